//! Map tiles and GeoTIFFs of a scene.

use super::Scene;
use crate::dual_tree::{PlaceLattice, PlaceValues};
use crate::error::SceneError;
use crate::geotiff::{self, RasterError, RasterMetadata};
use crate::map_tile::{PixelValues, RasterTile, SampledRasters, TileAddress, TileLayer};
use skyglow_physics::GeoPoint;

impl Scene {
    /// A Web-Mercator tile of numbers, `size_px` × `size_px` (1..=1024), row 0 in the north.
    ///
    /// # Errors
    /// [`SceneError::InvalidTile`] beyond zoom 24, off the world or of another size.
    pub fn tile(
        &self,
        layer: TileLayer,
        z: u8,
        x: u32,
        y: u32,
        size_px: u32,
    ) -> Result<RasterTile, SceneError> {
        self.sampled_rasters().tile(layer, TileAddress { z, x, y, size_px })
    }

    /// [`Self::tile`] of values of lit pixels.
    ///
    /// # Errors
    /// As [`Self::tile`].
    pub fn pixels_tile(
        &self,
        values: &PixelValues,
        z: u8,
        x: u32,
        y: u32,
        size_px: u32,
    ) -> Result<RasterTile, SceneError> {
        self.sampled_rasters().pixels_tile(values, TileAddress { z, x, y, size_px })
    }

    /// [`Self::tile`] of values of places.
    ///
    /// # Errors
    /// As [`Self::tile`].
    pub fn places_tile(
        &self,
        places: &PlaceValues,
        z: u8,
        x: u32,
        y: u32,
        size_px: u32,
    ) -> Result<RasterTile, SceneError> {
        self.sampled_rasters().places_tile(places, TileAddress { z, x, y, size_px })
    }

    /// The value at any place from those of a lattice, the mean over a width in metres; None off the raster and where there is none.
    pub fn value_at(&self, places: &PlaceValues, place: GeoPoint, width_m: f64) -> Option<f64> {
        let (x, y) = self.grid.position_of(place)?;
        places.at(x, y, width_m / self.metadata.pixel_size_m)
    }

    /// A layer at every place of a lattice: the mean radiance of the pixels of its block, the elevation at its middle; NaN
    /// without data.
    pub fn layer_at_places(&self, layer: TileLayer, lattice: PlaceLattice) -> Option<PlaceValues> {
        self.sampled_rasters().at_places(layer, lattice)
    }

    fn sampled_rasters(&self) -> SampledRasters<'_> {
        SampledRasters {
            grid: &self.grid,
            mask: &self.mask,
            pixel_size_m: self.metadata.pixel_size_m,
            light_layers: &self.light_layers,
            terrain: &self.terrain,
        }
    }

    /// Numbers of lit pixels as a cloud-optimized GeoTIFF, as [`Self::codes_geotiff`]; those of lights that share a pixel are added up.
    ///
    /// * `numbers`: of lit pixels ([`Self::column_and_row`]); `values` in parallel.
    ///
    /// # Errors
    /// [`RasterError`], only by a defect or for want of memory.
    pub fn pixels_geotiff(
        &self,
        numbers: &[u32],
        values: &[f32],
        metadata: &RasterMetadata<'_>,
    ) -> Result<Vec<u8>, RasterError> {
        let codes = numbers.iter().map(|&number| self.code(number));
        let mut pixels: Vec<(u64, f32)> = codes.zip(values.iter().copied()).collect();
        pixels.sort_by_key(|pixel| pixel.0);
        pixels.dedup_by(|next, first| {
            let is_same = next.0 == first.0;
            first.1 += if is_same { next.1 } else { 0.0 };
            is_same
        });
        self.codes_geotiff(&pixels, metadata)
    }

    /// Numbers of pixels as a cloud-optimized GeoTIFF on the scene's grid and in its CRS: one float32 band, deflated, with overviews of
    /// means; all other pixels are no data (NaN). Only tiles with numbers are written, so a few pixels of a large raster are a small file.
    ///
    /// * `pixels`: codes ([`Self::pixel_code`]), ascending, each with its number.
    ///
    /// # Errors
    /// [`RasterError`], only by a defect or for want of memory.
    pub fn codes_geotiff(
        &self,
        pixels: &[(u64, f32)],
        metadata: &RasterMetadata<'_>,
    ) -> Result<Vec<u8>, RasterError> {
        geotiff::of_pixels(&self.metadata.grid, pixels, metadata)
    }

    /// Numbers of places as a cloud-optimized GeoTIFF in the scene's CRS: one float32 band, deflated, with overviews; NaN is no data.
    ///
    /// # Errors
    /// [`RasterError`], only by a defect or for want of memory.
    pub fn places_geotiff(
        &self,
        places: &PlaceValues,
        metadata: &RasterMetadata<'_>,
    ) -> Result<Vec<u8>, RasterError> {
        geotiff::of_places(&self.metadata.grid, places, metadata)
    }
}
