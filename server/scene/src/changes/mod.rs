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

pub use area::{Area, AreaError, MOST_BRUSH_POINTS};
pub use change_id::ChangeId;
pub(crate) use gone::GoneLights;
pub use overlay::{ChangeError, ChangeSummary, MOST_NEW_LIGHTS, MOST_NEW_LIGHTS_AMONG_HILLS};
pub use painting::{Change, ChangeStep, Edit, MOST_EDITS, PixelFactors};
pub use store::ChangeStore;
pub use stored::{ChangeKind, ChangeLimits, ChangeStoreError, DEEPEST, Scenario, StoredPlan};
