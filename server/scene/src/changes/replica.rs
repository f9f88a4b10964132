//! A store of scenarios and plans beside others over one object store: what it lacks is fetched, what is gone there goes here.

use super::change_id::{ChangeId, ChangeKind};
use super::document::{self, Head, io, unix_ns};
use super::drafts::Drafts;
use super::index::Entry;
use super::shared::{DocumentStore, Shared, name_of, name_of_pixels};
use super::store::ChangeStore;
use super::store_key::StoreKey;
use super::stored::{ChangeLimits, ChangeStoreError};
use serde::Deserialize;
use serde::de::DeserializeOwned;
use std::collections::HashMap;
use std::io::ErrorKind;
use std::path::Path;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Arc, PoisonError};
use std::time::{Duration, SystemTime, UNIX_EPOCH};

/// Age from which a list is compared with the store's before it is shown.
const LISTS_ARE_FRESH_FOR: Duration = Duration::from_secs(1);
/// Documents that are fetched at a time.
const FETCHED_AT_ONCE: usize = 16;
/// What a document may be older here than there: the clocks of files and objects do not have the same steps.
const SAME_TIME_NS: u64 = 2_000_000_000;

/// What a plan says of its pixels.
#[derive(Deserialize)]
struct PixelsPart {
    pixels_blake3: String,
}

impl ChangeStore {
    /// The scenarios and plans of an object store, with copies in a data folder.
    ///
    /// # Errors
    /// [`ChangeStoreError::Away`] where it cannot be read and written.
    pub fn in_store(
        data_dir: &Path,
        limits: ChangeLimits,
        store: Arc<dyn DocumentStore>,
    ) -> Result<Self, ChangeStoreError> {
        let mark = &blake3::hash(store.address().as_bytes()).to_hex()[..16];
        let shared = Shared::new(store);
        let key = StoreKey::known(shared.key()?);
        Ok(Self {
            drafts: Drafts::new(limits.draft_bytes),
            key: Arc::new(key),
            shared: Some(Arc::new(shared)),
            ..Self::new(data_dir.join("copies").join(mark), limits)
        })
    }

    /// Compares what is here with the store: fetches what is new there, lets go of what is gone. Nothing to do without a store.
    ///
    /// # Errors
    /// [`ChangeStoreError::Away`], [`ChangeStoreError::Reading`].
    pub fn refresh(&self) -> Result<(), ChangeStoreError> {
        let Some(shared) = &self.shared else { return Ok(()) };
        let refreshed = shared.refreshed();
        self.refresh_from(shared)?;
        shared.note_refreshed(refreshed);
        Ok(())
    }

    /// The same where that is a while ago, for lists.
    pub(super) fn refresh_where_due(&self) -> Result<(), ChangeStoreError> {
        let Some(shared) = &self.shared else { return Ok(()) };
        let refreshed = shared.refreshed_once().ok_or(ChangeStoreError::Reading)?;
        if refreshed.is_none_or(|at| at.elapsed() >= LISTS_ARE_FRESH_FOR) {
            self.refresh_from(shared)?;
            shared.note_refreshed(refreshed);
        }
        Ok(())
    }

    fn refresh_from(&self, shared: &Shared) -> Result<(), ChangeStoreError> {
        shared.check()?;
        shared.write_renewed()?;
        for kind in [ChangeKind::Scenario, ChangeKind::Plan] {
            // The index first: what is put into it meanwhile is not looked for in a list that is older.
            let known: HashMap<ChangeId, u64> = self.catalogue.with(|index| {
                index.entries(kind).map(|entry| (entry.id.clone(), entry.modified_unix_ns)).collect()
            })?;
            let there = shared.list(kind)?;
            self.fetch_all(there.keys().filter(|id| !known.contains_key(id)).collect())?;
            for (id, modified_unix_ns) in &known {
                match there.get(id) {
                    None => self.forget(id)?,
                    // It was pinned.
                    Some(times) if times.written_unix_ns > modified_unix_ns.saturating_add(SAME_TIME_NS) => {
                        self.fetch(id)?;
                    }
                    Some(times) if times.renewed_unix_ns > modified_unix_ns.saturating_add(SAME_TIME_NS) => {
                        self.take_time(id, times.renewed_unix_ns)?;
                    }
                    Some(_) => {}
                }
            }
        }
        Ok(())
    }

    fn fetch_all(&self, ids: Vec<&ChangeId>) -> Result<(), ChangeStoreError> {
        let next = AtomicUsize::new(0);
        let work = || -> Result<(), ChangeStoreError> {
            while let Some(id) = ids.get(next.fetch_add(1, Ordering::Relaxed)) {
                self.fetch(id)?;
            }
            Ok(())
        };
        std::thread::scope(|scope| {
            let threads: Vec<_> = (0..FETCHED_AT_ONCE.min(ids.len())).map(|_| scope.spawn(work)).collect();
            threads.into_iter().try_for_each(|thread| match thread.join() {
                Ok(done) => done,
                Err(panic) => std::panic::resume_unwind(panic),
            })
        })
    }

