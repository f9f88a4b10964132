//! Computes a pack: training images → basis → every node's images projected on it → the same for sources behind skylines
//! → file.
//!
//! Images are temporary: each (observer altitude, distance) part is computed, projected and stored, so memory
//! stays small, a killed run resumes, and the result does not depend on threads or interruptions (every part
//! is computed by one thread in a fixed order).

use crate::{
    blocked::{BlockedJob, make_blocked},
    checkpoint::Checkpoint,
    error::TablesError,
    fit::{Basis, Floor, Projector, check_half_precision, fit_basis, sample_weights},
    images::images_of,
    layout::{IMAGE_COUNT, PIXEL_COUNT, image_index},
    manifest::{MeasuredError, PackParameters},
    measure::measure_error,
    multiple::MultipleTable,
    options::PrecomputeOptions,
    pack::Pack,
    progress::Progress,
    spectrum::even_spectrum,
    training::{offset_and_distance_m, training_geometries, training_images, training_set},
};
use half::f16;
use rayon::prelude::*;
use skyglow_physics::{Atmosphere, BAND_COUNT, Band, LOBE_COUNT, Turbidity};
use std::path::{Path, PathBuf};

/// Makes a pack in `out` and returns its path; resumes from what an earlier, killed run left there.
///
/// # Errors
/// [`TablesError`] naming the file or the step.
pub fn precompute(
    options: &PrecomputeOptions,
    out: &Path,
    progress: &dyn Progress,
) -> Result<PathBuf, TablesError> {
    let mut paths = precompute_together(std::slice::from_ref(&options.turbidity), options, out, progress)?;
    Ok(paths.remove(0))
}

/// The turbidities in ascending order, each once, when files can be named by them and written.
pub(crate) fn ascending(turbidities: &[Turbidity], out: &Path) -> Result<Vec<Turbidity>, TablesError> {
    let mut turbidities = turbidities.to_vec();
    turbidities.sort_by(|a, b| a.value().total_cmp(&b.value()));
    turbidities.dedup();
    check_decimals(&turbidities)?;
    std::fs::create_dir_all(out).map_err(TablesError::io(out))?;
    Ok(turbidities)
}

/// Makes packs of several turbidities (in place of the one in `options`; repetitions count once) and returns
/// their paths in ascending order. The same packs as one by one, in much less time: their images share all geometry.
///
/// # Errors
/// [`TablesError`] naming the file or the step.
pub fn precompute_together(
    turbidities: &[Turbidity],
    options: &PrecomputeOptions,
    out: &Path,
    progress: &dyn Progress,
) -> Result<Vec<PathBuf>, TablesError> {
    let turbidities = ascending(turbidities, out)?;
    let atmospheres: Vec<Atmosphere> = turbidities.iter().map(|&t| options.atmosphere(t)).collect();
    let parameters: Vec<PackParameters> = turbidities.iter().map(|&t| options.parameters(t)).collect();
    let checkpoints: Vec<Checkpoint> =
        parameters.iter().map(|p| Checkpoint::open(out, p)).collect::<Result<_, _>>()?;
    let multiple = make_multiple(options, &atmospheres, &checkpoints, progress)?;
    let bases = make_bases(options, &parameters, &atmospheres, &multiple, &checkpoints, progress)?;
    let projectors: Vec<Projector> = bases.iter().map(Projector::new).collect();
    let observers = options.axes.observer_altitude_m.len();
    let distances = options.axes.distance_m.len();
    progress.begin("sky images", (observers * distances) as u64);
    // [part][turbidity]
    let parts: Vec<Vec<Vec<f32>>> = (0..observers * distances)
        .into_par_iter()
        .map(|part| {
            let (observer, distance) = (part / distances, part % distances);
            let name = format!("part-{observer:02}-{distance:03}");
            let stored: Option<Vec<Vec<f32>>> = checkpoints
                .iter()
                .zip(&bases)
                .map(|(checkpoint, basis)| {
                    checkpoint.load(&name).filter(|part| part.len() == part_len(options, basis.count))
                })
                .collect();
            let values = match stored {
                Some(values) => values,
                None => {
                    let values =
                        make_part(options, &atmospheres, &multiple, &projectors, observer, distance)?;
                    for (checkpoint, values) in checkpoints.iter().zip(&values) {
                        checkpoint.store(&name, values)?;
                    }
                    values
                }
            };
            progress.advance(1);
            Ok(values)
        })
        .collect::<Result<_, TablesError>>()?;
    progress.begin("measuring the error", (options.error_sources * turbidities.len()) as u64);
    let mut packs = Vec::with_capacity(turbidities.len());
    for (index, ((parameters, basis), atmosphere)) in
        parameters.iter().zip(&bases).zip(&atmospheres).enumerate()
    {
        let (log_scale, shape) = arrange(options, &parts, index, basis.count);
        let mut pack = Pack::from_computed(
            parameters.manifest(MeasuredError::default(), String::new()),
            log_scale,
            shape,
            even_spectrum(&basis.functions),
        );
        pack.manifest_mut().measured_error =
            measure_error(&pack, atmosphere, multiple.get(index), options.error_sources, &|| {
                progress.advance(1)
            });
        packs.push(pack);
    }
    finish(options, &atmospheres, &multiple, packs, checkpoints, out, progress)
}

