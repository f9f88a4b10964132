//! An open radiance band: its scale, what of it is no data, its place on Earth, and the layers that say how good it is.

use super::gdal_open::gdal_reason;
use super::no_data::{Kind, NoData};
use super::options::IngestOptions;
use super::units::RadianceUnit;
use crate::error::SceneError;
use crate::metadata::Recognition;
use gdal::Dataset;
use gdal::raster::{GdalType, RasterBand};
use gdal::spatial_ref::SpatialRef;
use std::path::{Path, PathBuf};

/// How stored numbers become radiances: stored · scale + offset, nW cm⁻² sr⁻¹.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Conversion {
    pub(super) scale: f64,
    pub(super) offset: f64,
}

/// What a layer beside the radiances says of a pixel.
#[derive(Clone, Debug)]
pub(super) enum LayerTest {
    /// Pixels of other values are no data.
    OneOf(Vec<i64>),
    /// Pixels below it are no data.
    AtLeast(f64),
    /// Pixels at 0 or without data are dark.
    Lit,
}

/// A layer beside the radiances, on their grid.
pub(super) struct Layer {
    pub(super) dataset: Dataset,
    pub(super) test: LayerTest,
}

/// What a pixel is.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum PixelKind {
    /// No file has it.
    #[default]
    Outside,
    /// Declared no data, or masked.
    NoData,
    /// A value that fills gaps though nobody declares it.
    Fill,
    /// Refused by a quality or observation layer.
    Rejected,
    /// NaN that nobody declares.
    Nan,
    /// Infinite.
    Infinite,
    /// A measurement.
    Measured,
}

/// A radiance band, open, with its metadata.
pub(super) struct RadianceSource {
    pub(super) dataset: Dataset,
    pub(super) path: PathBuf,
    pub(super) band_number: usize,
    pub(super) band_name: String,
    /// A band that is 0 where there is no data.
    pub(super) alpha_band: Option<usize>,
    pub(super) conversion: Conversion,
    pub(super) no_data: NoData,
    pub(super) layers: Vec<Layer>,
    pub(super) geotransform: [f64; 6],
    pub(super) crs: SpatialRef,
    /// Whether the stored numbers are scaled, by the file or by the options.
    pub(super) is_scaled: bool,
    /// The unit, where the options or the file say it.
    pub(super) unit: Option<RadianceUnit>,
    pub(super) recognised: Vec<Recognition>,
    pub(super) warnings: Vec<String>,
}

/// What a band says of itself.
pub(super) struct BandFacts {
    pub(super) number: usize,
    pub(super) name: String,
    pub(super) conversion: Conversion,
    pub(super) no_data: NoData,
    /// The unit in the file's words; empty where it has none.
    pub(super) unit: String,
}

