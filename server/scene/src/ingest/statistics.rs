//! Counts of pixels by kind while a raster is read, what must be refused by them, and what looks wrong.

use super::mosaic::Mosaic;
use super::options::IngestOptions;
use super::overlap_rule::OverlapRule;
use super::radiance_source::PixelKind;
use super::tally::Tally;
use super::units::RadianceUnit;
use crate::grid::Grid;
use crate::lit_pixels::LitPixels;
use crate::metadata::{IngestReport, NoiseReport, Recognition};

/// The largest value on at least this many pixels looks like a cap.
const MIN_CAPPED_PIXELS: u64 = 10;
/// A largest value that is a multiple of this, nW cm⁻² sr⁻¹, looks like a cap even on one pixel.
const ROUND_CAP: f64 = 1_000.0;
/// No light on Earth is near this, nW cm⁻² sr⁻¹: flares of gas reach 1e5.
const MAX_RADIANCE_NW_CM2_SR: f64 = 1e7;
/// More than one lit pixel in this many off the world means a wrong CRS.
const OFF_WORLD_SHARE: u64 = 100;
/// The lit pixels of no real raster have a mean below this, nW cm⁻² sr⁻¹: the instrument's noise is 0.1.
const MIN_LIT_MEAN_NW_CM2_SR: f64 = 1e-3;
/// And of few below this.
const LOW_LIT_MEAN_NW_CM2_SR: f64 = 0.05;
/// No region of [`MIN_REGION_M2`] lit ground has a mean above this, nW cm⁻² sr⁻¹: the brightest cities have 60 to 80.
const MAX_REGION_MEAN_NW_CM2_SR: f64 = 200.0;
/// Lit ground that tells a unit, m².
const MIN_REGION_M2: f64 = 2e9;
/// One value in so many may be negative where values are counts or elevations.
const NEGATIVE_SHARE: u64 = 20;
/// One negative value on so many pixels, and this part of all, is a code and no measurement.
const MIN_REPEATED: u64 = 100;
const MIN_REPEATED_SHARE: f64 = 0.005;
/// Fill values that are named in the report.
const MAX_FILLS_NAMED: usize = 3;

/// What became of a pixel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Found {
    /// Its radiance where it is lit, nW cm⁻² sr⁻¹.
    pub(super) lit: Option<f32>,
    /// Whether it is a measurement below zero.
    pub(super) is_negative: bool,
    /// Whether it is a measurement.
    pub(super) is_measured: bool,
}

/// Counts while the raster is read.
#[derive(Default)]
pub(super) struct PixelStatistics {
    floor: f64,
    cap: f64,
    lit: Tally,
    zero: Tally,
    negative: Tally,
    nan: Tally,
    infinite: Tally,
    no_data: Tally,
    fill: Tally,
    rejected: Tally,
    at_maximum: Tally,
    at_minimum: u64,
    outside_world: Tally,
    below_floor: u64,
    above_cap: u64,
    minimum: f64,
    maximum: f64,
    sum: f64,
    fills: Vec<f64>,
    /// Whether all measurements are whole numbers as stored.
    pub(super) all_whole: bool,
    /// Pixels that more than one raster has measured, and what counts then.
    pub(super) shared: u64,
    /// Whether the rasters whose largest measurement counts hold noise.
    pub(super) noise_in_maximum: bool,
    overlap: OverlapRule,
}

/// The lowest of some measurements, and how many are exactly as low.
pub(super) struct Lowest {
    minimum: f64,
    maximum: f64,
    at_minimum: u64,
    measured: u64,
}

impl Default for Lowest {
    fn default() -> Self {
        Self { minimum: f64::INFINITY, maximum: f64::NEG_INFINITY, at_minimum: 0, measured: 0 }
    }
}

impl Lowest {
    /// Counts one.
    pub(super) fn add(&mut self, value: f64) {
        self.measured += 1;
        self.maximum = self.maximum.max(value);
        if value < self.minimum {
            (self.minimum, self.at_minimum) = (value, 0);
        }
        self.at_minimum += u64::from(value == self.minimum);
    }

