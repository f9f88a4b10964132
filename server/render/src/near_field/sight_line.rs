//! The first order of one light next to its own direction, in f32, some directions at a time: the closed form of
//! [`skyglow_physics::near_light`] with optical depths by Simpson's rule.

use super::air::{Air, HEIGHTS_M, MAX_LOG_DENSITY, density};
use crate::cpu::lanes::exponential;
use skyglow_physics::{BAND_COUNT, EARTH_RADIUS_M};
use std::f32::consts::{FRAC_PI_2, FRAC_PI_4};

/// A ray is not taken to pass a light nearer than this part of the light's distance: a point is infinitely bright.
const MIN_MISS: f64 = 1e-4;

/// A light as the observer sees it.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct SightLine {
    /// Where it is: metres along its azimuth and up from the observer's horizontal plane.
    across_m: f32,
    up_m: f32,
    /// Square of the nearest miss, m².
    nearest_miss_m2: f32,
    /// Sine and cosine of the arc to it: by so much its vertical is turned.
    arc: [f32; 2],
    /// e^{−z/H} at it, `[molecules, aerosol]`.
    density: [f32; 2],
}

/// Of tan⁻¹(y)/y in powers of y² up to 22.5°, by least squares at Chebyshev's nodes: within 3e-8.
const ARC_TANGENT: [f32; 5] = [1.0, -0.333_332_88, 0.199_913_94, -0.140_265_5, 0.085_297_92];

/// The arc tangent, to 2e-7: around 0, 1 and infinity, without branches, so that loops stay vectors.
#[inline(always)]
fn arc_tangent(x: f32) -> f32 {
    /// Tangents of 22.5° and 67.5°.
    const BOUNDS: [f32; 2] = [0.414_213_57, 2.414_213_7];
    let size = x.abs();
    let (around, over, under) = if size > BOUNDS[1] {
        (FRAC_PI_2, -1.0, size)
    } else if size > BOUNDS[0] {
        (FRAC_PI_4, size - 1.0, size + 1.0)
    } else {
        (0.0, size, 1.0)
    };
    let y = over / under;
    let square = y * y;
    let series = ARC_TANGENT.iter().rev().fold(0.0, |sum, factor| factor + square * sum);
    (around + y * series).copysign(x)
}

impl SightLine {
    /// A light at a distance along the ground, `offset_m` above the observer.
    #[inline(always)]
    pub(crate) fn new(air: &Air, distance_m: f64, offset_m: f64) -> Self {
        SightLines::<1>::new(air, &[distance_m], &[offset_m]).alone(0)
    }

    /// [`SightLines::transmittance`] of one light for rays of some elevations (sines, cosines).
    #[inline(always)]
    pub(crate) fn transmittance<const FUSED: bool, const N: usize>(
        &self,
        air: &Air,
        rays: [&[f32; N]; 2],
    ) -> [[f32; N]; BAND_COUNT] {
        SightLines::all(self).transmittance::<FUSED>(air, rays)
    }

    /// [`SightLines::radiance`] of one light at one elevation (sine and cosine) and some azimuths relative to its own (cosines, sines);
    /// `transmittance` is that of [`Self::transmittance`] at the elevation.
    #[inline(always)]
    pub(crate) fn radiance<const FUSED: bool, const N: usize>(
        &self,
        air: &Air,
        transmittance: [f32; BAND_COUNT],
        [sin_elevation, cos_elevation]: [f32; 2],
        azimuths: [&[f32; N]; 2],
    ) -> [[f32; N]; BAND_COUNT] {
        let elevations = [&[sin_elevation; N], &[cos_elevation; N]];
        SightLines::all(self).radiance::<FUSED>(
            air,
            transmittance.map(|transmittance| [transmittance; N]),
            elevations,
            azimuths,
        )
    }
}

/// Some lights side by side, or one of them for some rays.
pub(crate) struct SightLines<const N: usize> {
    across_m: [f32; N],
    up_m: [f32; N],
    nearest_miss_m2: [f32; N],
    arc: [[f32; N]; 2],
    density: [[f32; N]; 2],
}

impl<const N: usize> SightLines<N> {
    /// One light in every lane.
    #[inline(always)]
    fn all(sight_line: &SightLine) -> Self {
        Self {
            across_m: [sight_line.across_m; N],
            up_m: [sight_line.up_m; N],
            nearest_miss_m2: [sight_line.nearest_miss_m2; N],
            arc: sight_line.arc.map(|of_arc| [of_arc; N]),
            density: sight_line.density.map(|density| [density; N]),
        }
    }

