//! One of many skies: its numbers, or why it has none.

use super::SkyAnswer;
use crate::problem::LineError;
use serde::Serialize;
use utoipa::ToSchema;

/// One of many skies: the answer of `GET sky`, or an error.
#[derive(Clone, Debug, Serialize, ToSchema)]
pub struct SkyLine {
    /// Number of the place in the body, from 0.
    pub place: usize,
    /// The name that it came with.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub name: Option<String>,
    /// The answer.
    #[serde(flatten)]
    pub sky: Option<SkyAnswer>,
    /// Why there is none.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub error: Option<LineError>,
}
