//! The sky of a place as picture, raster or JSON.

use super::sky::{PreparedSky, put_times, put_warnings, times_of};
use crate::{
    error::ApiError,
    etag::ETag,
    refusals::{NotAcceptable, OfSky},
    respond::{CachePolicy, Caching},
    state::{AppState, EncodedAnswer},
};
use axum::{
    body::Body,
    extract::{Path, RawQuery, State},
    http::{HeaderMap, Response, header},
};
use skyglow_app::{
    accept::{Format, OFFERED, negotiate},
    answers::PanoramaAnswer,
    drawing::draw,
    negotiated_parameters::NegotiatedPanoramaParameters,
    parameters::{CompactParameters, GridParameters, PanoramaParameters, RasterParameters, WebPParameters},
    request::{PictureRequest, panorama, scene_id},
    source::SkySource,
};
use skyglow_display::{DynamicRange, GroundStyle};
use std::sync::Arc;

/// The sky in the format that the Accept header prefers: a picture, a raster, or JSON as `panorama.json` has it; PNG if it takes
/// anything. Parameters that mean nothing for that format are errors.
#[utoipa::path(
    get,
    path = "/api/v1/scenes/{scene}/panorama",
    tag = "sky",
    params(("scene" = String, Path, description = "The scene's id"), NegotiatedPanoramaParameters),
    responses(
        (status = 200, description = "The sky", content(
            (Vec<u8> = "image/png"),
            (Vec<u8> = "image/webp"),
            (Vec<u8> = "image/x-exr"),
            (Vec<u8> = "image/tiff"),
            (Vec<u8> = "application/vnd.skyglow.sky"),
        ), headers(
            ("skyglow-warnings" = String, description = "What the sky had to do without, where anything: the same as `warnings` in JSON"),
            ("server-timing" = String, description = "Milliseconds of each pass of the rendering"),
        )),
        (status = 304, description = "The client has this answer already; nothing was rendered"),
        OfSky,
        NotAcceptable,
    )
)]
pub async fn get_panorama(
    State(state): State<AppState>,
    Path(scene): Path<String>,
    RawQuery(query): RawQuery,
    headers: HeaderMap,
) -> Result<Response<Body>, ApiError> {
    let accept: Vec<&str> =
        headers.get_all(header::ACCEPT).iter().filter_map(|value| value.to_str().ok()).collect();
    let format = negotiate(&accept.join(",")).ok_or(ApiError::NotAcceptable { offered: OFFERED })?;
    answer(state, &scene, query.as_deref(), &headers, format, Some("accept")).await
}

macro_rules! formats {
    ($($name:ident, $extension:literal, $format:expr, $parameters:ident, $body:ty, $media_type:literal, $doc:literal;)*) => {$(
        #[doc = $doc]
        #[utoipa::path(
            get,
            path = concat!("/api/v1/scenes/{scene}/panorama.", $extension),
            tag = "sky",
            params(("scene" = String, Path, description = "The scene's id"), $parameters),
            responses(
                (status = 200, description = "The sky", body = $body, content_type = $media_type, headers(
                    ("skyglow-warnings" = String, description = "What the sky had to do without, where anything: the same as `warnings` in JSON"),
                    ("server-timing" = String, description = "Milliseconds of each pass of the rendering"),
                )),
                (status = 304, description = "The client has this answer already; nothing was rendered"),
                OfSky,
            )
        )]
        pub async fn $name(
            State(state): State<AppState>,
            Path(scene): Path<String>,
            RawQuery(query): RawQuery,
            headers: HeaderMap,
        ) -> Result<Response<Body>, ApiError> {
            answer(state, &scene, query.as_deref(), &headers, $format, None).await
        }
    )*};
}

