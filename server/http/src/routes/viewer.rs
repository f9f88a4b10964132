//! The viewer, built into the program.

use crate::{
    error::ApiError,
    etag::ETag,
    respond::{Caching, Keep},
};
use axum::{
    body::Body,
    http::{HeaderMap, HeaderValue, Response, Uri, header},
};
use rust_embed::{EmbeddedFile, RustEmbed};

/// The viewer's built form.
#[derive(RustEmbed)]
#[folder = "$CARGO_MANIFEST_DIR/../../web/dist"]
#[exclude = "SHA256SUMS"]
#[allow_missing = true]
struct Viewer;

/// Scripts, styles, workers and data come from this server alone; styles that the map sets on its elements and
/// pictures that it draws are its own.
const VIEWER_POLICY: &str = "default-src 'none'; script-src 'self'; worker-src 'self' blob:; style-src 'self'; \
     img-src 'self' data: blob:; connect-src 'self'; font-src 'self'; manifest-src 'self'; base-uri 'none'; \
     form-action 'none'; frame-ancestors 'self'";

/// What is served where the viewer was not built in.
const NO_VIEWER: &str = "<!doctype html>\n<html lang=\"en\"><meta charset=\"utf-8\"><title>Skyglow</title>\n\
     <h1>Skyglow</h1>\n<p>This program was built without the viewer: <code>web/dist</code> was missing.</p>\n\
     <p>The interface is all there: <a href=\"api/docs\">read and try it</a>.</p>\n</html>\n";

/// The viewer's files; everything that no other route takes. Pages are one: `/` alone.
pub async fn get_viewer(uri: Uri, headers: HeaderMap) -> Result<Response<Body>, ApiError> {
    let path = uri.path().trim_start_matches('/');
    if path.is_empty() || path == "index.html" {
        return Ok(index(&headers));
    }
    let file = Viewer::get(path).ok_or(ApiError::NotFound)?;
    // Vite puts what carries a hash in its name below assets/.
    let keep = if path.starts_with("assets/") { Keep::Forever } else { Keep::Revalidate };
    Ok(answer(&headers, keep, media_type(path), &file))
}

fn index(headers: &HeaderMap) -> Response<Body> {
    let mut response = match Viewer::get("index.html") {
        Some(file) => answer(headers, Keep::Revalidate, "text/html; charset=utf-8", &file),
        None => {
            let caching =
                Caching { etag: ETag::of_bytes(NO_VIEWER.as_bytes()), keep: Keep::Revalidate, vary: None };
            caching
                .not_modified(headers)
                .unwrap_or_else(|| caching.ok("text/html; charset=utf-8", NO_VIEWER.as_bytes().to_vec()))
        }
    };
    let policy = HeaderValue::from_static(VIEWER_POLICY);
    response.headers_mut().insert(header::CONTENT_SECURITY_POLICY, policy);
    response
}

fn answer(headers: &HeaderMap, keep: Keep, media_type: &'static str, file: &EmbeddedFile) -> Response<Body> {
    let hash: String = file.metadata.sha256_hash().iter().map(|byte| format!("{byte:02x}")).collect();
    let caching = Caching { etag: ETag::of(&["viewer", &hash]), keep, vary: None };
    caching.not_modified(headers).unwrap_or_else(|| caching.ok(media_type, file.data.to_vec()))
}

fn media_type(path: &str) -> &'static str {
    match path.rsplit_once('.').map(|(_, extension)| extension) {
        Some("html") => "text/html; charset=utf-8",
        Some("js" | "mjs") => "text/javascript; charset=utf-8",
        Some("css") => "text/css; charset=utf-8",
        Some("json" | "map") => "application/json",
        Some("svg") => "image/svg+xml",
        Some("png") => "image/png",
        Some("webp") => "image/webp",
        Some("ico") => "image/x-icon",
        Some("woff2") => "font/woff2",
        Some("txt") => "text/plain; charset=utf-8",
        _ => "application/octet-stream",
    }
}
