//! The lit pixels of a raster, in Morton order. Dark pixels are not stored.

use crate::array::Array;
use crate::grid::Grid;
use crate::morton;
use skyglow_physics::SourcePixel;
use skyglow_physics::source_pixel::upward_flux_dnb_w;

/// Lit pixels, ascending by [`morton::encode`]; the arrays run in parallel.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct LitPixels {
    /// Morton code of column and row.
    pub(crate) codes: Array<u64>,
    /// The raster's value, nW cm⁻² sr⁻¹, without the scene's calibration.
    pub(crate) radiance_nw_cm2_sr: Array<f32>,
    /// Terrain altitude of the centre, metres, ≥ 0.
    pub(crate) altitude_m: Array<f32>,
}

impl LitPixels {
    /// Number of pixels.
    pub(crate) fn len(&self) -> usize {
        self.codes.len()
    }

    /// Whether the parts fit each other and a grid: equal lengths, codes ascending and inside, values in range.
    pub(crate) fn is_consistent(&self, grid: &Grid) -> bool {
        self.codes.len() == self.radiance_nw_cm2_sr.len()
            && self.codes.len() == self.altitude_m.len()
            && self.codes.len() < u32::MAX as usize
            && self.codes.windows(2).all(|pair| pair[0] < pair[1])
            && self.codes.iter().all(|&code| {
                let (column, row) = morton::decode(code);
                column < grid.width && row < grid.height
            })
            && self.radiance_nw_cm2_sr.iter().all(|l| l.is_finite() && *l > 0.0)
            && self.altitude_m.iter().all(|h| h.is_finite() && *h >= 0.0)
    }

    /// The lowest and the highest altitude, metres; None without light.
    pub(crate) fn altitude_range_m(&self) -> Option<[f32; 2]> {
        self.altitude_m.iter().fold(None, |range, &altitude_m| {
            let [lowest, highest] = range.unwrap_or([altitude_m; 2]);
            Some([altitude_m.min(lowest), altitude_m.max(highest)])
        })
    }

    /// The index of a pixel if it is lit.
    pub(crate) fn index_at(&self, column: u32, row: u32) -> Option<usize> {
        self.codes.binary_search(&morton::encode(column, row)).ok()
    }

    /// Upward flux of pixel `index`, DNB watts, calibration included.
    pub(crate) fn flux_dnb_w(&self, grid: &Grid, calibration: f64, index: usize) -> f64 {
        let (column, row) = morton::decode(self.codes[index]);
        calibration * upward_flux_dnb_w(f64::from(self.radiance_nw_cm2_sr[index]), grid.area_m2(column, row))
    }

    /// Pixel `index` as a source.
    pub(crate) fn source_pixel(&self, grid: &Grid, calibration: f64, index: usize) -> SourcePixel {
        let (column, row) = morton::decode(self.codes[index]);
        SourcePixel {
            corners: grid.corners(column, row),
            flux_dnb_w: self.flux_dnb_w(grid, calibration, index),
            altitude_m: f64::from(self.altitude_m[index]),
        }
    }

    /// Drops the pixels that have become dark.
    pub(crate) fn drop_dark(&mut self) {
        let lit: Vec<bool> = self.radiance_nw_cm2_sr.iter().map(|value| *value > 0.0).collect();
        let mut is_lit = lit.iter();
        self.codes.retain(|_| is_lit.next().is_some_and(|lit| *lit));
        let mut is_lit = lit.iter();
        self.altitude_m.retain(|_| is_lit.next().is_some_and(|lit| *lit));
        self.radiance_nw_cm2_sr.retain(|value| *value > 0.0);
    }

    /// Sorts by code. Codes must be distinct.
    pub(crate) fn sort(&mut self) {
        let mut order: Vec<u32> = (0..self.codes.len() as u32).collect();
        order.sort_unstable_by_key(|&i| self.codes[i as usize]);
        let pick = |values: &[f32]| order.iter().map(|&i| values[i as usize]).collect();
        self.radiance_nw_cm2_sr = pick(&self.radiance_nw_cm2_sr);
        self.altitude_m = pick(&self.altitude_m);
        self.codes.sort_unstable();
    }
}
