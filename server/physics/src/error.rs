//! What can be wrong with a physical quantity.

use thiserror::Error;

/// A quantity outside its physical or modelled range; names the parameter, its value, unit and range.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum PhysicsError {
    /// A scalar outside its range, or not a finite number.
    #[error("{parameter} is {value}{}; allowed is {minimum} to {maximum}{}", spaced(unit), spaced(unit))]
    OutOfRange {
        /// Parameter name as users spell it.
        parameter: &'static str,
        /// The offending value.
        value: f64,
        /// Smallest allowed value.
        minimum: f64,
        /// Largest allowed value.
        maximum: f64,
        /// Unit of all three numbers; empty for pure numbers.
        unit: &'static str,
    },
    /// Weights that are negative, not finite, or all zero.
    #[error("{parameter}: {reason}")]
    Invalid {
        /// Parameter name as users spell it.
        parameter: &'static str,
        /// What is wrong with it.
        reason: String,
    },
}

/// A unit behind its number; nothing for pure numbers.
fn spaced(unit: &str) -> String {
    if unit.is_empty() { String::new() } else { format!(" {unit}") }
}

/// Checks that `value` is finite and within `minimum..=maximum`.
///
/// # Errors
/// [`PhysicsError::OutOfRange`] naming `parameter` otherwise.
pub fn check_range(
    parameter: &'static str,
    value: f64,
    minimum: f64,
    maximum: f64,
    unit: &'static str,
) -> Result<f64, PhysicsError> {
    if value.is_finite() && value >= minimum && value <= maximum {
        Ok(value)
    } else {
        Err(PhysicsError::OutOfRange { parameter, value, minimum, maximum, unit })
    }
}
