//! The index of the folders of scenarios and plans: read once, with a file of outlines beside the documents that makes this
//! fast; kept as they change; looked through again where another process changed a folder.

use super::change_id::{ChangeId, ChangeKind};
use super::document::{self, FILE_MODE, UNFINISHED, io, unix_ns};
use super::index::{Entry, Index};
use super::listing::{Outlined, PlanParts, ScenarioParts};
use super::stored::{ChangeLimits, ChangeStoreError};
use rayon::prelude::*;
use std::collections::{HashMap, HashSet};
use std::fs::Metadata;
use std::io::{ErrorKind, Write};
use std::os::unix::fs::OpenOptionsExt;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant, SystemTime};

/// Outlines of a folder's documents, one JSON line each. Only saves time: what is not in it is read from the documents.
const OUTLINES: &str = "outlines.jsonl";
/// A file that was not renamed to its place after this long never will be.
const STALE_AFTER: Duration = Duration::from_secs(3600);
/// How often a folder is looked through again at most.
const LOOK_EVERY: Duration = Duration::from_secs(1);

/// Outdated lines that a file of outlines has before it is written anew.
const OUTDATED_AT_LEAST: usize = 1_000;

const KINDS: [ChangeKind; 2] = [ChangeKind::Scenario, ChangeKind::Plan];

/// The index and what it was made from.
#[derive(Debug)]
pub(super) struct Catalogue {
    data_dir: PathBuf,
    limits: ChangeLimits,
    index: Mutex<Option<Index>>,
    is_reading: AtomicBool,
    /// When each folder was looked through.
    looked: [Mutex<Option<Looked>>; 2],
    damaged: Mutex<Vec<ChangeStoreError>>,
    /// Lines added to each file of outlines since it was written.
    noted: [AtomicUsize; 2],
}

/// When a folder was looked through, and when it had changed last.
type Looked = (Instant, Option<SystemTime>);

/// What a folder has.
#[derive(Default)]
struct Names {
    documents: HashSet<ChangeId>,
    unfinished: Vec<PathBuf>,
}

/// Says that the index is not read any more, also where reading it panics: the next who needs it reads it then.
struct Reading<'a>(&'a AtomicBool);

impl Drop for Reading<'_> {
    fn drop(&mut self) {
        self.0.store(false, Ordering::Release);
    }
}

impl Catalogue {
    pub(super) fn new(data_dir: &Path, limits: ChangeLimits) -> Self {
        Self {
            data_dir: data_dir.to_owned(),
            limits,
            index: Mutex::default(),
            is_reading: AtomicBool::new(false),
            looked: Default::default(),
            damaged: Mutex::default(),
            noted: Default::default(),
        }
    }

    pub(super) fn folder(&self, kind: ChangeKind) -> PathBuf {
        self.data_dir.join(match kind {
            ChangeKind::Scenario => "scenarios",
            ChangeKind::Plan => "plans",
        })
    }

    pub(super) fn path(&self, id: &ChangeId, extension: &str) -> PathBuf {
        self.folder(id.kind()).join(id.as_str()).with_extension(extension)
    }

    /// Does something with the index, which is read first where it was not yet.
    ///
    /// # Errors
    /// [`ChangeStoreError::Reading`] where it is being read; [`ChangeStoreError::Io`] where a folder cannot be.
    pub(super) fn with<T>(&self, work: impl FnOnce(&mut Index) -> T) -> Result<T, ChangeStoreError> {
        let mut index = self.index.lock().unwrap_or_else(PoisonError::into_inner);
        if index.is_none() {
            if self.is_reading.load(Ordering::Acquire) {
                return Err(ChangeStoreError::Reading);
            }
            *index = Some(self.read()?);
        }
        index.as_mut().map(work).ok_or(ChangeStoreError::Reading)
    }

    /// Reads the index while others go on; the number of documents.
    pub(super) fn read_beside(&self) -> Result<usize, ChangeStoreError> {
        self.is_reading.store(true, Ordering::Release);
        let reading = Reading(&self.is_reading);
        let read = self.read().map(|read| {
            let count = KINDS.map(|kind| read.ids(kind).count()).iter().sum();
            *self.index.lock().unwrap_or_else(PoisonError::into_inner) = Some(read);
            count
        });
        drop(reading);
        // What was stored meanwhile.
        read.and_then(|count| KINDS.iter().try_for_each(|kind| self.look(*kind)).map(|()| count))
    }

