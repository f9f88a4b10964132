//! The HTTP interface: a thin router over what the program can be asked.
//!
//! A request passes the middleware (id, count, log; panics; limits), a handler has it read ([`skyglow_app::request`]), its ETag
//! is known before anything is rendered ([`etag`]), the program behind ([`skyglow_app::source`]) answers, and the answer gets
//! its headers ([`respond`]). Status codes are in one table in [`error`].

pub mod access;
pub mod app;
mod asker;
pub mod atlases;
pub mod basemap;
mod budget;
pub mod config;
mod document;
pub mod error;
pub mod etag;
mod fair;
mod jobs;
mod kept_store;
pub mod listener;
mod memory;
pub mod metrics;
pub mod middleware;
pub mod party;
mod poster;
pub mod problem;
mod progress;
mod refusals;
pub mod respond;
pub mod routes;
pub mod serve;
mod shared;
mod shared_counts;
pub mod state;
mod tile_file;
mod token_buckets;
pub mod trust;
mod valkey;
mod work_places;

pub use access::{Access, ApiKey};
pub use app::{openapi, router, router_beside, router_with_access};
pub use atlases::{Atlas, AtlasError};
pub use basemap::{Basemap, BasemapError};
pub use config::{HttpConfig, LoggedAddress};
pub use kept_store::{KeptStore, KeptStoreError};
pub use memory::{MemoryShares, TooLittleMemory};
pub use serve::serve;
pub use tile_file::TileFileError;
pub use valkey::{BadValkey, Valkey};
