//! What a map shows, and what was found of it.

use clap::ValueEnum;
use skyglow_scene::{PlaceValues, Scene};
use std::sync::Arc;

/// What a map shows.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(super) enum MapLayer {
    /// The artificial light of the sky over every place: at the zenith, or by `--measure`.
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
    pub(super) unit: String,
    pub(super) description: String,
    /// Ends of the colours of a map of brightness.
    pub(super) colour_range: (f64, f64),
    /// JSON.
    pub(super) assumptions: String,
    /// Of a map of brightness: its key and its parameters, by which a server knows its tiles.
    pub(super) asked: Option<[String; 2]>,
}