    /// Lights at distances along the ground, `offset_m` above the observer.
    #[inline(always)]
    pub(crate) fn new(air: &Air, distance_m: &[f64; N], offset_m: &[f64; N]) -> Self {
        let mut sight_lines = Self {
            across_m: [0.0; N],
            up_m: [0.0; N],
            nearest_miss_m2: [0.0; N],
            arc: [[0.0; N]; 2],
            density: [[0.0; N]; 2],
        };
        for lane in 0..N {
            let arc = distance_m[lane] / EARTH_RADIUS_M;
            let altitude_m = air.observer_altitude_m + offset_m[lane];
            let radius_m = EARTH_RADIUS_M + altitude_m;
            // Over a twentieth of a radian the series are right to 1e-10.
            let square = arc * arc;
            let sin = arc * (1.0 - square * (1.0 / 6.0 - square * (1.0 / 120.0)));
            let less = 0.5 * square * (1.0 - square * (1.0 / 12.0 - square * (1.0 / 360.0)));
            let (across_m, up_m) = (radius_m * sin, offset_m[lane] - radius_m * less);
            let slant2_m2 = across_m * across_m + up_m * up_m;
            sight_lines.across_m[lane] = across_m as f32;
            sight_lines.up_m[lane] = up_m as f32;
            sight_lines.nearest_miss_m2[lane] = (MIN_MISS * MIN_MISS * slant2_m2) as f32;
            (sight_lines.arc[0][lane], sight_lines.arc[1][lane]) = (sin as f32, (1.0 - less) as f32);
            for (of_species, height_m) in sight_lines.density.iter_mut().zip(HEIGHTS_M) {
                of_species[lane] = density(-altitude_m as f32 / height_m);
            }
        }
        sight_lines
    }

    /// One of them.
    #[inline(always)]
    pub(crate) fn alone(&self, lane: usize) -> SightLine {
        SightLine {
            across_m: self.across_m[lane],
            up_m: self.up_m[lane],
            nearest_miss_m2: self.nearest_miss_m2[lane],
            arc: self.arc.map(|of_lanes| of_lanes[lane]),
            density: self.density.map(|of_lanes| of_lanes[lane]),
        }
    }

    /// Their elevations, radians, to 3e-7.
    #[inline(always)]
    pub(crate) fn elevations_rad(&self) -> [f32; N] {
        std::array::from_fn(|lane| arc_tangent(self.up_m[lane] / self.across_m[lane]))
    }

    /// Sines and cosines of their elevations.
    #[inline(always)]
    pub(crate) fn elevations(&self) -> [[f32; N]; 2] {
        let [mut sines, mut cosines] = [[0f32; N]; 2];
        for lane in 0..N {
            let (across_m, up_m) = (self.across_m[lane], self.up_m[lane]);
            let per_slant = 1.0 / (across_m * across_m + up_m * up_m).sqrt();
            (sines[lane], cosines[lane]) = (up_m * per_slant, across_m * per_slant);
        }
        [sines, cosines]
    }

    /// The transmittance from the light to the observer by way of the rays' nearest points to it, in the vertical plane of the two,
    /// for rays of some elevations (sines, cosines), one a lane, `[band][ray]`. Both ways' optical depths by Simpson's rule.
    #[inline(always)]
    pub(crate) fn transmittance<const FUSED: bool>(
        &self,
        air: &Air,
        [sines, cosines]: [&[f32; N]; 2],
    ) -> [[f32; N]; BAND_COUNT] {
        const SIXTH: f32 = 1.0 / 6.0;
        let eye_m = air.observer_altitude_m as f32;
        // Column of air of each species on the way, metres of it as it is at z = 0.
        let mut columns_m = [[0f32; N]; 2];
        for lane in 0..N {
            let (x, z) = (cosines[lane], sines[lane]);
            let (across_m, up_m) = (self.across_m[lane], self.up_m[lane]);
            let along_m = (across_m * x + up_m * z).max(0.0);
            let miss_m = (across_m * z - up_m * x).abs();
            let rise_m = |along_m: f32| along_m * (z + along_m * x * x * (0.5 / EARTH_RADIUS_M as f32));
            let (nearest_m, middle_m) = (eye_m + rise_m(along_m), eye_m + rise_m(0.5 * along_m));
            for species in 0..2 {
                let per_m = -1.0 / HEIGHTS_M[species];
                let at = |altitude_m: f32| {
                    let log = (altitude_m * per_m).clamp(-MAX_LOG_DENSITY, MAX_LOG_DENSITY);
                    exponential::<FUSED>(log)
                };
                let (nearest, light, eye) =
                    (at(nearest_m), self.density[species][lane], air.density[species]);
                // Midway between light and nearest point: the geometric mean is the density there.
                let between = (nearest * light).sqrt();
                columns_m[species][lane] = SIXTH
                    * (miss_m * (light + 4.0 * between + nearest)
                        + along_m * (nearest + 4.0 * at(middle_m) + eye));
            }
        }
        let mut transmittance = [[0f32; N]; BAND_COUNT];
        for (band, transmittance) in transmittance.iter_mut().enumerate() {
            let [molecules, aerosol] = air.extinction_per_m.map(|of_bands| of_bands[band] as f32);
            for lane in 0..N {
                let depth = molecules * columns_m[0][lane] + aerosol * columns_m[1][lane];
                let root = exponential::<FUSED>((-0.25 * depth).max(-MAX_LOG_DENSITY));
                transmittance[lane] = (root * root) * (root * root);
            }
        }
        transmittance
    }

