//! Multiply scattered light of single sources, tabulated for the images of a pack.
//!
//! Orders two and more are smooth where the first is not: they have no shadow edge, and near a source they are a
//! small part of its light. So they are solved for few settings and interpolated in their logarithm: over the
//! altitude ℓ of the ground, which is the lower of source and observer, over the offset Δ = h_c − h_o, and over
//! azimuth. For Δ ≤ 0 the source stands on the ground, and one field ([`SourceField`]) serves every observer above
//! it; for Δ > 0 the observer does, and each offset needs a field of its own. In the haze there are more of both: its
//! optical depth halves within 800 m, and it scatters the light of a near source back from where that stands.

mod axes;

use crate::{
    clouds::clamped_below_clouds_m,
    error::TablesError,
    layout::{HALF_COLUMN_COUNT, IMAGE_COUNT, PIXEL_COUNT, image_index},
};
use rayon::prelude::*;
use skyglow_physics::{
    Atmosphere, BAND_COUNT, ELEVATION_COUNT, LOBE_COUNT,
    interpolation::{MAX_STENCIL, Stencil},
    multiple_scattering::{SourceField, SourceSetting, ViewRow},
    panorama::{azimuth_rad, elevation_rad},
    single_source::SourceGeometry,
};

pub(crate) use axes::stretched_offset;
pub use axes::{FieldResolution, MultipleAxes};

/// Radiance that stands for darkness, m⁻² sr⁻¹ per watt.
const DARKNESS_PER_M2_SR: f64 = 1e-36;
/// ln of the radiance of orders two and more [m⁻² sr⁻¹ per watt] around sources in one atmosphere.
#[derive(Clone, Debug)]
pub struct MultipleTable {
    axes: MultipleAxes,
    log_distance: Vec<f64>,
    /// [`stretched_offset`] of the offsets over each ground.
    stretched_offsets: Vec<Vec<f64>>,
    /// `[ground][offset]`, each `[distance][row][column][image]`.
    parts: Vec<Vec<Vec<f32>>>,
    /// For each panorama column the table's columns and their weights.
    column_stencils: Vec<Stencil>,
}

impl MultipleTable {
    /// Solves the table. `stored` may return parts by (ground, offset), each
    /// as [`MultipleTable`] stores them; `store` is given each new one.
    ///
    /// Runs on the current rayon pool; the result does not depend on the number of threads.
    ///
    /// # Errors
    /// A setting outside its range, or what `store` fails with.
    pub fn solve(
        atmosphere: Atmosphere,
        axes: &MultipleAxes,
        stored: impl Fn(usize, usize) -> Option<Vec<f32>> + Sync,
        store: impl Fn(usize, usize, &[f32]) -> Result<(), TablesError> + Sync,
    ) -> Result<Self, TablesError> {
        let clamped_m = |altitude_m| clamped_below_clouds_m(altitude_m, atmosphere.cloud());
        let view_part = |field: &SourceField, ground: usize, offset: usize, offset_m: f64| {
            let observer_m = clamped_m(axes.ground_altitude_m[ground] - offset_m.min(0.0));
            let part = view(field, &axes.column, &axes.distance_m, observer_m)?;
            store(ground, offset, &part)?;
            Ok(part)
        };
        // Offsets that share a field are one piece of work. Several side by side: alone, a field does not keep every
        // thread busy.
        let solve = |(ground, offsets): (usize, Vec<(usize, f64)>)| -> Result<Vec<Vec<f32>>, TablesError> {
            let mut field: Option<SourceField> = None;
            let part = |(offset, offset_m): (usize, f64)| {
                if let Some(part) = stored(ground, offset) {
                    return Ok(part);
                }
                let field = match &mut field {
                    Some(field) => field,
                    none => none.insert(solved_field(atmosphere, axes, ground, offset_m)?),
                };
                view_part(field, ground, offset, offset_m)
            };
            offsets.into_iter().map(part).collect()
        };
        let grounds = 0..axes.ground_altitude_m.len();
        let pieces: Vec<(usize, Vec<(usize, f64)>)> = grounds
            .clone()
            .flat_map(|ground| {
                let offsets: Vec<(usize, f64)> =
                    axes.offsets_over_m(ground, atmosphere.cloud()).into_iter().enumerate().collect();
                let sharing = offsets.chunk_by(|a, b| a.1.max(0.0) == b.1.max(0.0));
                sharing.map(|offsets| (ground, offsets.to_vec())).collect::<Vec<_>>()
            })
            .collect();
        let solved: Vec<Vec<Vec<f32>>> = pieces.par_iter().cloned().map(solve).collect::<Result<_, _>>()?;
        let mut parts: Vec<Vec<Vec<f32>>> = vec![Vec::new(); grounds.len()];
        for ((ground, _), solved) in pieces.into_iter().zip(solved) {
            parts[ground].extend(solved);
        }
        let stretched = |ground| {
            axes.offsets_over_m(ground, atmosphere.cloud()).into_iter().map(stretched_offset).collect()
        };
        Ok(Self {
            axes: axes.clone(),
            log_distance: axes.distance_m.iter().map(|d| d.ln()).collect(),
            stretched_offsets: grounds.map(stretched).collect(),
            parts,
            column_stencils: column_stencils(&axes.column),
        })
    }

