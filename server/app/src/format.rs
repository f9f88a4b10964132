//! Times and degrees as answers write them.

use time::{OffsetDateTime, format_description::well_known::Rfc3339};

/// Seconds since 1970 as RFC 3339 UTC; empty for a time that no calendar has.
pub fn rfc3339(unix_s: u64) -> String {
    let time =
        i64::try_from(unix_s).ok().and_then(|seconds| OffsetDateTime::from_unix_timestamp(seconds).ok());
    time.and_then(|time| time.format(&Rfc3339).ok()).unwrap_or_default()
}

/// Degrees without the last digits of the way through radians.
pub fn rounded(degrees: f64) -> f64 {
    (degrees * 1e9).round() / 1e9
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times_are_utc_in_rfc_3339() {
        assert_eq!(rfc3339(0), "1970-01-01T00:00:00Z");
        assert_eq!(rfc3339(1_700_000_000), "2023-11-14T22:13:20Z");
        assert_eq!(rfc3339(u64::MAX), "");
    }
}
