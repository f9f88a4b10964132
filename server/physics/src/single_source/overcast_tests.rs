//! Sources and observers below a closed layer of cloud.

use super::{scattering::Integrand, *};
use crate::{
    atmosphere::{Atmosphere, Turbidity},
    bands::Band,
    cloud::CloudBase,
    emission::{EmissionMix, lobe_intensities_per_sr},
    geometry::EARTH_RADIUS_M,
    quadrature::gauss_legendre,
};
use glam::DVec3;
use proptest::prelude::*;
use std::f64::consts::{FRAC_PI_2, PI};

fn under(turbidity: f64, base_m: f64, albedo: f64) -> Atmosphere {
    clear(turbidity).under(Some(CloudBase::lambertian(base_m, albedo).unwrap()))
}

fn clear(turbidity: f64) -> Atmosphere {
    Atmosphere::new(Turbidity::new(turbidity).unwrap())
}

fn at(distance_m: f64) -> SourceGeometry {
    SourceGeometry { distance_m, source_altitude_m: 100.0, observer_altitude_m: 40.0 }
}

fn sky(air: Atmosphere, geometry: &SourceGeometry, azimuth: f64, elevation: f64) -> RadiancePerWatt {
    radiance_per_watt_of(&air, geometry, azimuth, elevation, 1e-8)
}

/// Every output, ray by ray, of a sample of geometries and directions.
fn sample() -> Vec<(SourceGeometry, f64, f64)> {
    let mut rays = Vec::new();
    for distance_m in [250.0, 3_000.0, 20_000.0, 70_000.0] {
        for (azimuth, elevation) in [(0.0, 0.02), (0.3, 0.2), (1.5, 0.7), (3.0, 0.1), (0.0, FRAC_PI_2)] {
            rays.push((at(distance_m), azimuth, elevation));
        }
    }
    rays
}

#[test]
fn the_base_beside_a_source_is_lit_as_by_hand() {
    // Straight up, in a layer of air so thin that it hardly counts: E = cos²/(π·d²) of a Lambertian source, of which
    // the base reflects A/π.
    let geometry = SourceGeometry { distance_m: 150.0, source_altitude_m: 0.0, observer_altitude_m: 0.0 };
    let (base_m, albedo) = (200.0f64, 0.5);
    let got = sky(under(1.0, base_m, albedo), &geometry, 0.0, FRAC_PI_2)[Band::LONGEST.index()][0];
    let distance2 = base_m.powi(2) + 150f64.powi(2);
    let cosine = base_m / distance2.sqrt();
    // Extinction of the red over 250 m up and 200 m down: half a part in 400; what this air scatters is as little.
    let by_hand = cosine / PI / distance2 * cosine * albedo / PI;
    assert!((got / by_hand - 1.0).abs() < 5e-3, "{got:e} {by_hand:e}");
    // Without either cosine it would be another number.
    assert!((got / (by_hand / cosine) - 1.0).abs() > 0.1);
}

/// What the base adds is its irradiance, attenuated by the air.
#[test]
fn base_light_is_its_irradiance_attenuated() {
    // Radiance is linear in the albedo, so the difference of two skies is the light of the base alone. By plain
    // vectors and sums, on the sphere.
    for (geometry, azimuth, elevation) in sample() {
        let (base_m, turbidity) = (1_300.0, 2.5);
        let dark = sky(under(turbidity, base_m, 0.0), &geometry, azimuth, elevation);
        let bright = sky(under(turbidity, base_m, 0.8), &geometry, azimuth, elevation);
        let observer = DVec3::new(0.0, 0.0, EARTH_RADIUS_M + geometry.observer_altitude_m);
        let arc = geometry.distance_m / EARTH_RADIUS_M;
        let source_up = DVec3::new(arc.sin(), 0.0, arc.cos());
        let source = source_up * (EARTH_RADIUS_M + geometry.source_altitude_m);
        let flat = elevation.cos();
        let view = DVec3::new(flat * azimuth.cos(), flat * azimuth.sin(), elevation.sin());
        let (mut low, mut high) = (0.0, 1e6);
        for _ in 0..100 {
            let middle = 0.5 * (low + high);
            let above = (observer + view * middle).length() > EARTH_RADIUS_M + base_m;
            (low, high) = if above { (low, middle) } else { (middle, high) };
        }
        let hit = observer + view * low;
        let light = hit - source;
        let cos_source = light.normalize().dot(source_up);
        let cos_incidence = light.normalize().dot(hit.normalize());
        let depth = |a: DVec3, b: DVec3| -> f64 {
            let steps = 2_000;
            let extinction = |p: DVec3| {
                let z = p.length() - EARTH_RADIUS_M;
                let air = clear(turbidity);
                air.molecule_extinction_per_m()[1] * (-z / 8_430.0).exp()
                    + air.aerosol_extinction_per_m()[1] * (-z / 1_200.0).exp()
            };
            let middles = (0..steps).map(|i| a.lerp(b, (f64::from(i) + 0.5) / f64::from(steps)));
            middles.map(extinction).sum::<f64>() * (b - a).length() / f64::from(steps)
        };
        let through = (-depth(source, hit) - depth(hit, observer)).exp();
        for (lobe, intensity) in lobe_intensities_per_sr(cos_source).into_iter().enumerate() {
            let by_hand = intensity / light.length_squared() * cos_incidence * 0.8 / PI * through;
            let got = bright[1][lobe] - dark[1][lobe];
            let scale = by_hand.max(1e-6 * bright[1][lobe]).max(1e-40);
            assert!((got - by_hand).abs() < 1e-4 * scale, "{geometry:?} {azimuth} {elevation} {lobe}");
        }
    }
}

