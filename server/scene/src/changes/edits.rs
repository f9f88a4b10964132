//! The edits that change the lights of a scene.

use super::area::Area;
use serde::{Deserialize, Serialize};
use skyglow_physics::{EmissionMix, Lamp, LampChange};

/// Most edits of a scenario.
pub const MAX_EDITS: usize = 100;

/// What an edit does to the lights in its area.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Change {
    /// Changes the existing lights.
    Alter {
        /// Factor on their radiance, at least 0.
        factor: f64,
        /// Other lamps.
        lamp: Option<LampChange>,
        /// Where they send their light; None for as before.
        emission: Option<EmissionMix>,
    },
    /// Adds light to every pixel, lit or dark.
    Add {
        /// Radiance that the satellite would see, nW cm⁻² sr⁻¹, above 0.
        radiance_nw_cm2_sr: f64,
        /// Its lamps; None for those of the request.
        lamp: Option<Lamp>,
        /// Where they send their light; None for that of the request.
        emission: Option<EmissionMix>,
    },
}

/// A change in an area. The lights in it are those of the pixels whose centre is in it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Edit {
    /// Where.
    pub area: Area,
    /// What.
    pub change: Change,
}

/// Factors on the radiance of single pixels, as a plan has them.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PixelFactors {
    /// Codes of the pixels ([`Scene::pixel_code`](crate::Scene::pixel_code)), ascending.
    pub codes: Vec<u64>,
    /// Factors in parallel with the codes, 0..=1.
    pub factors: Vec<f32>,
}

/// Edits and factors, one after the other.
#[derive(Clone, Debug, PartialEq)]
pub enum ChangeStep {
    /// Painted.
    Painted(Vec<Edit>),
    /// Dimmed pixel by pixel.
    Dimmed(PixelFactors),
}