    /// The lowest where it is negative and on so many pixels that it is a code and no measurement.
    pub(super) fn code(&self) -> Option<f64> {
        let is_code = self.minimum < 0.0
            && self.minimum < self.maximum
            && self.at_minimum >= MIN_REPEATED
            && self.at_minimum as f64 >= MIN_REPEATED_SHARE * self.measured as f64;
        is_code.then_some(self.minimum)
    }
}

impl PixelStatistics {
    pub(super) fn new(options: &IngestOptions) -> Self {
        Self {
            floor: options.floor_nw_cm2_sr.unwrap_or(0.0),
            cap: options.cap_nw_cm2_sr.unwrap_or(f64::INFINITY),
            minimum: f64::INFINITY,
            maximum: f64::NEG_INFINITY,
            all_whole: true,
            overlap: options.overlap,
            ..Self::default()
        }
    }

    /// Counts one pixel.
    pub(super) fn classify(
        &mut self,
        grid: &Grid,
        (column, row): (u32, u32),
        kind: PixelKind,
        value: f64,
    ) -> Found {
        let tally = match kind {
            PixelKind::Measured => return self.classify_measured(grid, (column, row), value),
            PixelKind::Outside | PixelKind::NoData => &mut self.no_data,
            PixelKind::Fill => {
                self.found_fill(value);
                &mut self.fill
            }
            PixelKind::Rejected => &mut self.rejected,
            PixelKind::Nan => &mut self.nan,
            PixelKind::Infinite => &mut self.infinite,
        };
        tally.add(column, row);
        Found { lit: None, is_negative: false, is_measured: false }
    }

    fn classify_measured(&mut self, grid: &Grid, (column, row): (u32, u32), value: f64) -> Found {
        if value < self.minimum {
            (self.minimum, self.at_minimum) = (value, 0);
        }
        self.at_minimum += u64::from(value == self.minimum);
        if value > self.maximum {
            (self.maximum, self.at_maximum) = (value, Tally::default());
        }
        if value == self.maximum {
            self.at_maximum.add(column, row);
        }
        let mut found = Found { lit: None, is_negative: value < 0.0, is_measured: true };
        if value < 0.0 {
            self.negative.add(column, row);
        } else if value == 0.0 || value < self.floor {
            self.below_floor += u64::from(value > 0.0);
            self.zero.add(column, row);
        } else if grid.center(column, row).is_finite() {
            self.lit.add(column, row);
            self.above_cap += u64::from(value > self.cap);
            let value = value.min(self.cap);
            self.sum += value;
            found.lit = Some(value as f32);
        } else {
            self.outside_world.add(column, row);
            found.is_measured = false;
        }
        found
    }

    /// Notes a value that fills gaps.
    pub(super) fn found_fill(&mut self, value: f64) {
        if self.fills.len() < MAX_FILLS_NAMED && !self.fills.contains(&value) {
            self.fills.push(value);
        }
    }

    /// Pixels with a measurement.
    pub(super) fn measured(&self) -> u64 {
        self.lit.count + self.zero.count + self.negative.count
    }

    /// Σ of the lit pixels, nW cm⁻² sr⁻¹.
    pub(super) fn lit_sum(&self) -> f64 {
        self.sum
    }

    /// The smallest value where it is negative and on so many pixels that it is a code and no measurement.
    pub(super) fn repeated_minimum(&self) -> Option<f64> {
        let lowest = Lowest {
            minimum: self.minimum,
            maximum: self.maximum,
            at_minimum: self.at_minimum,
            measured: self.measured(),
        };
        lowest.code().filter(|_| self.lit.count > 0)
    }

    /// Refuses rasters that cannot be meant.
    pub(super) fn check(&self, mosaic: &Mosaic, grid: &Grid, options: &IngestOptions) -> Result<(), String> {
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
        self.check_counts(mosaic)?;
        self.check_unit(mosaic, grid, options)
    }

