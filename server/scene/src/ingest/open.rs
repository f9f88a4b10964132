//! Opening rasters with GDAL: the formats allowed, the band meant, its scale, its place on Earth.

use super::black_marble;
use super::options::IngestOptions;
use crate::error::SceneError;
use gdal::raster::{ColorInterpretation, GdalDataType, RasterBand};
use gdal::spatial_ref::SpatialRef;
use gdal::{Dataset, DatasetOptions, GdalOpenFlags};
use std::path::{Path, PathBuf};
use std::sync::Once;

/// A radiance band, open, with what is known of it.
pub(super) struct RadianceSource {
    pub(super) dataset: Dataset,
    pub(super) path: PathBuf,
    pub(super) band_number: usize,
    pub(super) band_name: String,
    /// A band that is 0 where there is no data.
    pub(super) alpha_band: Option<usize>,
    /// radiance = stored · scale + offset, nW cm⁻² sr⁻¹.
    pub(super) scale: f64,
    pub(super) offset: f64,
    pub(super) no_data: Option<f64>,
    pub(super) geotransform: [f64; 6],
    pub(super) crs: SpatialRef,
    pub(super) crs_wkt: String,
    pub(super) crs_name: String,
    pub(super) warnings: Vec<String>,
}

/// Keeps GDAL from writing to stderr: its messages come back as errors.
fn silence_gdal() {
    static ONCE: Once = Once::new();
    ONCE.call_once(|| gdal::config::set_error_handler(|_, _, _| {}));
}

/// What GDAL said, without its wrapping, on one line.
pub(super) fn gdal_reason(error: gdal::errors::GdalError) -> String {
    use gdal::errors::GdalError::{CplError, NullPointer};
    let text = match error {
        CplError { msg, .. } | NullPointer { msg, .. } if !msg.is_empty() => msg,
        other => other.to_string(),
    };
    text.split_whitespace().collect::<Vec<_>>().join(" ")
}

/// Opens `path` with one of `drivers`. Only plain files: no network or archive file systems, no connection
/// strings, no formats that refer to other files.
pub(super) fn open_file(path: &Path, drivers: &[&str]) -> Result<Dataset, SceneError> {
    let metadata = std::fs::metadata(path).map_err(SceneError::io(path))?;
    let unreadable = |reason: String| SceneError::Unreadable { path: path.to_owned(), reason };
    if !metadata.is_file() {
        return Err(unreadable("it is not a file".to_owned()));
    }
    if path.starts_with("/vsi") || path.to_string_lossy().starts_with("/vsi") {
        return Err(unreadable("virtual file systems are not allowed".to_owned()));
    }
    black_marble::check_is_whole(path)?;
    open_name(&path.to_string_lossy(), drivers).map_err(|reason| {
        let is_other = reason.contains("not recognized as");
        unreadable(if is_other { format!("it is none of {}", drivers.join(", ")) } else { reason })
    })
}

/// Opens a name that is known to be a plain file or a subdataset of one.
pub(super) fn open_name(name: &str, drivers: &[&str]) -> Result<Dataset, String> {
    silence_gdal();
    let options = DatasetOptions {
        open_flags: GdalOpenFlags::GDAL_OF_READONLY
            | GdalOpenFlags::GDAL_OF_RASTER
            | GdalOpenFlags::GDAL_OF_VERBOSE_ERROR,
        allowed_drivers: Some(drivers),
        ..DatasetOptions::default()
    };
    Dataset::open_ex(name, options).map_err(gdal_reason)
}

/// Opens the radiance band that the options mean.
pub(super) fn radiance(options: &IngestOptions) -> Result<RadianceSource, SceneError> {
    let path = &options.radiance;
    let refuse = |reason: String| SceneError::Refused { path: path.clone(), reason };
    let container = open_file(path, &["GTiff", "COG", "HDF5", "HDF5Image"])?;
    if container.driver().short_name().starts_with("HDF5") {
        return black_marble::open(container, options);
    }
    let band_number = choose_band(&container, options.band.as_deref()).map_err(refuse)?;
    let (scale, offset, no_data, name) = {
        let band = container.rasterband(band_number).map_err(|e| refuse(gdal_reason(e)))?;
        check_is_measurement(&container, &band, options).map_err(refuse)?;
        let description = gdal::Metadata::description(&band).unwrap_or_default();
        let name = if description.is_empty() { format!("band {band_number}") } else { description };
        (band.scale().unwrap_or(1.0), band.offset().unwrap_or(0.0), band.no_data_value(), name)
    };
    let crs = container.spatial_ref().ok().filter(|crs| crs.is_geographic() || crs.is_projected());
    let crs = crs.ok_or_else(|| {
        refuse("the raster has no coordinate reference system, so its place on Earth is unknown; set one, for example with gdal_edit.py -a_srs EPSG:4326".to_owned())
    })?;
    let geotransform = container.geo_transform().map_err(|_| {
        refuse(
            "the raster is not georeferenced: it has a coordinate reference system but no geotransform"
                .to_owned(),
        )
    })?;
    let alpha_band = (1..=container.raster_count()).find(|&n| is_alpha(&container, n));
    let source = finish(container, options, band_number, name, (scale, offset, no_data), geotransform, crs)?;
    Ok(RadianceSource { alpha_band, ..source })
}

