use super::super::raster::TerrainRaster;
use super::*;
use crate::grid::{GeographicAxes, Grid};
use crate::lattice::{Lattice, node_count, node_position};
use crate::terrain::synthetic_ground::{STEP_DEG, grid, hills_m, layer, noise, place};
use proptest::prelude::*;
use skyglow_physics::EARTH_RADIUS_M;
use skyglow_physics::horizon::terrain_elevation_tangent;

/// The largest difference [degrees] from a walk in small steps over some columns's line of sight.
fn worst_error_deg(terrain: &Terrain, place: GeoPoint, height_m: f64, farthest_m: f64) -> f64 {
    let eye_m = terrain.ground(place).altitude_m() + height_m;
    let horizon = terrain.horizon(place, eye_m);
    let mut worst = 0.0f64;
    for column in (0..AZIMUTH_COUNT).step_by(19) {
        let (mut tangent, mut distance_m) = (0.0f64, crate::terrain::ray::MIN_GROUND_DISTANCE_M);
        while distance_m < farthest_m {
            if let Some(altitude_m) = terrain.elevation_m(place.destination(azimuth_rad(column), distance_m))
            {
                tangent = tangent.max(terrain_elevation_tangent(eye_m, altitude_m, distance_m));
            }
            distance_m += (distance_m / 1500.0).clamp(0.1, 30.0);
        }
        worst = worst.max((horizon.elevations_rad()[column] - tangent.atan()).abs().to_degrees());
    }
    worst
}

#[test]
fn a_plain_a_summit_and_the_sea_hide_nothing() {
    let plain = Terrain::new(vec![layer(grid(7.0, 47.0, 100), |_, _| 433.3)]);
    for height_m in [0.0, 0.5, 2.0, 100.0] {
        for at in [place(46.5, 7.5), place(46.5031, 7.4077), place(46.9999, 7.0001), place(46.0, 8.0)] {
            let ground_m = plain.elevation_m(at).unwrap();
            assert_eq!(plain.horizon(at, ground_m + height_m), Horizon::flat(), "{height_m} {at:?}");
        }
    }
    // A cone whose top is a sample.
    let cone = |column: u32, row: u32| {
        let (x, y) = (f64::from(column) - 50.0, f64::from(row) - 50.0);
        (3000.0 - 40.0 * x.hypot(y)) as f32
    };
    let summit = Terrain::new(vec![layer(grid(7.0, 47.0, 101), cone)]);
    let top = place(46.495, 7.505);
    assert!(summit.horizon(top, summit.elevation_m(top).unwrap()).is_flat());
    assert!(!summit.horizon(place(46.3, 7.505), 2300.0).is_flat());
    let sea = Terrain::new(vec![layer(grid(7.0, 47.0, 100), |_, _| f32::NAN)]);
    assert!(sea.horizon(place(46.5, 7.5), 2.0).is_flat());
}

/// A wall on a plain has the elevation angle of its top, with the Earth's curvature.
#[test]
fn a_wall_has_the_angle_of_its_top() {
    // A wall along a meridian, 30 columns east of the observer.
    let wall = |height_m: f32| move |column: u32, _: u32| if column == 80 { 200.0 + height_m } else { 200.0 };
    let at = place(46.5, 7.505);
    for (height_m, eye_m) in [(100.0f32, 202.0), (1000.0, 202.0), (3000.0, 1200.0)] {
        let terrain = Terrain::new(vec![layer(grid(7.0, 47.0, 100), wall(height_m))]);
        let horizon = terrain.horizon(at, eye_m);
        let frame = LocalFrame::at(at);
        let mut checked = 0;
        for column in 56..=72 {
            // Where the line of sight meets the meridian of the wall.
            let (mut near_m, mut far_m) = (0.0, 60_000.0);
            for _ in 0..60 {
                let middle_m = 0.5 * (near_m + far_m);
                let is_before = at.destination(azimuth_rad(column), middle_m).longitude_deg() < 7.805;
                *if is_before { &mut near_m } else { &mut far_m } = middle_m;
            }
            let expected = terrain_elevation_tangent(eye_m, 200.0 + f64::from(height_m), near_m).atan();
            let found = horizon.elevations_rad()[column];
            assert!((found - expected).abs().to_degrees() < 0.002, "{column}: {found} {expected}");
            checked += 1;
        }
        assert_eq!(checked, 17);
        // Nothing in the west.
        assert!((150..230).all(|column| horizon.elevations_rad()[column] == 0.0));
        assert!(frame.up.is_normalized());
    }
}

