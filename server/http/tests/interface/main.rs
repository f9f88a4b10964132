//! The interface over real HTTP on loopback, with a program behind it that counts, waits, fails or panics as told.

#![expect(clippy::unwrap_used, reason = "helpers of tests may fail as tests do")]

mod atlases;
mod budgets;
mod caching;
mod clients;
mod document;
mod end_to_end;
mod fake;
mod formats;
mod fuzz;
mod limits;
mod notes;
mod observing;
mod problems;
mod resources;
mod scattering;
mod server;
mod standards;
