//! What an engine is made of.

use crate::request::DeviceChoice;
use skyglow_tables::resident::ResidentTables;
use std::sync::Arc;

/// What an engine is made of.
#[derive(Clone, Debug)]
pub struct EngineConfig {
    /// Which device to use.
    pub device: DeviceChoice,
    /// The packs to keep resident, in any order.
    pub tables: Vec<Arc<ResidentTables>>,
    /// Requests that may wait; one more is refused as busy.
    pub queue_capacity: usize,
    /// Most requests in one batch, 1..=[`crate::MAX_BATCH`].
    pub batch_limit: usize,
    /// Most bytes that packs and workspace may take on the device.
    pub budget_bytes: u64,
}

impl Default for EngineConfig {
    fn default() -> Self {
        Self {
            device: DeviceChoice::Auto,
            tables: Vec::new(),
            queue_capacity: 64,
            batch_limit: crate::MAX_BATCH,
            budget_bytes: 2 << 30,
        }
    }
}
