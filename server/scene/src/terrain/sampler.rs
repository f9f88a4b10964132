//! Elevations of one level of a raster, one after the other: neighbours are mostly in the tile that was looked into last.

use super::raster::TerrainRaster;
use super::tile::SIDE;
use std::sync::Arc;

/// A level of a raster with the tiles that were looked into last.
pub(super) struct Sampler<'a> {
    raster: &'a TerrainRaster,
    level: usize,
    size: (usize, usize),
    /// By the parity of their column and row: neighbours never evict each other.
    tiles: [(usize, Option<Arc<Vec<f32>>>); 4],
}

impl<'a> Sampler<'a> {
    /// Of a level, the coarsest where there are not so many.
    pub(super) fn new(raster: &'a TerrainRaster, level: usize) -> Self {
        let (level, size) = raster.level_size(level);
        Self { raster, level, size, tiles: std::array::from_fn(|_| (usize::MAX, None)) }
    }

    /// Elevation at a position in the finest level's columns and rows from the raster's corner, metres, by the rule of
    /// [`TerrainRaster::bilinear_m`].
    pub(super) fn bilinear_m(&mut self, (column, row): (f64, f64)) -> Option<f64> {
        let grid = self.raster.grid();
        let column = match grid.turn_columns() {
            Some(turn) if column < 0.0 || column >= f64::from(grid.width) => column.rem_euclid(turn),
            _ => column,
        };
        let is_inside =
            (0.0..f64::from(grid.width)).contains(&column) && (0.0..f64::from(grid.height)).contains(&row);
        if !is_inside {
            return None;
        }
        let samples = f64::from(1u32 << self.level);
        let (x, y) = (column / samples - 0.5, row / samples - 0.5);
        let split = |at: f64| {
            let first = at.floor();
            (first as i64, first as i64 + 1, at - first)
        };
        let (left, right, s) = split(x);
        let (above, below, t) = split(y);
        let four = [
            (left, above, (1.0 - s) * (1.0 - t)),
            (right, above, s * (1.0 - t)),
            (left, below, (1.0 - s) * t),
            (right, below, s * t),
        ];
        let (mut sum, mut total) = (0.0, 0.0);
        for (column, row, weight) in four {
            let elevation_m = self.sample(column, row);
            if elevation_m.is_finite() {
                sum += weight * f64::from(elevation_m);
                total += weight;
            }
        }
        (total >= 0.5).then(|| sum / total)
    }

    /// NaN for a void.
    fn sample(&mut self, column: i64, row: i64) -> f32 {
        let inside = |at: i64, count: usize| at.clamp(0, count as i64 - 1) as usize;
        let (column, row) = match (inside(column, self.size.0), inside(row, self.size.1)) {
            (c, r) if (c as i64, r as i64) == (column, row) => (c, r),
            // Where no raster lies, half a sample at the edge belongs to the edge sample.
            (c, r) => match self.raster.border_m(self.level, column, row) {
                border_m if border_m.is_finite() => return border_m,
                _ => (c, r),
            },
        };
        let (tile_column, tile_row) = (column / SIDE, row / SIDE);
        let number = tile_row * self.size.0.div_ceil(SIDE) + tile_column;
        let slot = &mut self.tiles[(tile_row & 1) * 2 + (tile_column & 1)];
        if slot.0 != number {
            *slot = (number, self.raster.cached(self.level, number));
        }
        slot.1.as_ref().map_or(f32::NAN, |samples| samples[row % SIDE * SIDE + column % SIDE])
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::terrain::synthetic_ground::{grid, hills_m, layer, place};

    /// On every level, at edges and beside voids it says what the raster does, and nothing outside.
    #[test]
    fn it_says_what_the_raster_does() {
        let hilly = layer(grid(7.0, 47.0, 300), |column, row| {
            if (column / 7 + row / 5) % 4 == 0 { f32::NAN } else { hills_m(column, row, 3) }
        });
        for level in [0, 1, 9] {
            let mut sampler = Sampler::new(&hilly, level);
            let mut voids = 0;
            for number in 0..5_000 {
                let of = |step: f64, from: f64| from + 3.0 * (f64::from(number) * step).fract();
                let at = place(of(0.754_877_666, 44.0), of(0.569_840_291, 7.0));
                let wanted = hilly.bilinear_m(level, at);
                let found = hilly.grid().position_of(at).and_then(|position| sampler.bilinear_m(position));
                voids += usize::from(wanted.is_none());
                assert_eq!(wanted.is_some(), found.is_some(), "{number}");
                assert!((wanted.unwrap_or_default() - found.unwrap_or_default()).abs() < 1e-6, "{number}");
            }
            assert_eq!(sampler.bilinear_m((-0.1, 5.0)), None);
            assert!(level > 0 || voids > 100, "{voids}");
        }
    }
}
