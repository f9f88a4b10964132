//! The truth with all orders: what orders two and more add to the direct sum.
//!
//! The same sum over every source (paper Eq. 3), with each source's light from a table solved for this very
//! observer altitude: dense over the altitude of the source, over distance and over azimuth (a test halves the
//! steps). Nothing of a pack is in it but the solver.

use super::{LEAST_BELOW_BASE_M, Resolution, SourceField, SourceSetting, ViewRow};
use crate::{
    atmosphere::Atmosphere,
    bands::BAND_COUNT,
    cloud::CloudBase,
    emission::EmissionMix,
    error::PhysicsError,
    interpolation::lagrange_taps,
    panorama::Direction,
    single_source::RadiancePerWatt,
    source_pixel::{FARTHEST_SOURCE_M, NEAREST_SOURCE_M, PointSource},
};
use rayon::prelude::*;
use std::f64::consts::PI;

/// Radiance that stands for darkness, m⁻² sr⁻¹ per watt.
const DARKNESS_PER_M2_SR: f64 = 1e-36;
/// Nodes that an interpolation uses.
const TAPS: usize = 4;
/// Azimuth nodes are this power of an even share of the half turn.
const AZIMUTH_CROWDING: f64 = 1.7;

/// How dense the tables of a sum are.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SumDensity {
    /// Largest step between altitudes of sources, metres.
    pub altitude_step_m: f64,
    /// Distances from 250 m to 300 km, even in the logarithm.
    pub distances: usize,
    /// Azimuths of a half turn, crowding at the source's.
    pub azimuths: usize,
}

impl Default for SumDensity {
    fn default() -> Self {
        Self { altitude_step_m: 300.0, distances: 72, azimuths: 41 }
    }
}

/// The sum over all orders beyond the first for one observer.
#[derive(Clone, Debug)]
pub struct MultipleSum {
    /// The air.
    pub atmosphere: Atmosphere,
    /// Lambertian albedo of the ground, 0..=1.
    pub ground_albedo: f64,
    /// Altitude of the observer, metres.
    pub observer_altitude_m: f64,
    /// Directions of the sources' light.
    pub emission: EmissionMix,
    /// How finely fields are solved.
    pub resolution: Resolution,
    /// How dense their tables are.
    pub density: SumDensity,
}

/// ln of what the observer sees of single sources [m⁻² sr⁻¹ per watt].
struct Dense {
    altitude_m: Vec<f64>,
    log_distance: Vec<f64>,
    azimuth_rad: Vec<f64>,
    /// `[row][altitude][distance][azimuth]`
    log: Vec<[f32; BAND_COUNT]>,
}

impl MultipleSum {
    /// Radiance [W m⁻² sr⁻¹] of orders two and more at each direction: the part that
    /// [`crate::direct_sum::direct_sum`] leaves out. `flux_per_dnb_flux` is the lamp's s_b.
    ///
    /// Solves one field for every altitude of sources: seconds each. Without sources nothing is solved.
    ///
    /// Under a cloud, sources at or above the base are dark and so is everything to an observer there; a source less
    /// than [`LEAST_BELOW_BASE_M`] below the base counts as that far below it.
    ///
    /// # Errors
    /// [`PhysicsError::OutOfRange`] for an altitude or albedo outside the solver's ranges, or an elevation below 0.
    pub fn radiance(
        &self,
        sources: &[PointSource],
        flux_per_dnb_flux: [f64; BAND_COUNT],
        directions: &[Direction],
    ) -> Result<Vec<[f64; BAND_COUNT]>, PhysicsError> {
        let base_m = self.atmosphere.cloud().map_or(f64::INFINITY, CloudBase::altitude_m);
        let lit: Vec<PointSource> =
            sources.iter().filter(|source| source.altitude_m < base_m).copied().collect();
        if lit.is_empty() || self.observer_altitude_m >= base_m {
            return Ok(vec![[0.0; BAND_COUNT]; directions.len()]);
        }
        let mut rows: Vec<f64> = directions.iter().map(|direction| direction.elevation_rad).collect();
        rows.sort_by(f64::total_cmp);
        rows.dedup();
        let dense = self.solve(altitude_nodes(&lit, base_m, self.density.altitude_step_m), &rows)?;
        Ok(directions
            .par_iter()
            .map(|direction| {
                let row = rows.partition_point(|&elevation| elevation < direction.elevation_rad);
                let mut sum = [0.0; BAND_COUNT];
                for source in &lit {
                    let per_watt = dense.radiance_per_watt(row, source, direction.azimuth_rad);
                    for band in 0..BAND_COUNT {
                        sum[band] += source.flux_dnb_w * flux_per_dnb_flux[band] * per_watt[band];
                    }
                }
                sum
            })
            .collect())
    }

