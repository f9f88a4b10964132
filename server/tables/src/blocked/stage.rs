//! Computes the tables of sources behind skylines for packs whose open tables exist.

use super::{ANGLE_COUNT, BlockedAxes, BlockedTables, blocking_deg, later::LaterParts, tables::open_sample};
use crate::{
    axes::{OffsetAxis, clamped_node},
    checkpoint::Checkpoint,
    clouds::clamped_geometry,
    error::TablesError,
    fit::{Basis, Floor, Projector, check_half_precision, sample_weights},
    images::{SourceImages, cloud_over, images_with},
    layout::{IMAGE_COUNT, PIXEL_COUNT, image_index},
    manifest::Scattering,
    multiple::{MultipleAxes, MultipleTable},
    pack::Pack,
    progress::Progress,
    resident::{FREQUENCY_COUNT, ResidentTables},
    spectrum::even_functions,
};
use half::f16;
use rayon::prelude::*;
use skyglow_physics::{
    Atmosphere, BAND_COUNT, Band, ELEVATION_COUNT, LOBE_COUNT, interpolation::Stencil,
    single_source::SourceGeometry,
};

/// Smallest ln of a cut scale over the open one: nothing is left.
const MIN_LOG_PART: f64 = -60.0;
/// Scales over the open ones are rounded to this step in their logarithm, which costs 5e-4 at most and packs well.
const LOG_PART_STEP: f64 = 1.0 / 1024.0;

/// What the stage works on: packs of several turbidities without these tables, and what they were made of.
pub(crate) struct BlockedJob<'a> {
    pub(crate) axes: &'a BlockedAxes,
    pub(crate) scattering: Scattering,
    pub(crate) multiple_axes: Option<&'a MultipleAxes>,
    /// One for each pack.
    pub(crate) atmospheres: &'a [Atmosphere],
    /// One for each pack, or none for the first order alone.
    pub(crate) multiple: &'a [MultipleTable],
    /// One for each pack.
    pub(crate) checkpoints: &'a [Checkpoint],
    pub(crate) progress: &'a dyn Progress,
}

/// A pack as the stage needs it: open tables at the stage's distances, and the basis.
struct OpenTables {
    tables: ResidentTables,
    projector: Projector,
}

impl OpenTables {
    /// The basis comes from the spectrum that the pack stores, so that a pack read from a file gives the same.
    fn new(pack: &Pack, axes: &BlockedAxes) -> Self {
        let spectrum = &pack.basis_spectrum[..axes.basis_count * ELEVATION_COUNT * FREQUENCY_COUNT];
        let basis = Basis { count: axes.basis_count, functions: even_functions(spectrum) };
        Self { tables: pack.resident(&axes.distance_m), projector: Projector::new(&basis) }
    }
}

/// The tables of every pack, in their order.
///
/// # Errors
/// [`TablesError`] naming the file or the step.
pub(crate) fn make_blocked(job: &BlockedJob<'_>, packs: &[Pack]) -> Result<Vec<BlockedTables>, TablesError> {
    let axes = job.axes;
    let later = later_parts(job)?;
    let open: Vec<OpenTables> = packs.iter().map(|pack| OpenTables::new(pack, axes)).collect();
    let (observers, distances) = (axes.observer_altitude_m.len(), axes.distance_m.len());
    job.progress.begin("sky images behind skylines", (observers * distances) as u64);
    let part_len = ANGLE_COUNT * axes.offset_count * IMAGE_COUNT * (1 + axes.basis_count);
    // [part][turbidity]
    let parts: Vec<Vec<Vec<f32>>> = (0..observers * distances)
        .into_par_iter()
        .map(|part| {
            let (observer, distance) = (part / distances, part % distances);
            let name = format!("blocked-{observer:02}-{distance:03}");
            let stored: Option<Vec<Vec<f32>>> = job
                .checkpoints
                .iter()
                .map(|checkpoint| checkpoint.load(&name).filter(|values| values.len() == part_len))
                .collect();
            let values = match stored {
                Some(values) => values,
                None => {
                    let values = make_part(job, &open, &later, observer, distance)?;
                    for (checkpoint, values) in job.checkpoints.iter().zip(&values) {
                        checkpoint.store(&name, values)?;
                    }
                    values
                }
            };
            job.progress.advance(1);
            Ok(values)
        })
        .collect::<Result<_, TablesError>>()?;
    Ok((0..packs.len()).map(|turbidity| arrange(axes, &parts, turbidity)).collect())
}

