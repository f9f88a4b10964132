//! The JSON answers and their schemas.

mod assumptions;
mod brightness;
mod compact;
mod dark_reference;
mod darker;
mod influence;
mod night_hours;
mod night_sky;
mod panorama;
mod plan;
mod scenario;
mod scene;
mod service;
mod shares;
mod site;
mod skies;
mod sky;
pub mod standards;

pub use assumptions::{Assumptions, EmissionAnswer, LampAnswer, ObserverAnswer, ResponseAnswer};
pub use brightness::{BrightnessAssumptions, brightness_shows};
pub use compact::{CompactDisc, CompactHeader, CompactPlane, CompactPoints, compact_panorama};
pub use dark_reference::DarkReferenceAnswer;
pub use darker::{DarkerAnswer, DarkerPlaceAnswer, LowSkyAnswer, NearestPlace, PlaceSky};
pub use influence::{
    InfluenceAnswer, InfluentialPixel, PartAnswer, RingAnswer, SectorAnswer, influential_pixels, measure_name,
};
pub use night_hours::{NightHourAnswer, NightHoursAnswer};
pub use night_sky::{ComponentAnswer, DirectionLimitAnswer, NightSkyAnswer};
pub use panorama::{Light, PanoramaAnswer, PanoramaGrid};
pub use plan::{
    DimmedPixelAnswer, PlanAnswer, PlanEntry, PlanFacts, PlannedSite, TargetAnswer, dimmed_pixels, plan_facts,
};
pub use scenario::{EditAnswer, ScenarioAnswer, ScenarioEntry};
pub use scene::{GridAnswer, SceneAnswer, SceneReference};
pub use service::{AtmosphereAnswer, HealthAnswer, TileJson};
pub use shares::{AreaShare, AreaSharesAnswer, PlaceShare, SharesAnswer};
pub use site::SiteAnswer;
pub use skies::SkyLine;
pub use sky::SkyAnswer;
