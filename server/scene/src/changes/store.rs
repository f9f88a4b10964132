//! Scenarios and plans on disk: `<data>/scenarios/ID.json`; `<data>/plans/ID.json` beside `ID.bin` with its pixels.
//!
//! The JSON is written last and renamed into place, so a document is complete or absent. It carries BLAKE3 hashes of its content
//! and of the pixels; both are checked when they are read. The files are the truth; an index of them is in memory. What is too
//! much or too old is evicted; see [`ChangeLimits`] and [`Share`](super::shares::Share). Draft plans are held in memory; see
//! [`Drafts`].

use super::catalogue::Catalogue;
use super::change_id::{ChangeId, ChangeKind};
use super::document::{self, Head, damaged, io, unix_s};
use super::drafts::{DraftShelf, Drafts};
use super::edits::ChangeStep;
use super::listing::{Cursor, Listed, Page, Viewer};
use super::pixels;
use super::posting::Account;
use super::shared::Shared;
use super::store_key::StoreKey;
use super::stored::{ChangeLimits, ChangeStoreError, MAX_CHANGE_DEPTH, Scenario, StoredPlan};
use crate::scene_id::SceneId;
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};
use std::path::Path;
use std::sync::{Arc, Mutex};
use std::time::SystemTime;

/// A plan's JSON.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(super) struct PlanDocument {
    pub(super) scene: SceneId,
    pub(super) scene_version: String,
    pub(super) base: Option<ChangeId>,
    pub(super) answer: serde_json::Value,
    pub(super) pixels_blake3: String,
}

/// The folders of scenarios and plans.
#[derive(Clone, Debug)]
pub struct ChangeStore {
    pub(super) limits: ChangeLimits,
    pub(super) drafts: Drafts,
    pub(super) key: Arc<StoreKey>,
    pub(super) catalogue: Arc<Catalogue>,
    /// Held while files are put to their places or removed, and the index told.
    pub(super) writing: Arc<Mutex<()>>,
    /// What several servers share; its documents have copies in the folders.
    pub(super) shared: Option<Arc<Shared>>,
    /// Where servers have each other's drafts.
    pub(super) shelf: Option<Arc<dyn DraftShelf>>,
}

impl ChangeStore {
    /// The scenarios and plans of a data folder; the folder need not exist.
    pub fn new(data_dir: impl AsRef<Path>, limits: ChangeLimits) -> Self {
        let data_dir = data_dir.as_ref();
        let (key, catalogue) = (StoreKey::new(data_dir), Catalogue::new(data_dir, limits));
        Self {
            limits,
            drafts: Drafts::new(limits.draft_bytes),
            key: Arc::new(key),
            catalogue: Arc::new(catalogue),
            writing: Arc::default(),
            shared: None,
            shelf: None,
        }
    }

    /// Whether its limits are [`ChangeLimits::none`].
    pub fn has_no_limits(&self) -> bool {
        self.limits.is_none()
    }

    /// Looks through what is stored: the number of documents. Else the first who needs it waits for that. Meanwhile lists are
    /// refused, and the rest goes on.
    ///
    /// # Errors
    /// [`ChangeStoreError::Io`] where a folder cannot be read.
    pub fn read_index(&self) -> Result<usize, ChangeStoreError> {
        self.catalogue.read_beside()?;
        self.refresh()?;
        let count = |kind| self.catalogue.with(|index| index.ids(kind).count());
        Ok(count(ChangeKind::Scenario)? + count(ChangeKind::Plan)?)
    }

    /// Documents that were found damaged since this was asked last: they are in no list.
    pub fn take_damaged(&self) -> Vec<ChangeStoreError> {
        self.catalogue.take_damaged()
    }

    /// A scenario.
    ///
    /// # Errors
    /// [`ChangeStoreError`].
    pub fn scenario(&self, id: &ChangeId) -> Result<(Scenario, u64), ChangeStoreError> {
        self.read_document(id).map(|(scenario, head)| (scenario, head.created_unix_s))
    }

