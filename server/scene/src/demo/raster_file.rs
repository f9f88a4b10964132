//! Writing the demo's rasters as GeoTIFF.

use crate::error::SceneError;
use gdal::DriverManager;
use gdal::raster::{Buffer, RasterCreationOptions};
use gdal::spatial_ref::SpatialRef;
use std::path::Path;

/// A grid of square pixels in degrees.
pub(super) struct RasterSpec {
    pub(super) west_deg: f64,
    pub(super) north_deg: f64,
    pub(super) step_deg: f64,
    pub(super) width: usize,
    pub(super) height: usize,
}

impl RasterSpec {
    /// The grid over west, south, east, north.
    pub(super) fn over(bounds_deg: [f64; 4], per_degree: f64) -> Self {
        let [west, south, east, north] = bounds_deg;
        Self {
            west_deg: west,
            north_deg: north,
            step_deg: 1.0 / per_degree,
            width: ((east - west) * per_degree).round() as usize,
            height: ((north - south) * per_degree).round() as usize,
        }
    }

    /// Latitude and longitude of a pixel's centre.
    pub(super) fn center(&self, column: usize, row: usize) -> (f64, f64) {
        let middle = |index: usize| (index as f64 + 0.5) * self.step_deg;
        (self.north_deg - middle(row), self.west_deg + middle(column))
    }

    /// The same for all pixels, row by row.
    pub(super) fn centers(&self) -> impl Iterator<Item = (f64, f64)> {
        (0..self.height).flat_map(move |row| (0..self.width).map(move |column| self.center(column, row)))
    }
}

/// Writes values, row by row, as float32.
pub(super) fn write(path: &Path, spec: &RasterSpec, values: &[f32]) -> Result<(), SceneError> {
    let write = || -> gdal::errors::Result<()> {
        let driver = DriverManager::get_driver_by_name("GTiff")?;
        let options = RasterCreationOptions::default();
        let mut dataset = driver.create_with_band_type_with_options::<f32, _>(
            path,
            spec.width,
            spec.height,
            1,
            &options,
        )?;
        dataset.set_geo_transform(&[
            spec.west_deg,
            spec.step_deg,
            0.0,
            spec.north_deg,
            0.0,
            -spec.step_deg,
        ])?;
        dataset.set_spatial_ref(&SpatialRef::from_epsg(4326)?)?;
        let mut buffer = Buffer::new((spec.width, spec.height), values.to_vec());
        dataset.rasterband(1)?.write((0, 0), (spec.width, spec.height), &mut buffer)?;
        dataset.close()
    };
    write().map_err(|error| SceneError::Io {
        path: path.to_owned(),
        source: std::io::Error::other(error.to_string()),
    })
}
