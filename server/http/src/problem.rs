//! RFC 9457 problem documents.

use serde::Serialize;
use utoipa::ToSchema;

/// Media type of problem documents.
pub const PROBLEM_JSON: &str = "application/problem+json";

/// Why a request was not answered as asked (RFC 9457).
#[derive(Clone, Debug, PartialEq, Serialize, ToSchema)]
pub struct Problem {
    /// Stable name of the kind of problem, such as `/problems/unknown-parameter`.
    #[serde(rename = "type")]
    pub kind: String,
    /// The kind in words.
    pub title: String,
    /// The status code.
    pub status: u16,
    /// What is wrong with this request, and what would help.
    pub detail: String,
    /// Every bad parameter.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub errors: Vec<FieldError>,
    /// West, south, east, north of the scene, degrees, where the place lies outside it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub bounds: Option<[f64; 4]>,
}

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
    pub code: Mistake,
}

/// Kinds of mistakes in parameters.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, ToSchema)]
#[serde(rename_all = "snake_case")]
pub enum Mistake {
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

impl Mistake {
    /// The mistake in words.
    pub const fn words(self) -> &'static str {
        match self {
            Mistake::UnknownParameter => "there is no such parameter here",
            Mistake::Missing => "is required",
            Mistake::Repeated => "is given more than once",
            Mistake::Malformed => "cannot be read",
            Mistake::NotAllowed => "is not allowed",
            Mistake::Conflict => "excludes another parameter given",
            Mistake::OutOfRange => "is out of range",
            Mistake::NotResident => "needs tables that are not resident",
        }
    }
}

/// At most this many characters of what a client sent are sent back.
const LONGEST_ECHO: usize = 100;

/// At most this many of a message about it, which may quote it and lists what is allowed.
const LONGEST_MESSAGE: usize = 400;

/// A client's text, shortened.
pub fn echo(text: &str) -> String {
    shortened(text, LONGEST_ECHO)
}

/// A message that may quote a client's text, shortened.
pub fn message_with_echo(text: &str) -> String {
    shortened(text, LONGEST_MESSAGE)
}

fn shortened(text: &str, longest: usize) -> String {
    match text.char_indices().nth(longest) {
        Some((end, _)) => format!("{}…", &text[..end]),
        None => text.to_owned(),
    }
}
