use super::*;
use crate::terrain::synthetic_ground::{grid, hills_m, layer, noise, place};
use proptest::prelude::*;
use skyglow_physics::horizon::terrain_elevation_tangent;
use std::f64::consts::{FRAC_PI_2, PI};

const REACHES_M: [f64; 6] = [1_000.0, 3_000.0, 10_000.0, 30_000.0, 60_000.0, 120_000.0];

fn terrain(height_m: impl Fn(u32, u32) -> f32) -> Terrain {
    Terrain::new(vec![layer(grid(7.0, 47.0, 200), height_m)])
}

/// tan e of the highest terrain by small steps along the line of sight.
fn walked(terrain: &Terrain, at: GeoPoint, altitude_m: f64, azimuth_rad: f64, from_m: f64, to_m: f64) -> f64 {
    let (mut tangent, mut distance_m) = (0.0f64, from_m);
    while distance_m <= to_m {
        if let Some(ground_m) = terrain.elevation_m(at.destination(azimuth_rad, distance_m)) {
            tangent = tangent.max(terrain_elevation_tangent(altitude_m, ground_m, distance_m));
        }
        distance_m += (distance_m / 1000.0).clamp(0.1, 30.0);
    }
    tangent
}

#[test]
fn a_wall_is_seen_at_its_distance_and_not_before() {
    // A wall along a meridian, 23 km east of the light.
    let wall = terrain(|column, _| if column == 80 { 1200.0 } else { 200.0 });
    let at = place(46.5, 7.505);
    let wall_m = LocalFrame::at(at).bearing_to(place(46.5, 7.805).unit_vector()).distance_m;
    let sight = wall.source_horizon(at, 200.0, 100.0);
    let reaches_m = [1_000.0, 0.9 * wall_m, 1.1 * wall_m, 60_000.0];
    let tangents = sight.tangents(FRAC_PI_2, 0.0, &reaches_m);
    let expected = terrain_elevation_tangent(200.0, 1200.0, wall_m);
    assert_eq!(tangents[..2], [0.0, 0.0], "an observer nearer than the wall is not behind it");
    assert!((tangents[2] / expected - 1.0).abs() < 1e-3, "{tangents:?} {expected}");
    assert_eq!(tangents[2], tangents[3]);
    assert_eq!(sight.tangents(-FRAC_PI_2, 0.0, &reaches_m), [0.0; 4], "nothing in the west");
    assert!(sight.is_higher_than(0.9 * expected, FRAC_PI_2, 60_000.0));
    assert!(!sight.is_higher_than(1.1 * expected, FRAC_PI_2, 60_000.0));
    assert!(!sight.is_higher_than(0.9 * expected, FRAC_PI_2, 0.9 * wall_m));
}

/// A slope blocks what leaves uphill below it, and nothing downhill.
#[test]
fn a_slope_blocks_uphill_only() {
    // 0.1 metre a metre, up towards the north.
    let slope = terrain(|_, row| (200 - row) as f32 * 111.2);
    let at = place(46.0, 8.0);
    let altitude_m = slope.elevation_m(at).unwrap();
    let sight = slope.source_horizon(at, altitude_m, 100.0);
    for tangent in sight.tangents(0.0, 0.0, &REACHES_M) {
        assert!((tangent - 0.1).abs() < 1e-3, "{tangent}");
    }
    assert_eq!(sight.tangents(PI, 0.0, &REACHES_M), [0.0; 6]);
}

/// Ground within an eighth of the pixel's side does not block.
#[test]
fn ground_within_an_eighth_pixel_never_blocks() {
    // One sample of 1.1 km is 300 m higher; the light stands at its foot.
    let hill = terrain(|column, row| if (column, row) == (100, 100) { 500.0 } else { 200.0 });
    let at = place(45.995, 7.995);
    let altitude_m = hill.elevation_m(at).unwrap();
    let towards_rad = LocalFrame::at(at).bearing_to(place(45.995, 8.005).unit_vector()).azimuth_rad;
    let highest = |pixel_size_m: f64| {
        let sight = hill.source_horizon(at, altitude_m, min_blocking_distance_m(pixel_size_m));
        sight.tangents(towards_rad, 0.0, &REACHES_M)[5]
    };
    assert!(highest(500.0) > 0.3);
    assert_eq!(highest(16_000.0), 0.0);
}

#[test]
fn flat_ground_summits_and_voids_hide_nothing() {
    let at = place(46.0, 8.0);
    let plain = terrain(|_, _| 433.3);
    let altitude_m = plain.elevation_m(at).unwrap();
    assert!(plain.source_horizon(at, altitude_m, 100.0).is_open());
    // An island of ground in a sea of voids.
    let island =
        terrain(|c, r| if (90..110).contains(&c) && (90..110).contains(&r) { 800.0 } else { f32::NAN });
    let sight = island.source_horizon(at, 800.0, 100.0);
    let holes = terrain(|c, r| if noise(c / 3, r / 3, 9) < 0.3 { f32::NAN } else { 300.0 });
    for number in 0..16 {
        let azimuth_rad = f64::from(number) * PI / 8.0;
        assert_eq!(sight.tangents(azimuth_rad, 0.0, &REACHES_M), [0.0; 6]);
        assert_eq!(holes.source_horizon(at, 300.0, 100.0).tangents(azimuth_rad, 0.0, &REACHES_M), [0.0; 6]);
    }
}