impl RadianceSource {
    /// The options' scale and unit take precedence over the file's.
    pub(super) fn new(
        dataset: Dataset,
        path: &Path,
        options: &IngestOptions,
        band: BandFacts,
        geotransform: [f64; 6],
        mut crs: SpatialRef,
    ) -> Result<Self, SceneError> {
        let refuse = |reason: String| SceneError::Refused { path: path.to_owned(), reason };
        let (mut recognised, mut warnings) = (Vec::new(), Vec::new());
        let mut conversion = band.conversion;
        if let Some(own) = options.scale {
            conversion = Conversion { scale: own, offset: 0.0 };
        } else if conversion.scale != 1.0 || conversion.offset != 0.0 {
            recognised.push(Recognition::certain(
                "scale",
                format!("{} and offset {} by the file", conversion.scale, conversion.offset),
            ));
        }
        let is_scaled = options.scale.is_some() || conversion.scale != 1.0;
        let of_file = RadianceUnit::from_metadata(&band.unit);
        if let (Some(own), Some(file)) = (options.units, of_file)
            && own != file
        {
            warnings.push(format!(
                "the file says that its unit is \"{}\"; {} was given and is used",
                band.unit,
                own.name()
            ));
        }
        if options.units.is_none() && of_file.is_none() && !band.unit.is_empty() {
            if is_count(&band.unit) && options.scale.is_none() {
                return Err(refuse(format!(
                    "its unit is \"{}\", which is no radiance: give --scale, or --units if they are radiances",
                    band.unit
                )));
            }
            warnings.push(format!(
                "its unit \"{}\" is not known: its numbers are taken for nW cm-2 sr-1 (else give --units)",
                band.unit
            ));
        }
        let unit = options.units.or(of_file);
        match (options.units, of_file) {
            (Some(_), _) => {}
            (None, Some(unit)) => {
                recognised.push(Recognition::certain(
                    "unit",
                    format!("{} by the file: {}", unit.name(), band.unit),
                ));
            }
            (None, None) => {
                recognised.push(Recognition::assumed("unit", "nw-cm2-sr: the file says nothing".to_owned()))
            }
        }
        let factor = unit.map_or(1.0, RadianceUnit::nw_cm2_sr);
        let conversion = Conversion { scale: conversion.scale * factor, offset: conversion.offset * factor };
        if !(conversion.scale.is_finite() && conversion.offset.is_finite() && conversion.scale > 0.0) {
            return Err(refuse(format!(
                "its scale {} and offset {} make no radiances; give --scale",
                conversion.scale, conversion.offset
            )));
        }
        crs.set_axis_mapping_strategy(gdal::spatial_ref::AxisMappingStrategy::TraditionalGisOrder);
        Ok(Self {
            dataset,
            path: path.to_owned(),
            band_number: band.number,
            band_name: band.name,
            alpha_band: None,
            conversion,
            no_data: band.no_data,
            layers: Vec::new(),
            geotransform,
            crs,
            is_scaled,
            unit,
            recognised,
            warnings,
        })
    }

    /// Reads rows: radiances, nW cm⁻² sr⁻¹, and what each pixel is.
    ///
    /// # Errors
    /// [`SceneError::Unreadable`] for a file that ends too early or does not unpack.
    pub(super) fn read_rows(
        &self,
        first_row: usize,
        rows: usize,
        strip: &mut Strip,
    ) -> Result<(), SceneError> {
        let refuse = |error| SceneError::Refused { path: self.path.clone(), reason: gdal_reason(error) };
        let band = self.dataset.rasterband(self.band_number).map_err(refuse)?;
        let count = band.x_size() * rows;
        strip.prepare(count);
        read(&band, first_row, rows, &mut strip.radiance, &self.path)?;
        let flags = band.mask_flags().map_err(refuse)?;
        // GDAL itself takes no float band for a mask, so transparency is read as the band that it is.
        let mask = match self.alpha_band {
            Some(number) => Some(self.dataset.rasterband(number)),
            None => (flags.is_per_dataset() && !flags.is_nodata()).then(|| band.open_mask_band()),
        };
        match mask.transpose().map_err(refuse)? {
            Some(mask) => read(&mask, first_row, rows, &mut strip.mask, &self.path)?,
            None => strip.mask.fill(u8::MAX),
        }
        for index in 0..count {
            let stored = strip.radiance[index];
            let radiance = (stored * self.conversion.scale + self.conversion.offset) as f32;
            let kind = match self.no_data.kind(stored, f64::from(radiance)) {
                Kind::NoData => PixelKind::NoData,
                _ if strip.mask[index] == 0 => PixelKind::NoData,
                Kind::Fill => PixelKind::Fill,
                Kind::Number if radiance.is_nan() => PixelKind::Nan,
                Kind::Number if radiance.is_infinite() => PixelKind::Infinite,
                Kind::Number => PixelKind::Measured,
            };
            strip.is_whole &= kind != PixelKind::Measured || stored.fract() == 0.0;
            strip.kinds[index] = kind;
            strip.radiance[index] = if kind == PixelKind::Fill { stored } else { f64::from(radiance) };
        }
        for layer in &self.layers {
            layer.apply(first_row, rows, strip, &self.path)?;
        }
        Ok(())
    }
}

