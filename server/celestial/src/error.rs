//! What can be wrong with a time, a place or a condition of the sky.

use skyglow_physics::PhysicsError;
use thiserror::Error;

/// A request that the heavens have no answer to.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum CelestialError {
    /// A time that is not written as RFC 3339 wants it.
    #[error("time is \"{0}\"; it is written as in 2026-08-20T23:16:00Z or 2026-08-21T01:16:00+02:00")]
    NoTime(String),
    /// A date that is none.
    #[error("date is \"{0}\"; it is written as in 2026-08-20")]
    NoDate(String),
    /// A month that is none.
    #[error("month is \"{0}\"; it is written as in 2026-08")]
    NoMonth(String),
    /// A time that the positions of Sun and Moon do not hold for.
    #[error("the year is {0}; positions hold for 1900 to 2099")]
    OutsideYears(i32),
    /// A quantity outside its range.
    #[error(transparent)]
    Physics(#[from] PhysicsError),
}