    /// Adds the radiance [m⁻² sr⁻¹ per watt] around a source to images `[image][row][column]`.
    pub fn add_to(&self, geometry: &SourceGeometry, images: &mut [f64]) {
        let columns = self.axes.column.len();
        let mut row_log = vec![0.0f64; columns * IMAGE_COUNT];
        let nodes = self.nodes(geometry);
        for row in 0..ELEVATION_COUNT {
            row_log.fill(0.0);
            for &(part, distance, weight) in &nodes {
                let start = (distance * ELEVATION_COUNT + row) * columns * IMAGE_COUNT;
                let values = &part[start..start + columns * IMAGE_COUNT];
                for (sum, &value) in row_log.iter_mut().zip(values) {
                    *sum += weight * f64::from(value);
                }
            }
            for (column, stencil) in self.column_stencils.iter().enumerate() {
                let mut log = [0.0f64; IMAGE_COUNT];
                for (node, weight) in stencil {
                    for (sum, value) in log.iter_mut().zip(&row_log[node * IMAGE_COUNT..]) {
                        *sum += weight * value;
                    }
                }
                for (image, log) in log.into_iter().enumerate() {
                    images[image * PIXEL_COUNT + row * HALF_COLUMN_COUNT + column] += log.exp();
                }
            }
        }
    }

    /// The radiance [m⁻² sr⁻¹ per watt] at one grid direction, `[image]`: as [`Self::add_to`].
    pub fn radiance_per_watt(
        &self,
        geometry: &SourceGeometry,
        row: usize,
        column: usize,
    ) -> [f64; IMAGE_COUNT] {
        let columns = self.axes.column.len();
        let mut log = [0.0f64; IMAGE_COUNT];
        for (part, distance, weight) in self.nodes(geometry) {
            for (node, column_weight) in &self.column_stencils[column] {
                let start = ((distance * ELEVATION_COUNT + row) * columns + node) * IMAGE_COUNT;
                for (sum, &value) in log.iter_mut().zip(&part[start..start + IMAGE_COUNT]) {
                    *sum += weight * column_weight * f64::from(value);
                }
            }
        }
        log.map(f64::exp)
    }

    /// (part, distance node, weight) of a geometry; no weight is zero.
    fn nodes(&self, geometry: &SourceGeometry) -> Vec<(&[f32], usize, f64)> {
        let ground_m = geometry.source_altitude_m.min(geometry.observer_altitude_m);
        let stretched = stretched_offset(geometry.source_altitude_m - geometry.observer_altitude_m);
        let distances = Stencil::lagrange(&self.log_distance, geometry.distance_m.ln());
        let mut nodes = Vec::with_capacity(MAX_STENCIL.pow(3));
        // In altitude itself: in the optical depth above, where a clear path's logarithm is a line, the light that finds
        // its way around through thinner air bends more.
        let grounds_m = &self.axes.ground_altitude_m;
        let first = if stretched > 0.0 { grounds_m.partition_point(|&ground_m| ground_m < 0.0) } else { 0 };
        for (ground, ground_weight) in Stencil::lagrange(&grounds_m[first..], ground_m).shifted(first) {
            for (offset, offset_weight) in offset_stencil(&self.stretched_offsets[ground], stretched) {
                for (distance, distance_weight) in distances {
                    let weight = ground_weight * offset_weight * distance_weight;
                    if weight != 0.0 {
                        nodes.push((self.parts[ground][offset].as_slice(), distance, weight));
                    }
                }
            }
        }
        nodes
    }
}

