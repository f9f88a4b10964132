//! Web-Mercator map tiles of radiance and elevation, as numbers and a mask.

use crate::error::SceneError;
use crate::scene::Scene;
use skyglow_physics::{EARTH_RADIUS_M, GeoPoint};

/// What a map tile shows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TileLayer {
    /// The raster's radiance, nW cm⁻² sr⁻¹; the mean over the valid pixels under a tile's pixel.
    Radiance,
    /// Terrain elevation, metres (may be negative).
    Elevation,
}

/// Values of a map tile, row by row from the north-west.
#[derive(Clone, Debug, PartialEq)]
pub struct RasterTile {
    /// `size_px` × `size_px` values; 0 where there is no data.
    pub values: Vec<f32>,
    /// Which of them are data.
    pub has_data: Vec<bool>,
    /// Pixels a side.
    pub size_px: u32,
}

/// Deepest zoom level: a pixel of 256-pixel tiles is then a centimetre.
const DEEPEST_ZOOM: u8 = 24;
/// Largest tile, pixels a side.
const LARGEST_PX: u32 = 1024;

/// Samples the scene at the pixels of tile z/x/y.
pub(crate) fn sample(
    scene: &Scene,
    layer: TileLayer,
    z: u8,
    x: u32,
    y: u32,
    size_px: u32,
) -> Result<RasterTile, SceneError> {
    let refuse = |reason| Err(SceneError::InvalidTile { z, x, y, size_px, reason });
    if z > DEEPEST_ZOOM {
        return refuse("the deepest zoom level is 24");
    }
    if x >= 1 << z || y >= 1 << z {
        return refuse("x and y must be below 2 to the power of z");
    }
    if size_px == 0 || size_px > LARGEST_PX {
        return refuse("1 to 1024 pixels a side are allowed");
    }
    let mercator = Mercator { pixels: f64::from(size_px) * f64::from(1u32 << z) };
    let left = f64::from(x) * f64::from(size_px);
    let top = f64::from(y) * f64::from(size_px);
    let count = size_px as usize * size_px as usize;
    let mut tile = RasterTile { values: vec![0.0; count], has_data: vec![false; count], size_px };
    for row in 0..size_px {
        for column in 0..size_px {
            let (px, py) = (left + f64::from(column), top + f64::from(row));
            let value = match layer {
                TileLayer::Radiance => mean_radiance(scene, &mercator, px, py),
                TileLayer::Elevation => {
                    let place = mercator.place(px + 0.5, py + 0.5);
                    scene.terrain.overview_m(place, mercator.resolution_m(place))
                }
            };
            if let Some(value) = value {
                let index = (row * size_px + column) as usize;
                (tile.values[index], tile.has_data[index]) = (value as f32, true);
            }
        }
    }
    Ok(tile)
}

/// The Mercator map of the whole world, `pixels` a side.
struct Mercator {
    pixels: f64,
}

impl Mercator {
    /// The place at pixel coordinates from the north-west corner.
    fn place(&self, x: f64, y: f64) -> GeoPoint {
        let longitude_rad = std::f64::consts::TAU * (x / self.pixels - 0.5);
        let latitude_rad = (std::f64::consts::PI * (1.0 - 2.0 * y / self.pixels)).sinh().atan();
        GeoPoint::from_rad_unchecked(latitude_rad, longitude_rad)
    }

    /// Ground size of a pixel there, metres.
    fn resolution_m(&self, place: GeoPoint) -> f64 {
        std::f64::consts::TAU * EARTH_RADIUS_M * place.latitude_rad().cos() / self.pixels
    }
}

/// Mean radiance under the map pixel at (x, y): of the pixel there when zoomed in; zoomed out of the four
/// pyramid blocks around its quarters' middles, which are larger than those quarters, so that no lone
/// light falls between samples.
fn mean_radiance(scene: &Scene, mercator: &Mercator, x: f64, y: f64) -> Option<f64> {
    let middle = mercator.place(x + 0.5, y + 0.5);
    let ratio = mercator.resolution_m(middle) / scene.metadata.pixel_size_m;
    if ratio <= 1.0 {
        return scene.radiance_nw_cm2_sr(middle);
    }
    let level = (0.5 * ratio).log2().ceil().max(0.0) as u32;
    let (mut sum, mut valid) = (0.0, 0.0);
    for (dx, dy) in [(0.25, 0.25), (0.75, 0.25), (0.25, 0.75), (0.75, 0.75)] {
        let Some((column, row)) = scene.grid.pixel_at(mercator.place(x + dx, y + dy)) else { continue };
        let (block_column, block_row) = (column >> level, row >> level);
        valid += f64::from(scene.mask.valid_in_block(level, block_column, block_row));
        sum += if level == 0 {
            scene.pixels.radiance_at(column, row).map_or(0.0, f64::from)
        } else if level as usize <= scene.pyramid.top() {
            let block = scene.pyramid.level(level as usize).block_at(block_column, block_row);
            block.map_or(0.0, |b| b.radiance_sum_nw_cm2_sr)
        } else {
            let top = scene.pyramid.top();
            if top == 0 { 0.0 } else { scene.pyramid.level(top).blocks[0].radiance_sum_nw_cm2_sr }
        };
    }
    (valid > 0.0).then(|| sum / valid)
}