    fn solve(&self, altitude_m: Vec<f64>, rows: &[f64]) -> Result<Dense, PhysicsError> {
        let ratio = FARTHEST_SOURCE_M / NEAREST_SOURCE_M;
        let share = |k: usize, count: usize| k as f64 / (count - 1) as f64;
        let distance_m: Vec<f64> = (0..self.density.distances)
            .map(|k| NEAREST_SOURCE_M * ratio.powf(share(k, self.density.distances)))
            .collect();
        let azimuth_rad: Vec<f64> = (0..self.density.azimuths)
            .map(|k| PI * share(k, self.density.azimuths).powf(AZIMUTH_CROWDING))
            .collect();
        let per_altitude = distance_m.len() * azimuth_rad.len();
        let mut log = vec![[0.0; BAND_COUNT]; rows.len() * altitude_m.len() * per_altitude];
        for (altitude, &source_altitude_m) in altitude_m.iter().enumerate() {
            let setting = SourceSetting::for_observer(
                self.atmosphere,
                source_altitude_m,
                self.observer_altitude_m,
                self.ground_albedo,
            )?;
            let field = SourceField::solve(setting, &self.resolution);
            let parts = log.par_chunks_mut(altitude_m.len() * per_altitude);
            parts.zip(rows).try_for_each(|(part, &elevation_rad)| {
                let rays = ViewRow::new(&field, self.observer_altitude_m, elevation_rad)?;
                let mut values = part[altitude * per_altitude..(altitude + 1) * per_altitude].iter_mut();
                for &distance_m in &distance_m {
                    for (&azimuth_rad, value) in azimuth_rad.iter().zip(values.by_ref()) {
                        *value = self.log_of(rays.radiance_per_watt(distance_m, azimuth_rad));
                    }
                }
                Ok::<(), PhysicsError>(())
            })?;
        }
        let log_distance = distance_m.iter().map(|d| d.ln()).collect();
        Ok(Dense { altitude_m, log_distance, azimuth_rad, log })
    }

    /// ln of the mix of lobes.
    fn log_of(&self, radiance: RadiancePerWatt) -> [f32; BAND_COUNT] {
        radiance.map(|lobes| {
            let mixed: f64 =
                lobes.iter().zip(self.emission.weights()).map(|(value, weight)| value * weight).sum();
            mixed.max(DARKNESS_PER_M2_SR).ln() as f32
        })
    }
}

/// Altitudes of sources, metres, from the lowest to the highest in equal steps, all of them so far below a base that
/// fields are solved for them.
fn altitude_nodes(sources: &[PointSource], base_m: f64, step_m: f64) -> Vec<f64> {
    let (lowest, highest) = sources.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), source| {
        let altitude_m = source.altitude_m.min(base_m - LEAST_BELOW_BASE_M);
        (low.min(altitude_m), high.max(altitude_m))
    });
    let steps = ((highest - lowest) / step_m).ceil();
    if steps < 1.0 {
        return vec![lowest];
    }
    (0..=steps as usize).map(|k| lowest + (highest - lowest) * k as f64 / steps).collect()
}

