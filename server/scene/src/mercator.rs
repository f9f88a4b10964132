//! Web-Mercator tile arithmetic (XYZ scheme).

use skyglow_physics::EARTH_RADIUS_M;
use std::f64::consts::{PI, TAU};

/// Pixels a side of the tiles that zoom levels are counted in.
const TILE_PX: f64 = 256.0;

/// Ground size of a pixel of zoom level 0 (256 a side) on the equator, metres.
#[must_use]
pub fn zoom_0_pixel_m() -> f64 {
    TAU * EARTH_RADIUS_M / TILE_PX
}

/// Ground size, metres, of a pixel in the middle of the tile row `y` of zoom level `z`, tiles `size_px` a side:
/// 2πR cos φ / (size 2^z), cos φ = 1/cosh(m) of the Mercator ordinate m.
#[must_use]
pub fn tile_pixel_m(z: u8, y: u32, size_px: u32) -> f64 {
    let rows = f64::from(z).exp2();
    let mercator = PI * (1.0 - 2.0 * (f64::from(y) + 0.5) / rows);
    zoom_0_pixel_m() * TILE_PX / f64::from(size_px) / rows / mercator.cosh()
}

/// The tile column of zoom level `z` with a longitude (−180..=180°) in it.
#[must_use]
pub fn tile_column(longitude_deg: f64, z: u8) -> u32 {
    index((longitude_deg + 180.0) / 360.0, z)
}

/// The tile row of zoom level `z` with a latitude in it; beyond ±85.05° that of the edge.
#[must_use]
pub fn tile_row(latitude_deg: f64, z: u8) -> u32 {
    let mercator = latitude_deg.clamp(-85.05, 85.05).to_radians().tan().asinh();
    index(0.5 * (1.0 - mercator / PI), z)
}

/// The tile at a part of the way over the map.
fn index(part: f64, z: u8) -> u32 {
    let count = f64::from(z).exp2();
    ((part * count) as u32).min(count as u32 - 1)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A pixel of zoom level 0 is 156 km wide on the equator.
    #[test]
    fn a_zoom_0_pixel_is_156_km_on_the_equator() {
        assert!((tile_pixel_m(0, 0, 256) - 156_366.0).abs() < 100.0);
        assert!(tile_pixel_m(10, 0, 256) < tile_pixel_m(10, 512, 256));
        assert_eq!(tile_pixel_m(3, 1, 256), 2.0 * tile_pixel_m(3, 1, 512));
    }

    #[test]
    fn a_place_is_in_its_tile() {
        // Nairobi, as every map counts its tiles.
        let nairobi = |z| (tile_column(36.82, z), tile_row(-1.28, z));
        assert_eq!(nairobi(0), (0, 0));
        assert_eq!(nairobi(10), (616, 515));
        assert_eq!((tile_column(180.0, 3), tile_row(89.9, 3)), (7, 0));
        assert_eq!((tile_column(-180.0, 3), tile_row(-89.9, 3)), (0, 7));
    }
}
