//! What the engine's integration tests share.
#![allow(dead_code, reason = "each test file uses its own part")]

use skyglow_engine::{DeviceChoice, Engine, EngineConfig, RenderRequest, synthetic};
use skyglow_physics::{EmissionMix, Turbidity};
use skyglow_scene::PolarGrid;
use skyglow_tables::Scattering;
use std::sync::Arc;

/// An engine on made-up packs.
pub(crate) fn engine(device: DeviceChoice, turbidities: &[f64], basis_count: usize) -> Engine {
    let tables = synthetic::table_set(turbidities, basis_count);
    Engine::start(EngineConfig { device, tables, ..EngineConfig::default() }).unwrap()
}

/// A request for that light and turbidity, with an observer between the tables' altitudes.
pub(crate) fn request(polar: PolarGrid, turbidity: f64) -> RenderRequest {
    RenderRequest {
        polar: Arc::new(polar),
        observer_altitude_m: 1661.0,
        turbidity: Turbidity::new(turbidity).unwrap(),
        scattering: Scattering::Single,
        cloud_base_m: None,
        emission: EmissionMix::garstang(),
        flux_per_dnb_flux: [0.408, 0.642, 0.186],
        basis: None,
    }
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
