//! Numbers of places or of single pixels as GeoTIFF files in the scene's CRS.

use crate::dual_tree::PlaceValues;
use crate::metadata::GridMetadata;
use crate::morton;
use gdal::raster::{Buffer, RasterBand, RasterCreationOptions};
use gdal::spatial_ref::SpatialRef;
use gdal::{Dataset, DriverManager, Metadata, vsi};
use std::ffi::CString;
use std::sync::atomic::{AtomicU64, Ordering};
use thiserror::Error;

/// Side of a tile of a sparse file, pixels, as a power of two.
const TILE_SHIFT: u32 = 8;
const TILE_SIDE: u32 = 1 << TILE_SHIFT;
/// Sides of the coarsest overview of a sparse file at most, pixels.
const LARGEST_OVERVIEW: u32 = 512;

/// GDAL could not write a raster.
#[derive(Clone, Debug, PartialEq, Error)]
#[error("a GeoTIFF could not be written: {0}")]
pub struct RasterError(String);

impl From<gdal::errors::GdalError> for RasterError {
    fn from(error: gdal::errors::GdalError) -> Self {
        Self(error.to_string())
    }
}

/// The metadata of a raster.
#[derive(Clone, Copy, Debug)]
pub struct RasterMetadata<'a> {
    /// What the numbers are: the band's description.
    pub description: &'a str,
    /// Their unit.
    pub unit: &'a str,
    /// Names and texts that go into the file's metadata.
    pub notes: &'a [(&'a str, &'a str)],
}

/// Numbers of pixels as a cloud-optimized GeoTIFF on the scene's grid and in its CRS: one float32 band, deflated, with overviews of means;
/// all other pixels are no data (NaN). Only tiles with numbers are written, so a few pixels of a large raster are a small file.
///
/// * `pixels`: Morton codes, ascending, each with its number.
pub(crate) fn of_pixels(
    grid: &GridMetadata,
    pixels: &[(u64, f32)],
    metadata: &RasterMetadata<'_>,
) -> Result<Vec<u8>, RasterError> {
    let file = MemoryFile::new();
    let driver = DriverManager::get_driver_by_name("GTiff")?;
    let options = RasterCreationOptions::from_iter([
        "COMPRESS=DEFLATE",
        "PREDICTOR=3",
        "TILED=YES",
        "SPARSE_OK=TRUE",
        "BIGTIFF=IF_SAFER",
    ]);
    let size = (grid.width as usize, grid.height as usize);
    let mut dataset =
        driver.create_with_band_type_with_options::<f32, _>(&file.0, size.0, size.1, 1, &options)?;
    describe(&mut dataset, &grid.geotransform, &grid.crs_wkt, metadata)?;
    // Such a file has its directories first, then the data of overviews from the coarsest on. GDAL's own driver for it visits every tile
    // of the raster, which takes seconds of a large one; here only those with numbers are written, in that order.
    let mut levels = vec![pixels.to_vec()];
    while (grid.width.max(grid.height) >> (levels.len() - 1)) > LARGEST_OVERVIEW {
        levels.push(halved(&levels[levels.len() - 1]));
    }
    let factors: Vec<i32> = (1..levels.len()).map(|level| 1 << level).collect();
    if !factors.is_empty() {
        dataset.build_overviews("NONE", &factors, &[])?;
    }
    let mut band = dataset.rasterband(1)?;
    for (level, pixels) in levels.iter().enumerate().rev() {
        match level.checked_sub(1) {
            Some(index) => write_tiles(&mut band.overview(index)?, pixels)?,
            None => write_tiles(&mut band, pixels)?,
        }
    }
    dataset.close()?;
    Ok(vsi::get_vsi_mem_file_bytes_owned(&file.0)?)
}

/// Numbers of pixels into those tiles of a band that have any; in the file when this returns.
fn write_tiles(band: &mut RasterBand<'_>, pixels: &[(u64, f32)]) -> Result<(), RasterError> {
    // Pixels of a tile are one run of codes.
    let tile_of = |pixel: &(u64, f32)| pixel.0 >> (2 * TILE_SHIFT);
    let (columns, rows) = band.size();
    for run in pixels.chunk_by(|a, b| tile_of(a) == tile_of(b)) {
        let (tile_column, tile_row) = morton::decode(tile_of(&run[0]));
        let (west, north) = (tile_column * TILE_SIDE, tile_row * TILE_SIDE);
        let cut = |from: u32, whole: usize| (TILE_SIDE as usize).min(whole - from as usize);
        let (width, height) = (cut(west, columns), cut(north, rows));
        let mut tile = vec![f32::NAN; width * height];
        for &(code, value) in run {
            let (column, row) = morton::decode(code);
            tile[(row - north) as usize * width + (column - west) as usize] = value;
        }
        let mut buffer = Buffer::new((width, height), tile);
        band.write((west as isize, north as isize), (width, height), &mut buffer)?;
    }
    flush(band)
}

