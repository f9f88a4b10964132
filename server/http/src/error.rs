//! What can go wrong with a request, and the one table of status codes.

use crate::problem::{PROBLEM_JSON, Problem};
use axum::{
    Json,
    http::{HeaderValue, StatusCode, header},
    response::{IntoResponse, Response},
};
use skyglow_app::{
    error::AppError,
    validation::{Refusal, ValidationCode},
};
use thiserror::Error;

/// Why a request is not answered as asked.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum ApiError {
    /// The program behind refuses it or fails.
    #[error(transparent)]
    App(#[from] AppError),
    /// No such path.
    #[error("there is nothing here; GET /api/docs lists what there is")]
    NotFound,
    /// The path exists for other methods.
    #[error("this path answers other methods; see the Allow header")]
    MethodNotAllowed,
    /// No format that the client accepts.
    #[error("this resource comes as {offered}")]
    NotAcceptable {
        /// Media types there are.
        offered: &'static str,
    },
    /// No such process of OGC API – Processes.
    #[error("the processes are influence and plan")]
    NoSuchProcess,
    /// No such job of OGC API – Processes.
    #[error("there is no such job; what came of one is kept for ten minutes, for one where it is long")]
    NoSuchJob,
    /// A job of OGC API – Processes that is not done.
    #[error("the job is not done; its status says how far it is")]
    ResultNotReady,
    /// The request's body is too long.
    #[error("the request's body is longer than {limit_bytes} bytes")]
    BodyTooLong {
        /// The limit.
        limit_bytes: usize,
    },
    /// Something else that HTTP itself refuses, with its status.
    #[error("{}", unreadable(*.0))]
    Unreadable(
        /// A status from 400 to 499.
        u16,
    ),
    /// A token or key that nobody has, or none where one is needed.
    #[error("this needs the token or key of somebody who may: Authorization: Bearer …")]
    Unauthorized,
    /// Nobody may: the server was started without an operator's token.
    #[error("this server takes no uploads: it was started without an operator's token")]
    UploadsOff,
    /// A known client that may not.
    #[error("only the operator may do this")]
    OperatorOnly,
    /// What known clients alone may.
    #[error("only clients with a key have things pinned")]
    KeysOnly,
    /// A page of another site would have something kept.
    #[error(
        "pages of other sites have nothing kept here; ask from this server's own page, or without a browser"
    )]
    ForeignOrigin,
    /// An address had its share of a day kept.
    #[error(
        "this address had its share of the day's scenarios and plans kept; there is more in {retry_after_s} s"
    )]
    StorageQuotaUsed {
        /// Seconds until there is some.
        retry_after_s: u64,
    },
    /// A known client's requests of a day are used up.
    #[error("this key's requests of the day are used up; there are more in {retry_after_s} s")]
    QuotaUsed {
        /// Seconds to the next day.
        retry_after_s: u64,
    },
    /// This client sends too much.
    #[error("this address sent more requests than it may; try again in {retry_after_s} s")]
    TooManyRequests {
        /// Seconds to wait.
        retry_after_s: u64,
    },
    /// A range of bytes that a body does not have.
    #[error("this has {length_bytes} bytes, and none of those asked for is among them")]
    RangeNotSatisfiable {
        /// Length of the body.
        length_bytes: usize,
    },
    /// What was asked for is being made, and goes on being made.
    #[error("this is being made and goes on: {:.0} % is done; ask again in {retry_after_s} s", 100.0 * progress)]
    BeingMade {
        /// The part that is done, 0 to 1.
        progress: f64,
        /// Seconds until it is worth asking again.
        retry_after_s: u64,
    },
    /// The answer took too long.
    #[error("the answer took longer than {limit_s} s")]
    Timeout {
        /// The limit, seconds.
        limit_s: f64,
    },
}

/// What OGC API – Processes 1.0 puts before the names of its kinds of problems.
const OGC_EXCEPTIONS: &str = "http://www.opengis.net/def/exceptions/ogcapi-processes-1/1.0";

/// Why HTTP itself refuses a request.
fn unreadable(status: u16) -> &'static str {
    match StatusCode::from_u16(status) {
        Ok(StatusCode::REQUEST_TIMEOUT) => "the request took too long to arrive",
        Ok(StatusCode::URI_TOO_LONG) => "the address asked for is longer than this server reads",
        Ok(StatusCode::REQUEST_HEADER_FIELDS_TOO_LARGE) => {
            "the request's headers are longer than this server reads"
        }
        _ => "the request cannot be read",
    }
}

/// Status code, stable name and title of a kind of problem.
type Row = (StatusCode, &'static str, &'static str);

impl ApiError {
    /// An internal error with its reason for the log.
    pub fn internal(reason: impl std::fmt::Display) -> Self {
        Self::App(AppError::internal(reason))
    }

    /// One bad parameter.
    pub fn parameter(
        name: &str,
        value: String,
        allowed: String,
        message: String,
        code: ValidationCode,
    ) -> Self {
        Self::App(AppError::parameter(name, value, allowed, message, code))
    }

