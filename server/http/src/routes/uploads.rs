//! Changing scenes: for the operator alone.

use crate::etag::ETag;
use crate::{
    access::Client,
    error::ApiError,
    problem::Problem,
    refusals::{BodyTooLong, NotOperator},
    respond::{CachePolicy, Caching},
    state::AppState,
};
use axum::{
    body::Body,
    extract::{FromRequest, Multipart, Path, RawQuery, Request, State, multipart::Field},
    http::{HeaderMap, HeaderValue, Response, StatusCode, header},
};
use skyglow_app::error::AppError;
use skyglow_app::{
    answers::SceneAnswer,
    request::{new_scene_id, no_parameters, scene_id},
    validation::{FieldError, ValidationCode, echo},
};
use skyglow_scene::{IngestOptions, LandClasses, NoisePolicy, OverlapRule, RadianceUnit, SceneId};
use std::{
    path::{Path as FilePath, PathBuf},
    time::Duration,
};
use tokio::{fs::File, io::AsyncWriteExt, sync::OwnedSemaphorePermit};
use utoipa::ToSchema;

/// Longest text of a field that is no file, bytes.
const MAX_TEXT_BYTES: usize = 4096;
/// Files of radiance, and of terrain, at most.
const MAX_FILES: usize = 256;
/// Longest wait for the next piece of a file.
const MAX_PAUSE: Duration = Duration::from_secs(30);

/// A scene's files and what is to be known of them, as `skyglow ingest` has it.
#[derive(Debug, ToSchema)]
#[expect(dead_code, reason = "for the document: the fields are read one by one as they come")]
pub struct SceneUpload {
    /// Upward radiance: GeoTIFF, COG or NASA Black Marble HDF5 granules, plain or in gzip or zip; several on one grid make one scene.
    #[schema(value_type = Vec<String>, format = Binary)]
    radiance: Vec<u8>,
    /// Terrain, GeoTIFF or SRTM `.hgt`; may be given several times, the first that has a value wins.
    #[schema(value_type = Option<String>, format = Binary)]
    terrain: Option<Vec<u8>>,
    /// Classes of land cover, GeoTIFF or COG, by which pictures light the ground; may be given several times.
    #[schema(value_type = Option<String>, format = Binary)]
    land_cover: Option<Vec<u8>>,
    /// GeoJSON or CSV with name, latitude, longitude and population.
    #[schema(value_type = Option<String>, format = Binary)]
    places: Option<Vec<u8>>,
    /// Whose classes of land cover: `worldcover`, `cci`, `corine` or `igbp`; by default WorldCover's, where there are no others.
    land_cover_classes: Option<String>,
    /// Title for people; by default the id.
    title: Option<String>,
    /// When the radiances were taken.
    date: Option<String>,
    /// Whom to credit.
    attribution: Option<String>,
    /// Subdataset or band to read, by name or number.
    band: Option<String>,
    /// Factor on the stored numbers.
    scale: Option<f64>,
    /// `nw-cm2-sr`, `uw-cm2-sr`, `w-cm2-sr`, `uw-m2-sr`, `mw-m2-sr` or `w-m2-sr`; by default what the file says.
    units: Option<String>,
    /// Stored values that are no data, with commas between.
    nodata: Option<String>,
    /// `on` where zero is dark ground though the file declares it no data.
    zero_is_dark: Option<String>,
    /// Radiances below this are dark, nW cm⁻² sr⁻¹.
    floor: Option<f64>,
    /// Radiances above this count as this, nW cm⁻² sr⁻¹.
    cap: Option<f64>,
    /// Values of the granules' quality layer that are taken, with commas between.
    quality: Option<String>,
    /// Pixels with fewer observations are no data, where the granules say how many there were.
    min_observations: Option<u32>,
    /// Noise around zero: `balance` or `cut`.
    noise: Option<String>,
    /// What counts where several rasters have measured a pixel: `first` in the order given, `mean`, `max`, or `newest` by the dates in the
    /// files' names.
    overlap: Option<String>,
    /// Unit of the terrain, such as `m` or `ft`; by default what each file says.
    terrain_units: Option<String>,
    /// Factor on every radiance.
    calibration: Option<f64>,
}

