//! Why the program behind does not answer, and what its client is told.

use super::{EyeHeight, SkyQuery, rounded};
use crate::{
    error::AppError,
    parameters::{ALTITUDE, CLOUDS, HEIGHT, REGION, SCENARIO},
    validation::{FieldError, ValidationCode},
};
use skyglow_physics::GeoPoint;
use skyglow_scene::ChangeError;
use thiserror::Error;

/// Why the program behind does not answer.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum SourceError {
    /// No scene of that id.
    #[error("there is no scene \"{0}\"")]
    UnknownScene(String),
    /// The place lies outside.
    #[error("the place lies outside the scene")]
    OutsideScene {
        /// West, south, east, north of the scene, degrees.
        bounds: [f64; 4],
    },
    /// Observer too high.
    #[error("altitude is {altitude_m} m; allowed is {minimum_m} to {maximum_m} m")]
    AltitudeOutOfRange {
        /// Altitude asked for, metres.
        altitude_m: f64,
        /// Lowest resident, metres.
        minimum_m: f64,
        /// Highest resident, metres.
        maximum_m: f64,
    },
    /// Observer at the clouds or above them.
    #[error("altitude is {altitude_m} m; the clouds are at {base_m} m, and allowed is up to {maximum_m} m")]
    AboveClouds {
        /// Altitude asked for, metres.
        altitude_m: f64,
        /// Base of the clouds, metres.
        base_m: u32,
        /// Highest allowed, metres.
        maximum_m: f64,
    },
    /// Another number that the resident tables do not reach.
    #[error("{parameter} is {value}; allowed is {allowed}")]
    OutOfRange {
        /// Name of the parameter.
        parameter: &'static str,
        /// The value asked for.
        value: String,
        /// What is resident.
        allowed: String,
    },
    /// A value for which no tables are resident at all.
    #[error("{parameter} is {value}; resident is {resident}")]
    NotResident {
        /// Name of the parameter.
        parameter: &'static str,
        /// The value asked for.
        value: String,
        /// What is resident.
        resident: String,
    },
    /// A curve on the sky without a visible direction in it.
    #[error("the curve holds no visible direction of the sky")]
    EmptyRegion,
    /// No scenario or plan of that id.
    #[error("there is no scenario or plan \"{0}\"")]
    UnknownScenario(String),
    /// It belongs to another scene.
    #[error("\"{id}\" belongs to scene \"{scene}\"")]
    ScenarioOfOtherScene {
        /// The id.
        id: String,
        /// Its scene.
        scene: String,
    },
    /// A plan for pixels of a raster that was replaced.
    #[error("plan \"{0}\" is for an earlier state of its scene")]
    StalePlan(String),
    /// A plan that is only held for some minutes.
    #[error("plan \"{0}\" is not kept")]
    DraftPlan(String),
    /// Too many scenarios and plans one upon the other.
    #[error("\"{0}\" stands on too many others")]
    ScenarioTooDeep(String),
    /// Edits that cannot be made.
    #[error(transparent)]
    BadEdit(#[from] ChangeError),
    /// A plan that cannot be meant.
    #[error("{0}")]
    BadPlan(String),
    /// What was uploaded cannot be meant.
    #[error("{0}")]
    BadUpload(String),
    /// Nothing can be kept.
    #[error("{0}")]
    Storage(String),
    /// No such tile.
    #[error("{0}")]
    UnknownTile(String),
    /// The queue is full.
    #[error("the queue is full")]
    Busy,
    /// No engine, or its device failed twice.
    #[error("the engine is down: {0}")]
    Down(String),
    /// A defect or a broken installation.
    #[error("{0}")]
    Broken(String),
}

impl SourceError {
    /// The answer to the client that asked for a sky: an altitude out of range is the fault of the parameter
    /// that made it.
    pub fn of_sky(self, query: &SkyQuery) -> AppError {
        match self {
            SourceError::AltitudeOutOfRange { altitude_m, minimum_m, maximum_m } => {
                too_high(query.eye_height, altitude_m, (minimum_m, maximum_m))
            }
            other => other.at(query.place),
        }
    }

    /// The answer to the client that asked about a place.
    pub fn at(self, place: GeoPoint) -> AppError {
        match self {
            SourceError::OutsideScene { bounds } => AppError::OutsideScene {
                latitude_deg: rounded(place.latitude_deg()),
                longitude_deg: rounded(place.longitude_deg()),
                bounds,
            },
            // The scene was ingested again since the scenario was painted.
            SourceError::BadEdit(error) => AppError::Parameters(vec![FieldError {
                parameter: SCENARIO.name.to_owned(),
                value: None,
                allowed: "a scenario that can be painted over the scene as it is now".to_owned(),
                message: error.to_string(),
                code: ValidationCode::NotAllowed,
            }]),
            other => other.into(),
        }
    }

    /// The answer to the client that painted: what its scenario goes on from is named in the body.
    pub fn of_painting(self) -> AppError {
        let (id, message) = match self {
            SourceError::ScenarioOfOtherScene { id, scene } => {
                (id, format!("it belongs to scene \"{scene}\""))
            }
            SourceError::ScenarioTooDeep(id) => {
                (id, "it stands on too many others, one upon the other".to_owned())
            }
            other => return other.into(),
        };
        let allowed = "a scenario or plan of this scene that stands on few others".to_owned();
        AppError::parameter("base", id, allowed, message, ValidationCode::NotAllowed)
    }
}

