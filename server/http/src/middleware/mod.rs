//! What every request passes through, from the outside in: request id, count and log, panics, plain refusals made
//! problems, rate limit, storage quota, concurrency limit, timeout.

mod body;
mod concurrency_limit;
mod observe;
mod rate_limit;
mod refusals;
mod storage_quota;

pub use body::read_body;
pub use concurrency_limit::{ConcurrencyLimit, limit_concurrency};
pub use observe::observe;
pub use rate_limit::{KnownClient, RateLimiter, limit_rate};
pub use refusals::{catch_panic, problems_only, tag_encodings};
pub use storage_quota::{StorageQuota, StoredLength, limit_storage};
