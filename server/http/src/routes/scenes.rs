//! Scenes and their named places.

use super::frame::{Answer, JsonRequest};
use crate::{
    etag::ETag,
    refusals::{BadParameters, OfScene},
    respond::{CachePolicy, Caching},
};
use skyglow_app::{
    answers::SceneAnswer,
    parameters::WorldPlacesParameters,
    request::{FoundPlace, world_places},
    source::SkySource,
};
use skyglow_scene::NamedPlace;

/// Lists the scenes.
#[utoipa::path(
    get,
    path = "/api/v1/scenes",
    tag = "scenes",
    responses(
        (status = 200, description = "All scenes, by id", body = Vec<SceneAnswer>),
        (status = 304, description = "The client has this answer already"),
        BadParameters,
    )
)]
pub async fn list_scenes(request: JsonRequest) -> Answer {
    request.without_parameters()?;
    let read =
        |source: &dyn SkySource| Ok(source.scenes()?.into_iter().map(SceneAnswer::from).collect::<Vec<_>>());
    request.answer(CachePolicy::Revalidate, read).await
}

/// Describes a scene.
#[utoipa::path(
    get,
    path = "/api/v1/scenes/{scene}",
    tag = "scenes",
    params(("scene" = String, Path, description = "The scene's id")),
    responses(
        (status = 200, description = "The scene", body = SceneAnswer),
        (status = 304, description = "The client has this answer already"),
        OfScene,
    )
)]
pub async fn get_scene(request: JsonRequest) -> Answer {
    let id = request.scene()?;
    request.without_parameters()?;
    request
        .answer(CachePolicy::Revalidate, move |source| {
            Ok(SceneAnswer::from(source.view(&id, None)?.metadata().clone()))
        })
        .await
}

/// Finds places of the world by name, and the scene in which each lies.
#[utoipa::path(
    get,
    path = "/api/v1/places",
    tag = "scenes",
    params(WorldPlacesParameters),
    responses(
        (status = 200, description = "The places, 10 at most: whole names first, then the most populous", body = Vec<FoundPlace>),
        (status = 304, description = "The client has this answer already"),
        BadParameters,
    )
)]
pub async fn list_world_places(request: JsonRequest) -> Answer {
    let query = request.query.clone();
    request
        .answer(CachePolicy::Revalidate, move |source| Ok(world_places(query.as_deref(), &source.scenes()?)?))
        .await
}

/// Lists the named places of a scene, the most populous first.
#[utoipa::path(
    get,
    path = "/api/v1/scenes/{scene}/places",
    tag = "scenes",
    params(("scene" = String, Path, description = "The scene's id")),
    responses(
        (status = 200, description = "The places", body = Vec<NamedPlace>),
        (status = 304, description = "The client has this answer already"),
        OfScene,
    )
)]
pub async fn list_places(request: JsonRequest) -> Answer {
    let id = request.scene()?;
    request.without_parameters()?;
    let view = request.state.view(&id, None).await?;
    let etag = ETag::of(&("places", view.version()))?;
    let caching = Caching { etag, policy: CachePolicy::Minutes, vary: None };
    if let Some(response) = caching.not_modified(&request.headers) {
        return Ok(response);
    }
    caching.json(&request.state.source.places(&view))
}