/// Refuses the height or the altitude that puts an eye above the tables.
fn too_high(eye_height: EyeHeight, altitude_m: f64, (minimum_m, maximum_m): (f64, f64)) -> AppError {
    let (name, value_m, allowed) = match eye_height {
        EyeHeight::AboveSea(altitude_m) => {
            (ALTITUDE.name, altitude_m, format!("{minimum_m} to {maximum_m} m above sea level"))
        }
        EyeHeight::AboveGround(height_m) => {
            let ground_m = altitude_m - height_m;
            let room_m = maximum_m - ground_m;
            let allowed = if room_m >= 0.0 {
                format!("0 to {room_m:.0} m above this ground, which lies at {ground_m:.0} m")
            } else {
                format!("none above this ground: it lies at {ground_m:.0} m, the tables end at {maximum_m} m")
            };
            (HEIGHT.name, height_m, allowed)
        }
    };
    AppError::parameter(
        name,
        value_m.to_string(),
        allowed,
        ValidationCode::OutOfRange.words().to_owned(),
        ValidationCode::OutOfRange,
    )
}

/// Refuses clouds that an eye is in or above.
fn above_clouds(altitude_m: f64, base_m: u32, maximum_m: f64) -> AppError {
    let room_m = f64::from(base_m) - maximum_m;
    AppError::parameter(
        CLOUDS.name,
        base_m.to_string(),
        format!("none, or a base {room_m:.0} m or more above the observer, who is at {altitude_m:.0} m"),
        "the observer would be in the clouds or above them".to_owned(),
        ValidationCode::OutOfRange,
    )
}

/// Refuses an edit that only the scene shows to be wrong.
fn bad_edit(error: &ChangeError) -> AppError {
    let (parameter, allowed) = match error {
        ChangeError::Area { number, .. } => {
            (format!("edits[{}]", number - 1), "an area with closed rings, or a stroke of places")
        }
        ChangeError::Outside { number } => (format!("edits[{}]", number - 1), "an area in the scene"),
        ChangeError::TooBright { number } => (format!("edits[{}]", number - 1), "light that lamps can give"),
        ChangeError::TooManyFixtures { number } => {
            (format!("edits[{}]", number - 1), "fewer kinds of lamps and emissions")
        }
        ChangeError::TooMuch { number } => (format!("edits[{}]", number - 1), "smaller areas, or fewer"),
        ChangeError::TooManyNewLights { .. } => ("edits".to_owned(), "fewer new lights"),
    };
    let (message, allowed) = (error.to_string(), allowed.to_owned());
    let code = ValidationCode::NotAllowed;
    AppError::Parameters(vec![FieldError { parameter, value: None, allowed, message, code }])
}

impl From<SourceError> for AppError {
    fn from(error: SourceError) -> Self {
        match error {
            SourceError::UnknownScene(id) => AppError::UnknownScene { id: crate::validation::echo(&id) },
            SourceError::OutsideScene { .. } => AppError::internal("a place was checked without a place"),
            SourceError::AltitudeOutOfRange { altitude_m, minimum_m, maximum_m } => {
                too_high(EyeHeight::AboveSea(altitude_m), altitude_m, (minimum_m, maximum_m))
            }
            SourceError::AboveClouds { altitude_m, base_m, maximum_m } => {
                above_clouds(altitude_m, base_m, maximum_m)
            }
            SourceError::OutOfRange { parameter, value, allowed } => AppError::parameter(
                parameter,
                value,
                allowed,
                ValidationCode::OutOfRange.words().to_owned(),
                ValidationCode::OutOfRange,
            ),
            SourceError::NotResident { parameter, value, resident } => AppError::parameter(
                parameter,
                value,
                resident,
                ValidationCode::NotResident.words().to_owned(),
                ValidationCode::NotResident,
            ),
            SourceError::EmptyRegion => AppError::parameter(
                REGION.name,
                "the curve".to_owned(),
                "a curve around some of the visible sky; directions are 1.4 degrees apart".to_owned(),
                "it holds no visible direction of the sky".to_owned(),
                ValidationCode::NotAllowed,
            ),
            SourceError::UnknownScenario(id) => {
                AppError::UnknownScenario { id: crate::validation::echo(&id) }
            }
            SourceError::ScenarioOfOtherScene { id, scene } => AppError::parameter(
                SCENARIO.name,
                id,
                "one of this scene".to_owned(),
                format!("it belongs to scene \"{scene}\""),
                ValidationCode::NotAllowed,
            ),
            SourceError::StalePlan(id) => AppError::StalePlan { id },
            SourceError::DraftPlan(id) => AppError::DraftPlan { id },
            SourceError::ScenarioTooDeep(id) => AppError::parameter(
                SCENARIO.name,
                id,
                "one that stands on fewer others".to_owned(),
                "it stands on too many others, one upon the other".to_owned(),
                ValidationCode::NotAllowed,
            ),
            SourceError::BadEdit(error) => bad_edit(&error),
            SourceError::BadPlan(reason) => AppError::Parameters(vec![FieldError {
                parameter: "body".to_owned(),
                value: None,
                allowed: "a plan that can be made".to_owned(),
                message: reason,
                code: ValidationCode::NotAllowed,
            }]),
            SourceError::BadUpload(reason) => AppError::BadUpload { reason },
            SourceError::Storage(reason) => AppError::Storage { reason },
            SourceError::UnknownTile(reason) => AppError::UnknownTile { reason },
            SourceError::Busy => AppError::Busy { retry_after_s: 1 },
            SourceError::Down(reason) => {
                tracing::error!(%reason, "engine down");
                AppError::EngineDown
            }
            SourceError::Broken(reason) => AppError::Internal { reason },
        }
    }
}
