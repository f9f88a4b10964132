//! The first order of one light next to its own direction, in f32, some directions at a time.

use crate::cpu::dispatch::exponential;
use skyglow_physics::{
    Atmosphere, BAND_COUNT, EARTH_RADIUS_M,
    atmosphere::{AEROSOL_ALBEDO, AEROSOL_SCALE_HEIGHT_M, MOLECULE_SCALE_HEIGHT_M},
    near_light::NearScattering,
};

/// A ray is not taken to pass a light nearer than this part of the light's distance: a point is infinitely bright.
const NEAREST_MISS: f32 = 1e-4;
/// Largest power of e by which air is thicker or thinner than at the light.
const LARGEST_LOG_DENSITY: f32 = 8.0;

/// The air and the lamps of a request.
pub(super) struct Air {
    scattering: NearScattering,
    observer_altitude_m: f64,
    /// β at z = 0, `[molecules, aerosol][band]`, m⁻¹.
    extinction_per_m: [[f64; BAND_COUNT]; 2],
}

impl Air {
    pub(super) fn new(scattering: NearScattering, air: &Atmosphere, observer_altitude_m: f64) -> Self {
        let extinction_per_m = [air.molecule_extinction_per_m(), air.aerosol_extinction_per_m()];
        Self { scattering, observer_altitude_m, extinction_per_m }
    }
}

impl Air {
    /// Extinction at an altitude, m⁻¹: below it none is less.
    pub(super) fn least_lost_per_m(&self, altitude_m: f64) -> [f32; BAND_COUNT] {
        let [of_molecules, of_aerosol] = self.extinction_per_m;
        let density =
            [MOLECULE_SCALE_HEIGHT_M, AEROSOL_SCALE_HEIGHT_M].map(|height_m| (-altitude_m / height_m).exp());
        std::array::from_fn(|band| (density[0] * of_molecules[band] + density[1] * of_aerosol[band]) as f32)
    }

    /// No less than the radiance of a light per watt, in each band, times its distance and the sine of the angle past it, m⁻¹ sr⁻¹:
    /// for lights at `lowest_m` and above, without what the air between takes.
    pub(super) fn most_per_m(&self, lowest_m: f64) -> [f32; BAND_COUNT] {
        let [molecules, aerosol] = self.scattering.largest().map(f64::from);
        let density =
            [MOLECULE_SCALE_HEIGHT_M, AEROSOL_SCALE_HEIGHT_M].map(|height_m| (-lowest_m / height_m).exp());
        let [of_molecules, of_aerosol] = self.extinction_per_m;
        std::array::from_fn(|band| {
            let molecules = molecules * density[0] * of_molecules[band];
            (molecules + aerosol * density[1] * AEROSOL_ALBEDO * of_aerosol[band]) as f32
        })
    }
}

/// A light as the observer sees it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Sight {
    /// Where it is: metres along its azimuth and up from the observer's horizontal plane.
    across_m: f32,
    up_m: f32,
    /// Square of the nearest miss, m².
    nearest_miss_m2: f32,
    /// Sine and cosine of the arc to it: by so much its vertical is turned.
    arc: [f32; 2],
    /// ω·β at the light times what gets through to the observer, `[band][molecules, aerosol]`, m⁻¹.
    strength_per_m: [[f32; 2]; BAND_COUNT],
}

/// e^x with x held within ±8: no air of the model is thicker or thinner.
#[inline(always)]
pub(super) fn density(log: f32) -> f32 {
    exponential::<false>(log.clamp(-LARGEST_LOG_DENSITY, LARGEST_LOG_DENSITY))
}

