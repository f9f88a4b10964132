//! Maximum mipmap (Tevs, Ihrke & Seidel 2008): upper bounds of the elevation over ranges of cells.
//!
//! A *cell* is the square between four neighbouring sample centres, on which elevation is bilinear and so nowhere
//! above the highest of the four. Cell (i, j) lies between samples i − 1 and i, j − 1 and j, clamped to those that
//! exist or lie around it: cells 0 and `width` are the halves of the edge samples that extend to the raster's edge. The pyramid's
//! lowest level has the maximum of blocks of 8 × 8 cells, each level above that of 2 × 2 blocks.

use super::border::Border;
use super::tile::SIDE;
use crate::grid::Grid;
use glam::DVec3;
use std::ops::RangeInclusive;

/// Cells along a side of a block of the lowest level, as a power of two.
const BLOCK_BITS: u32 = 3;
/// Cells along a side of a block of the lowest level.
pub(super) const BLOCK_CELLS: f64 = (1 << BLOCK_BITS) as f64;

/// The pyramid of a layer, and a circle around it.
#[derive(Debug)]
pub(super) struct MaxMipmap {
    levels: Vec<Level>,
    /// Centre of a circle that holds the layer, as a unit vector.
    pub(super) center: DVec3,
    /// Its angular radius, radians.
    pub(super) radius_rad: f64,
}

/// Maxima of blocks, metres, row by row; −∞ where a block has no valid sample.
#[derive(Clone, Debug)]
struct Level {
    width: usize,
    height: usize,
    highest_m: Vec<f32>,
}

impl Level {
    fn void(width: usize, height: usize) -> Self {
        Self { width, height, highest_m: vec![f32::NEG_INFINITY; width * height] }
    }

    fn raise(&mut self, column: usize, row: usize, height_m: f32) {
        let block = &mut self.highest_m[row * self.width + column];
        *block = block.max(height_m);
    }
}

impl MaxMipmap {
    /// Of all samples of a raster, on as many threads as there are cores.
    ///
    /// * `border`: the samples around it.
    /// * `unpacked`: the samples of a tile by its number; `None` for one without any.
    pub(super) fn new(
        grid: &Grid,
        border: Option<&Border>,
        unpacked: impl Fn(usize) -> Option<Vec<f32>> + Sync,
    ) -> Self {
        let tile_count = (grid.width as usize).div_ceil(SIDE) * (grid.height as usize).div_ceil(SIDE);
        let void = Level::void(block_count(grid.width), block_count(grid.height));
        let threads = std::thread::available_parallelism().map_or(1, usize::from).min(tile_count);
        // Plain threads: a pool that steals work could come back here while this layer is being made.
        let parts: Vec<Level> = std::thread::scope(|scope| {
            let unpacked = &unpacked;
            let part = |first: usize, mut level: Level| {
                move || {
                    for number in (first..tile_count).step_by(threads) {
                        if let Some(samples) = unpacked(number) {
                            raise_by_tile(&mut level, grid, number, &samples);
                        }
                    }
                    level
                }
            };
            let workers: Vec<_> = (0..threads).map(|first| scope.spawn(part(first, void.clone()))).collect();
            workers.into_iter().map(|worker| worker.join().unwrap_or_else(|_| void.clone())).collect()
        });
        let mut lowest = void;
        for part in parts {
            lowest.highest_m.iter_mut().zip(part.highest_m).for_each(|(all, one)| *all = all.max(one));
        }
        for (column, row, height_m) in border.into_iter().flat_map(Border::known) {
            raise_by_border(&mut lowest, grid, (column, row), height_m);
        }
        Self::above(grid, lowest)
    }

    /// From the maxima of the lowest level, row by row; None where they are not as many as the grid has blocks.
    pub(super) fn of_lowest(grid: &Grid, highest_m: Vec<f32>) -> Option<Self> {
        let [width, height] = [grid.width, grid.height].map(block_count);
        let fits = highest_m.len() == width * height && highest_m.iter().all(|height_m| !height_m.is_nan());
        fits.then(|| Self::above(grid, Level { width, height, highest_m }))
    }

