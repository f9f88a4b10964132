//! The scenes as a SpatioTemporal Asset Catalog (STAC): a catalogue, a collection for each scene, an item for each of its layers.

use super::{
    frame::{Answer, JsonRequest},
    ogc::of_scenes,
};
use crate::{
    error::ApiError,
    problem::Problem,
    refusals::BadParameters,
    respond::{CachePolicy, bytes_by_content, json_bytes},
    trust::PublicAddress,
};
use axum::{Extension, extract::Path};
use skyglow_app::{
    answers::standards::{StacItem, stac_catalog, stac_collection, stac_item},
    request::document_format,
    source::SkySource,
    standard_parameters::DocumentParameters,
};

/// The STAC catalogue of the scenes.
#[utoipa::path(
    get,
    path = "/api/stac",
    tag = "standards",
    params(DocumentParameters),
    responses((status = 200, description = "The catalogue", body = Object), BadParameters)
)]
pub async fn get_stac_catalog(Extension(address): Extension<PublicAddress>, request: JsonRequest) -> Answer {
    let base = address.links();
    of_scenes(request, move |scenes| stac_catalog(&base, scenes)).await
}

/// A scene as a STAC collection.
#[utoipa::path(
    get,
    path = "/api/stac/collections/{scene}",
    tag = "standards",
    params(("scene" = String, Path, description = "The scene's id"), DocumentParameters),
    responses(
        (status = 200, description = "The collection", body = Object),
        BadParameters,
        (status = 404, description = "No such scene", body = Problem, content_type = "application/problem+json"),
    )
)]
pub async fn get_stac_collection(
    Extension(address): Extension<PublicAddress>,
    request: JsonRequest,
) -> Answer {
    document_format(request.query.as_deref())?;
    let (base, id) = (address.links(), request.scene()?);
    let read = move |source: &dyn SkySource| {
        let view = source.view(&id, None)?;
        Ok(stac_collection(&base, view.metadata(), source.stored_unix_s(&id)))
    };
    request.answer(CachePolicy::Revalidate, read).await
}

/// A layer of a scene as a STAC item, whose asset is the layer's cloud-optimized GeoTIFF.
#[utoipa::path(
    get,
    path = "/api/stac/collections/{scene}/items/{item}",
    tag = "standards",
    params(
        ("scene" = String, Path, description = "The scene's id"),
        ("item" = String, Path, description = "`radiance`, `elevation` or `brightness`"),
        DocumentParameters,
    ),
    responses(
        (status = 200, description = "The item", body = Object, content_type = "application/geo+json"),
        BadParameters,
        (status = 404, description = "No such scene or layer", body = Problem, content_type = "application/problem+json"),
    )
)]
pub async fn get_stac_item(
    Extension(address): Extension<PublicAddress>,
    Path((_, item)): Path<(String, String)>,
    request: JsonRequest,
) -> Answer {
    document_format(request.query.as_deref())?;
    let (base, id) = (address.links(), request.scene()?);
    let read = move |source: &dyn SkySource| {
        let view = source.view(&id, None)?;
        let scene = view.metadata();
        let item = StacItem::of_id(&item, scene).ok_or(ApiError::NotFound)?;
        stac_item(&base, scene, item, source.stored_unix_s(&id)).ok_or(ApiError::NotFound)
    };
    let document = request.state.blocking(read).await?;
    let bytes = json_bytes(&document)?;
    bytes_by_content(&request.headers, CachePolicy::Revalidate, "application/geo+json", bytes)
}
