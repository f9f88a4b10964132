//! How much memory an observatory may keep for the next question.

use skyglow_scene::memory_limit_bytes;

/// Bytes of memory for what is kept.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct CacheSizes {
    /// Open scenes; one may take all of it.
    pub scenes_bytes: u64,
    /// Scenes with changes, beside what they share with the scene itself.
    pub changed_scenes_bytes: u64,
    /// Light by cells and pixels, for the next map of influences from the same place.
    pub light_bytes: u64,
    /// Requests made ready, for the next measure of the same light under the same air.
    pub ready_requests_bytes: u64,
}

/// Of the memory that there is, a program that does nothing else has a third for open scenes.
const PART_FOR_SCENES: u64 = 3;
/// Bytes of open scenes where nobody says how much memory there is.
const SCENES_BYTES_IF_UNKNOWN: u64 = 8 << 30;

impl CacheSizes {
    /// The most that is of use, but for open scenes: of those as many as are given.
    pub const fn most(scenes_bytes: u64) -> Self {
        Self {
            scenes_bytes,
            changed_scenes_bytes: 512 << 20,
            light_bytes: 256 << 20,
            ready_requests_bytes: 128 << 20,
        }
    }

    /// For a program that does nothing else on this machine.
    pub fn of_machine() -> Self {
        Self::most(memory_limit_bytes().map_or(SCENES_BYTES_IF_UNKNOWN, |bytes| bytes / PART_FOR_SCENES))
    }
}
