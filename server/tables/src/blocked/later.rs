//! Later orders of scattering behind a skyline, as a part of those under the open sky.
//!
//! Fields are solved for sources on the ground alone, where one field serves every observer at or above the source; the
//! part is a smooth function of place and direction, and multiplies what [`MultipleTable`] gives for the open source.

use super::{ANGLE_COUNT, LaterAxes, blocking_deg};
use crate::{
    clouds::clamped_below_clouds_m,
    error::TablesError,
    layout::{HALF_COLUMN_COUNT, IMAGE_COUNT, PIXEL_COUNT},
    multiple::{MultipleAxes, MultipleTable, column_stencils, stretched_offset, view},
};
use rayon::prelude::*;
use skyglow_physics::{
    Atmosphere, ELEVATION_COUNT,
    interpolation::{MAX_STENCIL, Stencil},
    multiple_scattering::{SourceField, SourceSetting},
    single_source::SourceGeometry,
};

/// Smallest ln of a part that is stored.
const MIN_LOG_PART: f32 = -30.0;

/// ln of the part that skylines leave of orders two and more, in one atmosphere.
#[derive(Clone, Debug)]
pub(super) struct LaterParts {
    axes: LaterAxes,
    distances: usize,
    /// `[ground][angle_index]`, each `[offset][distance][row][column][image]`.
    parts: Vec<Vec<f32>>,
    column_stencils: Vec<Stencil>,
}

impl LaterAxes {
    /// Numbers of the table of one (ground, angle) at `distances` distances.
    pub(super) fn part_len(&self, distances: usize) -> usize {
        self.offset_m.len() * distances * ELEVATION_COUNT * self.column.len() * IMAGE_COUNT
    }

    /// What observers at every offset see of a field, `[offset][distance][row][column][image]`, ln(m⁻² sr⁻¹).
    fn views(&self, field: &SourceField, ground_m: f64, distance_m: &[f64]) -> Result<Vec<f32>, TablesError> {
        let mut views = Vec::with_capacity(self.part_len(distance_m.len()));
        for offset_m in &self.offset_m {
            let observer_m = clamped_below_clouds_m(ground_m - offset_m, field.setting().atmosphere.cloud());
            views.extend(view(field, &self.column, distance_m, observer_m)?);
        }
        Ok(views)
    }
}

impl LaterParts {
    /// Solves the fields of open and cut sources on every ground. `stored` may return parts by (ground, angle index);
    /// `store` is given each new one. The result does not depend on the number of threads.
    ///
    /// # Errors
    /// A setting outside its range, or what `store` fails with.
    pub(super) fn solve(
        atmosphere: Atmosphere,
        multiple: &MultipleAxes,
        axes: &LaterAxes,
        distance_m: &[f64],
        stored: impl Fn(usize, usize) -> Option<Vec<f32>> + Sync,
        store: impl Fn(usize, usize, &[f32]) -> Result<(), TablesError> + Sync,
    ) -> Result<Self, TablesError> {
        let resolution = axes.field_resolution.resolution();
        let setting = |ground: usize| {
            let ground_m = axes.ground_altitude_m[ground];
            SourceSetting::new(atmosphere, ground_m, ground_m, multiple.ground_albedo)
        };
        let solved_views = |setting: SourceSetting, ground: usize| {
            axes.views(&SourceField::solve(setting, &resolution), axes.ground_altitude_m[ground], distance_m)
        };
        let grounds = axes.ground_altitude_m.len();
        let stored: Vec<Option<Vec<f32>>> =
            (0..grounds * ANGLE_COUNT).map(|part| stored(part / ANGLE_COUNT, part % ANGLE_COUNT)).collect();
        // Open skies first: each is what the cut ones of its ground are parts of.
        let open: Vec<Vec<f32>> = (0..grounds)
            .into_par_iter()
            .map(|ground| match stored[ground * ANGLE_COUNT..][..ANGLE_COUNT].iter().any(Option::is_none) {
                true => solved_views(setting(ground)?, ground),
                false => Ok(Vec::new()),
            })
            .collect::<Result<_, TablesError>>()?;
        let parts: Vec<Vec<f32>> = stored
            .into_par_iter()
            .enumerate()
            .map(|(part, stored)| {
                if let Some(stored) = stored {
                    return Ok(stored);
                }
                let (ground, angle) = (part / ANGLE_COUNT, part % ANGLE_COUNT);
                let mut part =
                    solved_views(setting(ground)?.behind(blocking_deg(angle).to_radians())?, ground)?;
                for (cut, open) in part.iter_mut().zip(&open[ground]) {
                    // A skyline takes light and adds none; where both are dark nothing is known and nothing matters.
                    *cut = (*cut - open).clamp(MIN_LOG_PART, 0.0);
                }
                store(ground, angle, &part)?;
                Ok(part)
            })
            .collect::<Result<_, TablesError>>()?;
        Ok(Self {
            axes: axes.clone(),
            distances: distance_m.len(),
            parts,
            column_stencils: column_stencils(&axes.column),
        })
    }