    /// Whether a stored document or a draft has that id, readable or not. Cheap.
    pub fn is_there(&self, id: &ChangeId) -> bool {
        self.is_stored(id) || self.draft(id).is_some()
    }

    /// Whether a document of that id is on disk and not past its age.
    pub fn is_stored(&self, id: &ChangeId) -> bool {
        let metadata = std::fs::metadata(self.catalogue.path(id, "json"));
        let is_past_age = |modified| self.is_past_age(modified) && !self.is_pinned(id) && !self.is_base(id);
        metadata.and_then(|metadata| metadata.modified()).is_ok_and(|modified| !is_past_age(modified))
    }

    fn is_past_age(&self, modified: SystemTime) -> bool {
        unix_s(SystemTime::now()).saturating_sub(unix_s(modified)) > self.limits.age.as_secs()
    }

    fn is_pinned(&self, id: &ChangeId) -> bool {
        self.head(id).is_ok_and(|head| head.posted.pinned)
    }

    /// Whether something stored is based on it: it stays with that.
    fn is_base(&self, id: &ChangeId) -> bool {
        self.in_index(|index| index.is_base(id)).ok().flatten().unwrap_or(false)
    }

    pub(super) fn head(&self, id: &ChangeId) -> Result<Head, ChangeStoreError> {
        document::read::<serde::de::IgnoredAny>(&self.catalogue.path(id, "json"), id).map(|(_, head)| head)
    }

    /// Refuses a draft as the base of a stored document, since it would expire.
    ///
    /// # Errors
    /// [`ChangeStoreError::Draft`].
    pub fn check_base(&self, base: Option<&ChangeId>) -> Result<(), ChangeStoreError> {
        if let Some(id) = base {
            self.fetch_missing(id)?;
        }
        match base {
            Some(id) if !self.is_stored(id) && self.is_there(id) => {
                Err(ChangeStoreError::Draft { id: id.clone() })
            }
            _ => Ok(()),
        }
    }

    /// Holds a draft plan in memory for some minutes under an id of [`Self::plan_id`].
    pub fn hold_plan(&self, id: &ChangeId, plan: StoredPlan, account: &Account) {
        let now_unix_s = unix_s(SystemTime::now());
        let networks = self.shelve(id, &plan, account, now_unix_s);
        self.drafts.hold(id, plan, networks, now_unix_s);
    }

    /// A plan, stored or draft, and since when, seconds since 1970.
    ///
    /// # Errors
    /// [`ChangeStoreError`].
    pub fn plan(&self, id: &ChangeId) -> Result<(StoredPlan, u64), ChangeStoreError> {
        // A draft that is at hand is not looked for elsewhere first.
        if self.shared.is_some()
            && !self.is_stored(id)
            && let Some(held) = self.draft(id)
        {
            return Ok((held.0.clone(), held.1));
        }
        match self.stored_plan(id) {
            Err(ChangeStoreError::Unknown { .. }) => match self.draft(id) {
                Some(held) => Ok(StoredPlan::clone(&held.0)).map(|plan| (plan, held.1)),
                None => Err(ChangeStoreError::Unknown { id: id.clone() }),
            },
            read => read,
        }
    }

    fn stored_plan(&self, id: &ChangeId) -> Result<(StoredPlan, u64), ChangeStoreError> {
        let (document, head): (PlanDocument, Head) = self.read_document(id)?;
        let path = self.catalogue.path(id, "bin");
        // Unknown where it was removed while it was read.
        let bytes = document::read_file(&path, id)?;
        if blake3::hash(&bytes).to_hex().as_str() != document.pixels_blake3 {
            return Err(damaged(&path)("was altered or is truncated (its checksum is wrong)".to_owned()));
        }
        let (factors, effects) = pixels::unpack(&bytes).map_err(damaged(&path))?;
        let PlanDocument { scene, scene_version, base, answer, .. } = document;
        Ok((StoredPlan { scene, scene_version, base, answer, factors, effects }, head.created_unix_s))
    }

