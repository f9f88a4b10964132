//! Web-Mercator map tiles (EPSG:3857, XYZ scheme) of radiance, elevation and values of lit pixels, as numbers and a mask.

use crate::dual_tree::{PlaceLattice, PlaceValues};
use crate::error::SceneError;
use crate::grid::Grid;
use crate::light_layer::LightLayer;
use crate::mask::ValidMask;
use crate::morton;
use crate::terrain::Terrain;
use rayon::prelude::*;
use serde::Serialize;
use skyglow_physics::{EARTH_RADIUS_M, GeoPoint};

/// What a map tile shows.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
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

/// A value for each of some lit pixels, as prefix sums in Morton order: the sum over any block of the raster takes two look-ups.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PixelValues {
    /// Numbers of the pixels ([`Scene::column_and_row`](crate::Scene::column_and_row)), ascending.
    pixels: Vec<u32>,
    /// Sum of the values before each, and of all at the end.
    running: Vec<f64>,
}

impl PixelValues {
    /// Of lit pixels, ascending by their number.
    pub fn new(values: impl Iterator<Item = (u32, f32)>) -> Self {
        let (mut pixels, mut running, mut sum) = (Vec::new(), vec![0.0], 0.0);
        for (pixel, value) in values {
            debug_assert!(pixels.last().is_none_or(|last| *last < pixel));
            sum += f64::from(value);
            pixels.push(pixel);
            running.push(sum);
        }
        Self { pixels, running }
    }

    /// Sum over lit pixels `first..end`.
    fn sum(&self, first: u32, end: u32) -> f64 {
        let [first, end] = [first, end].map(|pixel| self.pixels.partition_point(|known| *known < pixel));
        self.running[end] - self.running[first]
    }

    /// Bytes held for each pixel.
    pub const BYTES_PER_PIXEL: usize = size_of::<u32>() + size_of::<f64>();
}

/// Highest zoom level: a pixel of 256-pixel tiles is then a centimetre.
const MAX_ZOOM: u8 = 24;
/// Largest tile, pixels a side.
const MAX_TILE_PX: u32 = 1024;

/// Which tile: zoom level, column, row, and pixels a side.
#[derive(Clone, Copy, Debug)]
pub(crate) struct TileAddress {
    pub(crate) z: u8,
    pub(crate) x: u32,
    pub(crate) y: u32,
    pub(crate) size_px: u32,
}

/// The parts of a scene that are sampled.
pub(crate) struct SampledRasters<'a> {
    pub(crate) grid: &'a Grid,
    pub(crate) mask: &'a ValidMask,
    pub(crate) pixel_size_m: f64,
    pub(crate) light_layers: &'a [LightLayer],
    pub(crate) terrain: &'a Terrain,
}

