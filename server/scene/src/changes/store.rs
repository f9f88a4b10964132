//! Scenarios and plans on disk: `<data>/scenarios/ID.json`; `<data>/plans/ID.json` beside `ID.bin` with its pixels.
//!
//! The JSON comes last, by a rename, so what is there is whole. It carries a BLAKE3 hash over its content, and of the pixels;
//! both are checked when they are read. Older ones make room for newer ones; see [`ChangeLimits`]. Plans that somebody only
//! tries are held in memory; see [`Drafts`].

use super::change_id::ChangeId;
use super::drafts::Drafts;
use super::edits::{ChangeStep, PixelFactors};
use super::stored::{ChangeKind, ChangeLimits, ChangeStoreError, MAX_CHANGE_DEPTH, Scenario, StoredPlan};
use crate::scene_id::SceneId;
use crate::sections::{self, Sections, pack_ascending, unpack_ascending};
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};
use std::borrow::Cow;
use std::io::{ErrorKind, Write};
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, SystemTime, UNIX_EPOCH};

/// Counts up with every change of the files' form.
const FORMAT: u32 = 1;
/// A file that was not renamed to its place after this long never will be.
const STALE_AFTER: Duration = Duration::from_secs(3600);

/// A plan's JSON.
#[derive(Clone, Debug, Serialize, Deserialize)]
struct PlanDocument {
    scene: SceneId,
    scene_version: String,
    base: Option<ChangeId>,
    answer: serde_json::Value,
    pixels_blake3: String,
}

/// The form of a file.
#[derive(Clone, Debug, Serialize, Deserialize)]
struct Stored<T> {
    format: u32,
    created_unix_s: u64,
    blake3: String,
    content: T,
}

/// The folders of scenarios and plans.
#[derive(Clone, Debug)]
pub struct ChangeStore {
    data_dir: PathBuf,
    limits: ChangeLimits,
    drafts: Drafts,
    /// Held while something is written or removed.
    writing: Arc<Mutex<()>>,
}

fn io(path: &Path) -> impl FnOnce(std::io::Error) -> ChangeStoreError + '_ {
    |source| ChangeStoreError::Io { path: path.to_owned(), source }
}

fn damaged(path: &Path) -> impl FnOnce(String) -> ChangeStoreError + '_ {
    |reason| ChangeStoreError::Damaged { path: path.to_owned(), reason }
}

fn unix_s(time: SystemTime) -> u64 {
    time.duration_since(UNIX_EPOCH).map_or(0, |since| since.as_secs())
}

impl ChangeStore {
    /// The scenarios and plans of a data folder; the folder need not exist.
    pub fn new(data_dir: impl AsRef<Path>, limits: ChangeLimits) -> Self {
        let (data_dir, drafts) = (data_dir.as_ref().to_owned(), Drafts::default());
        Self { data_dir, limits, drafts, writing: Arc::default() }
    }

    fn folder(&self, kind: ChangeKind) -> PathBuf {
        self.data_dir.join(match kind {
            ChangeKind::Scenario => "scenarios",
            ChangeKind::Plan => "plans",
        })
    }

    fn path(&self, id: &ChangeId, extension: &str) -> PathBuf {
        let kind = if id.is_plan() { ChangeKind::Plan } else { ChangeKind::Scenario };
        self.folder(kind).join(id.as_str()).with_extension(extension)
    }

    /// Keeps a scenario.
    ///
    /// # Errors
    /// [`ChangeStoreError::Io`]; [`ChangeStoreError::Draft`] where it goes on from one.
    pub fn store_scenario(&self, scenario: &Scenario) -> Result<ChangeId, ChangeStoreError> {
        self.check_base(scenario.base.as_ref())?;
        let id = self.scenario_id(scenario)?;
        let _writing = self.writing.lock().unwrap_or_else(PoisonError::into_inner);
        self.write_document(&id, scenario)?;
        self.renew(scenario.base.as_ref());
        self.make_room(ChangeKind::Scenario, &id)?;
        Ok(id)
    }

    /// The id that a scenario has.
    ///
    /// # Errors
    /// [`ChangeStoreError::Io`] for what is no JSON: none.
    pub fn scenario_id(&self, scenario: &Scenario) -> Result<ChangeId, ChangeStoreError> {
        Ok(ChangeId::of_scenario(&to_json(&self.folder(ChangeKind::Scenario), scenario)?))
    }

