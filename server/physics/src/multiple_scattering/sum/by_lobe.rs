//! The sum of later orders with each lobe separate, for several observers in the same air: fields of sources no higher
//! than the observer do not depend on the observer and are cached.

use super::{
    density::{DARKNESS_PER_M2_SR, SumDensity},
    open_altitudes::OpenAltitudes,
    tables::{FieldWeights, LogTable, SampleAxes},
};
use crate::{
    atmosphere::Atmosphere,
    bands::BAND_COUNT,
    emission::LOBE_COUNT,
    error::PhysicsError,
    multiple_scattering::{Resolution, SourceField, SourceSetting},
    panorama::Direction,
    single_source::{OUTPUT_COUNT, RadiancePerWatt},
    source_pixel::PointSource,
};
use rayon::prelude::*;
use std::collections::BTreeMap;

/// Fields in one air over one kind of ground, some tens of megabytes each.
#[derive(Clone, Debug)]
pub struct FieldCache {
    atmosphere: Atmosphere,
    ground_albedo: f64,
    resolution: Resolution,
    density: SumDensity,
    /// Of sources that stand on the ground, by the bits of their altitude.
    on_ground: BTreeMap<u64, SourceField>,
    solved_count: usize,
}

impl FieldCache {
    /// None yet, in air without clouds: below a base sources would have to be clamped. `density` is that of
    /// [`super::MultipleSum`].
    pub fn new(
        atmosphere: Atmosphere,
        ground_albedo: f64,
        resolution: Resolution,
        density: SumDensity,
    ) -> Self {
        let on_ground = BTreeMap::new();
        Self { atmosphere, ground_albedo, resolution, density, on_ground, solved_count: 0 }
    }

    /// How many fields were solved so far.
    pub fn solved_count(&self) -> usize {
        self.solved_count
    }

    /// Radiance of orders two and more at each direction, `[direction][band][lobe]`: Σ Φ·b over the sources, all under an
    /// open sky, in W m⁻² sr⁻¹ for flux in watts of the band.
    ///
    /// Altitudes of sources are those of [`super::MultipleSum`].
    ///
    /// # Errors
    /// [`PhysicsError::OutOfRange`] for an altitude or albedo outside the solver's ranges, or an elevation below 0.
    pub fn radiance_by_lobe_w_m2_sr(
        &mut self,
        sources: &[PointSource],
        observer_altitude_m: f64,
        directions: &[Direction],
    ) -> Result<Vec<RadiancePerWatt>, PhysicsError> {
        let mut rows: Vec<f64> = directions.iter().map(|direction| direction.elevation_rad).collect();
        rows.sort_by(f64::total_cmp);
        rows.dedup();
        if sources.is_empty() {
            return Ok(vec![[[0.0; LOBE_COUNT]; BAND_COUNT]; directions.len()]);
        }
        let altitudes = sources.iter().map(|source| source.altitude_m);
        let nodes = OpenAltitudes::new(altitudes, observer_altitude_m, self.density.altitude_step_m);
        let mut table: LogTable<OUTPUT_COUNT> =
            LogTable::new(SampleAxes::new(&self.density), rows.len(), nodes.altitude_m.len());
        for (place, &altitude_m) in nodes.altitude_m.iter().enumerate() {
            let alone;
            let field = if altitude_m <= observer_altitude_m {
                self.on_ground(altitude_m)?
            } else {
                alone = self.solve(altitude_m, observer_altitude_m)?;
                &alone
            };
            table.enter(place, field, observer_altitude_m, &rows, log_of)?;
        }
        let weights: Vec<FieldWeights> =
            sources.iter().map(|source| nodes.stencil(source.altitude_m).iter().collect()).collect();
        Ok(directions
            .par_iter()
            .map(|direction| {
                let row = rows.partition_point(|&elevation| elevation < direction.elevation_rad);
                let mut sum = [[0.0; LOBE_COUNT]; BAND_COUNT];
                for (source, weights) in sources.iter().zip(&weights) {
                    let log = table.log_at(row, weights, source, direction.azimuth_rad);
                    for (sum, log) in sum.as_flattened_mut().iter_mut().zip(log) {
                        *sum += source.flux_dnb_w * log.exp();
                    }
                }
                sum
            })
            .collect())
    }

    fn on_ground(&mut self, altitude_m: f64) -> Result<&SourceField, PhysicsError> {
        let key = altitude_m.to_bits();
        if !self.on_ground.contains_key(&key) {
            let solved = self.solve(altitude_m, altitude_m)?;
            self.on_ground.insert(key, solved);
        }
        Ok(&self.on_ground[&key])
    }

    fn solve(&mut self, source_altitude_m: f64, ground_altitude_m: f64) -> Result<SourceField, PhysicsError> {
        let setting =
            SourceSetting::new(self.atmosphere, source_altitude_m, ground_altitude_m, self.ground_albedo)?;
        self.solved_count += 1;
        Ok(SourceField::solve(setting, &self.resolution))
    }
}

/// ln of every band and lobe.
fn log_of(radiance: RadiancePerWatt) -> [f32; OUTPUT_COUNT] {
    let flat = radiance.as_flattened();
    std::array::from_fn(|output| flat[output].max(DARKNESS_PER_M2_SR).ln() as f32)
}

#[cfg(test)]
mod tests {
    use super::{super::MultipleSum, *};
    use crate::{EmissionMix, Lobe, Turbidity, direct_sum::grid_direction};

    /// Separate lobes are those of the sum, and fields below observers are solved once.
    #[test]
    #[ignore = "slow: `make check` leaves it to `make test`"]
    fn separate_lobes_add_up_and_fields_are_reused() {
        let atmosphere = Atmosphere::new(Turbidity::new(2.0).unwrap());
        let (resolution, density) = (Resolution::coarse(), SumDensity::default());
        let source = |azimuth_rad: f64, distance_m: f64, altitude_m: f64| PointSource {
            azimuth_rad,
            distance_m,
            altitude_m,
            flux_dnb_w: 2e6,
        };
        let sources =
            [source(0.3, 4_000.0, 150.0), source(2.0, 40_000.0, 150.0), source(5.0, 9_000.0, 620.0)];
        let directions = [(0, 10), (9, 200), (63, 0)].map(grid_direction);
        let mut kept = FieldCache::new(atmosphere, 0.15, resolution, density);
        let mut by_lobe = |observer_altitude_m: f64| {
            kept.radiance_by_lobe_w_m2_sr(&sources, observer_altitude_m, &directions).unwrap()
        };
        let (low, high) = (by_lobe(400.0), by_lobe(800.0));
        // 150 m for both, 620 m over the ground of the low observer, and over its own.
        assert_eq!(kept.solved_count(), 3);
        for (observer_altitude_m, by_lobe) in [(400.0, &low), (800.0, &high)] {
            for lobe in Lobe::ALL {
                let emission = EmissionMix::only(lobe);
                let sum = MultipleSum {
                    atmosphere,
                    ground_albedo: 0.15,
                    observer_altitude_m,
                    emission,
                    resolution,
                    density,
                };
                let whole = sum.radiance(&sources, [1.0; BAND_COUNT], &directions).unwrap();
                for (bands, lobes) in whole.iter().zip(by_lobe) {
                    for (band, value) in bands.iter().enumerate() {
                        assert!((lobes[band][lobe.index()] / value - 1.0).abs() < 1e-6, "{lobe:?} {band}");
                    }
                }
            }
        }
        // The control: another observer sees another sky.
        assert!((low[2][1][0] / high[2][1][0] - 1.0).abs() > 0.01);
    }
}
