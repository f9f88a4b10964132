//! Colours of map tiles.

use crate::{encode::encode_png_rgba, error::DisplayError, notes::Notes};
use image::{Rgba, RgbaImage};

/// Radiances that the colours of a radiance tile run between, nW cm⁻² sr⁻¹ (logarithmic).
pub const RADIANCE_RANGE_NW_CM2_SR: (f64, f64) = (0.2, 200.0);

/// Hypsometric tints: altitude [m] and colour, linear between.
const TINTS: [(f32, [f32; 3]); 8] = [
    (0.0, [58.0, 94.0, 74.0]),
    (200.0, [84.0, 122.0, 84.0]),
    (600.0, [138.0, 152.0, 100.0]),
    (1200.0, [178.0, 164.0, 116.0]),
    (2000.0, [168.0, 136.0, 104.0]),
    (3000.0, [150.0, 118.0, 106.0]),
    (4500.0, [200.0, 192.0, 190.0]),
    (6000.0, [250.0, 250.0, 250.0]),
];

/// Factor from the brightest colour of an influence tile to where colours end.
pub const INFLUENCE_SPAN: f64 = 1e4;

/// A square tile of artificial light at the zenith, `[y][x]`: less than the lower end of `range` is transparent, more runs through the
/// `plasma` map on a logarithmic scale.
///
/// # Errors
/// [`DisplayError::Encoding`] when the lengths are not `size_px²`.
pub fn brightness_tile_png(
    values: &[f32],
    has_data: &[bool],
    size_px: u32,
    range: (f64, f64),
    notes: &Notes,
) -> Result<Vec<u8>, DisplayError> {
    brightness_map_png(values, has_data, [size_px; 2], range, notes)
}

/// The same for a map of any width and height.
///
/// # Errors
/// [`DisplayError::Encoding`] when the lengths are not width times height.
pub fn brightness_map_png(
    values: &[f32],
    has_data: &[bool],
    size_px: [u32; 2],
    range: (f64, f64),
    notes: &Notes,
) -> Result<Vec<u8>, DisplayError> {
    logarithmic_png(values, has_data, size_px, crate::Colormap::Plasma, range, notes)
}

/// A square tile of upward radiance [nW cm⁻² sr⁻¹], `[y][x]`: dark is transparent, light runs through the
/// `inferno` map's brighter part on a logarithmic scale.
///
/// # Errors
/// [`DisplayError::Encoding`] when the lengths are not `size_px²`.
pub fn radiance_tile_png(
    radiance_nw_cm2_sr: &[f32],
    has_data: &[bool],
    size_px: u32,
    notes: &Notes,
) -> Result<Vec<u8>, DisplayError> {
    let range = RADIANCE_RANGE_NW_CM2_SR;
    logarithmic_png(radiance_nw_cm2_sr, has_data, [size_px; 2], crate::Colormap::Inferno, range, notes)
}

/// A square tile of influences in any unit, `[y][x]`: from a ten-thousandth of `most` to `most` and beyond through the `viridis` map's
/// brighter part on a logarithmic scale; less is transparent.
///
/// # Errors
/// [`DisplayError::Encoding`] when the lengths are not `size_px²`.
pub fn influence_tile_png(
    influence: &[f32],
    has_data: &[bool],
    size_px: u32,
    most: f64,
    notes: &Notes,
) -> Result<Vec<u8>, DisplayError> {
    let range = (most / INFLUENCE_SPAN, most);
    logarithmic_png(influence, has_data, [size_px; 2], crate::Colormap::Viridis, range, notes)
}

fn logarithmic_png(
    values: &[f32],
    has_data: &[bool],
    size_px: [u32; 2],
    colormap: crate::Colormap,
    (dark, bright): (f64, f64),
    notes: &Notes,
) -> Result<Vec<u8>, DisplayError> {
    let table: Vec<[u8; 4]> = colormap
        .table()
        .into_iter()
        .enumerate()
        .map(|(i, [r, g, b])| {
            let t = i as f64 / 255.0;
            [r, g, b, (255.0 * (0.25 + 0.75 * t.sqrt())).round() as u8]
        })
        .collect();
    paint(values, has_data, size_px, notes, |index| {
        let value = f64::from(values[index]);
        if value.is_nan() || value <= dark {
            return [0; 4];
        }
        let t = 0.15 + 0.85 * ((value / dark).ln() / (bright / dark).ln()).min(1.0);
        table[(t * 255.0) as usize]
    })
}

