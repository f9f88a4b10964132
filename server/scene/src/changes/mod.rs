//! Scenes with changed lights: edited in areas, or dimmed pixel by pixel by a reduction plan.
//!
//! A changed [`Scene`](crate::Scene) shares all that is untouched with the scene that it was made from; see
//! [`Scene::changed`](crate::Scene::changed).

mod area;
mod canvas;
mod change_id;
mod document;
mod drafts;
mod edits;
mod overlay;
mod store;
mod stored;

pub use area::{Area, AreaError, MAX_BRUSH_POINTS};
pub use canvas::{ChangeError, MAX_NEW_LIGHTS, MAX_NEW_LIGHTS_WITH_TERRAIN};
pub use change_id::ChangeId;
pub use edits::{Change, ChangeStep, Edit, MAX_EDITS, PixelFactors};
pub(crate) use overlay::Base;
pub use overlay::ChangeSummary;
pub use store::ChangeStore;
pub use stored::{ChangeKind, ChangeLimits, ChangeStoreError, MAX_CHANGE_DEPTH, Scenario, StoredPlan};
