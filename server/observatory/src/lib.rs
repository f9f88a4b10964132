//! From a place in a scene to its sky, to which lights cause it, and to what to dim. No device, no HTTP.

pub mod brightness;
mod brightness_request;
mod cache_sizes;
mod change;
mod clean_directions;
mod coarse_places;
mod dark_through_gaps;
mod darker;
pub mod error;
mod ground_light;
pub mod influence;
mod influence_cache;
mod influence_map;
mod influence_part;
mod influence_summary;
mod lights_under_clouds;
mod map_measure;
mod natural_places;
pub mod night_sky;
mod observatory;
mod place_sums;
mod plan_request;
mod plan_target;
pub mod reduction;
mod reduction_plan;
mod scene_cache;
mod scene_health;
mod scene_view;
mod shares;
mod sky;
mod sky_at_times;
mod sky_below;
mod sky_light;
mod slope_light;
mod surroundings;
mod watch;
mod water;

pub use brightness::{BrightnessMap, MAX_PLACES, PreparedBrightness};
pub use brightness_request::{BrightnessRequest, EYE_HEIGHT_M, MapLight};
pub use cache_sizes::CacheSizes;
pub use change::{ScenarioRecord, store_scenario};
pub use clean_directions::{LowSky, low_sky};
pub use darker::{DarkerPlace, DarkerPlaces, DarkerRequest, Footing};
pub use error::ObservatoryError;
pub use ground_light::{GroundRequest, lit_ground};
pub use influence::{CellInfluence, InfluenceSolver, MeasureOfCells, SeenMeasure, influence_of_pixels};
pub use influence_map::{InfluenceMap, InfluenceRequest, Measure};
pub use influence_part::Part;
pub use influence_summary::{RING_EDGES_M, SECTOR_COUNT};
pub use lights_under_clouds::LightsUnderClouds;
pub use map_measure::MapMeasure;
pub use night_sky::{ComponentSky, NightSky, SkyTime};
pub use observatory::{OPEN_SCENE_COUNT, Observatory};
pub use plan_request::{
    DimmedPixel, Level, Limit, PlanMethod, PlanOutcome, PlanRequest, SiteOutcome, SitePlan, SkyState,
    TargetSite,
};
pub use scene_view::{SceneView, Site};
pub use shares::{Shares, TOWN_REACH, town_radius_m};
pub use sky::{ObserverHeight, RenderContext, RenderedSky, SkyRequest};
pub use sky_at_times::{HORIZON_ENDS_DEG, SkyAtTime};
pub use watch::Watch;
