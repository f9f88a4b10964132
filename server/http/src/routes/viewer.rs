//! The viewer, built into the program. Its files are compressed once and well, not for each request and fast.

use crate::{
    error::ApiError,
    etag::ETag,
    respond::{CachePolicy, Caching, Counted},
};
use axum::{
    body::{Body, Bytes},
    http::{HeaderMap, HeaderValue, Response, Uri, header},
};
use brotli::enc::BrotliEncoderParams;
use rust_embed::{EmbeddedFile, RustEmbed};
use std::{
    borrow::Cow,
    collections::HashMap,
    sync::{Mutex, OnceLock, PoisonError},
};

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
/// The same for the view that other sites may show inside their pages. It has nothing to press but a link.
const EMBED_POLICY: &str = "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self'; \
     connect-src 'self'; base-uri 'none'; form-action 'none'; frame-ancestors *";

/// What is served where the viewer was not built in.
const NO_VIEWER: &str = "<!doctype html>\n<html lang=\"en\"><meta charset=\"utf-8\"><title>Skyglow</title>\n\
     <h1>Skyglow</h1>\n<p>This program was built without the viewer: <code>web/dist</code> was missing.</p>\n\
     <p>The interface is all there: <a href=\"api/docs\">read and try it</a>.</p>\n</html>\n";

/// The page.
const INDEX: &str = "index.html";
/// The page for other sites' frames.
const EMBED: &str = "embed.html";
/// Of brotli, 0 to 11. 11 makes files 8 % shorter and takes ten times as long.
const QUALITY: i32 = 9;
/// Shorter files are sent as they are.
const MIN_COMPRESSED_BYTES: usize = 512;

/// Files as they are sent to who takes brotli, by path; none where that is no shorter.
static COMPRESSED: OnceLock<Mutex<HashMap<String, Option<Bytes>>>> = OnceLock::new();

/// Compresses every file of the viewer, so that nobody waits for it. Takes about a second.
pub fn compress_viewer() {
    for path in Viewer::iter() {
        if let Some(file) = Viewer::get(&path) {
            compressed(&path, &file.data);
        }
    }
}

fn compressed(path: &str, data: &[u8]) -> Option<Bytes> {
    let files = COMPRESSED.get_or_init(Mutex::default);
    if let Some(known) = files.lock().unwrap_or_else(PoisonError::into_inner).get(path) {
        return known.clone();
    }
    // Two who ask at once compress it twice: no lock is held meanwhile.
    let made = brotli_of(data).map(Bytes::from);
    files.lock().unwrap_or_else(PoisonError::into_inner).insert(path.to_owned(), made.clone());
    made
}

fn brotli_of(data: &[u8]) -> Option<Vec<u8>> {
    if data.len() < MIN_COMPRESSED_BYTES {
        return None;
    }
    let parameters = BrotliEncoderParams { quality: QUALITY, size_hint: data.len(), ..Default::default() };
    let mut made = Vec::with_capacity(data.len() / 3);
    brotli::BrotliCompress(&mut &*data, &mut made, &parameters).ok()?;
    (made.len() < data.len()).then_some(made)
}

/// Whether the client takes brotli.
fn takes_brotli(headers: &HeaderMap) -> bool {
    let values = headers.get_all(header::ACCEPT_ENCODING).into_iter().filter_map(|value| value.to_str().ok());
    values.flat_map(|value| value.split(',')).any(|coding| {
        let (name, quality) = coding.split_once(';').unwrap_or((coding, ""));
        let refused = quality.split_once('=').is_some_and(|(_, q)| q.trim().parse() == Ok(0.0));
        name.trim().eq_ignore_ascii_case("br") && !refused
    })
}

/// A compact view of one place, which other sites may show in a frame; no other page may be.
pub async fn get_embed(headers: HeaderMap) -> Result<Response<Body>, ApiError> {
    page(&headers, EMBED, EMBED_POLICY)
}