    /// Radiance per watt in each band, m⁻² sr⁻¹, `[band][direction]`, at elevations (sines, cosines) and azimuths relative to their own
    /// (cosines, sines), one a lane. `transmittance` is that of [`Self::transmittance`] at the elevations.
    #[inline(always)]
    pub(crate) fn radiance<const FUSED: bool>(
        &self,
        air: &Air,
        transmittance: [[f32; N]; BAND_COUNT],
        [sin_elevation, cos_elevation]: [&[f32; N]; 2],
        [cos_azimuth, sin_azimuth]: [&[f32; N]; 2],
    ) -> [[f32; N]; BAND_COUNT] {
        let mut across = [0f32; N];
        let mut along = [0f32; N];
        let mut per_miss = [0f32; N];
        let mut density = [[0f32; N]; 2];
        for lane in 0..N {
            let (across_m, up_m) = (self.across_m[lane], self.up_m[lane]);
            let (sin_arc, cos_arc) = (self.arc[0][lane], self.arc[1][lane]);
            let (x, y) = (cos_elevation[lane] * cos_azimuth[lane], cos_elevation[lane] * sin_azimuth[lane]);
            let z = sin_elevation[lane];
            // |S × v|, without the difference of two long vectors.
            let cross = [up_m * y, up_m * x - across_m * z, across_m * y];
            let miss2 = (cross[0] * cross[0] + cross[1] * cross[1] + cross[2] * cross[2])
                .max(self.nearest_miss_m2[lane]);
            per_miss[lane] = 1.0 / miss2.sqrt();
            // n·miss = (S·v)v − S = v × (v × S), with v × S = −cross in another order.
            let out =
                [y * cross[2] - z * cross[1], -z * cross[0] - x * cross[2], x * cross[1] + y * cross[0]];
            let above_m = -(out[0] * sin_arc + out[2] * cos_arc);
            across[lane] = above_m * per_miss[lane];
            along[lane] = x * sin_arc + z * cos_arc;
            let clamp = |x: f32| x.clamp(-MAX_LOG_DENSITY, MAX_LOG_DENSITY);
            for species in 0..2 {
                density[species][lane] = exponential::<FUSED>(clamp(-above_m * (1.0 / HEIGHTS_M[species])));
            }
        }
        let mut scattered = air.scattering.at(&across, &along);
        for (scattered, density) in scattered.iter_mut().zip(&density) {
            for lane in 0..N {
                scattered[lane] *= density[lane] * per_miss[lane];
            }
        }
        let mut radiance = [[0f32; N]; BAND_COUNT];
        for (band, radiance) in radiance.iter_mut().enumerate() {
            let [molecules, aerosol] = [0, 1].map(|species| air.scattered_per_m[species][band]);
            for lane in 0..N {
                let [of_molecules, of_aerosol] = [0, 1].map(|species: usize| self.density[species][lane]);
                radiance[lane] = transmittance[band][lane]
                    * (molecules * of_molecules * scattered[0][lane]
                        + aerosol * of_aerosol * scattered[1][lane]);
            }
        }
        radiance
    }
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;
    use skyglow_physics::{
        Atmosphere, EmissionMix, Lobe, Turbidity,
        near_light::NearScattering,
        panorama::{azimuth_rad, elevation_rad},
        single_source::{SourceGeometry, mixed_radiance_per_watt},
    };

    /// A light's elevation, radians.
    pub(in crate::near_field) fn elevation_of(sight_line: &SightLine) -> f32 {
        (sight_line.up_m / sight_line.across_m).atan()
    }

    #[test]
    fn the_arc_tangent_is_that_of_the_library() {
        let sizes = (0..4_000).map(|step| 1e-5 * 1.006f32.powi(step)).chain([0.0, 1.0, f32::INFINITY]);
        for x in sizes.flat_map(|x| [x, -x]) {
            let error = (f64::from(arc_tangent(x)) - f64::from(x).atan()).abs();
            assert!(error < 2e-7, "{x}: {error}");
        }
    }

