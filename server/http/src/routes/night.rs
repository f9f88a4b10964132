//! Nights of a place: what the Sun and the Moon leave of them.

use super::frame::{Answer, JsonRequest};
use crate::{refusals::BadParameters, respond::CachePolicy};
use skyglow_app::{
    parameters::{NightParameters, NightsParameters},
    request::{night, nights},
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
