//! What can go wrong between a question about a place and its answer.

use skyglow_celestial::CelestialError;
use skyglow_physics::PhysicsError;
use skyglow_render::RenderError;
use skyglow_scene::{ChangeError, ChangeStoreError, SceneError};
use thiserror::Error;

/// Why an observatory does not answer.
#[derive(Debug, Error)]
pub enum ObservatoryError {
    /// The sky could not be rendered.
    #[error(transparent)]
    Render(#[from] RenderError),
    /// Lights whose emission does not say their flux, where the radiance at the nadir is kept.
    #[error(transparent)]
    Emission(PhysicsError),
    /// A curve on the sky that holds no direction of the panorama grid, or hidden ones alone.
    #[error("the curve holds no visible direction of the sky; directions are 1.4 degrees apart")]
    EmptyRegion,
    /// Norms of images of lights, between clouds: what a gap shows of a light hangs on all others.
    #[error("the norm of a light's own image has no meaning between broken clouds")]
    NormBetweenClouds,
    /// The place lies off the scene's raster.
    #[error(
        "{latitude_deg}, {longitude_deg} lies outside scene \"{scene}\" (west, south, east, north: {bounds:?} degrees)"
    )]
    OutsideScene {
        /// The scene's id.
        scene: String,
        /// Latitude asked for.
        latitude_deg: f64,
        /// Longitude asked for.
        longitude_deg: f64,
        /// West, south, east, north of the scene, degrees.
        bounds: [f64; 4],
    },
    /// A time, or a condition of the sky, that the heavens have no answer to.
    #[error(transparent)]
    Celestial(#[from] CelestialError),
    /// A sky of an instant without celestial tables.
    #[error(
        "there are no celestial tables beside the packs; `skyglow precompute --part celestial` makes them"
    )]
    NoCelestialTables,
    /// A scene that is not there or cannot be read.
    #[error(transparent)]
    Scene(#[from] SceneError),
    /// A plan that cannot be made.
    #[error("the plan cannot be made: {reason}")]
    BadPlan {
        /// Why.
        reason: String,
    },
    /// Changes that cannot be made to a scene.
    #[error(transparent)]
    Change(#[from] ChangeError),
    /// A scenario or plan that is not there or cannot be read or stored.
    #[error(transparent)]
    ChangeStore(#[from] ChangeStoreError),
}
