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
    let window = Window::new(z, x, y, size_px);
    let count = size_px as usize * size_px as usize;
    let mut tile = RasterTile { values: vec![0.0; count], has_data: vec![false; count], size_px };
    for row in 0..size_px as usize {
        for column in 0..size_px as usize {
            let value = match layer {
                TileLayer::Radiance => mean_radiance(scene, &window, column, row),
                TileLayer::Elevation => {
                    scene.terrain.overview_m(window.place(column, row, 2, 2), window.resolution_m(row))
                }
            };
            if let Some(value) = value {
                let index = row * size_px as usize + column;
                (tile.values[index], tile.has_data[index]) = (value as f32, true);
            }
        }
    }
    Ok(tile)
}

/// The tile's part of the Mercator map: latitudes and longitudes at every quarter of a pixel.
struct Window {
    latitudes_rad: Vec<f64>,
    longitudes_rad: Vec<f64>,
    /// Pixels around the whole equator.
    world_px: f64,
}

impl Window {
    fn new(z: u8, x: u32, y: u32, size_px: u32) -> Self {
        let world_px = f64::from(size_px) * f64::from(1u32 << z);
        let part = |tile: u32, quarter: u32| {
            (f64::from(tile) * f64::from(size_px) + 0.25 * f64::from(quarter)) / world_px
        };
        let quarters = 0..4 * size_px;
        let latitude_rad = |q| (std::f64::consts::PI * (1.0 - 2.0 * part(y, q))).sinh().atan();
        let longitude_rad = |q| std::f64::consts::TAU * (part(x, q) - 0.5);
        Self {
            latitudes_rad: quarters.clone().map(latitude_rad).collect(),
            longitudes_rad: quarters.map(longitude_rad).collect(),
            world_px,
        }
    }

    /// The place in a pixel, so many quarters from its west and north edge.
    fn place(&self, column: usize, row: usize, east: usize, south: usize) -> GeoPoint {
        GeoPoint::from_rad_unchecked(
            self.latitudes_rad[4 * row + south],
            self.longitudes_rad[4 * column + east],
        )
    }

    /// Ground size of a pixel of a row, metres.
    fn resolution_m(&self, row: usize) -> f64 {
        std::f64::consts::TAU * EARTH_RADIUS_M * self.latitudes_rad[4 * row + 2].cos() / self.world_px
    }
}

/// Mean radiance under the map pixel: of the pixel there when zoomed in; zoomed out of the four
/// pyramid blocks around its quarters' middles, which are larger than those quarters, so that no lone
/// light falls between samples.
fn mean_radiance(scene: &Scene, window: &Window, column: usize, row: usize) -> Option<f64> {
    let ratio = window.resolution_m(row) / scene.metadata.pixel_size_m;
    if ratio <= 1.0 {
        return scene.radiance_nw_cm2_sr(window.place(column, row, 2, 2));
    }
    let level = (0.5 * ratio).log2().ceil().max(0.0) as u32;
    let (mut sum, mut valid) = (0.0, 0.0);
    for (east, south) in [(1, 1), (3, 1), (1, 3), (3, 3)] {
        let Some((column, row)) = scene.grid.pixel_at(window.place(column, row, east, south)) else {
            continue;
        };
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
