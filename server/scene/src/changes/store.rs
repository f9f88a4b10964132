//! Scenarios and plans on disk: `<data>/scenarios/ID.json`; `<data>/plans/ID.json` beside `ID.bin` with its pixels.
//!
//! The JSON is written last and renamed into place, so a document is complete or absent. It carries BLAKE3 hashes of its content
//! and of the pixels; both are checked when they are read. The oldest are evicted; see [`ChangeLimits`]. Draft plans are held in
//! memory; see [`Drafts`].

use super::change_id::ChangeId;
use super::document::{self, damaged, io, to_json, unix_s};
use super::drafts::Drafts;
use super::edits::{ChangeStep, PixelFactors};
use super::stored::{ChangeKind, ChangeLimits, ChangeStoreError, MAX_CHANGE_DEPTH, Scenario, StoredPlan};
use crate::scene_id::SceneId;
use crate::sections::{self, Sections, pack_ascending, unpack_ascending};
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};
use std::borrow::Cow;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, SystemTime};

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

/// The folders of scenarios and plans.
#[derive(Clone, Debug)]
pub struct ChangeStore {
    data_dir: PathBuf,
    limits: ChangeLimits,
    drafts: Drafts,
    /// Held while something is written or removed.
    writing: Arc<Mutex<()>>,
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

    /// Stores a scenario.
    ///
    /// # Errors
    /// [`ChangeStoreError::Io`]; [`ChangeStoreError::Draft`] where it is based on a draft.
    pub fn store_scenario(&self, scenario: &Scenario) -> Result<ChangeId, ChangeStoreError> {
        self.check_base(scenario.base.as_ref())?;
        let id = self.scenario_id(scenario)?;
        let _writing = self.writing.lock().unwrap_or_else(PoisonError::into_inner);
        document::write(&self.path(&id, "json"), scenario)?;
        self.renew(scenario.base.as_ref());
        self.evict(ChangeKind::Scenario, &id)?;
        Ok(id)
    }

    /// The id that a scenario has.
    ///
    /// # Errors
    /// [`ChangeStoreError::Io`] for what is no JSON: none.
    pub fn scenario_id(&self, scenario: &Scenario) -> Result<ChangeId, ChangeStoreError> {
        Ok(ChangeId::of_scenario(&to_json(&self.folder(ChangeKind::Scenario), scenario)?))
    }

