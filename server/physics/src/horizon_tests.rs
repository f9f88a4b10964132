use super::*;
use crate::{
    geometry::{GeoPoint, LocalFrame},
    lamp::Lamp,
    panorama::azimuth_rad,
    seen_sky::SkyPart,
    sky_quantities::quantities_over,
};
use proptest::prelude::*;

/// The elevation of a terrain point by vectors in space, radians.
fn elevation_by_vectors_rad(observer_altitude_m: f64, terrain_altitude_m: f64, distance_m: f64) -> f64 {
    let place = GeoPoint::from_deg(46.0, 7.7).unwrap();
    let there = place.destination(1.1, distance_m).unit_vector() * (EARTH_RADIUS_M + terrain_altitude_m);
    let up = LocalFrame::at(place).up;
    let line = there - up * (EARTH_RADIUS_M + observer_altitude_m);
    line.dot(up).atan2((line - up * line.dot(up)).length())
}

fn uniform(radiance_w_m2_sr: f32) -> Panorama {
    Panorama::from_samples(vec![radiance_w_m2_sr; Panorama::LEN]).unwrap()
}

/// A wall rises by its angle less the curvature of the Earth.
#[test]
fn a_wall_is_lowered_by_earth_curvature() {
    // 1000 m at 10 km: atan(0.1) less d/2R of drop.
    let tangent = terrain_elevation_tangent(0.0, 1000.0, 10_000.0);
    assert!((tangent - (0.1 - 10_000.0 / (2.0 * EARTH_RADIUS_M))).abs() < 3e-5, "{tangent}");
    // At 200 km the Earth has dropped by 3139 m.
    assert!(terrain_elevation_tangent(0.0, 3_000.0, 200_000.0) < 0.0);
    assert!(terrain_elevation_tangent(0.0, 3_300.0, 200_000.0) > 0.0);
}

/// Terrain no higher than the eye is never above its horizontal plane.
#[test]
fn lower_terrain_is_below_the_horizontal() {
    assert_eq!(farthest_terrain_m(1000.0, 1000.0), 0.0);
    assert_eq!(farthest_terrain_m(1000.0, 10.0), 0.0);
    assert!(
        (farthest_terrain_m(0.0, 4_725.0) - 245_300.0).abs() < 200.0,
        "{}",
        farthest_terrain_m(0.0, 4_725.0)
    );
}

/// Wrong numbers of elevations and angles outside the sky are refused by name.
#[test]
fn invalid_horizons_are_refused() {
    for bad in
        [vec![0.0; 255], vec![-0.1; AZIMUTH_COUNT], vec![f64::NAN; AZIMUTH_COUNT], vec![1.6; AZIMUTH_COUNT]]
    {
        assert!(Horizon::new(bad).unwrap_err().to_string().starts_with("horizon"));
    }
    assert!(Horizon::flat().is_flat() && !Horizon::new(vec![0.1; AZIMUTH_COUNT]).unwrap().is_flat());
}

/// A sky of the default lamp.
fn part(kernel: &Panorama) -> SkyPart {
    SkyPart { light: std::sync::Arc::clone(Lamp::default().light()), kernel: kernel.clone() }
}

/// Between columns the horizon is linear, and it wraps around north.
#[test]
fn the_horizon_is_linear_between_columns() {
    let mut elevations = vec![0.0; AZIMUTH_COUNT];
    (elevations[255], elevations[0]) = (0.2, 0.4);
    let horizon = Horizon::new(elevations).unwrap();
    assert_eq!(horizon.elevation_at_rad(azimuth_rad(255)), 0.2);
    assert_eq!(horizon.elevation_at_rad(0.0), 0.4);
    assert!((horizon.elevation_at_rad(-TAU / 512.0) - 0.3).abs() < 1e-12);
    assert!((horizon.elevation_at_rad(azimuth_rad(1) - TAU / 1024.0) - 0.1).abs() < 1e-12);
}

#[test]
fn a_flat_horizon_changes_no_bit() {
    let mut panorama = uniform(1e-7);
    Horizon::flat().darken(&mut panorama);
    assert_eq!(panorama, uniform(1e-7));
}

/// A wall of 45 degrees all around leaves half of the light on the ground and all of the mean.
#[test]
fn a_45_degree_wall_halves_illuminance() {
    let horizon = Horizon::new(vec![std::f64::consts::FRAC_PI_4; AZIMUTH_COUNT]).unwrap();
    let mut panorama = uniform(1e-6);
    let open = quantities_over(&[part(&panorama)], &Horizon::flat());
    horizon.darken(&mut panorama);
    let walled = quantities_over(&[part(&panorama)], &horizon);
    // E = πL·cos²45° for a uniform sky; rows end at 45°.
    assert!((walled.horizontal_illuminance_lx / open.horizontal_illuminance_lx - 0.5).abs() < 1e-9);
    assert!(
        (walled.horizontal_total_illuminance_lx / open.horizontal_total_illuminance_lx - 0.5).abs() < 1e-9
    );
    assert!((walled.mean_luminance_cd_m2 / open.mean_luminance_cd_m2 - 1.0).abs() < 1e-9);
    assert_eq!(walled.zenith_luminance_cd_m2, open.zenith_luminance_cd_m2);
    assert!(walled.brightest_elevation_deg > 45.0);
}

