//! Rules that no single crate can keep: which crate may use which, and what must be absent where.
//!
//! Each rule is a pure function from facts (a dependency list, a text) to violations in plain words, so that
//! `tests/architecture.rs` can hold it against the real tree and against a tree that breaks it.

pub mod absences;
pub mod arrows;
pub mod circles;
pub mod class_errors;
pub mod class_scenes;
pub mod documents;
mod imports;
pub mod lit_areas;
pub mod lobe_sum;
pub mod lobe_truth;
pub mod merged_sources;
pub mod open_sky;
pub mod outside;
pub mod packs;
pub mod places;
pub mod sky_errors;
pub mod test_names;
pub mod tree;
