//! Mask of measured pixels: run-length encoded rows, with a pyramid of counts over blocks.
//!
//! Zero is a measurement (dark ground); no-data and NaN are none.

use crate::grid::Grid;
use crate::sections::{Flaw, Sections};
use std::borrow::Cow;

/// Blocks of the coarse counts are 2^BLOCK_SHIFT pixels a side.
const BLOCK_SHIFT: u32 = 4;

/// The valid pixels of a raster of `width` × `height`.
#[derive(Clone, Debug, Default)]
pub(crate) struct ValidMask {
    width: u32,
    height: u32,
    /// Runs of row r are `runs[row_start[r]..row_start[r + 1]]`.
    row_start: Vec<u32>,
    /// First column and the one after the last of each run, ascending within a row.
    runs: Vec<[u32; 2]>,
    /// Valid pixels of each block of 16 × 16, row by row, then of blocks of 32 × 32 and so on up.
    coarse: Vec<CoarseLevel>,
}

#[derive(Clone, Debug, Default)]
struct CoarseLevel {
    columns: u32,
    counts: Vec<u32>,
}

impl ValidMask {
    /// A mask to which rows are pushed from the top.
    pub(crate) fn begin(width: u32) -> Self {
        Self { width, height: 0, row_start: vec![0], runs: Vec::new(), coarse: Vec::new() }
    }

    /// Adds one row given by a flag for each column.
    pub(crate) fn push_row(&mut self, valid: impl Iterator<Item = bool>) {
        let mut start = None;
        let mut column = 0u32;
        for is_valid in valid {
            match (is_valid, start) {
                (true, None) => start = Some(column),
                (false, Some(first)) => {
                    self.runs.push([first, column]);
                    start = None;
                }
                _ => {}
            }
            column += 1;
        }
        if let Some(first) = start {
            self.runs.push([first, column]);
        }
        self.row_start.push(self.runs.len() as u32);
        self.height += 1;
    }

    /// Ends the pushing: counts the blocks.
    pub(crate) fn finish(mut self) -> Self {
        self.coarse = self.count_blocks();
        self
    }

    /// From stored parts; `None` when they contradict each other.
    pub(crate) fn from_parts(
        width: u32,
        height: u32,
        row_start: Vec<u32>,
        runs: Vec<[u32; 2]>,
    ) -> Option<Self> {
        let whole = row_start.len() == height as usize + 1
            && row_start.first() == Some(&0)
            && row_start.last().map(|&n| n as usize) == Some(runs.len())
            && row_start.windows(2).all(|w| w[0] <= w[1])
            && runs.iter().all(|r| r[0] < r[1] && r[1] <= width);
        whole.then(|| Self { width, height, row_start, runs, coarse: Vec::new() }.finish())
    }

