//! From the errors of the observatory to what its client is told, by what was asked.

use crate::{
    error::AppError,
    format::rounded,
    parameters::{
        ALTITUDE, BASIS, CLOUDS, EMISSION_KEEP, HEIGHT, MEASURE, REGION, SCATTERING, SCENARIO, TURBIDITY,
    },
    validation::{FieldError, ValidationCode, echo},
};
use skyglow_observatory::{ObservatoryError, ObserverHeight, SkyRequest};
use skyglow_physics::{EmissionKeep, GeoPoint};
use skyglow_render::{PackKind, RenderError};
use skyglow_scene::{ChangeError, ChangeStoreError, Ground, SceneError};

/// Nobody is told to wait longer before asking again, seconds.
const LONGEST_PAUSE_S: f64 = 5.0;

impl AppError {
    /// The answer to a client that asked for a sky: an altitude out of range is the fault of the parameter that made it.
    pub fn of_sky(error: ObservatoryError, request: &SkyRequest) -> Self {
        match error {
            ObservatoryError::Render(RenderError::AltitudeOutOfRange {
                altitude_m,
                minimum_m,
                maximum_m,
            }) => too_high(request.observer_height, altitude_m, (minimum_m, maximum_m)),
            other => Self::at(other, request.place),
        }
    }

    /// The answer to a client that asked about a place.
    pub fn at(error: ObservatoryError, place: GeoPoint) -> Self {
        match error {
            ObservatoryError::OutsideScene { bounds, .. } => Self::OutsideScene {
                latitude_deg: rounded(place.latitude_deg()),
                longitude_deg: rounded(place.longitude_deg()),
                bounds,
            },
            other => Self::in_scenario(other),
        }
    }

    /// The answer to a client that asked for a scene with a scenario's changes.
    pub fn in_scenario(error: ObservatoryError) -> Self {
        match error {
            // The scene was ingested again since the scenario was painted.
            ObservatoryError::Change(error) => Self::Parameters(vec![FieldError {
                parameter: SCENARIO.name.to_owned(),
                value: None,
                allowed: "a scenario that can be painted over the scene as it is now".to_owned(),
                message: error.to_string(),
                code: ValidationCode::NotAllowed,
            }]),
            other => other.into(),
        }
    }

    /// The answer to a client that painted: what its scenario goes on from is named in the body.
    pub fn of_painting(error: ObservatoryError) -> Self {
        let (id, message) = match error {
            ObservatoryError::ChangeStore(ChangeStoreError::OtherScene { id, scene }) => {
                (id, format!("it belongs to scene \"{scene}\""))
            }
            ObservatoryError::ChangeStore(ChangeStoreError::TooDeep { id }) => {
                (id, "it stands on too many others, one upon the other".to_owned())
            }
            other => return other.into(),
        };
        let allowed = "a scenario or plan of this scene that stands on few others".to_owned();
        Self::parameter("base", id.to_string(), allowed, message, ValidationCode::NotAllowed)
    }

    /// A parameter outside what is resident.
    fn out_of_range(parameter: &str, value: String, allowed: String) -> Self {
        let code = ValidationCode::OutOfRange;
        Self::parameter(parameter, value, allowed, code.description().to_owned(), code)
    }
}

/// Refuses an eye that terrain and height together put above the tables.
///
/// # Errors
/// [`AppError::Parameters`] naming the height or the altitude.
pub fn check_altitude(request: &SkyRequest, ground: Ground, range_m: (f64, f64)) -> Result<(), AppError> {
    let altitude_m = request.observer_height.altitude_m(ground);
    if altitude_m > range_m.1 { Err(too_high(request.observer_height, altitude_m, range_m)) } else { Ok(()) }
}

