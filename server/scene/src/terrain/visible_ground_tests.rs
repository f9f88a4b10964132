use super::*;
use crate::terrain::synthetic_ground::{grid, hills_m, layer, place};
use skyglow_physics::{AZIMUTH_COUNT, panorama::azimuth_rad};
use std::f64::consts::{PI, TAU};

fn hills() -> Terrain {
    Terrain::new(vec![layer(grid(7.0, 47.0, 100), |column, row| hills_m(column, row, 3))])
}

fn all_round(terrain: &Terrain, height_m: f64, lowest_tangent: f64) -> Vec<GroundLine> {
    let at = place(46.5, 7.5);
    let eye_m = terrain.elevation_m(at).unwrap_or_default() + height_m;
    let step_rad = TAU / AZIMUTH_COUNT as f64;
    terrain.visible_ground(
        at,
        eye_m,
        &GroundSight { azimuths: (0.0, step_rad, AZIMUTH_COUNT), lowest_tangent },
    )
}

/// The highest ground of each line is the horizon that the exact search finds, within 0.2°, and 0.02° in the mean.
#[test]
fn the_last_ground_is_the_horizon() {
    let terrain = hills();
    let at = place(46.5, 7.5);
    let eye_m = terrain.elevation_m(at).unwrap() + 2.0;
    let horizon = terrain.horizon(at, eye_m);
    let lines = all_round(&terrain, 2.0, f64::NEG_INFINITY);
    let errors: Vec<f64> = (0..AZIMUTH_COUNT)
        .filter(|column| horizon.elevations_rad()[*column] > 0.0)
        .map(|column| {
            assert!((lines[column].azimuth_rad - azimuth_rad(column)).abs() < 1e-9);
            let top = lines[column].seen.last().unwrap().tangent.atan();
            (top - horizon.elevations_rad()[column]).to_degrees()
        })
        .collect();
    let mean = errors.iter().map(|error| error.abs()).sum::<f64>() / errors.len() as f64;
    assert!(errors.len() > 200 && mean < 0.02, "{mean} of {}", errors.len());
    assert!(errors.iter().all(|error| error.abs() < 0.2), "{errors:?}");
}

/// Ground comes front to back and ever higher in the view; something behind a ridge is not shown, something above it is.
#[test]
fn lines_run_front_to_back() {
    let lines = all_round(&hills(), 2.0, f64::NEG_INFINITY);
    let mut ridges = 0;
    for line in &lines {
        let increasing = |value: fn(&SeenGround) -> f64| line.seen.is_sorted_by(|a, b| value(a) < value(b));
        assert!(increasing(|ground| ground.distance_m) && increasing(|ground| ground.tangent));
        for pair in line.seen.windows(2).filter(|pair| pair[1].is_behind_ridge) {
            ridges += 1;
            let between_m = 0.5 * (pair[0].distance_m + pair[1].distance_m);
            assert!(!line.shows(between_m, pair[0].tangent - 1e-3));
            assert!(line.shows(between_m, pair[0].tangent + 1e-3));
        }
    }
    assert!(ridges > 100, "{ridges}");
}

/// An inclined plane has its own slope everywhere, and sea level has none.
#[test]
fn slopes_are_those_of_the_plane() {
    // 0.01° of latitude is 1 112 m: rows fall by 200 m to the south.
    let plane = Terrain::new(vec![layer(grid(7.0, 47.0, 100), |_, row| 30_000.0 - 200.0 * row as f32)]);
    let lines = all_round(&plane, 500.0, f64::NEG_INFINITY);
    let mut count = 0;
    for ground in lines.iter().flat_map(|line| &line.seen).filter(|ground| ground.distance_m < 20_000.0) {
        count += 1;
        let expected = (200.0f64 / 1_111.9).atan();
        assert!((ground.slope.steepness_rad / expected - 1.0).abs() < 0.05, "{ground:?}");
        assert!((ground.slope.downhill_azimuth_rad - PI).abs() < 0.05, "{ground:?}");
    }
    assert!(count > 10_000, "{count}");
    let sea = all_round(&Terrain::default(), 10.0, f64::NEG_INFINITY);
    assert!(sea.iter().flat_map(|line| &line.seen).all(|ground| ground.slope == Slope::default()));
    let farthest_m = sea[0].seen.last().unwrap().distance_m;
    assert!((farthest_m / (2.0 * EARTH_RADIUS_M * 10.0).sqrt() - 1.0).abs() < 0.1, "{farthest_m}");
}
