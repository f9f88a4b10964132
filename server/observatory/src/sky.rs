//! What is asked about a sky, and what is answered.

use skyglow_physics::{
    BAND_COUNT, EmissionMix, GeoPoint, Horizon, Lamp, LampPreset, SkyQuantities, Turbidity,
};
use skyglow_render::{packs::PackKind, request::Rendered};
use skyglow_scene::{ChangeId, Ground, SceneId, SceneMetadata};
use skyglow_tables::Scattering;
use std::time::Duration;

/// Where the observer's eye is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ObserverHeight {
    /// Metres above the ground, as [`Ground`] has it: above sea level where there is no terrain within 5 km.
    AboveGround(f64),
    /// Metres above sea level.
    AboveSea(f64),
}

/// One sky asked for.
#[derive(Clone, Debug, PartialEq)]
pub struct SkyRequest {
    /// The scene.
    pub scene: SceneId,
    /// The scenario or plan that changes its lights; None for the scene as it is.
    pub scenario: Option<ChangeId>,
    /// The place, in the scene.
    pub place: GeoPoint,
    /// Where the eye is.
    pub observer_height: ObserverHeight,
    /// Turbidity, in the resident range.
    pub turbidity: Turbidity,
    /// Orders of scattering, of which packs are resident.
    pub scattering: Scattering,
    /// Base of the layer of cloud above sea level, metres, of which packs are resident; None under a clear sky.
    pub cloud_base_m: Option<u32>,
    /// The lamp.
    pub lamp: Lamp,
    /// Where lamps send their light.
    pub emission: EmissionMix,
    /// Basis functions; None for all, or for as many as the tolerance needs.
    pub basis: Option<usize>,
    /// Relative difference that fewer functions may make where `basis` names no number; None for all functions.
    pub tolerance: Option<f64>,
    /// Whether the scene's terrain hides the sky below the observer's horizon.
    pub terrain_hides: bool,
}

impl SkyRequest {
    /// The kind of packs that it is rendered from.
    pub(crate) fn kind(&self) -> PackKind {
        PackKind { cloud_base_m: self.cloud_base_m, scattering: self.scattering }
    }
}

/// Where an answer was observed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Observer {
    /// Degrees north.
    pub latitude_deg: f64,
    /// Degrees east.
    pub longitude_deg: f64,
    /// Altitude used, metres above sea level, at least 0.
    pub altitude_m: f64,
    /// The ground there.
    pub ground: Ground,
}

/// What is at a place.
#[derive(Clone, Debug)]
pub struct SiteAnswer {
    /// The scene.
    pub scene: SceneMetadata,
    /// The ground there.
    pub ground: Ground,
    /// Radiance of the pixel there, nW cm⁻² sr⁻¹, without the calibration; None without data.
    pub radiance_nw_cm2_sr: Option<f64>,
}

/// A sky with everything that its numbers depend on.
#[derive(Clone, Debug)]
pub struct SkyAnswer {
    /// The scene as it was.
    pub scene: SceneMetadata,
    /// Where.
    pub observer: Observer,
    /// The panorama, dark below the horizon, and how it was made.
    pub rendered: Rendered,
    /// The observer's horizon; flat where terrain does not hide or the scene has none.
    pub horizon: Horizon,
    /// How long the horizon took; None where none was computed.
    pub horizon_time: Option<Duration>,
    /// Where a tolerance was given, the bound of the difference to the sky of all functions
    /// ([`BasisWithin::error_bound`](skyglow_render::BasisWithin::error_bound)).
    pub basis_error_bound: Option<f64>,
    /// Lamps that changes replace around here where there are none of them by then.
    pub lamps_not_met: Vec<LampPreset>,
    /// The reported quantities, of the sky above the horizon.
    pub quantities: SkyQuantities,
    /// Covered share of the 300 km disc, 0..=1.
    pub coverage: f64,
    /// The scene's calibration factor.
    pub calibration: f64,
    /// Vertical optical depth above the observer in R, G, B.
    pub local_optical_depth: [f64; BAND_COUNT],
    /// Upward flux within 300 km, DNB watts, calibration included.
    pub flux_dnb_w: f64,
    /// Turbidity used.
    pub turbidity: Turbidity,
    /// Orders of scattering used.
    pub scattering: Scattering,
    /// Lamp used.
    pub lamp: Lamp,
    /// Emission used.
    pub emission: EmissionMix,
}
