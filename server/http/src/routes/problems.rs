//! The kinds of problems, in words: where the `type` of a problem document leads.

use crate::{
    error::ApiError,
    problem::Problem,
    respond::{CachePolicy, bytes_by_content},
};
use axum::{
    body::Body,
    extract::Path,
    http::{HeaderMap, Response},
};

/// Stable names and what they mean.
pub const KINDS: [(&str, &str); 39] = [
    (
        "bad-parameters",
        "One or more parameters cannot be used; `errors` names each, its value and what is allowed.",
    ),
    ("unknown-parameter", "Parameters that do not exist here; `errors` lists those that do."),
    ("out-of-range", "Altitude or turbidity outside the resident tables; `errors` has the range."),
    ("not-resident", "The interface has it, but this server does not hold the tables for it."),
    ("unknown-scene", "No scene has this id."),
    (
        "damaged-scene",
        "The scene's files on the server's disk are damaged, and so it is left out; its operator can store it again.",
    ),
    ("unknown-scenario", "No scenario or plan has this id, or it was not kept so long."),
    ("stale-plan", "The plan names pixels of a raster that was replaced since; make it again."),
    (
        "draft-plan",
        "The plan was made with keep=off, and what is kept cannot go on from it; make it again with keep=on.",
    ),
    (
        "not-owner",
        "The scenario or plan is removed by whoever had it kept: with the same key, or with the secret that Skyglow-Owner of the answer had then.",
    ),
    ("keys-only", "What stays whatever others have kept is for clients with a key."),
    ("pins-full", "As much is pinned as may be, which is half of what is kept; it can be kept without."),
    ("storage", "The server has no room on disk, or may not write there; its log says more."),
    (
        "store-away",
        "The store that the servers of this service share does not answer; what it has is not lost. Retry-After says when to try again.",
    ),
    ("outside-scene", "The place lies outside the scene; `bounds` has its edges."),
    ("unknown-tile", "No map tile has this address."),
    ("not-found", "No resource has this path."),
    ("no-such-process", "No process of OGC API – Processes has this id."),
    ("no-such-job", "No job has this id, or what came of it was not kept so long."),
    ("result-not-ready", "The job goes on; its status says how far it is."),
    ("method-not-allowed", "The path answers other methods; the Allow header lists them."),
    ("not-acceptable", "The resource does not come in any of the formats accepted."),
    ("body-too-long", "The request's body is longer than this server takes."),
    (
        "range-not-satisfiable",
        "The answer has no byte of the range asked for; Content-Range says how long it is.",
    ),
    ("unreadable", "The request is not HTTP as this server reads it."),
    ("unauthorized", "The request carries a token or key that nobody has, or none where one is needed."),
    (
        "foreign-origin",
        "A browser asked for a page of another site. Scenarios and plans are kept for this server's own page, and for programs.",
    ),
    (
        "kept-enough",
        "What is kept of scenarios and plans has an end, so one address has a share of it for a day. Keys have quotas of their own.",
    ),
    ("scene-too-large", "The server has less memory than the scene takes: the detail says how much."),
    ("uploads-off", "The server was started without an operator's token: nobody may change its scenes."),
    ("operator-only", "A known client asks for what the operator alone may do."),
    ("bad-upload", "What was uploaded is no scene: the detail says why, and what was there before stays."),
    ("quota-used", "The key's requests of the day (UTC) are used up; Retry-After says when there are more."),
    ("too-many-requests", "This address sent more than its share; Retry-After says when to go on."),
    ("busy", "The server works on as much as it can; Retry-After says when to try again."),
    (
        "being-made",
        "What was asked for takes longer than one answer may; it goes on being made, and `progress` says how far it is. Ask again after Retry-After.",
    ),
    ("timeout", "The answer took longer than this server allows."),
    ("engine-down", "The engine is starting or its device is lost; Retry-After says when to try again."),
    ("internal", "A defect or a broken installation; the server's log says more."),
];

