//! What every request passes through, from the outside in: request id, count and log, panics, plain refusals made
//! problems, rate limit, share of what is kept, room, timeout.

mod body;
mod guard;
mod keeping;
mod observe;
mod rate_limit;
mod refusals;

pub use body::read_body;
pub use guard::{Room, guard};
pub use keeping::{Keeping, KeptLength, limit_keeping};
pub use observe::observe;
pub use rate_limit::{KnownClient, RateLimiter, limit_rate};
pub use refusals::{catch_panic, problems_only, tag_encodings};
