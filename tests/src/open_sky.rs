//! A sky of default lamps with all lights under an open sky, and an observatory on the processor: what examples measure.

use skyglow_observatory::{Observatory, ObserverHeight, SkyRequest};
use skyglow_physics::{EmissionMix, GeoPoint, LampPreset, Turbidity};
use skyglow_render::{DeviceChoice, Engine, EngineConfig, resident_tables};
use skyglow_scene::SceneId;
use skyglow_tables::{Scattering, packs_in};
use std::{error::Error, path::Path};

/// An observatory over a data folder and a folder of packs.
///
/// # Errors
/// Packs that cannot be read.
pub fn observatory(data: &Path, packs: &Path) -> Result<Observatory, Box<dyn Error>> {
    let (tables, manifests) = resident_tables(&packs_in(packs)?)?;
    let engine =
        Engine::start(EngineConfig { device: DeviceChoice::Cpu, tables, ..EngineConfig::default() })?;
    Ok(Observatory::new(engine, manifests, data, 1))
}

/// All orders, two metres above the ground, terrain off.
pub fn open_sky(scene: SceneId, place: GeoPoint, turbidity: Turbidity) -> SkyRequest {
    SkyRequest {
        scene,
        scenario: None,
        place,
        observer_height: ObserverHeight::AboveGround(2.0),
        turbidity,
        scattering: Scattering::Multiple,
        cloud_base_m: None,
        lamp: LampPreset::Mixed.lamp(),
        emission: EmissionMix::garstang(),
        basis: None,
        tolerance: None,
        terrain_hides: false,
    }
}
