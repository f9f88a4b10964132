//! The engine as a Python module. [`answers`] knows no Python: it answers addresses of the HTTP interface without HTTP, by what
//! `skyglow-app` has for the command line and the server alike. `module` makes a Python class of it.
//!
//! An extension module finds Python's functions in the interpreter that opens it, so no program can be linked with it. `cargo test`
//! would do just that; in a test build the module is left out, and what is tested is the rest.

pub mod addresses;
pub mod answers;
pub mod map_parts;
#[cfg(not(test))]
mod module;
#[cfg(not(test))]
mod waiting;