impl Sight {
    /// A light at a distance along the ground, `offset_m` above the observer.
    pub(super) fn new(air: &Air, distance_m: f64, offset_m: f64) -> Self {
        let arc = distance_m / EARTH_RADIUS_M;
        let altitude_m = air.observer_altitude_m + offset_m;
        let radius_m = EARTH_RADIUS_M + altitude_m;
        let (across_m, up_m) =
            (radius_m * arc.sin(), offset_m - 2.0 * radius_m * (0.5 * arc).sin() * (0.5 * arc).sin());
        let slant_m = across_m.hypot(up_m);
        let heights = [MOLECULE_SCALE_HEIGHT_M, AEROSOL_SCALE_HEIGHT_M];
        let middle_m = 0.5 * (altitude_m + air.observer_altitude_m);
        let thin = |altitude_m: f64, height_m: f64| f64::from(density((-altitude_m / height_m) as f32));
        let middle: [f64; 2] = heights.map(|height_m| thin(middle_m, height_m));
        let here: [f64; 2] = heights.map(|height_m| thin(altitude_m, height_m));
        let strength_per_m = std::array::from_fn(|band| {
            let [molecules, aerosol] = air.extinction_per_m.map(|of_bands| of_bands[band]);
            let through = ((-slant_m * (molecules * middle[0] + aerosol * middle[1])) as f32).exp();
            let [molecules, aerosol] = [molecules * here[0], AEROSOL_ALBEDO * aerosol * here[1]];
            [through * molecules as f32, through * aerosol as f32]
        });
        Self {
            across_m: across_m as f32,
            up_m: up_m as f32,
            nearest_miss_m2: (f64::from(NEAREST_MISS) * slant_m).powi(2) as f32,
            arc: [arc.sin() as f32, arc.cos() as f32],
            strength_per_m,
        }
    }

    /// Its elevation, radians.
    pub(super) fn elevation_rad(&self) -> f32 {
        self.up_m.atan2(self.across_m)
    }

