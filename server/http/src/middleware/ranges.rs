//! Range requests (RFC 9110, section 14): a part of an answer that has a strong ETag and is sent as it is, not compressed.
//!
//! Several ranges at once are answered with the whole, as the standard allows: no multipart bodies are made.

use crate::error::ApiError;
use axum::{
    body::{Body, HttpBody, to_bytes},
    extract::Request,
    http::{HeaderMap, HeaderName, HeaderValue, Method, StatusCode, header},
    middleware::Next,
    response::{IntoResponse, Response},
};

/// What a `Range` header asks of a body.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Wanted {
    /// The whole: there is no such header, or it is none that must be understood.
    Whole,
    /// Bytes from the first to the last.
    Part(usize, usize),
    /// Bytes that are not there.
    Nothing,
}

/// Answers requests for a part of an answer with it (206), and says of answers that parts can be had.
///
/// The whole answer is made for it, and comes from the cache of answers when the next part is asked for.
pub async fn answer_ranges(request: Request, next: Next) -> Response {
    // Ranges are defined for GET alone.
    let is_get = request.method() == Method::GET;
    let range = text_of(request.headers(), &header::RANGE).filter(|_| is_get);
    let if_range = text_of(request.headers(), &header::IF_RANGE);
    let mut response = next.run(request).await;
    let Some(tag) = tag_of_parts(&response) else { return response };
    response.headers_mut().insert(header::ACCEPT_RANGES, HeaderValue::from_static("bytes"));
    // No answer has a date of change, so a date matches none.
    if if_range.is_some_and(|known| known != tag) {
        return response;
    }
    let length = response.body().size_hint().exact().and_then(|length| usize::try_from(length).ok());
    let (Some(range), Some(length)) = (range, length) else { return response };
    match wanted(&range, length) {
        Wanted::Whole => response,
        Wanted::Part(first, last) => part(response, first, last, length).await,
        Wanted::Nothing => {
            let mut refused = ApiError::RangeNotSatisfiable { length_bytes: length }.into_response();
            put_content_range(refused.headers_mut(), format!("bytes */{length}"));
            refused
        }
    }
}

fn text_of(headers: &HeaderMap, name: &HeaderName) -> Option<String> {
    headers.get(name)?.to_str().ok().map(str::to_owned)
}

/// The ETag of an answer whose parts can be had.
fn tag_of_parts(response: &Response) -> Option<String> {
    let headers = response.headers();
    let tag = headers.get(header::ETAG)?.to_str().ok()?;
    let has_parts = response.status() == StatusCode::OK
        && !tag.starts_with("W/")
        && !headers.contains_key(header::CONTENT_ENCODING);
    has_parts.then(|| tag.to_owned())
}

fn wanted(range: &str, length: usize) -> Wanted {
    let Some((unit, set)) = range.split_once('=') else { return Wanted::Whole };
    let Some((first, last)) = set.trim().split_once('-') else { return Wanted::Whole };
    if !unit.trim().eq_ignore_ascii_case("bytes") || set.contains(',') {
        return Wanted::Whole;
    }
    // Numbers too large to count are beyond every end.
    let number = |text: &str| {
        let is_number = !text.is_empty() && text.bytes().all(|byte| byte.is_ascii_digit());
        is_number.then(|| text.parse::<usize>().unwrap_or(usize::MAX))
    };
    match (number(first), number(last)) {
        (Some(first), None) if last.is_empty() => clipped(first, usize::MAX, length),
        (Some(first), Some(last)) if first <= last => clipped(first, last, length),
        // The last so many bytes.
        (None, Some(count)) if first.is_empty() && count > 0 => {
            clipped(length.saturating_sub(count), usize::MAX, length)
        }
        (None, Some(0)) if first.is_empty() => Wanted::Nothing,
        _ => Wanted::Whole,
    }
}

fn clipped(first: usize, last: usize, length: usize) -> Wanted {
    if first < length { Wanted::Part(first, last.min(length - 1)) } else { Wanted::Nothing }
}

async fn part(response: Response, first: usize, last: usize, length: usize) -> Response {
    let (mut parts, body) = response.into_parts();
    let bytes = match to_bytes(body, length).await {
        Ok(bytes) if bytes.len() == length => bytes.slice(first..=last),
        _ => return ApiError::internal("a body of another length than it says").into_response(),
    };
    parts.status = StatusCode::PARTIAL_CONTENT;
    parts.headers.insert(header::CONTENT_LENGTH, HeaderValue::from(bytes.len()));
    put_content_range(&mut parts.headers, format!("bytes {first}-{last}/{length}"));
    Response::from_parts(parts, Body::from(bytes))
}

fn put_content_range(headers: &mut HeaderMap, value: String) {
    if let Ok(value) = HeaderValue::from_str(&value) {
        headers.insert(header::CONTENT_RANGE, value);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ranges_are_read_as_the_standard_says() {
        for (range, part) in [
            ("bytes=0-0", Wanted::Part(0, 0)),
            ("bytes=2-4", Wanted::Part(2, 4)),
            ("bytes=2-", Wanted::Part(2, 9)),
            ("bytes=2-99999999999999999999999", Wanted::Part(2, 9)),
            ("bytes=-3", Wanted::Part(7, 9)),
            ("bytes=-30", Wanted::Part(0, 9)),
            ("Bytes=9-9", Wanted::Part(9, 9)),
            ("bytes=10-", Wanted::Nothing),
            ("bytes=10-11", Wanted::Nothing),
            ("bytes=-0", Wanted::Nothing),
            ("bytes=99999999999999999999999-", Wanted::Nothing),
            ("bytes=0-1,4-5", Wanted::Whole),
            ("bytes=4-2", Wanted::Whole),
            ("bytes=-", Wanted::Whole),
            ("bytes=+1-2", Wanted::Whole),
            ("bytes=a-b", Wanted::Whole),
            ("bytes", Wanted::Whole),
            ("rows=0-1", Wanted::Whole),
        ] {
            assert_eq!(wanted(range, 10), part, "{range}");
        }
        assert_eq!(wanted("bytes=0-", 0), Wanted::Nothing);
    }
}