    /// What was found damaged since this was asked last.
    pub(super) fn take_damaged(&self) -> Vec<ChangeStoreError> {
        std::mem::take(&mut *self.damaged.lock().unwrap_or_else(PoisonError::into_inner))
    }

    fn read(&self) -> Result<Index, ChangeStoreError> {
        let mut index = Index::new(self.limits);
        for kind in KINDS {
            let began = (Instant::now(), self.changed(kind));
            let known = self.read_outlines(kind);
            let names = self.names(kind)?;
            let entries: Vec<Entry> =
                names.documents.into_par_iter().filter_map(|id| self.entry(&id, known.get(&id))).collect();
            entries.into_iter().for_each(|entry| index.put(entry));
            clear(&names.unfinished);
            *self.looked(kind) = Some(began);
            if !self.limits.is_none() {
                // It only saves time at the next start.
                let _best_effort = self.write_outlines(kind, &index);
            }
        }
        Ok(index)
    }

    fn looked(&self, kind: ChangeKind) -> MutexGuard<'_, Option<Looked>> {
        self.looked[kind as usize].lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn changed(&self, kind: ChangeKind) -> Option<SystemTime> {
        std::fs::metadata(self.folder(kind)).and_then(|metadata| metadata.modified()).ok()
    }

    /// Finds what other processes stored or removed, where the folder changed and not more often than every second.
    pub(super) fn look_again(&self, kind: ChangeKind) -> Result<(), ChangeStoreError> {
        let is_due = self
            .looked(kind)
            .is_none_or(|(at, as_of)| at.elapsed() >= LOOK_EVERY && as_of != self.changed(kind));
        if is_due { self.look(kind) } else { Ok(()) }
    }

    fn look(&self, kind: ChangeKind) -> Result<(), ChangeStoreError> {
        let began = (Instant::now(), self.changed(kind));
        // The index first: what is put into it now and missing here is looked for by itself.
        let known: HashSet<ChangeId> = self.with(|index| index.ids(kind).cloned().collect())?;
        let names = self.names(kind)?;
        let new: Vec<Entry> =
            names.documents.difference(&known).filter_map(|id| self.entry(id, None)).collect();
        let gone: Vec<&ChangeId> =
            known.difference(&names.documents).filter(|id| !self.path(id, "json").exists()).collect();
        self.with(|index| {
            for entry in new {
                if index.get(&entry.id).is_none() {
                    index.put(entry);
                }
            }
            for id in gone {
                index.take(id);
            }
        })?;
        clear(&names.unfinished);
        *self.looked(kind) = Some(began);
        Ok(())
    }

    fn names(&self, kind: ChangeKind) -> Result<Names, ChangeStoreError> {
        let folder = self.folder(kind);
        let files = match std::fs::read_dir(&folder) {
            Ok(files) => files,
            Err(error) if error.kind() == ErrorKind::NotFound => return Ok(Names::default()),
            Err(error) => return Err(io(&folder)(error)),
        };
        let (mut names, mut pixels) = (Names::default(), Vec::new());
        for file in files {
            let path = file.map_err(io(&folder))?.path();
            let name = path.file_name().and_then(|name| name.to_str()).unwrap_or_default();
            if name.starts_with(UNFINISHED) {
                names.unfinished.push(path);
            } else if let Some((stem, extension)) = name.split_once('.')
                && let Ok(id) = ChangeId::parse(stem)
                && id.kind() == kind
            {
                match extension {
                    "json" => drop(names.documents.insert(id)),
                    "bin" => pixels.push((id, path)),
                    _ => {}
                }
            }
        }
        pixels.retain(|(id, _)| !names.documents.contains(id));
        names.unfinished.extend(pixels.into_iter().map(|(_, path)| path));
        Ok(names)
    }