    /// Makes all that something stands on as young as it.
    fn renew(&self, base: Option<&ChangeId>) {
        let mut next = base.cloned();
        for _ in 0..MAX_CHANGE_DEPTH {
            let Some(id) = next else { return };
            let file = std::fs::File::options().write(true).open(self.path(&id, "json"));
            // Should it be removed meanwhile, whoever asks for it is told.
            let _best_effort = file.and_then(|file| file.set_modified(SystemTime::now()));
            next = match id.is_plan() {
                true => self.read_document::<PlanDocument>(&id).ok().and_then(|(plan, _)| plan.base),
                false => self.read_document::<Scenario>(&id).ok().and_then(|(scenario, _)| scenario.base),
            };
        }
    }

    /// A scenario.
    ///
    /// # Errors
    /// [`ChangeStoreError`].
    pub fn scenario(&self, id: &ChangeId) -> Result<(Scenario, u64), ChangeStoreError> {
        self.read_document(id)
    }

    /// Whether there is one of that id, be it readable or not. Cheap.
    pub fn is_there(&self, id: &ChangeId) -> bool {
        self.is_stored(id) || self.drafts.get(id).is_some()
    }

    /// Whether one of that id is on disk and not past its age.
    pub fn is_stored(&self, id: &ChangeId) -> bool {
        let kept = std::fs::metadata(self.path(id, "json")).and_then(|metadata| metadata.modified());
        kept.is_ok_and(|modified| !self.is_past_age(modified))
    }

    fn is_past_age(&self, modified: SystemTime) -> bool {
        unix_s(SystemTime::now()).saturating_sub(unix_s(modified)) > self.limits.age.as_secs()
    }

    /// What is kept stands on what is kept: a draft would go from under it.
    ///
    /// # Errors
    /// [`ChangeStoreError::Draft`].
    pub fn check_base(&self, base: Option<&ChangeId>) -> Result<(), ChangeStoreError> {
        match base {
            Some(id) if !self.is_stored(id) && self.is_there(id) => {
                Err(ChangeStoreError::Draft { id: id.clone() })
            }
            _ => Ok(()),
        }
    }

    /// The id that a plan with this content has: all that decides it.
    pub fn plan_id(content: &[u8]) -> ChangeId {
        ChangeId::of_plan(content)
    }

    /// Holds a plan in memory for some minutes under an id of [`Self::plan_id`], for whoever tries one after the other.
    pub fn hold_plan(&self, id: &ChangeId, plan: StoredPlan) {
        self.drafts.hold(id, plan, unix_s(SystemTime::now()));
    }

    /// Keeps a plan under an id of [`Self::plan_id`].
    ///
    /// # Errors
    /// [`ChangeStoreError::Io`]; [`ChangeStoreError::Draft`] where it goes on from one.
    pub fn store_plan(&self, id: &ChangeId, plan: &StoredPlan) -> Result<(), ChangeStoreError> {
        self.check_base(plan.base.as_ref())?;
        let _writing = self.writing.lock().unwrap_or_else(PoisonError::into_inner);
        let path = self.path(id, "bin");
        let parts: Vec<(String, Cow<'_, [u8]>)> = vec![
            ("codes".into(), Cow::Owned(pack_ascending(&plan.factors.codes))),
            ("factors".into(), Cow::Borrowed(bytemuck::cast_slice(&plan.factors.factors))),
            ("effects".into(), Cow::Borrowed(bytemuck::cast_slice(&plan.effects))),
        ];
        let pixels = sections::pack(&parts).map_err(io(&path))?;
        self.write_file(&path, &pixels)?;
        let document = PlanDocument {
            scene: plan.scene.clone(),
            scene_version: plan.scene_version.clone(),
            base: plan.base.clone(),
            answer: plan.answer.clone(),
            pixels_blake3: blake3::hash(&pixels).to_hex().to_string(),
        };
        self.write_document(id, &document)?;
        self.renew(plan.base.as_ref());
        self.make_room(ChangeKind::Plan, id)
    }

    /// A plan, kept or held, and since when, seconds since 1970.
    ///
    /// # Errors
    /// [`ChangeStoreError`].
    pub fn plan(&self, id: &ChangeId) -> Result<(StoredPlan, u64), ChangeStoreError> {
        match self.kept_plan(id) {
            Err(ChangeStoreError::Unknown { .. }) => match self.drafts.get(id) {
                Some(held) => Ok(StoredPlan::clone(&held.0)).map(|plan| (plan, held.1)),
                None => Err(ChangeStoreError::Unknown { id: id.clone() }),
            },
            read => read,
        }
    }

