//! From a place in a stored scene to its sky.
#![allow(clippy::unwrap_used, reason = "a test that cannot be set up fails")]

mod common;

use common::{engine, sky, store_town_on, town};
use skyglow_observatory::{
    InfluenceRequest, Measure, Observatory, ObservatoryError, ObserverHeight, RenderedSky, SkyRequest,
};
use skyglow_physics::{
    AZIMUTH_COUNT, Atmosphere, BAND_COUNT, BrokenClouds, GeoPoint, Horizon, Panorama, Response,
};
use skyglow_render::{DeviceChoice, Engine, EngineConfig, RenderError, synthetic};
use skyglow_scene::{Ground, IngestOptions, SceneError, SceneId, SceneStore, ingest};
use std::{path::Path, sync::Arc};

/// Stores a scene of 40 × 40 pixels about 36.4–36.8° E, 1.6–1.2° S: one town of 9 pixels, and ground at 1000 m.
fn store_town(data_dir: &Path, calibration: f64) {
    store_town_on(data_dir, calibration, &|_, _| 1000.25);
}

fn request(latitude_deg: f64, longitude_deg: f64, observer_height: ObserverHeight) -> SkyRequest {
    SkyRequest { observer_height, ..sky(2.5, latitude_deg, longitude_deg) }
}

fn observatory(data_dir: &Path) -> Observatory {
    Observatory::new(engine(DeviceChoice::Cpu, &[2.0, 3.0], 8), Vec::new(), data_dir, 2)
}

fn has_timed_horizon(sky: &RenderedSky) -> bool {
    sky.passes.iter().any(|pass| pass.name == "horizon")
}

/// A place gets its sky with everything it depends on.
#[test]
fn a_place_gets_its_sky_with_what_it_needs() {
    let data = tempfile::tempdir().unwrap();
    store_town(data.path(), 1.0);
    let observatory = observatory(data.path());
    let request = request(-1.35, 36.5, ObserverHeight::AboveGround(2.0));
    let answer = observatory.sky_blocking(&request).unwrap();
    assert!((answer.context.altitude_m - 1002.25).abs() < 0.01, "{:?}", answer.context);
    assert!((answer.context.ground.known_altitude_m().unwrap() - 1000.25).abs() < 0.01);
    assert!(
        answer.context.flux_dnb_w > 0.0 && answer.context.coverage > 0.0 && answer.context.coverage < 0.1
    );
    let atmosphere = Atmosphere::new(request.turbidity);
    assert_eq!(
        answer.context.local_optical_depth,
        atmosphere.vertical_optical_depth(answer.context.altitude_m)
    );
    // The town lies to the south-east: (0.105° east, 0.055° south).
    assert!((answer.quantities.brightest_azimuth_deg - 118.0).abs() < 4.0);
    let runtime = tokio::runtime::Runtime::new().unwrap();
    let again = {
        let view = observatory.view(&request.scene, None).unwrap();
        runtime.block_on(observatory.sky(view, Arc::new(request))).unwrap()
    };
    assert_eq!(again.seen, answer.seen);
    assert_eq!(observatory.open_scene_count(), 1);
}

#[test]
fn a_site_says_what_is_there() {
    let data = tempfile::tempdir().unwrap();
    store_town(data.path(), 1.0);
    let site = |latitude_deg, longitude_deg| {
        let view = observatory(data.path()).view(&town(), None).unwrap();
        view.site(GeoPoint::from_deg(latitude_deg, longitude_deg).unwrap())
    };
    assert_eq!(site(-1.405, 36.605).unwrap().radiance_nw_cm2_sr, Some(25.5));
    assert_eq!(site(-1.3, 36.5).unwrap().radiance_nw_cm2_sr, Some(0.0));
    match site(10.0, 36.5).unwrap_err() {
        ObservatoryError::OutsideScene { bounds: [west, south, east, north], scene, .. } => {
            assert_eq!(scene, "town");
            for (got, expected) in [(west, 36.4), (south, -1.6), (east, 36.8), (north, -1.2)] {
                assert!((got - expected).abs() < 1e-9);
            }
        }
        other => panic!("{other}"),
    }
}