impl Dense {
    fn radiance_per_watt(&self, row: usize, source: &PointSource, azimuth_rad: f64) -> [f64; BAND_COUNT] {
        // Azimuth from the source's, folded to 0..=π: the sky is even.
        let turn = (azimuth_rad - source.azimuth_rad).rem_euclid(2.0 * PI);
        let azimuths = lagrange_taps(&self.azimuth_rad, turn.min(2.0 * PI - turn), TAPS);
        let distances = lagrange_taps(&self.log_distance, source.distance_m.ln(), TAPS);
        let mut sum = [0.0; BAND_COUNT];
        for (altitude, altitude_weight) in lagrange_taps(&self.altitude_m, source.altitude_m, TAPS) {
            for &(distance, distance_weight) in &distances {
                let start = ((row * self.altitude_m.len() + altitude) * self.log_distance.len() + distance)
                    * self.azimuth_rad.len();
                for &(azimuth, azimuth_weight) in &azimuths {
                    let weight = altitude_weight * distance_weight * azimuth_weight;
                    for (sum, &log) in sum.iter_mut().zip(&self.log[start + azimuth]) {
                        *sum += weight * f64::from(log);
                    }
                }
            }
        }
        sum.map(f64::exp)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        Turbidity,
        panorama::{azimuth_rad, elevation_rad},
    };

    fn sum(
        density: &SumDensity,
        sources: &[PointSource],
        directions: &[Direction],
    ) -> Vec<[f64; BAND_COUNT]> {
        let sum = MultipleSum {
            atmosphere: Atmosphere::new(Turbidity::new(2.0).unwrap()),
            ground_albedo: 0.15,
            observer_altitude_m: 800.0,
            emission: EmissionMix::garstang(),
            resolution: Resolution::coarse(),
            density: *density,
        };
        sum.radiance(sources, [1.0; BAND_COUNT], directions).unwrap()
    }

    #[test]
    fn halving_its_steps_hardly_moves_the_sum() {
        let sources: Vec<PointSource> = (0..40)
            .map(|i| {
                let spread = |ratio: f64| (f64::from(i) * ratio).fract();
                PointSource {
                    azimuth_rad: 6.0 * spread(0.82),
                    distance_m: 2_000.0 * 80f64.powf(spread(0.67)),
                    altitude_m: 1_100.0 * spread(0.55),
                    flux_dnb_w: 1e6,
                }
            })
            .collect();
        let directions = [(0, 10), (3, 200), (20, 90), (63, 0)].map(|(row, column)| Direction {
            azimuth_rad: azimuth_rad(column),
            elevation_rad: elevation_rad(row),
        });
        let default = sum(&SumDensity::default(), &sources, &directions);
        let with = |density: &SumDensity| {
            let other = sum(density, &sources, &directions);
            let pairs = default.iter().flatten().zip(other.iter().flatten());
            pairs.map(|(a, b)| (b / a - 1.0).abs()).fold(0.0, f64::max)
        };
        let used = SumDensity::default();
        assert!(with(&SumDensity { azimuths: 81, ..used }) < 1e-3);
        assert!(with(&SumDensity { distances: 143, ..used }) < 3e-3);
        // Coarse fields of neighbouring altitudes differ by more than what lies between them does.
        assert!(with(&SumDensity { altitude_step_m: 150.0, ..used }) < 0.025);
        // The checks can fail.
        assert!(with(&SumDensity { azimuths: 7, ..used }) > 5e-3);
        assert!(with(&SumDensity { altitude_step_m: 1e4, ..used }) > 0.1);
    }

    #[test]
    fn a_sky_without_sources_is_dark() {
        let directions = [Direction { azimuth_rad: 0.0, elevation_rad: 0.5 }];
        assert_eq!(sum(&SumDensity::default(), &[], &directions), [[0.0; BAND_COUNT]]);
    }
}
