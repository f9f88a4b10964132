//! What every request passes through, from the outside in: request id, count and log, where the client reached the server,
//! other sites' pages, panics, plain refusals made problems, hosts, stray bodies, compression, shares of what is sent, ranges,
//! rate limit, body, jobs, storage quota, timeout.

mod body;
mod cors;
mod host;
mod observe;
mod public_address;
mod ranges;
mod rate_limit;
mod refusals;
mod respond_async;
mod sending;
mod storage_quota;
mod time_limit;

pub use body::{read_body, refuse_stray_bodies};
pub use cors::share_across_origins;
pub use host::require_host;
pub use observe::observe;
pub use public_address::find_public_address;
pub use ranges::answer_ranges;
pub use rate_limit::{KnownClient, limit_rate};
pub use refusals::{catch_panic, problems_only, tag_encodings};
pub use respond_async::respond_async;
pub use sending::limit_sending;
pub use storage_quota::{StorageQuota, StoredLength, limit_storage};
pub use time_limit::limit_time;