    /// Adds to `images` `[image][row][column]` [m⁻² sr⁻¹] what the skyline of `angle_index` leaves of the later orders of
    /// a source at distance node `distance`, whose open light is `table`'s.
    pub(super) fn add_to(
        &self,
        table: &MultipleTable,
        geometry: &SourceGeometry,
        angle_index: usize,
        distance: usize,
        images: &mut [f64],
    ) {
        let mut open = vec![0.0; IMAGE_COUNT * PIXEL_COUNT];
        table.add_to(geometry, &mut open);
        let nodes = self.nodes(geometry, angle_index);
        let columns = self.axes.column.len();
        let mut row_log = vec![0.0f64; columns * IMAGE_COUNT];
        for row in 0..ELEVATION_COUNT {
            row_log.fill(0.0);
            for &(part, offset, weight) in &nodes {
                let start =
                    ((offset * self.distances + distance) * ELEVATION_COUNT + row) * columns * IMAGE_COUNT;
                let values = &self.parts[part][start..start + columns * IMAGE_COUNT];
                for (sum, &value) in row_log.iter_mut().zip(values) {
                    *sum += weight * f64::from(value);
                }
            }
            for (column, stencil) in self.column_stencils.iter().enumerate() {
                for image in 0..IMAGE_COUNT {
                    let log = stencil.sum(|node| row_log[node * IMAGE_COUNT + image]);
                    let sample = image * PIXEL_COUNT + row * HALF_COLUMN_COUNT + column;
                    images[sample] += open[sample] * log.min(0.0).exp();
                }
            }
        }
    }

    /// (part, offset node, weight) of a geometry and angle; no weight is zero.
    fn nodes(&self, geometry: &SourceGeometry, angle_index: usize) -> Vec<(usize, usize, f64)> {
        let ground_m = geometry.source_altitude_m.min(geometry.observer_altitude_m);
        let offset_m = (geometry.source_altitude_m - geometry.observer_altitude_m).min(0.0);
        let stretched_axis: Vec<f64> =
            self.axes.offset_m.iter().map(|&offset_m| stretched_offset(offset_m)).collect();
        let mut nodes = Vec::with_capacity(MAX_STENCIL.pow(2));
        for (ground, ground_weight) in Stencil::lagrange(&self.axes.ground_altitude_m, ground_m) {
            for (offset, offset_weight) in Stencil::lagrange(&stretched_axis, stretched_offset(offset_m)) {
                let weight = ground_weight * offset_weight;
                if weight != 0.0 {
                    nodes.push((ground * ANGLE_COUNT + angle_index, offset, weight));
                }
            }
        }
        nodes
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::multiple::FieldResolution;
    use skyglow_physics::{
        BAND_COUNT, LOBE_COUNT, Turbidity,
        multiple_scattering::ViewRow,
        panorama::{azimuth_rad, elevation_rad},
    };

    /// At its nodes the part is that of a cut field, and it multiplies the open table.
    #[test]
    #[ignore = "slow: `make check` leaves it to `make test`"]
    fn parts_at_nodes_are_those_of_cut_fields() {
        let atmosphere = Atmosphere::new(Turbidity::new(3.0).unwrap());
        let distance_m = [2_000.0, 30_000.0];
        let multiple = MultipleAxes { distance_m: distance_m.to_vec(), ..MultipleAxes::coarse(0.15) };
        let axes = LaterAxes {
            ground_altitude_m: vec![0.0],
            offset_m: vec![-1_500.0, 0.0],
            column: vec![0, 16, 64, 128],
            field_resolution: FieldResolution::Coarse,
        };
        let table = MultipleTable::solve(atmosphere, &multiple, |_, _| None, |_, _, _| Ok(())).unwrap();
        let later =
            LaterParts::solve(atmosphere, &multiple, &axes, &distance_m, |_, _| None, |_, _, _| Ok(()))
                .unwrap();
        let resolution = axes.field_resolution.resolution();
        let setting = SourceSetting::new(atmosphere, 0.0, 0.0, 0.15).unwrap();
        let open = SourceField::solve(setting, &resolution);
        let angle = 4;
        let cut = SourceField::solve(setting.behind(blocking_deg(angle).to_radians()).unwrap(), &resolution);
        for (distance, observer_m) in [(0, 0.0), (1, 0.0), (1, 1_500.0)] {
            let geometry = SourceGeometry {
                distance_m: distance_m[distance],
                source_altitude_m: 0.0,
                observer_altitude_m: observer_m,
            };
            let mut open_images = vec![0.0; IMAGE_COUNT * PIXEL_COUNT];
            table.add_to(&geometry, &mut open_images);
            let mut images = vec![0.0; IMAGE_COUNT * PIXEL_COUNT];
            later.add_to(&table, &geometry, angle, distance, &mut images);
            for (row, column) in [(0, 0), (10, 64), (63, 128), (30, 16)] {
                let see = |field: &SourceField| {
                    let rays = ViewRow::new(field, observer_m, elevation_rad(row)).unwrap();
                    rays.radiance_per_watt(geometry.distance_m, azimuth_rad(column))
                };
                let (cut, open) = (see(&cut), see(&open));
                for band in 0..BAND_COUNT {
                    for lobe in 0..LOBE_COUNT {
                        let sample = crate::layout::image_index(lobe, band) * PIXEL_COUNT
                            + row * HALF_COLUMN_COUNT
                            + column;
                        let part = (cut[band][lobe] / open[band][lobe]).min(1.0);
                        let got = images[sample] / open_images[sample];
                        assert!((got / part - 1.0).abs() < 1e-3, "{distance} {row} {column}: {got} {part}");
                        // The low lobe loses most, the steep one nothing below 30°: no two could be exchanged.
                        assert!(lobe != 1 || part < 0.9, "{part}");
                        assert!(lobe != 2 || part > 0.98, "{part}");
                    }
                }
            }
        }
    }
}