    /// Renews the age of the whole chain of bases.
    fn renew(&self, base: Option<&ChangeId>) {
        let mut next = base.cloned();
        for _ in 0..MAX_CHANGE_DEPTH {
            let Some(id) = next else { return };
            let file = std::fs::File::options().write(true).open(self.path(&id, "json"));
            // If it is removed meanwhile, the next request for it fails.
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

    /// Whether a stored document or a draft has that id, readable or not. Cheap.
    pub fn is_there(&self, id: &ChangeId) -> bool {
        self.is_stored(id) || self.drafts.get(id).is_some()
    }

    /// Whether a document of that id is on disk and not past its age.
    pub fn is_stored(&self, id: &ChangeId) -> bool {
        let modified = std::fs::metadata(self.path(id, "json")).and_then(|metadata| metadata.modified());
        modified.is_ok_and(|modified| !self.is_past_age(modified))
    }

    fn is_past_age(&self, modified: SystemTime) -> bool {
        unix_s(SystemTime::now()).saturating_sub(unix_s(modified)) > self.limits.age.as_secs()
    }

    /// Refuses a draft as the base of a stored document, since it would expire.
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

    /// The id of a plan with this content, which must include all of its inputs.
    pub fn plan_id(content: &[u8]) -> ChangeId {
        ChangeId::of_plan(content)
    }

    /// Holds a draft plan in memory for some minutes under an id of [`Self::plan_id`].
    pub fn hold_plan(&self, id: &ChangeId, plan: StoredPlan) {
        self.drafts.hold(id, plan, unix_s(SystemTime::now()));
    }

    /// Stores a plan under an id of [`Self::plan_id`].
    ///
    /// # Errors
    /// [`ChangeStoreError::Io`]; [`ChangeStoreError::Draft`] where it is based on a draft.
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
        document::write_file(&path, &pixels)?;
        let document = PlanDocument {
            scene: plan.scene.clone(),
            scene_version: plan.scene_version.clone(),
            base: plan.base.clone(),
            answer: plan.answer.clone(),
            pixels_blake3: blake3::hash(&pixels).to_hex().to_string(),
        };
        document::write(&self.path(id, "json"), &document)?;
        self.renew(plan.base.as_ref());
        self.evict(ChangeKind::Plan, id)
    }

    /// A plan, stored or draft, and since when, seconds since 1970.
    ///
    /// # Errors
    /// [`ChangeStoreError`].
    pub fn plan(&self, id: &ChangeId) -> Result<(StoredPlan, u64), ChangeStoreError> {
        match self.stored_plan(id) {
            Err(ChangeStoreError::Unknown { .. }) => match self.drafts.get(id) {
                Some(held) => Ok(StoredPlan::clone(&held.0)).map(|plan| (plan, held.1)),
                None => Err(ChangeStoreError::Unknown { id: id.clone() }),
            },
            read => read,
        }
    }

    fn stored_plan(&self, id: &ChangeId) -> Result<(StoredPlan, u64), ChangeStoreError> {
        let (document, created_unix_s): (PlanDocument, u64) = self.read_document(id)?;
        let path = self.path(id, "bin");
        // Unknown where it was removed while it was read.
        let bytes = document::read_file(&path, id)?;
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

    /// A plan's scene and answer, without its pixels, and when it was stored, seconds since 1970.
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

    /// Ids with the time of storage, seconds since 1970, the newest first. What cannot be read is left out.
    ///
    /// # Errors
    /// [`ChangeStoreError::Io`] where the folder cannot be read.
    pub fn list(&self, kind: ChangeKind) -> Result<Vec<(ChangeId, u64)>, ChangeStoreError> {
        let entries = self.entries(kind)?.into_iter();
        let limit = unix_s(SystemTime::now()).saturating_sub(self.limits.age.as_secs());
        let ids = entries.map(|entry| (entry.id, unix_s(entry.modified)));
        Ok(ids.filter(|(_, modified_unix_s)| *modified_unix_s >= limit).collect())
    }

    /// The documents of a folder, the newest first.
    fn entries(&self, kind: ChangeKind) -> Result<Vec<Entry>, ChangeStoreError> {
        let folder = self.folder(kind);
        let files = match std::fs::read_dir(&folder) {
            Ok(files) => files,
            Err(error) if error.kind() == ErrorKind::NotFound => return Ok(Vec::new()),
            Err(error) => return Err(io(&folder)(error)),
        };
        let mut entries = Vec::new();
        for file in files {
            let path = file.map_err(io(&folder))?.path();
            let stem = path.file_stem().and_then(|stem| stem.to_str());
            let Some(id) = stem.and_then(|stem| ChangeId::parse(stem).ok()) else { continue };
            if path.extension().is_none_or(|extension| extension != "json") {
                continue;
            }
            // Another process may have removed it.
            let Ok(metadata) = std::fs::metadata(&path) else { continue };
            let Ok(modified) = metadata.modified() else { continue };
            let pixels = std::fs::metadata(path.with_extension("bin")).map_or(0, |metadata| metadata.len());
            entries.push(Entry { id, modified, bytes: metadata.len() + pixels });
        }
        entries.sort_by(|a, b| b.modified.cmp(&a.modified).then_with(|| a.id.cmp(&b.id)));
        Ok(entries)
    }

    /// Removes documents beyond the limits, the oldest first, never `newest`.
    fn evict(&self, kind: ChangeKind, newest: &ChangeId) -> Result<(), ChangeStoreError> {
        let now_s = unix_s(SystemTime::now());
        let (mut count, mut bytes) = (1, 0);
        for entry in self.entries(kind)?.into_iter().filter(|entry| entry.id != *newest) {
            count += 1;
            bytes += entry.bytes;
            let is_old = now_s.saturating_sub(unix_s(entry.modified)) > self.limits.age.as_secs();
            if is_old || count > self.limits.count || bytes > self.limits.bytes {
                // The document first: pixels without it count as removed.
                for extension in ["json", "bin"] {
                    let _may_be_gone_already = std::fs::remove_file(self.path(&entry.id, extension));
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

    /// A document with the time of storage; unknown where it is past its age.
    fn read_document<T: DeserializeOwned>(&self, id: &ChangeId) -> Result<(T, u64), ChangeStoreError> {
        let path = self.path(id, "json");
        let (content, created_unix_s) = document::read(&path, id)?;
        // A document based on it may have renewed it since.
        let modified =
            std::fs::metadata(&path).and_then(|metadata| metadata.modified()).map_err(io(&path))?;
        if self.is_past_age(modified) {
            return Err(ChangeStoreError::Unknown { id: id.clone() });
        }
        Ok((document::parse(&path, content)?, created_unix_s))
    }
}

/// A document of a folder.
struct Entry {
    id: ChangeId,
    modified: SystemTime,
    bytes: u64,
}