    /// The table of status codes: the only place that knows them.
    pub fn row(&self) -> Row {
        match self {
            ApiError::App(error) => {
                let kind = error.kind();
                (status_of(error), kind.name, kind.title)
            }
            ApiError::NotFound => (StatusCode::NOT_FOUND, "not-found", "There is nothing here"),
            ApiError::NoSuchProcess => (StatusCode::NOT_FOUND, "no-such-process", "There is no such process"),
            ApiError::NoSuchJob => (StatusCode::NOT_FOUND, "no-such-job", "There is no such job"),
            ApiError::ResultNotReady => (StatusCode::NOT_FOUND, "result-not-ready", "The job is not done"),
            ApiError::MethodNotAllowed => {
                (StatusCode::METHOD_NOT_ALLOWED, "method-not-allowed", "This method is not allowed here")
            }
            ApiError::NotAcceptable { .. } => {
                (StatusCode::NOT_ACCEPTABLE, "not-acceptable", "None of the accepted formats is there")
            }
            ApiError::BodyTooLong { .. } => {
                (StatusCode::PAYLOAD_TOO_LARGE, "body-too-long", "The request's body is too long")
            }
            ApiError::RangeNotSatisfiable { .. } => {
                (StatusCode::RANGE_NOT_SATISFIABLE, "range-not-satisfiable", "There are no such bytes")
            }
            ApiError::Unreadable(status) => (
                StatusCode::from_u16(*status).unwrap_or(StatusCode::BAD_REQUEST),
                "unreadable",
                "The request cannot be read",
            ),
            ApiError::Unauthorized => (StatusCode::UNAUTHORIZED, "unauthorized", "A token or key is needed"),
            ApiError::UploadsOff => (StatusCode::FORBIDDEN, "uploads-off", "This server takes no uploads"),
            ApiError::OperatorOnly => {
                (StatusCode::FORBIDDEN, "operator-only", "Only the operator may do this")
            }
            ApiError::KeysOnly => (StatusCode::FORBIDDEN, "keys-only", "Only clients with a key may do this"),
            ApiError::QuotaUsed { .. } => {
                (StatusCode::TOO_MANY_REQUESTS, "quota-used", "The key's requests of the day are used up")
            }
            ApiError::ForeignOrigin => {
                (StatusCode::FORBIDDEN, "foreign-origin", "Pages of other sites keep nothing here")
            }
            ApiError::StorageQuotaUsed { .. } => {
                (StatusCode::TOO_MANY_REQUESTS, "kept-enough", "The address's share of the day is kept")
            }
            ApiError::TooManyRequests { .. } => {
                (StatusCode::TOO_MANY_REQUESTS, "too-many-requests", "Too many requests from this address")
            }
            ApiError::BeingMade { .. } => {
                (StatusCode::SERVICE_UNAVAILABLE, "being-made", "This is being made")
            }
            ApiError::Timeout { .. } => {
                (StatusCode::SERVICE_UNAVAILABLE, "timeout", "The answer took too long")
            }
        }
    }

    /// Seconds after which trying again makes sense.
    fn retry_after_s(&self) -> Option<u64> {
        match self {
            ApiError::TooManyRequests { retry_after_s }
            | ApiError::QuotaUsed { retry_after_s }
            | ApiError::StorageQuotaUsed { retry_after_s }
            | ApiError::BeingMade { retry_after_s, .. }
            | ApiError::App(
                AppError::Busy { retry_after_s } | AppError::SkylinesBeingFound { retry_after_s, .. },
            ) => Some((*retry_after_s).max(1)),
            ApiError::Timeout { .. } | ApiError::App(AppError::EngineDown) => Some(2),
            ApiError::App(
                AppError::Storage { .. }
                | AppError::StoreAway { .. }
                | AppError::AtlasAway { .. }
                | AppError::SceneTooLarge { .. },
            ) => Some(60),
            _ => None,
        }
    }

    /// The problem document.
    pub fn problem(&self) -> Problem {
        let (status, name, title) = self.row();
        let (detail, errors) = match self {
            ApiError::App(error) => (error.detail(), error.field_errors().to_vec()),
            other => (other.to_string(), Vec::new()),
        };
        let root = match self {
            // The standard has names of its own for these.
            ApiError::NoSuchProcess | ApiError::NoSuchJob | ApiError::ResultNotReady => OGC_EXCEPTIONS,
            _ => "/problems",
        };
        Problem {
            kind: format!("{root}/{name}"),
            title: title.to_owned(),
            status: status.as_u16(),
            detail,
            errors,
            bounds: match self {
                ApiError::App(error) => error.bounds(),
                _ => None,
            },
            progress: match self {
                ApiError::BeingMade { progress, .. }
                | ApiError::App(AppError::SkylinesBeingFound { progress, .. }) => Some(*progress),
                _ => None,
            },
        }
    }
}