    /// Copies a document from the store; whether it is there. Without a store none is.
    pub(super) fn fetch(&self, id: &ChangeId) -> Result<bool, ChangeStoreError> {
        let Some(shared) = &self.shared else { return Ok(false) };
        let Some((text, written)) = shared.store.get(&name_of(id, "json"))? else {
            return Ok(shared.check().map(|()| false)?);
        };
        let path = self.catalogue.path(id, "json");
        let text_file = document::write_beside(path.clone(), &text)?;
        let mut pixels_file = None;
        if id.is_plan() {
            // A document that says no hash is damaged, and known as that where it is read.
            let hash = document::read_bytes::<PixelsPart>(&path, &text).map(|(part, _)| part.pixels_blake3);
            if let Ok(hash) = hash {
                let Some((pixels, _)) = shared.store.get(&name_of_pixels(id, &hash))? else {
                    // It is being removed.
                    return Ok(false);
                };
                pixels_file = Some(document::write_beside(self.catalogue.path(id, "bin"), &pixels)?);
            }
        }
        let renewed = shared.store.modified(&name_of(id, "renewed"))?;
        let _writing = self.writing.lock().unwrap_or_else(PoisonError::into_inner);
        pixels_file.map_or(Ok(()), document::Unfinished::put)?;
        text_file.put()?;
        self.set_time(id, renewed.map_or(written, |renewed| renewed.max(written)))?;
        Ok(true)
    }

    /// Copies a document that there is no copy of.
    pub(super) fn fetch_missing(&self, id: &ChangeId) -> Result<(), ChangeStoreError> {
        match self.shared.is_some() && !self.catalogue.path(id, "json").exists() {
            true => self.fetch(id).map(drop),
            false => Ok(()),
        }
    }

    /// What stands before a document that is to be stored, where it is stored already; and whether what the store has of that id
    /// is to be written over, as it is past its age or damaged.
    pub(super) fn head_before<T: DeserializeOwned>(
        &self,
        id: &ChangeId,
    ) -> Result<(Option<Head>, bool), ChangeStoreError> {
        let is_there = match &self.shared {
            // Another server may have removed it just now.
            Some(shared) if shared.store.modified(&name_of(id, "json"))?.is_none() => {
                self.forget(id)?;
                return Ok((None, false));
            }
            Some(_) => {
                self.fetch_missing(id)?;
                true
            }
            None => false,
        };
        let before = self.read_document::<T>(id).ok().map(|(_, head)| head);
        let is_replaced = is_there && before.is_none();
        Ok((before, is_replaced))
    }

    /// Whether a document is stored, asked of the store where there is one: what it answers is so for all servers.
    ///
    /// # Errors
    /// [`ChangeStoreError::Away`].
    pub fn is_kept(&self, id: &ChangeId) -> Result<bool, ChangeStoreError> {
        if let Some(shared) = &self.shared {
            if shared.store.modified(&name_of(id, "json"))?.is_none() {
                self.forget(id)?;
                return Ok(false);
            }
            self.fetch_missing(id)?;
        }
        Ok(self.is_stored(id))
    }

    /// The hash of a plan's pixels, where they are shared.
    pub(super) fn pixels_of(&self, id: &ChangeId) -> Option<String> {
        if self.shared.is_none() || !id.is_plan() {
            return None;
        }
        let path = self.catalogue.path(id, "json");
        document::read::<PixelsPart>(&path, id).map(|(part, _)| part.pixels_blake3).ok()
    }

    /// Lets go of the copy of what is gone from the store.
    fn forget(&self, id: &ChangeId) -> Result<(), ChangeStoreError> {
        let _writing = self.writing.lock().unwrap_or_else(PoisonError::into_inner);
        self.remove_files(id);
        self.in_index(|index| index.take(id)).map(drop)
    }

    /// Takes over when a document was renewed by another server.
    fn take_time(&self, id: &ChangeId, modified_unix_ns: u64) -> Result<(), ChangeStoreError> {
        let _writing = self.writing.lock().unwrap_or_else(PoisonError::into_inner);
        self.set_time(id, UNIX_EPOCH + Duration::from_nanos(modified_unix_ns))
    }

    /// Gives a copy its time, and tells the index of it.
    fn set_time(&self, id: &ChangeId, modified: SystemTime) -> Result<(), ChangeStoreError> {
        let path = self.catalogue.path(id, "json");
        let file = std::fs::File::options().write(true).open(&path);
        match file.and_then(|file| file.set_modified(modified)) {
            // It was removed meanwhile.
            Err(error) if error.kind() == ErrorKind::NotFound => return Ok(()),
            set => set.map_err(io(&path))?,
        }
        let known = self.in_index(|index| index.get(id).cloned())?.flatten();
        let known = known.map(|entry| Entry { modified_unix_ns: unix_ns(modified), ..entry });
        if let Some(entry) = self.catalogue.entry(id, known.as_ref()) {
            self.catalogue.note(&entry);
            self.in_index(|index| index.put(entry))?;
        }
        Ok(())
    }
}
