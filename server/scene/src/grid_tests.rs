use super::*;
use proptest::prelude::*;
use skyglow_physics::{EARTH_RADIUS_M, SourcePixel};

fn kenya_like() -> Grid {
    let axes = GeographicAxes {
        first_longitude_deg: 33.9,
        first_latitude_deg: 5.0625,
        longitude_step_deg: 1.0 / 240.0,
        latitude_step_deg: -1.0 / 240.0,
    };
    Grid::geographic(axes, 1924, 2348)
}

fn across_the_antimeridian() -> Grid {
    let axes = GeographicAxes {
        first_longitude_deg: 178.0,
        first_latitude_deg: -15.0,
        longitude_step_deg: 0.01,
        latitude_step_deg: -0.01,
    };
    Grid::geographic(axes, 400, 300)
}

/// The same place as the geographic grid, but through a lattice of its corners.
fn as_lattice(grid: &Grid, step: u32) -> Grid {
    let axes = grid.axes().unwrap();
    let mut nodes = Vec::new();
    for j in 0..crate::lattice::node_count(grid.height, step) {
        for i in 0..crate::lattice::node_count(grid.width, step) {
            let x = crate::lattice::node_position(i, grid.width, step);
            let y = crate::lattice::node_position(j, grid.height, step);
            let latitude_deg = axes.first_latitude_deg + y * axes.latitude_step_deg;
            let longitude_deg = axes.first_longitude_deg + x * axes.longitude_step_deg;
            nodes.push(
                GeoPoint::from_rad_unchecked(latitude_deg.to_radians(), longitude_deg.to_radians())
                    .unit_vector(),
            );
        }
    }
    Grid::from_lattice(Lattice::new(grid.width, grid.height, step, nodes).unwrap())
}

proptest! {
    /// The centre is that of the corners and lies in its own pixel.
    #[test]
    fn a_centre_lies_in_its_own_pixel(c in 0u32..400, r in 0u32..300) {
        for grid in [across_the_antimeridian(), kenya_like(), as_lattice(&across_the_antimeridian(), 8)] {
            let center = grid.center(c, r);
            let pixel = SourcePixel { corners: grid.corners(c, r), flux_dnb_w: 1.0, altitude_m: 0.0 };
            prop_assert!(center.distance(pixel.center()) * EARTH_RADIUS_M < 1e-6);
            prop_assert_eq!(grid.pixel_at(GeoPoint::from_vector(center)), Some((c, r)));
        }
    }

    /// A lattice agrees with the grid that it was made from.
    #[test]
    fn a_lattice_agrees_with_its_grid(x in 0.0f64..400.0, y in 0.0f64..300.0) {
        let exact = across_the_antimeridian();
        let lattice = as_lattice(&exact, 16);
        let place = GeoPoint::from_rad_unchecked(
            (-15.0 - 0.01 * y).to_radians(),
            (178.0 + 0.01 * x).to_radians(),
        );
        let (column, row) = lattice.position_of(place).unwrap();
        prop_assert!((column - x).abs() < 0.02 && (row - y).abs() < 0.02, "{column} {x} {row} {y}");
        let (c, r) = exact.pixel_at(place).unwrap();
        let ratio = lattice.area_m2(c, r) / exact.area_m2(c, r);
        prop_assert!((ratio - 1.0).abs() < 1e-3, "{ratio}");
    }
}

/// Bounds across the antimeridian have west greater than east.
#[test]
fn antimeridian_bounds_have_west_above_east() {
    for grid in [across_the_antimeridian(), as_lattice(&across_the_antimeridian(), 16)] {
        let [west, south, east, north] = grid.bounds_deg();
        assert!((west - 178.0).abs() < 1e-9 && (east + 178.0).abs() < 1e-9, "{west} {east}");
        assert!((south + 18.0).abs() < 1e-9 && (north + 15.0).abs() < 1e-9);
    }
}

/// A grid from 0° to 360° contains every longitude once.
#[test]
fn a_grid_of_360_degrees_has_no_duplicates() {
    let axes = GeographicAxes {
        first_longitude_deg: 0.0,
        first_latitude_deg: 90.0,
        longitude_step_deg: 0.5,
        latitude_step_deg: -0.5,
    };
    let grid = Grid::geographic(axes, 720, 360);
    assert_eq!(grid.bounds_deg(), [-180.0, -90.0, 180.0, 90.0]);
    let pixel = |lat, lon| grid.pixel_at(GeoPoint::from_deg(lat, lon).unwrap());
    assert_eq!(pixel(0.1, -0.1), Some((719, 179)));
    assert_eq!(pixel(0.1, 359.9), Some((719, 179)));
    assert_eq!(pixel(90.0, 0.1), Some((0, 0)));
    assert_eq!(pixel(-90.0, 180.0), Some((360, 359)));
    let whole: f64 = (0..360).map(|r| 720.0 * grid.area_m2(0, r)).sum();
    let sphere = 4.0 * std::f64::consts::PI * EARTH_RADIUS_M * EARTH_RADIUS_M;
    assert!((whole / sphere - 1.0).abs() < 1e-12);
}

#[test]
fn places_outside_are_no_pixel() {
    let grid = kenya_like();
    for (lat, lon) in [(5.07, 36.0), (-4.73, 36.0), (0.0, 33.89), (0.0, 41.95), (0.0, -36.0)] {
        assert_eq!(grid.pixel_at(GeoPoint::from_deg(lat, lon).unwrap()), None, "{lat} {lon}");
    }
}