impl Layer {
    fn apply(&self, first_row: usize, rows: usize, strip: &mut Strip, path: &Path) -> Result<(), SceneError> {
        let refuse = |error| SceneError::Refused { path: path.to_owned(), reason: gdal_reason(error) };
        let band = self.dataset.rasterband(1).map_err(refuse)?;
        let no_data = band.no_data_value();
        strip.layer.resize(strip.kinds.len(), 0.0);
        read(&band, first_row, rows, &mut strip.layer, path)?;
        for ((kind, radiance), &value) in strip.kinds.iter_mut().zip(&mut strip.radiance).zip(&strip.layer) {
            let is_there = value.is_finite() && Some(value) != no_data;
            match &self.test {
                LayerTest::Lit => {
                    if *kind == PixelKind::Measured && !(is_there && value != 0.0) {
                        *radiance = radiance.min(0.0);
                    }
                }
                LayerTest::OneOf(good) => {
                    if *kind == PixelKind::Measured && !(is_there && good.contains(&(value as i64))) {
                        *kind = PixelKind::Rejected;
                    }
                }
                LayerTest::AtLeast(least) => {
                    if *kind == PixelKind::Measured && !(is_there && value >= *least) {
                        *kind = PixelKind::Rejected;
                    }
                }
            }
        }
        Ok(())
    }
}

/// Some rows of a source.
#[derive(Default)]
pub(super) struct Strip {
    /// nW cm⁻² sr⁻¹; as stored where it is a fill.
    pub(super) radiance: Vec<f64>,
    pub(super) kinds: Vec<PixelKind>,
    /// Whether all measurements so far were whole numbers as stored.
    pub(super) is_whole: bool,
    /// Pixels that more than one raster has measured.
    pub(super) shared: u64,
    pub(super) mask: Vec<u8>,
    pub(super) layer: Vec<f64>,
}

impl Strip {
    fn prepare(&mut self, count: usize) {
        self.radiance.resize(count, 0.0);
        self.mask.resize(count, 0);
        self.kinds.resize(count, PixelKind::Outside);
    }

    /// Measurements of some values, nW cm⁻² sr⁻¹, are none.
    pub(super) fn drop_codes(&mut self, codes: &[f64]) {
        if codes.is_empty() {
            return;
        }
        for (kind, radiance) in self.kinds.iter_mut().zip(&self.radiance) {
            if *kind == PixelKind::Measured && codes.contains(radiance) {
                *kind = PixelKind::Fill;
            }
        }
    }
}

/// A band's unit in the file's words: the band's own, else an attribute's.
pub(super) fn unit_of(band: &RasterBand<'_>, attributes: &[String]) -> String {
    let own = band.unit();
    if !own.is_empty() {
        return own;
    }
    let is_unit =
        |key: &str| key == "units" || key == "unit" || key.ends_with("_units") || key.ends_with("#units");
    attributes
        .iter()
        .filter_map(|item| item.split_once('='))
        .find(|(key, _)| is_unit(&key.to_lowercase()))
        .map(|(_, value)| value.trim().to_owned())
        .unwrap_or_default()
}

/// Whether a unit says counts.
fn is_count(unit: &str) -> bool {
    let unit = unit.trim().to_lowercase();
    ["dn", "counts", "count", "digital number", "digital numbers"].contains(&unit.as_str())
}

fn read<T: Copy + GdalType>(
    band: &RasterBand<'_>,
    first_row: usize,
    rows: usize,
    values: &mut [T],
    path: &Path,
) -> Result<(), SceneError> {
    let width = band.x_size();
    band.read_into_slice((0, first_row as isize), (width, rows), (width, rows), values, None).map_err(
        |error| {
            let reason = format!("it is truncated or broken near row {first_row} ({})", gdal_reason(error));
            SceneError::Unreadable { path: path.to_owned(), reason }
        },
    )
}
