//! What the engine's integration tests share.
#![allow(dead_code, reason = "each test file uses its own part")]

use gdal::{DriverManager, raster::Buffer, spatial_ref::SpatialRef};
use skyglow_observatory::{ObserverHeight, SkyRequest};
use skyglow_physics::{EmissionMix, GeoPoint, LampPreset, Response, Turbidity};
use skyglow_render::{DeviceChoice, Engine, EngineConfig, RenderRequest, synthetic};
use skyglow_scene::{IngestOptions, PolarGrid, SceneId, SceneStore, ingest};
use skyglow_tables::Scattering;
use std::path::Path;

/// An engine on made-up packs.
pub(crate) fn engine(device: DeviceChoice, turbidities: &[f64], basis_count: usize) -> Engine {
    let tables = synthetic::table_set(turbidities, basis_count);
    Engine::start(EngineConfig { device, tables, ..EngineConfig::default() }).unwrap()
}

/// The device with Vulkan that tests run on.
pub(crate) fn vulkan() -> DeviceChoice {
    synthetic::tested_device().choice()
}

/// A sky over a place of the town's scene, two metres above the ground.
pub(crate) fn sky(turbidity: f64, latitude_deg: f64, longitude_deg: f64) -> SkyRequest {
    SkyRequest {
        scene: town(),
        scenario: None,
        place: GeoPoint::from_deg(latitude_deg, longitude_deg).unwrap(),
        observer_height: ObserverHeight::AboveGround(2.0),
        turbidity: Turbidity::new(turbidity).unwrap(),
        scattering: Scattering::Single,
        cloud_base_m: None,
        broken_clouds: None,
        lamp: LampPreset::Mixed.lamp(),
        response: Response::Photopic,
        emission: EmissionMix::garstang().into(),
        basis: None,
        tolerance: None,
        terrain_hides: true,
        time: None,
    }
}

/// A request for that light and turbidity, with an observer between the tables' altitudes.
pub(crate) fn request(polar: PolarGrid, turbidity: f64) -> RenderRequest {
    synthetic::request(polar, Turbidity::new(turbidity).unwrap())
}

/// Largest |got − exact| / max(|exact|, floor) over the samples; the floor is a thousandth of the mean.
pub(crate) fn largest_error(got: &[f32], exact: &[f64]) -> f64 {
    assert_eq!(got.len(), exact.len());
    let floor = exact.iter().map(|value| value.abs()).sum::<f64>() / exact.len() as f64 * 1e-3;
    got.iter()
        .zip(exact)
        .map(|(got, exact)| (f64::from(*got) - exact).abs() / exact.abs().max(floor))
        .fold(0.0, f64::max)
}

/// Stores a scene of 40 × 40 pixels about 36.4–36.8° E, 1.6–1.2° S: one town of 9 pixels, on a ground in metres by row and
/// column.
pub(crate) fn store_town_on(data_dir: &Path, calibration: f64, ground_m: &dyn Fn(usize, usize) -> f32) {
    let near = |a: usize| (19..22).contains(&a);
    let light = |row, column| if near(row) && near(column) { 25.5 } else { 0.0 };
    store_scene(data_dir, 40, [36.4, -1.2, 0.01], calibration, ground_m, &light);
}

/// Stores a square scene under the town's id: pixels a side; west and north edge and pixel in degrees; altitude and radiance by
/// row and column.
pub(crate) fn store_scene(
    data_dir: &Path,
    side: usize,
    [west_deg, north_deg, step_deg]: [f64; 3],
    calibration: f64,
    ground_m: &dyn Fn(usize, usize) -> f32,
    radiance_nw_cm2_sr: &dyn Fn(usize, usize) -> f32,
) {
    let write = |name: &str, value: &dyn Fn(usize, usize) -> f32| {
        let path = data_dir.join(name);
        let driver = DriverManager::get_driver_by_name("GTiff").unwrap();
        let mut dataset = driver.create_with_band_type::<f32, _>(&path, side, side, 1).unwrap();
        dataset.set_geo_transform(&[west_deg, step_deg, 0.0, north_deg, 0.0, -step_deg]).unwrap();
        dataset.set_spatial_ref(&SpatialRef::from_epsg(4326).unwrap()).unwrap();
        let values = (0..side * side).map(|pixel| value(pixel / side, pixel % side)).collect();
        let mut band = dataset.rasterband(1).unwrap();
        band.write((0, 0), (side, side), &mut Buffer::new((side, side), values)).unwrap();
        dataset.close().unwrap();
        path
    };
    let options = IngestOptions {
        terrain: vec![write("terrain.tif", ground_m)],
        id: Some(town()),
        calibration,
        replace: true,
        ..IngestOptions::new(write("lights.tif", radiance_nw_cm2_sr))
    };
    ingest(&SceneStore::new(data_dir), &options, &mut |_| {}).unwrap();
}

/// Its id.
pub(crate) fn town() -> SceneId {
    SceneId::parse("town").unwrap()
}
