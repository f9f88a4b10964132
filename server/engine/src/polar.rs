//! The polar grid of light around an observer.

use skyglow_physics::{AZIMUTH_COUNT, GeoPoint};

/// Rings of the polar grid.
pub const RING_COUNT: usize = 192;

/// One lit cell.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C)]
pub struct PolarCell {
    /// Ring, 0 nearest.
    pub ring: u32,
    /// Upward flux, DNB watts.
    pub flux_dnb_w: f32,
    /// Flux-weighted mean altitude, metres above the sphere.
    pub altitude_m: f32,
}

/// Light around an observer: sparse, by azimuth column.
#[derive(Clone, Debug)]
pub struct PolarGrid {
    /// The observer's place.
    pub observer: GeoPoint,
    /// 257 offsets into `cells`: column i holds `cells[azimuth_start[i]..azimuth_start[i + 1]]`.
    pub azimuth_start: Vec<u32>,
    /// Lit cells, sorted by ring within a column.
    pub cells: Vec<PolarCell>,
    /// Sum of the cells' flux, DNB watts.
    pub flux_dnb_w: f64,
    /// Share of the 300 km disc that the scene covers, 0..=1.
    pub coverage: f64,
}

impl PolarGrid {
    /// A grid without light.
    pub fn dark(observer: GeoPoint) -> Self {
        Self {
            observer,
            azimuth_start: vec![0; AZIMUTH_COUNT + 1],
            cells: Vec::new(),
            flux_dnb_w: 0.0,
            coverage: 1.0,
        }
    }
}