/// On hills the horizon matches a search in small steps at every distance.
#[test]
fn hills_match_a_fine_search_at_each_distance() {
    let hills = terrain(|c, r| hills_m(c, r, 4));
    for at in [place(46.0, 8.0), place(46.613, 7.251), place(45.377, 8.707)] {
        let altitude_m = hills.elevation_m(at).unwrap();
        let sight = hills.source_horizon(at, altitude_m, 125.0);
        for number in 0..7 {
            let azimuth_rad = 0.3 + f64::from(number);
            let tangents = sight.tangents(azimuth_rad, 0.0, &REACHES_M);
            for (tangent, reach_m) in tangents.into_iter().zip(REACHES_M) {
                let expected = walked(&hills, at, altitude_m, azimuth_rad, 125.0, reach_m);
                assert!((tangent.atan() - expected.atan()).abs().to_degrees() < 0.02, "{tangent} {expected}");
            }
        }
    }
}

/// At coarse precision angles are hardly lower than at fine precision, and never far off.
#[test]
fn coarse_precision_is_close_to_fine() {
    let hills = terrain(|c, r| hills_m(c, r, 11));
    let (mut sum_deg, mut count) = (0.0, 0.0);
    for (latitude, longitude) in [(46.0, 8.0), (46.613, 7.251), (45.377, 8.707), (45.9, 7.9)] {
        let at = place(latitude, longitude);
        let altitude_m = hills.elevation_m(at).unwrap();
        let careful = hills.source_horizon(at, altitude_m, 58.0);
        let coarse = hills.source_horizon(at, altitude_m, 58.0).coarse();
        for number in 0..32 {
            let azimuth_rad = f64::from(number) * PI / 16.0;
            let tests = careful.tangents(azimuth_rad, 0.0, &REACHES_M).into_iter();
            for (careful, coarse) in tests.zip(coarse.tangents(azimuth_rad, 0.0, &REACHES_M)) {
                let off_deg = (coarse.atan() - careful.atan()).to_degrees();
                assert!(off_deg.abs() < 0.02 + 0.02 * careful.atan().to_degrees(), "{coarse} {careful}");
                (sum_deg, count) = (sum_deg + off_deg, count + 1.0);
            }
        }
    }
    let bias_deg: f64 = sum_deg / count;
    assert!((-0.05..0.01).contains(&bias_deg), "{bias_deg}");
}

/// Where rasters overlap, the first counts at every distance.
#[test]
fn the_first_raster_counts_at_each_distance() {
    let first =
        layer(
            grid(7.5, 46.8, 90),
            |c, r| if noise(c / 8, r / 8, 3) < 0.2 { f32::NAN } else { hills_m(c, r, 6) },
        );
    let second = layer(grid(7.0, 47.0, 200), |c, r| hills_m(c, r, 7) + 900.0);
    let both = Terrain::new(vec![first, second]);
    let at = place(46.3, 7.9);
    let altitude_m = both.elevation_m(at).unwrap();
    let sight = both.source_horizon(at, altitude_m, 125.0);
    for azimuth_rad in [0.1, 1.7, 3.3, 4.9] {
        for (tangent, reach_m) in sight.tangents(azimuth_rad, 0.0, &REACHES_M).into_iter().zip(REACHES_M) {
            let expected = walked(&both, at, altitude_m, azimuth_rad, 125.0, reach_m);
            assert!((tangent.atan() - expected.atan()).abs().to_degrees() < 0.03, "{tangent} {expected}");
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(32))]

    #[test]
    fn raising_terrain_never_lowers_an_angle(
        seed in 0u32..1000, column in 5u32..140, row in 5u32..140, size in 1u32..30, by in 1u32..2000,
        latitude in 45.6f64..46.9, longitude in 7.1f64..8.4, azimuth_rad in 0.0f64..6.3,
    ) {
        let low = |c: u32, r: u32| hills_m(c, r, seed).round();
        let is_raised = |c: u32, r: u32| (column..column + size).contains(&c) && (row..row + size).contains(&r);
        let high = |c: u32, r: u32| low(c, r) + if is_raised(c, r) { by as f32 } else { 0.0 };
        let at = place(latitude, longitude);
        let around = |terrain: Terrain| terrain.source_horizon(at, 1800.0, 125.0).tangents(azimuth_rad, 0.0, &REACHES_M);
        let (before, after) = (around(terrain(low)), around(terrain(high)));
        for (before, after) in before.into_iter().zip(after) {
            prop_assert!(after - before > -1e-4, "{} {}", before, after);
        }
        prop_assert!(before.windows(2).all(|pair| pair[0] <= pair[1]), "farther reaches hold nearer ones");
    }
}