/// An observer over a gap in the terrain stands on the nearest within 5 km.
#[test]
fn over_a_terrain_gap_the_nearest_ground_counts() {
    let data = tempfile::tempdir().unwrap();
    // Ground in the west alone: column 20 ends at 36.6° E.
    store_town_on(data.path(), 1.0, &|_, column| if column < 20 { 1000.25 } else { -32_768.0 });
    let observatory = observatory(data.path());
    let observer = |longitude_deg| {
        let request = request(-1.35, longitude_deg, ObserverHeight::AboveGround(2.0));
        observatory.sky_blocking(&request).unwrap().context
    };
    assert!(matches!(observer(36.5).ground, Ground::Here { .. }));
    let beside = observer(36.622);
    assert!((beside.altitude_m - 1002.25).abs() < 0.01, "{beside:?}");
    assert!(matches!(beside.ground, Ground::Nearest { .. }), "{beside:?}");
    let beyond = observer(36.7);
    assert_eq!((beyond.altitude_m, beyond.ground), (2.0, Ground::Unknown));
}

/// Altitudes too high and unknown scenes are named.
#[test]
fn too_high_and_unknown_scenes_are_named() {
    let data = tempfile::tempdir().unwrap();
    store_town(data.path(), 1.0);
    let observatory = observatory(data.path());
    let error = observatory.sky_blocking(&request(-1.3, 36.5, ObserverHeight::AboveSea(9000.0))).unwrap_err();
    assert_eq!(error.to_string(), "altitude is 9000 m; allowed is 0 to 6000 m");
    let error = observatory.sky_blocking(&request(-1.3, 36.5, ObserverHeight::AboveGround(5500.0)));
    assert!(matches!(error, Err(ObservatoryError::Render(RenderError::AltitudeOutOfRange { .. }))));
    let error = observatory.sky_blocking(&request(-1.3, 36.5, ObserverHeight::AboveSea(f64::NAN)));
    assert!(matches!(error, Err(ObservatoryError::Render(RenderError::AltitudeOutOfRange { .. }))));
    let below = observatory.sky_blocking(&request(-1.3, 36.5, ObserverHeight::AboveSea(-50.0))).unwrap();
    assert_eq!(below.context.altitude_m, 0.0);
    let mut elsewhere = request(-1.3, 36.5, ObserverHeight::AboveSea(0.0));
    elsewhere.scene = SceneId::parse("nowhere").unwrap();
    let error = observatory.sky_blocking(&elsewhere).unwrap_err();
    assert!(matches!(error, ObservatoryError::Scene(SceneError::UnknownScene { .. })), "{error}");
}

#[test]
fn a_scene_that_changes_on_disk_is_opened_again() {
    let data = tempfile::tempdir().unwrap();
    store_town(data.path(), 1.0);
    let observatory = observatory(data.path());
    let request = request(-1.3, 36.5, ObserverHeight::AboveSea(1500.0));
    let before = observatory.sky_blocking(&request).unwrap();
    let view = observatory.view(&town(), None).unwrap();
    assert_eq!(observatory.view(&town(), None).unwrap().version(), view.version());
    store_town(data.path(), 2.0);
    let after = observatory.sky_blocking(&request).unwrap();
    assert_ne!(observatory.view(&town(), None).unwrap().version(), view.version());
    assert!((after.context.flux_dnb_w / before.context.flux_dnb_w - 2.0).abs() < 1e-6);
    assert_eq!(observatory.open_scene_count(), 1);
    // What was prepared before it was replaced is answered as it was then.
    let runtime = tokio::runtime::Runtime::new().unwrap();
    let then = runtime.block_on(observatory.sky(view, Arc::new(request.clone()))).unwrap();
    assert_eq!(then.quantities, before.quantities);
    std::fs::remove_dir_all(data.path().join("scenes/town")).unwrap();
    assert!(observatory.sky_blocking(&request).is_err());
    assert_eq!(observatory.open_scene_count(), 0);
}