    /// The mean of the lit is what tells a unit: a bright town changes it little.
    fn check_unit(&self, mosaic: &Mosaic, grid: &Grid, options: &IngestOptions) -> Result<(), String> {
        let mean = self.sum / self.lit.count as f64;
        let is_told = options.units == Some(RadianceUnit::NanowattPerSquareCentimetreSteradian);
        let lit_m2 = self.lit.count as f64 * grid.pixel_size_m().powi(2);
        if mean > MAX_REGION_MEAN_NW_CM2_SR && lit_m2 > MIN_REGION_M2 && !is_told {
            return Err(format!(
                "the mean of its lit pixels is {mean:.0} nW cm-2 sr-1 over {:.0} km2, and no region on Earth is so bright: it may be \
                 terrain (--terrain), or its unit or scale is another one (--units, --scale); if it is right, say --units {}",
                lit_m2 / 1e6,
                RadianceUnit::NanowattPerSquareCentimetreSteradian.name()
            ));
        }
        if mean >= MIN_LIT_MEAN_NW_CM2_SR || is_told {
            return Ok(());
        }
        let advice = match unit_advice(mosaic, mean) {
            Some(units) => format!(": {units}; give its --units, or a --scale"),
            None => "; give its --units or --scale".to_owned(),
        };
        Err(format!(
            "the mean of its lit pixels is {mean:.2e} nW cm-2 sr-1, darker than any satellite sees, so its unit is another one{advice}"
        ))
    }

    /// Radiances are no whole numbers: where all are, and above 255, they are counts whose scale is lost.
    fn check_counts(&self, mosaic: &Mosaic) -> Result<(), String> {
        if self.are_whole_and_plain(mosaic) && self.lit.count > 100 && self.maximum > 255.0 {
            return Err(format!(
                "all its {} values are whole numbers up to {}, so they seem to be counts, or elevations (--terrain): NASA Black Marble stores tenths (--scale 0.1); if they are nW \
                 cm-2 sr-1 as they are, say --scale 1",
                self.measured(),
                self.maximum
            ));
        }
        Ok(())
    }

    /// Whether values are whole numbers without a scale, and hardly any is negative.
    fn are_whole_and_plain(&self, mosaic: &Mosaic) -> bool {
        let is_plain = mosaic.sources().all(|source| !source.is_scaled);
        self.all_whole && is_plain && self.negative.count * NEGATIVE_SHARE <= self.measured()
    }

    /// What is said of the rasters.
    pub(super) fn report(
        &self,
        mosaic: &Mosaic,
        grid: &Grid,
        noise: Option<NoiseReport>,
        pixels: &LitPixels,
    ) -> IngestReport {
        let is_capped = self.maximum > self.minimum
            && self.maximum > 0.0
            && (self.at_maximum.count >= MIN_CAPPED_PIXELS || self.maximum % ROUND_CAP == 0.0);
        let capped = if is_capped { self.at_maximum.finish(grid) } else { Default::default() };
        let first = mosaic.first();
        let name = |path: &std::path::Path| path.file_name().map(|n| n.to_string_lossy().into_owned());
        let files: Vec<String> = mosaic.sources().filter_map(|source| name(&source.path)).collect();
        let mut recognised: Vec<Recognition> = Vec::new();
        for entry in mosaic.sources().flat_map(|source| &source.recognised) {
            if !recognised.contains(entry) {
                recognised.push(entry.clone());
            }
        }
        let lit_sum: f64 = pixels.radiance_nw_cm2_sr.iter().map(|value| f64::from(*value)).sum();
        IngestReport {
            pixels: u64::from(grid.width) * u64::from(grid.height),
            lit: self.lit.finish(grid),
            zero: self.zero.finish(grid),
            negative: self.negative.finish(grid),
            nan: self.nan.finish(grid),
            infinite: self.infinite.finish(grid),
            no_data: self.no_data.finish(grid),
            fill: self.fill.finish(grid),
            rejected: self.rejected.finish(grid),
            outside_world: self.outside_world.finish(grid),
            minimum_nw_cm2_sr: self.minimum,
            maximum_nw_cm2_sr: self.maximum,
            lit_mean_nw_cm2_sr: lit_sum / pixels.len().max(1) as f64,
            flux_dnb_w: 0.0,
            band: first.band_name.clone(),
            scale: first.conversion.scale,
            offset_nw_cm2_sr: first.conversion.offset,
            terrain: None,
            files: if files.len() > 1 { files } else { Vec::new() },
            recognised,
            noise,
            warnings: self.warnings(mosaic, capped.count, noise),
            capped,
        }
    }

