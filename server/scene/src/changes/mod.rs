//! Scenes with changed lights: edited in areas, or dimmed pixel by pixel by a reduction plan.
//!
//! A changed [`Scene`](crate::Scene) shares all that is untouched with the scene that it was made from; see
//! [`Scene::changed`](crate::Scene::changed).

mod area;
mod canvas;
mod catalogue;
mod change_id;
mod document;
mod draft_shelf;
mod drafts;
mod edits;
mod index;
mod listing;
mod overlay;
mod pixels;
mod posting;
mod replica;
mod shared;
mod shares;
mod store;
mod store_key;
mod stored;
mod writing;

pub use area::{Area, AreaError, MAX_BRUSH_POINTS};
pub use canvas::{ChangeError, MAX_NEW_LIGHTS, MAX_NEW_LIGHTS_WITH_TERRAIN};
pub use change_id::{ChangeId, ChangeKind};
pub use drafts::DraftShelf;
pub use edits::{Change, ChangeStep, Edit, MAX_EDITS, PixelFactors};
pub use listing::{Cursor, Listed, Outline, Page, Viewer};
pub(crate) use overlay::Base;
pub use overlay::ChangeSummary;
pub use posting::{Account, NETWORK_TIERS, Owner, Posting};
pub use shared::{DocumentStore, StoredObject};
pub use store::ChangeStore;
pub use stored::{
    ChangeLimits, ChangeStoreError, MAX_CHANGE_DEPTH, MAX_DRAFT_BYTES, Scenario, StoreAway, StoredPlan,
};