impl SampledRasters<'_> {
    /// A layer at the pixels of a tile.
    pub(crate) fn tile(&self, layer: TileLayer, address: TileAddress) -> Result<RasterTile, SceneError> {
        sample(address, |window, column, row| match layer {
            TileLayer::Radiance => self.mean_of_pixels(window, column, row, |level, column, row| {
                self.radiance_sum(level, column, row)
            }),
            TileLayer::Elevation => {
                self.terrain.overview_m(window.place(column, row, 2, 2), window.resolution_m(row))
            }
        })
    }

    /// Values of lit pixels: the mean over the valid pixels under a tile's pixel, dark ones counting 0.
    pub(crate) fn pixels_tile(
        &self,
        values: &PixelValues,
        address: TileAddress,
    ) -> Result<RasterTile, SceneError> {
        let sum = |level: u32, column: u32, row: u32| {
            let block = morton::encode(column, row);
            let in_layer = |layer: &LightLayer| {
                let [first, end] = [block, block + 1].map(|block| {
                    let codes = &layer.lights.pixels.codes;
                    layer.first_number + codes.partition_point(|code| code >> (2 * level) < block) as u32
                });
                values.sum(first, end)
            };
            self.light_layers.iter().map(in_layer).sum()
        };
        sample(address, |window, column, row| self.mean_of_pixels(window, column, row, sum))
    }

    /// Values of places.
    pub(crate) fn places_tile(
        &self,
        places: &PlaceValues,
        address: TileAddress,
    ) -> Result<RasterTile, SceneError> {
        sample(address, |window, column, row| {
            let (x, y) = self.grid.position_of(window.place(column, row, 2, 2))?;
            places.at(x, y, window.resolution_m(row) / self.pixel_size_m)
        })
    }

    /// A layer at every place of a lattice: the mean radiance of the pixels of its block, the elevation at its middle; NaN
    /// without data.
    pub(crate) fn at_places(&self, layer: TileLayer, lattice: PlaceLattice) -> Option<PlaceValues> {
        let level = lattice.step.trailing_zeros();
        let [left, top] = lattice.first_block();
        let around = (self.grid.width / lattice.step).max(1);
        let radiance = |column: u32, row: u32| {
            let (column, row) = ((left + column) % around, top + row);
            let valid = self.mask.valid_in_block(level, column, row);
            if valid > 0 {
                (self.radiance_sum(level, column, row) / f64::from(valid)) as f32
            } else {
                f32::NAN
            }
        };
        let elevation = |column: u32, row: u32| {
            let point = lattice.point(self.grid, f64::from(column), f64::from(row));
            let known =
                point.is_finite().then(|| self.terrain.elevation_m(GeoPoint::from_vector(point))).flatten();
            known.map_or(f32::NAN, |elevation_m| elevation_m as f32)
        };
        let mut values = vec![0f32; lattice.len()];
        values.par_chunks_mut(lattice.columns as usize).zip(0..lattice.rows).for_each(|(values, row)| {
            for (value, column) in values.iter_mut().zip(0u32..) {
                *value = match layer {
                    TileLayer::Radiance => radiance(column, row),
                    TileLayer::Elevation => elevation(column, row),
                };
            }
        });
        PlaceValues::new(lattice, values)
    }

    fn radiance_sum(&self, level: u32, column: u32, row: u32) -> f64 {
        self.light_layers.iter().map(|layer| layer.radiance_sum_nw_cm2_sr(level, column, row)).sum()
    }

    /// Mean under the map pixel of what pixels have: of the pixel there when zoomed in; zoomed out of the four blocks
    /// around its quarters' middles, which are larger than those quarters, so that no lone light falls between samples.
    ///
    /// * `sum`: over the pixels of a block of 2^level × 2^level at block coordinates (column, row).
    fn mean_of_pixels(
        &self,
        window: &Window,
        column: usize,
        row: usize,
        sum: impl Fn(u32, u32, u32) -> f64,
    ) -> Option<f64> {
        let ratio = window.resolution_m(row) / self.pixel_size_m;
        if ratio <= 1.0 {
            let (column, row) = self.grid.pixel_at(window.place(column, row, 2, 2))?;
            let value = sum(0, column, row);
            // A lit pixel is valid; it need not be looked up.
            return (value > 0.0 || self.mask.is_valid(column, row)).then_some(value);
        }
        let level = (0.5 * ratio).log2().ceil().max(0.0) as u32;
        let (mut total, mut valid) = (0.0, 0.0);
        for (east, south) in [(1, 1), (3, 1), (1, 3), (3, 3)] {
            let Some((column, row)) = self.grid.pixel_at(window.place(column, row, east, south)) else {
                continue;
            };
            let (block_column, block_row) = (column >> level, row >> level);
            valid += f64::from(self.mask.valid_in_block(level, block_column, block_row));
            total += sum(level, block_column, block_row);
        }
        (valid > 0.0).then(|| total / valid)
    }
}

fn sample(
    TileAddress { z, x, y, size_px }: TileAddress,
    value: impl Fn(&Window, usize, usize) -> Option<f64>,
) -> Result<RasterTile, SceneError> {
    let refuse = |reason| Err(SceneError::InvalidTile { z, x, y, size_px, reason });
    if z > MAX_ZOOM {
        return refuse("the deepest zoom level is 24");
    }
    if x >= 1 << z || y >= 1 << z {
        return refuse("x and y must be below 2 to the power of z");
    }
    if size_px == 0 || size_px > MAX_TILE_PX {
        return refuse("1 to 1024 pixels a side are allowed");
    }
    let window = Window::new(z, x, y, size_px);
    let count = size_px as usize * size_px as usize;
    let mut tile = RasterTile { values: vec![0.0; count], has_data: vec![false; count], size_px };
    for row in 0..size_px as usize {
        for column in 0..size_px as usize {
            if let Some(value) = value(&window, column, row) {
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
