//! Reading the radiance rasters: classifies their pixels and finds noise and codes among them.

use super::georeference;
use super::memory;
use super::mosaic::Mosaic;
use super::noise::Negatives;
use super::options::{IngestOptions, IngestProgress, IngestStage, NoisePolicy};
use super::radiance_source::{PixelKind, Strip};
use super::statistics::PixelStatistics;
use crate::error::SceneError;
use crate::grid::Grid;
use crate::lit_pixels::LitPixels;
use crate::mask::ValidMask;
use crate::metadata::{IngestReport, NoiseReport};
use crate::morton;

/// Values read at once.
const STRIP_VALUES: usize = 1 << 22;

/// The light of a raster.
pub(super) struct RadianceRaster {
    pub(super) grid: Grid,
    pub(super) mask: ValidMask,
    pub(super) pixels: LitPixels,
    pub(super) report: IngestReport,
}

/// What one reading of all pixels found.
struct Scan {
    mask: ValidMask,
    pixels: LitPixels,
    negatives: Negatives,
    statistics: PixelStatistics,
}

/// Reads all of it.
///
/// # Errors
/// Rasters that cannot be meant, and those whose light does not fit into the memory that there is.
pub(super) fn read(
    mosaic: &Mosaic,
    options: &IngestOptions,
    progress: &mut dyn FnMut(IngestProgress),
) -> Result<RadianceRaster, SceneError> {
    let first = mosaic.first();
    let refuse = |reason: String| SceneError::Refused { path: first.path.clone(), reason };
    let grid = georeference::grid(&mosaic.geotransform, &mosaic.crs, mosaic.size).map_err(refuse)?;
    check_memory(mosaic, &grid, options).map_err(refuse)?;
    let mut scan = scan(mosaic, &grid, options, None, progress)?;
    if let Some(code) = scan.statistics.repeated_minimum() {
        scan = self::scan(mosaic, &grid, options, Some(code), progress)?;
        scan.statistics.found_fill(code);
    }
    let Scan { mask, mut pixels, negatives, statistics } = scan;
    statistics.check(mosaic, options).map_err(refuse)?;
    pixels.sort();
    let lit_before = statistics.lit_sum();
    let noise = negatives.are_noise(statistics.measured()).then(|| {
        let bias = lit_before / (lit_before - negatives.sum()).max(0.01 * lit_before);
        let balance = options.noise == NoisePolicy::Balance;
        let balanced = if balance { negatives.balance(&mut pixels) } else { negatives.left_alone() };
        NoiseReport {
            deviation_nw_cm2_sr: balanced.deviation,
            bias,
            balanced: balance,
            darkened: balanced.darkened,
        }
    });
    if pixels.len() == 0 {
        return Err(refuse(
            "it holds no light: all that is above zero is balanced by what is below, so it is noise (--noise cut takes it for light)"
                .to_owned(),
        ));
    }
    let report = statistics.report(mosaic, &grid, noise, &pixels);
    Ok(RadianceRaster { grid, mask, pixels, report })
}

/// Refuses, before work begins, light that does not fit: where every pixel could be lit and would not, those that are get counted.
fn check_memory(mosaic: &Mosaic, grid: &Grid, options: &IngestOptions) -> Result<(), String> {
    let pixels = u64::from(grid.width) * u64::from(grid.height);
    let Some(available) = options.memory_bytes.or_else(memory::available_bytes) else { return Ok(()) };
    if memory::needed_bytes(pixels, pixels) <= available {
        return Ok(());
    }
    let lit = count_lit(mosaic, options).map_err(|error| error.to_string())?;
    let needed = memory::needed_bytes(pixels, lit);
    if needed <= available {
        return Ok(());
    }
    let gigabytes = |bytes: u64| bytes as f64 / 1e9;
    Err(format!(
        "its {lit} lit pixels need {:.1} GB of memory and {:.1} GB are free: a masked product has far fewer, --floor 0.5 leaves noise \
         out, and gdal_translate -projwin cuts a region",
        gigabytes(needed),
        gigabytes(available)
    ))
}

fn rows_at_once(mosaic: &Mosaic) -> usize {
    let (width, height) = mosaic.size;
    (STRIP_VALUES / width.max(1)).clamp(1, height.clamp(1, 512))
}

fn count_lit(mosaic: &Mosaic, options: &IngestOptions) -> Result<u64, SceneError> {
    let (mut strip, mut part) = (Strip::default(), Strip::default());
    let height = mosaic.size.1;
    let step = rows_at_once(mosaic);
    let floor = options.floor_nw_cm2_sr.unwrap_or(0.0);
    let mut lit = 0;
    for first_row in (0..height).step_by(step) {
        mosaic.read_rows(first_row, step.min(height - first_row), &mut strip, &mut part)?;
        let is_lit = |(kind, value): (&PixelKind, &f64)| {
            *kind == PixelKind::Measured && *value > 0.0 && *value >= floor
        };
        lit += strip.kinds.iter().zip(&strip.radiance).filter(|pixel| is_lit(*pixel)).count() as u64;
    }
    Ok(lit)
}

/// Reads every pixel once.
///
/// * `fill_nw_cm2_sr`: a value that is no data, beside those that are known.
fn scan(
    mosaic: &Mosaic,
    grid: &Grid,
    options: &IngestOptions,
    fill_nw_cm2_sr: Option<f64>,
    progress: &mut dyn FnMut(IngestProgress),
) -> Result<Scan, SceneError> {
    let (width, height) = mosaic.size;
    let step = rows_at_once(mosaic);
    let (mut strip, mut part) = (Strip { is_whole: true, ..Strip::default() }, Strip::default());
    let mut scan = Scan {
        mask: ValidMask::begin(grid.width),
        pixels: LitPixels::default(),
        negatives: Negatives::default(),
        statistics: PixelStatistics::new(options),
    };
    for first_row in (0..height).step_by(step) {
        progress(IngestProgress {
            stage: IngestStage::Radiance,
            done: first_row as u64,
            total: height as u64,
        });
        let rows = step.min(height - first_row);
        mosaic.read_rows(first_row, rows, &mut strip, &mut part)?;
        for offset in 0..rows {
            let row = (first_row + offset) as u32;
            let line = offset * width..(offset + 1) * width;
            let Scan { mask, pixels, negatives, statistics } = &mut scan;
            let (kinds, values) = (&strip.kinds[line.clone()], &strip.radiance[line]);
            mask.push_row(kinds.iter().zip(values).enumerate().map(|(column, (&kind, &value))| {
                let place = (column as u32, row);
                let kind = if kind == PixelKind::Measured && Some(value) == fill_nw_cm2_sr {
                    PixelKind::Fill
                } else {
                    kind
                };
                let found = statistics.classify(grid, place, kind, value);
                if let Some(radiance) = found.lit {
                    pixels.codes.push(morton::encode(place.0, place.1));
                    pixels.radiance_nw_cm2_sr.push(radiance);
                    pixels.altitude_m.push(0.0);
                } else if found.is_negative {
                    negatives.add(morton::encode(place.0, place.1), value);
                }
                found.is_measured
            }));
        }
    }
    progress(IngestProgress { stage: IngestStage::Radiance, done: height as u64, total: height as u64 });
    scan.statistics.all_whole = strip.is_whole;
    scan.mask = scan.mask.finish();
    Ok(scan)
}
