//! The HTTP interface: a router over the engine.
//!
//! A request passes the layers (id, count, log; panics; limits), a handler parses it into a typed request
//! ([`request`], against the table in [`parameters`]), its ETag is known before anything is rendered
//! ([`etag`]), the program behind ([`source`]) answers, and the answer gets its headers ([`respond`]).
//! Status codes are in one table in [`error`].

pub mod accept;
pub mod access;
pub mod answers;
pub mod app;
pub mod config;
pub mod drawing;
pub mod error;
pub mod etag;
pub mod influence_file;
pub mod kept;
pub mod kind_facts;
pub mod layers;
pub mod listener;
pub mod metrics;
pub mod observatory;
pub mod parameters;
pub mod plan_file;
pub mod planning;
pub mod problem;
mod program;
pub mod reader;
pub mod request;
pub mod respond;
pub mod routes;
pub mod serve;
pub mod source;
pub mod stamp;
pub mod state;
mod trust;
pub mod upload_reader;

pub use access::{Access, ApiKey};
pub use app::{openapi, router, router_with_access};
pub use config::HttpConfig;
pub use observatory::ObservatorySource;
pub use serve::serve;
pub use source::SkySource;
pub use upload_reader::{UploadReader, read_upload};
