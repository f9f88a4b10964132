//! Counts pixels by kind, with a few example places of each, sampled evenly by decimation.

use crate::grid::Grid;
use crate::metadata::{ExamplePlace, PixelCount};
use skyglow_physics::GeoPoint;

/// Examples of each kind.
const EXAMPLES: usize = 5;

/// A count with examples spread over the raster: whenever the buffer is full, every other one is dropped and
/// the stride doubles.
#[derive(Clone, Debug, Default)]
pub(super) struct Tally {
    pub(super) count: u64,
    stride: u64,
    examples: Vec<(u32, u32)>,
}

impl Tally {
    pub(super) fn add(&mut self, column: u32, row: u32) {
        self.stride = self.stride.max(1);
        if self.count.is_multiple_of(self.stride) {
            if self.examples.len() == 2 * EXAMPLES {
                let mut index = 0;
                self.examples.retain(|_| {
                    index += 1;
                    index % 2 == 1
                });
                self.stride *= 2;
            }
            if self.count.is_multiple_of(self.stride) {
                self.examples.push((column, row));
            }
        }
        self.count += 1;
    }

    pub(super) fn finish(&self, grid: &Grid) -> PixelCount {
        let stride = self.examples.len().div_ceil(EXAMPLES).max(1);
        let picked = self.examples.iter().step_by(stride);
        let place = |&(column, row): &(u32, u32)| {
            let place = GeoPoint::from_vector(grid.center(column, row));
            ExamplePlace {
                latitude_deg: round(place.latitude_deg()),
                longitude_deg: round(place.longitude_deg()),
            }
        };
        let examples = picked.map(place).filter(|p| p.latitude_deg.is_finite()).collect();
        PixelCount { count: self.count, examples }
    }
}

/// To about a metre, for people.
fn round(degrees: f64) -> f64 {
    (degrees * 1e5).round() / 1e5
}
