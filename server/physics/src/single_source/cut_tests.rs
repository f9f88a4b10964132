//! Sources behind a skyline.

use super::{scattering::Integrand, *};
use crate::{
    atmosphere::{Atmosphere, Turbidity},
    bands::{BAND_COUNT, Band},
    emission::LOBE_COUNT,
    quadrature::gauss_legendre,
};
use proptest::prelude::*;

fn atmosphere(turbidity: f64) -> Atmosphere {
    Atmosphere::new(Turbidity::new(turbidity).unwrap())
}

fn at(distance_m: f64) -> SourceGeometry {
    SourceGeometry { distance_m, source_altitude_m: 200.0, observer_altitude_m: 100.0 }
}

#[test]
fn an_open_skyline_changes_no_bit() {
    let nodes = gauss_legendre(7);
    for turbidity in [1.0, 4.0] {
        let air = [atmosphere(turbidity)];
        for distance_m in [300.0, 8_000.0, 150_000.0] {
            for (azimuth, elevation) in [(0.0, 0.02), (0.4, 0.5), (2.9, 0.1), (1.0, 1.5)] {
                let open: [f64; OUTPUT_COUNT] =
                    radiance_per_watt_fixed(&air, &at(distance_m), azimuth, elevation, &nodes);
                for blocking_rad in [0.0, -0.1, -0.0] {
                    let cut: [f64; OUTPUT_COUNT] = cut_radiance_per_watt_fixed(
                        &air,
                        &at(distance_m),
                        blocking_rad,
                        azimuth,
                        elevation,
                        &nodes,
                    );
                    assert_eq!(open.map(f64::to_bits), cut.map(f64::to_bits));
                }
                let low: [f64; OUTPUT_COUNT] =
                    cut_radiance_per_watt_fixed(&air, &at(distance_m), 0.2, azimuth, elevation, &nodes);
                assert!(low.iter().zip(&open).all(|(cut, open)| cut <= open));
            }
        }
    }
}

/// Away from a source and below its skyline there is exactly nothing.
#[test]
fn away_below_the_skyline_all_is_dark() {
    let blocking_rad = 10f64.to_radians();
    let cut = |elevation_deg: f64, azimuth: f64| {
        cut_radiance_per_watt_of(
            &atmosphere(2.0),
            &at(5_000.0),
            blocking_rad,
            azimuth,
            elevation_deg.to_radians(),
            1e-6,
        )
    };
    // The curve of the Earth lifts a ray by less than a quarter of a degree before it has left the haze.
    assert_eq!(cut(9.0, std::f64::consts::PI), [[0.0; LOBE_COUNT]; BAND_COUNT]);
    assert_eq!(cut(2.0, 2.0), [[0.0; LOBE_COUNT]; BAND_COUNT]);
    assert!(cut(14.0, std::f64::consts::PI)[1][0] > 0.0);
    // Towards the source a ray passes above it.
    assert!(cut(2.0, 0.0)[1][0] > 0.0);
}

#[test]
fn a_skyline_at_the_zenith_leaves_nothing() {
    let zenith = |blocking_deg: f64| {
        let sky = cut_radiance_per_watt_of(
            &atmosphere(2.0),
            &at(2_000.0),
            blocking_deg.to_radians(),
            0.3,
            1.57,
            1e-8,
        );
        sky[1]
    };
    let open = zenith(0.0);
    assert!(zenith(80.0)[0] < 0.1 * open[0] && zenith(80.0)[0] > 0.0);
    // The Lambertian lobe loses all but cos² of the angle; what is left falls to nothing.
    assert!(zenith(89.5).iter().zip(open).all(|(cut, open)| *cut < 1e-2 * open));
    assert_eq!(zenith(90.0), [0.0; LOBE_COUNT]);
}

/// The cut integral by plain steps that know nothing of cones: the integrand of the open sky where the elevation is
/// above the skyline.
fn by_plain_steps(geometry: &SourceGeometry, blocking_rad: f64, azimuth: f64, elevation: f64) -> f64 {
    let air = [atmosphere(2.5)];
    let scattering = Integrand::new(&air, geometry, 0.0, elevation);
    let ray = SourceRay::new(geometry, azimuth, elevation);
    let steps = 200_000;
    let mut sum = 0.0;
    for i in 0..steps {
        let s = (f64::from(i) + 0.5) / f64::from(steps);
        let point = ray.point(4e5 * s * s * s);
        if point.cos_zenith_at_source.asin() > blocking_rad {
            let values: [f64; OUTPUT_COUNT] = scattering.by_lobe(&point);
            sum += values[Band::MIDDLE.index() * LOBE_COUNT] * 4e5 * 3.0 * s * s / f64::from(steps);
        }
    }
    sum
}

