//! Ground in light around a town on a plain.
#![allow(clippy::unwrap_used, reason = "a test that cannot be set up fails")]

mod common;

use common::{engine, sky, store_town_on, town};
use gdal::{DriverManager, raster::Buffer, spatial_ref::SpatialRef};
use skyglow_observatory::{GroundRequest, Observatory, ObserverHeight, RenderedSky, SkyRequest, lit_ground};
use skyglow_physics::{
    AZIMUTH_COUNT, Direction, LitGround, aerial_perspective::AirBetween, fresnel::water_reflectance,
};
use skyglow_render::DeviceChoice;
use skyglow_scene::{GroundSight, IngestOptions, SceneStore, ingest};
use std::{
    f64::consts::{PI, TAU},
    path::Path,
};

const COUNT: usize = 720;

fn ground_at(
    data: &Path,
    latitude_deg: f64,
    longitude_deg: f64,
    (albedo, has_water): (f64, bool),
) -> (LitGround, RenderedSky, SkyRequest) {
    ground_in(data, latitude_deg, longitude_deg, (albedo, has_water, false))
}

fn ground_in(
    data: &Path,
    latitude_deg: f64,
    longitude_deg: f64,
    (albedo, has_water, has_snow): (f64, bool, bool),
) -> (LitGround, RenderedSky, SkyRequest) {
    let observatory = Observatory::new(engine(DeviceChoice::Cpu, &[2.0, 3.0], 8), Vec::new(), data, 2);
    let observer_height = ObserverHeight::AboveGround(50.0);
    let request = SkyRequest { observer_height, ..sky(2.5, latitude_deg, longitude_deg) };
    let rendered = observatory.sky_blocking(&request).unwrap();
    let view = observatory.view(&request.scene, None).unwrap();
    let sight = GroundSight { azimuths: (0.0, TAU / COUNT as f64, COUNT), lowest_tangent: f64::NEG_INFINITY };
    let wanted = GroundRequest { sight, albedo, has_snow, in_total: false, has_water };
    let ground = lit_ground(&view, &request, &rendered, &wanted).unwrap();
    (ground, rendered, request)
}

fn looking(azimuth_deg: f64, elevation_deg: f64) -> Direction {
    Direction { azimuth_rad: azimuth_deg.to_radians(), elevation_rad: elevation_deg.to_radians() }
}

/// Level ground near by has the luminance ρE/π of the sky's own illuminance, and reflects in proportion.
#[test]
fn near_ground_reflects_the_sky() {
    let data = tempfile::tempdir().unwrap();
    store_town_on(data.path(), 1.0, &|_, _| 1000.25);
    // 12 km to the north-west of the town.
    let [(dark, sky, _), (bright, ..)] =
        [0.15, 0.6].map(|albedo| ground_at(data.path(), -1.35, 36.5, (albedo, false)));
    let expected = 0.15 * sky.quantities.horizontal_illuminance_lx / PI;
    // The air of 50 m takes and adds less than one per cent.
    let below = looking(300.0, -40.0);
    let found = dark.light(below).unwrap()[1];
    assert!((found / expected - 1.0).abs() < 0.01, "{found} {expected}");
    let four_times = bright.light(below).unwrap()[1] / found;
    assert!((four_times - 4.0).abs() < 0.1, "{four_times}");
    // Above the horizon there is sky.
    assert_eq!(dark.light(looking(300.0, 1.0)), None);
}

/// The lamps of the town are seen where it lies, together as bright as its light sideways through the air, and its ground is brighter
/// than that around it.
#[test]
fn the_towns_lamps_are_seen_in_its_direction() {
    let data = tempfile::tempdir().unwrap();
    store_town_on(data.path(), 1.0, &|_, _| 1000.25);
    let (ground, sky, request) = ground_at(data.path(), -1.35, 36.5, (0.15, false));
    assert!(ground.lamps.len() > 100, "{}", ground.lamps.len());
    for (direction, _) in &ground.lamps {
        assert!((direction.azimuth_rad.to_degrees() - 118.0).abs() < 12.0, "{direction:?}");
        assert!((-1.0..0.0).contains(&direction.elevation_rad.to_degrees()), "{direction:?}");
    }
    let found_lx: f64 = ground.lamps.iter().map(|(_, lx)| lx[1]).sum();
    // The horizontal lobe has 3.1 times the mean intensity at the horizon: C (π/2)⁴/2π with C = 1/∫ψ⁴ sin ψ dψ.
    let half = PI / 2.0;
    let per_sr = half.powi(4) / (2.0 * PI * (4.0 * half.powi(3) - 24.0 * half + 24.0));
    let lumens = request.lamp.light().rule(&skyglow_physics::Response::Photopic).value([1.0; 4]);
    let distance_m = 13_200.0;
    let sideways = request.emission.mix().weights()[1] * per_sr * sky.context.flux_dnb_w * lumens;
    let expected_lx = sideways / (distance_m * distance_m);
    assert!((0.3..0.95).contains(&(found_lx / expected_lx)), "{found_lx} {expected_lx}");
    let [town, beside] = [118.0, 150.0].map(|azimuth_deg| ground.light(looking(azimuth_deg, -0.25)).unwrap());
    assert!(town[1] > 5.0 * beside[1], "{town:?} {beside:?}");
}