/// Files are named by two decimals.
pub(crate) fn check_decimals(turbidities: &[Turbidity]) -> Result<(), TablesError> {
    for turbidity in turbidities.iter().map(|t| t.value()) {
        if (turbidity * 100.0 - (turbidity * 100.0).round()).abs() > 1e-9 {
            return Err(TablesError::TooManyDecimals { turbidity });
        }
    }
    Ok(())
}

/// The last stages, common to new packs and to those that lacked them: sources behind skylines, and the files.
fn finish(
    options: &PrecomputeOptions,
    atmospheres: &[Atmosphere],
    multiple: &[MultipleTable],
    mut packs: Vec<Pack>,
    checkpoints: Vec<Checkpoint>,
    out: &Path,
    progress: &dyn Progress,
) -> Result<Vec<PathBuf>, TablesError> {
    if let Some(axes) = options.blocked_axes() {
        let job = BlockedJob {
            axes: &axes,
            scattering: options.scattering,
            multiple_axes: options.multiple_axes(),
            atmospheres,
            multiple,
            checkpoints: &checkpoints,
            progress,
        };
        let blocked = make_blocked(&job, &packs)?;
        for (pack, blocked) in packs.iter_mut().zip(blocked) {
            pack.set_blocked(blocked);
        }
    }
    let paths = packs.iter().map(|pack| pack.write(out)).collect::<Result<_, _>>()?;
    for checkpoint in checkpoints {
        checkpoint.finish()?;
    }
    Ok(paths)
}

/// The basis that a pack of one turbidity would have, without its tables: to measure the accuracy of the fit.
///
/// # Errors
/// [`TablesError::Fit`] when a least-squares step breaks down.
pub fn basis_alone(options: &PrecomputeOptions, multiple: &[MultipleTable]) -> Result<Basis, TablesError> {
    let geometries = training_geometries(options);
    let atmospheres = [options.atmosphere(options.turbidity)];
    let images = training_images(&atmospheres, multiple, &geometries, &|| ());
    let set = training_set(options, &geometries, &images, 0);
    fit_basis(&set, options.basis_count.at(options.turbidity), options.fit_iterations, &|| ())
}

/// Multiply scattered light of every turbidity; empty for the first order alone.
fn make_multiple(
    options: &PrecomputeOptions,
    atmospheres: &[Atmosphere],
    checkpoints: &[Checkpoint],
    progress: &dyn Progress,
) -> Result<Vec<MultipleTable>, TablesError> {
    let Some(axes) = options.multiple_axes() else { return Ok(Vec::new()) };
    let parts = axes.part_count(options.cloud_base());
    progress.begin("multiple scattering", (parts * atmospheres.len()) as u64);
    let name = |ground: usize, offset: usize| format!("multiple-{ground:02}-{offset:02}");
    atmospheres
        .iter()
        .zip(checkpoints)
        .map(|(&atmosphere, checkpoint)| {
            let stored = |ground, offset| {
                let part =
                    checkpoint.load(&name(ground, offset)).filter(|part| part.len() == axes.part_len())?;
                progress.advance(1);
                Some(part)
            };
            let store = |ground, offset, part: &[f32]| {
                progress.advance(1);
                checkpoint.store(&name(ground, offset), part)
            };
            MultipleTable::solve(atmosphere, axes, stored, store)
        })
        .collect()
}

