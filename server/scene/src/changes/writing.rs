//! Scenarios and plans put on disk, renewed, evicted and removed.
//!
//! Files are written beside their places before anybody is kept waiting; a lock is held while they are renamed and the index is
//! told. No folder is looked through.

use super::change_id::{ChangeId, ChangeKind};
use super::document::{self, Head, io, to_json, unix_ns, unix_s};
use super::index::{Entry, Index};
use super::listing::Outlined;
use super::pixels;
use super::posting::{Owner, Posted, Posting};
use super::store::{ChangeStore, PlanDocument};
use super::stored::{ChangeStoreError, MAX_CHANGE_DEPTH, Scenario, StoredPlan};
use serde::Serialize;
use serde::de::DeserializeOwned;
use std::io::ErrorKind;
use std::sync::PoisonError;
use std::time::SystemTime;

impl ChangeStore {
    /// Stores a scenario for nobody in particular, in the lists.
    ///
    /// # Errors
    /// As [`Self::store_scenario_as`].
    pub fn store_scenario(&self, scenario: &Scenario) -> Result<ChangeId, ChangeStoreError> {
        self.store_scenario_as(scenario, &Posting::default()).map(|(id, _)| id)
    }

    /// Stores a scenario, and whether it is new. One that is stored already stays whose it is, and is renewed.
    ///
    /// # Errors
    /// [`ChangeStoreError::Io`]; [`ChangeStoreError::Draft`] where it is based on a draft; [`ChangeStoreError::PinsFull`].
    pub fn store_scenario_as(
        &self,
        scenario: &Scenario,
        posting: &Posting,
    ) -> Result<(ChangeId, bool), ChangeStoreError> {
        self.check_base(scenario.base.as_ref())?;
        let id = self.scenario_id(scenario, posting)?;
        let is_new = self.store(&id, scenario.into(), scenario, None, posting)?;
        Ok((id, is_new))
    }

    /// The id that a scenario has.
    ///
    /// # Errors
    /// [`ChangeStoreError::Io`].
    pub fn scenario_id(&self, scenario: &Scenario, posting: &Posting) -> Result<ChangeId, ChangeStoreError> {
        let content = to_json(&self.catalogue.folder(ChangeKind::Scenario), scenario)?;
        Ok(ChangeId::of_scenario(&self.decides(content, posting)?))
    }

    /// The id of a listed plan with this content, which must include all of its inputs.
    pub fn plan_id(content: &[u8]) -> ChangeId {
        ChangeId::of_plan(content)
    }

    /// The id of a plan with this content, which must include all of its inputs.
    ///
    /// # Errors
    /// [`ChangeStoreError::Io`].
    pub fn plan_id_as(&self, content: Vec<u8>, posting: &Posting) -> Result<ChangeId, ChangeStoreError> {
        Ok(ChangeId::of_plan(&self.decides(content, posting)?))
    }

    /// What an id is a hash of: of what is not listed the owner too, with a key, so that nobody finds it by its content.
    fn decides(&self, content: Vec<u8>, posting: &Posting) -> Result<Vec<u8>, ChangeStoreError> {
        if posting.listed {
            return Ok(content);
        }
        let owner = posting.owner.map(Owner::to_hex).unwrap_or_default();
        let content = [owner.as_bytes(), &content].concat();
        Ok(blake3::keyed_hash(self.key.get()?, &content).as_bytes().to_vec())
    }