/// Refuses the height or the altitude that puts an eye above the tables.
fn too_high(height: ObserverHeight, altitude_m: f64, (minimum_m, maximum_m): (f64, f64)) -> AppError {
    let (name, value_m, allowed) = match height {
        ObserverHeight::AboveSea(altitude_m) => {
            (ALTITUDE.name, altitude_m, format!("{minimum_m} to {maximum_m} m above sea level"))
        }
        ObserverHeight::AboveGround(height_m) => {
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
    AppError::out_of_range(name, value_m.to_string(), allowed)
}

/// Refuses clouds that an eye is in or above.
pub fn above_clouds(altitude_m: f64, base_m: u32, maximum_m: f64) -> AppError {
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

impl From<ObservatoryError> for AppError {
    fn from(error: ObservatoryError) -> Self {
        match error {
            ObservatoryError::Render(error) => of_render(error),
            // What the request itself asks for was checked when it was read.
            ObservatoryError::Emission(_) => Self::parameter(
                EMISSION_KEEP.name,
                EmissionKeep::NadirRadiance.name().to_owned(),
                "flux, or a scenario whose lights all have 0.01 or more of lambert".to_owned(),
                "lights of the scenario have too little light at the nadir to say their flux".to_owned(),
                ValidationCode::Conflict,
            ),
            ObservatoryError::OutsideScene { .. } => Self::internal("a place was checked without a place"),
            ObservatoryError::EmptyRegion => Self::parameter(
                REGION.name,
                "the curve".to_owned(),
                "a curve around some of the visible sky; directions are 1.4 degrees apart".to_owned(),
                "it holds no visible direction of the sky".to_owned(),
                ValidationCode::NotAllowed,
            ),
            ObservatoryError::NormBetweenClouds => Self::parameter(
                MEASURE.name,
                "norm".to_owned(),
                "zenith, mean, horizontal or region; or clouds without gaps".to_owned(),
                "the norm of a light's own image has no meaning between broken clouds".to_owned(),
                ValidationCode::Conflict,
            ),
            ObservatoryError::Scene(error) => match error {
                SceneError::UnknownScene { id } | SceneError::InvalidId { id } => {
                    Self::UnknownScene { id: echo(&id) }
                }
                SceneError::Damaged { scene, .. } => Self::DamagedScene { id: scene },
                SceneError::InvalidTile { .. } => Self::UnknownTile { reason: error.to_string() },
                SceneError::SkylinesBeingFound { progress, left_s } => Self::SkylinesBeingFound {
                    progress,
                    // A part of it is worth telling too.
                    retry_after_s: left_s.clamp(1.0, LONGEST_PAUSE_S).ceil() as u64,
                },
                SceneError::StoreAway { reason } => Self::StoreAway { reason },
                SceneError::TooLarge { .. } | SceneError::MapTooLarge { .. } => {
                    Self::SceneTooLarge { reason: error.to_string() }
                }
                other => Self::internal(other),
            },
            // Times, and whether there are tables for them, are checked when they are read.
            error @ (ObservatoryError::Celestial(_) | ObservatoryError::NoCelestialTables) => {
                Self::internal(error)
            }
            ObservatoryError::Change(error) => bad_edit(&error),
            ObservatoryError::ChangeStore(error) => of_change_store(error),
            ObservatoryError::BadPlan { reason } => Self::Parameters(vec![FieldError {
                parameter: "body".to_owned(),
                value: None,
                allowed: "a plan that can be made".to_owned(),
                message: reason,
                code: ValidationCode::NotAllowed,
            }]),
        }
    }
}

fn of_render(error: RenderError) -> AppError {
    match error {
        RenderError::Busy { .. } => AppError::Busy { retry_after_s: 1 },
        // Told to nobody.
        RenderError::Ended => AppError::EngineDown,
        RenderError::Stopped | RenderError::Device(_) => {
            tracing::error!(reason = %error, "engine down");
            AppError::EngineDown
        }
        RenderError::AltitudeOutOfRange { altitude_m, minimum_m, maximum_m } => {
            too_high(ObserverHeight::AboveSea(altitude_m), altitude_m, (minimum_m, maximum_m))
        }
        RenderError::AboveClouds { altitude_m, base_m, maximum_m } => {
            above_clouds(altitude_m, base_m, maximum_m)
        }
        RenderError::TurbidityOutOfRange { turbidity, minimum, maximum } => {
            AppError::out_of_range(TURBIDITY.name, turbidity.to_string(), format!("{minimum} to {maximum}"))
        }
        RenderError::BasisOutOfRange { basis, maximum } => AppError::out_of_range(
            BASIS.name,
            basis.to_string(),
            format!("a whole number from 1 to {maximum}"),
        ),
        RenderError::KindNotResident { kind, resident } => AppError::parameter(
            SCATTERING.name,
            kind.to_string(),
            resident.iter().map(PackKind::to_string).collect::<Vec<_>>().join(", "),
            ValidationCode::NotResident.description().to_owned(),
            ValidationCode::NotResident,
        ),
        // The rest is about starting an engine, or a defect.
        other => AppError::internal(other),
    }
}

fn of_change_store(error: ChangeStoreError) -> AppError {
    let of_scenario = |id: String, allowed: &str, message: String| {
        AppError::parameter(SCENARIO.name, id, allowed.to_owned(), message, ValidationCode::NotAllowed)
    };
    match error {
        ChangeStoreError::Unknown { id } => AppError::UnknownScenario { id: echo(id.as_str()) },
        ChangeStoreError::OtherScene { id, scene } => {
            of_scenario(id.to_string(), "one of this scene", format!("it belongs to scene \"{scene}\""))
        }
        ChangeStoreError::Stale { id, .. } => AppError::StalePlan { id: id.to_string() },
        ChangeStoreError::Draft { id } => AppError::DraftPlan { id: id.to_string() },
        ChangeStoreError::TooDeep { id } => of_scenario(
            id.to_string(),
            "one that stands on fewer others",
            "it stands on too many others, one upon the other".to_owned(),
        ),
        ChangeStoreError::NotOwner { id } => AppError::NotOwner { id: id.to_string() },
        ChangeStoreError::PinsFull => AppError::PinsFull,
        ChangeStoreError::Reading => AppError::Busy { retry_after_s: 2 },
        ChangeStoreError::Away(away) => AppError::StoreAway { reason: away.reason },
        ChangeStoreError::Io { .. } => AppError::Storage { reason: error.to_string() },
        ChangeStoreError::Damaged { .. } => AppError::internal(error),
    }
}