    /// Radiance per watt in each band, m⁻² sr⁻¹, `[band][direction]`, at one elevation (sine and cosine) and azimuths relative to its own
    /// (cosines, sines).
    #[inline(always)]
    pub(super) fn radiance<const FUSED: bool, const N: usize>(
        &self,
        air: &Air,
        [sin_elevation, cos_elevation]: [f32; 2],
        [cos_azimuth, sin_azimuth]: [&[f32; N]; 2],
    ) -> [[f32; N]; BAND_COUNT] {
        let [sin_arc, cos_arc] = self.arc;
        let mut across = [0f32; N];
        let mut along = [0f32; N];
        let mut per_miss = [0f32; N];
        let mut density = [[0f32; N]; 2];
        for lane in 0..N {
            let (x, y) = (cos_elevation * cos_azimuth[lane], cos_elevation * sin_azimuth[lane]);
            let z = sin_elevation;
            // |S × v|, without the difference of two long vectors.
            let cross = [self.up_m * y, self.up_m * x - self.across_m * z, self.across_m * y];
            let miss2 =
                (cross[0] * cross[0] + cross[1] * cross[1] + cross[2] * cross[2]).max(self.nearest_miss_m2);
            per_miss[lane] = 1.0 / miss2.sqrt();
            // n·miss = (S·v)v − S = v × (v × S), with v × S = −cross in another order.
            let out =
                [y * cross[2] - z * cross[1], -z * cross[0] - x * cross[2], x * cross[1] + y * cross[0]];
            let up_m = -(out[0] * sin_arc + out[2] * cos_arc);
            across[lane] = up_m * per_miss[lane];
            along[lane] = x * sin_arc + z * cos_arc;
            let clamp = |x: f32| x.clamp(-LARGEST_LOG_DENSITY, LARGEST_LOG_DENSITY);
            density[0][lane] = exponential::<FUSED>(clamp(-up_m * (1.0 / MOLECULE_SCALE_HEIGHT_M as f32)));
            density[1][lane] = exponential::<FUSED>(clamp(-up_m * (1.0 / AEROSOL_SCALE_HEIGHT_M as f32)));
        }
        let mut scattered = [[0f32; N]; 2];
        for lane in 0..N {
            let of_species = air.scattering.at(across[lane], along[lane]);
            for species in 0..2 {
                scattered[species][lane] = of_species[species] * density[species][lane] * per_miss[lane];
            }
        }
        let mut radiance = [[0f32; N]; BAND_COUNT];
        for (radiance, [molecules, aerosol]) in radiance.iter_mut().zip(self.strength_per_m) {
            for lane in 0..N {
                radiance[lane] = molecules * scattered[0][lane] + aerosol * scattered[1][lane];
            }
        }
        radiance
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use skyglow_physics::{
        EmissionMix, Lobe, Turbidity,
        single_source::{SourceGeometry, mixed_radiance_per_watt},
    };

    fn one(sight: &Sight, air: &Air, azimuth_rad: f64, elevation_rad: f64) -> [f64; BAND_COUNT] {
        let (cosines, sines) = ([azimuth_rad.cos() as f32], [azimuth_rad.sin() as f32]);
        let elevation = [elevation_rad.sin() as f32, elevation_rad.cos() as f32];
        sight.radiance::<false, 1>(air, elevation, [&cosines, &sines]).map(|of_band| f64::from(of_band[0]))
    }

    #[test]
    fn next_to_a_light_it_is_the_first_order() {
        for turbidity in [1.5, 2.5, 6.0] {
            let atmosphere = Atmosphere::new(Turbidity::new(turbidity).unwrap());
            for emission in
                [EmissionMix::garstang(), EmissionMix::lambert(), EmissionMix::only(Lobe::Horizon)]
            {
                let air = Air::new(NearScattering::of(emission), &atmosphere, 300.0);
                let (mut sum, mut worst, mut count) = (0.0, 0f64, 0.0);
                // Three optical depths away hardly anything is left of a peak.
                let farthest_m = 3.0 / (atmosphere.aerosol_extinction_per_m()[1] + 1e-5);
                for distance_m in [400.0, 2_000.0, 9_000.0, 25_000.0].into_iter().filter(|m| *m < farthest_m)
                {
                    for climb in [-0.003, 0.0, 0.05, 0.2] {
                        let offset_m = climb * distance_m;
                        let sight = Sight::new(&air, distance_m, offset_m);
                        let geometry = SourceGeometry {
                            distance_m,
                            source_altitude_m: 300.0 + offset_m,
                            observer_altitude_m: 300.0,
                        };
                        // Above and beside it, half a degree to two away.
                        for (aside_deg, above_deg) in [(0.5f64, 0.7f64), (0.1, 0.7), (1.4, 1.0), (0.0, 1.6)] {
                            let elevation =
                                (f64::from(sight.elevation_rad()) + above_deg.to_radians()).max(0.012);
                            let azimuth = aside_deg.to_radians();
                            let exact: [f64; BAND_COUNT] = mixed_radiance_per_watt(
                                &[atmosphere],
                                &geometry,
                                emission,
                                azimuth,
                                elevation,
                                1e-5,
                            );
                            let got = one(&sight, &air, azimuth, elevation);
                            for (got, exact) in got.iter().zip(exact) {
                                let error = (got / exact - 1.0).abs();
                                (sum, worst, count) = (sum + error, worst.max(error), count + 1.0);
                            }
                        }
                    }
                }
                println!("{turbidity} {:?}: mean {:.3}, worst {worst:.3}", emission.weights(), sum / count);
                assert!(sum / count < 0.12 && worst < 0.7, "{turbidity}: {} {worst}", sum / count);
            }
        }
    }

    #[test]
    fn it_is_even_in_azimuth_and_falls_as_one_over_the_angle() {
        let atmosphere = Atmosphere::new(Turbidity::default());
        let air = Air::new(NearScattering::of(EmissionMix::only(Lobe::Horizon)), &atmosphere, 0.0);
        let sight = Sight::new(&air, 5_000.0, 0.0);
        let at = |azimuth_rad: f64| one(&sight, &air, azimuth_rad, 0.002)[1];
        assert!((at(0.03) / at(-0.03) - 1.0).abs() < 1e-5);
        assert!((at(0.02) / at(0.04) / 2.0 - 1.0).abs() < 0.1, "{}", at(0.02) / at(0.04));
    }
}
