//! What can go wrong between a panorama and the bytes of a picture.

use thiserror::Error;

/// A picture that cannot be made as asked; names the option, its value, unit and range.
#[derive(Debug, Error)]
pub enum DisplayError {
    /// A number outside its range, or not finite.
    #[error("{option} is {value}{unit}; allowed is {minimum} to {maximum}{unit}")]
    OutOfRange {
        /// Name of the option as users spell it.
        option: &'static str,
        /// The offending value.
        value: f64,
        /// Smallest allowed value.
        minimum: f64,
        /// Largest allowed value.
        maximum: f64,
        /// Unit of all three, with its leading space; empty for pure numbers.
        unit: &'static str,
    },
    /// A colour range whose ends are equal or the wrong way round.
    #[error("min is {minimum} and max is {maximum}; min must be the smaller one")]
    EmptyRange {
        /// The lower end given.
        minimum: f64,
        /// The upper end given.
        maximum: f64,
    },
    /// Ground in light in a picture of false colours.
    #[error("ground in light has the colours of eye and camera; in false colours it stays dark")]
    LitInFalseColour,
    /// A picture of false colours for screens that go above white.
    #[error(
        "false colours mean numbers and go no higher than white; a high dynamic range is for eye and camera"
    )]
    HighInFalseColour,
    /// A response that the sky at hand was not made for: a defect of this program, not of the request.
    #[error("the sky was not made for the response {response}")]
    NotSeen {
        /// Its name.
        response: &'static str,
    },
    /// An encoder refused: a defect of this program, not of the request.
    #[error("encoding {format} failed: {reason}")]
    Encoding {
        /// Name of the format.
        format: &'static str,
        /// What the encoder said.
        reason: String,
    },
}

impl DisplayError {
    /// The error of an encoder of `format`.
    pub(crate) fn encoding(format: &'static str, reason: impl std::fmt::Display) -> Self {
        Self::Encoding { format, reason: reason.to_string() }
    }
}

/// Checks that `value` is finite and within `minimum..=maximum`.
pub(crate) fn check(
    option: &'static str,
    value: f64,
    minimum: f64,
    maximum: f64,
    unit: &'static str,
) -> Result<(), DisplayError> {
    if value.is_finite() && (minimum..=maximum).contains(&value) {
        Ok(())
    } else {
        Err(DisplayError::OutOfRange { option, value, minimum, maximum, unit })
    }
}
