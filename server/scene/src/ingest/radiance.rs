//! Reading the radiance rasters: classifies their pixels and finds noise and codes among them.

use super::georeference;
use super::mosaic::Mosaic;
use super::noise::Negatives;
use super::options::{IngestOptions, IngestProgress, IngestStage, NoisePolicy};
use super::overlap_rule::OverlapRule;
use super::radiance_source::{PixelKind, Strip};
use super::statistics::{Lowest, PixelStatistics};
use crate::error::SceneError;
use crate::grid::Grid;
use crate::lit_pixels::LitPixels;
use crate::mask::ValidMask;
use crate::memory::{LEVELS, LightCount, available_bytes, gigabytes};
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
    let rule = options.overlap;
    let mixes = matches!(rule, OverlapRule::Mean | OverlapRule::Max) && mosaic.sources().nth(1).is_some();
    // Codes of missing data are found among numbers as the files have them, before they are mixed.
    let mut codes = if mixes { codes_of_sources(mosaic)? } else { Vec::new() };
    let has_noise = rule == OverlapRule::Max && mixes && {
        let first = self::scan(mosaic, &grid, options, (OverlapRule::First, &codes), progress)?;
        first.negatives.are_noise(first.statistics.measured())
    };
    let mut scan = scan(mosaic, &grid, options, (rule, &codes), progress)?;
    if let Some(code) = scan.statistics.repeated_minimum() {
        codes.push(code);
        scan = self::scan(mosaic, &grid, options, (rule, &codes), progress)?;
    }
    codes.iter().for_each(|code| scan.statistics.found_fill(*code));
    scan.statistics.noise_in_maximum = has_noise;
    let Scan { mask, mut pixels, negatives, statistics } = scan;
    statistics.check(mosaic, &grid, options).map_err(refuse)?;
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
    let free = options.memory_bytes.or_else(available_bytes).unwrap_or(u64::MAX);
    let check = |count: &LightCount| {
        let needed = count.ingest_bytes(pixels);
        if needed > free {
            return Err(format!(
                "reading its {} lit pixels needs {} of memory, and {} are free: {LESS_LIGHT}",
                count.lit,
                gigabytes(needed),
                gigabytes(free)
            ));
        }
        check_scene(count, options)
    };
    match check(&LightCount::worst(grid.width, grid.height)) {
        Ok(()) => Ok(()),
        Err(_) => check(&count_lit(mosaic, options).map_err(|error| error.to_string())?),
    }
}

/// Refuses light that would take more memory as a scene than those who open it have for one.
pub(super) fn check_scene(count: &LightCount, options: &IngestOptions) -> Result<(), String> {
    let (needed, most) = (count.scene_bytes(), options.max_scene_bytes.unwrap_or(u64::MAX));
    if needed <= most {
        return Ok(());
    }
    Err(format!(
        "as a scene its {} lit pixels need {} of memory, and the server has {} for scenes: {LESS_LIGHT}",
        count.lit,
        gigabytes(needed),
        gigabytes(most)
    ))
}

/// What helps against too much light.
const LESS_LIGHT: &str =
    "a masked product has far fewer, --floor 0.5 leaves noise out, and gdal_translate -projwin cuts a region";

fn rows_at_once(mosaic: &Mosaic) -> usize {
    let (width, height) = mosaic.size;
    (STRIP_VALUES / width.max(1)).clamp(1, height.clamp(1, 512))
}

fn count_lit(mosaic: &Mosaic, options: &IngestOptions) -> Result<LightCount, SceneError> {
    let (mut strip, mut part) = (Strip::default(), Strip::default());
    let (width, height) = mosaic.size;
    let step = rows_at_once(mosaic);
    let floor = options.floor_nw_cm2_sr.unwrap_or(0.0);
    let mut count = LightCount::default();
    // Of the row of blocks at each level, those that hold light.
    let mut lit_blocks: Vec<Vec<bool>> =
        (1..=LEVELS).map(|level| vec![false; (width >> level) + 1]).collect();
    for first_row in (0..height).step_by(step) {
        let rows = step.min(height - first_row);
        mosaic.read_rows(first_row, rows, (options.overlap, &[]), &mut strip, &mut part)?;
        for offset in 0..rows {
            let begins = |level: &usize| (first_row + offset).is_multiple_of(2 << level);
            (0..lit_blocks.len()).take_while(begins).for_each(|level| lit_blocks[level].fill(false));
            for column in 0..width {
                let (kind, value) =
                    (strip.kinds[offset * width + column], strip.radiance[offset * width + column]);
                if kind != PixelKind::Measured || value <= 0.0 || value < floor {
                    continue;
                }
                count.lit += 1;
                // Where a block holds light already, so do those that hold it.
                for (level, blocks) in lit_blocks.iter_mut().enumerate() {
                    if std::mem::replace(&mut blocks[column >> (level + 1)], true) {
                        break;
                    }
                    count.blocks += 1;
                }
            }
        }
    }
    Ok(count)
}

/// The values of each raster that are codes of missing data, though nobody says so.
fn codes_of_sources(mosaic: &Mosaic) -> Result<Vec<f64>, SceneError> {
    let mut codes = Vec::new();
    let mut strip = Strip::default();
    for source in mosaic.sources() {
        let (width, height) = source.dataset.raster_size();
        let step = (STRIP_VALUES / width.max(1)).clamp(1, height.clamp(1, 512));
        let mut lowest = Lowest::default();
        for first_row in (0..height).step_by(step) {
            source.read_rows(first_row, step.min(height - first_row), &mut strip)?;
            let measured =
                strip.kinds.iter().zip(&strip.radiance).filter(|(kind, _)| **kind == PixelKind::Measured);
            measured.for_each(|(_, value)| lowest.add(*value));
        }
        codes.extend(lowest.code().filter(|code| !codes.contains(code)));
    }
    Ok(codes)
}

/// Reads every pixel once.
///
/// * `reading`: which of several measurements counts, and values that are no data, beside those that are known.
fn scan(
    mosaic: &Mosaic,
    grid: &Grid,
    options: &IngestOptions,
    reading: (OverlapRule, &[f64]),
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
        mosaic.read_rows(first_row, rows, reading, &mut strip, &mut part)?;
        for offset in 0..rows {
            let row = (first_row + offset) as u32;
            let line = offset * width..(offset + 1) * width;
            let Scan { mask, pixels, negatives, statistics } = &mut scan;
            let (kinds, values) = (&strip.kinds[line.clone()], &strip.radiance[line]);
            mask.push_row(kinds.iter().zip(values).enumerate().map(|(column, (&kind, &value))| {
                let place = (column as u32, row);
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
    (scan.statistics.all_whole, scan.statistics.shared) = (strip.is_whole, strip.shared);
    scan.mask = scan.mask.finish();
    Ok(scan)
}
