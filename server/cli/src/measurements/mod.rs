//! Measured skies: the standard file of readings, and the calibration of a scene that fits them.

mod calibration;
mod ida;

pub(crate) use calibration::{Calibration, Compared, fit};
pub(crate) use ida::{Reading, read_ida};