/// Terrain makes the sky below its horizon dark and leaves the rest bit for bit.
#[test]
fn terrain_darkens_below_its_horizon_alone() {
    let data = tempfile::tempdir().unwrap();
    // A wall of 4 km along column 5, 5.6 km west of the observer, who has the town in the east.
    store_town_on(data.path(), 1.0, &|_, column| if column == 5 { 5000.0 } else { 1000.25 });
    let observatory = observatory(data.path());
    let on = request(-1.4, 36.505, ObserverHeight::AboveGround(2.0));
    let off = SkyRequest { terrain_hides: false, ..on.clone() };
    let (on, off) = (observatory.sky_blocking(&on).unwrap(), observatory.sky_blocking(&off).unwrap());
    let west_deg = on.horizon.elevations_rad()[192].to_degrees();
    assert!((west_deg - (4000.0f64 / 5560.0).atan().to_degrees()).abs() < 1.0, "{west_deg}");
    assert_eq!(on.horizon.elevations_rad()[64], 0.0, "the plain in the east");
    let mut hidden = 0;
    for band in 0..BAND_COUNT {
        for row in 0..64 {
            for column in 0..AZIMUTH_COUNT {
                let at = Panorama::index(band, row, column);
                let [masked, open] = [&on, &off].map(|sky| sky.parts[0].kernel.samples()[at]);
                let is_hidden = on.horizon.hides_sample(row, column);
                assert_eq!(masked, if is_hidden { 0.0 } else { open }, "{band} {row} {column}");
                hidden += usize::from(is_hidden);
            }
        }
    }
    assert!(hidden > 1000, "{hidden}");
    assert!(on.quantities.horizontal_illuminance_lx < off.quantities.horizontal_illuminance_lx);
    assert_eq!(on.quantities.zenith_luminance_cd_m2, off.quantities.zenith_luminance_cd_m2);
    assert!(has_timed_horizon(&on) && !has_timed_horizon(&off));
}

/// Over flat ground terrain changes no bit and without it there is no work for it.
#[test]
fn flat_terrain_changes_no_bit_and_no_work() {
    let data = tempfile::tempdir().unwrap();
    store_town(data.path(), 1.0);
    let with_terrain = observatory(data.path());
    let on = request(-1.35, 36.5, ObserverHeight::AboveGround(2.0));
    let off = SkyRequest { terrain_hides: false, ..on.clone() };
    let (on, off) = (with_terrain.sky_blocking(&on).unwrap(), with_terrain.sky_blocking(&off).unwrap());
    assert_eq!(on.horizon, Horizon::flat());
    assert_eq!(on.seen, off.seen);
    assert_eq!(on.quantities, off.quantities);
    assert!(has_timed_horizon(&on) && !has_timed_horizon(&off));

    let bare = tempfile::tempdir().unwrap();
    let options = IngestOptions { id: Some(town()), ..IngestOptions::new(data.path().join("lights.tif")) };
    ingest(&SceneStore::new(bare.path()), &options, &mut |_| {}).unwrap();
    let request = request(-1.35, 36.5, ObserverHeight::AboveSea(1002.25));
    let answer = observatory(bare.path()).sky_blocking(&request).unwrap();
    assert!(!has_timed_horizon(&answer) && answer.horizon.is_flat());
}

/// An overcast sky has no stars, half of the natural light, and none is seen from above the clouds.
#[test]
fn overcast_has_no_stars_nor_eyes_above_it() {
    let data = tempfile::tempdir().unwrap();
    store_town(data.path(), 1.0);
    let mut tables = synthetic::table_set(&[2.0, 3.0], 8);
    tables.extend(synthetic::under_clouds(synthetic::table_set(&[2.0, 3.0], 8), 2_000));
    let engine =
        Engine::start(EngineConfig { device: DeviceChoice::Cpu, tables, ..EngineConfig::default() }).unwrap();
    let observatory = Observatory::new(engine, Vec::new(), data.path(), 2);
    let asked = |height_m, cloud_base_m| SkyRequest {
        cloud_base_m,
        ..request(-1.35, 36.5, ObserverHeight::AboveGround(height_m))
    };
    let clear = observatory.sky_blocking(&asked(2.0, None)).unwrap();
    let overcast = observatory.sky_blocking(&asked(2.0, Some(2_000))).unwrap();
    // The made-up packs are the same under both skies: what differs is what clouds are said to do.
    assert_eq!(overcast.seen, clear.seen);
    assert!(clear.quantities.bortle_class.is_some() && overcast.quantities.bortle_class.is_none());
    // Half of what there is of the dark reference with its stars comes through.
    let dark = 0.5 * clear.context.dark.meter_value(&Response::Photopic);
    let natural =
        overcast.quantities.zenith_total_luminance_cd_m2 - overcast.quantities.zenith_luminance_cd_m2;
    assert!((natural / dark - 1.0).abs() < 2e-3, "{natural} {dark}");
    assert!(observatory.sky_blocking(&asked(950.0, None)).is_ok());
    match observatory.sky_blocking(&asked(950.0, Some(2_000))) {
        Err(ObservatoryError::Render(RenderError::AboveClouds { base_m: 2_000, altitude_m, .. })) => {
            assert!((altitude_m - 1_950.25).abs() < 0.01);
        }
        other => panic!("{other:?}"),
    }
}