/// The viewer's files; everything that no other route takes. Pages are one: `/` alone.
pub async fn get_viewer(uri: Uri, headers: HeaderMap) -> Result<Response<Body>, ApiError> {
    let path = uri.path().trim_start_matches('/');
    if path.is_empty() || path == INDEX {
        return page(&headers, INDEX, VIEWER_POLICY);
    }
    let file = Viewer::get(path).ok_or(ApiError::NotFound)?;
    // Vite puts what carries a hash in its name below assets/.
    let policy = if path.starts_with("assets/") { CachePolicy::Forever } else { CachePolicy::Revalidate };
    answer(&headers, policy, path, &file)
}

fn page(headers: &HeaderMap, path: &str, policy: &'static str) -> Result<Response<Body>, ApiError> {
    let mut response = match Viewer::get(path) {
        Some(file) => answer(headers, CachePolicy::Revalidate, path, &file)?,
        None => {
            let caching = Caching {
                etag: ETag::of_bytes(NO_VIEWER.as_bytes()),
                policy: CachePolicy::Revalidate,
                vary: None,
            };
            caching
                .not_modified(headers)
                .unwrap_or_else(|| caching.ok("text/html; charset=utf-8", NO_VIEWER.as_bytes().to_vec()))
        }
    };
    let policy = HeaderValue::from_static(policy);
    response.headers_mut().insert(header::CONTENT_SECURITY_POLICY, policy);
    Ok(response)
}

fn answer(
    headers: &HeaderMap,
    policy: CachePolicy,
    path: &str,
    file: &EmbeddedFile,
) -> Result<Response<Body>, ApiError> {
    let hash: String = file.metadata.sha256_hash().iter().map(|byte| format!("{byte:02x}")).collect();
    let caching = Caching { etag: ETag::of(&("viewer", &hash))?, policy, vary: None };
    if let Some(response) = caching.not_modified(headers) {
        return Ok(response);
    }
    let Some(short) = takes_brotli(headers).then(|| compressed(path, &file.data)).flatten() else {
        let data = match &file.data {
            Cow::Borrowed(data) => Bytes::from_static(data),
            Cow::Owned(data) => Bytes::from(data.clone()),
        };
        return Ok(counted(caching.ok(media_type(path), data)));
    };
    let mut response = counted(caching.ok(media_type(path), short));
    response.headers_mut().insert(header::CONTENT_ENCODING, HeaderValue::from_static("br"));
    Ok(response)
}

/// Files of the program take no memory of their own.
fn counted(mut response: Response<Body>) -> Response<Body> {
    response.extensions_mut().insert(Counted);
    response
}

fn media_type(path: &str) -> &'static str {
    match path.rsplit_once('.').map(|(_, extension)| extension) {
        Some("html") => "text/html; charset=utf-8",
        Some("js" | "mjs") => "text/javascript; charset=utf-8",
        Some("css") => "text/css; charset=utf-8",
        Some("json" | "map") => "application/json",
        Some("webmanifest") => "application/manifest+json",
        Some("svg") => "image/svg+xml",
        Some("png") => "image/png",
        Some("webp") => "image/webp",
        Some("ico") => "image/x-icon",
        Some("woff2") => "font/woff2",
        Some("txt") => "text/plain; charset=utf-8",
        _ => "application/octet-stream",
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn brotli_is_for_those_who_take_it() {
        let takes = |value: &'static str| {
            let mut headers = HeaderMap::new();
            headers.insert(header::ACCEPT_ENCODING, HeaderValue::from_static(value));
            takes_brotli(&headers)
        };
        assert!(takes("gzip, deflate, br, zstd") && takes("BR;q=0.5") && takes("br"));
        assert!(!takes("gzip") && !takes("br;q=0") && !takes("br;q=0.0, gzip") && !takes("brotli"));
        assert!(!takes_brotli(&HeaderMap::new()));
    }

    /// Files are compressed where that is shorter and come out again.
    #[test]
    fn files_are_compressed_where_that_is_shorter() {
        let text = "light ".repeat(1000);
        let made = brotli_of(text.as_bytes()).unwrap();
        assert!(made.len() < 200);
        let mut back = Vec::new();
        brotli::BrotliDecompress(&mut &*made, &mut back).unwrap();
        assert_eq!(back, text.as_bytes());
        assert_eq!(brotli_of(b"short"), None);
    }
}