/// A part of a square tile, enlarged to a tile by bilinear interpolation: beyond its last zoom a map has nothing finer.
///
/// * `part`: how many zooms deeper, and column and row among the 2^zooms a side that the tile has of such parts.
///
/// # Errors
/// [`DisplayError::Encoding`] for what is no PNG.
pub fn enlarged_tile_png(
    tile: &[u8],
    (zooms, column, row): (u8, u32, u32),
    size_px: u32,
    notes: &Notes,
) -> Result<Vec<u8>, DisplayError> {
    let tile = decoded(tile)?;
    // Pixels of the tile around a pixel of the part, and how far it is to the second.
    let around = |pixel: u32, part: u32, whole: u32| {
        let place =
            (f64::from(part) + (f64::from(pixel) + 0.5) / f64::from(size_px)) / f64::from(zooms).exp2();
        let at = (place * f64::from(whole) - 0.5).clamp(0.0, f64::from(whole - 1));
        let first = at as u32;
        ([first, (first + 1).min(whole - 1)], at - at.floor())
    };
    let enlarged = RgbaImage::from_fn(size_px, size_px, |x, y| {
        let ((columns, right), (rows, down)) =
            (around(x, column, tile.width()), around(y, row, tile.height()));
        let (mut colour, mut opacity) = ([0.0; 3], 0.0);
        for (row, of_row) in rows.into_iter().zip([1.0 - down, down]) {
            for (column, of_column) in columns.into_iter().zip([1.0 - right, right]) {
                // What is transparent has no colour.
                let Rgba([r, g, b, alpha]) = *tile.get_pixel(column, row);
                let weight = of_row * of_column * f64::from(alpha);
                opacity += weight;
                colour = [0, 1, 2].map(|at| colour[at] + weight * f64::from([r, g, b][at]));
            }
        }
        let [r, g, b] = colour.map(|sum| if opacity > 0.0 { (sum / opacity).round() as u8 } else { 0 });
        Rgba([r, g, b, opacity.round() as u8])
    });
    encode_png_rgba(&enlarged, notes)
}

/// Four tiles of a zoom as one of the zoom before, with all their pixels: north-west, north-east, south-west, south-east; transparent
/// where there is none.
///
/// # Errors
/// [`DisplayError::Encoding`] for what is no PNG.
pub fn joined_tiles_png(
    four: &[Option<&[u8]>],
    size_px: u32,
    notes: &Notes,
) -> Result<Vec<u8>, DisplayError> {
    let mut joined = RgbaImage::new(2 * size_px, 2 * size_px);
    for (number, tile) in (0u32..).zip(four) {
        if let Some(tile) = tile {
            let at = [number % 2, number / 2].map(|side| i64::from(side * size_px));
            image::imageops::replace(&mut joined, &decoded(tile)?, at[0], at[1]);
        }
    }
    encode_png_rgba(&joined, notes)
}

fn decoded(png: &[u8]) -> Result<RgbaImage, DisplayError> {
    let picture = image::load_from_memory_with_format(png, image::ImageFormat::Png);
    let picture = picture.map_err(|error| DisplayError::encoding("PNG", error))?.into_rgba8();
    match picture.is_empty() {
        true => Err(DisplayError::encoding("PNG", "a tile without pixels")),
        false => Ok(picture),
    }
}

