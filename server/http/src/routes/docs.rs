//! The OpenAPI document, and a page to read and try it that needs no other host.

use crate::{
    error::ApiError,
    refusals::BadParameters,
    respond::{CachePolicy, bytes_by_content},
    state::AppState,
    trust::PublicAddress,
};
use axum::{
    Extension,
    body::Body,
    extract::{RawQuery, State},
    http::{HeaderMap, HeaderValue, Response, header},
};
use skyglow_app::request::no_parameters;

/// The page may load what lies beside it and ask this server, nothing else.
const PAGE_POLICY: &str = "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' blob:; \
     connect-src 'self'; base-uri 'none'; form-action 'none'; frame-ancestors 'none'";

/// The document's servers where nobody said how clients reach this one.
const SERVERS: &str = "\"servers\":[{\"url\":\"/\"}]";

/// The OpenAPI document.
#[utoipa::path(
    get,
    path = "/api/v1/openapi.json",
    tag = "operation",
    responses((status = 200, description = "The contract (OpenAPI 3.1)", body = Object))
)]
pub async fn get_openapi(
    State(state): State<AppState>,
    Extension(address): Extension<PublicAddress>,
    RawQuery(query): RawQuery,
    headers: HeaderMap,
) -> Result<Response<Body>, ApiError> {
    no_parameters(query.as_deref())?;
    let document = state.openapi.get().ok_or_else(|| ApiError::internal("no OpenAPI document"))?;
    let url = serde_json::to_string(&address.server_url()).map_err(ApiError::internal)?;
    let document = document.replacen(SERVERS, &format!("\"servers\":[{{\"url\":{url}}}]"), 1);
    bytes_by_content(&headers, CachePolicy::Revalidate, "application/json", document.into_bytes())
}

fn page(
    headers: &HeaderMap,
    media_type: &'static str,
    text: &'static str,
) -> Result<Response<Body>, ApiError> {
    let mut response =
        bytes_by_content(headers, CachePolicy::Revalidate, media_type, text.as_bytes().to_vec())?;
    response.headers_mut().insert(header::CONTENT_SECURITY_POLICY, HeaderValue::from_static(PAGE_POLICY));
    Ok(response)
}

/// A page to read and try the interface.
#[utoipa::path(
    get,
    path = "/api/docs",
    tag = "operation",
    responses(
        (status = 200, description = "The page", body = String, content_type = "text/html"),
        BadParameters,
    )
)]
pub async fn get_docs(RawQuery(query): RawQuery, headers: HeaderMap) -> Result<Response<Body>, ApiError> {
    no_parameters(query.as_deref())?;
    page(&headers, "text/html; charset=utf-8", include_str!("../docs_page/page.html"))
}

/// The page's script.
pub async fn get_docs_script(headers: HeaderMap) -> Result<Response<Body>, ApiError> {
    page(&headers, "text/javascript; charset=utf-8", include_str!("../docs_page/page.js"))
}

/// The page's style.
pub async fn get_docs_style(headers: HeaderMap) -> Result<Response<Body>, ApiError> {
    page(&headers, "text/css; charset=utf-8", include_str!("../docs_page/page.css"))
}
