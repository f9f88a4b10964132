//! A scene as it is when a request is prepared, and what it says of a place.

use crate::error::ObservatoryError;
use skyglow_physics::{EARTH_RADIUS_M, GeoPoint, source_pixel::MAX_SOURCE_DISTANCE_M};
use skyglow_scene::{Ground, Scene, SceneMetadata};
use std::{f64::consts::PI, sync::Arc};

/// Who comes again waits where skylines of so many lights are missing: what one place needs of them takes a second of two cores.
const FEW_LIGHTS: usize = 150_000;

/// A scene with its changes, resolved once when a request is prepared and passed down: a scene that is replaced meanwhile changes
/// no answer that is under way.
#[derive(Clone, Debug)]
pub struct SceneView {
    /// The scene without the scenario's changes.
    base: Arc<Scene>,
    scene: Arc<Scene>,
    metadata: Arc<SceneMetadata>,
    /// Whether who asks comes again instead of waiting for skylines.
    comes_again: bool,
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
        Self { base, scene, metadata, comes_again: false }
    }

    /// The same under another description.
    #[must_use]
    pub fn with_metadata(self, metadata: SceneMetadata) -> Self {
        Self { metadata: Arc::new(metadata), ..self }
    }

    /// The same for somebody who is told to come again ([`SceneError::SkylinesBeingFound`](skyglow_scene::SceneError)) where the
    /// skylines of the lights around a place take longer than a second to find.
    #[must_use]
    pub fn coming_again(self) -> Self {
        Self { comes_again: true, ..self }
    }

    /// Begins to find the skylines of the lights around a place where they are missing.
    ///
    /// # Errors
    /// [`ObservatoryError::Scene`] for who [comes again](Self::coming_again), until they are there.
    pub(crate) fn find_skylines(&self, place: GeoPoint, hides: bool) -> Result<(), ObservatoryError> {
        if hides && self.comes_again {
            self.scene.find_skylines_around(place, FEW_LIGHTS)?;
        }
        Ok(())
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

    /// Lit pixels that can lie within reach of a place, at most: those of the whole scene, or as many as have room there.
    pub fn max_lit_pixels_around(&self, place: GeoPoint) -> u64 {
        let [_, south_deg, _, north_deg] = self.metadata.bounds;
        let middle_deg = 0.5 * (south_deg + north_deg);
        let room = max_pixels_around(self.metadata.pixel_size_m, middle_deg, place.latitude_deg());
        self.metadata.lit_pixels.min(room)
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

/// Pixels that have room within reach of a place. Towards a pole they get narrower than in the middle of the raster, and in Mercator's
/// projection lower too.
fn max_pixels_around(pixel_size_m: f64, middle_deg: f64, latitude_deg: f64) -> u64 {
    // A disc on a sphere is smaller than this.
    let reach_m2 = PI * MAX_SOURCE_DISTANCE_M * MAX_SOURCE_DISTANCE_M;
    let farthest_deg = latitude_deg.abs() + (MAX_SOURCE_DISTANCE_M / EARTH_RADIUS_M).to_degrees();
    let narrow = farthest_deg.min(89.0).to_radians().cos() / middle_deg.to_radians().cos();
    let least_m2 = pixel_size_m * pixel_size_m * narrow.min(1.0).powi(2);
    // The cast saturates: what is not known is no bound.
    if least_m2 > 0.0 { (reach_m2 / least_m2).ceil() as u64 } else { u64::MAX }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Of Black Marble's pixels 1.3 million have room at the equator; more towards the poles; what is unknown is no bound.
    #[test]
    fn pixels_have_so_much_room() {
        let at = |latitude_deg| max_pixels_around(463.0, 0.0, latitude_deg);
        assert!((1_310_000..1_340_000).contains(&at(0.0)), "{}", at(0.0));
        assert!(at(60.0) > 4 * at(0.0) && at(-60.0) == at(60.0));
        assert_eq!(max_pixels_around(463.0, 60.0, 0.0), max_pixels_around(463.0, 60.0, 10.0));
        assert_eq!(max_pixels_around(f64::NAN, 0.0, 0.0), u64::MAX);
    }
}