    /// Writes a document and puts it in its place. False where it is there already.
    fn store<T: Serialize + DeserializeOwned>(
        &self,
        id: &ChangeId,
        outlined: Outlined,
        content: &T,
        pixels: Option<&[u8]>,
        posting: &Posting,
    ) -> Result<bool, ChangeStoreError> {
        let path = self.catalogue.path(id, "json");
        let now = SystemTime::now();
        let (before, is_replaced) = self.head_before::<T>(id)?;
        let is_new = before.is_none();
        let mut head = match before {
            Some(head) => head,
            None => {
                let created_ns = (unix_ns(now) % 1_000_000_000) as u32;
                let posted = Posted::new(posting, self.key.get()?, created_ns);
                Head { created_unix_s: unix_s(now), posted }
            }
        };
        let is_pinned_now =
            posting.pinned && !head.posted.pinned && head.posted.is_of(posting.owner.as_ref());
        head.posted.pinned |= is_pinned_now;
        if !is_new && !is_pinned_now {
            let _writing = self.writing.lock().unwrap_or_else(PoisonError::into_inner);
            self.renew(Some(id));
            return Ok(false);
        }
        let text = document::bytes_of(&path, &head, content)?;
        let bytes = (text.len() + pixels.map_or(0, <[u8]>::len)) as u64;
        let is_pin = head.posted.pinned && (is_new || is_pinned_now);
        let check_pins =
            || match !is_pin || self.in_index(|index| index.may_pin(id.kind(), bytes))?.unwrap_or(true) {
                true => Ok(()),
                false => Err(ChangeStoreError::PinsFull),
            };
        if let Some(shared) = &self.shared {
            check_pins()?;
            // Somebody else may have stored the same at another server meanwhile: it is theirs.
            if !shared.publish(id, &text, pixels, is_new && !is_replaced)? {
                self.fetch(id)?;
                let _writing = self.writing.lock().unwrap_or_else(PoisonError::into_inner);
                self.renew(Some(id));
                return Ok(false);
            }
        }
        // Files are written before anybody is kept waiting, pixels and all.
        let pixels = pixels.map(|pixels| document::write_beside(self.catalogue.path(id, "bin"), pixels));
        let (pixels, text_file) = (pixels.transpose()?, document::write_beside(path.clone(), &text)?);
        let writing = self.writing.lock().unwrap_or_else(PoisonError::into_inner);
        // Somebody else may have stored the same meanwhile: it is theirs.
        if is_new && self.shared.is_none() && self.read_copy::<T>(id).is_ok() {
            self.renew(Some(id));
            return Ok(false);
        }
        if self.shared.is_none() {
            check_pins()?;
        }
        pixels.map_or(Ok(()), document::Unfinished::put)?;
        text_file.put()?;
        let modified = std::fs::metadata(&path).and_then(|metadata| metadata.modified()).unwrap_or(now);
        let base = outlined.base.clone();
        let entry = Entry {
            id: id.clone(),
            base: None,
            listed: None,
            created_unix_ns: head.created_unix_ns(),
            posted: head.posted,
            modified_unix_ns: unix_ns(modified),
            document_bytes: text.len() as u64,
            bytes,
        };
        let entry = entry.outlined(outlined);
        self.catalogue.note(&entry);
        self.in_index(|index| index.put(entry))?;
        self.renew(base.as_ref());
        let gone = self.evict(id)?;
        drop(writing);
        for (id, pixels) in gone {
            // Where the store keeps it, it comes back, and goes when the next is stored.
            let _best_effort = self.shared.as_ref().map(|shared| shared.remove(&id, pixels.as_deref()));
        }
        document::sync_folder(&self.catalogue.folder(id.kind()))?;
        Ok(is_new)
    }

    /// Does something with the index, but for programs beside a server, which applies its limits itself, and while it is read.
    pub(super) fn in_index<T>(
        &self,
        work: impl FnOnce(&mut Index) -> T,
    ) -> Result<Option<T>, ChangeStoreError> {
        if self.limits.is_none() {
            return Ok(None);
        }
        match self.catalogue.with(work) {
            Err(ChangeStoreError::Reading) => Ok(None),
            done => done.map(Some),
        }
    }

    /// Renews the age of a document and the whole chain of its bases.
    fn renew(&self, id: Option<&ChangeId>) {
        let mut next = id.cloned();
        for _ in 0..=MAX_CHANGE_DEPTH {
            let Some(id) = next else { return };
            if let Some(shared) = &self.shared {
                shared.note_renewed(&id);
            }
            let now = SystemTime::now();
            let file = std::fs::File::options().write(true).open(self.catalogue.path(&id, "json"));
            // If it is removed meanwhile, the next request for it fails.
            let _best_effort = file.and_then(|file| file.set_modified(now));
            let known = self.in_index(|index| {
                index.renew(&id, unix_ns(now));
                index.get(&id).cloned()
            });
            next = match known {
                Ok(Some(Some(entry))) => {
                    self.catalogue.note(&entry);
                    entry.base
                }
                _ => self.base_of(&id),
            };
        }
    }

