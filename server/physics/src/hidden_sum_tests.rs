use super::*;
use crate::{
    CloudBase, Turbidity, direct_sum::direct_sum, horizon::terrain_elevation_tangent, panorama::Direction,
};

/// Another flux in every band.
const FLUX_PER_DNB_FLUX: [f64; crate::BAND_COUNT] = [0.4, 0.5, 0.3, 0.1];
const OBSERVER_ALTITUDE_M: f64 = 300.0;
const SOURCE_ALTITUDE_M: f64 = 120.0;
const SOURCE_AZIMUTH_RAD: f64 = 0.7;

fn place() -> GeoPoint {
    GeoPoint::from_deg(46.0, 8.0).unwrap()
}

fn source(distance_m: f64) -> PointSource {
    PointSource {
        azimuth_rad: SOURCE_AZIMUTH_RAD,
        distance_m,
        altitude_m: SOURCE_ALTITUDE_M,
        flux_dnb_w: 1e6,
    }
}

fn atmosphere() -> Atmosphere {
    Atmosphere::new(Turbidity::default())
}

fn view_directions() -> Vec<Direction> {
    [(0.0, 0.03), (0.3, 0.2), (1.2, 0.5), (2.5, 0.9), (3.1, 0.1), (0.1, 1.55)]
        .map(|(turn, elevation_rad)| Direction { azimuth_rad: SOURCE_AZIMUTH_RAD + turn, elevation_rad })
        .to_vec()
}

fn sky<'a>(sources: &'a [PointSource], directions: &'a [Direction]) -> SkySum<'a> {
    SkySum {
        place: place(),
        observer_altitude_m: OBSERVER_ALTITUDE_M,
        sources,
        emission: EmissionMix::garstang(),
        flux_per_dnb_flux: FLUX_PER_DNB_FLUX,
        directions,
    }
}

/// Arc distance [m], azimuth [rad] and tan of the elevation at which a source sees a point.
fn seen_from(source_m: DVec3, point_m: DVec3) -> (f64, f64, f64) {
    let bearing = LocalFrame::at(GeoPoint::from_vector(source_m)).bearing_to(point_m.normalize());
    let (from_m, to_m) = (source_m.length() - EARTH_RADIUS_M, point_m.length() - EARTH_RADIUS_M);
    let tangent = terrain_elevation_tangent(from_m, to_m, bearing.distance_m.max(1e-3));
    (bearing.distance_m, bearing.azimuth_rad, tangent)
}

/// A wall at a distance around the source, as a test of segments.
fn ring_wall(distance_m: f64, height_m: f64) -> impl Fn(DVec3, DVec3) -> bool + Sync {
    let top = terrain_elevation_tangent(SOURCE_ALTITUDE_M, height_m, distance_m);
    move |source_m, point_m| {
        let (point_distance_m, _, tangent) = seen_from(source_m, point_m);
        point_distance_m > distance_m && tangent < top
    }
}

fn worst_difference(a: &[[f64; BAND_COUNT]], b: &[[f64; BAND_COUNT]]) -> f64 {
    let pairs = a.iter().flatten().zip(b.iter().flatten());
    pairs.map(|(a, b)| (a / b - 1.0).abs()).fold(0.0, f64::max)
}

/// What no terrain hides and what skylines at or below the horizontal cut are the plain sum; the former is returned.
fn check_against_the_plain_sum(
    atmosphere: &Atmosphere,
    sum: &SkySum,
    no_skylines_rad: &[f64],
) -> Vec<[f64; BAND_COUNT]> {
    let plain: Vec<[f64; BAND_COUNT]> = direct_sum(
        &[*atmosphere],
        sum.sources,
        OBSERVER_ALTITUDE_M,
        sum.emission,
        sum.flux_per_dnb_flux,
        sum.directions,
        &|| (),
    );
    let open = hidden_sum(atmosphere, sum, &|_, _| false);
    assert!(worst_difference(&open, &plain) < 1e-4, "{}", worst_difference(&open, &plain));
    let uncut = cut_sum(atmosphere, sum, no_skylines_rad);
    assert!(worst_difference(&uncut, &plain) < 1e-4, "{}", worst_difference(&uncut, &plain));
    open
}

#[test]
fn without_terrain_it_is_the_plain_sum() {
    let (sources, directions) = ([source(20_000.0), source(90_000.0)], view_directions());
    let sum = sky(&sources, &directions);
    check_against_the_plain_sum(&atmosphere(), &sum, &[0.0, -0.1]);
    // The control: what is hidden is missed.
    assert!(hidden_sum(&atmosphere(), &sum, &|_, _| true).iter().flatten().all(|value| *value == 0.0));
}

/// Below a cloud all sums agree, and what hides a source from the base counts.
#[test]
fn sums_agree_below_a_cloud() {
    let cloudy = atmosphere().under(Some(CloudBase::lambertian(1_500.0, 0.5).unwrap()));
    let high = PointSource { altitude_m: 1_600.0, ..source(3_000.0) };
    let (sources, directions) = ([source(3_000.0), source(9_000.0), high], view_directions());
    let sum = sky(&sources, &directions);
    let open = check_against_the_plain_sum(&cloudy, &sum, &[0.0; 3]);
    // Above the base there is nothing, so the high source is none; the clear sky has other light.
    let low = sky(&sources[..2], &directions);
    assert_eq!(hidden_sum(&cloudy, &low, &|_, _| false), open);
    assert!(worst_difference(&hidden_sum(&atmosphere(), &sum, &|_, _| false), &open) > 0.5);
    // A lid over the sources blocks the base from them and leaves the air below.
    let lid = EARTH_RADIUS_M + 1_499.0;
    let lidded = hidden_sum(&cloudy, &sum, &|_, point_m| point_m.length() > lid);
    let zenith = directions.len() - 1;
    assert!(lidded[zenith][1] > 0.0 && lidded[zenith][1] < 0.5 * open[zenith][1], "{lidded:?} {open:?}");
}

