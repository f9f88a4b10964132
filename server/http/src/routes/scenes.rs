//! Scenes and their named places.

use super::frame::{Answer, JsonRequest};
use crate::{
    etag::ETag,
    problem::Problem,
    respond::{CachePolicy, Caching},
};
use skyglow_app::{
    answers::{PlaceAnswer, SceneAnswer},
    source::SkySource,
};

/// Lists the scenes.
#[utoipa::path(
    get,
    path = "/api/v1/scenes",
    tag = "scenes",
    responses(
        (status = 200, description = "All scenes, by id", body = Vec<SceneAnswer>),
        (status = 304, description = "The client has this answer already"),
        (status = 400, description = "Bad parameters", body = Problem, content_type = "application/problem+json"),
    )
)]
pub async fn list_scenes(asked: JsonRequest) -> Answer {
    asked.without_parameters()?;
    let read =
        |source: &dyn SkySource| Ok(source.scenes()?.into_iter().map(SceneAnswer::from).collect::<Vec<_>>());
    asked.answer(CachePolicy::Revalidate, read).await
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
        (status = 400, description = "Bad parameters", body = Problem, content_type = "application/problem+json"),
        (status = 404, description = "No such scene", body = Problem, content_type = "application/problem+json"),
    )
)]
pub async fn get_scene(asked: JsonRequest) -> Answer {
    let id = asked.scene()?;
    asked.without_parameters()?;
    asked.answer(CachePolicy::Revalidate, move |source| Ok(SceneAnswer::from(source.scene(&id)?))).await
}

/// Lists the named places of a scene, the most populous first.
#[utoipa::path(
    get,
    path = "/api/v1/scenes/{scene}/places",
    tag = "scenes",
    params(("scene" = String, Path, description = "The scene's id")),
    responses(
        (status = 200, description = "The places", body = Vec<PlaceAnswer>),
        (status = 304, description = "The client has this answer already"),
        (status = 400, description = "Bad parameters", body = Problem, content_type = "application/problem+json"),
        (status = 404, description = "No such scene", body = Problem, content_type = "application/problem+json"),
    )
)]
pub async fn list_places(asked: JsonRequest) -> Answer {
    let id = asked.scene()?;
    asked.without_parameters()?;
    let wanted = id.clone();
    let scene = asked.state.blocking(move |source| Ok(source.scene(&wanted)?)).await?;
    let etag = ETag::of(&["places", &scene.version]);
    let caching = Caching { etag, policy: CachePolicy::Minutes, vary: None };
    if let Some(response) = caching.not_modified(&asked.headers) {
        return Ok(response);
    }
    let places = asked.state.blocking(move |source| Ok(source.places(&id)?)).await?;
    let answer: Vec<PlaceAnswer> = places.into_iter().map(PlaceAnswer::from).collect();
    caching.json(&answer)
}
