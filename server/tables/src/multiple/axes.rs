//! The sample points of multiply scattered light, and how finely its fields are solved.

use crate::{
    axes::logarithmic,
    clouds::{Clouds, MIN_SOURCE_M, altitudes_below, clamped_below_clouds_m},
    layout::IMAGE_COUNT,
};
use serde::{Deserialize, Serialize};
use skyglow_physics::{CloudBase, ELEVATION_COUNT, multiple_scattering::Resolution};

/// Offsets are interpolated in asinh(Δ/this), metres.
const OFFSET_SCALE_M: f64 = 150.0;
/// Version of the solver of later orders and of how its fields are laid out and interpolated: raised with either, so that no
/// run resumes from parts of another version.
const FIELD_VERSION: u32 = 5;

/// What offsets are interpolated in.
pub(crate) fn stretched_offset(offset_m: f64) -> f64 {
    (offset_m / OFFSET_SCALE_M).asinh()
}

/// How finely fields are solved.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum FieldResolution {
    /// [`Resolution::table`].
    Table,
    /// [`Resolution::coarse`], for ratios of fields and for tests.
    Coarse,
}

impl FieldResolution {
    pub(crate) fn resolution(self) -> Resolution {
        match self {
            Self::Table => Resolution::table(),
            Self::Coarse => Resolution::coarse(),
        }
    }
}

/// The sample points of multiply scattered light.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct MultipleAxes {
    /// Version of the solver of the fields and of their layout.
    pub field_version: u32,
    /// Distances of sources, metres, ascending. Not those of a pack: light that is smooth along the distance needs no node
    /// where a pack has one, and packs of other distances are made from the same fields.
    #[serde(default)]
    pub distance_m: Vec<f64>,
    /// Lambertian albedo of the ground, 0..=1.
    pub ground_albedo: f64,
    /// Altitudes ℓ of the ground, metres, ascending. The lowest may lie below the sea: no source does, but packs have
    /// nodes there for those above to be interpolated with, and an end of the fields before theirs is a kink.
    pub ground_altitude_m: Vec<f64>,
    /// Offsets Δ, metres, ascending; those above 0 only over grounds from the sea on.
    pub offset_m: Vec<f64>,
    /// Further ones above 0 over grounds in the haze, metres.
    #[serde(default)]
    pub haze_offset_m: Vec<f64>,
    /// Highest ground that has those, metres; grounds below the sea have none.
    #[serde(default)]
    pub haze_top_m: f64,
    /// Panorama columns, ascending from 0 to 128.
    pub column: Vec<usize>,
    /// How finely the fields are solved.
    pub field_resolution: FieldResolution,
}

impl MultipleAxes {
    /// The axes of the packs that come with the program.
    pub fn full(ground_albedo: f64) -> Self {
        Self {
            field_version: FIELD_VERSION,
            distance_m: logarithmic(56),
            ground_albedo,
            ground_altitude_m: vec![
                -2_000.0, -1_000.0, -450.0, 0.0, 300.0, 700.0, 1_400.0, 2_600.0, 4_200.0, 6_000.0,
            ],
            offset_m: vec![
                -6_000.0, -4_000.0, -3_200.0, -2_500.0, -2_000.0, -1_500.0, -900.0, -500.0, -250.0, -100.0,
                0.0, 100.0, 500.0, 1_200.0, 3_500.0,
            ],
            haze_offset_m: vec![30.0, 220.0],
            haze_top_m: 1_000.0,
            column: vec![0, 1, 2, 4, 6, 9, 12, 16, 20, 25, 31, 38, 46, 55, 65, 76, 88, 101, 114, 128],
            field_resolution: FieldResolution::Table,
        }
    }

    /// The same below a layer of cloud.
    pub fn below(self, clouds: Clouds) -> Self {
        // Grounds below the sea stay as far down as sources are, and so does the sea.
        let lowest = self.ground_altitude_m.partition_point(|&ground_m| ground_m < MIN_SOURCE_M);
        let sea = self.ground_altitude_m.partition_point(|&ground_m| ground_m < 0.0);
        let (below_sea_m, clear_m) = self.ground_altitude_m.split_at(sea);
        let ground_altitude_m = [&below_sea_m[lowest..], &altitudes_below(clear_m, clouds)].concat();
        Self { ground_altitude_m, ..self }
    }

    /// Few points, for tests of everything but accuracy.
    pub fn coarse(ground_albedo: f64) -> Self {
        Self {
            distance_m: logarithmic(10),
            ground_altitude_m: vec![0.0, 3_000.0],
            offset_m: vec![-2_000.0, 0.0],
            haze_offset_m: vec![400.0],
            column: vec![0, 16, 64, 128],
            field_resolution: FieldResolution::Coarse,
            ..Self::full(ground_albedo)
        }
    }

    /// Offsets over a ground, metres, ascending. Below a cloud sources and observers are clamped under it, and offsets end
    /// where they are.
    pub(super) fn offsets_over_m(&self, ground: usize, cloud: Option<CloudBase>) -> Vec<f64> {
        let ground_m = self.ground_altitude_m[ground];
        // Above 0 the ground is the observer's, and no observer is below the sea.
        let has_raised = ground_m >= 0.0;
        let mut offsets: Vec<f64> =
            self.offset_m.iter().copied().filter(|&offset_m| has_raised || offset_m <= 0.0).collect();
        if (0.0..=self.haze_top_m).contains(&ground_m) {
            offsets.extend(&self.haze_offset_m);
            offsets.sort_by(f64::total_cmp);
        }
        for offset_m in &mut offsets {
            let higher_m = clamped_below_clouds_m(ground_m + offset_m.abs(), cloud);
            *offset_m = offset_m.signum() * (higher_m - ground_m).min(offset_m.abs());
        }
        offsets.dedup();
        offsets
    }

    /// Number of (ground, offset) pairs.
    pub(crate) fn part_count(&self, cloud: Option<CloudBase>) -> usize {
        (0..self.ground_altitude_m.len()).map(|ground| self.offsets_over_m(ground, cloud).len()).sum()
    }

    /// Numbers of the table of one (ground, offset).
    pub(crate) fn part_len(&self) -> usize {
        self.distance_m.len() * ELEVATION_COUNT * self.column.len() * IMAGE_COUNT
    }
}