/// The cut integral is that of plain steps above the skyline.
#[test]
fn cut_integral_agrees_with_plain_steps() {
    for (distance_m, blocking_deg, azimuth, elevation) in [
        (3_000.0, 4.0f64, 0.5, 0.8f64),
        (3_000.0, 16.0, 3.0, 0.4),
        (40_000.0, 4.0, 0.05, 0.03),
        (40_000.0, 8.0, 1.2, 0.3),
        (120_000.0, 8.0, 0.1, 1.2),
    ] {
        let geometry = at(distance_m);
        let blocking_rad = blocking_deg.to_radians();
        let plain = by_plain_steps(&geometry, blocking_rad, azimuth, elevation);
        let got =
            cut_radiance_per_watt_of(&atmosphere(2.5), &geometry, blocking_rad, azimuth, elevation, 1e-8)
                [Band::MIDDLE.index()][0];
        assert!((got / plain - 1.0).abs() < 1e-3, "{distance_m} {blocking_deg}: {got:e} {plain:e}");
        // The open sky is another one: the check can fail.
        let open = by_plain_steps(&geometry, 0.0, azimuth, elevation);
        assert!(open > 1.01 * plain, "{distance_m} {blocking_deg}");
    }
}

/// The fixed rule agrees with the adaptive one behind a skyline.
#[test]
fn fixed_rule_agrees_behind_a_skyline() {
    let nodes = gauss_legendre(10);
    let mut errors = Vec::new();
    for distance_m in [400.0, 6_000.0, 60_000.0] {
        for blocking_deg in [0.5f64, 2.0, 8.0, 25.0] {
            for azimuth in [0.0, 0.1, 0.7, 2.0, 3.1] {
                for elevation in [0.012, 0.1, 0.4, 1.0, 1.55] {
                    let blocking_rad = blocking_deg.to_radians();
                    let air = [atmosphere(3.0)];
                    let fixed: [f64; OUTPUT_COUNT] = cut_radiance_per_watt_fixed(
                        &air,
                        &at(distance_m),
                        blocking_rad,
                        azimuth,
                        elevation,
                        &nodes,
                    );
                    let fine: [f64; OUTPUT_COUNT] = cut_radiance_per_watt(
                        &air,
                        &at(distance_m),
                        blocking_rad,
                        azimuth,
                        elevation,
                        1e-9,
                        0.0,
                    );
                    errors.extend(fixed.iter().zip(fine).map(|(got, reference)| {
                        if reference > 1e-30 { (got / reference - 1.0).abs() } else { got - reference }
                    }));
                }
            }
        }
    }
    errors.sort_by(f64::total_cmp);
    let (most, worst) = (errors[errors.len() * 99 / 100], errors[errors.len() - 1]);
    assert!(most < 1e-3 && worst < 1e-2, "{most:e} {worst:e}");
}

proptest! {
    #[test]
    fn a_higher_skyline_makes_no_direction_brighter(
        log_distance in 0.0f64..1.0, source_altitude_m in 0.0f64..4e3, observer_altitude_m in 0.0f64..4e3,
        azimuth in 0.0f64..3.1, elevation in 0.005f64..1.57, turbidity in 1.0f64..6.0, a in 0.0f64..1.5, b in 0.0f64..1.5,
    ) {
        let geometry =
            SourceGeometry { distance_m: 250.0 * 1200f64.powf(log_distance), source_altitude_m, observer_altitude_m };
        let sky = |blocking| {
            cut_radiance_per_watt_of(&atmosphere(turbidity), &geometry, blocking, azimuth, elevation, 1e-6)
        };
        let (low, high) = (sky(a.min(b)), sky(a.max(b)));
        for band in 0..BAND_COUNT {
            for lobe in 0..LOBE_COUNT {
                prop_assert!(high[band][lobe] >= 0.0 && high[band][lobe] <= low[band][lobe] * (1.0 + 1e-5));
            }
        }
    }
}
