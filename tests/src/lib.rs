//! Rules that no single crate can keep: which crate may use which, and what must be absent where.
//!
//! Each rule is a pure function from facts (a dependency list, a text) to violations in plain words, so that
//! `tests/architecture.rs` can hold it against the real tree and against a tree that breaks it.

pub mod cycles;
pub mod documents;
pub mod forbidden_words;
mod imports;
pub mod layering;
pub mod outside;
pub mod packs;
pub mod test_names;
pub mod tree;
