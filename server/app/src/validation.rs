//! What is wrong with the parameters of a request: which, why, and what is allowed instead.

use serde::Serialize;
use utoipa::ToSchema;

/// One bad parameter.
#[derive(Clone, Debug, PartialEq, Serialize, ToSchema)]
pub struct FieldError {
    /// Its name.
    pub parameter: String,
    /// Its value as it came; absent where the parameter is missing.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub value: Option<String>,
    /// What is allowed.
    pub allowed: String,
    /// What is wrong with it.
    pub message: String,
    /// The kind of mistake.
    pub code: ValidationCode,
}

/// Kinds of mistakes in parameters.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, ToSchema)]
#[serde(rename_all = "snake_case")]
#[schema(as = Mistake)]
pub enum ValidationCode {
    /// No such parameter here.
    UnknownParameter,
    /// Required and absent.
    Missing,
    /// Given more than once.
    Repeated,
    /// Not of the parameter's kind.
    Malformed,
    /// Of the right kind, not in the parameter's range.
    NotAllowed,
    /// Excludes another parameter that is given too.
    Conflict,
    /// Altitude or turbidity outside what is resident.
    OutOfRange,
    /// Allowed, but this server does not hold the tables for it.
    NotResident,
}

impl ValidationCode {
    /// The mistake in words.
    pub const fn description(self) -> &'static str {
        match self {
            ValidationCode::UnknownParameter => "there is no such parameter here",
            ValidationCode::Missing => "is required",
            ValidationCode::Repeated => "is given more than once",
            ValidationCode::Malformed => "cannot be read",
            ValidationCode::NotAllowed => "is not allowed",
            ValidationCode::Conflict => "excludes another parameter given",
            ValidationCode::OutOfRange => "is out of range",
            ValidationCode::NotResident => "needs tables that are not resident",
        }
    }
}

/// What a refused request is, by the worst of its mistakes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Refusal {
    /// All that is wrong are names that are no parameters here.
    UnknownParameter,
    /// All that is wrong needs tables that are not resident.
    NotResident,
    /// The rest can be read and is outside what is resident.
    OutOfRange,
    /// Something cannot be read or is not allowed.
    BadParameters,
}

impl Refusal {
    /// The worst mistake decides: what cannot be read before what is out of range before what is not resident.
    pub fn of(errors: &[FieldError]) -> Self {
        let only = |mistakes: &[ValidationCode]| errors.iter().all(|error| mistakes.contains(&error.code));
        if only(&[ValidationCode::UnknownParameter]) {
            Self::UnknownParameter
        } else if only(&[ValidationCode::NotResident]) {
            Self::NotResident
        } else if only(&[ValidationCode::OutOfRange, ValidationCode::NotResident]) {
            Self::OutOfRange
        } else {
            Self::BadParameters
        }
    }
}

/// At most this many characters of what a client sent are sent back.
const MAX_ECHO_CHARS: usize = 100;

/// At most this many of a message about it, which may quote it and lists what is allowed.
const MAX_MESSAGE_CHARS: usize = 400;

/// A client's text, shortened.
pub fn echo(text: &str) -> String {
    shortened(text, MAX_ECHO_CHARS)
}

/// A message that may quote a client's text, shortened.
pub fn message_with_echo(text: &str) -> String {
    shortened(text, MAX_MESSAGE_CHARS)
}

fn shortened(text: &str, longest: usize) -> String {
    match text.char_indices().nth(longest) {
        Some((end, _)) => format!("{}…", &text[..end]),
        None => text.to_owned(),
    }
}
