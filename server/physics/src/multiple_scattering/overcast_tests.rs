//! All orders below a closed layer of cloud.

use super::{
    solver_checks::{
        TRACED, at, check_against_traced_light, check_balance, check_both_tracers, check_rows, detectors,
    },
    *,
};
use crate::{
    Atmosphere, BAND_COUNT, CloudBase, EmissionMix, LOBE_COUNT, PointSource, Turbidity,
    panorama::Direction,
    quadrature::integrate_adaptive,
    single_source::{SourceGeometry, cut_radiance_per_watt_of, radiance_per_watt_of},
};
use std::{f64::consts::PI, sync::LazyLock};

const BASE_M: f64 = 1_000.0;

fn air(base_m: f64, albedo: f64) -> Atmosphere {
    let cloud = CloudBase::lambertian(base_m, albedo).unwrap();
    Atmosphere::new(Turbidity::new(2.0).unwrap()).under(Some(cloud))
}

fn setting(base_m: f64, albedo: f64) -> SourceSetting {
    SourceSetting::new(air(base_m, albedo), 0.0, 0.0, DEFAULT_GROUND_ALBEDO).unwrap()
}

/// Solved once for all tests here: a base at 1 km of albedo 0.5, over a source at sea level.
static FIELD: LazyLock<SourceField> =
    LazyLock::new(|| SourceField::solve(setting(BASE_M, 0.5), &Resolution::coarse()));

/// Below a cloud light is scattered, absorbed or retained by ground and base, and none escapes.
#[test]
fn energy_balances_below_a_cloud() {
    check_balance(&FIELD);
    let powers = FIELD.powers();
    assert!(powers.iter().all(|power| power.escaped_w() == [[0.0; LOBE_COUNT]; BAND_COUNT]));
    // Most of the direct light arrives at the base: without it the first balance fails, and the later ones too.
    assert!(powers[0].at_base_w()[1][0] > 0.8);
    assert!(powers[1..].iter().all(|power| power.at_base_w()[1][0] > 0.05 * power.sent_w()[1][0]));
    // Half of the direct light is reflected, and with what is scattered it is the light of the first order.
    let sent = powers[0].scattered_on_w()[1][0] + 0.5 * powers[0].at_base_w()[1][0];
    assert!((powers[1].sent_w()[1][0] / sent - 1.0).abs() < 1e-6);
}

/// The same below drops: what they reflect of the direct light, by its angle, is found again in the light of the first order.
#[test]
fn energy_balances_below_drops() {
    let drops = CloudBase::new(BASE_M, 0.5).unwrap();
    let setting =
        SourceSetting::new(air(BASE_M, 0.5).under(Some(drops)), 0.0, 0.0, DEFAULT_GROUND_ALBEDO).unwrap();
    let field = SourceField::solve(setting, &Resolution::coarse());
    check_balance(&field);
    check_rows(&field, [(400.0, 0.4), (7e3, 1.7), (30e3, 2.8)]);
    // More of the horizontal lobe than of the Lambertian one comes back: it arrives at grazing angles.
    let returned = |lobe: usize| {
        let power = &field.powers()[0];
        (field.powers()[1].sent_w()[1][lobe] - power.scattered_on_w()[1][lobe]) / power.at_base_w()[1][lobe]
    };
    let [steep, grazing] = [0, 1].map(returned);
    assert!(steep > 0.5 && grazing > steep + 0.05, "{steep} {grazing}");
}