/// Pixels twice as large, each the mean of those in it that have a number.
fn halved(pixels: &[(u64, f32)]) -> Vec<(u64, f32)> {
    let mean = |run: &[(u64, f32)]| {
        let sum: f64 = run.iter().map(|pixel| f64::from(pixel.1)).sum();
        (run[0].0 >> 2, (sum / run.len() as f64) as f32)
    };
    pixels.chunk_by(|a, b| a.0 >> 2 == b.0 >> 2).map(mean).collect()
}

/// Numbers of places as a cloud-optimized GeoTIFF in the scene's CRS: one float32 band, deflated, with overviews; NaN is no data.
pub(crate) fn of_places(
    grid: &GridMetadata,
    places: &PlaceValues,
    metadata: &RasterMetadata<'_>,
) -> Result<Vec<u8>, RasterError> {
    let lattice = places.lattice();
    let size = (lattice.columns as usize, lattice.rows as usize);
    let memory = DriverManager::get_driver_by_name("MEM")?;
    let mut dataset = memory.create_with_band_type::<f32, _>("", size.0, size.1, 1)?;
    let geotransform = lattice.geotransform(grid.geotransform);
    let mut band = describe(&mut dataset, &geotransform, &grid.crs_wkt, metadata)?;
    band.write((0, 0), size, &mut Buffer::new(size, places.values().to_vec()))?;
    let file = MemoryFile::new();
    let options = RasterCreationOptions::from_iter([
        "COMPRESS=DEFLATE",
        "PREDICTOR=YES",
        "OVERVIEW_RESAMPLING=AVERAGE",
        "BIGTIFF=IF_SAFER",
    ]);
    let cog = DriverManager::get_driver_by_name("COG")?;
    dataset.create_copy(&cog, &file.0, &options)?.close()?;
    Ok(vsi::get_vsi_mem_file_bytes_owned(&file.0)?)
}

/// Georeferences and describes a dataset; returns its only band.
fn describe<'a>(
    dataset: &'a mut Dataset,
    geotransform: &[f64; 6],
    crs_wkt: &str,
    metadata: &RasterMetadata<'_>,
) -> Result<RasterBand<'a>, RasterError> {
    dataset.set_geo_transform(geotransform)?;
    dataset.set_spatial_ref(&SpatialRef::from_wkt(crs_wkt)?)?;
    for (name, text) in metadata.notes {
        dataset.set_metadata_item(name, text, "")?;
    }
    let mut band = dataset.rasterband(1)?;
    band.set_no_data_value(Some(f64::NAN))?;
    band.set_description(metadata.description)?;
    set_unit(&band, metadata.unit)?;
    Ok(band)
}

/// The unit of a band, which the bindings can read and not write.
fn set_unit(band: &RasterBand<'_>, unit: &str) -> Result<(), RasterError> {
    let unit = CString::new(unit).map_err(|error| RasterError(error.to_string()))?;
    #[expect(unsafe_code, reason = "the safe bindings have no such call")]
    // SAFETY: the band is open while it is borrowed, and the text ends in 0 and is copied by the callee.
    let result = unsafe { gdal_sys::GDALSetRasterUnitType(band.c_rasterband(), unit.as_ptr()) };
    if result == gdal_sys::CPLErr::CE_None {
        Ok(())
    } else {
        Err(RasterError("the unit was refused".to_owned()))
    }
}

/// Writes what a band has in its cache.
fn flush(band: &RasterBand<'_>) -> Result<(), RasterError> {
    #[expect(unsafe_code, reason = "the safe bindings have no such call")]
    // SAFETY: the band is open while it is borrowed.
    let result = unsafe { gdal_sys::GDALFlushRasterCache(band.c_rasterband()) };
    if result == gdal_sys::CPLErr::CE_None {
        Ok(())
    } else {
        Err(RasterError("its tiles were not written".to_owned()))
    }
}

/// A file in memory, removed when this is dropped.
struct MemoryFile(String);

impl MemoryFile {
    fn new() -> Self {
        static NEXT: AtomicU64 = AtomicU64::new(0);
        Self(format!("/vsimem/skyglow-pixels-{}.tif", NEXT.fetch_add(1, Ordering::Relaxed)))
    }
}

impl Drop for MemoryFile {
    fn drop(&mut self) {
        // It is not there after its bytes were taken.
        drop(vsi::unlink_mem_file(&self.0));
    }
}
