//! An engine or an observatory on the processor, and the sky of default lamps that most programs ask of them.

use crate::class_errors::JudgeError;
use skyglow_observatory::{Observatory, ObserverHeight, SkyRequest};
use skyglow_physics::{
    Atmosphere, EmissionMix, GeoPoint, LampPreset, Response, Turbidity,
    multiple_scattering::{DEFAULT_GROUND_ALBEDO, MultipleSum, Resolution, SumDensity},
};
use skyglow_render::{
    DeviceChoice, Engine, EngineConfig, RenderError, RenderRequest, celestial::CelestialTables,
    resident_tables,
};
use skyglow_scene::{PolarGrid, SceneId};
use skyglow_tables::{ResidentTables, Scattering, packs_in};
use std::{path::Path, sync::Arc};

/// The engine on the processor with every pack of a folder.
///
/// # Errors
/// Packs that cannot be read.
pub fn engine_with(packs: &Path) -> Result<Engine, JudgeError> {
    let (tables, _) = resident_tables(&packs_in(packs)?)?;
    Ok(engine_of(tables, DeviceChoice::Cpu)?)
}

/// The engine with some tables.
///
/// # Errors
/// A device that is not there.
pub fn engine_of(tables: Vec<Arc<ResidentTables>>, device: DeviceChoice) -> Result<Engine, RenderError> {
    Engine::start(EngineConfig { device, tables, ..EngineConfig::default() })
}

/// An observatory over a data folder and a folder of packs.
///
/// # Errors
/// Packs that cannot be read.
pub fn observatory(data: &Path, packs: &Path) -> Result<Observatory, JudgeError> {
    let (tables, manifests) = resident_tables(&packs_in(packs)?)?;
    let observatory = Observatory::new(engine_of(tables, DeviceChoice::Cpu)?, manifests, data, 1);
    Ok(match CelestialTables::open(packs)? {
        Some(celestial) => observatory.with_celestial_tables(celestial),
        None => observatory,
    })
}

/// All orders, Garstang's lobes of 1986, two metres above the ground, terrain off.
pub fn open_sky(scene: SceneId, place: GeoPoint, turbidity: Turbidity) -> SkyRequest {
    SkyRequest {
        scene,
        scenario: None,
        place,
        observer_height: ObserverHeight::AboveGround(2.0),
        turbidity,
        scattering: Scattering::Multiple,
        cloud_base_m: None,
        broken_clouds: None,
        response: Response::Photopic,
        lamp: LampPreset::Mixed.lamp(),
        emission: EmissionMix::garstang().into(),
        basis: None,
        tolerance: None,
        terrain_hides: false,
        time: None,
    }
}

/// The clear sky of a grid lit by the mixed lamp with Garstang's lobes, by all functions.
pub fn clear_sky(
    polar: impl Into<Arc<PolarGrid>>,
    observer_altitude_m: f64,
    turbidity: Turbidity,
    scattering: Scattering,
) -> RenderRequest {
    RenderRequest {
        polar: polar.into(),
        observer_altitude_m,
        turbidity,
        scattering,
        cloud_base_m: None,
        emission: EmissionMix::garstang(),
        flux_per_dnb_flux: skyglow_bench::options::REFERENCE_FLUX,
        basis: None,
    }
}

/// The sum of the later orders over point sources with Garstang's lobes.
pub fn later_orders(turbidity: Turbidity, observer_altitude_m: f64) -> MultipleSum {
    MultipleSum {
        atmosphere: Atmosphere::new(turbidity),
        ground_albedo: DEFAULT_GROUND_ALBEDO,
        observer_altitude_m,
        emission: EmissionMix::garstang(),
        resolution: Resolution::table(),
        density: SumDensity::default(),
    }
}