/// The stencil in [`stretched_offset`] on the source's own side of the observer: where both stand equally high there is a kink, for
/// below it the ground is the source's, above it the observer's.
fn offset_stencil(stretched_offsets: &[f64], stretched: f64) -> Stencil {
    let level = stretched_offsets.partition_point(|&node| node < 0.0);
    if stretched <= 0.0 {
        return Stencil::lagrange(&stretched_offsets[..(level + 1).min(stretched_offsets.len())], stretched);
    }
    let first = level.min(stretched_offsets.len() - 1);
    Stencil::lagrange(&stretched_offsets[first..], stretched).shifted(first)
}

/// The field that serves an offset over a ground.
fn solved_field(
    atmosphere: Atmosphere,
    axes: &MultipleAxes,
    ground: usize,
    offset_m: f64,
) -> Result<SourceField, TablesError> {
    let ground_m = axes.ground_altitude_m[ground];
    let source_m = clamped_below_clouds_m(ground_m + offset_m.max(0.0), atmosphere.cloud());
    let setting = SourceSetting::new(atmosphere, source_m, ground_m, axes.ground_albedo)?;
    Ok(SourceField::solve(setting, &axes.field_resolution.resolution()))
}

/// For each panorama column the table's columns around it and their weights, in azimuth.
pub(crate) fn column_stencils(columns: &[usize]) -> Vec<Stencil> {
    let nodes: Vec<f64> = columns.iter().map(|&column| column as f64).collect();
    (0..HALF_COLUMN_COUNT).map(|column| Stencil::lagrange(&nodes, column as f64)).collect()
}

