//! Colour-bin lookup: which colour of a table a luminance has, without a logarithm or a search.

use crate::colormap::TABLE_LEN;

/// Bits of a float's fraction that cells are counted by, at most; a scale that wants more is looked through.
const MAX_FRACTION_BITS: u32 = 40;
/// Bits of the fraction of an f64.
const FRACTION_BITS: u32 = 52;

/// Where the colours of a table start, even in the logarithm. No logarithm is taken to find one, and nothing is searched: the first
/// bits of a float number cells so narrow that no more than one colour starts in each.
pub(crate) struct ColourBins {
    /// Entry `i` holds luminances from `cd_m2[i]` to below `cd_m2[i + 1]`; all reach the first, none the last.
    cd_m2: [f64; TABLE_LEN + 1],
    /// The entry at the lower end of each cell.
    cells: Vec<u8>,
    /// A luminance's bits without so many are its cell's number and that of the first cell.
    shift: u32,
    first_cell: i64,
}

impl ColourBins {
    /// For colours from `dark` to `bright`, both positive.
    pub(crate) fn new((dark, bright): (f64, f64)) -> Self {
        let steps = (TABLE_LEN - 1) as f64;
        let start = |i: usize| dark * ((i as f64 - 0.5) / steps * (bright / dark).ln()).exp();
        let cd_m2: [f64; TABLE_LEN + 1] = std::array::from_fn(|i| match i {
            0 => f64::NEG_INFINITY,
            TABLE_LEN => f64::NAN,
            i => start(i),
        });
        // A cell is at most 2^-bits of its luminance wide.
        let narrowest = (1..TABLE_LEN - 1).map(|i| cd_m2[i + 1] / cd_m2[i] - 1.0).fold(1.0, f64::min);
        let bits = (-narrowest.log2()).ceil().max(1.0);
        let mut bins = Self { cd_m2, cells: Vec::new(), shift: 0, first_cell: 0 };
        if bits <= f64::from(MAX_FRACTION_BITS) {
            bins.shift = FRACTION_BITS - bits as u32;
            bins.first_cell = bins.cell_of(cd_m2[1]) - 1;
            let last_cell = bins.cell_of(cd_m2[TABLE_LEN - 1]);
            let lowest = |cell: i64| f64::from_bits((cell << bins.shift) as u64);
            // The first cell is that of everything darker.
            bins.cells = std::iter::once(0)
                .chain((bins.first_cell + 1..=last_cell).map(|cell| bins.searched(lowest(cell)) as u8))
                .collect();
        }
        bins
    }

    fn cell_of(&self, luminance_cd_m2: f64) -> i64 {
        // Negative numbers come before all others.
        (luminance_cd_m2.to_bits() as i64) >> self.shift
    }

    /// The entry that holds a luminance.
    #[inline(always)]
    pub(crate) fn entry(&self, luminance_cd_m2: f64) -> usize {
        if self.cells.is_empty() {
            return self.searched(luminance_cd_m2);
        }
        let cell = (self.cell_of(luminance_cd_m2) - self.first_cell).clamp(0, self.cells.len() as i64 - 1);
        let entry = usize::from(self.cells[cell as usize]);
        entry + usize::from(self.cd_m2[entry + 1] <= luminance_cd_m2)
    }

    fn searched(&self, luminance_cd_m2: f64) -> usize {
        self.cd_m2[1..TABLE_LEN].partition_point(|&start| start <= luminance_cd_m2)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A colour is that of the last start at or below for any number.
    #[test]
    fn the_lookup_equals_a_binary_search() {
        for ends in
            [(1e-5, 0.1), (3e-9, 2e-3), (0.2, 0.3), (1e-30, 1e30), (1.0, 1.0 + 1e-6), (1.0, 1.0 + 1e-13)]
        {
            let bins = ColourBins::new(ends);
            let own = &bins.cd_m2[1..TABLE_LEN];
            let known: Vec<f64> = own.iter().flat_map(|&s| [s.next_down(), s, s.next_up()]).collect();
            let spread = (0..4000).map(|i| ends.0 * 1e-3 * (i as f64 * 0.01).exp());
            for luminance in
                known.into_iter().chain(spread).chain([0.0, -1e-9, 1e30, f64::MIN_POSITIVE, f64::INFINITY])
            {
                let wanted = own.partition_point(|&start| start <= luminance);
                assert_eq!(bins.entry(luminance), wanted, "{luminance:e}");
            }
        }
    }
}
