//! What the engine's integration tests share.
#![allow(dead_code, reason = "each test file uses its own part")]

use skyglow_physics::Turbidity;
use skyglow_render::{DeviceChoice, Engine, EngineConfig, RenderRequest, synthetic};
use skyglow_scene::PolarGrid;

/// An engine on made-up packs.
pub(crate) fn engine(device: DeviceChoice, turbidities: &[f64], basis_count: usize) -> Engine {
    let tables = synthetic::table_set(turbidities, basis_count);
    Engine::start(EngineConfig { device, tables, ..EngineConfig::default() }).unwrap()
}

/// The device with Vulkan that tests run on.
pub(crate) fn vulkan() -> DeviceChoice {
    synthetic::tested_device().choice()
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
