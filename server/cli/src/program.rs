//! Scenes, packs and engine put together.

use crate::{
    failure::Failure,
    progress::{self, Stages},
    settings::Device,
};
use skyglow_engine::{Engine, EngineConfig, Observatory, observatory, resident_tables};
use skyglow_http::SkySource;
use skyglow_scene::{ChangeLimits, SceneStore, create_demo, demo_is_wanted};
use skyglow_tables::packs_in;
use std::{path::Path, sync::Arc};

/// An engine over the packs of a folder, before the scenes of another.
///
/// * `limits`: what is kept of scenarios and plans.
/// * `most_places`: of a map of the zenith's brightness.
///
/// # Errors
/// [`Failure::Work`] where there are no packs, one is refused, or there is no such device.
pub(crate) fn open(
    data: &Path,
    packs: &Path,
    device: Device,
    limits: ChangeLimits,
    most_places: usize,
) -> Result<Arc<dyn SkySource>, Failure> {
    let paths = packs_in(packs).map_err(Failure::work)?;
    if paths.is_empty() {
        return Err(Failure::Work(format!(
            "no table packs in {}: `skyglow precompute` makes them",
            packs.display()
        )));
    }
    let (tables, manifests) = resident_tables(&paths).map_err(Failure::work)?;
    let config = EngineConfig { device: device.into(), tables, ..EngineConfig::default() };
    let engine = Engine::start(config).map_err(Failure::work)?;
    let observatory =
        Observatory::with_limits(engine, manifests, data, observatory::OPEN_SCENE_COUNT, limits);
    let source = skyglow_http::ObservatorySource::new(Arc::new(observatory));
    Ok(Arc::new(source.with_most_places(most_places)))
}

/// Makes the demo scene where there is none, or one of an older program.
///
/// # Errors
/// [`Failure::Work`] where the data folder cannot be written.
pub(crate) fn make_demo_if_missing(data: &Path) -> Result<(), Failure> {
    let store = SceneStore::new(data);
    if !demo_is_wanted(&store) {
        return Ok(());
    }
    tracing::info!("making the demo scene in {}", store.scenes_dir().display());
    let stages = Stages::new();
    create_demo(&store, &mut progress::of_ingest(&stages)).map_err(Failure::work)?;
    Ok(())
}