/// Puts a source together; the options' scale and unit win.
pub(super) fn finish(
    dataset: Dataset,
    options: &IngestOptions,
    band_number: usize,
    band_name: String,
    (mut scale, mut offset, no_data): (f64, f64, Option<f64>),
    geotransform: [f64; 6],
    mut crs: SpatialRef,
) -> Result<RadianceSource, SceneError> {
    let path = options.radiance.clone();
    let refuse = |reason: String| SceneError::Refused { path: path.clone(), reason };
    if let Some(own) = options.scale {
        (scale, offset) = (own, 0.0);
    }
    let unit = options.units.map_or(1.0, super::RadianceUnit::nw_cm2_sr);
    (scale, offset) = (scale * unit, offset * unit);
    if !(scale.is_finite() && offset.is_finite() && scale > 0.0) {
        return Err(refuse(format!("its scale {scale} and offset {offset} make no radiances; give --scale")));
    }
    crs.set_axis_mapping_strategy(gdal::spatial_ref::AxisMappingStrategy::TraditionalGisOrder);
    let crs_wkt = crs.to_wkt().map_err(|e| refuse(gdal_reason(e)))?;
    let crs_name = crs.name().unwrap_or_else(|| "unnamed".to_owned());
    Ok(RadianceSource {
        dataset,
        path,
        band_number,
        band_name,
        alpha_band: None,
        scale,
        offset,
        no_data,
        geotransform,
        crs,
        crs_wkt,
        crs_name,
        warnings: Vec::new(),
    })
}

fn choose_band(dataset: &Dataset, wanted: Option<&str>) -> Result<usize, String> {
    let count = dataset.raster_count();
    let name = |number: usize| {
        dataset.rasterband(number).ok().and_then(|b| gdal::Metadata::description(&b).ok()).unwrap_or_default()
    };
    let entry = |number: usize| {
        let name = name(number);
        if name.is_empty() { number.to_string() } else { format!("{number} \"{name}\"") }
    };
    let listed = || (1..=count).map(entry).collect::<Vec<_>>().join(", ");
    match wanted {
        Some(text) => (1..=count)
            .find(|&n| name(n) == text || text.parse() == Ok(n))
            .ok_or_else(|| format!("there is no band \"{text}\"; the raster has {}", listed())),
        None if count == 1 => Ok(1),
        // Transparency beside the one band of measurements is a mask, and read as that.
        None if count == 2 && is_alpha(dataset, 2) => Ok(1),
        None if count == 0 => Err("the raster has no bands".to_owned()),
        None => {
            let colours = is_colour_picture(dataset);
            if colours {
                Err("the raster is a colour picture, not a measurement of radiance".to_owned())
            } else {
                Err(format!("the raster has {count} bands; choose one with --band: {}", listed()))
            }
        }
    }
}

fn is_alpha(dataset: &Dataset, number: usize) -> bool {
    dataset.rasterband(number).is_ok_and(|b| b.color_interpretation() == ColorInterpretation::AlphaBand)
}

fn is_colour_picture(dataset: &Dataset) -> bool {
    dataset.rasterbands().flatten().any(|band| {
        matches!(
            band.color_interpretation(),
            ColorInterpretation::RedBand | ColorInterpretation::GreenBand | ColorInterpretation::BlueBand
        ) && matches!(band.band_type(), GdalDataType::UInt8 | GdalDataType::UInt16)
    })
}

fn check_is_measurement(
    dataset: &Dataset,
    band: &RasterBand<'_>,
    options: &IngestOptions,
) -> Result<(), String> {
    if is_colour_picture(dataset) {
        return Err("the raster is a colour picture, not a measurement of radiance".to_owned());
    }
    if band.color_interpretation() == ColorInterpretation::PaletteIndex {
        return Err("the raster holds colours of a palette, not radiances".to_owned());
    }
    let is_scaled = options.scale.is_some() || band.scale().is_some_and(|scale| scale != 1.0);
    match band.band_type() {
        GdalDataType::UInt8 if !is_scaled => Err(
            "the raster holds 8-bit numbers, as a picture does, not radiances; if they are scaled radiances, give their --scale"
                .to_owned(),
        ),
        GdalDataType::Unknown => Err("the raster holds numbers of an unknown or complex type".to_owned()),
        _ => Ok(()),
    }
}