/// A ridge hidden by the Earth's curvature is not seen.
#[test]
fn a_ridge_beyond_the_curvature_is_not_seen() {
    // 2.4° along the meridian are 267 km: the Earth has dropped by 5590 m.
    let ridge = |height_m: f32| move |_: u32, row: u32| if row == 5 { height_m } else { 0.0 };
    let seen = |height_m: f32| {
        let terrain = Terrain::new(vec![layer(grid(7.0, 47.0, 300), ridge(height_m))]);
        terrain.horizon(place(46.945 - 2.4, 8.5), 0.0).elevations_rad()[0]
    };
    assert_eq!(seen(5500.0), 0.0);
    assert!(seen(5700.0) > 0.0 && seen(5700.0).to_degrees() < 0.05, "{}", seen(5700.0));
}

#[test]
fn hills_agree_with_a_walk_over_them() {
    for (seed, latitude_deg) in [(1, 47.0), (2, 1.0), (3, -60.0), (4, 79.0)] {
        let terrain = Terrain::new(vec![layer(grid(7.0, latitude_deg, 260), |c, r| hills_m(c, r, seed))]);
        for at in
            [place(latitude_deg - 1.3, 8.3), place(latitude_deg - 0.2, 9.1), place(latitude_deg - 2.61, 7.03)]
        {
            let worst_deg = worst_error_deg(&terrain, at, 2.0, 250_000.0);
            assert!(worst_deg < 0.02, "{seed} {at:?}: {worst_deg}");
        }
    }
}

#[test]
fn voids_are_no_ground_and_no_wall() {
    let holes = |c: u32, r: u32| if noise(c / 3, r / 3, 9) < 0.3 { f32::NAN } else { hills_m(c, r, 5) };
    let terrain = Terrain::new(vec![layer(grid(7.0, 47.0, 200), holes)]);
    for at in [place(46.0, 8.0), place(45.503, 7.503), place(46.312, 8.777)] {
        let worst_deg = worst_error_deg(&terrain, at, 2.0, 180_000.0);
        assert!(worst_deg < 0.02, "{at:?}: {worst_deg}");
    }
    // An island of ground around the observer, and nothing else.
    let island =
        |c: u32, r: u32| if (90..110).contains(&c) && (90..110).contains(&r) { 800.0 } else { f32::NAN };
    let terrain = Terrain::new(vec![layer(grid(7.0, 47.0, 200), island)]);
    assert!(terrain.horizon(place(46.0, 8.0), 802.0).is_flat());
}

/// Where rasters overlap, the first counts for the horizon too.
#[test]
fn the_first_raster_counts_for_the_horizon() {
    // The second is higher everywhere, and must be seen only where the first has no value.
    let first =
        layer(
            grid(7.5, 46.8, 90),
            |c, r| if noise(c / 8, r / 8, 3) < 0.2 { f32::NAN } else { hills_m(c, r, 6) },
        );
    let second = layer(grid(7.0, 47.0, 200), |c, r| hills_m(c, r, 7) + 900.0);
    let terrain = Terrain::new(vec![first, second]);
    for at in [place(46.3, 7.9), place(46.0, 7.2), place(46.75, 8.9)] {
        let worst_deg = worst_error_deg(&terrain, at, 2.0, 160_000.0);
        assert!(worst_deg < 0.02, "{at:?}: {worst_deg}");
    }
}

#[test]
fn a_layer_in_a_projection_is_looked_along_too() {
    // A plane of 500 m pixels that touches the sphere, turned by 30°.
    let (size, step, pixel_rad) = (200u32, 8u32, 500.0 / EARTH_RADIUS_M);
    let frame = LocalFrame::at(place(60.0, 25.0));
    let node = |i: u32, j: u32| {
        let (x, y) = (node_position(i, size, step) - 100.0, node_position(j, size, step) - 100.0);
        let (sin, cos) = 30f64.to_radians().sin_cos();
        let (east, north) = (cos * x + sin * y, sin * x - cos * y);
        (frame.up + (frame.east * east + frame.north * north) * pixel_rad).normalize()
    };
    let nodes = node_count(size, step);
    let nodes = (0..nodes * nodes).map(|n| node(n % nodes, n / nodes)).collect();
    let lattice = Grid::from_lattice(Lattice::new(size, size, step, nodes).unwrap());
    let terrain = Terrain::new(vec![layer(lattice, |c, r| hills_m(c, r, 8))]);
    // Inside, near a corner, and outside.
    for at in [place(60.0, 25.0), place(60.4, 25.5), place(60.9, 25.0), place(59.0, 24.0)] {
        let worst_deg = worst_error_deg(&terrain, at, 2.0, 150_000.0);
        assert!(worst_deg < 0.02, "{at:?}: {worst_deg}");
    }
}

#[test]
fn a_grid_around_the_whole_earth_has_no_seam() {
    let axes = GeographicAxes {
        first_longitude_deg: -180.0,
        first_latitude_deg: 10.0,
        longitude_step_deg: 0.25,
        latitude_step_deg: -0.25,
    };
    let ridge = |column: u32, _: u32| if column == 2 { 4000.0 } else { 0.0 };
    let terrain = Terrain::new(vec![layer(Grid::geographic(axes, 1440, 80), ridge)]);
    // 0.8° west of the ridge, across the antimeridian, and 0.8° east of it.
    let (west, east) = (place(0.1, 179.825), place(0.1, -178.575));
    let (seen_east, seen_west) = (terrain.horizon(west, 2.0), terrain.horizon(east, 2.0));
    assert!(seen_east.elevations_rad()[64].to_degrees() > 2.0, "{:?}", seen_east.elevations_rad()[64]);
    assert!((seen_east.elevations_rad()[64] - seen_west.elevations_rad()[192]).abs() < 1e-6);
}