    fn kept_plan(&self, id: &ChangeId) -> Result<(StoredPlan, u64), ChangeStoreError> {
        let (document, created_unix_s): (PlanDocument, u64) = self.read_document(id)?;
        let path = self.path(id, "bin");
        let bytes = match std::fs::read(&path) {
            Ok(bytes) => bytes,
            // Removed while it was read.
            Err(error) if error.kind() == ErrorKind::NotFound => {
                return Err(ChangeStoreError::Unknown { id: id.clone() });
            }
            Err(error) => return Err(io(&path)(error)),
        };
        if blake3::hash(&bytes).to_hex().as_str() != document.pixels_blake3 {
            return Err(damaged(&path)("was altered or is truncated (its checksum is wrong)".to_owned()));
        }
        let parsed = Sections::parse(&bytes).and_then(|sections| {
            let codes = unpack_ascending(&sections.bytes("codes")?)?;
            let factors: Vec<f32> = sections.numbers("factors")?;
            let effects: Vec<f32> = sections.numbers("effects")?;
            let is_whole = codes.len() == factors.len()
                && codes.len() == effects.len()
                && codes.windows(2).all(|pair| pair[0] < pair[1])
                && factors.iter().all(|factor| (0.0..=1.0).contains(factor));
            if is_whole { Ok((codes, factors, effects)) } else { Err("contradicts itself".to_owned()) }
        });
        let (codes, factors, effects) = parsed.map_err(damaged(&path))?;
        let PlanDocument { scene, scene_version, base, answer, .. } = document;
        let factors = PixelFactors { codes, factors };
        Ok((StoredPlan { scene, scene_version, base, answer, factors, effects }, created_unix_s))
    }

