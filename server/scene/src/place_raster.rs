//! A number for each place of a lattice, as a cloud-optimized GeoTIFF on the scene's own grid.

use crate::map_tile::TileLayer;
use crate::pixel_raster::{MemoryFile, RasterError, RasterMetadata, set_unit};
use crate::place_sum::{PlaceLattice, PlaceValues};
use crate::scene::Scene;
use gdal::raster::{Buffer, RasterCreationOptions};
use gdal::spatial_ref::SpatialRef;
use gdal::{DriverManager, Metadata, vsi};
use rayon::prelude::*;
use skyglow_physics::GeoPoint;

impl Scene {
    /// What a layer shows at every place of a lattice: the mean radiance of the pixels of its block, the ground at its middle; NaN
    /// without data.
    pub fn layer_at_places(&self, layer: TileLayer, lattice: PlaceLattice) -> Option<PlaceValues> {
        let level = lattice.step.trailing_zeros();
        let radiance = |column: u32, row: u32| {
            let valid = self.mask.valid_in_block(level, column, row);
            let sums = self.layers.iter().map(|layer| layer.radiance_sum_nw_cm2_sr(level, column, row));
            if valid > 0 { (sums.sum::<f64>() / f64::from(valid)) as f32 } else { f32::NAN }
        };
        let elevation = |column: u32, row: u32| {
            let point = lattice.point(&self.grid, f64::from(column), f64::from(row));
            let known =
                point.is_finite().then(|| self.terrain.elevation_m(GeoPoint::from_vector(point))).flatten();
            known.map_or(f32::NAN, |elevation_m| elevation_m as f32)
        };
        let mut values = vec![0f32; lattice.len()];
        values.par_chunks_mut(lattice.columns as usize).zip(0..lattice.rows).for_each(|(values, row)| {
            for (value, column) in values.iter_mut().zip(0u32..) {
                *value = match layer {
                    TileLayer::Radiance => radiance(column, row),
                    TileLayer::Elevation => elevation(column, row),
                };
            }
        });
        PlaceValues::new(lattice, values)
    }

    /// Numbers of places as a cloud-optimized GeoTIFF in the scene's CRS: one float32 band, deflated, with overviews; NaN is no data.
    ///
    /// # Errors
    /// [`RasterError`], only by a defect or for want of memory.
    pub fn places_geotiff(
        &self,
        places: &PlaceValues,
        words: &RasterMetadata<'_>,
    ) -> Result<Vec<u8>, RasterError> {
        let lattice = places.lattice();
        let size = (lattice.columns as usize, lattice.rows as usize);
        let memory = DriverManager::get_driver_by_name("MEM")?;
        let mut dataset = memory.create_with_band_type::<f32, _>("", size.0, size.1, 1)?;
        dataset.set_geo_transform(&lattice.geotransform(self.metadata.grid.geotransform))?;
        dataset.set_spatial_ref(&SpatialRef::from_wkt(&self.metadata.grid.crs_wkt)?)?;
        for (name, text) in words.notes {
            dataset.set_metadata_item(name, text, "")?;
        }
        let mut band = dataset.rasterband(1)?;
        band.set_no_data_value(Some(f64::NAN))?;
        band.set_description(words.description)?;
        set_unit(&band, words.unit)?;
        band.write((0, 0), size, &mut Buffer::new(size, places.values().to_vec()))?;
        let file = MemoryFile::new();
        let options = RasterCreationOptions::from_iter([
            "COMPRESS=DEFLATE",
            "PREDICTOR=YES",
            "OVERVIEW_RESAMPLING=AVERAGE",
            "BIGTIFF=IF_SAFER",
        ]);
        let cog = DriverManager::get_driver_by_name("COG")?;
        dataset.create_copy(&cog, file.name(), &options)?.close()?;
        Ok(vsi::get_vsi_mem_file_bytes_owned(file.name())?)
    }
}
