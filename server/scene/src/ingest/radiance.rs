//! Reading the radiance raster: classifies its pixels and reports what looks wrong.

use super::gdal_open::gdal_reason;
use super::options::{IngestProgress, IngestStage};
use super::radiance_source::RadianceSource;
use super::{georeference, tally::Tally};
use crate::error::SceneError;
use crate::grid::Grid;
use crate::lit_pixels::LitPixels;
use crate::mask::ValidMask;
use crate::metadata::IngestReport;
use crate::morton;
use gdal::raster::RasterBand;

/// Values read at once.
const STRIP_VALUES: usize = 1 << 22;
/// The largest value on at least this many pixels looks like a cap.
const MIN_CAPPED_PIXELS: u64 = 10;
/// A largest value that is a multiple of this, nW cm⁻² sr⁻¹, looks like a cap even on one pixel.
const ROUND_CAP: f64 = 1_000.0;
/// No light on Earth is near this, nW cm⁻² sr⁻¹: flares of gas reach 1e5.
const MAX_RADIANCE_NW_CM2_SR: f64 = 1e7;
/// More than one lit pixel in this many off the world means a wrong CRS.
const OFF_WORLD_SHARE: u64 = 100;

/// The light of a raster.
pub(super) struct RadianceRaster {
    pub(super) grid: Grid,
    pub(super) mask: ValidMask,
    pub(super) pixels: LitPixels,
    pub(super) report: IngestReport,
}

/// Counts while the raster is read.
#[derive(Default)]
struct PixelStatistics {
    lit: Tally,
    zero: Tally,
    negative: Tally,
    nan: Tally,
    infinite: Tally,
    no_data: Tally,
    at_maximum: Tally,
    outside_world: Tally,
    minimum: f64,
    maximum: f64,
    sum: f64,
    all_whole: bool,
}

/// Reads all of it.
pub(super) fn read(
    source: &RadianceSource,
    progress: &mut dyn FnMut(IngestProgress),
) -> Result<RadianceRaster, SceneError> {
    let refuse = |reason: String| SceneError::Refused { path: source.path.clone(), reason };
    let grid = georeference::grid(&source.geotransform, &source.crs, source.dataset.raster_size())
        .map_err(refuse)?;
    let band = source.dataset.rasterband(source.band_number).map_err(|e| refuse(gdal_reason(e)))?;
    let flags = band.mask_flags().map_err(|e| refuse(gdal_reason(e)))?;
    // GDAL itself takes no float band for a mask, so transparency is read as the band that it is.
    let mask_band = match source.alpha_band {
        Some(number) => Some(source.dataset.rasterband(number)),
        None => (flags.is_per_dataset() && !flags.is_nodata()).then(|| band.open_mask_band()),
    };
    let mask_band = mask_band.transpose().map_err(|e| refuse(gdal_reason(e)))?;
    let (width, height) = (grid.width as usize, grid.height as usize);
    let rows_at_once = (STRIP_VALUES / width).clamp(1, height.min(512));
    let mut values = vec![0f64; width * rows_at_once];
    let mut flags = vec![u8::MAX; width * rows_at_once];
    let mut statistics = PixelStatistics {
        minimum: f64::INFINITY,
        maximum: f64::NEG_INFINITY,
        all_whole: true,
        ..PixelStatistics::default()
    };
    let mut valid = ValidMask::begin(grid.width);
    let mut pixels = LitPixels::default();
    for first_row in (0..height).step_by(rows_at_once) {
        progress(IngestProgress {
            stage: IngestStage::Radiance,
            done: first_row as u64,
            total: height as u64,
        });
        let rows = rows_at_once.min(height - first_row);
        read_rows(&band, first_row, rows, &mut values[..rows * width], source)?;
        if let Some(mask_band) = &mask_band {
            read_rows(mask_band, first_row, rows, &mut flags[..rows * width], source)?;
        }
        for (offset, line) in values[..rows * width].chunks_exact(width).enumerate() {
            let row = (first_row + offset) as u32;
            let masked = &flags[offset * width..][..width];
            valid.push_row(line.iter().zip(masked).enumerate().map(|(column, (&stored, &flag))| {
                let is_no_data = flag == 0 || source.conversion.no_data.is_some_and(|n| is_same(stored, n));
                statistics.classify(source, &grid, (column as u32, row), stored, is_no_data, &mut pixels)
            }));
        }
    }
    progress(IngestProgress { stage: IngestStage::Radiance, done: height as u64, total: height as u64 });
    statistics.check().map_err(refuse)?;
    pixels.sort();
    let report = statistics.report(source, &grid);
    Ok(RadianceRaster { grid, mask: valid.finish(), pixels, report })
}

/// No-data values compare as floats of the raster's own precision; NaN is NaN.
fn is_same(stored: f64, no_data: f64) -> bool {
    stored == no_data
        || (stored.is_nan() && no_data.is_nan())
        || (no_data.abs() > 1e30 && stored as f32 == no_data as f32)
}

fn read_rows<T: Copy + gdal::raster::GdalType>(
    band: &RasterBand<'_>,
    first_row: usize,
    rows: usize,
    values: &mut [T],
    source: &RadianceSource,
) -> Result<(), SceneError> {
    let width = band.x_size();
    band.read_into_slice((0, first_row as isize), (width, rows), (width, rows), values, None).map_err(
        |error| {
            let reason = format!("it is truncated or broken near row {first_row} ({})", gdal_reason(error));
            SceneError::Unreadable { path: source.path.clone(), reason }
        },
    )
}

