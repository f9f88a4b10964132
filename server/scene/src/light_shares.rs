//! Which cells of a polar grid each pixel's light went to: the way back from what cells do to what pixels do.

use crate::gather::LightSink;
use crate::polar_grid::{
    AZIMUTH_COLUMN_COUNT, PlacedLight, PolarAccumulator, PolarAxes, PolarGrid, RING_COUNT, blocking_shares,
};
use skyglow_physics::GeoPoint;
use skyglow_physics::blocking::BLOCKING_COUNT;

/// A part of a pixel's light in a cell.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CellShare {
    /// Index in [`PolarGrid::cells`].
    pub cell: u32,
    /// Upward flux, DNB watts.
    pub flux_dnb_w: f32,
}

/// The light around an observer by cells and by pixels. Every pixel is taken by itself, far ones too.
#[derive(Clone, Debug)]
pub struct LightShares {
    /// The light by azimuth and distance.
    pub polar: PolarGrid,
    /// Lit pixels within reach, as [`Scene::lit_pixel`](crate::Scene::lit_pixel) numbers them, ascending.
    pixels: Vec<u32>,
    /// Where each pixel's shares begin, and where the last one's end.
    starts: Vec<u32>,
    shares: Vec<CellShare>,
    /// Their altitudes, metres.
    altitude_m: Vec<f32>,
}

impl LightShares {
    /// Number of lit pixels within 300 km.
    pub fn len(&self) -> usize {
        self.pixels.len()
    }

    /// Whether there is no light.
    pub fn is_empty(&self) -> bool {
        self.pixels.is_empty()
    }

    /// The lit pixels, ascending.
    pub fn pixels(&self) -> &[u32] {
        &self.pixels
    }

    /// Altitude of pixel `position` of [`Self::pixels`], metres.
    pub fn altitude_m(&self, position: usize) -> f32 {
        self.altitude_m[position]
    }

    /// Where the light of pixel `position` of [`Self::pixels`] went; a cell may come more than once.
    pub fn shares(&self, position: usize) -> &[CellShare] {
        &self.shares[self.starts[position] as usize..self.starts[position + 1] as usize]
    }

    /// Bytes held.
    pub fn byte_count(&self) -> usize {
        12 * self.pixels.len() + 8 * self.shares.len() + 16 * self.polar.cells.len()
    }
}

/// Light shares being gathered, in the order in which pixels are visited.
pub(crate) struct ShareCollector {
    accumulator: PolarAccumulator,
    axes: PolarAxes,
    /// Number of each pixel, its altitude, and where its shares begin.
    visited: Vec<(u32, f32, u32)>,
    /// Shares with the numbers of their places on the grid in place of their cells'.
    shares: Vec<CellShare>,
}

/// Number of a place on the grid.
fn slot(at: usize, blocking: usize) -> u32 {
    (at * BLOCKING_COUNT + blocking) as u32
}

impl LightSink for ShareCollector {
    fn take(&mut self, pixel: Option<usize>, light: PlacedLight) {
        self.accumulator.add(light);
        // Blocks are not taken where pixels are asked for.
        let Some(pixel) = pixel.map(|pixel| pixel as u32) else { return };
        if self.visited.last().is_none_or(|(last, ..)| *last != pixel) {
            self.visited.push((pixel, light.altitude_m as f32, self.shares.len() as u32));
        }
        for (at, weight) in self.axes.shares(light.azimuth_rad, light.log_distance) {
            for (angle, part) in blocking_shares(light.blocking) {
                let flux_dnb_w = (light.flux_dnb_w * weight * part) as f32;
                if flux_dnb_w > 0.0 {
                    self.shares.push(CellShare { cell: slot(at, angle), flux_dnb_w });
                }
            }
        }
    }
}

impl ShareCollector {
    pub(crate) fn new() -> Self {
        let (visited, shares) = (Vec::new(), Vec::new());
        Self { accumulator: PolarAccumulator::new(), axes: PolarAxes::new(), visited, shares }
    }

    /// Orders pixels by their number and names the cells of their shares.
    pub(crate) fn finish(self, observer: GeoPoint, coverage: f64) -> LightShares {
        let polar = self.accumulator.finish(observer, coverage);
        let mut cell_of = vec![u32::MAX; AZIMUTH_COLUMN_COUNT * RING_COUNT * BLOCKING_COUNT];
        for (column, range) in polar.azimuth_start.windows(2).enumerate() {
            for cell in range[0]..range[1] {
                let of = polar.cells[cell as usize];
                let at = column * RING_COUNT + of.ring as usize;
                cell_of[slot(at, of.blocking as usize) as usize] = cell;
            }
        }
        let ends = self.visited.iter().skip(1).map(|(.., start)| *start).chain([self.shares.len() as u32]);
        let mut visited: Vec<(u32, f32, std::ops::Range<usize>)> = self
            .visited
            .iter()
            .zip(ends)
            .map(|(&(pixel, altitude_m, start), end)| (pixel, altitude_m, start as usize..end as usize))
            .collect();
        visited.sort_unstable_by_key(|(pixel, ..)| *pixel);
        let mut starts = vec![0];
        let mut shares = Vec::with_capacity(self.shares.len());
        for (.., range) in &visited {
            let placed = self.shares[range.clone()].iter();
            let named = placed.map(|share| CellShare { cell: cell_of[share.cell as usize], ..*share });
            // A flux that f32 holds may still be too little for the f32 of a cell behind a skyline.
            shares.extend(named.filter(|share| share.cell != u32::MAX));
            starts.push(shares.len() as u32);
        }
        let pixels = visited.iter().map(|(pixel, ..)| *pixel).collect();
        let altitude_m = visited.iter().map(|(_, altitude_m, _)| *altitude_m).collect();
        LightShares { polar, pixels, starts, shares, altitude_m }
    }
}
