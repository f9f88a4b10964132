//! What the interface can be told.

use ipnet::IpNet;
use serde::{Deserialize, Serialize};
use std::{net::IpAddr, path::PathBuf, time::Duration};

/// How much of a client's address the log has.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum LoggedAddress {
    /// Nothing.
    #[default]
    Off,
    /// Its network: /24 of IPv4, /48 of IPv6.
    Truncated,
    /// All of it.
    Full,
}

impl LoggedAddress {
    /// What the log has of an address.
    pub fn of(self, address: IpAddr) -> Option<String> {
        let address = address.to_canonical();
        let bits = if address.is_ipv4() { 24 } else { 48 };
        match self {
            Self::Off => None,
            Self::Truncated => IpNet::new(address, bits).ok().map(|net| net.trunc().to_string()),
            Self::Full => Some(address.to_string()),
        }
    }
}

/// Limits and addresses of the interface. Everything is on by default.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct HttpConfig {
    /// Requests to the API that make something, a quarter of them worked on and the others waiting for their turn; more are answered
    /// 503.
    pub concurrent_requests: usize,
    /// Longest time for one answer, seconds; then 503.
    pub request_timeout_s: f64,
    /// Longest request body, bytes; then 413.
    pub body_limit_bytes: usize,
    /// Bytes of memory for what is under way: pictures and answers until they are sent, plans; a fourth more for answers that were
    /// not counted before, and a sixteenth for bodies of requests. 0 for what [`MemoryShares`](crate::MemoryShares) has for it.
    pub memory_budget_bytes: u64,
    /// Longest upload of a scene's rasters together, bytes; then 413.
    pub upload_limit_bytes: usize,
    /// Longest time for an upload to arrive and be checked, seconds.
    pub upload_timeout_s: f64,
    /// Pixels that an uploaded raster may have.
    pub upload_pixels: u64,
    /// Requests a second that one client address may send on average; 0 for no limit. More are answered 429.
    pub requests_per_second: f64,
    /// Requests that one client address may send at once.
    pub request_burst: u32,
    /// Seconds of long work (influences, plans, rasters of layers) a minute that one client may have on average; 0 for no limit. More
    /// are answered 429.
    pub work_per_minute_s: f64,
    /// Seconds of long work that one client may have at once.
    pub work_burst_s: f64,
    /// Scenarios and plans, counted by 16 kB, that one client address may have kept in a day. 0 for no limit; more are answered 429.
    pub kept_per_day: u32,
    /// Longest time for the answers under way when the server is told to end, seconds.
    pub drain_timeout_s: f64,
    /// Most bytes of rendered skies that are kept for the next request; fewer where memory is small, as of all caches.
    pub cache_bytes: u64,
    /// Most bytes of pictures, rasters and map tiles that are kept as they were sent.
    pub answer_cache_bytes: u64,
    /// Most bytes of maps of influences that are kept for the next request and for map tiles; a map of a million lights takes 36 MB.
    pub influence_cache_bytes: u64,
    /// Most bytes of maps of the zenith's brightness that are kept for map tiles; a map takes 7 MB.
    pub brightness_cache_bytes: u64,
    /// Connections at a time; a fourth of them from one address.
    pub connections: usize,
    /// Longest wait for the head of a request, and for a client to take some of what it is sent, seconds; then the connection ends.
    pub idle_timeout_s: f64,
    /// Networks of proxies that are believed in `X-Forwarded-For`, `-Proto`, `-Host` and `-Prefix`, and in `Forwarded`.
    pub trusted_proxies: Vec<IpNet>,
    /// How much of a client's address is in the log.
    pub log_client_address: LoggedAddress,
    /// Where clients reach the server, such as `https://sky.example.org/skyglow`, for the links inside answers;
    /// without it trusted proxies and the request's Host header say so.
    pub public_url: Option<String>,
    /// A PMTiles file of vector tiles with the layers of Protomaps, which the viewer's map shows below the lights.
    pub basemap: Option<PathBuf>,
    /// PMTiles files of maps of brightness that `skyglow atlas` or `skyglow.export.pmtiles` made, by path or in an object store: their
    /// tiles are shown in place of the same maps computed.
    pub atlases: Vec<String>,
    /// Origins of other sites whose pages may have scenarios and plans kept, such as `https://maps.example.org`; `*` for all. Those
    /// of all sites may read.
    pub cors_origins: Vec<String>,
}

