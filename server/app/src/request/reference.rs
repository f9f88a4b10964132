//! Values by reference: addresses of the scheme `data` (RFC 2397), which hold what they refer to. No other is followed, for a server
//! that fetches what it is told to can be sent anywhere.

use base64::{Engine, engine::general_purpose::STANDARD};
use percent_encoding::percent_decode_str;
use serde_json::Value;

/// The value that an address holds: JSON where its media type is that, else text.
///
/// # Errors
/// What is wrong with it.
pub(super) fn value_at(href: &str) -> Result<Value, &'static str> {
    let held = "is a reference: addresses of the scheme `data` are followed alone, such as \
                `data:application/json,…`; other inputs are given as values";
    let (head, data) = href.strip_prefix("data:").and_then(|rest| rest.split_once(',')).ok_or(held)?;
    let (media_type, is_base64) = match head.strip_suffix(";base64") {
        Some(media_type) => (media_type, true),
        None => (head, false),
    };
    let bytes: Vec<u8> = percent_decode_str(data).collect();
    let bytes = match is_base64 {
        true => STANDARD.decode(bytes).map_err(|_| "is a reference whose data are no base64")?,
        false => bytes,
    };
    let name = media_type.split(';').next().unwrap_or_default();
    if name.ends_with("/json") || name.ends_with("+json") {
        return serde_json::from_slice(&bytes).map_err(|_| "is a reference whose data are no JSON");
    }
    String::from_utf8(bytes).map(Value::String).map_err(|_| "is a reference whose data are no text")
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn data_are_read_and_nothing_is_fetched() {
        for (href, value) in [
            ("data:application/json,46.5", json!(46.5)),
            (
                "data:application/geo+json;charset=utf-8,%7B%22type%22%3A%22Point%22%7D",
                json!({"type": "Point"}),
            ),
            ("data:application/json;base64,WzEsIDJd", json!([1, 2])),
            ("data:,demo", json!("demo")),
            ("data:text/plain;base64,ZMOpbW8=", json!("démo")),
        ] {
            assert_eq!(value_at(href), Ok(value), "{href}");
        }
        for (href, word) in [
            ("http://169.254.169.254/latest", "scheme `data`"),
            ("file:///etc/passwd", "scheme `data`"),
            ("data:application/json", "scheme `data`"),
            ("data:application/json,{", "no JSON"),
            ("data:application/json;base64,*", "no base64"),
            ("data:,%ff", "no text"),
        ] {
            assert!(value_at(href).unwrap_err().contains(word), "{href}");
        }
    }
}