/// A sky hidden altogether has finite quantities without light.
#[test]
fn a_fully_hidden_sky_is_finite() {
    let horizon = Horizon::new(vec![FRAC_PI_2; AZIMUTH_COUNT]).unwrap();
    let mut panorama = uniform(1e-6);
    horizon.darken(&mut panorama);
    let quantities = quantities_over(&[part(&panorama)], &horizon);
    assert_eq!((quantities.mean_luminance_cd_m2, quantities.horizontal_illuminance_lx), (0.0, 0.0));
    assert!(quantities.horizontal_total_illuminance_lx.abs() < 1e-12);
    assert_eq!(quantities.zenith_brightness_mag_arcsec2, None);
    assert!(quantities.sqm_total_brightness_mag_arcsec2.is_some_and(f64::is_finite));
}

fn any_horizon() -> impl Strategy<Value = Horizon> {
    proptest::collection::vec(prop_oneof![Just(0.0), 0.0..FRAC_PI_2], AZIMUTH_COUNT)
        .prop_map(|elevations| Horizon::new(elevations).unwrap())
}

proptest! {
    /// The elevation of a terrain point is that of the straight line to it.
    #[test]
    fn terrain_elevation_is_that_of_the_line(
        eye in 0.0f64..6000.0, terrain in 0.0f64..9000.0, distance in 1.0f64..400_000.0,
    ) {
        let tangent = terrain_elevation_tangent(eye, terrain, distance);
        let expected = elevation_by_vectors_rad(eye, terrain, distance);
        // Vectors of 6371 km know a place to a nanometre or two.
        prop_assert!((tangent.atan() - expected).abs() < 1e-8 + 1e-8 / distance, "{} {}", tangent.atan(), expected);
    }

    /// Elevation rises with height and, above the eye, falls with distance.
    #[test]
    fn elevation_rises_with_height(
        eye in 0.0f64..6000.0, above in 0.0f64..4000.0, more in 0.1f64..500.0,
        distance in 1.0f64..300_000.0, farther in 1.01f64..2.0,
    ) {
        let at = |altitude, distance| terrain_elevation_tangent(eye, altitude, distance);
        prop_assert!(at(eye + above + more, distance) > at(eye + above, distance));
        let tangent = at(eye + above, distance);
        prop_assert!(tangent <= 0.0 || at(eye + above, distance * farther) < tangent);
        let end_m = farthest_terrain_m(eye, eye + above);
        prop_assert!(at(eye + above, end_m * 1.001 + 1.0) < 0.0);
        prop_assert!(above < 1.0 || at(eye + above, end_m * 0.999) > 0.0);
    }

    /// The mask makes nothing brighter and leaves what is visible.
    #[test]
    fn masking_only_darkens_hidden_samples(horizon in any_horizon(), seed in 0u32..1000) {
        let samples = (0..Panorama::LEN).map(|i| 1e-9 * ((i as u32 ^ seed) % 977) as f32).collect();
        let open = Panorama::from_samples(samples).unwrap();
        let mut masked = open.clone();
        horizon.darken(&mut masked);
        for row in 0..ELEVATION_COUNT {
            for column in 0..AZIMUTH_COUNT {
                for band in 0..BAND_COUNT {
                    let (before, after) = (open.radiance_w_m2_sr(band, row, column), masked.radiance_w_m2_sr(band, row, column));
                    let expected = if horizon.hides_sample(row, column) { 0.0 } else { before };
                    prop_assert_eq!(after, expected);
                }
                let direction = Direction { azimuth_rad: azimuth_rad(column), elevation_rad: elevation_rad(row) };
                prop_assert_eq!(horizon.hides(direction), horizon.hides_sample(row, column));
            }
        }
        let (all, seen) = (quantities_over(&[part(&open)], &Horizon::flat()), quantities_over(&[part(&masked)], &horizon));
        prop_assert!(seen.horizontal_illuminance_lx <= all.horizontal_illuminance_lx);
        prop_assert!(seen.horizontal_total_illuminance_lx <= all.horizontal_total_illuminance_lx);
        prop_assert!(seen.brightest_luminance_cd_m2 <= all.brightest_luminance_cd_m2);
    }
}
