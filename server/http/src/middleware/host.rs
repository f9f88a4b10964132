//! The Host header, which every request of HTTP/1.1 has once (RFC 9112, section 3.2).

use crate::error::ApiError;
use axum::{
    extract::Request,
    http::{HeaderMap, HeaderValue, StatusCode, Version, header},
    middleware::Next,
    response::{IntoResponse, Response},
};

/// Answers 400 to requests with no host or with two; the connection ends.
pub async fn require_host(request: Request, next: Next) -> Response {
    if has_one_host(request.version(), request.headers()) {
        return next.run(request).await;
    }
    let mut response = ApiError::Unreadable(StatusCode::BAD_REQUEST.as_u16()).into_response();
    response.headers_mut().insert(header::CONNECTION, HeaderValue::from_static("close"));
    response
}

fn has_one_host(version: Version, headers: &HeaderMap) -> bool {
    let mut hosts = headers.get_all(header::HOST).iter();
    match (hosts.next(), hosts.next()) {
        (None, _) => version < Version::HTTP_11,
        (Some(_), None) => true,
        (Some(_), Some(_)) => false,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_host_is_needed_since_http_1_1() {
        let has = |version, hosts: &[&'static str]| {
            let mut headers = HeaderMap::new();
            hosts.iter().for_each(|host| {
                headers.append(header::HOST, HeaderValue::from_static(host));
            });
            has_one_host(version, &headers)
        };
        assert!(has(Version::HTTP_11, &["sky.example.org:8080"]) && has(Version::HTTP_11, &["[::1]:80"]));
        assert!(has(Version::HTTP_11, &[""]) && has(Version::HTTP_10, &[]));
        for hosts in [&[][..], &["a", "a"], &["a", "b"]] {
            assert!(!has(Version::HTTP_11, hosts), "{hosts:?}");
        }
        assert!(!has(Version::HTTP_10, &["a", "b"]));
    }
}