fn status_of(error: &AppError) -> StatusCode {
    match error {
        AppError::Parameters(errors) => match Refusal::of(errors) {
            Refusal::UnknownParameter | Refusal::BadParameters => StatusCode::BAD_REQUEST,
            Refusal::NotResident | Refusal::OutOfRange => StatusCode::UNPROCESSABLE_ENTITY,
        },
        AppError::UnknownScene { .. }
        | AppError::UnknownScenario { .. }
        | AppError::OutsideScene { .. }
        | AppError::UnknownTile { .. } => StatusCode::NOT_FOUND,
        AppError::StalePlan { .. } | AppError::DraftPlan { .. } | AppError::PinsFull => StatusCode::CONFLICT,
        AppError::NotOwner { .. } => StatusCode::FORBIDDEN,
        AppError::BadUpload { .. } => StatusCode::UNPROCESSABLE_ENTITY,
        AppError::DamagedScene { .. }
        | AppError::Storage { .. }
        | AppError::StoreAway { .. }
        | AppError::AtlasAway { .. }
        | AppError::SceneTooLarge { .. }
        | AppError::SkylinesBeingFound { .. }
        | AppError::Busy { .. }
        | AppError::EngineDown => StatusCode::SERVICE_UNAVAILABLE,
        AppError::Internal { .. } => StatusCode::INTERNAL_SERVER_ERROR,
    }
}

/// Marks an answer that came for want of time: what was asked for may be done yet.
#[derive(Clone, Copy, Debug)]
pub(crate) struct TookTooLong;

impl IntoResponse for ApiError {
    fn into_response(self) -> Response {
        match &self {
            ApiError::App(AppError::Internal { reason }) => tracing::error!(%reason, "internal error"),
            ApiError::App(AppError::SceneTooLarge { reason }) => {
                tracing::error!(%reason, "a scene is too large")
            }
            ApiError::App(AppError::Storage { reason }) => tracing::error!(%reason, "nothing can be kept"),
            ApiError::App(AppError::StoreAway { reason }) => {
                tracing::error!(%reason, "the store of what is kept does not answer");
            }
            ApiError::App(AppError::AtlasAway { reason }) => {
                tracing::error!(%reason, "an atlas cannot be read")
            }
            _ => {}
        }
        let retry_after_s = self.retry_after_s();
        let problem = self.problem();
        let status = StatusCode::from_u16(problem.status).unwrap_or(StatusCode::INTERNAL_SERVER_ERROR);
        let mut response = (status, Json(problem)).into_response();
        let headers = response.headers_mut();
        headers.insert(header::CONTENT_TYPE, HeaderValue::from_static(PROBLEM_JSON));
        headers.insert(header::CACHE_CONTROL, HeaderValue::from_static("no-store"));
        if status == StatusCode::UNAUTHORIZED {
            headers.insert(header::WWW_AUTHENTICATE, HeaderValue::from_static("Bearer"));
        }
        if let Some(seconds) = retry_after_s {
            headers.insert(header::RETRY_AFTER, HeaderValue::from(seconds));
        }
        if matches!(self, ApiError::Timeout { .. }) {
            response.extensions_mut().insert(TookTooLong);
        }
        response
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use skyglow_app::validation::FieldError;

    fn mistake(code: ValidationCode) -> FieldError {
        FieldError {
            parameter: "p".into(),
            value: Some("v".into()),
            allowed: "a".into(),
            message: code.description().into(),
            code,
        }
    }

    /// The worst mistake decides the kind of the problem.
    #[test]
    fn the_worst_mistake_decides_the_problem() {
        let kind = |codes: &[ValidationCode]| {
            ApiError::App(AppError::Parameters(codes.iter().copied().map(mistake).collect())).problem().kind
        };
        assert_eq!(kind(&[ValidationCode::UnknownParameter]), "/problems/unknown-parameter");
        assert_eq!(
            kind(&[ValidationCode::UnknownParameter, ValidationCode::OutOfRange]),
            "/problems/bad-parameters"
        );
        assert_eq!(kind(&[ValidationCode::OutOfRange]), "/problems/out-of-range");
        assert_eq!(kind(&[ValidationCode::NotResident]), "/problems/not-resident");
        assert_eq!(
            kind(&[ValidationCode::NotResident, ValidationCode::OutOfRange]),
            "/problems/out-of-range"
        );
    }

    #[test]
    fn reasons_of_internal_errors_stay_in_the_log() {
        let problem = ApiError::internal("/secret/path is broken").problem();
        assert!(!problem.detail.contains("secret"));
        assert_eq!(problem.status, 500);
    }

    #[test]
    fn a_busy_server_says_when_to_try_again() {
        let response = ApiError::App(AppError::Busy { retry_after_s: 3 }).into_response();
        assert_eq!(response.status(), StatusCode::SERVICE_UNAVAILABLE);
        assert_eq!(response.headers()[header::RETRY_AFTER], "3");
        assert_eq!(response.headers()[header::CONTENT_TYPE], PROBLEM_JSON);
    }
}