#[test]
fn a_black_base_leaves_the_clear_sky_below_it() {
    // The part of the clear integrand below the base, by plain steps.
    for (geometry, azimuth, elevation) in sample() {
        let base_m = 900.0;
        let air = [clear(2.0)];
        let scattering = Integrand::new(&air, &geometry, 0.0, elevation);
        let ray = SourceRay::new(&geometry, azimuth, elevation);
        let end_m = ray.path_to_altitude_m(base_m);
        let steps = 40_000;
        let mut sum = 0.0;
        for i in 0..steps {
            let s = (f64::from(i) + 0.5) / f64::from(steps);
            let values: [f64; OUTPUT_COUNT] = scattering.by_lobe(&ray.point(end_m * s * s));
            sum += values[LOBE_COUNT] * end_m * 2.0 * s / f64::from(steps);
        }
        let got = sky(under(2.0, base_m, 0.0), &geometry, azimuth, elevation)[1][0];
        assert!((got - sum).abs() <= 1e-3 * sum, "{geometry:?} {azimuth} {elevation}: {got:e} {sum:e}");
        let open = sky(air[0], &geometry, azimuth, elevation)[1][0];
        assert!(got <= open);
    }
}

/// A black base far above nearly leaves the clear sky; a low one takes what it would have scattered.
#[test]
fn a_high_black_base_leaves_the_clear_sky() {
    // At 12 km a fifth of the molecules and none of the haze are left.
    let geometry = at(300.0);
    let (open, black) =
        (sky(clear(2.0), &geometry, 0.0, 1.5), sky(under(2.0, 12_000.0, 0.0), &geometry, 0.0, 1.5));
    let (low, ratio) = (sky(under(2.0, 300.0, 0.0), &geometry, 0.0, 1.5), black[1][0] / open[1][0]);
    assert!(ratio > 0.98 && ratio < 1.0, "{ratio}");
    assert!(low[1][0] < 0.9 * open[1][0]);
}

#[test]
fn nothing_passes_the_base_in_either_direction() {
    let base_m = 1_000.0;
    let (air, nodes) = (under(2.5, base_m, 0.5), gauss_legendre(8));
    for (source_altitude_m, observer_altitude_m) in
        [(base_m, 0.0), (1_500.0, 0.0), (0.0, base_m), (0.0, 1_800.0), (1_400.0, 1_600.0)]
    {
        let geometry = SourceGeometry { distance_m: 4_000.0, source_altitude_m, observer_altitude_m };
        for (azimuth, elevation) in [(0.0, 0.01), (1.0, 0.6), (0.0, FRAC_PI_2)] {
            assert_eq!(sky(air, &geometry, azimuth, elevation), [[0.0; LOBE_COUNT]; BAND_COUNT]);
            let fixed: [f64; OUTPUT_COUNT] =
                radiance_per_watt_fixed(&[air], &geometry, azimuth, elevation, &nodes);
            assert_eq!(fixed, [0.0; OUTPUT_COUNT]);
            let mix: [f64; BAND_COUNT] = mixed_radiance_per_watt_where(
                &[air],
                &geometry,
                EmissionMix::garstang(),
                azimuth,
                elevation,
                &nodes,
                |_, _| true,
            );
            assert_eq!(mix, [0.0; BAND_COUNT]);
        }
    }
    // Ten metres below the base there is light: the check can fail.
    let geometry =
        SourceGeometry { distance_m: 4_000.0, source_altitude_m: 990.0, observer_altitude_m: 990.0 };
    assert!(sky(air, &geometry, 0.0, 0.6)[1][1] > 0.0);
}

