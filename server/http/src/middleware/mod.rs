//! What every request passes through, from the outside in: request id, count and log, where the client reached the server,
//! other sites' pages, panics, plain refusals made problems, compression, ranges, rate limit, storage quota, concurrency limit,
//! timeout.

mod body;
mod concurrency_limit;
mod cors;
mod observe;
mod public_address;
mod ranges;
mod rate_limit;
mod refusals;
mod storage_quota;

pub use body::read_body;
pub use concurrency_limit::{ConcurrencyLimit, limit_concurrency};
pub use cors::share_across_origins;
pub use observe::observe;
pub use public_address::find_public_address;
pub use ranges::answer_ranges;
pub use rate_limit::{KnownClient, RateLimiter, limit_rate};
pub use refusals::{catch_panic, problems_only, tag_encodings};
pub use storage_quota::{StorageQuota, StoredLength, limit_storage};