/// By land cover forest in the west is darker than fields in the east, and much darker under snow; where nothing is known the ground has
/// the albedo asked for.
#[test]
fn ground_is_lit_by_its_cover() {
    let data = tempfile::tempdir().unwrap();
    store_town_on(data.path(), 1.0, &|_, _| 1000.25);
    let cover = data.path().join("cover.tif");
    let driver = DriverManager::get_driver_by_name("GTiff").unwrap();
    let mut dataset = driver.create_with_band_type::<u8, _>(&cover, 40, 40, 1).unwrap();
    dataset.set_geo_transform(&[36.4, 0.01, 0.0, -1.2, 0.0, -0.01]).unwrap();
    dataset.set_spatial_ref(&SpatialRef::from_epsg(4326).unwrap()).unwrap();
    // Forest, fields, and nothing south of the observer.
    let class = |column: usize, row: usize| {
        if row > 14 {
            0
        } else if column < 10 {
            10
        } else {
            40
        }
    };
    let values = (0..1_600).map(|pixel| class(pixel % 40, pixel / 40)).collect();
    dataset.rasterband(1).unwrap().write((0, 0), (40, 40), &mut Buffer::new((40, 40), values)).unwrap();
    dataset.close().unwrap();
    let options = IngestOptions {
        terrain: vec![data.path().join("terrain.tif")],
        land_cover: vec![cover],
        id: Some(town()),
        replace: true,
        ..IngestOptions::new(data.path().join("lights.tif"))
    };
    ingest(&SceneStore::new(data.path()), &options, &mut |_| {}).unwrap();
    let [(bare, sky, request), (snow, ..)] =
        [false, true].map(|has_snow| ground_in(data.path(), -1.35, 36.5, (0.15, false, has_snow)));
    // Five degrees below the horizon ground is 570 m away, and the air before it counts.
    let path_m = 50.0 / 5f64.to_radians().sin();
    let [_, through, ..] = AirBetween::new(request.turbidity).transmittance([1_050.0, 1_000.0], path_m);
    let plane = sky.seen.seen_by(&skyglow_physics::Response::Photopic).unwrap();
    for (ground, azimuth_deg, albedo) in [
        (&bare, 284.0, 0.06),
        (&bare, 80.0, 0.10),
        (&bare, 200.0, 0.15),
        (&snow, 80.0, 0.75),
        (&snow, 284.0, 0.15),
    ] {
        let (_, column) = looking(azimuth_deg, 1.0).nearest_sample();
        let horizon = plane[column - 4..=column + 4].iter().map(|value| f64::from(*value)).sum::<f64>() / 9.0;
        let sent = albedo * sky.quantities.horizontal_illuminance_lx / PI;
        let expected = through * sent + (1.0 - through) * horizon;
        let found = ground.light(looking(azimuth_deg, -5.0)).unwrap()[1];
        assert!((found / expected - 1.0).abs() < 0.02, "{azimuth_deg} {albedo}: {found} {expected}");
    }
}

/// Level ground as water: near by it mirrors the sky by Fresnel's reflectance and sends 2 % of the rest from below, and the town's
/// lamps are seen a second time, as deep below the water as they stand above it.
#[test]
fn water_mirrors_the_sky_and_the_town() {
    let data = tempfile::tempdir().unwrap();
    store_town_on(data.path(), 1.0, &|_, _| 1000.25);
    let [(land, ..), (water, sky, request)] =
        [false, true].map(|has_water| ground_at(data.path(), -1.35, 36.5, (0.15, has_water)));
    let plane = sky.seen.seen_by(&skyglow_physics::Response::Photopic).unwrap();
    // At a sample: column 213, row 28.
    let (azimuth_deg, elevation_deg) = (213.0 * 360.0 / 256.0, 28.5 * 90.0 / 64.0);
    let (row, column) = looking(azimuth_deg, elevation_deg).nearest_sample();
    let share = water_reflectance(elevation_deg.to_radians().sin());
    let mirrored = share * f64::from(plane[row * AZIMUTH_COUNT + column]);
    let sent = mirrored + (1.0 - share) * 0.02 * sky.quantities.horizontal_illuminance_lx / PI;
    // Water is so dark there that the air of 78 m counts.
    let path_m = 50.0 / elevation_deg.to_radians().sin();
    let [_, through, ..] = AirBetween::new(request.turbidity).transmittance([1_050.0, 1_000.0], path_m);
    let horizon = plane[column - 4..=column + 4].iter().map(|value| f64::from(*value)).sum::<f64>() / 9.0;
    let expected = through * sent + (1.0 - through) * horizon;
    let found = water.light(looking(azimuth_deg, -elevation_deg)).unwrap()[1];
    assert!((found / expected - 1.0).abs() < 0.01, "{found} {expected}");
    assert_eq!(water.lamps.len(), 2 * land.lamps.len());
    // Above the water, both together, metres; the Earth's curvature makes the ray less steep.
    let heights_m = 58.0;
    for pair in water.lamps.chunks_exact(2) {
        let [(lamp, lx), (image, mirrored_lx)] = pair else { panic!("{pair:?}") };
        // 8 m above the water, so 16 m lower in the mirror, less as the Earth is a convex one.
        let distance_m = 16.0 / (lamp.elevation_rad.tan() - image.elevation_rad.tan());
        assert!((11_000.0..18_000.0).contains(&distance_m), "{distance_m}");
        assert_eq!(lamp.azimuth_rad, image.azimuth_rad);
        let share = mirrored_lx[1] / lx[1];
        assert!((water_reflectance(heights_m / distance_m)..1.0).contains(&share), "{share}");
    }
}