/// A square tile of terrain altitude [m], `[y][x]`: hypsometric tints, shaded with a light from the north-west.
/// `pixel_m` is the size of a pixel on the ground. No data is transparent.
///
/// # Errors
/// [`DisplayError::Encoding`] when the lengths are not `size_px²`.
pub fn elevation_tile_png(
    altitude_m: &[f32],
    has_data: &[bool],
    size_px: u32,
    pixel_m: f64,
    notes: &Notes,
) -> Result<Vec<u8>, DisplayError> {
    let size = size_px as usize;
    // Relief is drawn steeper on small scales, where true slopes would vanish.
    let exaggeration = (pixel_m / 60.0).clamp(1.0, 12.0) as f32;
    let slope = |index: usize, step: usize, position: usize| -> f32 {
        let before = if position > 0 && has_data[index - step] { index - step } else { index };
        let after = if position + 1 < size && has_data[index + step] { index + step } else { index };
        if before == after {
            return 0.0;
        }
        let distance_m = pixel_m as f32 * ((after - before) / step) as f32;
        exaggeration * (altitude_m[after] - altitude_m[before]) / distance_m
    };
    paint(altitude_m, has_data, [size_px; 2], notes, |index| {
        let (x, y) = (index % size, index / size);
        let (east, south) = (slope(index, 1, x), slope(index, size, y));
        // Lambertian shading; the light stands 45 degrees high in the north-west.
        let shade = (0.5 * east + 0.5 * south + std::f32::consts::FRAC_1_SQRT_2)
            / (1.0 + east * east + south * south).sqrt();
        let light = (0.45 + 0.78 * shade).clamp(0.3, 1.25);
        let [r, g, b] = tint(altitude_m[index]).map(|c| (c * light).clamp(0.0, 255.0) as u8);
        [r, g, b, 255]
    })
}

fn tint(altitude_m: f32) -> [f32; 3] {
    let mut colour = TINTS[0].1;
    for pair in TINTS.windows(2) {
        let ((low_m, low), (high_m, high)) = (pair[0], pair[1]);
        if altitude_m >= low_m {
            let t = ((altitude_m - low_m) / (high_m - low_m)).min(1.0);
            colour = std::array::from_fn(|i| low[i] + t * (high[i] - low[i]));
        }
    }
    colour
}