impl Default for HttpConfig {
    fn default() -> Self {
        Self {
            concurrent_requests: 128,
            request_timeout_s: 30.0,
            body_limit_bytes: 2 * 1024 * 1024,
            memory_budget_bytes: 0,
            upload_limit_bytes: 2 * 1024 * 1024 * 1024,
            upload_timeout_s: 1800.0,
            upload_pixels: 400_000_000,
            requests_per_second: 100.0,
            request_burst: 1000,
            work_per_minute_s: 60.0,
            work_burst_s: 600.0,
            kept_per_day: 500,
            drain_timeout_s: 10.0,
            cache_bytes: 64 * 1024 * 1024,
            answer_cache_bytes: 256 * 1024 * 1024,
            influence_cache_bytes: 256 * 1024 * 1024,
            brightness_cache_bytes: 64 * 1024 * 1024,
            connections: 2048,
            idle_timeout_s: 30.0,
            trusted_proxies: Vec::new(),
            log_client_address: LoggedAddress::Off,
            public_url: None,
            basemap: None,
            atlases: Vec::new(),
            cors_origins: Vec::new(),
        }
    }
}

/// Bytes for what is under way where nobody says.
const MEMORY_BUDGET_BYTES: u64 = 1 << 30;
/// Part of that for bodies of requests.
pub(crate) const PART_FOR_BODIES: u64 = 16;

impl HttpConfig {
    /// Bytes for what is under way.
    pub fn memory_budget(&self) -> u64 {
        match self.memory_budget_bytes {
            0 => MEMORY_BUDGET_BYTES,
            bytes => bytes,
        }
    }

    /// Bytes of that for bodies of requests: one at least.
    pub fn body_budget(&self) -> u64 {
        (self.memory_budget() / PART_FOR_BODIES).max(self.body_limit_bytes as u64)
    }

    /// The longest time for one answer.
    pub fn request_timeout(&self) -> Duration {
        seconds(self.request_timeout_s)
    }

    /// The longest time that a client may keep silent.
    pub fn idle_timeout(&self) -> Duration {
        seconds(self.idle_timeout_s)
    }

    /// The longest time for an upload.
    pub fn upload_timeout(&self) -> Duration {
        seconds(self.upload_timeout_s)
    }

    /// The longest time for the answers under way at the end.
    pub fn drain_timeout(&self) -> Duration {
        seconds(self.drain_timeout_s)
    }
}

/// A duration from seconds; 0 for what is no duration, a day at most.
fn seconds(seconds: f64) -> Duration {
    Duration::from_secs_f64(if seconds.is_finite() { seconds.clamp(0.0, 86_400.0) } else { 0.0 })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The log has the network of a client, its address, or nothing.
    #[test]
    fn the_log_has_as_much_of_an_address_as_told() {
        let of = |how: LoggedAddress, address: &str| how.of(address.parse().unwrap());
        assert_eq!(of(LoggedAddress::Off, "203.0.113.77"), None);
        for (address, net) in [
            ("203.0.113.77", "203.0.113.0/24"),
            ("::ffff:203.0.113.77", "203.0.113.0/24"),
            ("2001:db8:1:2::77", "2001:db8:1::/48"),
        ] {
            assert_eq!(of(LoggedAddress::Truncated, address).as_deref(), Some(net));
        }
        assert_eq!(of(LoggedAddress::Full, "::ffff:203.0.113.77").as_deref(), Some("203.0.113.77"));
    }
}
