//! Small GeoTIFFs, right and wrong, written without GDAL.

use std::{fs::File, path::Path};
use tiff::{
    encoder::{TiffEncoder, colortype},
    tags::Tag,
};

/// How a raster lies on the Earth.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Crs {
    /// No geo keys and no position at all.
    None,
    /// A position without a coordinate reference system.
    PositionOnly,
    /// Geographic, WGS84 (EPSG:4326).
    Geographic,
    /// Projected, with this EPSG code; the position stays in degrees.
    Projected(u16),
}

/// Side of every raster, pixels.
pub(crate) const SIDE: u32 = 40;
/// Degrees a pixel: 15 arc seconds, as the satellite's products have.
pub(crate) const STEP_DEG: f64 = 1.0 / 240.0;
/// Longitude of the western edge and latitude of the northern edge, degrees.
pub(crate) const CORNER_DEG: (f64, f64) = (36.75, -1.2);

/// Radiance of a small town in the middle and darkness around it, nW cm⁻² sr⁻¹.
pub(crate) fn town() -> Vec<f32> {
    let middle = f64::from(SIDE) / 2.0;
    (0..SIDE * SIDE)
        .map(|index| {
            let (x, y) = (f64::from(index % SIDE) + 0.5 - middle, f64::from(index / SIDE) + 0.5 - middle);
            let radiance = 40.0 * (-(x * x + y * y) / 18.0).exp();
            if radiance < 0.5 { 0.0 } else { radiance as f32 }
        })
        .collect()
}

/// Altitudes of level ground with a low ridge along a meridian, east of [`town`]: 0.3 to 1.6° high as the town's lights
/// see it, metres.
pub(crate) fn ridge() -> Vec<f32> {
    (0..SIDE * SIDE).map(|index| if index % SIDE == 32 { 450.0 } else { 400.0 }).collect()
}

/// Writes radiances [nW cm⁻² sr⁻¹] or altitudes [m] as a one-band float GeoTIFF with no-data −999.
pub(crate) fn write_radiance(path: &Path, crs: Crs, radiance_nw_cm2_sr: &[f32]) {
    let mut encoder = TiffEncoder::new(File::create(path).unwrap()).unwrap();
    let mut image = encoder.new_image::<colortype::Gray32Float>(SIDE, SIDE).unwrap();
    write_position(image.encoder(), crs);
    image.encoder().write_tag(Tag::GdalNodata, "-999").unwrap();
    image.write_data(radiance_nw_cm2_sr).unwrap();
}

/// Writes an eight-bit grey picture, as a map rendered for the eye is.
pub(crate) fn write_picture(path: &Path) {
    let mut encoder = TiffEncoder::new(File::create(path).unwrap()).unwrap();
    let mut image = encoder.new_image::<colortype::Gray8>(SIDE, SIDE).unwrap();
    write_position(image.encoder(), Crs::Geographic);
    let pixels: Vec<u8> = (0..SIDE * SIDE).map(|index| (index % 256) as u8).collect();
    image.write_data(&pixels).unwrap();
}

fn write_position<W: std::io::Write + std::io::Seek, K: tiff::encoder::TiffKind>(
    directory: &mut tiff::encoder::DirectoryEncoder<'_, W, K>,
    crs: Crs,
) {
    if matches!(crs, Crs::None) {
        return;
    }
    directory.write_tag(Tag::ModelPixelScaleTag, &[STEP_DEG, STEP_DEG, 0.0][..]).unwrap();
    directory
        .write_tag(Tag::ModelTiepointTag, &[0.0, 0.0, 0.0, CORNER_DEG.0, CORNER_DEG.1, 0.0][..])
        .unwrap();
    // Header (version 1.1.0, number of keys), then key, location, count, value.
    let keys: &[u16] = match crs {
        Crs::None | Crs::PositionOnly => return,
        Crs::Geographic => &[1, 1, 0, 3, 1024, 0, 1, 2, 1025, 0, 1, 1, 2048, 0, 1, 4326],
        Crs::Projected(code) => &[1, 1, 0, 3, 1024, 0, 1, 1, 1025, 0, 1, 1, 3072, 0, 1, code],
    };
    directory.write_tag(Tag::GeoKeyDirectoryTag, keys).unwrap();
}
