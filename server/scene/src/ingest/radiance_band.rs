//! The radiance band of a raster: which band is meant, and whether it can be a measurement.

use super::black_marble;
use super::gdal_open::{gdal_reason, open_file};
use super::layers;
use super::no_data::NoData;
use super::options::IngestOptions;
use super::radiance_source::{BandFacts, Conversion, RadianceSource, unit_of};
use crate::error::SceneError;
use gdal::raster::{ColorInterpretation, GdalDataType, RasterBand};
use gdal::{Dataset, Metadata};
use std::path::Path;

/// Opens the radiance band of a file that the options mean, with the layers beside it.
///
/// * `index`: of the file among the radiance rasters.
pub(super) fn open(options: &IngestOptions, path: &Path, index: usize) -> Result<RadianceSource, SceneError> {
    let refuse = |reason: String| SceneError::Refused { path: path.to_owned(), reason };
    let container = open_file(path, &["GTiff", "COG", "HDF5", "HDF5Image"])?;
    if container.driver().short_name().starts_with("HDF5") {
        let mut source = black_marble::open(container, path, options)?;
        layers::add_files(&mut source, options, index)?;
        return Ok(source);
    }
    let band_number = choose_band(&container, options.band.as_deref()).map_err(refuse)?;
    let facts = {
        let band = container.rasterband(band_number).map_err(|e| refuse(gdal_reason(e)))?;
        check_is_measurement(&container, &band, options).map_err(refuse)?;
        let description = gdal::Metadata::description(&band).unwrap_or_default();
        let mut attributes = container.metadata_domain("").unwrap_or_default();
        attributes.extend(band.metadata_domain("").unwrap_or_default());
        BandFacts {
            number: band_number,
            name: if description.is_empty() { format!("band {band_number}") } else { description },
            conversion: Conversion {
                scale: band.scale().unwrap_or(1.0),
                offset: band.offset().unwrap_or(0.0),
            },
            no_data: NoData::of(&band, &attributes, &options.no_data),
            unit: unit_of(&band, &attributes),
        }
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
    let mut source = RadianceSource::new(container, path, options, facts, geotransform, crs)?;
    source.alpha_band = alpha_band;
    layers::require(options, &source, false, false)?;
    layers::add_files(&mut source, options, index)?;
    Ok(source)
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
        kind if kind.is_integer() && !is_scaled => Err(format!(
            "the raster holds whole numbers ({}) without a scale: NASA Black Marble stores tenths (--scale 0.1 --nodata 65535); if they are \
             nW cm-2 sr-1 as they are, say --scale 1",
            kind.name()
        )),
        GdalDataType::Unknown => Err("the raster holds numbers of an unknown or complex type".to_owned()),
        _ => Ok(()),
    }
}