    /// A plan's scene and answer, without its pixels, and when it was stored, seconds since 1970.
    ///
    /// # Errors
    /// [`ChangeStoreError`].
    pub fn plan_answer(&self, id: &ChangeId) -> Result<(SceneId, serde_json::Value, u64), ChangeStoreError> {
        let (document, head): (PlanDocument, Head) = self.read_document(id)?;
        Ok((document.scene, document.answer, head.created_unix_s))
    }

    /// All changes that an id stands for, one after the other.
    ///
    /// * `scene`, `scene_version`: what they are to be applied to.
    ///
    /// # Errors
    /// [`ChangeStoreError`].
    pub fn steps(
        &self,
        id: &ChangeId,
        scene: &SceneId,
        scene_version: &str,
    ) -> Result<Vec<ChangeStep>, ChangeStoreError> {
        let mut steps = Vec::new();
        let mut next = Some(id.clone());
        while let Some(id) = next {
            if steps.len() == MAX_CHANGE_DEPTH {
                return Err(ChangeStoreError::TooDeep { id });
            }
            let (of, step) = if id.is_plan() {
                let (plan, _) = self.plan(&id)?;
                if plan.scene == *scene && plan.scene_version != scene_version {
                    return Err(ChangeStoreError::Stale { id, scene: plan.scene });
                }
                next = plan.base;
                (plan.scene, ChangeStep::Dimmed(plan.factors))
            } else {
                let (scenario, _) = self.scenario(&id)?;
                next = scenario.base;
                (scenario.scene, ChangeStep::Painted(scenario.edits))
            };
            if of != *scene {
                return Err(ChangeStoreError::OtherScene { id, scene: of });
            }
            steps.push(step);
        }
        steps.reverse();
        Ok(steps)
    }

    /// All ids with the time of storage, seconds since 1970, the newest first.
    ///
    /// # Errors
    /// [`ChangeStoreError::Io`] where the folder cannot be read; [`ChangeStoreError::Reading`].
    pub fn list(&self, kind: ChangeKind) -> Result<Vec<(ChangeId, u64)>, ChangeStoreError> {
        self.refresh_where_due()?;
        self.catalogue.look_again(kind)?;
        self.catalogue.with(|index| index.list(kind, unix_s(SystemTime::now())))
    }

    /// Part of the list of a scene as somebody sees it, the newest first. What is damaged is left out.
    ///
    /// # Errors
    /// As [`Self::list`].
    pub fn page(
        &self,
        kind: ChangeKind,
        scene: &SceneId,
        viewer: &Viewer,
        after: Option<&Cursor>,
        limit: usize,
    ) -> Result<Page<Listed>, ChangeStoreError> {
        self.refresh_where_due()?;
        self.catalogue.look_again(kind)?;
        let now_s = unix_s(SystemTime::now());
        self.catalogue.with(|index| index.page(kind, scene, viewer, after, limit, now_s))
    }

    /// A document and what stands before it; unknown where it is past its age.
    pub(super) fn read_document<T: DeserializeOwned>(
        &self,
        id: &ChangeId,
    ) -> Result<(T, Head), ChangeStoreError> {
        self.fetch_missing(id)?;
        self.read_copy(id)
    }

    /// The same of what is in the folders alone.
    pub(super) fn read_copy<T: DeserializeOwned>(
        &self,
        id: &ChangeId,
    ) -> Result<(T, Head), ChangeStoreError> {
        let path = self.catalogue.path(id, "json");
        let (content, head) = document::read(&path, id)?;
        // A document based on it may have renewed it since.
        let modified =
            std::fs::metadata(&path).and_then(|metadata| metadata.modified()).map_err(io(&path))?;
        if self.is_past_age(modified) && !head.posted.pinned && !self.is_base(id) {
            return Err(ChangeStoreError::Unknown { id: id.clone() });
        }
        Ok((content, head))
    }
}