/// Broken clouds lie between clear and overcast skies; natural light comes through their gaps, and half of it through them.
#[test]
fn broken_clouds_let_natural_light_through() {
    let data = tempfile::tempdir().unwrap();
    store_town(data.path(), 1.0);
    let mut tables = synthetic::table_set(&[2.0, 3.0], 8);
    tables.extend(synthetic::under_clouds(synthetic::table_set(&[2.0, 3.0], 8), 2_000));
    let engine =
        Engine::start(EngineConfig { device: DeviceChoice::Cpu, tables, ..EngineConfig::default() }).unwrap();
    let observatory = Observatory::new(engine, Vec::new(), data.path(), 2);
    let asked = |broken_clouds| SkyRequest {
        cloud_base_m: Some(2_000),
        broken_clouds,
        ..request(-1.35, 36.5, ObserverHeight::AboveGround(2.0))
    };
    let sky = |cover, pattern| {
        let clouds = BrokenClouds::new(cover, pattern).unwrap();
        observatory.sky_blocking(&asked(Some(clouds))).unwrap()
    };
    let clear = observatory.sky_blocking(&SkyRequest { cloud_base_m: None, ..asked(None) }).unwrap();
    let overcast = observatory.sky_blocking(&asked(None)).unwrap();
    assert_eq!(sky(0.0, None).seen, clear.seen);
    let totals = [&sky(0.0, None), &clear].map(|sky| sky.quantities.zenith_total_luminance_cd_m2);
    assert!((totals[0] / totals[1] - 1.0).abs() < 1e-6, "{totals:?}");
    assert_eq!(sky(1.0, Some(4)).seen, overcast.seen);
    let natural_cd_m2 = |sky: &RenderedSky| {
        sky.quantities.zenith_total_luminance_cd_m2 - sky.quantities.zenith_luminance_cd_m2
    };
    let broken = sky(0.25, None);
    // What comes through gaps, and half of what falls on clouds, stars too.
    let dark = &clear.context.dark;
    let wanted = 0.75 * dark.luminance_cd_m2() + 0.125 * dark.meter_value(&Response::Photopic);
    assert!((natural_cd_m2(&broken) / wanted - 1.0).abs() < 1e-3);
    assert_eq!((broken.quantities.bortle_class, broken.quantities.naked_eye_limit_mag), (None, None));
    let added: Vec<f32> = (broken.seen_in_total().plane(1).iter().zip(broken.seen.plane(1)))
        .map(|(total, artificial)| total - artificial)
        .collect();
    assert!(added.iter().all(|added| (added / wanted as f32 - 1.0).abs() < 1e-2));
    // One pattern has clouds here and gaps there.
    let one = sky(0.5, Some(4));
    let gaps = one.gaps.as_ref().unwrap();
    // Air before the ground is the sky's own in a gap, and no cloud stands in it.
    assert_eq!((&clear.air_before_ground, &overcast.air_before_ground), (&None, &None));
    let air = one.air_before_ground.as_ref().unwrap();
    for (column, air) in air.iter().enumerate() {
        let sky = f64::from(one.seen.plane(1)[column]);
        assert!(gaps.share(0, column) < 1.0 || (air[1] / sky - 1.0).abs() < 1e-3, "{column} {air:?} {sky}");
        assert!(air[1] <= f64::from(clear.seen.plane(1)[column]) * 1.001, "{column}");
    }
    let share = |at: usize| gaps.share(at / AZIMUTH_COUNT, at % AZIMUTH_COUNT);
    let total = one.seen_in_total();
    let natural = |at: usize| total.plane(1)[at] - one.seen.plane(1)[at];
    let places = 0..one.seen.plane(1).len();
    assert!(places.clone().any(|at| share(at) == 0.0) && places.clone().any(|at| share(at) == 1.0));
    let behind = 0.5 * dark.meter_value(&Response::Photopic) as f32;
    assert!(places.filter(|at| share(*at) == 0.0).all(|at| (natural(at) / behind - 1.0).abs() < 1e-2));
}

