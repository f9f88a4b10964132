//! Nights of a place: what the Sun and the Moon leave of them.

use super::{
    frame::{Answer, JsonRequest},
    sky::PreparedSky,
};
use crate::{
    etag::ETag,
    refusals::{BadParameters, OfSky},
    respond::{CachePolicy, Caching},
};
use skyglow_app::{
    answers::NightHoursAnswer,
    parameters::{NightParameters, NightsParameters, SceneNightParameters},
    request::{night, nights, scene_night},
    source::SkySource,
};
use skyglow_celestial::{Calendar, Night};

/// Rise, set and twilights of a night, its Moon, and when it is dark.
#[utoipa::path(
    get,
    path = "/api/v1/night",
    tag = "sky",
    params(NightParameters),
    responses(
        (status = 200, description = "The night", body = Night),
        (status = 304, description = "The client has this answer already"),
        BadParameters,
    )
)]
pub async fn get_night(request: JsonRequest) -> Answer {
    let query = request.query.clone();
    request.answer(CachePolicy::Minutes, move |_| Ok(night(query.as_deref())?)).await
}

/// How long the nights of a month are dark.
#[utoipa::path(
    get,
    path = "/api/v1/nights",
    tag = "sky",
    params(NightsParameters),
    responses(
        (status = 200, description = "The month", body = Calendar),
        (status = 304, description = "The client has this answer already"),
        BadParameters,
    )
)]
pub async fn list_nights(request: JsonRequest) -> Answer {
    let query = request.query.clone();
    request.answer(CachePolicy::Minutes, move |_| Ok(nights(query.as_deref())?)).await
}

/// A night over a place of a scene, hour by hour: how bright zenith and horizon are with all light, where Sun and Moon stand, and which
/// hour is the darkest.
#[utoipa::path(
    get,
    path = "/api/v1/scenes/{scene}/night",
    tag = "sky",
    params(("scene" = String, Path, description = "The scene's id"), SceneNightParameters),
    responses(
        (status = 200, description = "The night", body = NightHoursAnswer),
        (status = 304, description = "The client has this answer already; nothing was rendered"),
        OfSky,
    )
)]
pub async fn get_scene_night(request: JsonRequest) -> Answer {
    let state = request.state.clone();
    let asked = scene_night(request.query.as_deref(), request.scene()?, state.source.facts())?;
    let prepared = PreparedSky::prepare(&state, asked.sky.clone()).await?;
    let tag = ("night", &prepared.key, asked.night.date, asked.solar_flux_sfu.to_bits());
    let caching = Caching { etag: ETag::of(&tag)?, policy: CachePolicy::Minutes, vary: None };
    if let Some(response) = caching.not_modified(&request.headers) {
        return Ok(response);
    }
    let rendered = prepared.render(&state).await?;
    let assumptions = prepared.assumptions(&state, &rendered);
    let hours = asked.hours();
    let (sky, night, solar_flux_sfu) = (asked.sky, asked.night, asked.solar_flux_sfu);
    let at_hours = move |source: &dyn SkySource| Ok(source.sky_at_times(&sky, &rendered, &hours)?);
    let skies = state.heavy(at_hours).await?;
    caching.json(&NightHoursAnswer::new(assumptions, night, solar_flux_sfu, &skies))
}