/// Later orders of every turbidity; empty for the first order alone.
fn later_parts(job: &BlockedJob<'_>) -> Result<Vec<LaterParts>, TablesError> {
    let (Some(multiple), Some(later)) = (job.multiple_axes, &job.axes.later) else { return Ok(Vec::new()) };
    let distance_m = &job.axes.distance_m;
    let fields = later.ground_altitude_m.len() * ANGLE_COUNT;
    job.progress.begin("multiple scattering behind skylines", (fields * job.atmospheres.len()) as u64);
    let name = |ground: usize, angle: usize| format!("later-{ground:02}-{angle:02}");
    job.atmospheres
        .iter()
        .zip(job.checkpoints)
        .map(|(&atmosphere, checkpoint)| {
            let stored = |ground, angle| {
                let part = checkpoint
                    .load(&name(ground, angle))
                    .filter(|part| part.len() == later.part_len(distance_m.len()))?;
                job.progress.advance(1);
                Some(part)
            };
            let store = |ground, angle, part: &[f32]| {
                job.progress.advance(1);
                checkpoint.store(&name(ground, angle), part)
            };
            LaterParts::solve(atmosphere, multiple, later, distance_m, stored, store)
        })
        .collect()
}

/// One part of every turbidity, each `[angle_index][offset][image][1 + basis]`.
fn make_part(
    job: &BlockedJob<'_>,
    open: &[OpenTables],
    later: &[LaterParts],
    observer: usize,
    distance: usize,
) -> Result<Vec<Vec<f32>>, TablesError> {
    let (distance_m, observer_m) = (job.axes.distance_m[distance], job.axes.observer_altitude_m[observer]);
    let mut parts = vec![Vec::new(); open.len()];
    for angle in 0..ANGLE_COUNT {
        let axis = OffsetAxis::behind_skyline(distance_m, blocking_deg(angle), job.axes.offset_count);
        let mut last: Option<(SourceGeometry, Vec<SourceImages>)> = None;
        for node in 0..job.axes.offset_count {
            let offset_m = axis.offset_m(node as f64);
            let geometry =
                clamped_geometry(clamped_node(distance_m, observer_m, offset_m), cloud_over(job.atmospheres));
            let add_later = |atmosphere: usize, images: &mut [f64]| {
                if let (Some(later), Some(table)) = (later.get(atmosphere), job.multiple.get(atmosphere)) {
                    later.add_to(table, &geometry, angle, distance, images);
                }
            };
            // Nodes outside the range of source altitudes show the last one inside, each beside its own open light.
            let images = match last.take() {
                Some((shown, images)) if shown == geometry => images,
                _ => images_with(job.atmospheres, &geometry, blocking_deg(angle).to_radians(), &add_later),
            };
            let clamped_offset_m = geometry.source_altitude_m - geometry.observer_altitude_m;
            let floor =
                Floor::behind_skyline(job.scattering, clamped_offset_m, distance_m, blocking_deg(angle));
            for ((part, open), images) in parts.iter_mut().zip(open).zip(&images) {
                push_differences(part, job, open, images, floor, observer_m, distance, offset_m)?;
            }
            last = Some((geometry, images));
        }
    }
    Ok(parts)
}