#[test]
fn the_base_obeys_the_sources_skyline() {
    let (air, geometry) = (under(2.0, 1_000.0, 0.5), at(2_000.0));
    let zenith = |blocking_deg: f64| {
        cut_radiance_per_watt_of(&air, &geometry, blocking_deg.to_radians(), 0.0, FRAC_PI_2, 1e-8)[1][0]
    };
    // The base over the observer stands 24° above the source's horizon.
    let (open, below, above) = (zenith(0.0), zenith(24.0), zenith(25.0));
    assert!(below > 0.5 * open, "{below:e} {open:e}");
    assert_eq!(above, 0.0);
    // What is hidden from the base by a wall is tested point by point.
    let nodes = gauss_legendre(16);
    let ask = |is_lit: &dyn Fn(f64, f64) -> bool| -> [f64; BAND_COUNT] {
        let mix = EmissionMix::lambert();
        mixed_radiance_per_watt_where(&[air], &geometry, mix, 0.0, FRAC_PI_2, &nodes, is_lit)
    };
    let (all, without_base) = (ask(&|_, _| true), ask(&|path_m, _| path_m < 959.0));
    assert!((all[1] / open - 1.0).abs() < 1e-3);
    assert!(without_base[1] > 0.0 && without_base[1] < 0.5 * all[1]);
}

#[test]
fn all_ways_of_asking_agree_under_a_cloud() {
    let (air, nodes) = ([under(3.0, 700.0, 0.5)], gauss_legendre(10));
    let mix = EmissionMix::garstang();
    for (geometry, azimuth, elevation) in sample() {
        let fine = sky(air[0], &geometry, azimuth, elevation);
        let fixed: [f64; OUTPUT_COUNT] = radiance_per_watt_fixed(&air, &geometry, azimuth, elevation, &nodes);
        let mixed: [f64; BAND_COUNT] =
            mixed_radiance_per_watt(&air, &geometry, mix, azimuth, elevation, 1e-8);
        for band in 0..BAND_COUNT {
            for lobe in 0..LOBE_COUNT {
                let (got, reference) = (fixed[band * LOBE_COUNT + lobe], fine[band][lobe]);
                assert!(
                    (got - reference).abs() <= 1e-3 * reference,
                    "{geometry:?} {azimuth} {elevation}: {got:e} {reference:e}"
                );
            }
            let sum: f64 = fine[band].iter().zip(mix.weights()).map(|(value, weight)| value * weight).sum();
            assert!((mixed[band] - sum).abs() <= 1e-6 * sum);
        }
    }
}

/// Atmospheres under different clouds are not evaluated together.
#[test]
#[should_panic(expected = "under one cloud")]
fn different_clouds_together_panic() {
    let air = [under(2.0, 1_000.0, 0.5), clear(2.0)];
    let _: [f64; 2 * OUTPUT_COUNT] = radiance_per_watt(&air, &at(1_000.0), 0.0, 0.5, 1e-6, 0.0);
}

proptest! {
    /// More albedo is brighter everywhere, and a black base is darker than the clear sky.
    #[test]
        fn more_albedo_is_brighter_everywhere(
        log_distance in 0.0f64..1.0, azimuth in 0.0f64..3.1, elevation in 0.005f64..1.57,
        base_m in 250.0f64..6e3, albedo in 0.05f64..0.9, turbidity in 1.0f64..6.0,
    ) {
        let geometry = at(250.0 * 1200f64.powf(log_distance));
        let black = sky(under(turbidity, base_m, 0.0), &geometry, azimuth, elevation);
        let grey = sky(under(turbidity, base_m, albedo), &geometry, azimuth, elevation);
        let white = sky(under(turbidity, base_m, albedo + 0.1), &geometry, azimuth, elevation);
        let open = sky(clear(turbidity), &geometry, azimuth, elevation);
        for band in 0..BAND_COUNT {
            for lobe in 0..LOBE_COUNT {
                let (b, g, w) = (black[band][lobe], grey[band][lobe], white[band][lobe]);
                prop_assert!(0.0 <= b && b <= g && g <= w && w.is_finite());
                prop_assert!(b <= open[band][lobe] * (1.0 + 1e-7));
                // Linear in the albedo.
                prop_assert!((g - b - (w - b) * albedo / (albedo + 0.1)).abs() <= 1e-7 * w);
            }
        }
    }
}
