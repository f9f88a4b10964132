//! Run time against error: panoramas of growing scenes on every executor that there is, beside two baselines timed in the
//! same run on the same threads, beside the least time that the machine would need, and beside the reference.
//!
//! The baselines are the direct sum over every source ([`sampled_sum`]) and the accumulation of interpolated source images
//! ([`accumulation`], [`image_mixing`]), as in Fig. 6 of Dobashi, Ishikawa and Iwasaki (2023). Whatever was timed in part
//! and scaled says so in its row.

pub mod accumulation;
pub mod accuracy;
mod baselines;
mod batches;
pub mod error;
pub mod executors;
pub mod image_mixing;
mod images;
pub mod machine;
pub mod options;
mod output;
pub mod plots;
pub mod reference;
pub mod report;
pub mod roofline;
mod rows;
pub mod run;
pub mod sampled_sum;
pub mod scenes;
mod skies;
pub mod targets;
pub mod text;

pub use error::BenchError;
pub use options::{BenchOptions, Extent};
pub use report::Report;
pub use run::run;
pub use text::{Section, sections};
