//! The interface over real HTTP on loopback, with a program behind it that counts, waits, fails or panics as told.

mod caching;
mod document;
mod fake;
mod formats;
mod fuzz;
mod limits;
mod problems;
mod resources;
mod server;
mod whole;