/// The maximum mipmap is built at the first horizon query and not before.
#[test]
fn maxima_are_built_lazily() {
    let made = Terrain::new(vec![layer(grid(7.0, 47.0, 50), |c, r| hills_m(c, r, 1))]);
    let sections = made.to_sections();
    let packed = crate::sections::pack(&sections).unwrap();
    let opened = Terrain::from_sections(&crate::sections::Sections::parse(&packed).unwrap(), None).unwrap();
    opened.ground(place(46.8, 7.2));
    assert!(!opened.rasters[0].has_maxima());
    assert!(!opened.horizon(place(46.8, 7.2), 1000.0).is_flat());
    assert!(opened.rasters[0].has_maxima());
}

/// From the ground itself a slope that flattens is seen where it begins.
#[test]
fn a_flattening_slope_is_seen_from_the_ground() {
    // Between samples, where lines of sight bend with the ground that they cross.
    let terrain = Terrain::new(vec![layer(grid(7.0, 47.0, 150), |c, r| hills_m(c, r, 808))]);
    for at in [place(46.57683003501028, 7.1), place(46.31, 7.7312), place(46.0807, 8.2009)] {
        for height_m in [0.0, 0.1] {
            let worst_deg = worst_error_deg(&terrain, at, height_m, 200_000.0);
            assert!(worst_deg < 0.02, "{at:?} from {height_m} m: {worst_deg}");
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    #[test]
    fn raising_terrain_never_lowers_the_horizon(
        seed in 0u32..1000, column in 5u32..140, row in 5u32..140, size in 1u32..30, by in 1u32..2000,
        latitude in 45.6f64..46.9, longitude in 7.1f64..8.4,
    ) {
        // Whole metres are stored exactly.
        let low = |c: u32, r: u32| hills_m(c, r, seed).round();
        let is_raised = |c: u32, r: u32| (column..column + size).contains(&c) && (row..row + size).contains(&r);
        let high = |c: u32, r: u32| low(c, r) + if is_raised(c, r) { by as f32 } else { 0.0 };
        let at = place(latitude, longitude);
        let horizon_over = |terrain: TerrainRaster| Terrain::new(vec![terrain]).horizon(at, 1800.0);
        let before = horizon_over(layer(grid(7.0, 47.0, 150), low));
        let after = horizon_over(layer(grid(7.0, 47.0, 150), high));
        for (before, after) in before.elevations_rad().iter().zip(after.elevations_rad()) {
            prop_assert!(after - before > -1e-4, "{} {}", before, after);
        }
    }

    #[test]
    fn a_higher_eye_sees_a_lower_horizon(
        seed in 0u32..1000, latitude in 45.6f64..46.9, longitude in 7.1f64..8.4, up_m in 0.1f64..500.0,
    ) {
        let terrain = Terrain::new(vec![layer(grid(7.0, 47.0, 150), |c, r| hills_m(c, r, seed))]);
        let at = place(latitude, longitude);
        let eye_m = terrain.elevation_m(at).unwrap_or(1000.0);
        let (low, high) = (terrain.horizon(at, eye_m), terrain.horizon(at, eye_m + up_m));
        for (low, high) in low.elevations_rad().iter().zip(high.elevations_rad()) {
            prop_assert!(high <= low);
        }
    }

    #[test]
    fn the_bounds_hold_every_point(
        seed in 0u32..1000, size in 1u32..300, latitude in 0.0f64..1.0, longitude in 0.0f64..1.0, extent in 0usize..200,
    ) {
        let terrain = layer(grid(7.0, 47.0, size), |c, r| if noise(c, r, seed) < 0.1 { f32::NAN } else { hills_m(c, r, seed) });
        let side_deg = STEP_DEG * f64::from(size);
        let at = place(47.0 - latitude * side_deg, 7.0 + longitude * side_deg);
        let (Some((column, row)), Some(height_m)) = (terrain.grid().position_of(at), terrain.bilinear_m(0, at)) else {
            return Ok(());
        };
        let (u, v) = ((column + 0.5) as usize, (row + 0.5) as usize);
        let bounds = terrain.maxima();
        let over = |extent: usize| bounds.max_over_m(u.saturating_sub(extent)..=u + extent, v.saturating_sub(extent)..=v);
        prop_assert!(over(0) >= height_m - 1e-9);
        prop_assert!(over(extent) >= over(0) && bounds.highest_m() >= over(extent));
    }
}