/// First-order light on the grid is that of `single_source` below a cloud.
#[test]
#[ignore = "slow: `make check` leaves it to `make test`"]
fn first_order_agrees_below_a_cloud() {
    let resolution = Resolution::table();
    let rule = gathering::FirstOrderRule::new(
        resolution.first_polar,
        resolution.first_around,
        resolution.first_along,
    );
    for (blocking_rad, rings) in [(0.0, &[2, 9, 12, 15][..]), (0.15, &[2, 9])] {
        let setting = setting(BASE_M, 0.5).behind(blocking_rad).unwrap();
        let cloud = setting.atmosphere.cloud();
        let grid = grid::FieldGrid::new(0.0, 0.0, cloud, 0.4, 1);
        let first = first_order::FirstOrder::new(&setting, &rule, grid::TOP_ALTITUDE_M);
        for layer in [0, grid.layer_count() / 2, grid.layer_count() - 2] {
            for &ring in rings {
                let point = layer * grid.ring_count() + ring;
                let (distance_m, observer_altitude_m) = grid.place_m(point);
                let geometry = SourceGeometry { observer_altitude_m, ..at(distance_m) };
                let place = first.at(&grid, point, 2);
                let flux = integrate_adaptive(0.0, 0.5 * PI, 1e-3, 0.0, |elevation| {
                    integrate_adaptive(0.0, PI, 1e-3, 0.0, |azimuth| {
                        let (air, cut) = (&setting.atmosphere, blocking_rad);
                        let sky = cut_radiance_per_watt_of(air, &geometry, cut, azimuth, elevation, 1e-4);
                        [0, 1, 2].map(|lobe| 2.0 * sky[1][lobe] * elevation.sin() * elevation.cos())
                    })
                });
                // The oblique lobe lights a disc of the base with a sharp edge.
                for (lobe, tolerance) in [0.02, 0.02, 0.06].into_iter().enumerate() {
                    let error = place.down_flux[LOBE_COUNT + lobe] / flux[lobe] - 1.0;
                    assert!(error.abs() < tolerance, "{distance_m} {observer_altitude_m} {lobe}: {error}");
                }
            }
        }
    }
}

/// A row agrees with the sum of moments below a cloud.
#[test]
fn a_row_is_the_sum_of_moments_below_a_cloud() {
    check_rows(&FIELD, [(400.0, 0.4), (7e3, 1.7), (30e3, 2.8)]);
}

/// The solver agrees with light traced forward below a cloud.
#[test]
fn solver_agrees_with_tracer_below_a_cloud() {
    let detectors = detectors(&[1e3, 5e3], &[(0.0, 1.57), (0.0, 0.2), (1.6, 0.5), (3.1, 0.8)]);
    check_against_traced_light(&FIELD, &detectors, 100_000, 0.03, 0.04);
}

#[test]
fn both_tracers_agree_below_a_cloud() {
    let setting = SourceSetting::new(air(1_500.0, 0.7), 600.0, 200.0, 0.5).unwrap();
    let geometry = SourceGeometry { distance_m: 2e3, source_altitude_m: 600.0, observer_altitude_m: 200.0 };
    let (azimuth, elevation) = (1.0, 0.7);
    // Both know the first order, most of which is the base's.
    let first =
        radiance_per_watt_of(&setting.atmosphere, &geometry, azimuth, elevation, 1e-6)[TRACED.index()];
    for traced in check_both_tracers(setting, geometry, (azimuth, elevation), 40_000, 0.1) {
        for (lobe, &first) in first.iter().enumerate() {
            let traced_first = traced.by_order_per_m2_sr[0][lobe];
            assert!((traced_first - first).abs() <= 0.1 * first, "{lobe}: {first} {traced:?}");
        }
    }
}

