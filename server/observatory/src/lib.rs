//! From a place in a scene to its sky, to which lights cause it, and to what to dim. No device, no HTTP.

pub mod brightness;
mod change;
pub mod error;
pub mod influence;
mod influence_map;
mod influence_summary;
mod observatory;
pub mod reduction;
mod reduction_plan;
mod scene_cache;
mod scene_view;
mod sky;

pub use brightness::{BrightnessMap, BrightnessRequest, EYE_HEIGHT_M, MAX_PLACES};
pub use change::store_scenario;
pub use error::ObservatoryError;
pub use influence::{CellInfluence, InfluenceSolver, MeasureOfCells, influence_of_pixels};
pub use influence_map::{InfluenceMap, InfluenceRequest, Measure};
pub use influence_summary::{Part, RING_EDGES_M, SECTOR_COUNT};
pub use observatory::{OPEN_SCENE_COUNT, Observatory};
pub use reduction_plan::{
    DimmedPixel, Level, Limit, PlanMethod, PlanOutcome, PlanRequest, SiteOutcome, SitePlan, SkyState,
    TargetSite,
};
pub use sky::{Observer, ObserverHeight, SiteAnswer, SkyAnswer, SkyRequest};