    /// The sections `row_start` and `runs`.
    pub(crate) fn to_sections(&self) -> [(String, Cow<'_, [u8]>); 2] {
        [
            ("row_start".into(), Cow::Borrowed(bytemuck::cast_slice(&self.row_start))),
            ("runs".into(), Cow::Borrowed(bytemuck::cast_slice(&self.runs))),
        ]
    }

    /// Undoes [`Self::to_sections`], for a grid.
    pub(crate) fn from_sections(sections: &Sections<'_>, grid: &Grid) -> Result<Self, Flaw> {
        let (row_start, runs) = (sections.numbers("row_start")?, sections.numbers("runs")?);
        Self::from_parts(grid.width, grid.height, row_start, runs)
            .ok_or_else(|| "holds a mask that contradicts itself".to_owned())
    }

    /// The parts to store: row starts and runs.
    pub(crate) fn parts(&self) -> (&[u32], &[[u32; 2]]) {
        (&self.row_start, &self.runs)
    }

    fn row(&self, row: u32) -> &[[u32; 2]] {
        let row = row as usize;
        &self.runs[self.row_start[row] as usize..self.row_start[row + 1] as usize]
    }

    /// Whether a pixel holds a measurement; false outside.
    pub(crate) fn is_valid(&self, column: u32, row: u32) -> bool {
        if row >= self.height {
            return false;
        }
        let runs = self.row(row);
        let next = runs.partition_point(|run| run[1] <= column);
        runs.get(next).is_some_and(|run| run[0] <= column)
    }

    /// Valid pixels of `row` in columns `from..to`.
    fn valid_in_row(&self, row: u32, from: u32, to: u32) -> u32 {
        let runs = self.row(row);
        let first = runs.partition_point(|run| run[1] <= from);
        runs[first..].iter().take_while(|run| run[0] < to).map(|run| run[1].min(to) - run[0].max(from)).sum()
    }

    /// Valid pixels of the block of 2^level × 2^level pixels at block coordinates (column, row).
    pub(crate) fn valid_in_block(&self, level: u32, column: u32, row: u32) -> u32 {
        if level >= BLOCK_SHIFT {
            let Some(coarse) = self.coarse.get((level - BLOCK_SHIFT) as usize) else {
                // Above the top level one block holds everything.
                return self.coarse.last().map_or(0, |top| top.counts.iter().sum());
            };
            if column >= coarse.columns {
                return 0;
            }
            let index = u64::from(row) * u64::from(coarse.columns) + u64::from(column);
            return coarse.counts.get(index as usize).copied().unwrap_or(0);
        }
        let side = 1u32 << level;
        let rows = (row * side).min(self.height)..((row + 1) * side).min(self.height);
        rows.map(|r| self.valid_in_row(r, column * side, (column + 1) * side)).sum()
    }

    fn count_blocks(&self) -> Vec<CoarseLevel> {
        let side = 1u32 << BLOCK_SHIFT;
        let columns = self.width.div_ceil(side);
        let rows = self.height.div_ceil(side);
        let mut counts = vec![0u32; columns as usize * rows as usize];
        for row in 0..self.height {
            let line = &mut counts[(row / side) as usize * columns as usize..][..columns as usize];
            for &[first, end] in self.row(row) {
                for block in first / side..=(end - 1) / side {
                    line[block as usize] += end.min((block + 1) * side) - first.max(block * side);
                }
            }
        }
        let mut levels = vec![CoarseLevel { columns, counts }];
        let (mut columns, mut rows) = (columns, rows);
        while columns > 1 || rows > 1 {
            let below = &levels[levels.len() - 1];
            let (wide, high) = (columns.div_ceil(2), rows.div_ceil(2));
            let mut counts = vec![0u32; wide as usize * high as usize];
            for row in 0..rows {
                for column in 0..columns {
                    counts[(row / 2) as usize * wide as usize + (column / 2) as usize] +=
                        below.counts[row as usize * columns as usize + column as usize];
                }
            }
            levels.push(CoarseLevel { columns: wide, counts });
            (columns, rows) = (wide, high);
        }
        levels
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn mask_of(width: u32, flags: &[bool]) -> ValidMask {
        let mut mask = ValidMask::begin(width);
        for row in flags.chunks(width as usize) {
            mask.push_row(row.iter().copied());
        }
        mask.finish()
    }

    proptest! {
        #[test]
        fn runs_say_what_the_flags_said(flags in proptest::collection::vec(any::<bool>(), 37 * 21)) {
            let mask = mask_of(37, &flags);
            for row in 0..21u32 {
                for column in 0..37u32 {
                    prop_assert_eq!(mask.is_valid(column, row), flags[(row * 37 + column) as usize]);
                }
            }
            let total = flags.iter().filter(|f| **f).count() as u32;
            for level in 0..7u32 {
                let side = 1u32 << level;
                let sum: u32 = (0..21u32.div_ceil(side))
                    .flat_map(|row| (0..37u32.div_ceil(side)).map(move |column| (column, row)))
                    .map(|(column, row)| mask.valid_in_block(level, column, row))
                    .sum();
                prop_assert_eq!(sum, total, "level {}", level);
            }
        }
    }

    #[test]
    fn parts_that_contradict_each_other_are_refused() {
        let mask = mask_of(4, &[true, false, true, true]);
        let (starts, runs) = mask.parts();
        assert!(ValidMask::from_parts(4, 1, starts.to_vec(), runs.to_vec()).is_some());
        assert!(ValidMask::from_parts(3, 1, starts.to_vec(), runs.to_vec()).is_none());
        assert!(ValidMask::from_parts(4, 2, starts.to_vec(), runs.to_vec()).is_none());
        assert!(ValidMask::from_parts(4, 1, vec![0, 1], runs.to_vec()).is_none());
    }
}
