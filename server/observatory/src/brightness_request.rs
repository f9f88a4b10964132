//! What is asked of a map of a scene's brightness.

use crate::{map_measure::MapMeasure, night_sky::SkyTime};
use serde::Serialize;
use skyglow_physics::{Emission, Lamp, Response, Turbidity};
use skyglow_render::pack_kind::PackKind;
use skyglow_scene::{ChangeId, SceneId};
use skyglow_tables::Scattering;

/// The observer's eye above the ground, metres.
pub const EYE_HEIGHT_M: f64 = 2.0;
/// Which light a map shows.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub enum MapLight {
    /// Artificial light alone.
    #[default]
    Artificial,
    /// With the natural sky of an instant, or else with the dark reference.
    Total(Option<SkyTime>),
}

/// A request for one map of brightness: under a clear sky or a closed layer of cloud, two metres above the ground.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct BrightnessRequest {
    /// The scene.
    pub scene: SceneId,
    /// The scenario or plan that changes its lights; None for the scene as it is.
    pub scenario: Option<ChangeId>,
    /// Turbidity, in the resident range.
    pub turbidity: Turbidity,
    /// Orders of scattering, of which packs are resident.
    pub scattering: Scattering,
    /// Base of a closed layer of cloud, metres above sea level, of which packs are resident; None under a clear sky.
    pub cloud_base_m: Option<u32>,
    /// The lamp.
    pub lamp: Lamp,
    /// What of the sky.
    pub measure: MapMeasure,
    /// Which light.
    pub light: MapLight,
    /// What sees the sky.
    pub response: Response,
    /// Where lamps send their light, and what of them the satellite's radiance says.
    pub emission: Emission,
    /// Whether terrain hides the low light of lamps behind it.
    pub terrain_hides: bool,
    /// Places at most; beyond, pixels share one by blocks.
    pub max_places: usize,
}

impl BrightnessRequest {
    pub(crate) fn kind(&self) -> PackKind {
        PackKind { cloud_base_m: self.cloud_base_m, scattering: self.scattering }
    }
}
