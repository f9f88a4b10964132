//! Scenes with changed lights: painted by people, or dimmed by a plan.
//!
//! A changed [`Scene`](crate::Scene) shares all that is untouched with the scene that it was made of; see
//! [`Scene::changed`](crate::Scene::changed).

mod area;
mod change_id;
mod drafts;
mod gone;
mod overlay;
mod painting;
mod store;
mod stored;

pub use area::{Area, AreaError, MAX_BRUSH_POINTS};
pub use change_id::ChangeId;
pub(crate) use gone::GoneLights;
pub use overlay::{ChangeError, ChangeSummary, MAX_NEW_LIGHTS, MAX_NEW_LIGHTS_WITH_TERRAIN};
pub use painting::{Change, ChangeStep, Edit, MAX_EDITS, PixelFactors};
pub use store::ChangeStore;
pub use stored::{ChangeKind, ChangeLimits, ChangeStoreError, MAX_CHANGE_DEPTH, Scenario, StoredPlan};
