//! Strong ETags, known before anything is rendered.

use crate::error::ApiError;
use axum::http::{HeaderMap, header};
use serde::Serialize;
use skyglow_app::fingerprint::fingerprint;

/// A strong ETag without its quotes.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ETag(String);

/// Ends that the compression adds to a tag: another encoding is another representation.
const ENCODINGS: [&str; 4] = ["gzip", "br", "zstd", "deflate"];

impl ETag {
    /// The tag of everything that decides an answer's bytes. The program itself is added.
    ///
    /// # Errors
    /// [`AppError::Internal`](skyglow_app::AppError::Internal) for what is no JSON, only by a defect.
    pub fn of(parts: &impl Serialize) -> Result<Self, ApiError> {
        Ok(Self(fingerprint(parts)?))
    }

    /// The tag of bytes that are there already.
    pub fn of_bytes(bytes: &[u8]) -> Self {
        Self(blake3::hash(bytes).to_hex()[..32].to_owned())
    }

    /// The header's value.
    pub fn header(&self) -> String {
        format!("\"{}\"", self.0)
    }

    /// The tag as it stands in `If-None-Match` if that matches (weak comparison, RFC 9110), with the encoding
    /// it came with; None if the client must be sent the answer.
    pub fn matched(&self, headers: &HeaderMap) -> Option<String> {
        for value in headers.get_all(header::IF_NONE_MATCH) {
            for candidate in value.to_str().ok()?.split(',') {
                let candidate = candidate.trim();
                if candidate == "*" {
                    return Some(self.header());
                }
                let opaque = candidate.strip_prefix("W/").unwrap_or(candidate);
                let Some(opaque) = opaque.strip_prefix('"').and_then(|rest| rest.strip_suffix('"')) else {
                    continue;
                };
                let plain = ENCODINGS
                    .iter()
                    .find_map(|encoding| opaque.strip_suffix(encoding)?.strip_suffix('-'))
                    .unwrap_or(opaque);
                if plain == self.0 {
                    return Some(format!("\"{opaque}\""));
                }
            }
        }
        None
    }

    /// The header's value for a body in another encoding.
    pub fn with_encoding(header: &str, encoding: &str) -> Option<String> {
        Some(format!("{}-{encoding}\"", header.strip_suffix('"')?))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use axum::http::HeaderValue;

    fn asks(value: &str) -> HeaderMap {
        HeaderMap::from_iter([(header::IF_NONE_MATCH, HeaderValue::from_str(value).unwrap())])
    }

    /// In a list, in any encoding, and as a star.
    #[test]
    fn a_tag_matches_itself_in_any_encoding() {
        let tag = ETag::of(&("sky", "demo")).unwrap();
        let plain = tag.header();
        assert_eq!(tag.matched(&asks(&plain)), Some(plain.clone()));
        assert_eq!(tag.matched(&asks(&format!("\"x\", W/{plain}"))), Some(plain.clone()));
        let zipped = ETag::with_encoding(&plain, "gzip").unwrap();
        assert_eq!(tag.matched(&asks(&zipped)), Some(zipped.clone()));
        assert_eq!(tag.matched(&asks("*")), Some(plain));
        assert_eq!(tag.matched(&asks("\"other\"")), None);
        assert_eq!(tag.matched(&HeaderMap::new()), None);
    }
}