    fn base_of(&self, id: &ChangeId) -> Option<ChangeId> {
        match id.kind() {
            ChangeKind::Plan => self.read_copy::<PlanDocument>(id).ok()?.0.base,
            ChangeKind::Scenario => self.read_copy::<Scenario>(id).ok()?.0.base,
        }
    }

    /// Removes documents beyond the limits, never `newest`: which, and the hash of the pixels of each.
    fn evict(&self, newest: &ChangeId) -> Result<Vec<(ChangeId, Option<String>)>, ChangeStoreError> {
        let gone = self.in_index(|index| {
            let (now_s, mut gone) = (unix_s(SystemTime::now()), Vec::new());
            index.withdraw(newest);
            while let Some(id) = index.next_to_go(newest, now_s) {
                index.take(&id);
                gone.push(id);
            }
            index.offer(newest);
            gone
        })?;
        let remove = |id: ChangeId| {
            let pixels = self.pixels_of(&id);
            self.remove_files(&id);
            (id, pixels)
        };
        Ok(gone.into_iter().flatten().map(remove).collect())
    }

    pub(super) fn remove_files(&self, id: &ChangeId) {
        // The document first: pixels without it count as removed.
        for extension in ["json", "bin"] {
            let _may_be_gone_already = std::fs::remove_file(self.catalogue.path(id, extension));
        }
    }

    /// Removes a scenario or plan. What is based on it cannot be had any more.
    ///
    /// * `owner`: who asks for it; None for the operator, who may always.
    ///
    /// # Errors
    /// [`ChangeStoreError::NotOwner`], [`ChangeStoreError::Unknown`], also of drafts, which go by themselves;
    /// [`ChangeStoreError::Io`].
    pub fn remove(&self, id: &ChangeId, owner: Option<&Owner>) -> Result<(), ChangeStoreError> {
        self.fetch_missing(id)?;
        if !self.is_stored(id) {
            return Err(ChangeStoreError::Unknown { id: id.clone() });
        }
        if owner.is_some() && !self.head(id)?.posted.is_of(owner) {
            return Err(ChangeStoreError::NotOwner { id: id.clone() });
        }
        if let Some(shared) = &self.shared {
            shared.remove(id, self.pixels_of(id).as_deref())?;
        }
        let path = self.catalogue.path(id, "json");
        let writing = self.writing.lock().unwrap_or_else(PoisonError::into_inner);
        match std::fs::remove_file(&path) {
            // Its copy went with it.
            Err(error) if error.kind() == ErrorKind::NotFound && self.shared.is_some() => {}
            removed => removed.map_err(io(&path))?,
        }
        self.remove_files(id);
        self.in_index(|index| index.take(id))?;
        drop(writing);
        document::sync_folder(&self.catalogue.folder(id.kind()))
    }

    /// Stores a plan for nobody in particular, in the lists.
    ///
    /// # Errors
    /// As [`Self::store_plan_as`].
    pub fn store_plan(&self, id: &ChangeId, plan: &StoredPlan) -> Result<(), ChangeStoreError> {
        self.store_plan_as(id, plan, &Posting::default()).map(drop)
    }

    /// Stores a plan under an id of [`Self::plan_id_as`], and whether it is new. One that is stored already stays whose it is.
    ///
    /// # Errors
    /// As [`Self::store_scenario_as`].
    pub fn store_plan_as(
        &self,
        id: &ChangeId,
        plan: &StoredPlan,
        posting: &Posting,
    ) -> Result<bool, ChangeStoreError> {
        self.check_base(plan.base.as_ref())?;
        let pixels = pixels::pack(plan).map_err(io(&self.catalogue.path(id, "bin")))?;
        let document = PlanDocument {
            scene: plan.scene.clone(),
            scene_version: plan.scene_version.clone(),
            base: plan.base.clone(),
            answer: plan.answer.clone(),
            pixels_blake3: blake3::hash(&pixels).to_hex().to_string(),
        };
        self.store(id, plan.into(), &document, Some(&pixels), posting)
    }
}
