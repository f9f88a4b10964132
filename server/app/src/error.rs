//! Why a question is not answered, whoever asks.

use crate::validation::{FieldError, ValidationCode};
use thiserror::Error;

/// Why a question is not answered as asked.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum AppError {
    /// One or more bad parameters; never empty.
    #[error("bad parameters")]
    Parameters(Vec<FieldError>),
    /// No scene of that id.
    #[error("there is no scene \"{id}\"; GET /api/v1/scenes lists those that are there")]
    UnknownScene {
        /// The id asked for, shortened.
        id: String,
    },
    /// A scene that cannot be read any more.
    #[error(
        "the files of scene \"{id}\" are damaged, and so it is left out; the operator can store it again"
    )]
    DamagedScene {
        /// The scene's id.
        id: String,
    },
    /// No scenario or plan of that id.
    #[error("there is no scenario or plan \"{id}\"; those that are old or too many are not kept")]
    UnknownScenario {
        /// The id asked for, shortened.
        id: String,
    },
    /// A plan for pixels of a raster that was replaced.
    #[error("plan \"{id}\" is for the pixels of the scene as it was before it was ingested again")]
    StalePlan {
        /// The plan's id.
        id: String,
    },
    /// A plan that is only held for some minutes.
    #[error(
        "plan \"{id}\" is not kept, so nothing that is kept can go on from it; ask for it again with keep=on first"
    )]
    DraftPlan {
        /// The plan's id.
        id: String,
    },
    /// A scenario or plan of somebody else.
    #[error("scenario or plan \"{id}\" is somebody else's")]
    NotOwner {
        /// Its id.
        id: String,
    },
    /// As much is pinned as may be.
    #[error("as much is pinned as may be, which is half of what is kept")]
    PinsFull,
    /// What should be stored cannot be written.
    #[error("the server cannot keep this now; try again later")]
    Storage {
        /// What happened, for the log.
        reason: String,
    },
    /// The store that servers share does not answer.
    #[error("what is kept cannot be reached now, nor can anything be kept; try again in a minute")]
    StoreAway {
        /// What happened, for the log.
        reason: String,
    },
    /// The file of a map that was made beforehand cannot be read.
    #[error("this map was made beforehand, and its file cannot be read now; try again in a minute")]
    AtlasAway {
        /// What happened, for the log.
        reason: String,
    },
    /// A scene that takes more memory than this server has for one.
    #[error("{reason}")]
    SceneTooLarge {
        /// How much it needs and how much there is, in one sentence.
        reason: String,
    },
    /// The skylines of the lights around a place are being found, which goes on.
    #[error("the skylines of the lights around are found for the first time: {:.0} % are there; ask again in {retry_after_s} s", 100.0 * progress)]
    SkylinesBeingFound {
        /// The part of the lights that have theirs, 0 to 1.
        progress: f64,
        /// Seconds until it is worth asking again.
        retry_after_s: u64,
    },
    /// The place is not in the scene.
    #[error(
        "latitude {latitude_deg}, longitude {longitude_deg} lies outside the scene, which reaches from west {} south {} to east {} north {}",
        bounds[0], bounds[1], bounds[2], bounds[3]
    )]
    OutsideScene {
        /// Latitude asked for, degrees.
        latitude_deg: f64,
        /// Longitude asked for, degrees.
        longitude_deg: f64,
        /// West, south, east, north, degrees.
        bounds: [f64; 4],
    },
    /// No such map tile.
    #[error("there is no such tile: {reason}")]
    UnknownTile {
        /// What is wrong with its address.
        reason: String,
    },
    /// What was uploaded cannot be meant.
    #[error("{reason}")]
    BadUpload {
        /// Why, in one sentence.
        reason: String,
    },
    /// The server is at its limit.
    #[error("the server is busy; try again in {retry_after_s} s")]
    Busy {
        /// Seconds to wait.
        retry_after_s: u64,
    },
    /// The engine does not answer.
    #[error("the engine does not answer; try again soon")]
    EngineDown,
    /// A defect or a broken installation; `reason` goes to the log, never to the client.
    #[error("something is wrong with the server; its log says more")]
    Internal {
        /// What happened, for the log.
        reason: String,
    },
}

impl AppError {
    /// A defect with its reason for the log.
    pub fn internal(reason: impl std::fmt::Display) -> Self {
        Self::Internal { reason: reason.to_string() }
    }

    /// One bad parameter.
    pub fn parameter(
        name: &str,
        value: String,
        allowed: String,
        message: String,
        code: ValidationCode,
    ) -> Self {
        Self::Parameters(vec![FieldError {
            parameter: name.to_owned(),
            value: Some(value),
            allowed,
            message,
            code,
        }])
    }

    /// The bad parameters.
    pub fn field_errors(&self) -> &[FieldError] {
        match self {
            Self::Parameters(errors) => errors,
            _ => &[],
        }
    }

    /// What is wrong and what would help, in one sentence for each mistake.
    pub fn detail(&self) -> String {
        match self {
            Self::Parameters(errors) => sentence(errors),
            other => other.to_string(),
        }
    }
}

/// All mistakes in one sentence.
fn sentence(errors: &[FieldError]) -> String {
    let parts: Vec<String> = errors
        .iter()
        .map(|error| match &error.value {
            Some(value) => {
                format!("{}={value}: {}; allowed: {}", error.parameter, error.message, error.allowed)
            }
            None => format!("{}: {}; allowed: {}", error.parameter, error.message, error.allowed),
        })
        .collect();
    parts.join(". ")
}
