//! Sources behind skylines: images of sources whose light below a blocking angle is cut off.
//!
//! The tables stand on coarser axes than the open ones and hold differences to them: the logarithm of the cut scale over
//! the open one, and the cut shape coefficients less the open ones, over the first functions of the pack's own basis.
//! What haze and altitude do to both alike is then in the open tables, which are finer. Angles are those of
//! [`skyglow_physics::blocking::BLOCKING_ANGLES_DEG`] but the first; the offset axis of each has a node where its cone
//! meets the observer ([`crate::OffsetAxis::behind_skyline`]).

mod later;
mod stage;
mod tables;

use crate::{axes::logarithmic, multiple::FieldResolution};
use serde::{Deserialize, Serialize};
use skyglow_physics::blocking::{BLOCKING_ANGLES_DEG, BLOCKING_COUNT};

pub(crate) use stage::{BlockedJob, make_blocked};
pub(crate) use tables::BlockedTables;

/// Number of angles with tables: all but the open sky.
pub(crate) const ANGLE_COUNT: usize = BLOCKING_COUNT - 1;

/// Blocking angle of place `angle_index` of the tables, degrees.
pub(crate) fn blocking_deg(angle_index: usize) -> f64 {
    BLOCKING_ANGLES_DEG[angle_index + 1]
}

/// The sample points of sources behind skylines.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct BlockedAxes {
    /// Distances, metres, ascending, even in the logarithm.
    pub distance_m: Vec<f64>,
    /// Observer altitudes, metres, ascending; beyond the last one the difference to the open tables stays what it is.
    pub observer_altitude_m: Vec<f64>,
    /// Number of nodes of the offset axis at every distance and angle, at least 3.
    pub offset_count: usize,
    /// Number of basis functions, those of the pack from the first on; a multiple of 4.
    pub basis_count: usize,
    /// Sample points of later orders, where scattering is multiple.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub later: Option<LaterAxes>,
}

/// The sample points of the later orders of scattering of cut sources, which are stored as parts of those of open ones.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct LaterAxes {
    /// Altitudes of the ground and of the source on it, metres, ascending.
    pub ground_altitude_m: Vec<f64>,
    /// Offsets of the source from observers at its altitude and above, metres, ascending to 0.
    pub offset_m: Vec<f64>,
    /// Panorama columns, ascending from 0 to 128.
    pub column: Vec<usize>,
    /// How finely the fields of cut and open sources are solved whose ratio is taken: a coarse one is enough, for both
    /// have the same errors (`docs/notebook/2026-11-21.md`: 0.1, 0.6 and 3.4 % of the part in the mean at 1, 4
    /// and 16°).
    pub field_resolution: FieldResolution,
}

impl BlockedAxes {
    /// The axes of the packs that come with the program.
    pub fn full() -> Self {
        Self {
            distance_m: logarithmic(20),
            observer_altitude_m: vec![0.0, 700.0, 1_900.0, 4_200.0],
            offset_count: 9,
            basis_count: 32,
            later: Some(LaterAxes {
                ground_altitude_m: vec![0.0, 1_500.0, 5_000.0],
                offset_m: vec![-6_000.0, -2_500.0, -900.0, -250.0, 0.0],
                column: vec![0, 2, 5, 9, 14, 20, 28, 38, 50, 64, 80, 97, 114, 128],
                field_resolution: FieldResolution::Coarse,
            }),
        }
    }

    /// Few points, made in seconds: for tests of everything but accuracy.
    pub fn coarse() -> Self {
        Self {
            distance_m: logarithmic(3),
            observer_altitude_m: vec![0.0],
            offset_count: 3,
            basis_count: 8,
            later: Some(LaterAxes {
                ground_altitude_m: vec![0.0],
                offset_m: vec![-1_500.0, 0.0],
                column: vec![0, 32, 128],
                field_resolution: FieldResolution::Coarse,
            }),
        }
    }

    /// Number of nodes, each a scale and [`Self::basis_count`] coefficients.
    pub(crate) fn node_count(&self) -> usize {
        self.observer_altitude_m.len()
            * ANGLE_COUNT
            * crate::layout::IMAGE_COUNT
            * self.distance_m.len()
            * self.offset_count
    }
}