impl PixelStatistics {
    /// Counts one pixel, adds it if it is lit, and returns whether it is a measurement.
    fn classify(
        &mut self,
        source: &RadianceSource,
        grid: &Grid,
        (column, row): (u32, u32),
        stored: f64,
        is_no_data: bool,
        pixels: &mut LitPixels,
    ) -> bool {
        if is_no_data {
            self.no_data.add(column, row);
            return false;
        }
        let radiance = (stored * source.conversion.scale + source.conversion.offset) as f32;
        if !radiance.is_finite() {
            let kind = if radiance.is_nan() { &mut self.nan } else { &mut self.infinite };
            kind.add(column, row);
            return false;
        }
        let value = f64::from(radiance);
        self.minimum = self.minimum.min(value);
        self.all_whole &= stored.fract() == 0.0;
        if value > self.maximum {
            (self.maximum, self.at_maximum) = (value, Tally::default());
        }
        if value == self.maximum {
            self.at_maximum.add(column, row);
        }
        if value < 0.0 {
            self.negative.add(column, row);
        } else if value == 0.0 {
            self.zero.add(column, row);
        } else if grid.center(column, row).is_finite() {
            self.lit.add(column, row);
            self.sum += value;
            pixels.codes.push(morton::encode(column, row));
            pixels.radiance_nw_cm2_sr.push(radiance);
            pixels.altitude_m.push(0.0);
        } else {
            self.outside_world.add(column, row);
            return false;
        }
        true
    }

    /// Refuses rasters that cannot be radiances.
    fn check(&self) -> Result<(), String> {
        if self.minimum > self.maximum {
            return Err("it holds no measurement: every pixel is no-data, NaN or infinite".to_owned());
        }
        if self.outside_world.count * OFF_WORLD_SHARE > self.lit.count + self.outside_world.count {
            return Err(format!(
                "{} of its lit pixels have no place on Earth, so its CRS is not the right one",
                self.outside_world.count
            ));
        }
        if self.lit.count == 0 {
            return Err(format!(
                "it holds no light: its values run from {} to {}, none above 0",
                self.minimum, self.maximum
            ));
        }
        if self.maximum > MAX_RADIANCE_NW_CM2_SR {
            return Err(format!(
                "its largest value is {:e} nW cm-2 sr-1, far above all that shines on Earth ({MAX_RADIANCE_NW_CM2_SR:e}): its unit or its \
                 scale is not the right one",
                self.maximum
            ));
        }
        Ok(())
    }

    fn report(&self, source: &RadianceSource, grid: &Grid) -> IngestReport {
        let is_capped = self.maximum > self.minimum
            && self.maximum > 0.0
            && (self.at_maximum.count >= MIN_CAPPED_PIXELS || self.maximum % ROUND_CAP == 0.0);
        let capped = if is_capped { self.at_maximum.finish(grid) } else { Default::default() };
        IngestReport {
            pixels: u64::from(grid.width) * u64::from(grid.height),
            lit: self.lit.finish(grid),
            zero: self.zero.finish(grid),
            negative: self.negative.finish(grid),
            nan: self.nan.finish(grid),
            infinite: self.infinite.finish(grid),
            no_data: self.no_data.finish(grid),
            outside_world: self.outside_world.finish(grid),
            minimum_nw_cm2_sr: self.minimum,
            maximum_nw_cm2_sr: self.maximum,
            lit_mean_nw_cm2_sr: self.sum / self.lit.count as f64,
            flux_dnb_w: 0.0,
            band: source.band_name.clone(),
            scale: source.conversion.scale,
            offset_nw_cm2_sr: source.conversion.offset,
            terrain: None,
            warnings: self.warnings(source, capped.count),
            capped,
        }
    }

    /// One sentence for each thing that tests wrong.
    fn warnings(&self, source: &RadianceSource, capped: u64) -> Vec<String> {
        let mut warnings = Vec::new();
        let measured = self.lit.count + self.zero.count + self.negative.count;
        if self.maximum < 1e-3 {
            warnings.push(format!(
                "the largest value is {:e} nW cm-2 sr-1, darker than any satellite sees: the unit is suspicious, W m-2 sr-1 perhaps (--units w-m2-sr)",
                self.maximum
            ));
        } else if self.maximum > 1e5 {
            warnings.push(format!(
                "the largest value is {:e} nW cm-2 sr-1, brighter than any town: the unit or the scale is suspicious",
                self.maximum
            ));
        }
        if self.all_whole
            && source.conversion.scale == 1.0
            && self.minimum >= 0.0
            && self.maximum <= 255.0
            && measured > 100
        {
            warnings.push(
                "all values are whole numbers from 0 to 255, as in a picture: they may not be radiances"
                    .to_owned(),
            );
        }
        if capped > 0 {
            warnings.push(format!(
                "{} at exactly the largest value, {}: the raster seems to be capped there",
                if capped == 1 { "1 pixel is".to_owned() } else { format!("{capped} pixels are") },
                self.maximum
            ));
        }
        if self.infinite.count > 0 {
            warnings.push(format!(
                "{} pixels are infinite and count as no data: something overflowed where the raster was made",
                self.infinite.count
            ));
        }
        if self.negative.count > self.lit.count {
            warnings.push(format!(
                "{} pixels are negative and {} lit: the lights may be noise",
                self.negative.count, self.lit.count
            ));
        }
        if self.zero.count + self.negative.count == 0 && measured > 10_000 {
            warnings.push(
                "no pixel is dark: the raster may hold a background or not be radiance at all".to_owned(),
            );
        }
        warnings
    }
}