/// Under a closed layer lights add up to the sky's own value, and less than 100 m below it they do less the higher they are.
#[test]
fn influences_add_up_at_the_clouds() {
    let data = tempfile::tempdir().unwrap();
    store_town(data.path(), 1.0);
    let found = [2_000, 1_050, 1_020, 1_000].map(|base_m| {
        let tables = synthetic::under_clouds(synthetic::table_set(&[2.0, 3.0], 8), base_m);
        let config = EngineConfig { device: DeviceChoice::Cpu, tables, ..EngineConfig::default() };
        let observatory = Observatory::new(Engine::start(config).unwrap(), Vec::new(), data.path(), 2);
        let asked = request(-1.35, 36.5, ObserverHeight::AboveSea(500.0));
        let sky = SkyRequest { cloud_base_m: Some(base_m), ..asked };
        let wanted = observatory.sky_blocking(&sky).unwrap().quantities.zenith_luminance_cd_m2;
        let map = observatory.influence(&InfluenceRequest { sky, measure: Measure::Zenith }).unwrap();
        let total = map.total().influence;
        assert!((total - wanted).abs() <= 1e-4 * wanted, "{base_m} {total} {wanted}");
        total
    });
    // 50 and 20 m below the base, 12 km away: what the spot above the town sends counts a little.
    let [all, half, fifth, above] = found;
    assert!((0.5..0.7).contains(&(half / all)) && (0.2..0.4).contains(&(fifth / all)), "{found:?}");
    assert_eq!(above, 0.0);
}

/// Between clouds lights add up to the sky's own value, and dimming all of them takes that much.
#[test]
fn influences_add_up_between_clouds() {
    let data = tempfile::tempdir().unwrap();
    store_town(data.path(), 1.0);
    let mut tables = synthetic::table_set(&[2.0, 3.0], 8);
    tables.extend(synthetic::under_clouds(synthetic::table_set(&[2.0, 3.0], 8), 2_000));
    let engine =
        Engine::start(EngineConfig { device: DeviceChoice::Cpu, tables, ..EngineConfig::default() }).unwrap();
    let observatory = Observatory::new(engine, Vec::new(), data.path(), 2);
    for (cover, pattern) in [(0.0, None), (0.4, None), (0.4, Some(3)), (1.0, None)] {
        let sky = SkyRequest {
            cloud_base_m: Some(2_000),
            broken_clouds: BrokenClouds::new(cover, pattern).ok(),
            ..request(-1.35, 36.5, ObserverHeight::AboveGround(2.0))
        };
        let seen = observatory.sky_blocking(&sky).unwrap().quantities;
        for (measure, wanted) in [
            (Measure::Zenith, seen.zenith_luminance_cd_m2),
            (Measure::Horizontal, seen.horizontal_illuminance_lx),
        ] {
            let map = observatory.influence(&InfluenceRequest { sky: sky.clone(), measure }).unwrap();
            let total = map.total().influence;
            assert!((total / wanted - 1.0).abs() < 1e-4, "{cover} {pattern:?} {total} {wanted}");
        }
        let norm = observatory.influence(&InfluenceRequest { sky, measure: Measure::Norm });
        assert!(matches!(norm, Err(ObservatoryError::NormBetweenClouds)));
    }
}
