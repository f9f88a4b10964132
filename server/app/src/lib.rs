//! What the program can be asked and what it answers, whoever asks: the command line and the HTTP interface share it.
//!
//! A question is read into a typed request ([`request`], against the table in [`parameters`]), the program behind
//! ([`source`]) answers, and the answer becomes JSON ([`answers`]), a picture ([`drawing`]) or a file ([`influence_file`],
//! [`plan_file`], [`shares_file`], [`horizon_file`], [`layer_file`], [`sky_lines`], [`parquet_table`]), or is found in parts ([`map_part`]). [`quantities`] names the numbers of a sky.

pub mod accept;
pub mod answers;
pub mod conversion;
pub mod drawing;
pub mod error;
pub mod facts;
pub mod fingerprint;
pub mod format;
pub mod horizon_file;
pub mod influence_file;
pub mod layer_file;
pub mod map_part;
pub mod negotiated_parameters;
pub mod observatory;
pub mod opening;
pub mod parameters;
pub mod parquet_table;
pub mod plan_file;
pub mod planning;
pub mod problem;
pub mod qgis_style;
pub mod quantities;
pub mod reader;
pub mod request;
pub mod sandbox;
pub mod shares_file;
mod sky_bodies;
pub mod sky_lines;
pub mod source;
pub mod standard_parameters;
pub mod stored;
pub mod upload_reader;
pub mod validation;

pub use error::AppError;
pub use observatory::ObservatorySource;
pub use source::SkySource;
pub use upload_reader::{UploadReader, read_upload};