formats! {
    get_panorama_png, "png", Format::Png, PanoramaParameters, Vec<u8>, "image/png",
        "The sky as PNG, with its legend; with `dynamic_range=hdr` for screens that go above white.";
    get_panorama_webp, "webp", Format::WebP, WebPParameters, Vec<u8>, "image/webp",
        "The sky as lossless WebP, with its legend.";
    get_panorama_exr, "exr", Format::Exr, RasterParameters, Vec<u8>, "image/x-exr",
        "Linear radiance as OpenEXR: channels R, G, B in W m⁻² sr⁻¹, 32-bit floats, 0 where terrain hides the sky; A says where the projection shows the upper hemisphere.";
    get_panorama_tif, "tif", Format::Tiff, RasterParameters, Vec<u8>, "image/tiff",
        "Linear radiance as TIFF: three float32 bands in W m⁻² sr⁻¹; 0 where terrain hides the sky, NaN where the projection shows nothing above the horizontal plane.";
    get_panorama_json, "json", Format::Json, GridParameters, PanoramaAnswer, "application/json",
        "The raw grid with its numbers; it has no projection and no style.";
    get_panorama_sky, "sky", Format::Sky, CompactParameters, Vec<u8>, "application/vnd.skyglow.sky",
        "The raw grid in a tenth of the bytes, for programs that draw: X, Y, Z and scotopic luminance to 0.025 %, and at a time all light and the stars, planets, Moon and Sun that are seen. The guide has the layout.";
}

/// Bytes that drawing takes for each pixel of a picture with its file, and of a raster, of which the file is all that there is; and
/// of any.
const BYTES_PER_PICTURE_PIXEL: usize = 40;
const BYTES_PER_HDR_PIXEL: usize = 60;
const BYTES_PER_RASTER_PIXEL: usize = 13;
const BASE_BYTES: usize = 8 << 20;
/// Bytes of ground in light, about: elevations by azimuth and distance, and what is seen of them.
const GROUND_BYTES: usize = 192 << 20;

fn drawing_bytes(picture: &PictureRequest, format: Format) -> usize {
    let ((width_px, height_px), bytes) = match format {
        Format::Png | Format::WebP => {
            let is_hdr = picture.options.dynamic_range == DynamicRange::High;
            let bytes = if is_hdr { BYTES_PER_HDR_PIXEL } else { BYTES_PER_PICTURE_PIXEL };
            ((picture.options.width_px, picture.options.height_px), bytes)
        }
        Format::Exr | Format::Tiff => (picture.raster_size_px, BYTES_PER_RASTER_PIXEL),
        Format::Json | Format::Sky => ((0, 0), 0),
    };
    let is_lit = picture.options.ground != GroundStyle::Dark;
    let ground = if is_lit { GROUND_BYTES } else { 0 };
    BASE_BYTES + ground + bytes * width_px as usize * height_px as usize
}

async fn answer(
    state: AppState,
    scene: &str,
    query: Option<&str>,
    headers: &HeaderMap,
    format: Format,
    vary: Option<&'static str>,
) -> Result<Response<Body>, ApiError> {
    let (request, picture) = panorama(query, scene_id(scene)?, state.source.facts(), format)?;
    let prepared = PreparedSky::prepare(&state, request).await?;
    let etag = ETag::of(&("panorama", &prepared.key, format.extension(), picture))?;
    let caching = Caching { etag, policy: CachePolicy::Minutes, vary };
    if let Some(response) = caching.not_modified(headers) {
        return Ok(response);
    }
    let make = async {
        let rendered = prepared.render(&state).await?;
        let assumptions = prepared.assumptions(&state, &rendered);
        let warnings = assumptions.warnings.clone();
        let times = times_of(&rendered);
        let bytes = drawing_bytes(&picture, format);
        let (request, view) = (Arc::clone(&prepared.request), prepared.view.clone());
        let draw = move |_: &dyn SkySource| {
            draw(assumptions, (&request, &view), &rendered, &picture, format).map_err(ApiError::internal)
        };
        Ok(EncodedAnswer { bytes: state.work.drawn(bytes, draw).await?, warnings, times })
    };
    let made = state.answer(&caching.etag, make).await?;
    let mut response = made.response(&caching, format.media_type());
    put_times(&mut response, &made.times);
    put_warnings(&mut response, &made.warnings);
    Ok(response)
}
