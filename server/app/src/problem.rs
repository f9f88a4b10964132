//! Why a question is not answered, for programs: the stable names of [`AppError`]s, and a document of one.

use crate::{
    error::AppError,
    validation::{FieldError, Refusal},
};
use serde::Serialize;
use utoipa::ToSchema;

/// A kind of problem.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ProblemKind {
    /// Its stable name, such as `unknown-scene`.
    pub name: &'static str,
    /// The kind in words.
    pub title: &'static str,
}

const fn kind(name: &'static str, title: &'static str) -> ProblemKind {
    ProblemKind { name, title }
}

impl AppError {
    /// Which kind of problem it is.
    pub fn kind(&self) -> ProblemKind {
        match self {
            Self::Parameters(errors) => match Refusal::of(errors) {
                Refusal::UnknownParameter => kind("unknown-parameter", "Unknown parameter"),
                Refusal::NotResident => kind("not-resident", "The tables for this are not resident"),
                Refusal::OutOfRange => kind("out-of-range", "Outside the range that is resident"),
                Refusal::BadParameters => kind("bad-parameters", "Bad parameters"),
            },
            Self::UnknownScene { .. } => kind("unknown-scene", "There is no such scene"),
            Self::DamagedScene { .. } => kind("damaged-scene", "The scene is damaged and left out"),
            Self::UnknownScenario { .. } => kind("unknown-scenario", "There is no such scenario or plan"),
            Self::StalePlan { .. } => kind("stale-plan", "The plan is for an earlier state of the scene"),
            Self::DraftPlan { .. } => kind("draft-plan", "The plan is not kept"),
            Self::NotOwner { .. } => kind("not-owner", "The scenario or plan is somebody else's"),
            Self::PinsFull => kind("pins-full", "No more can be pinned"),
            Self::Storage { .. } => kind("storage", "The server cannot keep this now"),
            Self::StoreAway { .. } | Self::AtlasAway { .. } => {
                kind("store-away", "What is kept cannot be reached now")
            }
            Self::SceneTooLarge { .. } => {
                kind("scene-too-large", "The scene takes more memory than there is")
            }
            Self::SkylinesBeingFound { .. } => kind("being-made", "This is being made"),
            Self::OutsideScene { .. } => kind("outside-scene", "The place lies outside the scene"),
            Self::UnknownTile { .. } => kind("unknown-tile", "There is no such tile"),
            Self::BadUpload { .. } => kind("bad-upload", "What was uploaded cannot be meant"),
            Self::Busy { .. } => kind("busy", "The server is busy"),
            Self::EngineDown => kind("engine-down", "The engine does not answer"),
            Self::Internal { .. } => kind("internal", "Something is wrong with the server"),
        }
    }

    /// The scene's edges where a place lies outside them: west, south, east, north, degrees.
    pub fn bounds(&self) -> Option<[f64; 4]> {
        match self {
            Self::OutsideScene { bounds, .. } => Some(*bounds),
            _ => None,
        }
    }
}

/// Why there is no answer: a problem document without what HTTP adds to it.
#[derive(Clone, Debug, PartialEq, Serialize, ToSchema)]
pub struct LineError {
    /// Stable name of the kind of problem, such as `/problems/outside-scene`.
    #[serde(rename = "type")]
    pub kind: String,
    /// The kind in words.
    pub title: String,
    /// What is wrong, in words.
    pub detail: String,
    /// What is wrong with which parameter.
    pub errors: Vec<FieldError>,
    /// West, south, east, north of the scene, degrees, where the place lies outside it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub bounds: Option<[f64; 4]>,
}

impl From<&AppError> for LineError {
    fn from(error: &AppError) -> Self {
        let ProblemKind { name, title } = error.kind();
        Self {
            kind: format!("/problems/{name}"),
            title: title.to_owned(),
            detail: error.detail(),
            errors: error.field_errors().to_vec(),
            bounds: error.bounds(),
        }
    }
}
