//! Map layers as rasters.

use super::{brightness::PreparedBrightness, sky::put_warnings, tiles::scenario_of};
use crate::{
    asker::Work,
    error::ApiError,
    etag::ETag,
    problem::Problem,
    refusals::BadParameters,
    respond::{CachePolicy, Caching},
    state::{AppState, EncodedAnswer},
    work_places::Lane,
};
use axum::{
    body::Body,
    extract::{Path, RawQuery, State},
    http::{HeaderMap, Response},
};
use skyglow_app::{
    answers::{BrightnessAssumptions, standards::MAX_LAYER_PIXELS},
    layer_file,
    parameters::{BrightnessParameters, NoParameters, ScenarioParameters},
    request::{brightness, scene_id},
    source::SkySource,
};
use skyglow_scene::TileLayer;

/// Bytes that a raster takes for each pixel while it is written.
const BYTES_PER_PIXEL: usize = 16;

fn layer_bytes(pixels: usize) -> usize {
    pixels.min(MAX_LAYER_PIXELS) * BYTES_PER_PIXEL
}

macro_rules! layers {
    ($($get:ident, $name:literal, $parameters:ident, $layer:expr, $answer:ident, $doc:literal;)*) => {$(
        #[doc = $doc]
        #[utoipa::path(
            get,
            path = concat!("/api/v1/scenes/{scene}/layers/", $name, ".tif"),
            tag = "tiles",
            params(("scene" = String, Path, description = "The scene's id"), $parameters),
            responses(
                (status = 200, description = "The raster", body = Vec<u8>, content_type = "image/tiff"),
                (status = 304, description = "The client has this answer already; nothing was computed"),
                BadParameters,
                (status = 404, description = "No such scene or scenario", body = Problem, content_type = "application/problem+json"),
                (status = 409, description = "The scenario is a plan for an earlier state of the scene", body = Problem, content_type = "application/problem+json"),
                (status = 422, description = "Turbidity out of range", body = Problem, content_type = "application/problem+json"),
                (status = 503, description = "Busy, or still being made, then with its progress; Retry-After says when to try again", body = Problem, content_type = "application/problem+json"),
            )
        )]
        pub async fn $get(
            State(state): State<AppState>,
            Path(scene): Path<String>,
            RawQuery(query): RawQuery,
            headers: HeaderMap,
        ) -> Result<Response<Body>, ApiError> {
            $answer(&state, &scene, query.as_deref(), &headers, $layer).await
        }
    )*};
}

layers! {
    get_radiance_tif, "radiance", ScenarioParameters,
        TileLayer::Radiance, scene_layer,
        "Upward radiance as a cloud-optimized GeoTIFF on the scene's own grid: one float32 band, nW cm⁻² sr⁻¹, without the calibration; by blocks where that would be more than 32 million pixels.";
    get_elevation_tif, "elevation", NoParameters,
        TileLayer::Elevation, scene_layer,
        "Terrain elevation at the middles of the scene's pixels as a cloud-optimized GeoTIFF: one float32 band, metres; by blocks where that would be more than 32 million pixels.";
    get_brightness_tif, "brightness", BrightnessParameters,
        (), brightness_layer,
        "The artificial luminance at the zenith of every place as a cloud-optimized GeoTIFF on the scene's own grid: one float32 band, cd m⁻², two metres above the ground; found for blocks of pixels where there are more than 1.2 million, and linear between their middles. The first time it takes seconds: a refusal of the kind `being-made` says that it goes on.";
}

async fn scene_layer(
    state: &AppState,
    scene: &str,
    query: Option<&str>,
    headers: &HeaderMap,
    layer: TileLayer,
) -> Result<Response<Body>, ApiError> {
    let id = scene_id(scene)?;
    let scenario = scenario_of(query, layer)?;
    let view = state.view(&id, scenario.as_ref()).await?;
    let etag = ETag::of(&("layer", view.version(), layer))?;
    let caching = Caching { etag, policy: CachePolicy::Minutes, vary: None };
    if let Some(response) = caching.not_modified(headers) {
        return Ok(response);
    }
    let bytes = layer_bytes(view.metadata().grid.width as usize * view.metadata().grid.height as usize);
    let make =
        state.work.long(Lane::Plan, bytes, move |_, _| Ok(layer_file::scene_layer(view.scene(), layer)?));
    let make = async { make.await.map(|(made, held)| state.work.keep(made, held).into()) };
    let made = state.answer(&caching.etag, make).await?;
    Ok(made.response(&caching, "image/tiff"))
}

async fn brightness_layer(
    state: &AppState,
    scene: &str,
    query: Option<&str>,
    headers: &HeaderMap,
    (): (),
) -> Result<Response<Body>, ApiError> {
    let request = brightness(query, scene_id(scene)?, state.source.facts())?;
    let prepared = PreparedBrightness::prepare(state, request).await?;
    let caching =
        Caching { etag: ETag::of(&("layer", &prepared.key))?, policy: CachePolicy::Minutes, vary: None };
    if let Some(response) = caching.not_modified(headers) {
        return Ok(response);
    }
    let make = async {
        let map = prepared.find(state).await?;
        let assumptions = BrightnessAssumptions::new(prepared.request(), &map, state.source.facts());
        let warnings = assumptions.warnings.clone();
        let grid = &map.scene().grid;
        let bytes = layer_bytes(grid.width as usize * grid.height as usize);
        let write = move |_: &dyn SkySource, _: &Work| Ok(layer_file::brightness_layer(&map, &assumptions)?);
        let (made, held) = state.work.long(Lane::Plan, bytes, write).await?;
        Ok(EncodedAnswer { bytes: state.work.keep(made, held), warnings, ..EncodedAnswer::default() })
    };
    let made = state.answer(&caching.etag, make).await?;
    let mut response = made.response(&caching, "image/tiff");
    put_warnings(&mut response, &made.warnings);
    Ok(response)
}