/// More albedo is brighter everywhere, and a black base is darker than the clear sky.
#[test]
#[ignore = "slow: `make check` leaves it to `make test`"]
fn more_albedo_is_brighter_everywhere() {
    let solve = |atmosphere: Atmosphere| {
        let setting = SourceSetting::new(atmosphere, 0.0, 0.0, DEFAULT_GROUND_ALBEDO).unwrap();
        SourceField::solve(setting, &Resolution::coarse())
    };
    let (black, white) = (solve(air(BASE_M, 0.0)), solve(air(BASE_M, 0.9)));
    let open = solve(air(BASE_M, 0.0).under(None));
    for distance_m in [300.0, 4e3, 25e3] {
        for (azimuth, elevation) in [(0.0, 0.1), (0.5, 0.6), (3.0, 0.3), (0.0, 1.57)] {
            let of =
                |field: &SourceField| field.radiance_per_watt(&at(distance_m), azimuth, elevation).unwrap();
            let (black, grey, white, open) = (of(&black), of(&FIELD), of(&white), of(&open));
            for band in 0..3 {
                for lobe in 0..3 {
                    let order = [black, grey, white].map(|sky| sky[band][lobe]);
                    assert!(0.0 < order[0] && order[0] < order[1] && order[1] < order[2], "{order:?}");
                    assert!(order[0] < open[band][lobe], "{distance_m} {azimuth} {elevation}");
                }
            }
        }
    }
}

/// An observer at or above the base sees nothing, and a source there is refused by name.
#[test]
fn nothing_is_seen_from_above_the_base() {
    for observer_altitude_m in [BASE_M, 1_700.0] {
        let row = ViewRow::new(&FIELD, observer_altitude_m, 0.4).unwrap();
        assert_eq!(row.radiance_per_watt(3e3, 0.2), [[0.0; LOBE_COUNT]; BAND_COUNT]);
        let geometry = SourceGeometry { observer_altitude_m, ..at(3e3) };
        assert_eq!(FIELD.radiance_per_watt(&geometry, 0.2, 0.4).unwrap(), [[0.0; LOBE_COUNT]; BAND_COUNT]);
    }
    let below = SourceGeometry { observer_altitude_m: BASE_M - 1.0, ..at(3e3) };
    assert!(FIELD.radiance_per_watt(&below, 0.2, 0.4).unwrap()[1][0] > 0.0);
    for source_m in [BASE_M, 1_500.0, BASE_M - 0.5 * MIN_BELOW_BASE_M] {
        let error = SourceSetting::new(air(BASE_M, 0.5), source_m, 0.0, 0.15).unwrap_err().to_string();
        assert!(error.contains("source_altitude") && error.contains("975"), "{error}");
    }
    assert!(SourceSetting::new(air(BASE_M, 0.5), BASE_M - MIN_BELOW_BASE_M, 0.0, 0.15).is_ok());
    assert!(SourceSetting::new(air(BASE_M, 0.5).under(None), 1_500.0, 0.0, 0.15).is_ok());
}

#[test]
#[ignore = "slow: `make check` leaves it to `make test`"]
fn a_sum_leaves_out_what_is_above_the_base() {
    let source =
        |altitude_m: f64| PointSource { azimuth_rad: 0.3, distance_m: 3e3, altitude_m, flux_dnb_w: 1e6 };
    let directions = [Direction { azimuth_rad: 0.0, elevation_rad: 0.8 }];
    let sky = |observer_altitude_m: f64, sources: &[PointSource]| {
        let sum = MultipleSum {
            atmosphere: air(BASE_M, 0.5),
            ground_albedo: 0.15,
            observer_altitude_m,
            emission: EmissionMix::garstang(),
            resolution: Resolution::coarse(),
            density: SumDensity { distances: 24, azimuths: 21, ..SumDensity::default() },
        };
        sum.radiance(sources, [1.0; BAND_COUNT], &directions).unwrap()[0]
    };
    let low = sky(100.0, &[source(200.0)]);
    assert!(low[1] > 0.0);
    assert_eq!(sky(100.0, &[source(200.0), source(BASE_M), source(1_800.0)]), low);
    assert_eq!(sky(100.0, &[source(BASE_M), source(1_800.0)]), [0.0; BAND_COUNT]);
    assert_eq!(sky(BASE_M, &[source(200.0)]), [0.0; BAND_COUNT]);
    // Just below the base is not left out.
    assert!(sky(100.0, &[source(BASE_M - 1.0)])[1] > 0.0);
}
