//! Global GeoTIFFs written strip by strip, deflated on all cores.

use flate2::{Compression, write::ZlibEncoder};
use rayon::prelude::*;
use skyglow_physics::EARTH_RADIUS_M;
use std::{error::Error, fs::File, io::BufWriter, io::Write, path::Path};
use tiff::{encoder::TiffEncoder, tags::Tag};

/// Rows of a strip.
const STRIP_ROWS: u32 = 16;
/// Strips that are in memory together.
const STRIPS_AT_ONCE: u32 = 16;

/// A grid of the whole Earth, from its north-western corner.
#[derive(Clone, Copy, Debug)]
pub(super) struct GlobalGrid {
    pub(super) width: u32,
    pub(super) height: u32,
    step_deg: f64,
}

impl GlobalGrid {
    /// Of pixels of so many arc seconds.
    pub(super) fn new(arcsec: u32) -> Result<Self, String> {
        let height = 180 * 3_600 / arcsec.max(1);
        if arcsec == 0 || height * arcsec != 180 * 3_600 {
            return Err(format!("{arcsec} arc seconds do not divide 180 degrees"));
        }
        Ok(Self { width: 2 * height, height, step_deg: 180.0 / f64::from(height) })
    }

    /// Of the middle of a row.
    pub(super) fn latitude_deg(self, row: u32) -> f64 {
        90.0 - (f64::from(row) + 0.5) * self.step_deg
    }

    /// Of the middle of a column.
    pub(super) fn longitude_deg(self, column: u32) -> f64 {
        (f64::from(column) + 0.5) * self.step_deg - 180.0
    }

    /// Columns and rows from the corner.
    pub(super) fn position(self, latitude_deg: f64, longitude_deg: f64) -> [f64; 2] {
        [(longitude_deg + 180.0) / self.step_deg, (90.0 - latitude_deg) / self.step_deg]
    }

    /// Side of a pixel along a meridian, metres.
    pub(super) fn pixel_m(self) -> f64 {
        EARTH_RADIUS_M * self.step_deg.to_radians()
    }

    #[cfg(test)]
    pub(super) fn row_of(self, latitude_deg: f64) -> u32 {
        self.position(latitude_deg, 0.0)[1] as u32
    }

    #[cfg(test)]
    pub(super) fn column_of(self, longitude_deg: f64) -> u32 {
        self.position(0.0, longitude_deg)[0] as u32
    }
}

/// What a raster can hold.
pub(super) trait Sample: Copy + Default + Send + Sync {
    /// TIFF's number of it: 2 for signed integers, 3 for floating point.
    const SAMPLE_FORMAT: u16;
    /// TIFF's number of the predictor: 1 for none, 2 for differences along a row.
    const PREDICTOR: u16;

    /// Appends a row's bytes, after the predictor.
    fn to_bytes(line: &[Self], bytes: &mut Vec<u8>);
}

impl Sample for f32 {
    const SAMPLE_FORMAT: u16 = 3;
    const PREDICTOR: u16 = 1;

    fn to_bytes(line: &[Self], bytes: &mut Vec<u8>) {
        bytes.extend_from_slice(bytemuck::cast_slice(line));
    }
}

impl Sample for i16 {
    const SAMPLE_FORMAT: u16 = 2;
    const PREDICTOR: u16 = 2;

    fn to_bytes(line: &[Self], bytes: &mut Vec<u8>) {
        let mut before = 0i16;
        for &value in line {
            bytes.extend(value.wrapping_sub(before).to_ne_bytes());
            before = value;
        }
    }
}

/// Writes a raster of one band in EPSG:4326.
///
/// * `paint`: fills whole rows from a first one, and counts something in them.
///
/// Returns the sum of the counts.
pub(super) fn write<T: Sample>(
    path: &Path,
    grid: GlobalGrid,
    no_data: Option<f64>,
    paint: &(dyn Fn(u32, &mut [T]) -> u64 + Sync),
) -> Result<u64, Box<dyn Error>> {
    let mut file = BufWriter::new(File::create(path)?);
    let mut encoder = TiffEncoder::new(&mut file)?;
    let mut directory = encoder.image_directory()?;
    let strip_count = grid.height.div_ceil(STRIP_ROWS);
    let (mut offsets, mut lengths, mut counted) = (Vec::new(), Vec::new(), 0);
    for first_strip in (0..strip_count).step_by(STRIPS_AT_ONCE as usize) {
        let strips = first_strip..(first_strip + STRIPS_AT_ONCE).min(strip_count);
        let packed: Vec<std::io::Result<(Vec<u8>, u64)>> =
            strips.into_par_iter().map(|strip| pack(grid, strip * STRIP_ROWS, paint)).collect();
        for strip in packed {
            let (bytes, count) = strip?;
            offsets.push(u32::try_from(directory.write_data(&bytes[..])?)?);
            lengths.push(u32::try_from(bytes.len())?);
            counted += count;
        }
    }
    directory.write_tag(Tag::ImageWidth, grid.width)?;
    directory.write_tag(Tag::ImageLength, grid.height)?;
    directory.write_tag(Tag::BitsPerSample, 8 * size_of::<T>() as u16)?;
    directory.write_tag(Tag::SampleFormat, T::SAMPLE_FORMAT)?;
    directory.write_tag(Tag::SamplesPerPixel, 1u16)?;
    // Deflate; black is zero.
    directory.write_tag(Tag::Compression, 8u16)?;
    directory.write_tag(Tag::Predictor, T::PREDICTOR)?;
    directory.write_tag(Tag::PhotometricInterpretation, 1u16)?;
    directory.write_tag(Tag::RowsPerStrip, STRIP_ROWS)?;
    directory.write_tag(Tag::StripOffsets, &offsets[..])?;
    directory.write_tag(Tag::StripByteCounts, &lengths[..])?;
    directory.write_tag(Tag::ModelPixelScaleTag, &[grid.step_deg, grid.step_deg, 0.0][..])?;
    directory.write_tag(Tag::ModelTiepointTag, &[0.0, 0.0, 0.0, -180.0, 90.0, 0.0][..])?;
    // As in `skyglow_lab::light_raster`: geographic, pixel is area, WGS 84.
    let keys: [u16; 16] = [1, 1, 0, 3, 1024, 0, 1, 2, 1025, 0, 1, 1, 2048, 0, 1, 4326];
    directory.write_tag(Tag::GeoKeyDirectoryTag, &keys[..])?;
    if let Some(no_data) = no_data {
        directory.write_tag(Tag::GdalNodata, &*no_data.to_string())?;
    }
    directory.finish()?;
    file.flush()?;
    Ok(counted)
}

/// A strip's bytes, and what was counted in it.
fn pack<T: Sample>(
    grid: GlobalGrid,
    first_row: u32,
    paint: &(dyn Fn(u32, &mut [T]) -> u64 + Sync),
) -> std::io::Result<(Vec<u8>, u64)> {
    let rows = STRIP_ROWS.min(grid.height - first_row);
    let width = grid.width as usize;
    let mut values = vec![T::default(); width * rows as usize];
    let count = paint(first_row, &mut values);
    let mut bytes = Vec::with_capacity(size_of_val(&values[..]));
    values.chunks_exact(width).for_each(|line| T::to_bytes(line, &mut bytes));
    let mut packed = ZlibEncoder::new(Vec::new(), Compression::fast());
    packed.write_all(&bytes)?;
    Ok((packed.finish()?, count))
}
