//! Which cells of a polar grid each pixel's light went to: the way back from what cells do to what pixels do.

use crate::gather::LightSink;
use crate::polar_grid::{
    AZIMUTH_COLUMN_COUNT, PolarAccumulator, PolarAxes, PolarGrid, RING_COUNT, blocking_shares,
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

/// A share on its way: its pixel, the number of its place on the grid, and its light.
struct Pending {
    pixel: u32,
    slot: u32,
    flux_dnb_w: f32,
}

/// Light shares being gathered.
pub(crate) struct ShareCollector {
    accumulator: PolarAccumulator,
    axes: PolarAxes,
    pending: Vec<Pending>,
    altitudes_m: Vec<(u32, f32)>,
}

fn slot(at: usize, blocking: usize) -> u32 {
    (at * BLOCKING_COUNT + blocking) as u32
}

impl LightSink for ShareCollector {
    fn add(
        &mut self,
        pixel: Option<usize>,
        azimuth_rad: f64,
        log_distance: f64,
        altitude_m: f64,
        blocking: f64,
        flux_dnb_w: f64,
    ) {
        self.accumulator.add(azimuth_rad, log_distance, altitude_m, blocking, flux_dnb_w);
        // Blocks are not taken where pixels are asked for.
        let Some(pixel) = pixel.map(|pixel| pixel as u32) else { return };
        if self.altitudes_m.last().is_none_or(|(last, _)| *last != pixel) {
            self.altitudes_m.push((pixel, altitude_m as f32));
        }
        for (at, weight) in self.axes.shares(azimuth_rad, log_distance) {
            let mut push = |blocking: usize, flux_dnb_w: f64| {
                if flux_dnb_w > 0.0 {
                    self.pending.push(Pending {
                        pixel,
                        slot: slot(at, blocking),
                        flux_dnb_w: flux_dnb_w as f32,
                    });
                }
            };
            if blocking > 0.0 {
                for (angle, part) in blocking_shares(blocking) {
                    push(angle, flux_dnb_w * weight * part);
                }
            } else {
                push(0, flux_dnb_w * weight);
            }
        }
    }
}

impl ShareCollector {
    pub(crate) fn new() -> Self {
        Self {
            accumulator: PolarAccumulator::new(),
            axes: PolarAxes::new(),
            pending: Vec::new(),
            altitudes_m: Vec::new(),
        }
    }

    /// Sorts the shares by pixel and names their cells.
    pub(crate) fn finish(mut self, observer: GeoPoint, coverage: f64) -> LightShares {
        let polar = self.accumulator.finish(observer, coverage);
        let mut cell_of = vec![u32::MAX; AZIMUTH_COLUMN_COUNT * RING_COUNT * BLOCKING_COUNT];
        for (column, range) in polar.azimuth_start.windows(2).enumerate() {
            for cell in range[0]..range[1] {
                let of = polar.cells[cell as usize];
                let at = column * RING_COUNT + of.ring as usize;
                cell_of[slot(at, of.blocking as usize) as usize] = cell;
            }
        }
        // The walk visits a pixel's pieces one after another, and pixels in no order.
        self.pending.sort_by_key(|share| share.pixel);
        self.altitudes_m.sort_by_key(|(pixel, _)| *pixel);
        let (mut pixels, mut starts) = (Vec::with_capacity(self.altitudes_m.len()), Vec::new());
        let mut shares = Vec::with_capacity(self.pending.len());
        for share in &self.pending {
            if pixels.last() != Some(&share.pixel) {
                pixels.push(share.pixel);
                starts.push(shares.len() as u32);
            }
            let cell = cell_of[share.slot as usize];
            // What f32 made 0 on its way into the grid is no light.
            if cell != u32::MAX {
                shares.push(CellShare { cell, flux_dnb_w: share.flux_dnb_w });
            }
        }
        starts.push(shares.len() as u32);
        let altitude_m = self.altitudes_m.into_iter().map(|(_, altitude_m)| altitude_m).collect();
        LightShares { polar, pixels, starts, shares, altitude_m }
    }
}
