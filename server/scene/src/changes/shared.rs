//! Documents that several servers share: an object store is the truth, and a server's folders hold copies of it.
//!
//! Objects have the names of files: `scenarios/ID.json`, `plans/ID.json`, beside them `ID.HASH.bin` with the pixels of a plan, and
//! `ID.renewed`, whose time says how old it counts. Documents are written once, but where they are pinned.

use super::change_id::{ChangeId, ChangeKind};
use super::document::unix_ns;
use super::stored::{ChangeStoreError, StoreAway};
use std::collections::{HashMap, HashSet};
use std::fmt::Debug;
use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant, SystemTime};

/// The object with the key of hashes.
const KEY: &str = "kept.key";
/// What belongs to no document goes when it is older: it may be of one that is being stored.
const ORPHANS_GO_AFTER: Duration = Duration::from_secs(3600);

/// An object of a store.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct StoredObject {
    /// Its name, with its folder.
    pub name: String,
    /// When it was written.
    pub modified: SystemTime,
}

/// Named objects that several servers read and write, such as a bucket. Calls wait for the answer; what was written is seen by all
/// from then on.
pub trait DocumentStore: Debug + Send + Sync {
    /// Where it is, for the log and to tell stores apart.
    fn address(&self) -> String;

    /// An object's bytes, and when it was written; None where there is none.
    ///
    /// # Errors
    /// [`StoreAway`].
    fn get(&self, name: &str) -> Result<Option<(Vec<u8>, SystemTime)>, StoreAway>;

    /// When an object was written; None where there is none.
    ///
    /// # Errors
    /// [`StoreAway`].
    fn modified(&self, name: &str) -> Result<Option<SystemTime>, StoreAway>;

    /// Writes an object, over what is there.
    ///
    /// # Errors
    /// [`StoreAway`].
    fn put(&self, name: &str, bytes: &[u8]) -> Result<(), StoreAway>;

    /// Writes an object where there is none of that name; whether it did.
    ///
    /// # Errors
    /// [`StoreAway`].
    fn put_new(&self, name: &str, bytes: &[u8]) -> Result<bool, StoreAway>;

    /// Removes an object, if it is there.
    ///
    /// # Errors
    /// [`StoreAway`].
    fn remove(&self, name: &str) -> Result<(), StoreAway>;

    /// Writes an object's bytes to a new file; whether there is one.
    ///
    /// # Errors
    /// [`StoreAway`], also where the file cannot be written.
    fn download(&self, name: &str, path: &Path) -> Result<bool, StoreAway>;

    /// Writes an object of a file's bytes, over what is there.
    ///
    /// # Errors
    /// [`StoreAway`], also where the file cannot be read.
    fn upload(&self, name: &str, path: &Path) -> Result<(), StoreAway>;

    /// The objects of a folder.
    ///
    /// # Errors
    /// [`StoreAway`].
    fn list(&self, folder: &str) -> Result<Vec<StoredObject>, StoreAway>;
}

/// The store of documents, and how this server stands to it.
#[derive(Debug)]
pub(super) struct Shared {
    pub(super) store: Arc<dyn DocumentStore>,
    /// When its lists were compared with the index last; held while they are.
    refreshed: Mutex<Option<Instant>>,
    was_refreshed: AtomicBool,
    /// Documents whose age is to be renewed there.
    renewed: Mutex<HashSet<ChangeId>>,
}

/// When a document was written, and when written or renewed last, nanoseconds since 1970.
#[derive(Clone, Copy, Debug)]
pub(super) struct Times {
    pub(super) written_unix_ns: u64,
    pub(super) renewed_unix_ns: u64,
}

pub(super) fn name_of(id: &ChangeId, extension: &str) -> String {
    format!("{}/{id}.{extension}", folder_of(id.kind()))
}

/// The name of a plan's pixels, which are of that hash: who stores the same plan at the same time has others of his own.
pub(super) fn name_of_pixels(id: &ChangeId, blake3: &str) -> String {
    name_of(id, &format!("{}.bin", blake3.get(..16).unwrap_or(blake3)))
}

pub(super) fn folder_of(kind: ChangeKind) -> &'static str {
    match kind {
        ChangeKind::Scenario => "scenarios",
        ChangeKind::Plan => "plans",
    }
}

impl Shared {
    pub(super) fn new(store: Arc<dyn DocumentStore>) -> Self {
        Self {
            store,
            refreshed: Mutex::default(),
            was_refreshed: AtomicBool::new(false),
            renewed: Mutex::default(),
        }
    }

    /// The key of hashes, which all servers have; made by the first.
    ///
    /// # Errors
    /// [`ChangeStoreError::Away`], [`ChangeStoreError::Damaged`].
    pub(super) fn key(&self) -> Result<[u8; 32], ChangeStoreError> {
        let made = super::store_key::new_key().map_err(|error| StoreAway { reason: error.to_string() })?;
        let text = format!("{}\n", blake3::Hash::from_bytes(made).to_hex());
        if self.store.modified(KEY)?.is_none() && self.store.put_new(KEY, text.as_bytes())? {
            return Ok(made);
        }
        let bytes = self.store.get(KEY)?.map(|(bytes, _)| bytes).unwrap_or_default();
        let text = String::from_utf8_lossy(&bytes);
        let hash = blake3::Hash::from_hex(text.trim()).map_err(|_| ChangeStoreError::Damaged {
            path: KEY.into(),
            reason: format!("in {} is no key", self.store.address()),
        })?;
        Ok(*hash.as_bytes())
    }