    /// What the index says of a document: as it is `known`, or else from its file. None where that is gone.
    pub(super) fn entry(&self, id: &ChangeId, known: Option<&Entry>) -> Option<Entry> {
        let path = self.path(id, "json");
        let metadata = std::fs::metadata(&path).ok()?;
        let modified_unix_ns = metadata.modified().map_or(0, unix_ns);
        let pixels = if id.is_plan() { std::fs::metadata(self.path(id, "bin")).ok() } else { None };
        let bytes = metadata.len() + pixels.map_or(0, |pixels| pixels.len());
        if let Some(known) = known.filter(|known| is_of(known, &metadata, modified_unix_ns)) {
            return Some(Entry { bytes, ..known.clone() });
        }
        let read = match id.kind() {
            ChangeKind::Scenario => {
                document::read::<ScenarioParts>(&path, id).map(|(parts, head)| (parts.into(), head))
            }
            ChangeKind::Plan => {
                document::read::<PlanParts>(&path, id).map(|(parts, head)| (Outlined::from(parts), head))
            }
        };
        let entry = Entry {
            id: id.clone(),
            base: None,
            listed: None,
            posted: Default::default(),
            created_unix_ns: modified_unix_ns,
            modified_unix_ns,
            document_bytes: metadata.len(),
            bytes,
        };
        match read {
            Ok((outlined, head)) => {
                let created_unix_ns = head.created_unix_ns();
                Some(Entry { posted: head.posted, created_unix_ns, ..entry }.outlined(outlined))
            }
            Err(ChangeStoreError::Unknown { .. }) => None,
            Err(error) => {
                self.damaged.lock().unwrap_or_else(PoisonError::into_inner).push(error);
                Some(entry)
            }
        }
    }

    fn read_outlines(&self, kind: ChangeKind) -> HashMap<ChangeId, Entry> {
        let lines = std::fs::read(self.folder(kind).join(OUTLINES)).unwrap_or_default();
        let entries = lines.split(|byte| *byte == b'\n');
        // The last line may be half of one, and any may be of another version of the program.
        let entries = entries.filter_map(|line| serde_json::from_slice::<Entry>(line).ok());
        entries.map(|entry| (entry.id.clone(), entry)).collect()
    }

    fn write_outlines(&self, kind: ChangeKind, index: &Index) -> Result<(), ChangeStoreError> {
        let path = self.folder(kind).join(OUTLINES);
        if index.ids(kind).next().is_none() {
            return Ok(());
        }
        let lines = index.entries(kind).filter(|entry| entry.listed.is_some()).map(line);
        document::write_beside(path, &lines.collect::<Vec<_>>().concat())?.put()
    }

    /// Adds a document's outline to the file of them, which is written anew where most of its lines are outdated.
    pub(super) fn note(&self, entry: &Entry) {
        let kind = entry.id.kind();
        if self.limits.is_none() {
            return;
        }
        let noted = self.noted[kind as usize].fetch_add(1, Ordering::Relaxed);
        if noted >= OUTDATED_AT_LEAST
            && noted >= self.with(|index| index.ids(kind).count()).unwrap_or(usize::MAX)
        {
            self.noted[kind as usize].store(0, Ordering::Relaxed);
            let _best_effort = self.with(|index| self.write_outlines(kind, index));
        }
        let path = self.folder(kind).join(OUTLINES);
        let file = std::fs::OpenOptions::new().create(true).append(true).mode(FILE_MODE).open(path);
        // It only saves time at the next start.
        let _best_effort = file.and_then(|mut file| file.write_all(&line(entry)));
    }
}

fn line(entry: &Entry) -> Vec<u8> {
    let mut line = serde_json::to_vec(entry).unwrap_or_default();
    line.push(b'\n');
    line
}

fn is_of(entry: &Entry, metadata: &Metadata, modified_unix_ns: u64) -> bool {
    entry.document_bytes == metadata.len() && entry.modified_unix_ns == modified_unix_ns
}

/// Removes what killed processes left.
fn clear(unfinished: &[PathBuf]) {
    for path in unfinished {
        let modified = std::fs::metadata(path).and_then(|metadata| metadata.modified());
        if modified.is_ok_and(|time| time.elapsed().is_ok_and(|age| age > STALE_AFTER)) {
            let _may_be_gone_already = std::fs::remove_file(path);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Where reading the index panics, the next who needs it reads it.
    #[test]
    fn an_index_that_is_given_up_is_read_anew() {
        let folder = tempfile::tempdir().unwrap();
        let catalogue = Catalogue::new(folder.path(), ChangeLimits::default());
        catalogue.is_reading.store(true, Ordering::Release);
        assert!(matches!(catalogue.with(|_| ()), Err(ChangeStoreError::Reading)));
        let broken = std::panic::catch_unwind(|| {
            let _reading = Reading(&catalogue.is_reading);
            panic!("planted");
        });
        assert!(broken.is_err() && catalogue.with(|_| ()).is_ok());
    }
}
