//! GeoTIFFs of made-up light, written without GDAL.

use std::io::Cursor;
use tiff::{
    TiffResult,
    encoder::{TiffEncoder, colortype::Gray32Float},
    tags::Tag,
};

/// A raster of radiances, or altitudes, along parallels and meridians.
#[derive(Clone, Debug)]
pub struct LightRaster {
    /// Longitude of the western edge, degrees.
    pub west_deg: f64,
    /// Latitude of the northern edge, degrees.
    pub north_deg: f64,
    /// Width and height of a pixel, degrees.
    pub step_deg: (f64, f64),
    /// Columns and rows.
    pub size: (u32, u32),
    /// Values row by row, nW cm⁻² sr⁻¹ or metres.
    pub values: Vec<f32>,
}

impl LightRaster {
    /// A raster whose pixel (column, row) has the value `of`.
    pub fn new(
        (west_deg, north_deg): (f64, f64),
        step_deg: (f64, f64),
        size: (u32, u32),
        of: impl Fn(u32, u32) -> f32,
    ) -> Self {
        let pixels = (0..size.1).flat_map(|row| (0..size.0).map(move |column| (column, row)));
        let values = pixels.map(|(column, row)| of(column, row)).collect();
        Self { west_deg, north_deg, step_deg, size, values }
    }

    /// The raster with its rows upside down, as far south of the equator as it was north.
    #[must_use]
    pub fn mirrored(&self) -> Self {
        let (width, height) = (self.size.0 as usize, self.size.1);
        Self {
            north_deg: -(self.north_deg - self.step_deg.1 * f64::from(height)),
            values: self.values.chunks_exact(width).rev().flatten().copied().collect(),
            ..self.clone()
        }
    }

    /// The bytes of a one-band GeoTIFF in EPSG:4326.
    ///
    /// # Errors
    /// Sizes that do not fit the values.
    pub fn to_geotiff(&self) -> TiffResult<Vec<u8>> {
        let mut file = Cursor::new(Vec::new());
        let mut encoder = TiffEncoder::new(&mut file)?;
        let mut image = encoder.new_image::<Gray32Float>(self.size.0, self.size.1)?;
        let tags = image.encoder();
        tags.write_tag(Tag::ModelPixelScaleTag, &[self.step_deg.0, self.step_deg.1, 0.0][..])?;
        let corner = [0.0, 0.0, 0.0, self.west_deg, self.north_deg, 0.0];
        tags.write_tag(Tag::ModelTiepointTag, &corner[..])?;
        // Header (version 1.1.0, number of keys), then key, location, count, value: geographic, pixel is area, WGS 84.
        let keys: [u16; 16] = [1, 1, 0, 3, 1024, 0, 1, 2, 1025, 0, 1, 1, 2048, 0, 1, 4326];
        tags.write_tag(Tag::GeoKeyDirectoryTag, &keys[..])?;
        image.write_data(&self.values)?;
        Ok(file.into_inner())
    }
}
