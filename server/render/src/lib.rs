//! From a polar grid of light to a panorama: table packs resident on a device, the passes of the fast evaluation
//! (`docs/model.md#rendering`), batches, read-back. The only crate that names wgpu.
//!
//! A request is prepared on the caller's thread ([`prepare`]: what must be computed, as lists), waits in a bounded
//! queue, and is rendered together with compatible ones by the one thread that owns the device. Two executors
//! run the same passes: WGSL on Vulkan, and plain Rust ([`twin`] holds the functions they share).

pub mod celestial;
mod config;
pub mod cpu;
mod device;
pub mod engine;
pub mod error;
mod executor;
mod gpu;
mod job;
pub mod light_share;
pub mod near_field;
mod node_norms;
mod node_table;
pub mod pack_kind;
pub mod packs;
pub mod plan;
mod post_process;
pub mod prepare;
pub mod reference;
pub mod request;
pub mod ring_axis;
pub mod shaders;
pub mod stats;
pub mod synthetic;
pub mod table_set;
pub mod truncation;
pub mod twin;
mod worker;

pub use config::EngineConfig;
pub use engine::{Engine, EngineInfo};
pub use error::{DeviceFault, RenderError};
pub use gpu::rates::{DeviceRates, RatesExtent, Timer, device_rates};
pub use near_field::NearFieldCorrection;
pub use pack_kind::{PackKind, ResidentKind};
pub use packs::{LeftOutPack, UndamagedTables, resident_tables, undamaged_tables};
pub use request::{DeviceChoice, ExecutorKind, PassTime, RenderRequest, Rendered, WorkCount};
pub use stats::EngineStats;
pub use table_set::TableSet;
pub use truncation::{BasisChooser, BasisWithin};

/// Most requests in one batch.
pub const MAX_BATCH: usize = 8;
/// Most nodes that the requests of one batch may mix, unless one request alone needs more.
pub const MAX_BATCH_NODES: usize = 8192;
/// Most lit cells that the requests of one batch may have: as many as one grid can with light at every blocking angle.
pub const MAX_BATCH_CELLS: usize =
    skyglow_physics::blocking::BLOCKING_COUNT * skyglow_physics::AZIMUTH_COUNT * skyglow_scene::RING_COUNT;
