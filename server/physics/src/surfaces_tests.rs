//! Tests of [`super`].

use super::*;
use crate::{panorama::elevation_rad, spectrum::Spectrum};
use proptest::prelude::*;

/// ∫ L max(0, n·v) dΩ, direction by direction.
fn direct(plane: &[f32], normal: DVec3) -> f64 {
    let mut sum = 0.0;
    for row in 0..ELEVATION_COUNT {
        for column in 0..AZIMUTH_COUNT {
            let v = Direction { azimuth_rad: azimuth_rad(column), elevation_rad: elevation_rad(row) }.enu();
            sum +=
                f64::from(plane[row * AZIMUTH_COUNT + column]) * v.dot(normal).max(0.0) * solid_angle_sr(row);
        }
    }
    sum
}

fn wall(azimuth_deg: f64) -> DVec3 {
    Direction { azimuth_rad: azimuth_deg.to_radians(), elevation_rad: 0.0 }.enu()
}

/// Glow of a town: bright and low on one side.
fn town(azimuth_deg: f64, width_deg: f64) -> Vec<f32> {
    let of = |row: usize, column: usize| {
        let away = (azimuth_rad(column) - azimuth_deg.to_radians()).sin() / width_deg.to_radians();
        let before = (azimuth_rad(column) - azimuth_deg.to_radians()).cos() > 0.0;
        let glow = if before { (-away * away - 6.0 * elevation_rad(row)).exp() } else { 0.0 };
        (1e-3 * glow + 1e-5) as f32
    };
    (0..ELEVATION_COUNT * AZIMUTH_COUNT).map(|at| of(at / AZIMUTH_COUNT, at % AZIMUTH_COUNT)).collect()
}

/// A uniform sky of luminance L gives πL on level ground, half of it on walls, cylinder and sphere.
#[test]
fn a_uniform_sky_is_known() {
    let sums = SurfaceSums::of_even(2.0, &Horizon::flat(), Slope::default());
    let light = sums.illuminance();
    for (value, expected) in [
        (light.horizontal, 2.0 * PI),
        (light.slope, 2.0 * PI),
        (light.vertical_north, PI),
        (light.vertical_west, PI),
        (light.vertical_largest, PI),
        (light.cylindrical, PI),
        (light.spherical, PI),
    ] {
        assert!((value / expected - 1.0).abs() < 2e-4, "{value} {expected}");
    }
    // A slope of angle s sees (1 + cos s)/2 of it.
    let steep = Slope { steepness_rad: 0.7, downhill_azimuth_rad: 4.0 };
    let on_slope = SurfaceSums::of_even(2.0, &Horizon::flat(), steep).illuminance().slope;
    assert!((on_slope / (PI * (1.0 + 0.7f64.cos())) - 1.0).abs() < 2e-4, "{on_slope}");
}

/// Ground that rises to the east falls to the west.
#[test]
fn slopes_fall_where_ground_does() {
    let slope = Slope::of_gradient(1.0, 0.0);
    assert!((slope.steepness_rad.to_degrees() - 45.0).abs() < 1e-9);
    assert!((slope.downhill_azimuth_rad.to_degrees() - 270.0).abs() < 1e-9);
    assert!(slope.normal().distance(DVec3::new(-0.5f64.sqrt(), 0.0, 0.5f64.sqrt())) < 1e-12);
    assert_eq!(Slope::of_gradient(0.0, 0.0), Slope::default());
    assert!(Slope::default().normal().distance(DVec3::Z) < 1e-12);
}

/// One beam lights surfaces by the cosine of its angle.
#[test]
fn a_beam_lights_by_its_cosine() {
    let light = Arc::new(Light::new(Spectrum::from_fn(|_| 1.0)));
    let direction = Direction { azimuth_rad: 1.234, elevation_rad: 0.5 };
    let slope = Slope { steepness_rad: 0.3, downhill_azimuth_rad: 1.0 };
    let beams = [BeamSums::new(Arc::clone(&light), slope, [(direction, [1.0; NODE_COUNT])].into_iter())];
    let one = light.rule(&Response::Photopic).value([1.0; NODE_COUNT]);
    let dark = SurfaceSums::of_plane(&[], slope);
    let found = dark.plus_beams(&beams, &Response::Photopic).illuminance();
    let v = direction.enu();
    for (value, expected) in [
        (found.horizontal, v.z),
        (found.slope, v.dot(slope.normal())),
        (found.vertical_north, v.y),
        (found.vertical_east, v.x),
        (found.vertical_largest, 0.5f64.cos()),
        (found.cylindrical, 0.5f64.cos() / PI),
        (found.spherical, 0.25),
    ] {
        assert!((value / one - expected).abs() < 2e-4, "{value} {expected}");
    }
    assert_eq!((found.vertical_south, found.vertical_west), (0.0, 0.0));
    assert!((found.vertical_largest_azimuth_deg - 1.234f64.to_degrees()).abs() < 1.0);
    assert!((beams[0].horizontal(&Response::Photopic) / one - v.z).abs() < 1e-12);
}

/// Units of illuminances follow from those of radiances.
#[test]
fn units_lose_the_steradian() {
    let sums = SurfaceSums::of_plane(&[], Slope::default());
    let unit = |response: Response| SurfaceLight::new(&response, &sums, &sums).unit;
    assert_eq!(unit(Response::Melanopic), "lx");
    assert_eq!(unit(Response::Dnb), "nW cm-2");
    assert_eq!(unit(Response::Band { from_nm: 400, to_nm: 500 }), "W m-2");
}

proptest! {
    /// Every surface under any glow receives what the sum over all directions says, within 0.3 % of the largest wall.
    #[test]
    fn surfaces_are_sums_over_directions(
        azimuth_deg in 0.0..360.0f64,
        width_deg in 3.0..60.0f64,
        steepness_rad in 0.0..1.4f64,
        downhill_azimuth_rad in 0.0..6.2f64,
    ) {
        let plane = town(azimuth_deg, width_deg);
        let slope = Slope { steepness_rad, downhill_azimuth_rad };
        let found = SurfaceSums::of_plane(&plane, slope).illuminance();
        for (value, normal) in [
            (found.horizontal, DVec3::Z),
            (found.slope, slope.normal()),
            (found.vertical_north, wall(0.0)),
            (found.vertical_east, wall(90.0)),
            (found.vertical_south, wall(180.0)),
            (found.vertical_west, wall(270.0)),
            (found.vertical_largest, wall(found.vertical_largest_azimuth_deg)),
        ] {
            let expected = direct(&plane, normal);
            prop_assert!((value - expected).abs() < 3e-3 * found.vertical_largest, "{} {}", value, expected);
            prop_assert!(expected < found.vertical_largest * 1.001 || normal.z > 0.0);
        }
        let walls = (0..360).map(|at| direct(&plane, wall(f64::from(at)))).sum::<f64>() / 360.0;
        prop_assert!((found.cylindrical / walls - 1.0).abs() < 3e-3);
    }
}
