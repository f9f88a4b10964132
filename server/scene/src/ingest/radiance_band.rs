//! The radiance band of a raster: which band is meant, and whether it can be a measurement.

use super::black_marble;
use super::gdal_open::{gdal_reason, open_file};
use super::options::IngestOptions;
use super::radiance_source::{Conversion, RadianceSource};
use crate::error::SceneError;
use gdal::Dataset;
use gdal::raster::{ColorInterpretation, GdalDataType, RasterBand};

/// Opens the radiance band that the options mean.
pub(super) fn open(options: &IngestOptions) -> Result<RadianceSource, SceneError> {
    let path = &options.radiance;
    let refuse = |reason: String| SceneError::Refused { path: path.clone(), reason };
    let container = open_file(path, &["GTiff", "COG", "HDF5", "HDF5Image"])?;
    if container.driver().short_name().starts_with("HDF5") {
        return black_marble::open(container, options);
    }
    let band_number = choose_band(&container, options.band.as_deref()).map_err(refuse)?;
    let (conversion, name) = {
        let band = container.rasterband(band_number).map_err(|e| refuse(gdal_reason(e)))?;
        check_is_measurement(&container, &band, options).map_err(refuse)?;
        let description = gdal::Metadata::description(&band).unwrap_or_default();
        let name = if description.is_empty() { format!("band {band_number}") } else { description };
        let (scale, offset) = (band.scale().unwrap_or(1.0), band.offset().unwrap_or(0.0));
        (Conversion { scale, offset, no_data: band.no_data_value() }, name)
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
    let source = RadianceSource::new(container, options, (band_number, name), conversion, geotransform, crs)?;
    Ok(RadianceSource { alpha_band, ..source })
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
