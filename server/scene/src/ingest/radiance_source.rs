//! An open radiance band: its scale, its no-data value, its place on Earth.

use super::gdal_open::gdal_reason;
use super::options::{IngestOptions, RadianceUnit};
use crate::error::SceneError;
use gdal::Dataset;
use gdal::spatial_ref::SpatialRef;
use std::path::PathBuf;

/// How stored numbers become radiances: stored · scale + offset, nW cm⁻² sr⁻¹.
#[derive(Clone, Copy)]
pub(super) struct Conversion {
    pub(super) scale: f64,
    pub(super) offset: f64,
    pub(super) no_data: Option<f64>,
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
    pub(super) geotransform: [f64; 6],
    pub(super) crs: SpatialRef,
    pub(super) crs_wkt: String,
    pub(super) crs_name: String,
}

impl RadianceSource {
    /// The options' scale and unit take precedence over the file's.
    pub(super) fn new(
        dataset: Dataset,
        options: &IngestOptions,
        (band_number, band_name): (usize, String),
        mut conversion: Conversion,
        geotransform: [f64; 6],
        mut crs: SpatialRef,
    ) -> Result<Self, SceneError> {
        let path = options.radiance.clone();
        let refuse = |reason: String| SceneError::Refused { path: path.clone(), reason };
        if let Some(own) = options.scale {
            (conversion.scale, conversion.offset) = (own, 0.0);
        }
        let unit = options.units.map_or(1.0, RadianceUnit::nw_cm2_sr);
        let (scale, offset) = (conversion.scale * unit, conversion.offset * unit);
        (conversion.scale, conversion.offset) = (scale, offset);
        if !(scale.is_finite() && offset.is_finite() && scale > 0.0) {
            return Err(refuse(format!(
                "its scale {scale} and offset {offset} make no radiances; give --scale"
            )));
        }
        crs.set_axis_mapping_strategy(gdal::spatial_ref::AxisMappingStrategy::TraditionalGisOrder);
        let crs_wkt = crs.to_wkt().map_err(|e| refuse(gdal_reason(e)))?;
        let crs_name = crs.name().unwrap_or_else(|| "unnamed".to_owned());
        Ok(Self {
            dataset,
            path,
            band_number,
            band_name,
            alpha_band: None,
            conversion,
            geotransform,
            crs,
            crs_wkt,
            crs_name,
        })
    }
}