/// What an observer sees of a field at panorama columns, `[distance][row][column][image]`, ln(m⁻² sr⁻¹).
pub(crate) fn view(
    field: &SourceField,
    columns: &[usize],
    distance_m: &[f64],
    observer_altitude_m: f64,
) -> Result<Vec<f32>, TablesError> {
    // [row][distance][column][image]
    let rows: Vec<Vec<f32>> = (0..ELEVATION_COUNT)
        .into_par_iter()
        .map(|row| {
            let rays = ViewRow::new(field, observer_altitude_m, elevation_rad(row))?;
            let mut values = Vec::with_capacity(distance_m.len() * columns.len() * IMAGE_COUNT);
            for &distance_m in distance_m {
                for &column in columns {
                    let radiance = rays.radiance_per_watt(distance_m, azimuth_rad(column));
                    let mut images = [0.0f32; IMAGE_COUNT];
                    for band in 0..BAND_COUNT {
                        for lobe in 0..LOBE_COUNT {
                            images[image_index(lobe, band)] =
                                radiance[band][lobe].max(DARKNESS_PER_M2_SR).ln() as f32;
                        }
                    }
                    values.extend(images);
                }
            }
            Ok(values)
        })
        .collect::<Result<_, TablesError>>()?;
    let row_len = columns.len() * IMAGE_COUNT;
    let mut part = Vec::with_capacity(distance_m.len() * ELEVATION_COUNT * row_len);
    for distance in 0..distance_m.len() {
        for row in &rows {
            part.extend_from_slice(&row[distance * row_len..(distance + 1) * row_len]);
        }
    }
    Ok(part)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::clouds::Clouds;
    use skyglow_physics::{Turbidity, multiple_scattering::Resolution};

    fn table(distance_m: &[f64]) -> (Atmosphere, MultipleTable) {
        let atmosphere = Atmosphere::new(Turbidity::new(3.0).unwrap());
        let axes = MultipleAxes { distance_m: distance_m.to_vec(), ..MultipleAxes::coarse(0.15) };
        (atmosphere, MultipleTable::solve(atmosphere, &axes, |_, _| None, |_, _, _| Ok(())).unwrap())
    }

    /// At its nodes the table is the field, and images are what single directions are.
    #[test]
    #[ignore = "slow: `make check` leaves it to `make test`"]
    fn the_table_is_the_field_at_its_nodes() {
        let distance_m = [2_000.0, 30_000.0];
        let (atmosphere, table) = table(&distance_m);
        for (source_m, observer_m) in [(3_000.0, 5_000.0), (400.0, 0.0)] {
            let geometry = SourceGeometry {
                distance_m: 30_000.0,
                source_altitude_m: source_m,
                observer_altitude_m: observer_m,
            };
            let setting = SourceSetting::for_observer(atmosphere, source_m, observer_m, 0.15).unwrap();
            is_that_of_the_field(&table, &SourceField::solve(setting, &Resolution::coarse()), geometry);
        }
    }

    fn is_that_of_the_field(table: &MultipleTable, field: &SourceField, geometry: SourceGeometry) {
        let mut images = vec![0.0; IMAGE_COUNT * PIXEL_COUNT];
        table.add_to(&geometry, &mut images);
        for (row, column) in [(0, 0), (10, 64), (63, 128), (30, 16)] {
            let reference = ViewRow::new(field, geometry.observer_altitude_m, elevation_rad(row))
                .unwrap()
                .radiance_per_watt(30_000.0, azimuth_rad(column));
            let got = table.radiance_per_watt(&geometry, row, column);
            for (slot, &reference) in reference.as_flattened().iter().enumerate() {
                // `[band][lobe]`
                let image = image_index(slot % LOBE_COUNT, slot / LOBE_COUNT);
                assert!((got[image] / reference - 1.0).abs() < 1e-4, "{row} {column} {slot}");
                let sample = images[image * PIXEL_COUNT + row * HALF_COLUMN_COUNT + column];
                assert!((sample / got[image] - 1.0).abs() < 1e-9);
            }
        }
        // The check can fail: another distance is another sky.
        let near = SourceGeometry { distance_m: 20_000.0, ..geometry };
        let ratio = table.radiance_per_watt(&near, 10, 64)[0] / table.radiance_per_watt(&geometry, 10, 64)[0];
        assert!(ratio > 1.2, "{ratio}");
    }

    /// Offsets are interpolated on their own side of the observer, and haze has more of them.
    #[test]
    fn offsets_are_interpolated_on_their_own_side() {
        let axes = MultipleAxes::full(0.15);
        let stretched =
            |ground| axes.offsets_over_m(ground, None).into_iter().map(stretched_offset).collect::<Vec<_>>();
        let (haze, clear) = (stretched(3), stretched(8));
        assert!(haze.len() == clear.len() + axes.haze_offset_m.len());
        assert!(haze.windows(2).all(|pair| pair[0] < pair[1]));
        let level = haze.partition_point(|&node| node < 0.0);
        for (offset_m, sides) in [(-30.0, 0..=level), (0.0, 0..=level), (20.0, level..=haze.len() - 1)] {
            let stencil = offset_stencil(&haze, stretched_offset(offset_m));
            assert!(stencil.nodes().all(|node| sides.contains(&node)), "{offset_m}: {stencil:?}");
            assert!((stencil.weights().iter().sum::<f64>() - 1.0).abs() < 1e-12);
            let position = stencil.sum(|node| haze[node]);
            assert!((position - stretched_offset(offset_m)).abs() < 1e-9, "{offset_m}");
        }
        let clouds = Clouds::new(1_000, 0.5).unwrap();
        let below = MultipleAxes::full(0.15).below(clouds);
        assert!(below.ground_altitude_m[1] == -450.0 && below.ground_altitude_m[2] == 0.0);
        for ground in 0..below.ground_altitude_m.len() {
            let offsets_m = below.offsets_over_m(ground, Some(clouds.base()));
            assert!(offsets_m.windows(2).all(|pair| pair[0] < pair[1]) && offsets_m.contains(&0.0));
            let ceiling_m = clouds.ceiling_m() - below.ground_altitude_m[ground];
            assert!(offsets_m.iter().all(|offset_m| offset_m.abs() <= ceiling_m + 1e-9), "{offsets_m:?}");
        }
        let raised = offset_stencil(&[-3.0, 0.0], 1.0).nodes();
        assert_eq!(raised, 1..2, "without offsets above the observer its own stands for them");
    }

    /// The columns of every table reach from the source to its opposite, and their weights sum to one.
    #[test]
    fn column_stencils_span_the_half_turn() {
        for axes in [MultipleAxes::full(0.15), MultipleAxes::coarse(0.15)] {
            assert_eq!((axes.column[0], axes.column[axes.column.len() - 1]), (0, HALF_COLUMN_COUNT - 1));
            for stencil in column_stencils(&axes.column) {
                assert!((stencil.weights().iter().sum::<f64>() - 1.0).abs() < 1e-12);
            }
        }
    }
}