    /// One sentence for each thing that looks wrong.
    fn warnings(&self, mosaic: &Mosaic, capped: u64, noise: Option<NoiseReport>) -> Vec<String> {
        let mut warnings: Vec<String> = Vec::new();
        for warning in mosaic.sources().flat_map(|source| &source.warnings) {
            if !warnings.contains(warning) {
                warnings.push(warning.clone());
            }
        }
        if self.shared > 0 {
            let what = match self.overlap {
                OverlapRule::First => "first counts, as they were given (--overlap mean, max or newest)",
                OverlapRule::Mean => "mean counts (--overlap)",
                OverlapRule::Max => "largest counts (--overlap)",
                OverlapRule::Newest => "newest counts (--overlap)",
            };
            warnings.push(format!("{} pixels are measured by more than one raster: the {what}", self.shared));
        }
        if self.noise_in_maximum {
            warnings.push(
                "the rasters hold noise around zero, of which the largest measurement takes the bright half for light: take --overlap mean, or \
                 masked products"
                    .to_owned(),
            );
        }
        let mean = self.sum / self.lit.count.max(1) as f64;
        if mean < LOW_LIT_MEAN_NW_CM2_SR {
            let other =
                unit_advice(mosaic, mean).map_or(String::new(), |units| format!(": {units} (--units)"));
            warnings.push(format!(
                "the mean of the lit pixels is {mean:.2e} nW cm-2 sr-1, darker than the noise of the satellites: the unit is suspicious{other}"
            ));
        } else if self.maximum > 1e5 {
            warnings.push(format!(
                "the largest value is {:e} nW cm-2 sr-1, brighter than any town: the unit or the scale is suspicious",
                self.maximum
            ));
        }
        if self.are_whole_and_plain(mosaic) && self.measured() > 100 {
            warnings.push(if self.maximum <= 255.0 {
                "all values are whole numbers from 0 to 255, as in a picture: they may not be radiances"
                    .to_owned()
            } else {
                "all values are whole numbers: they may be counts without their scale".to_owned()
            });
        }
        if capped > 0 {
            warnings.push(format!(
                "{} at exactly the largest value, {}: the raster seems to be capped there",
                if capped == 1 { "1 pixel is".to_owned() } else { format!("{capped} pixels are") },
                self.maximum
            ));
        }
        if self.fill.count > 0 {
            let values: Vec<String> = self.fills.iter().map(f64::to_string).collect();
            warnings.push(format!(
                "{} pixels hold {}, which no light has: they count as no data, though the file does not say so (--nodata)",
                self.fill.count,
                values.join(", ")
            ));
        }
        if self.infinite.count > 0 {
            warnings.push(format!(
                "{} pixels are infinite and count as no data: something overflowed where the raster was made",
                self.infinite.count
            ));
        }
        if self.below_floor > 0 {
            warnings.push(format!("{} pixels below the floor are taken for dark", self.below_floor));
        }
        if self.above_cap > 0 {
            warnings.push(format!("{} pixels above the cap count as the cap", self.above_cap));
        }
        if let Some(noise) = noise {
            let more = if noise.bias < 50.0 {
                format!("{:.1} times the light that there is", noise.bias)
            } else {
                "many times the light that there is".to_owned()
            };
            let done = if noise.balanced {
                format!(
                    "so each takes its part from the faintest pixels around it, of which {} became dark (--noise cut leaves them)",
                    noise.darkened
                )
            } else {
                "as --noise cut has it (--noise balance does not)".to_owned()
            };
            warnings.push(format!(
                "{} pixels are negative, noise around zero of {:.2} nW cm-2 sr-1: cutting them alone would leave {more}, {done}",
                self.negative.count, noise.deviation_nw_cm2_sr
            ));
        } else if self.negative.count > self.lit.count {
            warnings.push(format!(
                "{} pixels are negative and {} lit: the lights may be noise",
                self.negative.count, self.lit.count
            ));
        }
        if self.zero.count + self.negative.count == 0 && self.measured() > 10_000 {
            warnings.push(
                "no pixel is dark: the raster may hold a background or not be radiance at all".to_owned(),
            );
        }
        warnings
    }
}

/// Units that would make light of the Earth of rasters, whose mean of the lit is `mean` in nW cm⁻² sr⁻¹ by the unit that was taken.
fn unit_advice(mosaic: &Mosaic, mean: f64) -> Option<String> {
    let taken = mosaic.first().unit;
    RadianceUnit::advice(mean / taken.map_or(1.0, RadianceUnit::nw_cm2_sr), taken)
}