    /// Radiance per watt in each band of one light in one direction, the azimuth relative to its own.
    pub(in crate::near_field) fn one(
        sight_line: &SightLine,
        air: &Air,
        azimuth_rad: f64,
        elevation_rad: f64,
    ) -> [f64; BAND_COUNT] {
        let (cosines, sines) = ([azimuth_rad.cos() as f32], [azimuth_rad.sin() as f32]);
        let [sin, cos] = [elevation_rad.sin() as f32, elevation_rad.cos() as f32];
        let transmittance =
            sight_line.transmittance::<false, 1>(air, [&[sin], &[cos]]).map(|of_band| of_band[0]);
        sight_line
            .radiance::<false, 1>(air, transmittance, [sin, cos], [&cosines, &sines])
            .map(|of_band| f64::from(of_band[0]))
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
                    for slope in [-0.003, 0.0, 0.05, 0.2] {
                        let offset_m = slope * distance_m;
                        let sight_line = SightLine::new(&air, distance_m, offset_m);
                        let geometry = SourceGeometry {
                            distance_m,
                            source_altitude_m: 300.0 + offset_m,
                            observer_altitude_m: 300.0,
                        };
                        // Above and beside it, half a degree to two away.
                        for (aside_deg, above_deg) in [(0.5f64, 0.7f64), (0.1, 0.7), (1.4, 1.0), (0.0, 1.6)] {
                            let elevation =
                                (f64::from(elevation_of(&sight_line)) + above_deg.to_radians()).max(0.012);
                            let azimuth = aside_deg.to_radians();
                            let exact: [f64; BAND_COUNT] = mixed_radiance_per_watt(
                                &[atmosphere],
                                &geometry,
                                emission,
                                azimuth,
                                elevation,
                                1e-5,
                            );
                            let got = one(&sight_line, &air, azimuth, elevation);
                            for (got, exact) in got.iter().zip(exact) {
                                let error = (got / exact - 1.0).abs();
                                (sum, worst, count) = (sum + error, worst.max(error), count + 1.0);
                            }
                        }
                    }
                }
                println!("{turbidity} {:?}: mean {:.3}, worst {worst:.3}", emission.weights(), sum / count);
                assert!(sum / count < 0.04 && worst < 0.3, "{turbidity}: {} {worst}", sum / count);
            }
        }
    }

    /// Radiance per watt of the form and of the integral in green, seen from 302 m; the azimuth in columns.
    fn both(
        turbidity: f64,
        lobe: Lobe,
        [distance_m, altitude_m]: [f64; 2],
        row: usize,
        aside: f64,
    ) -> [f64; 2] {
        let atmosphere = Atmosphere::new(Turbidity::new(turbidity).unwrap());
        let emission = EmissionMix::only(lobe);
        let air = Air::new(NearScattering::of(emission), &atmosphere, 302.0);
        let sight_line = SightLine::new(&air, distance_m, altitude_m - 302.0);
        let geometry =
            SourceGeometry { distance_m, source_altitude_m: altitude_m, observer_altitude_m: 302.0 };
        let (azimuth, elevation) = (aside * azimuth_rad(1), elevation_rad(row));
        let exact: [f64; BAND_COUNT] =
            mixed_radiance_per_watt(&[atmosphere], &geometry, emission, azimuth, elevation, 1e-5);
        [one(&sight_line, &air, azimuth, elevation)[1], exact[1]]
    }

    #[test]
    fn far_peaks_have_their_height_and_shape() {
        for (distance_m, most) in [(35e3, 0.08), (60e3, 0.1), (100e3, 0.25)] {
            for (turbidity, lobe, row) in [
                (1.75, Lobe::Lambert, 0),
                (1.75, Lobe::Oblique, 0),
                (2.5, Lobe::Lambert, 1),
                (2.5, Lobe::Oblique, 1),
            ] {
                let at = |aside: f64| both(turbidity, lobe, [distance_m, 300.0], row, aside);
                let [form, exact] = at(0.0);
                assert!((form / exact - 1.0).abs() < most, "{distance_m} {lobe:?}: {form} for {exact}");
                for aside in [0.25, 0.5, 1.0, 1.5] {
                    let [of_form, of_exact] = at(aside);
                    let off = (of_form / form - of_exact / exact).abs();
                    assert!(off < 0.4 * most, "{distance_m} m, {aside} columns aside, {lobe:?}: {off}");
                }
            }
        }
    }

    /// It is even in azimuth and falls as one over the angle.
    #[test]
    fn it_is_even_and_falls_with_the_angle() {
        let atmosphere = Atmosphere::new(Turbidity::default());
        let air = Air::new(NearScattering::of(EmissionMix::only(Lobe::Horizon)), &atmosphere, 0.0);
        let sight_line = SightLine::new(&air, 5_000.0, 0.0);
        let at = |azimuth_rad: f64| one(&sight_line, &air, azimuth_rad, 0.002)[1];
        assert!((at(0.03) / at(-0.03) - 1.0).abs() < 1e-5);
        assert!((at(0.02) / at(0.04) / 2.0 - 1.0).abs() < 0.1, "{}", at(0.02) / at(0.04));
    }
}
