//! What a map shows, and what was found of it.

use clap::ValueEnum;
use skyglow_physics::Response;
use skyglow_scene::{PlaceValues, Scene};
use std::sync::Arc;

/// What a map shows.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(super) enum MapLayer {
    /// The artificial luminance at the zenith of every place.
    Brightness,
    /// The scene's lights.
    Radiance,
    /// The ground.
    Elevation,
}

/// What is found, and what is said of it.
pub(super) struct Found {
    pub(super) scene: Arc<Scene>,
    pub(super) places: PlaceValues,
    pub(super) unit: &'static str,
    pub(super) description: String,
    /// What sees the sky of a map of brightness.
    pub(super) response: Response,
    /// JSON.
    pub(super) assumptions: String,
}