/// Makes a scene of rasters, in place of the one of that id if there is one. They are checked before anything is replaced, and
/// requests under way keep the scene that they have. For the operator: `Authorization: Bearer` with the server's token.
#[utoipa::path(
    put,
    path = "/api/v1/scenes/{scene}",
    tag = "scenes",
    security(("operator_token" = [])),
    params(("scene" = String, Path, description = "The scene's id")),
    request_body(content = SceneUpload, content_type = "multipart/form-data"),
    responses(
        (status = 200, description = "The scene, which takes the place of the one before", body = SceneAnswer),
        (status = 201, description = "The scene, which is new", body = SceneAnswer),
        NotOperator,
        BodyTooLong,
        (status = 400, description = "A body that is no form of such fields", body = Problem, content_type = "application/problem+json"),
        (status = 404, description = "No scene can have this id", body = Problem, content_type = "application/problem+json"),
        (status = 422, description = "Rasters that cannot be meant; what was there before stays", body = Problem, content_type = "application/problem+json"),
        (status = 503, description = "Another upload is under way, no room on disk, or too slow; Retry-After says when to try again", body = Problem, content_type = "application/problem+json"),
    )
)]
pub async fn put_scene(
    State(state): State<AppState>,
    Path(scene): Path<String>,
    RawQuery(query): RawQuery,
    request: Request,
) -> Result<Response<Body>, ApiError> {
    only_operator(&state, request.headers())?;
    let id = new_scene_id(&scene)?;
    no_parameters(query.as_deref())?;
    let Ok(permit) = state.upload_permits.clone().try_acquire_owned() else {
        state.metrics.count_refused("busy");
        return Err(ApiError::App(AppError::Busy { retry_after_s: 30 }));
    };
    let limit = state.config.upload_timeout();
    match tokio::time::timeout(limit, upload(&state, id, request, permit)).await {
        Ok(answer) => answer,
        Err(_) => {
            state.metrics.count_refused("timeout");
            Err(ApiError::Timeout { limit_s: state.config.upload_timeout_s })
        }
    }
}

/// Removes a scene; requests under way keep it. For the operator.
#[utoipa::path(
    delete,
    path = "/api/v1/scenes/{scene}",
    tag = "scenes",
    security(("operator_token" = [])),
    params(("scene" = String, Path, description = "The scene's id")),
    responses(
        (status = 204, description = "It is gone"),
        NotOperator,
        (status = 404, description = "No such scene", body = Problem, content_type = "application/problem+json"),
        (status = 503, description = "The disk does not let it go", body = Problem, content_type = "application/problem+json"),
    )
)]
pub async fn delete_scene(
    State(state): State<AppState>,
    Path(scene): Path<String>,
    RawQuery(query): RawQuery,
    headers: HeaderMap,
) -> Result<StatusCode, ApiError> {
    only_operator(&state, &headers)?;
    let id = scene_id(&scene)?;
    no_parameters(query.as_deref())?;
    let removed = id.clone();
    state.blocking(move |source| Ok(source.remove_scene(&removed)?)).await?;
    state.forget(&id).await;
    tracing::info!(scene = %id, "a scene was removed by the operator");
    Ok(StatusCode::NO_CONTENT)
}

fn only_operator(state: &AppState, headers: &HeaderMap) -> Result<(), ApiError> {
    if !state.access.has_operator() {
        return Err(ApiError::UploadsOff);
    }
    match state.access.client(headers)? {
        Client::Operator => Ok(()),
        Client::Key(_) => Err(ApiError::OperatorOnly),
        Client::Anyone => Err(ApiError::Unauthorized),
    }
}

/// * `permit`: held until the files are gone, whether somebody still waits or not.
async fn upload(
    state: &AppState,
    id: SceneId,
    request: Request,
    permit: OwnedSemaphorePermit,
) -> Result<Response<Body>, ApiError> {
    let mut form = Multipart::from_request(request, &()).await.map_err(|error| {
        field_error("body", None, error.body_text(), "a form (multipart/form-data) with the file `radiance`")
    })?;
    let folder = state.blocking(|source| Ok(source.upload_folder()?)).await?;
    let mut options = IngestOptions { calibration: 1.0, ..IngestOptions::default() };
    (options.id, options.replace) = (Some(id.clone()), true);
    options.max_pixels = Some(state.config.upload_pixels);
    loop {
        let next = tokio::time::timeout(MAX_PAUSE, form.next_field()).await.map_err(|_| too_slow())?;
        let Some(field) = next.map_err(|error| unreadable(state, &error))? else { break };
        take(state, folder.path(), field, &mut options).await?;
    }
    if options.radiance.is_empty() {
        return Err(field_error(
            "radiance",
            None,
            ValidationCode::Missing.description().to_owned(),
            "a raster",
        ));
    }
    let (scene, was_there) = state
        .blocking(move |source| {
            let made = source.ingest(&folder, &options)?;
            drop((folder, permit));
            Ok(made)
        })
        .await?;
    state.forget(&id).await;
    tracing::info!(scene = %id, version = scene.version, replaced = was_there, "a scene was uploaded by the operator");
    let etag = ETag::of(&("uploaded", &scene.version))?;
    let caching = Caching { etag, policy: CachePolicy::Revalidate, vary: None };
    let mut response = caching.json(&SceneAnswer::from(scene))?;
    if !was_there {
        *response.status_mut() = StatusCode::CREATED;
    }
    if let Ok(location) = HeaderValue::from_str(&format!("/api/v1/scenes/{id}")) {
        response.headers_mut().insert(header::LOCATION, location);
    }
    Ok(response)
}

