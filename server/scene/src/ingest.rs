//! Ingest: reads rasters and places, checks them, reports on them and stores the scene.

mod black_marble;
mod date;
mod gdal_open;
mod georeference;
mod hdf5;
mod options;
mod places;
mod radiance;
mod radiance_band;
mod radiance_source;
mod skylines;
mod tally;
mod terrain_files;

pub use options::{IngestOptions, IngestProgress, IngestStage, RadianceUnit};

use crate::error::SceneError;
use crate::light_layer::{LightLayer, Lights};
use crate::metadata::{GridMetadata, SceneMetadata};
use crate::scene::Scene;
use crate::scene_id::SceneId;
use crate::scene_writer;
use crate::store::SceneStore;
use std::sync::Arc;

/// Reads a radiance raster with its terrain and places, and stores the scene.
///
/// # Errors
/// Every refusal is one sentence: see [`SceneError`]. Nothing is left behind then.
pub fn ingest(
    store: &SceneStore,
    options: &IngestOptions,
    progress: &mut dyn FnMut(IngestProgress),
) -> Result<SceneMetadata, SceneError> {
    ingest_as(store, options, false, progress)
}

/// [`ingest`], for light that may be synthetic.
pub(crate) fn ingest_as(
    store: &SceneStore,
    options: &IngestOptions,
    illustrative: bool,
    progress: &mut dyn FnMut(IngestProgress),
) -> Result<SceneMetadata, SceneError> {
    let id = match &options.id {
        Some(id) => id.clone(),
        None => SceneId::from_file_name(&options.radiance)?,
    };
    // First of all, as it may bring a scene back that was set aside.
    store.clear_stale();
    if store.exists(&id) && !options.replace {
        return Err(SceneError::SceneExists { id: id.to_string() });
    }
    options.check()?;
    let places = options.places.as_deref().map(places::read).transpose()?.unwrap_or_default();
    let source = radiance_band::open(options)?;
    options
        .check_size(source.dataset.raster_size())
        .map_err(|reason| SceneError::Refused { path: options.radiance.clone(), reason })?;
    let mut light = radiance::read(&source, progress)?;
    let terrain = terrain_files::read(options, progress)?;
    terrain_files::set_altitudes(&terrain, &mut light, progress);
    let skylines = skylines::of_lights(&terrain.terrain, &light.grid, &light.pixels, progress);
    let has_skylines = skylines.is_some();
    let lights = Lights::new(&light.grid, light.pixels, skylines, options.calibration);
    let mut report = light.report;
    let pyramid = &lights.pyramid;
    if pyramid.top() > 0 {
        report.flux_dnb_w = pyramid.level(pyramid.top()).blocks.iter().map(|b| b.flux_dnb_w).sum();
    }
    let metadata = SceneMetadata {
        title: options.title.clone().unwrap_or_else(|| id.to_string()),
        id,
        bounds: light.grid.bounds_deg(),
        grid: GridMetadata {
            width: light.grid.width,
            height: light.grid.height,
            geotransform: source.geotransform,
            crs_wkt: source.crs_wkt.clone(),
        },
        crs: source.crs_name.clone(),
        calibration: options.calibration,
        report,
        pixel_size_m: light.grid.pixel_size_m(),
        lit_pixels: lights.pixels.len() as u64,
        date: options.date.clone(),
        attribution: options.attribution.clone(),
        illustrative,
        terrain: !terrain.terrain.is_empty(),
        light_skylines: has_skylines,
        places_count: places.len() as u64,
        version: String::new(),
    };
    let mut scene = Scene {
        metadata,
        grid: Arc::new(light.grid),
        mask: Arc::new(light.mask),
        light_layers: vec![LightLayer::whole(lights)],
        terrain: Arc::new(terrain.terrain),
        places: places.into(),
    };
    progress(IngestProgress { stage: IngestStage::Store, done: 0, total: 1 });
    scene_writer::write(store.scenes_dir(), &mut scene, options.replace)?;
    progress(IngestProgress { stage: IngestStage::Store, done: 1, total: 1 });
    Ok(scene.metadata)
}
