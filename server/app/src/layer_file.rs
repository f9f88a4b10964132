//! Map layers as the bytes of a file: what the HTTP interface answers and the Python package reads.

use crate::{
    answers::{BrightnessAssumptions, brightness_shows, standards::MAX_LAYER_PIXELS},
    error::AppError,
};
use skyglow_display::notes;
use skyglow_observatory::BrightnessMap;
use skyglow_scene::{PlaceValues, RasterMetadata, Scene, TileLayer};

/// A layer of a scene as a cloud-optimized GeoTIFF; takes tenths of a second.
///
/// # Errors
/// [`AppError::Internal`], only by a defect.
pub fn scene_layer(scene: &Scene, layer: TileLayer) -> Result<Vec<u8>, AppError> {
    let places = scene.layer_at_places(layer, scene.place_lattice(MAX_LAYER_PIXELS));
    let places = places.ok_or_else(|| AppError::internal("a layer of another size than its lattice"))?;
    let unit = match layer {
        TileLayer::Radiance => "nW cm-2 sr-1",
        TileLayer::Elevation => "m",
    };
    let metadata = scene.metadata();
    let version = metadata.version.as_str();
    let notes = [("TIFFTAG_SOFTWARE", "Skyglow"), ("SCENE_VERSION", version)];
    let (shows, of_block) = match layer {
        TileLayer::Radiance => ("upward radiance", "mean"),
        TileLayer::Elevation => ("terrain elevation", "middle"),
    };
    let shows = match places.lattice().step {
        1 => shows.to_owned(),
        step => format!("{shows}, {of_block} of {step} x {step} pixels"),
    };
    let description = notes::description(shows, metadata.illustrative);
    let words = RasterMetadata { description: &description, unit, notes: &notes };
    scene.places_geotiff(&places, &words).map_err(AppError::internal)
}

/// A map of brightness as a cloud-optimized GeoTIFF on the scene's own grid; takes tenths of a second.
///
/// # Errors
/// [`AppError::Internal`], only by a defect.
pub fn brightness_layer(
    map: &BrightnessMap,
    assumptions: &BrightnessAssumptions,
) -> Result<Vec<u8>, AppError> {
    let assumptions = serde_json::to_string(assumptions).map_err(AppError::internal)?;
    let notes = [("TIFFTAG_SOFTWARE", "Skyglow"), ("ASSUMPTIONS", assumptions.as_str())];
    let what = brightness_shows(map.measure, map.light, map.cloud_base_m, &map.response);
    let shows = match map.places().lattice().step {
        1 => what,
        step => {
            format!("{what}, found for blocks of {step} x {step} pixels, linear between their middles")
        }
    };
    let description = notes::description(shows, map.scene().illustrative);
    let pixels = on_every_pixel(map.open_scene(), map.places());
    let pixels = pixels.ok_or_else(|| AppError::internal("a map of another size than its lattice"))?;
    let words = RasterMetadata { description: &description, unit: &map.unit(), notes: &notes };
    map.open_scene().places_geotiff(&pixels, &words).map_err(AppError::internal)
}

/// Numbers of places on every pixel of the scene's raster: linear between the places.
fn on_every_pixel(scene: &Scene, places: &PlaceValues) -> Option<PlaceValues> {
    let pixels = scene.place_lattice(MAX_LAYER_PIXELS);
    if pixels == places.lattice() {
        return Some(places.clone());
    }
    let (columns, step) = (pixels.columns as usize, f64::from(pixels.step));
    let value = |index: usize| {
        let middle = |at: usize| (at as f64 + 0.5) * step;
        let value = places.at(middle(index % columns), middle(index / columns), step);
        value.map_or(f32::NAN, |value| value as f32)
    };
    PlaceValues::new(pixels, (0..pixels.len()).map(value).collect())
}
