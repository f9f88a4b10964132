//! Lists of what is stored: what they say of each, who sees what, and pages.

use super::change_id::ChangeId;
use super::posting::Owner;
use super::stored::{Scenario, StoredPlan};
use crate::scene_id::SceneId;
use serde::de::IgnoredAny;
use serde::{Deserialize, Serialize};
use std::fmt;

/// What lists say of a scenario or plan, by its kind.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum Outline {
    /// Of a scenario.
    Scenario {
        /// Its name for people.
        title: Option<String>,
        /// Number of its edits.
        edit_count: usize,
    },
    /// Of a plan.
    Plan {
        /// Its method.
        method: String,
        /// Number of its sites.
        site_count: usize,
        /// Upward flux that goes, DNB watts.
        flux_removed_dnb_w: f64,
        /// Part of the flux within reach.
        flux_removed_share: f64,
    },
}

/// What an index reads of a document.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Outlined {
    pub(super) scene: SceneId,
    pub(super) base: Option<ChangeId>,
    pub(super) outline: Outline,
}

/// A scenario's document but for its edits.
#[derive(Deserialize)]
pub(super) struct ScenarioParts {
    scene: SceneId,
    title: Option<String>,
    base: Option<ChangeId>,
    edits: Vec<IgnoredAny>,
}

/// A plan's document but for most of its answer.
#[derive(Deserialize)]
pub(super) struct PlanParts {
    scene: SceneId,
    base: Option<ChangeId>,
    answer: AnswerParts,
}

#[derive(Default, Deserialize)]
#[serde(default)]
struct AnswerParts {
    method: Option<String>,
    sites: Vec<IgnoredAny>,
    flux_removed_dnb_w: Option<f64>,
    flux_removed_share: Option<f64>,
}

impl From<ScenarioParts> for Outlined {
    fn from(ScenarioParts { scene, title, base, edits }: ScenarioParts) -> Self {
        Self { scene, base, outline: Outline::Scenario { title, edit_count: edits.len() } }
    }
}

impl From<PlanParts> for Outlined {
    fn from(PlanParts { scene, base, answer }: PlanParts) -> Self {
        let outline = Outline::Plan {
            method: answer.method.unwrap_or_default(),
            site_count: answer.sites.len(),
            flux_removed_dnb_w: answer.flux_removed_dnb_w.unwrap_or_default(),
            flux_removed_share: answer.flux_removed_share.unwrap_or_default(),
        };
        Self { scene, base, outline }
    }
}

impl From<&Scenario> for Outlined {
    fn from(scenario: &Scenario) -> Self {
        let outline = Outline::Scenario { title: scenario.title.clone(), edit_count: scenario.edits.len() };
        Self { scene: scenario.scene.clone(), base: scenario.base.clone(), outline }
    }
}

impl From<&StoredPlan> for Outlined {
    fn from(plan: &StoredPlan) -> Self {
        let answer = AnswerParts::deserialize(&plan.answer).unwrap_or_default();
        PlanParts { scene: plan.scene.clone(), base: plan.base.clone(), answer }.into()
    }
}

/// A scenario or plan in a list.
#[derive(Clone, Debug, PartialEq)]
pub struct Listed {
    /// Its id.
    pub id: ChangeId,
    /// The scenario or plan that it is based on.
    pub base: Option<ChangeId>,
    /// When it was stored, seconds since 1970.
    pub created_unix_s: u64,
    /// What else is said of it.
    pub outline: Outline,
}

/// Who looks at a list.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Viewer {
    /// Somebody: sees what is listed.
    Anyone,
    /// Sees in addition what is theirs.
    Owner(Owner),
    /// The operator: sees all.
    Operator,
}

/// A place in a list, the newest first: before the older ones.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Cursor {
    /// When what stands before it was stored, nanoseconds since 1970.
    pub created_unix_ns: u64,
    /// What stands before it.
    pub id: ChangeId,
}

impl Cursor {
    /// From its text.
    pub fn parse(text: &str) -> Option<Self> {
        let (created_unix_ns, id) = text.split_once('.')?;
        Some(Self { created_unix_ns: created_unix_ns.parse().ok()?, id: ChangeId::parse(id).ok()? })
    }
}

impl fmt::Display for Cursor {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}.{}", self.created_unix_ns, self.id)
    }
}

/// Part of a list, the newest first.
#[derive(Clone, Debug, PartialEq)]
pub struct Page<T> {
    /// What is in it.
    pub entries: Vec<T>,
    /// Where the next part begins, if there is more.
    pub next: Option<Cursor>,
}