    /// A plan's scene and what is said of it, without its pixels, and when it was kept, seconds since 1970.
    ///
    /// # Errors
    /// [`ChangeStoreError`].
    pub fn plan_answer(&self, id: &ChangeId) -> Result<(SceneId, serde_json::Value, u64), ChangeStoreError> {
        let (document, created_unix_s): (PlanDocument, u64) = self.read_document(id)?;
        Ok((document.scene, document.answer, created_unix_s))
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

    /// Ids with the time they were kept, seconds since 1970, the newest first. What cannot be read is left out.
    ///
    /// # Errors
    /// [`ChangeStoreError::Io`] where the folder cannot be read.
    pub fn list(&self, kind: ChangeKind) -> Result<Vec<(ChangeId, u64)>, ChangeStoreError> {
        let kept = self.kept(kind)?;
        let limit = unix_s(SystemTime::now()).saturating_sub(self.limits.age.as_secs());
        let of = kept.into_iter().map(|kept| (kept.id, unix_s(kept.modified)));
        Ok(of.filter(|(_, modified_unix_s)| *modified_unix_s >= limit).collect())
    }

    /// What is in a folder, the newest first.
    fn kept(&self, kind: ChangeKind) -> Result<Vec<Kept>, ChangeStoreError> {
        let folder = self.folder(kind);
        let entries = match std::fs::read_dir(&folder) {
            Ok(entries) => entries,
            Err(error) if error.kind() == ErrorKind::NotFound => return Ok(Vec::new()),
            Err(error) => return Err(io(&folder)(error)),
        };
        let mut kept = Vec::new();
        for entry in entries {
            let path = entry.map_err(io(&folder))?.path();
            let stem = path.file_stem().and_then(|stem| stem.to_str());
            let Some(id) = stem.and_then(|stem| ChangeId::parse(stem).ok()) else { continue };
            if path.extension().is_none_or(|extension| extension != "json") {
                continue;
            }
            // Another process may have removed it meanwhile.
            let Ok(metadata) = std::fs::metadata(&path) else { continue };
            let Ok(modified) = metadata.modified() else { continue };
            let pixels = std::fs::metadata(path.with_extension("bin")).map_or(0, |metadata| metadata.len());
            kept.push(Kept { id, modified, bytes: metadata.len() + pixels });
        }
        kept.sort_by(|a, b| b.modified.cmp(&a.modified).then_with(|| a.id.cmp(&b.id)));
        Ok(kept)
    }

    /// Removes what is too old or too much, never `newest`.
    fn make_room(&self, kind: ChangeKind, newest: &ChangeId) -> Result<(), ChangeStoreError> {
        let now_s = unix_s(SystemTime::now());
        let (mut count, mut bytes) = (1, 0);
        for kept in self.kept(kind)?.into_iter().filter(|kept| kept.id != *newest) {
            count += 1;
            bytes += kept.bytes;
            let is_old = now_s.saturating_sub(unix_s(kept.modified)) > self.limits.age.as_secs();
            if is_old || count > self.limits.count || bytes > self.limits.bytes {
                // The document first: without it nothing is there.
                for extension in ["json", "bin"] {
                    let _may_be_gone_already = std::fs::remove_file(self.path(&kept.id, extension));
                }
            }
        }
        self.clear_unfinished(kind);
        Ok(())
    }

    /// Removes what killed processes left.
    fn clear_unfinished(&self, kind: ChangeKind) {
        let Ok(entries) = std::fs::read_dir(self.folder(kind)) else { return };
        for path in entries.flatten().map(|entry| entry.path()) {
            let name = path.file_name().and_then(|name| name.to_str()).unwrap_or_default();
            let is_orphan = name.ends_with(".bin") && !path.with_extension("json").exists();
            let modified = std::fs::metadata(&path).and_then(|metadata| metadata.modified());
            let is_old = modified.is_ok_and(|time| time.elapsed().is_ok_and(|age| age > STALE_AFTER));
            if (name.starts_with('.') || is_orphan) && is_old {
                let _may_be_gone_already = std::fs::remove_file(&path);
            }
        }
    }

    fn write_document<T: Serialize>(&self, id: &ChangeId, content: &T) -> Result<(), ChangeStoreError> {
        let path = self.path(id, "json");
        // The hash is over what is written and not over what it means: that may be told in more than one way.
        let content = serde_json::to_value(content).map_err(|error| io(&path)(error.into()))?;
        let text = to_json(&path, &content)?;
        let stored = Stored {
            format: FORMAT,
            created_unix_s: unix_s(SystemTime::now()),
            blake3: blake3::hash(&text).to_hex().to_string(),
            content,
        };
        self.write_file(&path, &to_json(&path, &stored)?)
    }

    /// A document with the time it was kept.
    fn read_document<T: DeserializeOwned>(&self, id: &ChangeId) -> Result<(T, u64), ChangeStoreError> {
        let path = self.path(id, "json");
        let text = match std::fs::read(&path) {
            Ok(text) => text,
            Err(error) if error.kind() == ErrorKind::NotFound => {
                return Err(ChangeStoreError::Unknown { id: id.clone() });
            }
            Err(error) => return Err(io(&path)(error)),
        };
        let stored: Stored<serde_json::Value> = serde_json::from_slice(&text)
            .map_err(|error| damaged(&path)(format!("is truncated or broken ({error})")))?;
        if stored.format != FORMAT {
            return Err(damaged(&path)(format!(
                "is of format {}, this program reads {FORMAT}",
                stored.format
            )));
        }
        if blake3::hash(&to_json(&path, &stored.content)?).to_hex().as_str() != stored.blake3 {
            return Err(damaged(&path)("was altered (its checksum is wrong)".to_owned()));
        }
        // What stands on it may have made it young again since.
        let kept = std::fs::metadata(&path).and_then(|metadata| metadata.modified()).map_err(io(&path))?;
        if self.is_past_age(kept) {
            return Err(ChangeStoreError::Unknown { id: id.clone() });
        }
        let content = serde_json::from_value(stored.content)
            .map_err(|error| damaged(&path)(format!("is of another form ({error})")))?;
        Ok((content, stored.created_unix_s))
    }

    /// Writes beside the place first, then moves there.
    fn write_file(&self, path: &Path, bytes: &[u8]) -> Result<(), ChangeStoreError> {
        let folder = path.parent().unwrap_or(&self.data_dir);
        std::fs::create_dir_all(folder).map_err(io(folder))?;
        let write = || -> std::io::Result<()> {
            let mut file = tempfile::Builder::new().prefix(".change-").tempfile_in(folder)?;
            file.write_all(bytes)?;
            file.as_file().sync_all()?;
            file.persist(path).map_err(|error| error.error)?;
            std::fs::File::open(folder)?.sync_all()
        };
        write().map_err(io(path))
    }
}

/// Something in a folder.
struct Kept {
    id: ChangeId,
    modified: SystemTime,
    bytes: u64,
}

fn to_json<T: Serialize>(path: &Path, content: &T) -> Result<Vec<u8>, ChangeStoreError> {
    serde_json::to_vec(content).map_err(|error| io(path)(error.into()))
}
