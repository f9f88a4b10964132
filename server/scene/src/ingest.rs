//! Ingest: reads rasters and places, checks them, reports on them and stores the scene.

mod black_marble;
mod date;
mod file_list;
mod gdal_open;
mod georeference;
mod granule_name;
mod hdf5;
mod land_classes;
mod land_cover_files;
mod layers;
mod mosaic;
mod no_data;
mod noise;
mod options;
mod overlap;
mod overlap_rule;
mod places;
mod radiance;
mod radiance_band;
mod radiance_source;
mod skylines;
mod statistics;
mod tally;
mod terrain_files;
mod units;
mod unpack;

pub use land_classes::LandClasses;
pub use options::{IngestOptions, IngestProgress, IngestStage, NoisePolicy, SkylineTime};
pub use overlap_rule::OverlapRule;
pub use units::RadianceUnit;

use self::mosaic::Mosaic;
use crate::error::SceneError;
use crate::gazetteer::{GAZETTEER_CREDIT, Gazetteer};
use crate::light_layer::{LightLayer, Lights};
use crate::memory::LightCount;
use crate::metadata::{GridMetadata, Recognition, SceneMetadata};
use crate::scene::Scene;
use crate::scene_id::SceneId;
use crate::scene_writer;
use crate::store::SceneStore;
use std::sync::Arc;
use std::time::{SystemTime, UNIX_EPOCH};

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
    let first = options.radiance.first().ok_or_else(|| SceneError::InvalidOption {
        option: "FILES",
        reason: "no radiance raster is given".to_owned(),
    })?;
    let id = match &options.id {
        Some(id) => id.clone(),
        None => SceneId::from_file_name(first)?,
    };
    // First of all, as it may bring a scene back that was set aside.
    store.clear_stale();
    if store.exists(&id) && !options.replace {
        return Err(SceneError::SceneExists { id: id.to_string() });
    }
    let is_trusted = options.max_pixels.is_none();
    let mut options = options.clone();
    if is_trusted {
        let list = file_list::expand(&options.radiance)?;
        options.radiance = list.paths;
        options.no_data.extend(list.no_data);
    }
    let unpacked = unpack::unpack(&options.radiance, options.max_pixels)?;
    options.radiance = unpacked.paths.clone();
    options.check()?;
    let options = &options;
    let given = options.places.as_deref().map(places::read).transpose()?;
    let (mosaic, date) = open_mosaic(options)?;
    options
        .check_size(mosaic.size)
        .map_err(|reason| SceneError::Refused { path: mosaic.first().path.clone(), reason })?;
    let mut light = radiance::read(&mosaic, options, progress)?;
    let (places, places_source) = match given {
        Some(given) => {
            let outside = places::check_inside(&given.places, light.grid.bounds_deg());
            let path = options.places.clone().unwrap_or_default();
            let outside = outside.map_err(|reason| SceneError::Refused { path, reason })?;
            light.report.warnings.extend(given.warnings.into_iter().chain(outside));
            (given.places, None)
        }
        None => {
            let places = Gazetteer::world().within(light.grid.bounds_deg());
            let source = (!places.is_empty()).then(|| GAZETTEER_CREDIT.to_owned());
            (places, source)
        }
    };
    let (crs_wkt, crs_name) = mosaic.crs_text()?;
    let terrain = terrain_files::read(options, progress)?;
    terrain_files::set_altitudes(&terrain, &mut light, options, progress)?;
    let land_cover = land_cover_files::read(options, &light.grid, &mut light.report.recognised)?;
    let when = options.skylines.unwrap_or_else(|| SkylineTime::of_lights(light.pixels.len()));
    let skylines = match when {
        SkylineTime::Ingest => skylines::of_lights(&terrain.terrain, &light.grid, &light.pixels, progress),
        SkylineTime::Need => None,
    };
    let has_skylines = !terrain.terrain.is_empty();
    let with_skylines = skylines.as_ref().map_or(0, |skylines| skylines.blocked_count() as u64);
    let count = LightCount::of_codes(&light.pixels.codes, with_skylines);
    radiance::check_scene(&count, options)
        .map_err(|reason| SceneError::Refused { path: mosaic.first().path.clone(), reason })?;
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
            geotransform: mosaic.geotransform,
            crs_wkt,
        },
        crs: crs_name,
        calibration: options.calibration,
        report,
        pixel_size_m: light.grid.pixel_size_m(),
        lit_pixels: lights.pixels.len() as u64,
        date,
        attribution: options.attribution.clone(),
        illustrative,
        terrain: !terrain.terrain.is_empty(),
        light_skylines: has_skylines,
        land_cover: !land_cover.is_empty(),
        places_count: places.len() as u64,
        places_source,
        ingested_unix_s: (!illustrative).then(now_unix_s).flatten(),
        version: String::new(),
    };
    let mut scene = Scene {
        metadata,
        grid: Arc::new(light.grid),
        mask: Arc::new(light.mask),
        light_layers: vec![LightLayer::whole(lights)],
        terrain: Arc::new(terrain.terrain),
        land_cover: Arc::new(land_cover),
        places: places.into(),
    };
    progress(IngestProgress { stage: IngestStage::Store, done: 0, total: 1 });
    scene_writer::write(store.scenes_dir(), &mut scene, options.replace)?;
    progress(IngestProgress { stage: IngestStage::Store, done: 1, total: 1 });
    Ok(scene.metadata)
}

/// Now; None on a machine whose clock stands before 1970.
fn now_unix_s() -> Option<u64> {
    SystemTime::now().duration_since(UNIX_EPOCH).ok().map(|since| since.as_secs())
}

/// Opens all radiance rasters, and says when they were taken: by the options, else by the files' names.
fn open_mosaic(options: &IngestOptions) -> Result<(Mosaic, Option<String>), SceneError> {
    let mut sources = Vec::with_capacity(options.radiance.len());
    let mut dates = Vec::new();
    for (index, path) in options.radiance.iter().enumerate() {
        let mut source = radiance_band::open(options, path, index)?;
        let name = path.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default();
        let product = granule_name::product(&name);
        if source.no_data.has_zero() {
            // Masked products of the Earth Observation Group are 0 where nothing shines.
            if options.zero_is_dark || product.is_some() {
                source.no_data.take_zero_for_dark();
                source.recognised.push(Recognition::likely("no data", "0 is dark ground".to_owned()));
            } else {
                source.warnings.push(
                    "0 is declared no data, so dark ground counts as not measured; where 0 means dark, give --zero-is-dark"
                        .to_owned(),
                );
            }
        }
        dates.push(product.as_ref().and_then(|product| product.date.clone()));
        if let Some(product) = product {
            source.recognised.push(Recognition::likely("product", product.name.to_owned()));
        }
        sources.push(source);
    }
    let by_name = granule_name::span(&dates);
    if let (None, Some(date), Some(source)) = (&options.date, &by_name, sources.first_mut()) {
        source.recognised.push(Recognition::likely("date", format!("{date} by the name of the file")));
    }
    let date = options.date.clone().or(by_name);
    let sources = overlap::newest_first(options, &dates, sources)?;
    Ok((Mosaic::new(sources)?, date))
}