/// Adds one node of one turbidity, `[image][1 + basis]`.
fn push_differences(
    part: &mut Vec<f32>,
    job: &BlockedJob<'_>,
    open: &OpenTables,
    images: &SourceImages,
    floor: Floor,
    observer_m: f64,
    distance: usize,
    offset_m: f64,
) -> Result<(), TablesError> {
    let observers = Stencil::lagrange(&open.tables.observer_altitude_m, observer_m);
    let mut open_shape = vec![0.0f32; job.axes.basis_count];
    for lobe in 0..LOBE_COUNT {
        let shape = |band| &images.shape[image_index(lobe, band) * PIXEL_COUNT..][..PIXEL_COUNT];
        let shapes: [&[f32]; BAND_COUNT] = std::array::from_fn(shape);
        // As in the open tables, the middle image's weights serve all bands.
        let rows = open.projector.project(&sample_weights(shapes[Band::MIDDLE.index()], floor), &shapes)?;
        for (band, row) in rows.into_iter().enumerate() {
            let image = image_index(lobe, band);
            let open_log = open_sample(&open.tables, observers, image, distance, offset_m, &mut open_shape);
            let log_part = (images.log_scale[image] - open_log).clamp(MIN_LOG_PART, 0.0);
            part.push(((log_part / LOG_PART_STEP).round() * LOG_PART_STEP) as f32);
            let less_open: Vec<f64> =
                row.iter().zip(&open_shape).map(|(c, open)| c - f64::from(*open)).collect();
            check_half_precision(&less_open)?;
            part.extend(less_open.iter().map(|c| *c as f32));
        }
    }
    Ok(())
}

