//! A scene as it is when a request is prepared, and what it says of a place.

use crate::error::ObservatoryError;
use skyglow_physics::GeoPoint;
use skyglow_scene::{Ground, Scene, SceneMetadata};
use std::sync::Arc;

/// A scene with its changes, resolved once when a request is prepared and passed down: a scene that is replaced meanwhile changes
/// no answer that is under way.
#[derive(Clone, Debug)]
pub struct SceneView {
    /// The scene without the scenario's changes.
    base: Arc<Scene>,
    scene: Arc<Scene>,
    metadata: Arc<SceneMetadata>,
}

/// What is at a place.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Site {
    /// The ground there.
    pub ground: Ground,
    /// Radiance of the pixel there, nW cm⁻² sr⁻¹, without the calibration; None without data.
    pub radiance_nw_cm2_sr: Option<f64>,
}

impl SceneView {
    /// * `base`: the scene itself.
    /// * `scene`: the same with its changes.
    pub fn new(base: Arc<Scene>, scene: Arc<Scene>) -> Self {
        let metadata = Arc::new(scene.metadata().clone());
        Self { base, scene, metadata }
    }

    /// The same under another description.
    #[must_use]
    pub fn with_metadata(self, metadata: SceneMetadata) -> Self {
        Self { metadata: Arc::new(metadata), ..self }
    }

    /// The scene without the scenario's changes.
    pub fn base(&self) -> &Arc<Scene> {
        &self.base
    }

    /// The scene with its changes.
    pub fn scene(&self) -> &Arc<Scene> {
        &self.scene
    }

    /// The description of the scene, with the version that its changes make.
    pub fn metadata(&self) -> &SceneMetadata {
        &self.metadata
    }

    /// Hash over all that the scene holds, its changes included.
    pub fn version(&self) -> &str {
        &self.metadata.version
    }

    /// What is at a place.
    ///
    /// # Errors
    /// [`ObservatoryError::OutsideScene`].
    pub fn site(&self, place: GeoPoint) -> Result<Site, ObservatoryError> {
        if !self.scene.contains(place) {
            return Err(ObservatoryError::OutsideScene {
                scene: self.metadata.id.to_string(),
                latitude_deg: place.latitude_deg(),
                longitude_deg: place.longitude_deg(),
                bounds: self.metadata.bounds,
            });
        }
        let radiance_nw_cm2_sr = self.scene.radiance_nw_cm2_sr(place);
        Ok(Site { ground: self.scene.ground(place), radiance_nw_cm2_sr })
    }
}
