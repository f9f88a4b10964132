//! The numbers of a sky.

use super::Assumptions;
use serde::Serialize;
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
}
