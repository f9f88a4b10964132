//! OGC API – Common and Tiles: landing page, conformance, collections and tile sets. They say where things are; the things are
//! answered by the other routes.

use super::frame::{Answer, JsonRequest};
use crate::{
    error::ApiError, problem::Problem, refusals::BadParameters, respond::CachePolicy, trust::PublicAddress,
};
use axum::{
    Extension,
    extract::{Path, RawQuery},
    http::HeaderMap,
};
use serde_json::Value;
use skyglow_app::{
    answers::standards::{self as documents, Base},
    error::AppError,
    request::document_format,
    source::SkySource,
    standard_parameters::DocumentParameters,
};
use skyglow_scene::SceneMetadata;

impl PublicAddress {
    /// The address for links in documents.
    pub(super) fn links(&self) -> Base {
        Base::new(self.base())
    }
}

/// A document that follows from a scene.
pub(super) async fn of_scene(
    request: JsonRequest,
    make: impl FnOnce(&SceneMetadata) -> Result<Value, ApiError> + Send + 'static,
) -> Answer {
    document_format(request.query.as_deref())?;
    let id = request.scene()?;
    let read = move |source: &dyn SkySource| make(source.view(&id, None)?.metadata());
    request.answer(CachePolicy::Revalidate, read).await
}

/// A document that follows from all scenes.
pub(super) async fn of_scenes(
    request: JsonRequest,
    make: impl FnOnce(&[SceneMetadata]) -> Value + Send + 'static,
) -> Answer {
    document_format(request.query.as_deref())?;
    request.answer(CachePolicy::Revalidate, move |source| Ok(make(&source.scenes()?))).await
}

/// A document that follows from nothing else.
pub(super) fn constant(query: Option<&str>, headers: &HeaderMap, document: &Value) -> Answer {
    document_format(query)?;
    crate::respond::json_by_content(headers, CachePolicy::Revalidate, document)
}

/// The landing page of the OGC APIs: Common, EDR, Tiles, Maps and Processes.
#[utoipa::path(
    get,
    path = "/api/ogc",
    tag = "standards",
    params(DocumentParameters),
    responses((status = 200, description = "The landing page", body = Object), BadParameters)
)]
pub async fn get_landing(
    Extension(address): Extension<PublicAddress>,
    RawQuery(query): RawQuery,
    headers: HeaderMap,
) -> Answer {
    constant(query.as_deref(), &headers, &documents::landing(&address.links()))
}

/// The requirements of OGC's standards that this server conforms to.
#[utoipa::path(
    get,
    path = "/api/ogc/conformance",
    tag = "standards",
    params(DocumentParameters),
    responses((status = 200, description = "The classes", body = Object), BadParameters)
)]
pub async fn get_conformance(RawQuery(query): RawQuery, headers: HeaderMap) -> Answer {
    constant(query.as_deref(), &headers, &documents::conformance())
}

/// The collections: a scene each, with its extent, its numbers with their units, and how to ask for them.
#[utoipa::path(
    get,
    path = "/api/ogc/collections",
    tag = "standards",
    params(DocumentParameters),
    responses((status = 200, description = "The collections", body = Object), BadParameters)
)]
pub async fn get_collections(Extension(address): Extension<PublicAddress>, request: JsonRequest) -> Answer {
    let base = address.links();
    of_scenes(request, move |scenes| documents::collections(&base, scenes)).await
}

/// A collection.
#[utoipa::path(
    get,
    path = "/api/ogc/collections/{scene}",
    tag = "standards",
    params(("scene" = String, Path, description = "The scene's id"), DocumentParameters),
    responses(
        (status = 200, description = "The collection", body = Object),
        BadParameters,
        (status = 404, description = "No such scene", body = Problem, content_type = "application/problem+json"),
    )
)]
pub async fn get_collection(Extension(address): Extension<PublicAddress>, request: JsonRequest) -> Answer {
    let base = address.links();
    of_scene(request, move |scene| Ok(documents::collection(&base, scene))).await
}

/// The tile sets of a collection's maps; the first is that of `map`.
#[utoipa::path(
    get,
    path = "/api/ogc/collections/{scene}/map/tiles",
    tag = "standards",
    params(("scene" = String, Path, description = "The scene's id"), DocumentParameters),
    responses(
        (status = 200, description = "The tile sets", body = Object),
        BadParameters,
        (status = 404, description = "No such scene", body = Problem, content_type = "application/problem+json"),
    )
)]
pub async fn get_tilesets(Extension(address): Extension<PublicAddress>, request: JsonRequest) -> Answer {
    let base = address.links();
    of_scene(request, move |scene| Ok(documents::tilesets(&base, scene))).await
}

/// A tile set, with the template of its tiles' addresses: they take the parameters of the layer's tiles.
#[utoipa::path(
    get,
    path = "/api/ogc/collections/{scene}/map/tiles/{tileset}",
    tag = "standards",
    params(
        ("scene" = String, Path, description = "The scene's id"),
        ("tileset" = String, Path, description = "`brightness`, `radiance` or `elevation`"),
        DocumentParameters,
    ),
    responses(
        (status = 200, description = "The tile set", body = Object),
        BadParameters,
        (status = 404, description = "No such scene or tile set", body = Problem, content_type = "application/problem+json"),
    )
)]
pub async fn get_tileset(
    Extension(address): Extension<PublicAddress>,
    Path((_, name)): Path<(String, String)>,
    request: JsonRequest,
) -> Answer {
    let base = address.links();
    let make = move |scene: &SceneMetadata| {
        documents::tileset(&base, scene, &name).ok_or_else(|| {
            let reason = "the tile sets are brightness, radiance and, with terrain, elevation".to_owned();
            ApiError::App(AppError::UnknownTile { reason })
        })
    };
    of_scene(request, make).await
}

/// The tile matrix sets: one.
#[utoipa::path(
    get,
    path = "/api/ogc/tileMatrixSets",
    tag = "standards",
    params(DocumentParameters),
    responses((status = 200, description = "The tile matrix sets", body = Object), BadParameters)
)]
pub async fn get_tile_matrix_sets(
    Extension(address): Extension<PublicAddress>,
    RawQuery(query): RawQuery,
    headers: HeaderMap,
) -> Answer {
    constant(query.as_deref(), &headers, &documents::tile_matrix_sets(&address.links()))
}

/// A tile matrix set.
#[utoipa::path(
    get,
    path = "/api/ogc/tileMatrixSets/{tms}",
    tag = "standards",
    params(("tms" = String, Path, description = "`WebMercatorQuad`"), DocumentParameters),
    responses(
        (status = 200, description = "The tile matrix set", body = Object),
        BadParameters,
        (status = 404, description = "No such set", body = Problem, content_type = "application/problem+json"),
    )
)]
pub async fn get_tile_matrix_set(
    Path(id): Path<String>,
    RawQuery(query): RawQuery,
    headers: HeaderMap,
) -> Answer {
    let document = documents::tile_matrix_set(&id).ok_or(ApiError::NotFound)?;
    constant(query.as_deref(), &headers, &document)
}