    /// The maxima of the lowest level as bytes.
    pub(super) fn lowest_bytes(&self) -> &[u8] {
        bytemuck::cast_slice(&self.levels[0].highest_m)
    }

    /// The levels above the lowest.
    fn above(grid: &Grid, lowest: Level) -> Self {
        let mut levels = vec![lowest];
        while let Some(below) = levels.last().filter(|level| level.highest_m.len() > 1) {
            levels.push(halved(below));
        }
        let (center, radius_rad) = grid.cap();
        Self { levels, center, radius_rad }
    }

    /// The highest sample of the layer, metres; −∞ if there is none.
    pub(super) fn highest_m(&self) -> f64 {
        self.levels.last().map_or(f64::NEG_INFINITY, |top| f64::from(top.highest_m[0]))
    }

    /// At least the elevation of every point in a range of cells, metres; −∞ where there is no ground. Cells beyond
    /// the last count as the last.
    pub(super) fn max_over_m(&self, columns: RangeInclusive<usize>, rows: RangeInclusive<usize>) -> f64 {
        let extent = (columns.end() - columns.start()).max(rows.end() - rows.start());
        // Blocks at least as large as the range: it touches at most two of them along each axis.
        let level = (usize::BITS - (extent >> BLOCK_BITS).leading_zeros()) as usize;
        let level = level.min(self.levels.len() - 1);
        let blocks = &self.levels[level];
        let shift = BLOCK_BITS as usize + level;
        let block = |cell: &usize, count: usize| (cell >> shift).min(count - 1);
        let mut highest_m = f32::NEG_INFINITY;
        for row in block(rows.start(), blocks.height)..=block(rows.end(), blocks.height) {
            for column in block(columns.start(), blocks.width)..=block(columns.end(), blocks.width) {
                highest_m = highest_m.max(blocks.highest_m[row * blocks.width + column]);
            }
        }
        f64::from(highest_m)
    }
}

/// Blocks of the lowest level along so many samples.
fn block_count(samples: u32) -> usize {
    (samples >> BLOCK_BITS) as usize + 1
}

/// Raises the blocks of all cells that the samples of a tile are corners of.
fn raise_by_tile(level: &mut Level, grid: &Grid, number: usize, samples: &[f32]) {
    let (width, height) = (grid.width as usize, grid.height as usize);
    let tile_columns = width.div_ceil(SIDE);
    let (left, top) = (number % tile_columns * SIDE, number / tile_columns * SIDE);
    for (row, line) in (top..height).zip(samples.chunks_exact(SIDE)) {
        for (column, &height_m) in (left..width).zip(line) {
            if !height_m.is_finite() {
                continue;
            }
            // A sample is a corner of cells `column` and `column + 1`.
            let (c0, c1) = (column >> BLOCK_BITS, (column + 1) >> BLOCK_BITS);
            let (r0, r1) = (row >> BLOCK_BITS, (row + 1) >> BLOCK_BITS);
            level.raise(c0, r0, height_m);
            if c1 != c0 || r1 != r0 {
                level.raise(c1, r0, height_m);
                level.raise(c0, r1, height_m);
                level.raise(c1, r1, height_m);
            }
        }
    }
}

/// Raises the blocks of the cells that a sample just outside of the raster is a corner of.
fn raise_by_border(level: &mut Level, grid: &Grid, (column, row): (i64, i64), height_m: f32) {
    let blocks = |sample: i64, count: u32| {
        let cell = |at: i64| at.clamp(0, i64::from(count)) as usize >> BLOCK_BITS;
        [cell(sample), cell(sample + 1)]
    };
    for row in blocks(row, grid.height) {
        for column in blocks(column, grid.width) {
            level.raise(column, row, height_m);
        }
    }
}

fn halved(below: &Level) -> Level {
    let mut level = Level::void(below.width.div_ceil(2), below.height.div_ceil(2));
    for row in 0..below.height {
        for column in 0..below.width {
            level.raise(column / 2, row / 2, below.highest_m[row * below.width + column]);
        }
    }
    level
}