/// Takes a field into the options, a file into the folder.
async fn take(
    state: &AppState,
    folder: &FilePath,
    field: Field<'_>,
    options: &mut IngestOptions,
) -> Result<(), ApiError> {
    let name = field.name().unwrap_or_default().to_owned();
    let is_repeated = match name.as_str() {
        "radiance" => options.radiance.len() >= MAX_FILES,
        "places" => options.places.is_some(),
        "terrain" => options.terrain.len() >= MAX_FILES,
        "land_cover" => options.land_cover.len() >= MAX_FILES,
        _ => false,
    };
    if is_repeated {
        return Err(field_error(
            &name,
            None,
            ValidationCode::Repeated.description().to_owned(),
            "one, or 256 files of radiance, of terrain and of land_cover",
        ));
    }
    match name.as_str() {
        "radiance" => {
            let part = match options.radiance.len() {
                0 => "radiance".to_owned(),
                count => format!("radiance{count}"),
            };
            options.radiance.push(save_file(state, folder, &part, "tif", field).await?);
        }
        "places" => options.places = Some(save_file(state, folder, "places", "csv", field).await?),
        "terrain" => {
            let part = format!("terrain{}", options.terrain.len());
            options.terrain.push(save_file(state, folder, &part, "tif", field).await?);
        }
        "land_cover" => {
            let part = format!("land_cover{}", options.land_cover.len());
            options.land_cover.push(save_file(state, folder, &part, "tif", field).await?);
        }
        _ if TEXT_FIELDS.contains(&name.as_str()) => {
            let text = text_of(state, &name, field).await?;
            take_text(&name, text, options)?;
        }
        _ => {
            let allowed = format!("radiance, terrain, land_cover, places, {}", TEXT_FIELDS.join(", "));
            let message = ValidationCode::UnknownParameter.description().to_owned();
            return Err(field_error(&echo(&name), None, message, &allowed));
        }
    }
    Ok(())
}

/// Fields that are no files.
const TEXT_FIELDS: [&str; 17] = [
    "title",
    "date",
    "attribution",
    "band",
    "scale",
    "units",
    "calibration",
    "nodata",
    "zero_is_dark",
    "floor",
    "cap",
    "quality",
    "min_observations",
    "noise",
    "overlap",
    "land_cover_classes",
    "terrain_units",
];

/// Takes a field that is no file into the options.
fn take_text(name: &str, text: String, options: &mut IngestOptions) -> Result<(), ApiError> {
    let malformed = |allowed: &str| {
        field_error(name, Some(&text), ValidationCode::Malformed.description().to_owned(), allowed)
    };
    let number = |allowed: &str| {
        text.parse::<f64>().ok().filter(|number| number.is_finite()).ok_or_else(|| malformed(allowed))
    };
    let refused = |error: skyglow_scene::SceneError, allowed: &str| {
        field_error(name, Some(&text), error.to_string(), allowed)
    };
    match name {
        "title" => options.title = Some(text),
        "date" => options.date = Some(text),
        "attribution" => options.attribution = Some(text),
        "band" => options.band = Some(text),
        "terrain_units" => options.terrain_units = Some(text),
        "scale" => options.scale = Some(number("a number above 0")?),
        "calibration" => options.calibration = number("a number above 0")?,
        "floor" => options.floor_nw_cm2_sr = Some(number("a number above 0")?),
        "cap" => options.cap_nw_cm2_sr = Some(number("a number above 0")?),
        "nodata" => options.no_data = list(&text).ok_or_else(|| malformed("numbers with commas between"))?,
        "quality" => {
            options.quality =
                Some(list(&text).ok_or_else(|| malformed("whole numbers with commas between"))?);
        }
        "min_observations" => {
            options.min_observations = Some(text.parse().map_err(|_| malformed("a whole number"))?);
        }
        "zero_is_dark" => {
            options.zero_is_dark = match text.as_str() {
                "on" | "true" | "1" => true,
                "off" | "false" | "0" => false,
                _ => return Err(malformed("on or off")),
            };
        }
        "land_cover_classes" => {
            let classes = LandClasses::parse(&text).map_err(|error| refused(error, LandClasses::NAMES))?;
            options.land_cover_classes = Some(classes);
        }
        "overlap" => {
            options.overlap =
                OverlapRule::parse(&text).map_err(|error| refused(error, OverlapRule::NAMES))?;
        }
        "noise" => {
            options.noise = NoisePolicy::parse(&text).map_err(|error| refused(error, "balance or cut"))?;
        }
        _ => {
            let names = RadianceUnit::ALL.map(RadianceUnit::name).join(", ");
            options.units = Some(RadianceUnit::parse(&text).map_err(|error| refused(error, &names))?);
        }
    }
    Ok(())
}