/// Explains a kind of problem.
#[utoipa::path(
    get,
    path = "/problems/{kind}",
    tag = "operation",
    params(("kind" = String, Path, description = "The last part of a problem's `type`")),
    responses(
        (status = 200, description = "What it means", body = String, content_type = "text/plain"),
        (status = 404, description = "No such kind", body = Problem, content_type = "application/problem+json"),
    )
)]
pub async fn get_problem(Path(kind): Path<String>, headers: HeaderMap) -> Result<Response<Body>, ApiError> {
    let (name, words) = KINDS.iter().find(|(name, _)| *name == kind).ok_or(ApiError::NotFound)?;
    let text = format!("{name}\n\n{words}\n");
    bytes_by_content(&headers, CachePolicy::Minutes, "text/plain; charset=utf-8", text.into_bytes())
}

#[cfg(test)]
mod tests {
    use super::*;
    use skyglow_app::error::AppError;
    use skyglow_app::validation::{FieldError, ValidationCode};

    /// Every kind that the table of status codes has is explained.
    #[test]
    fn every_kind_of_problem_is_explained() {
        let wrong = |code: ValidationCode| {
            ApiError::App(AppError::Parameters(vec![FieldError {
                parameter: String::new(),
                value: None,
                allowed: String::new(),
                message: String::new(),
                code,
            }]))
        };
        let errors = [
            wrong(ValidationCode::UnknownParameter),
            wrong(ValidationCode::Malformed),
            wrong(ValidationCode::OutOfRange),
            wrong(ValidationCode::NotResident),
            ApiError::App(AppError::DamagedScene { id: String::new() }),
            ApiError::App(AppError::UnknownScenario { id: String::new() }),
            ApiError::App(AppError::StalePlan { id: String::new() }),
            ApiError::App(AppError::DraftPlan { id: String::new() }),
            ApiError::App(AppError::NotOwner { id: String::new() }),
            ApiError::App(AppError::PinsFull),
            ApiError::KeysOnly,
            ApiError::Unauthorized,
            ApiError::UploadsOff,
            ApiError::ForeignOrigin,
            ApiError::StorageQuotaUsed { retry_after_s: 1 },
            ApiError::OperatorOnly,
            ApiError::App(AppError::BadUpload { reason: String::new() }),
            ApiError::QuotaUsed { retry_after_s: 1 },
            ApiError::App(AppError::Storage { reason: String::new() }),
            ApiError::App(AppError::StoreAway { reason: String::new() }),
            ApiError::App(AppError::UnknownScene { id: String::new() }),
            ApiError::App(AppError::OutsideScene { latitude_deg: 0.0, longitude_deg: 0.0, bounds: [0.0; 4] }),
            ApiError::App(AppError::UnknownTile { reason: String::new() }),
            ApiError::NotFound,
            ApiError::NoSuchProcess,
            ApiError::NoSuchJob,
            ApiError::ResultNotReady,
            ApiError::MethodNotAllowed,
            ApiError::NotAcceptable { offered: "" },
            ApiError::BodyTooLong { limit_bytes: 1 },
            ApiError::RangeNotSatisfiable { length_bytes: 1 },
            ApiError::Unreadable(400),
            ApiError::TooManyRequests { retry_after_s: 1 },
            ApiError::App(AppError::Busy { retry_after_s: 1 }),
            ApiError::BeingMade { progress: 0.5, retry_after_s: 1 },
            ApiError::Timeout { limit_s: 1.0 },
            ApiError::App(AppError::EngineDown),
            ApiError::App(AppError::SceneTooLarge { reason: String::new() }),
            ApiError::internal(""),
        ];
        let mut kinds: Vec<&str> = errors.iter().map(|error| error.row().1).collect();
        let mut explained: Vec<&str> = KINDS.iter().map(|(name, _)| *name).collect();
        kinds.sort_unstable();
        explained.sort_unstable();
        assert_eq!(kinds, explained);
    }
}