/// A wall around a source cuts its lobe at the elevation of the wall's top.
#[test]
fn a_ring_wall_is_a_cut_lobe() {
    let (sources, directions) = ([source(20_000.0)], view_directions());
    let sum = sky(&sources, &directions);
    let open = hidden_sum(&atmosphere(), &sum, &|_, _| false);
    for height_m in [130.0, 155.0, 260.0] {
        // 500 m away the Earth has dropped by 2 cm.
        let angle_rad = ((height_m - SOURCE_ALTITUDE_M) / 500.0f64).atan();
        let behind_wall = hidden_sum(&atmosphere(), &sum, &ring_wall(500.0, height_m));
        let cut = cut_sum(&atmosphere(), &sum, &[angle_rad]);
        assert!(worst_difference(&behind_wall, &cut) < 0.02, "{height_m}: {behind_wall:?} {cut:?}");
        for (behind_wall, open) in behind_wall.iter().flatten().zip(open.iter().flatten()) {
            assert!(behind_wall <= open);
        }
        assert!(worst_difference(&behind_wall, &open) > 0.05, "a wall of {height_m} m hides something");
        // The control: the cut of another wall is seen.
        let other = cut_sum(&atmosphere(), &sum, &[2.0 * angle_rad]);
        assert!(worst_difference(&behind_wall, &other) > 0.03);
    }
}

/// Over a ridge the zenith is lit from where the light clears the ridge.
#[test]
fn the_zenith_is_lit_above_a_ridge() {
    // In the vertical plane through source and observer the light that clears the ridge meets the vertical above the
    // observer at a height that plane geometry gives; below it nothing is lit.
    let (distance_m, ridge_m, ridge_height_m) = (10_000.0, 4_000.0, 900.0);
    let sources = [source(distance_m)];
    let directions =
        [Direction { azimuth_rad: SOURCE_AZIMUTH_RAD, elevation_rad: std::f64::consts::FRAC_PI_2 }];
    let sum = sky(&sources, &directions);
    let over_ridge = hidden_sum(&atmosphere(), &sum, &ring_wall(ridge_m, ridge_height_m));
    let clear_m = SOURCE_ALTITUDE_M + (ridge_height_m - SOURCE_ALTITUDE_M) * distance_m / ridge_m;
    let lit_from = |clear_m: f64| {
        let geometry = SourceGeometry {
            distance_m,
            source_altitude_m: SOURCE_ALTITUDE_M,
            observer_altitude_m: OBSERVER_ALTITUDE_M,
        };
        let nodes = gauss_legendre(400);
        let elevation_rad = directions[0].elevation_rad;
        let per_watt: [f64; BAND_COUNT] = mixed_radiance_per_watt_where(
            &[atmosphere()],
            &geometry,
            sum.emission,
            0.0,
            elevation_rad,
            &nodes,
            |path_m, _| OBSERVER_ALTITUDE_M + path_m >= clear_m,
        );
        std::array::from_fn(|band| 1e6 * sum.flux_per_dnb_flux[band] * per_watt[band])
    };
    let expected = [lit_from(clear_m)];
    assert!(worst_difference(&over_ridge, &expected) < 0.015, "{over_ridge:?} {expected:?}");
    // The control: 20 % higher is seen.
    assert!(worst_difference(&over_ridge, &[lit_from(1.2 * clear_m)]) > 0.05);
}

/// A ridge on one side hides nothing on the other.
#[test]
fn a_ridge_hides_on_its_own_side_only() {
    let (sources, directions) = ([source(20_000.0)], view_directions());
    let sum = sky(&sources, &directions);
    let wall = ring_wall(500.0, 260.0);
    let frame = LocalFrame::at(place());
    // Points on the observer's far side of the source, over which the light passes no wall.
    let is_behind = |point_m: DVec3| {
        let bearing = frame.bearing_to(point_m.normalize());
        (bearing.azimuth_rad - SOURCE_AZIMUTH_RAD).cos() * bearing.distance_m > 20_000.0
    };
    let all_around = hidden_sum(&atmosphere(), &sum, &wall);
    let one_side = hidden_sum(&atmosphere(), &sum, &|s, p| !is_behind(p) && wall(s, p));
    for (one_side, all_around) in one_side.iter().flatten().zip(all_around.iter().flatten()) {
        assert!(one_side >= all_around);
    }
    // Low towards the source the view ray passes over it.
    assert!(one_side[0][1] > 1.005 * all_around[0][1], "{} {}", one_side[0][1], all_around[0][1]);
}

/// A wall below the curve of the Earth hides nothing.
#[test]
fn a_wall_below_the_horizon_hides_nothing() {
    let (sources, directions) = ([source(80_000.0)], view_directions());
    let sum = sky(&sources, &directions);
    let open = hidden_sum(&atmosphere(), &sum, &|_, _| false);
    // 50 km away the Earth has dropped by 196 m; over a flat one a wall 150 m high would hide 0.17 degrees.
    let low = hidden_sum(&atmosphere(), &sum, &ring_wall(50_000.0, SOURCE_ALTITUDE_M + 150.0));
    assert_eq!(low, open);
    let high = hidden_sum(&atmosphere(), &sum, &ring_wall(50_000.0, SOURCE_ALTITUDE_M + 900.0));
    assert!(worst_difference(&high, &open) > 0.01);
}
