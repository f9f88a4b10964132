//! Darker places near a place.

use super::sky::{PreparedSky, put_times, put_warnings};
use crate::{
    error::ApiError,
    etag::ETag,
    refusals::OfSky,
    respond::{CachePolicy, Caching, json_bytes},
    state::{AppState, EncodedAnswer},
    work_places::Lane,
};
use axum::{
    body::{Body, Bytes},
    extract::{Path, RawQuery, State},
    http::{HeaderMap, Response},
};
use skyglow_app::{
    answers::DarkerAnswer,
    parameters::DarkerParameters,
    request::{darker, scene_id},
};

/// Bytes that a search takes, about: a few numbers for each of its places.
const SEARCH_BYTES: usize = 8 << 20;

/// Darker places near a place: where they are, what they gain, and in which directions their low sky is clean.
///
/// Some ten thousand places around are compared by the brightness of their zenith, two metres above the ground. The darkest within
/// reach, within half of it, a quarter and an eighth are named, and others nearly as dark that lie apart. Places on the sea are left
/// out where the terrain shows it.
#[utoipa::path(
    get,
    path = "/api/v1/scenes/{scene}/darker",
    tag = "sky",
    params(("scene" = String, Path, description = "The scene's id"), DarkerParameters),
    responses(
        (status = 200, description = "The darker places, the darkest first", body = DarkerAnswer, headers(
            ("skyglow-warnings" = String, description = "What the sky had to do without, where anything: the same as `warnings`"),
            ("server-timing" = String, description = "Milliseconds that each step of the search took, when it was made"),
        )),
        (status = 304, description = "The client has this answer already; nothing was computed"),
        OfSky,
    )
)]
pub async fn get_darker(
    State(state): State<AppState>,
    Path(scene): Path<String>,
    RawQuery(query): RawQuery,
    headers: HeaderMap,
) -> Result<Response<Body>, ApiError> {
    let question = darker(query.as_deref(), scene_id(&scene)?, state.source.facts())?;
    let here = PreparedSky::prepare(&state, question.here.clone()).await?;
    let search = question.search.clone();
    let etag = ETag::of(&("darker", &here.key, search.within_m, search.count))?;
    let caching = Caching { etag, policy: CachePolicy::Minutes, vary: None };
    if let Some(response) = caching.not_modified(&headers) {
        return Ok(response);
    }
    let make = async {
        let within_m = search.within_m;
        let view = here.view.clone();
        let find = state.work.long(Lane::Influence, SEARCH_BYTES, move |source, work| {
            Ok(source.darker(&search, &view, &|done| work.note(done))?)
        });
        let (found, held) = find.await?;
        drop(held);
        let sky_here = here.render(&state).await?;
        let mut skies = Vec::with_capacity(found.places.len());
        for place in &found.places {
            let request = question.sky_at(place.place);
            let key = skyglow_app::fingerprint::sky_key(&request, here.view.version(), state.source.facts())?;
            skies.push(state.sky(&key, request.into(), here.view.clone()).await?);
        }
        let assumptions = here.assumptions(&state, &sky_here);
        let named = state.source.places(&here.view);
        let at = (question.here.place, sky_here.as_ref());
        let answer = DarkerAnswer::new(assumptions, at, within_m, &found, &skies, &named);
        let warnings = answer.assumptions.warnings.clone();
        let step = |(name, time): &(&str, std::time::Duration)| {
            format!("{name};dur={:.3}", 1e3 * time.as_secs_f64())
        };
        let times = found.steps.iter().map(step).collect::<Vec<_>>().join(", ");
        Ok(EncodedAnswer { bytes: Bytes::from(json_bytes(&answer)?), warnings, times })
    };
    let made = state.answer(&caching.etag, make).await?;
    let mut response = made.response(&caching, "application/json");
    put_warnings(&mut response, &made.warnings);
    put_times(&mut response, &made.times);
    Ok(response)
}