    /// That this is the store that it was: one that lost its key is another, or a folder that is not mounted.
    ///
    /// # Errors
    /// [`StoreAway`].
    pub(super) fn check(&self) -> Result<(), StoreAway> {
        match self.store.modified(KEY)? {
            Some(_) => Ok(()),
            None => Err(StoreAway { reason: format!("{} has no {KEY} any more", self.store.address()) }),
        }
    }

    pub(super) fn refreshed(&self) -> MutexGuard<'_, Option<Instant>> {
        self.refreshed.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// The same for who does not wait for the first time; None while that goes on.
    pub(super) fn refreshed_once(&self) -> Option<MutexGuard<'_, Option<Instant>>> {
        match self.refreshed.try_lock() {
            Ok(guard) => Some(guard),
            Err(_) if self.was_refreshed.load(Ordering::Acquire) => Some(self.refreshed()),
            Err(_) => None,
        }
    }

    pub(super) fn note_refreshed(&self, mut at: MutexGuard<'_, Option<Instant>>) {
        *at = Some(Instant::now());
        self.was_refreshed.store(true, Ordering::Release);
    }

    pub(super) fn note_renewed(&self, id: &ChangeId) {
        self.renewed.lock().unwrap_or_else(PoisonError::into_inner).insert(id.clone());
    }

    /// Tells the store what was renewed since.
    ///
    /// # Errors
    /// [`StoreAway`]: it is told the next time.
    pub(super) fn write_renewed(&self) -> Result<(), StoreAway> {
        let next = || self.renewed.lock().unwrap_or_else(PoisonError::into_inner).iter().next().cloned();
        while let Some(id) = next() {
            self.store.put(&name_of(&id, "renewed"), b"")?;
            self.renewed.lock().unwrap_or_else(PoisonError::into_inner).remove(&id);
        }
        Ok(())
    }

    /// Writes a document, the pixels first; whether it is this one that is there now, and not one of somebody who was first.
    ///
    /// * `is_new`: whether there is none yet; else it is written over what is there.
    ///
    /// # Errors
    /// [`StoreAway`]: it may be there all the same.
    pub(super) fn publish(
        &self,
        id: &ChangeId,
        text: &[u8],
        pixels: Option<&[u8]>,
        is_new: bool,
    ) -> Result<bool, StoreAway> {
        self.check()?;
        if let Some(pixels) = pixels {
            self.store.put(&name_of_pixels(id, &blake3::hash(pixels).to_hex()), pixels)?;
        }
        let name = name_of(id, "json");
        if !is_new {
            return self.store.put(&name, text).map(|()| true);
        }
        // Where the answer to the first try was lost, the second finds what that wrote.
        Ok(self.store.put_new(&name, text)? || self.store.get(&name)?.is_some_and(|(bytes, _)| bytes == text))
    }

    /// Removes a document. Its pixels go too; where they do not, they go as those of no document.
    ///
    /// * `pixels`: their hash.
    ///
    /// # Errors
    /// [`StoreAway`]: it may be gone all the same.
    pub(super) fn remove(&self, id: &ChangeId, pixels: Option<&str>) -> Result<(), StoreAway> {
        self.store.remove(&name_of(id, "json"))?;
        if let Some(blake3) = pixels {
            self.store.remove(&name_of_pixels(id, blake3))?;
        }
        self.store.remove(&name_of(id, "renewed"))
    }

    /// What there is of a kind. Removes what belongs to none of it and is old.
    ///
    /// # Errors
    /// [`StoreAway`].
    pub(super) fn list(&self, kind: ChangeKind) -> Result<HashMap<ChangeId, Times>, StoreAway> {
        let (mut documents, mut others) = (HashMap::new(), Vec::new());
        for object in self.store.list(folder_of(kind))? {
            let name = object.name.rsplit('/').next().unwrap_or_default();
            let Some((stem, extension)) = name.split_once('.') else { continue };
            let Some(id) = ChangeId::parse(stem).ok().filter(|id| id.kind() == kind) else { continue };
            match extension {
                "json" => {
                    let written_unix_ns = unix_ns(object.modified);
                    documents.insert(id, Times { written_unix_ns, renewed_unix_ns: written_unix_ns });
                }
                _ => others.push((id, object)),
            }
        }
        for (id, object) in others {
            let is_old = object.modified.elapsed().is_ok_and(|age| age > ORPHANS_GO_AFTER);
            match documents.get_mut(&id) {
                Some(times) if object.name.ends_with(".renewed") => {
                    times.renewed_unix_ns = times.renewed_unix_ns.max(unix_ns(object.modified));
                }
                None if is_old => self.store.remove(&object.name)?,
                _ => {}
            }
        }
        Ok(documents)
    }
}
