//! Whose light a sky is, by named places and by areas.

use super::{influence::PreparedInfluence, sky::put_warnings};
use crate::{
    asker::Work,
    error::ApiError,
    etag::ETag,
    problem::Problem,
    refusals::{Accepted, BodyTooLong, OfSky},
    respond::{CachePolicy, Caching},
    state::{AppState, EncodedAnswer, influence_bytes},
    work_places::Lane,
};
use axum::{
    body::{Body, Bytes},
    extract::{Path, RawQuery, State},
    http::{HeaderMap, Response},
};
use skyglow_app::{
    answers::{AreaSharesAnswer, Assumptions, SharesAnswer},
    parameters::{AreaSharesParameters, SharesParameters},
    request::{area_shares, scene_id, shares},
    shares_file::{SharesFormat, SharesQuestion},
    source::SkySource,
};

macro_rules! formats {
    ($($get:ident, $post:ident, $end:literal, $format:expr, $of_places:ident, $of_areas:ident, $media_type:literal, $doc:literal;)*) => {$(
        #[doc = concat!("Whose artificial light the sky of a place is, by the scene's named places", $doc)]
        ///
        /// A light belongs to the place that is nearest in units of the place's own radius, which grows with its inhabitants.
        #[utoipa::path(
            get,
            path = concat!("/api/v1/scenes/{scene}/shares", $end),
            tag = "influence",
            params(("scene" = String, Path, description = "The scene's id"), SharesParameters),
            responses(
                (status = 200, description = "The shares, the largest first", body = $of_places, content_type = $media_type, headers(
                    ("skyglow-warnings" = String, description = "What the sky had to do without, where anything: the same as `warnings` in JSON"),
                )),
                (status = 304, description = "The client has this answer already; nothing was computed"),
                OfSky,
            )
        )]
        pub async fn $get(
            State(state): State<AppState>,
            Path(scene): Path<String>,
            RawQuery(query): RawQuery,
            headers: HeaderMap,
        ) -> Result<Response<Body>, ApiError> {
            let request = shares(query.as_deref(), scene_id(&scene)?, state.source.facts())?;
            answer(state, SharesQuestion::Places(request), None, &headers, $format).await
        }

        #[doc = concat!("Whose artificial light the sky of a place is, by areas with names", $doc)]
        ///
        /// The body is a GeoJSON FeatureCollection of Polygons and MultiPolygons, such as municipalities. Every feature gets its
        /// share under its own name.
        #[utoipa::path(
            post,
            path = concat!("/api/v1/scenes/{scene}/shares", $end),
            tag = "influence",
            params(("scene" = String, Path, description = "The scene's id"), AreaSharesParameters),
            request_body(content = Object, description = "A GeoJSON FeatureCollection", content_type = "application/json"),
            responses(
                (status = 200, description = "The shares, the largest first", body = $of_areas, content_type = $media_type, headers(
                    ("skyglow-warnings" = String, description = "What the sky had to do without, where anything: the same as `warnings` in JSON"),
                )),
                OfSky,
                BodyTooLong,
                Accepted,
                (status = 400, description = "Bad parameters, or a body that cannot be meant", body = Problem, content_type = "application/problem+json"),
            )
        )]
        pub async fn $post(
            State(state): State<AppState>,
            Path(scene): Path<String>,
            RawQuery(query): RawQuery,
            headers: HeaderMap,
            body: Bytes,
        ) -> Result<Response<Body>, ApiError> {
            let (id, tag) = (scene_id(&scene)?, ETag::of_bytes(&body).header());
            let posted = Posted { query: query.clone(), tag, areas: body.clone() };
            // A body may be megabytes.
            let read = move |source: &dyn SkySource| Ok(area_shares(query.as_deref(), &body, id, source.facts())?);
            let request = state.blocking(read).await?;
            answer(state, SharesQuestion::Areas(request), Some(posted), &headers, $format).await
        }
    )*};
}

formats! {
    get_shares, post_shares, "", SharesFormat::Json, SharesAnswer, AreaSharesAnswer, "application/json", ".";
    get_shares_csv, post_shares_csv, ".csv", SharesFormat::Csv, String, String, "text/csv",
        ", as a table whose shares add up to 1.";
    get_shares_parquet, post_shares_parquet, ".parquet", SharesFormat::Parquet, String, String,
        "application/vnd.apache.parquet", ", as a table in Parquet, as the CSV's.";
    get_shares_geojson, post_shares_geojson, ".geojson", SharesFormat::GeoJson, Object, Object, "application/geo+json",
        ", as GeoJSON: places are points, areas come as they were posted, with their own properties, the largest share first. \
         Beside the features stand the sums of what is in none of them, and the assumptions.";
}

/// What came with a post.
struct Posted {
    query: Option<String>,
    /// The tag of its body.
    tag: String,
    /// The body.
    areas: Bytes,
}

async fn answer(
    state: AppState,
    question: SharesQuestion,
    posted: Option<Posted>,
    headers: &HeaderMap,
    format: SharesFormat,
) -> Result<Response<Body>, ApiError> {
    let (request, limit) = match &question {
        SharesQuestion::Places(places) => (&places.request, Some(places.limit)),
        SharesQuestion::Areas(areas) => (&areas.request, None),
    };
    let request = request.clone();
    let prepared = PreparedInfluence::prepare(&state, request.clone()).await?;
    if let SharesQuestion::Areas(areas) = &question {
        areas.check_within(prepared.view().metadata().bounds)?;
    }
    let is_get = posted.is_none();
    let body = posted.as_ref().map(|posted| (&posted.query, &posted.tag));
    let etag = ETag::of(&("shares", &prepared.key, format.media_type(), limit, body))?;
    let caching = Caching { etag, policy: CachePolicy::Minutes, vary: None };
    if is_get && let Some(response) = caching.not_modified(headers) {
        return Ok(response);
    }
    let make = async {
        let map = prepared.find(&state).await?;
        let assumptions = Assumptions::of_influences(&request, &map, state.source.facts());
        let add_up = move |_: &dyn SkySource, work: &Work| {
            let outcome = question.answer(assumptions, &map, &|done| work.note(done))?;
            let areas = posted.map(|posted| posted.areas).unwrap_or_default();
            let bytes = outcome.encode(format, &areas).map_err(ApiError::internal)?;
            Ok((bytes, outcome.assumptions().warnings.clone()))
        };
        let bytes = influence_bytes(prepared.view().max_lit_pixels_around(request.sky.place));
        let ((made, warnings), held) = state.work.long(Lane::Influence, bytes, add_up).await?;
        Ok(EncodedAnswer { bytes: state.work.keep(made, held), warnings, ..EncodedAnswer::default() })
    };
    let made = state.answer(&caching.etag, make).await?;
    let mut response = made.response(&caching, format.media_type());
    put_warnings(&mut response, &made.warnings);
    Ok(response)
}