/// Parts `[observer][distance]` of `[turbidity][angle][offset][image][1 + basis]` → tables of one turbidity.
fn arrange(axes: &BlockedAxes, parts: &[Vec<Vec<f32>>], turbidity: usize) -> BlockedTables {
    let (distances, offsets) = (axes.distance_m.len(), axes.offset_count);
    let record = 1 + axes.basis_count;
    let mut log_part = Vec::with_capacity(axes.node_count());
    let mut shape_less_open = Vec::with_capacity(axes.node_count() * axes.basis_count);
    for observer in 0..axes.observer_altitude_m.len() {
        for angle in 0..ANGLE_COUNT {
            for image in 0..IMAGE_COUNT {
                for distance in 0..distances {
                    for offset in 0..offsets {
                        let start = ((angle * offsets + offset) * IMAGE_COUNT + image) * record;
                        let values =
                            &parts[observer * distances + distance][turbidity][start..start + record];
                        log_part.push(values[0]);
                        shape_less_open.extend(values[1..].iter().map(|&c| f16::from_f32(c)));
                    }
                }
            }
        }
    }
    BlockedTables { axes: axes.clone(), log_part, shape_less_open }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{NoProgress, PrecomputeOptions, precompute};
    use skyglow_physics::Turbidity;

    /// At the nodes scales are those of the cut images, and higher skylines leave less.
    #[test]
    #[ignore = "slow: `make check` leaves it to `make test`"]
    fn scales_at_nodes_are_those_of_cut_images() {
        let turbidity = Turbidity::new(2.0).unwrap();
        let folder = tempfile::tempdir().unwrap();
        let options = PrecomputeOptions::coarse(turbidity);
        let path = precompute(&options, folder.path(), &NoProgress).unwrap();
        let axes = options.blocked.unwrap();
        let tables = Pack::open(&path).unwrap().resident(&axes.distance_m);
        let blocked = tables.blocked.as_ref().unwrap();
        assert_eq!(blocked.shape.len(), blocked.log_scale.len() * blocked.basis_count);
        let distance = 1;
        for (angle, offset) in [(0, 1), (4, 2), (6, 1)] {
            let offset_m = blocked.offset_axis[angle][distance].offset_m(offset as f64);
            let geometry = clamped_node(axes.distance_m[distance], 0.0, offset_m);
            let scales = |blocking_deg: f64| {
                let air = [Atmosphere::new(turbidity)];
                images_with(&air, &geometry, blocking_deg.to_radians(), &|_, _| ())[0].log_scale
            };
            let (cut, open) = (scales(blocking_deg(angle)), scales(0.0));
            for lobe in 0..LOBE_COUNT {
                for band in 0..BAND_COUNT {
                    let image = image_index(lobe, band);
                    let node = blocked.scale_index(0, angle, lobe, band, distance, offset);
                    let error = f64::from(blocked.log_scale[node]) - cut[image];
                    // Where a skyline takes nothing, the scale is that of the open tables with their error.
                    assert!(
                        error.abs() < 1e-3 || cut[image] > open[image] - 0.5,
                        "{angle} {offset} {image}: {error}"
                    );
                }
            }
            // The low lobe loses most, if little by half a degree: the check can fail.
            let (cut, open) = (cut[image_index(1, 1)], open[image_index(1, 1)]);
            assert!(cut <= open && (angle == 0 || cut < open - 0.05), "{angle}: {cut} {open}");
        }
        let scale = |angle| blocked.log_scale[blocked.scale_index(0, angle, 1, 1, distance, 2)];
        assert!((1..ANGLE_COUNT).all(|angle| scale(angle) < scale(angle - 1) + 0.05));
        assert!(scale(ANGLE_COUNT - 1) < scale(0) - 1.0);
    }

    #[test]
    fn every_image_of_a_pack_is_where_its_index_says() {
        let folder = tempfile::tempdir().unwrap();
        let options = PrecomputeOptions::coarse(Turbidity::new(2.0).unwrap());
        let pack = Pack::open(&precompute(&options, folder.path(), &NoProgress).unwrap()).unwrap();
        // On a pack's own distances nothing is interpolated.
        let (axes, count) = (&pack.manifest().axes, pack.manifest().basis_count);
        let tables = pack.resident(&axes.distance_m);
        let (distances, offsets) = (axes.distance_m.len(), axes.offset_count);
        for (observer, lobe, band, distance, offset) in
            [(0, 0, 0, 0, 0), (1, 2, 1, 3, 2), (0, 1, 2, distances - 1, offsets - 1), (1, 0, 2, 2, 0)]
        {
            let image = observer * IMAGE_COUNT + image_index(lobe, band);
            let of_pack = &pack.shape[((image * distances + distance) * offsets + offset) * count..][..count];
            let index = tables.shape_index(observer, lobe, band, distance, offset);
            assert_eq!(&tables.shape[index * count..][..count], of_pack);
        }

        let behind = pack.blocked.as_ref().unwrap();
        let (distances, offsets) = (behind.axes.distance_m.len(), behind.axes.offset_count);
        let tables = pack.resident(&behind.axes.distance_m);
        let blocked = tables.blocked.as_ref().unwrap();
        let count = blocked.basis_count;
        // Differences at one observer altitude serve all.
        assert_eq!(behind.axes.observer_altitude_m.len(), 1);
        for (observer, angle, lobe, band, distance, offset) in [
            (0, 0, 0, 0, 0, 0),
            (1, 5, 2, 1, 2, 1),
            (0, ANGLE_COUNT - 1, 1, 2, distances - 1, offsets - 1),
            (1, 3, 0, 2, 1, 0),
        ] {
            let image = image_index(lobe, band);
            let offset_m = blocked.offset_axis[angle][distance].offset_m(offset as f64);
            let mut expected = vec![0.0f32; count];
            open_sample(&tables, Stencil::single(observer), image, distance, offset_m, &mut expected);
            let node = angle * IMAGE_COUNT + image;
            let differences =
                &behind.shape_less_open[((node * distances + distance) * offsets + offset) * count..];
            let index = blocked.shape_index(observer, angle, lobe, band, distance, offset);
            for ((value, open), difference) in
                blocked.shape[index * count..][..count].iter().zip(expected).zip(differences)
            {
                assert_eq!(*value, f16::from_f32(open + difference.to_f32()));
            }
        }
    }
}
