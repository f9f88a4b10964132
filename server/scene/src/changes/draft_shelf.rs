//! Drafts where other servers find them too, for as long as in memory: each holds its own, and takes over what it is asked for.

use super::change_id::ChangeId;
use super::drafts::{DraftShelf, Drafts, Held};
use super::pixels;
use super::posting::{Account, Networks};
use super::store::{ChangeStore, PlanDocument};
use super::stored::StoredPlan;
use serde::{Deserialize, Serialize};
use std::sync::Arc;

/// Networks are not written out where there is no shelf, so no secret has to hide them.
const NO_KEY: [u8; 32] = [0; 32];

/// A draft but for its pixels.
#[derive(Serialize, Deserialize)]
struct Shelved {
    held_unix_s: u64,
    networks: Networks,
    plan: PlanDocument,
}

impl ChangeStore {
    /// The same with drafts that other servers find.
    #[must_use]
    pub fn with_shelf(self, shelf: Arc<dyn DraftShelf>) -> Self {
        Self { shelf: Some(shelf), ..self }
    }

    /// Puts a draft where other servers find it, if there is such a place; whom it counts for.
    pub(super) fn shelve(
        &self,
        id: &ChangeId,
        plan: &StoredPlan,
        account: &Account,
        held_unix_s: u64,
    ) -> Networks {
        // No key is made where there is no shelf.
        let Some((shelf, key)) = self.shelf.as_ref().and_then(|shelf| Some((shelf, self.key.get().ok()?)))
        else {
            return Drafts::networks(id, account, &NO_KEY);
        };
        let networks = Drafts::networks(id, account, key);
        if let Some(bytes) = to_bytes(plan, networks, held_unix_s) {
            shelf.put(id.as_str(), &bytes);
        }
        networks
    }

    /// A draft, held here or by another server.
    pub(super) fn draft(&self, id: &ChangeId) -> Option<Held> {
        if let Some(held) = self.drafts.get(id) {
            return Some(held);
        }
        let bytes = self.shelf.as_ref().filter(|_| id.is_plan())?.get(id.as_str())?;
        let (plan, networks, held_unix_s) = from_bytes(&bytes)?;
        self.drafts.hold(id, plan, networks, held_unix_s);
        self.drafts.get(id)
    }
}

/// The length of the JSON, the JSON, the pixels.
fn to_bytes(plan: &StoredPlan, networks: Networks, held_unix_s: u64) -> Option<Vec<u8>> {
    let pixels = pixels::pack(plan).ok()?;
    let plan = PlanDocument {
        scene: plan.scene.clone(),
        scene_version: plan.scene_version.clone(),
        base: plan.base.clone(),
        answer: plan.answer.clone(),
        pixels_blake3: blake3::hash(&pixels).to_hex().to_string(),
    };
    let json = serde_json::to_vec(&Shelved { held_unix_s, networks, plan }).ok()?;
    Some([&u32::try_from(json.len()).ok()?.to_le_bytes(), json.as_slice(), &pixels].concat())
}

/// None where the bytes are not whole.
fn from_bytes(bytes: &[u8]) -> Option<(StoredPlan, Networks, u64)> {
    let (length, rest) = bytes.split_first_chunk::<4>()?;
    let (json, pixels) = rest.split_at_checked(u32::from_le_bytes(*length) as usize)?;
    let Shelved { held_unix_s, networks, plan } = serde_json::from_slice(json).ok()?;
    if blake3::hash(pixels).to_hex().as_str() != plan.pixels_blake3 {
        return None;
    }
    let (factors, effects) = pixels::unpack(pixels).ok()?;
    let PlanDocument { scene, scene_version, base, answer, .. } = plan;
    Some((StoredPlan { scene, scene_version, base, answer, factors, effects }, networks, held_unix_s))
}