/// Numbers with commas between; None where one is none.
fn list<T: std::str::FromStr>(text: &str) -> Option<Vec<T>> {
    text.split(',').map(|word| word.trim().parse().ok()).collect()
}

/// Writes a file into a folder of its own, for rasters may look for others beside them.
async fn save_file(
    state: &AppState,
    folder: &FilePath,
    part: &str,
    ending: &str,
    mut field: Field<'_>,
) -> Result<PathBuf, ApiError> {
    let storage = |error: std::io::Error| ApiError::App(AppError::Storage { reason: error.to_string() });
    let own = folder.join(part);
    tokio::fs::create_dir(&own).await.map_err(storage)?;
    let path = own.join(field.file_name().and_then(plain_name).unwrap_or_else(|| format!("{part}.{ending}")));
    let mut file = File::create(&path).await.map_err(storage)?;
    while let Some(piece) = tokio::time::timeout(MAX_PAUSE, field.chunk())
        .await
        .map_err(|_| too_slow())?
        .map_err(|error| unreadable(state, &error))?
    {
        file.write_all(&piece).await.map_err(storage)?;
    }
    file.flush().await.map_err(storage)?;
    Ok(path)
}

/// A client's name of a file where it can be one here: granules and `.hgt` say by it what ground they are of.
fn plain_name(name: &str) -> Option<String> {
    let is_plain = |byte: u8| byte.is_ascii_alphanumeric() || b"-_.".contains(&byte);
    let is_name =
        (1..=120).contains(&name.len()) && !name.starts_with(['.', '-']) && name.bytes().all(is_plain);
    is_name.then(|| name.to_owned())
}

async fn text_of(state: &AppState, name: &str, mut field: Field<'_>) -> Result<String, ApiError> {
    let mut bytes = Vec::new();
    while let Some(piece) = tokio::time::timeout(MAX_PAUSE, field.chunk())
        .await
        .map_err(|_| too_slow())?
        .map_err(|error| unreadable(state, &error))?
    {
        bytes.extend_from_slice(&piece);
        if bytes.len() > MAX_TEXT_BYTES {
            return Err(field_error(name, None, "is too long".to_owned(), "4096 bytes at most"));
        }
    }
    String::from_utf8(bytes).map_err(|_| {
        field_error(name, None, ValidationCode::Malformed.description().to_owned(), "text in UTF-8")
    })
}

fn field_error(name: &str, value: Option<&str>, message: String, allowed: &str) -> ApiError {
    ApiError::App(AppError::Parameters(vec![FieldError {
        parameter: name.to_owned(),
        value: value.map(echo),
        allowed: allowed.to_owned(),
        message,
        code: ValidationCode::NotAllowed,
    }]))
}

fn too_slow() -> ApiError {
    ApiError::Unreadable(StatusCode::REQUEST_TIMEOUT.as_u16())
}

fn unreadable(state: &AppState, error: &axum::extract::multipart::MultipartError) -> ApiError {
    if error.status() == StatusCode::PAYLOAD_TOO_LARGE {
        return ApiError::BodyTooLong { limit_bytes: state.config.upload_limit_bytes };
    }
    field_error("body", None, error.body_text(), "a form (multipart/form-data) with the file `radiance`")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_of_files_stay_where_they_are_plain() {
        for name in ["N46E008.hgt", "VNP46A4.A2023001.h21v08.001.h5", "a_b-c.tif"] {
            assert_eq!(plain_name(name).as_deref(), Some(name));
        }
        let long = "a".repeat(121);
        for name in
            ["", ".", "..", ".hidden", "../x.tif", "a/b", "a\\b", "-o", "a b", "ä.tif", "a\0", long.as_str()]
        {
            assert_eq!(plain_name(name), None, "{name:?}");
        }
    }
}
