use super::*;
use proptest::prelude::*;

fn log_distance(distance_m: f64) -> f64 {
    crate::polar_grid::log_distance(distance_m)
}

/// Nothing within 8 km; beyond, codes by azimuth.
fn behind_8_km(code: impl Fn(usize) -> u8) -> Skyline {
    let mut skyline = Skyline::default();
    for (azimuth, codes) in skyline.iter_mut().enumerate() {
        codes[5..].fill(code(azimuth));
    }
    skyline
}

fn only(skyline: Skyline) -> Skylines {
    let mut skylines = Skylines::default();
    skylines.push(&skyline);
    skylines
}

/// At a stored azimuth and distance the skyline is the highest terrain within that distance.
#[test]
fn at_a_node_it_is_the_terrain_within_distance() {
    let skylines = only(behind_8_km(|azimuth| azimuth as u8 * 4));
    for azimuth in 0..SKYLINE_AZIMUTH_COUNT {
        for (reach, reach_m) in SKYLINE_DISTANCES_M.into_iter().enumerate() {
            let turns = azimuth as f64 / SKYLINE_AZIMUTH_COUNT as f64;
            let expected = if reach < 5 { 0.0 } else { azimuth as f64 * 4.0 / 36.0 };
            let found = skylines.blocking(0, turns, log_distance(reach_m));
            assert!((found - expected).abs() < 1e-9, "{azimuth} {reach_m}: {found}");
        }
    }
    // An observer nearer than the terrain is not behind it; one beyond the last distance is.
    assert_eq!(skylines.blocking(0, 0.7, log_distance(8_000.0)), 0.0);
    assert!(skylines.blocking(0, 0.7, log_distance(8_500.0)) > 0.0);
    assert_eq!(
        skylines.blocking(0, 0.7, log_distance(128_000.0)),
        skylines.blocking(0, 0.7, log_distance(300_000.0))
    );
    // A whole turn is azimuth 0.
    let far = log_distance(50_000.0);
    assert_eq!(skylines.blocking(0, 1.0, far), skylines.blocking(0, 0.0, far));
}

/// Codes are fine near the open sky and reach the last blocking angle.
#[test]
fn codes_resolve_low_angles_and_span_all() {
    for (degrees, code) in [(-1.0, 0), (0.0, 0), (0.5, 36), (1.0, 72), (32.0, 252), (70.0, 252)] {
        assert_eq!(code_of(f64::to_radians(degrees).tan()), code);
    }
    assert_eq!(code_of(f64::to_radians(0.014).tan()), 1);
    assert_eq!((code_of(MIN_TANGENT), code_of(1.02 * MIN_TANGENT)), (0, 1));
}

/// The skyline of a block is the mean of its lights' skylines, weighted by flux.
#[test]
fn a_block_has_the_flux_weighted_mean_skyline() {
    let grid = crate::grid::Grid::geographic(
        crate::grid::GeographicAxes {
            first_longitude_deg: 8.0,
            first_latitude_deg: 47.0,
            longitude_step_deg: 0.01,
            latitude_step_deg: -0.01,
        },
        4,
        4,
    );
    let pixels = crate::lit_pixels::LitPixels {
        codes: vec![0, 1, 2, 12].into(),
        radiance_nw_cm2_sr: vec![1.0, 1.0, 2.0, 5.0].into(),
        altitude_m: vec![0.0; 4].into(),
    };
    let mut skylines = Skylines::default();
    for code in [80, 0, 40, 0] {
        skylines.push(&behind_8_km(|_| code));
    }
    assert_eq!(skylines.blocked_count(), 2);
    let pyramid = crate::light_pyramid::LightPyramid::build(&grid, &pixels, Some(&skylines), 1.0);
    let level = pyramid.level(1).skylines.as_ref().unwrap();
    let far = log_distance(1e5);
    // (80 + 0 + 2 · 40) / 4, and nothing around the fourth.
    assert!((level.blocking(0, 0.3, far) - 40.0 / 36.0).abs() < 0.02);
    assert!(level.is_open(1) && level.blocking(1, 0.3, far) == 0.0);
    let top = pyramid.level(2).skylines.as_ref().unwrap();
    assert!((top.blocking(0, 0.3, far) - 160.0 / 9.0 / 36.0).abs() < 0.02);
    let without = crate::light_pyramid::LightPyramid::build(&grid, &pixels, None, 1.0);
    assert!(without.level(1).skylines.is_none());
}

proptest! {
    #[test]
    fn stored_skylines_come_back(rises in proptest::collection::vec(0u8..60, 0..40)) {
        let mut skylines = Skylines::default();
        for (light, &rise) in rises.iter().enumerate() {
            let mut skyline = Skyline::default();
            for (azimuth, codes) in skyline.iter_mut().enumerate() {
                for (reach, code) in codes.iter_mut().enumerate() {
                    *code = if light % 3 == 0 { 0 } else { ((azimuth + reach) as u8).wrapping_mul(rise) };
                }
                codes.sort_unstable();
            }
            skylines.push(&skyline);
        }
        let packed = crate::sections::pack(&skylines.to_sections()).unwrap();
        let sections = Sections::parse(&packed).unwrap();
        prop_assert_eq!(Skylines::from_sections(&sections, rises.len()).unwrap(), skylines.clone());
        // For fewer lights than there are skylines it is refused.
        if skylines.blocked_count() > 0 {
            let last = (0..rises.len()).rev().find(|&light| !skylines.is_open(light)).unwrap();
            prop_assert!(Skylines::from_sections(&sections, last).is_err());
        }
    }

    #[test]
    fn it_stays_within_its_samples(code in 0u8..=252, turns in 0.0f64..=1.0, log in 0.0f64..7.1) {
        let found = only(behind_8_km(|_| code)).blocking(0, turns, log);
        prop_assert!((0.0..=f64::from(code) / 36.0 + 1e-9).contains(&found));
    }
}