fn make_bases(
    options: &PrecomputeOptions,
    parameters: &[PackParameters],
    atmospheres: &[Atmosphere],
    multiple: &[MultipleTable],
    checkpoints: &[Checkpoint],
    progress: &dyn Progress,
) -> Result<Vec<Basis>, TablesError> {
    let load = |(checkpoint, parameters): (&Checkpoint, &PackParameters)| {
        let count = parameters.basis_count;
        let functions = checkpoint.load("basis").filter(|f| f.len() == count * PIXEL_COUNT)?;
        Some(Basis { count, functions })
    };
    if let Some(bases) = checkpoints.iter().zip(parameters).map(load).collect() {
        return Ok(bases);
    }
    let geometries = training_geometries(options);
    progress.begin("training images", geometries.len() as u64);
    let images = training_images(atmospheres, multiple, &geometries, &|| progress.advance(1));
    progress.begin("basis fit", (options.fit_iterations as u64 + 1) * atmospheres.len() as u64);
    checkpoints
        .iter()
        .zip(parameters)
        .enumerate()
        .map(|(index, (checkpoint, parameters))| {
            let set = training_set(options, &geometries, &images, index);
            let advance = || progress.advance(1);
            let basis = fit_basis(&set, parameters.basis_count, options.fit_iterations, &advance)?;
            checkpoint.store("basis", &basis.functions)?;
            Ok(basis)
        })
        .collect()
}

/// Numbers of one part: for each offset and image a log scale and M coefficients.
fn part_len(options: &PrecomputeOptions, basis_count: usize) -> usize {
    options.axes.offset_count * IMAGE_COUNT * (1 + basis_count)
}

/// One part of every turbidity, each `[offset][lobe][band][1 + basis]`, as many functions as its projector has.
fn make_part(
    options: &PrecomputeOptions,
    atmospheres: &[Atmosphere],
    multiple: &[MultipleTable],
    projectors: &[Projector],
    observer: usize,
    distance: usize,
) -> Result<Vec<Vec<f32>>, TablesError> {
    let with_room = |projector: &Projector| Vec::with_capacity(part_len(options, projector.count()));
    let mut parts: Vec<Vec<f32>> = projectors.iter().map(with_room).collect();
    let cloud = options.cloud_base();
    let mut previous_altitude_m = f64::NAN;
    for offset in 0..options.axes.offset_count {
        // Nodes outside the range of source altitudes repeat the last one inside.
        let geometry = options.axes.geometry(observer, distance, offset, cloud);
        if geometry.source_altitude_m == previous_altitude_m {
            for (part, projector) in parts.iter_mut().zip(projectors) {
                let record = IMAGE_COUNT * (1 + projector.count());
                part.extend_from_within(part.len() - record..);
            }
            continue;
        }
        previous_altitude_m = geometry.source_altitude_m;
        let images = images_of(atmospheres, multiple, &geometry);
        let (offset_m, distance_m) = offset_and_distance_m(&geometry);
        let floor = Floor::of(options.scattering, cloud.is_some(), offset_m, distance_m);
        for ((part, images), projector) in parts.iter_mut().zip(&images).zip(projectors) {
            for lobe in 0..LOBE_COUNT {
                let shape = |band| &images.shape[image_index(lobe, band) * PIXEL_COUNT..][..PIXEL_COUNT];
                // The middle image's weights serve all bands: a third of the normal equations, and the mean error
                // rises by a tenth of itself.
                let shapes: [&[f32]; BAND_COUNT] = std::array::from_fn(shape);
                let rows =
                    projector.project(&sample_weights(shapes[Band::MIDDLE.index()], floor), &shapes)?;
                for (band, row) in rows.into_iter().enumerate() {
                    check_half_precision(&row)?;
                    part.push(images.log_scale[image_index(lobe, band)] as f32);
                    part.extend(row.into_iter().map(|c| c as f32));
                }
            }
        }
    }
    Ok(parts)
}

/// Parts `[observer][distance]` of `[turbidity][offset][image][1 + basis]` → sections of one turbidity's pack,
/// `[observer][image][distance][offset]` and the same with `[basis]`.
fn arrange(
    options: &PrecomputeOptions,
    parts: &[Vec<Vec<f32>>],
    turbidity: usize,
    basis_count: usize,
) -> (Vec<f32>, Vec<f16>) {
    let (distances, offsets) = (options.axes.distance_m.len(), options.axes.offset_count);
    let record = 1 + basis_count;
    let mut log_scale = Vec::new();
    let mut shape = Vec::new();
    for observer in 0..options.axes.observer_altitude_m.len() {
        for image in 0..IMAGE_COUNT {
            for distance in 0..distances {
                for offset in 0..offsets {
                    let start = (offset * IMAGE_COUNT + image) * record;
                    let values = &parts[observer * distances + distance][turbidity][start..start + record];
                    log_scale.push(values[0]);
                    shape.extend(values[1..].iter().map(|&c| f16::from_f32(c)));
                }
            }
        }
    }
    (log_scale, shape)
}
