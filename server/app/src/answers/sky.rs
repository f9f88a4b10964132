//! The numbers of a sky.

use super::{Assumptions, NightSkyAnswer};
use serde::Serialize;
use skyglow_observatory::RenderedSky;
use skyglow_physics::SkyQuantities;
use utoipa::ToSchema;

/// The numbers alone.
#[derive(Clone, Debug, Serialize, ToSchema)]
pub struct SkyAnswer {
    /// What they depend on.
    #[serde(flatten)]
    pub assumptions: Assumptions,
    /// The numbers.
    pub sky: SkyQuantities,
    /// What the natural sky of the time is made of; absent where no time was asked for, and under clouds.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub night_sky: Option<NightSkyAnswer>,
}

impl SkyAnswer {
    /// The answer for a rendered sky.
    pub fn new(assumptions: Assumptions, sky: &RenderedSky) -> Self {
        Self { assumptions, sky: sky.quantities.clone(), night_sky: NightSkyAnswer::of(sky) }
    }
}
