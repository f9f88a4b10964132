//! Answers with their caching headers.

use crate::{error::ApiError, etag::ETag, state::EncodedAnswer};
use axum::{
    body::Body,
    http::{HeaderMap, HeaderValue, Response, StatusCode, header},
};
use serde::Serialize;

/// How long caches may store an answer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CachePolicy {
    /// Asked about each time; the ETag makes that cheap.
    Revalidate,
    /// The same for what is for one client alone.
    Private,
    /// For some minutes: made from a scene that may be ingested again.
    Minutes,
    /// For ever: its URL carries a hash of it.
    Forever,
}

impl CachePolicy {
    const fn cache_control(self) -> &'static str {
        match self {
            CachePolicy::Revalidate => "public, no-cache",
            CachePolicy::Private => "private, no-cache",
            CachePolicy::Minutes => "public, max-age=300",
            CachePolicy::Forever => "public, max-age=31536000, immutable",
        }
    }
}

/// Headers of an answer that a client may keep.
#[derive(Clone, Debug)]
pub struct Caching {
    /// Its tag.
    pub etag: ETag,
    /// For how long.
    pub policy: CachePolicy,
    /// Request headers that it depends on, besides the encodings accepted.
    pub vary: Option<&'static str>,
}

impl Caching {
    /// 304 if the client has this answer already.
    pub fn not_modified(&self, request: &HeaderMap) -> Option<Response<Body>> {
        let tag = self.etag.matched(request)?;
        let mut response = Response::new(Body::empty());
        *response.status_mut() = StatusCode::NOT_MODIFIED;
        self.put(response.headers_mut(), &tag);
        Some(response)
    }

    /// 200 with a body.
    pub fn ok(&self, media_type: &'static str, body: impl Into<Body>) -> Response<Body> {
        let mut response = Response::new(body.into());
        let headers = response.headers_mut();
        headers.insert(header::CONTENT_TYPE, HeaderValue::from_static(media_type));
        self.put(headers, &self.etag.header());
        response
    }

    /// 200 with JSON.
    ///
    /// # Errors
    /// [`AppError::Internal`](skyglow_app::AppError::Internal) for what is no JSON.
    pub fn json(&self, value: &impl Serialize) -> Result<Response<Body>, ApiError> {
        Ok(self.ok("application/json", json_bytes(value)?))
    }

    fn put(&self, headers: &mut HeaderMap, tag: &str) {
        if let Ok(tag) = HeaderValue::from_str(tag) {
            headers.insert(header::ETAG, tag);
        }
        headers.insert(header::CACHE_CONTROL, HeaderValue::from_static(self.policy.cache_control()));
        // The compression adds this to what it compresses; caches must know for the other answers too.
        let vary = match self.vary {
            None => "accept-encoding",
            Some("accept") => "accept, accept-encoding",
            Some(other) => other,
        };
        headers.insert(header::VARY, HeaderValue::from_static(vary));
    }
}

/// Marks an answer whose bytes count in the memory for work for as long as anybody has them.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Counted;

impl EncodedAnswer {
    /// 200 with it.
    pub(crate) fn response(&self, caching: &Caching, media_type: &'static str) -> Response<Body> {
        let mut response = caching.ok(media_type, self.bytes.clone());
        response.extensions_mut().insert(Counted);
        response
    }
}

/// A value as JSON.
///
/// # Errors
/// [`AppError::Internal`](skyglow_app::AppError::Internal) for what is no JSON.
pub fn json_bytes(value: &impl Serialize) -> Result<Vec<u8>, ApiError> {
    serde_json::to_vec(value).map_err(ApiError::internal)
}

/// 200 with JSON that nobody keeps.
///
/// # Errors
/// [`AppError::Internal`](skyglow_app::AppError::Internal) for what is no JSON.
pub fn uncached(value: &impl Serialize) -> Result<Response<Body>, ApiError> {
    let mut response = Response::new(Body::from(json_bytes(value)?));
    let headers = response.headers_mut();
    headers.insert(header::CONTENT_TYPE, HeaderValue::from_static("application/json"));
    headers.insert(header::CACHE_CONTROL, HeaderValue::from_static("no-store"));
    Ok(response)
}

/// 201 with JSON and the address of what was made.
///
/// # Errors
/// [`AppError::Internal`](skyglow_app::AppError::Internal) for what is no JSON.
pub fn created(location: &str, value: &impl Serialize) -> Result<Response<Body>, ApiError> {
    let mut response = uncached(value)?;
    *response.status_mut() = StatusCode::CREATED;
    let headers = response.headers_mut();
    headers.insert(header::LOCATION, HeaderValue::from_str(location).map_err(ApiError::internal)?);
    Ok(response)
}

/// JSON whose tag is that of its bytes: for answers that cost nothing to make.
///
/// # Errors
/// [`AppError::Internal`](skyglow_app::AppError::Internal) for what is no JSON.
pub fn json_by_content(
    request: &HeaderMap,
    policy: CachePolicy,
    value: &impl Serialize,
) -> Result<Response<Body>, ApiError> {
    bytes_by_content(request, policy, "application/json", json_bytes(value)?)
}

/// Bytes whose tag is their own hash.
///
/// # Errors
/// None today.
pub fn bytes_by_content(
    request: &HeaderMap,
    policy: CachePolicy,
    media_type: &'static str,
    body: Vec<u8>,
) -> Result<Response<Body>, ApiError> {
    let caching = Caching { etag: ETag::of_bytes(&body), policy, vary: None };
    Ok(caching.not_modified(request).unwrap_or_else(|| caching.ok(media_type, body)))
}