/// Paints the pixels with data; the others are transparent.
fn paint(
    values: &[f32],
    has_data: &[bool],
    [width_px, height_px]: [u32; 2],
    notes: &Notes,
    colour: impl Fn(usize) -> [u8; 4],
) -> Result<Vec<u8>, DisplayError> {
    let length = width_px as usize * height_px as usize;
    if values.len() != length || has_data.len() != length {
        return Err(DisplayError::encoding("PNG", "a tile must have as many values as pixels"));
    }
    let tile = RgbaImage::from_fn(width_px, height_px, |x, y| {
        let index = (y * width_px + x) as usize;
        Rgba(if has_data[index] { colour(index) } else { [0; 4] })
    });
    encode_png_rgba(&tile, notes)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn decode(bytes: &[u8]) -> RgbaImage {
        image::load_from_memory_with_format(bytes, image::ImageFormat::Png).unwrap().into_rgba8()
    }

    /// Brighter radiance is brighter and dark or missing is transparent.
    #[test]
    fn tiles_brighten_and_dark_is_transparent() {
        let values = [0.0, 1.0, 10.0, 500.0];
        let tile =
            decode(&radiance_tile_png(&values, &[true, true, true, true], 2, &Notes::default()).unwrap());
        let sum = |x, y| tile.get_pixel(x, y).0[..3].iter().map(|&c| u32::from(c)).sum::<u32>();
        assert_eq!(tile.get_pixel(0, 0).0[3], 0);
        assert!(sum(1, 0) < sum(0, 1) && sum(0, 1) < sum(1, 1));
        let missing = decode(&radiance_tile_png(&values, &[false; 4], 2, &Notes::default()).unwrap());
        assert!(missing.pixels().all(|p| p.0[3] == 0));
        assert!(radiance_tile_png(&values, &[true; 4], 3, &Notes::default()).is_err());
    }

    /// Influences are coloured by their part of the most.
    #[test]
    fn influences_are_coloured_by_their_share() {
        let values = [0.0, 0.9e-4, 1e-2, 1.0];
        for unit in [1.0, 1e-9] {
            let values = values.map(|value| value * unit as f32);
            let tile = decode(&influence_tile_png(&values, &[true; 4], 2, unit, &Notes::default()).unwrap());
            let pixels: Vec<[u8; 4]> = tile.pixels().map(|pixel| pixel.0).collect();
            assert_eq!((pixels[0][3], pixels[1][3]), (0, 0));
            let green = |pixel: [u8; 4]| pixel[1];
            assert!(pixels[2][3] > 0 && green(pixels[3]) > green(pixels[2]));
        }
        // Without any influence nothing is coloured.
        let dark = decode(&influence_tile_png(&[0.0; 4], &[true; 4], 2, 0.0, &Notes::default()).unwrap());
        assert!(dark.pixels().all(|pixel| pixel.0[3] == 0));
    }

    /// Four tiles make one of all their pixels, of which each fourth is the tile again; what is enlarged has the pixels of its part.
    #[test]
    fn tiles_are_joined_and_enlarged() {
        let values: Vec<f32> = (0..16).map(|i| 1.0 + 12.0 * i as f32).collect();
        let tile = radiance_tile_png(&values, &[true; 16], 4, &Notes::default()).unwrap();
        let joined = joined_tiles_png(&[None, Some(&tile), Some(&tile), None], 4, &Notes::default()).unwrap();
        let (one, whole) = (decode(&tile), decode(&joined));
        assert_eq!(whole.dimensions(), (8, 8));
        for (x, y) in [(0, 0), (3, 1), (2, 3)] {
            assert_eq!(whole.get_pixel(4 + x, y), one.get_pixel(x, y));
            assert_eq!(whole.get_pixel(x, 4 + y), one.get_pixel(x, y));
            assert_eq!(whole.get_pixel(x, y).0[3] + whole.get_pixel(4 + x, 4 + y).0[3], 0);
        }
        let again = enlarged_tile_png(&joined, (1, 1, 0), 4, &Notes::default()).unwrap();
        assert_eq!(decode(&again), one);
        // Just before the middle of the second pixel of the first row, and between it and the third.
        let enlarged = |part, size_px, at: (u32, u32)| {
            let tile = enlarged_tile_png(&tile, part, size_px, &Notes::default()).unwrap();
            decode(&tile).get_pixel(at.0, at.1).0
        };
        let [left, right] = [1, 2].map(|x| one.get_pixel(x, 0).0);
        let (deep, between) = (enlarged((5, 11, 0), 4, (3, 3)), enlarged((3, 3, 0), 2, (1, 1)));
        for at in 0..4 {
            assert!(deep[at].abs_diff(left[at]) <= 3, "{deep:?} {left:?}");
            let mean = 0.625 * f64::from(left[at]) + 0.375 * f64::from(right[at]);
            assert!((f64::from(between[at]) - mean).abs() < 3.0, "{left:?} {between:?} {right:?}");
        }
        assert!(between != left && between != right);
        assert!(enlarged_tile_png(b"no picture", (1, 0, 0), 4, &Notes::default()).is_err());
    }

    /// A slope that faces north west is lighter than one that faces away.
    #[test]
    fn north_west_slopes_are_lighter() {
        // A ridge that rises to the south-east, then falls.
        let altitudes: Vec<f32> = (0..64)
            .map(|i| {
                let (x, y) = (i % 8, i / 8);
                300.0 - ((x + y) as f32 - 7.0).abs() * 20.0
            })
            .collect();
        let tile = decode(&elevation_tile_png(&altitudes, &[true; 64], 8, 30.0, &Notes::default()).unwrap());
        let sum = |x, y| tile.get_pixel(x, y).0[..3].iter().map(|&c| u32::from(c)).sum::<u32>();
        assert!(sum(2, 2) > sum(5, 5), "{} {}", sum(2, 2), sum(5, 5));
        assert_eq!(tile.get_pixel(0, 0).0[3], 255);
    }

    /// Higher ground has another tint than lower ground.
    #[test]
    fn ground_tint_depends_on_its_altitude() {
        assert_eq!(tint(-50.0), TINTS[0].1);
        assert_eq!(tint(9000.0), TINTS[7].1);
        assert_ne!(tint(100.0), tint(1500.0));
    }
}
