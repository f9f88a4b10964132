//! An opened scene: everything that is asked of the light and the terrain of a region.

use crate::coverage;
use crate::error::SceneError;
use crate::gather::{FAR_BLOCK_RATIO, Light, NO_BLOCKS};
use crate::grid::Grid;
use crate::ground::Ground;
use crate::light_pyramid::LightPyramid;
use crate::light_shares::{LightShares, ShareCollector};
use crate::lit_pixels::LitPixels;
use crate::map_tile::{self, PixelNumbers, RasterTile, TileLayer};
use crate::mask::ValidMask;
use crate::metadata::{Place, SceneMetadata};
use crate::morton;
use crate::polar_grid::{PolarAccumulator, PolarGrid};
use crate::skylines::Skylines;
use crate::terrain::{Terrain, nearest_wall_m};
use glam::DVec3;
use skyglow_physics::geometry::LocalFrame;
use skyglow_physics::horizon::terrain_elevation_tangent;
use skyglow_physics::{EARTH_RADIUS_M, GeoPoint, Horizon, SourcePixel};

/// A scene in memory. It needs neither its files nor GDAL to answer; share it in an `Arc`.
#[derive(Debug)]
pub struct Scene {
    pub(crate) metadata: SceneMetadata,
    pub(crate) grid: Grid,
    pub(crate) mask: ValidMask,
    pub(crate) pixels: LitPixels,
    /// What stands around each lit pixel; None without terrain, and for scenes stored before it was looked for.
    pub(crate) skylines: Option<Skylines>,
    pub(crate) pyramid: LightPyramid,
    pub(crate) terrain: Terrain,
    pub(crate) places: Vec<Place>,
}

impl Scene {
    /// What is said about the scene.
    pub fn metadata(&self) -> &SceneMetadata {
        &self.metadata
    }

    /// Places with names, the most populous first.
    pub fn places(&self) -> &[Place] {
        &self.places
    }

    /// Whether a place lies on the raster (with data or without).
    pub fn contains(&self, place: GeoPoint) -> bool {
        self.grid.pixel_at(place).is_some()
    }

    /// The ground under an observer: the terrain there, else the nearest within 5 km, as for the lights.
    pub fn ground(&self, place: GeoPoint) -> Ground {
        self.terrain.ground(place)
    }

    /// Terrain elevation, metres, bilinear, at least 0; `None` where the terrain has no data at that place.
    pub fn terrain_altitude_m(&self, place: GeoPoint) -> Option<f64> {
        self.terrain.elevation_m(place).map(|elevation_m| elevation_m.max(0.0))
    }

    /// The elevation of the ground against the sky, seen by an eye at an altitude over a place: from the scene's
    /// terrain with the Earth's curvature, without refraction, out to where no ground of the scene can matter.
    /// Below the ground counts as on it. Where there is no terrain nothing hides the sky.
    ///
    /// * `eye_altitude_m`: metres above sea level.
    ///
    /// Takes about a millisecond on two cores; the first call for a scene also makes bounds of its terrain, a tenth of
    /// a second for ten million samples.
    pub fn horizon(&self, place: GeoPoint, eye_altitude_m: f64) -> Horizon {
        if self.terrain.is_empty() {
            return Horizon::flat();
        }
        self.terrain.horizon(place, eye_altitude_m.max(self.ground(place).altitude_m()))
    }

    /// The blocking angle of a light towards a place, radians, 0..=π/2: the highest elevation of the terrain between
    /// them, seen from the light, in the vertical plane through both. Exact for the bilinear terrain.
    ///
    /// * `light`, `light_altitude_m`: where the light is, metres above sea level.
    /// * `pixel_size_m`: the side of its pixel; terrain nearer than an eighth of it is no wall, since the lamps are
    ///   spread over the pixel.
    pub fn blocking_angle_rad(
        &self,
        light: GeoPoint,
        light_altitude_m: f64,
        pixel_size_m: f64,
        towards: GeoPoint,
    ) -> f64 {
        let bearing = LocalFrame::at(light).bearing_to(towards.unit_vector());
        let sight = self.terrain.around_source(light, light_altitude_m, nearest_wall_m(pixel_size_m));
        let [tangent] = sight.tangents(bearing.azimuth_rad, 0.0, &[bearing.distance_m]);
        tangent.atan()
    }

    /// Whether terrain stands between a light and a point that it would shine on: the straight segment between them
    /// meets the bilinear terrain, farther from the light than an eighth of its pixel's side `pixel_size_m`.
    ///
    /// * `light_m`, `point_m`: positions from the Earth's centre, metres, in the frame of [`GeoPoint::unit_vector`].
    ///
    /// Light that leaves below the light's horizontal plane counts as hidden only by terrain above that plane.
    pub fn hides(&self, light_m: DVec3, point_m: DVec3, pixel_size_m: f64) -> bool {
        let light = GeoPoint::from_vector(light_m);
        let (altitude_m, point_altitude_m) =
            (light_m.length() - EARTH_RADIUS_M, point_m.length() - EARTH_RADIUS_M);
        let bearing = LocalFrame::at(light).bearing_to(point_m.normalize());
        if bearing.distance_m < nearest_wall_m(pixel_size_m) {
            return false;
        }
        let tangent = terrain_elevation_tangent(altitude_m, point_altitude_m, bearing.distance_m);
        let sight = self.terrain.around_source(light, altitude_m, nearest_wall_m(pixel_size_m));
        sight.is_higher_than(tangent.max(0.0), bearing.azimuth_rad, bearing.distance_m)
    }

    /// The raster's radiance at a place, nW cm⁻² sr⁻¹, without the calibration: 0 where it measured no
    /// light (or less than none), `None` outside and without data.
    pub fn radiance_nw_cm2_sr(&self, place: GeoPoint) -> Option<f64> {
        let (column, row) = self.grid.pixel_at(place)?;
        let radiance = self.pixels.radiance_at(column, row);
        radiance.map(f64::from).or_else(|| self.mask.is_valid(column, row).then_some(0.0))
    }

    /// The light around a place by azimuth and distance: all lit pixels whose centre is within 300 km, far
    /// ones by blocks (see [`FAR_BLOCK_RATIO`]). Works for places off the raster too.
    ///
    /// * `terrain_hides`: whether the terrain between a light and the place cuts its low light. Without it, or
    ///   where the scene knows no skylines of its lights, all light is under an open sky (blocking index 0).
    pub fn polar_grid(&self, place: GeoPoint, terrain_hides: bool) -> PolarGrid {
        self.polar_grid_with_ratio(place, terrain_hides, FAR_BLOCK_RATIO)
    }

    /// [`Self::polar_grid`] with another limit for blocks; 0 takes every pixel by itself.
    pub fn polar_grid_with_ratio(
        &self,
        place: GeoPoint,
        terrain_hides: bool,
        far_block_ratio: f64,
    ) -> PolarGrid {
        let mut accumulator = PolarAccumulator::new();
        self.light_behind(terrain_hides).gather(&LocalFrame::at(place), far_block_ratio, &mut accumulator);
        accumulator.finish(place, self.coverage(place))
    }

    /// The same with every pixel by itself, and where the light of each went.
    pub fn light_shares(&self, place: GeoPoint, terrain_hides: bool) -> LightShares {
        let mut collector = ShareCollector::new();
        let frame = LocalFrame::at(place);
        self.light_behind(terrain_hides).gather(&frame, NO_BLOCKS, &mut collector);
        collector.finish(place, &frame, self.coverage(place), |number| {
            let (column, row) = morton::decode(self.pixels.codes[number as usize]);
            self.grid.center(column, row)
        })
    }

    /// Column and row on the raster of a lit pixel by its number, as [`LightShares`] names it.
    ///
    /// # Panics
    /// For a number that no lit pixel has.
    pub fn column_and_row(&self, number: u32) -> (u32, u32) {
        morton::decode(self.pixels.codes[number as usize])
    }

    /// The raster's radiance of a lit pixel by its number, nW cm⁻² sr⁻¹, without the calibration.
    ///
    /// # Panics
    /// For a number that no lit pixel has.
    pub fn lit_radiance_nw_cm2_sr(&self, number: u32) -> f32 {
        self.pixels.radiance_nw_cm2_sr[number as usize]
    }

    /// The centre of a pixel of the raster.
    pub fn pixel_center(&self, column: u32, row: u32) -> GeoPoint {
        GeoPoint::from_vector(self.grid.center(column, row))
    }

    /// The scene's light, behind the skylines around it where those are known and terrain is to hide.
    fn light_behind(&self, terrain_hides: bool) -> Light<'_> {
        let skylines =
            self.skylines.as_ref().filter(|skylines| terrain_hides && skylines.blocked_count() > 0);
        Light { skylines, ..self.light() }
    }

    /// The part of the 300 km disc around a place for which the raster has data, 0..=1, to about 0.005.
    /// Dark ground counts as covered; no-data and what is beyond the raster do not.
    pub fn coverage(&self, place: GeoPoint) -> f64 {
        coverage::covered_fraction(&self.grid, &self.mask, place)
    }

    /// Every lit pixel whose centre is within `radius_m` of a place, exactly as the raster has it.
    pub fn source_pixels_within(&self, place: GeoPoint, radius_m: f64) -> Vec<SourcePixel> {
        self.light().pixels_within(&LocalFrame::at(place), radius_m)
    }

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
        map_tile::sample(self, layer, z, x, y, size_px)
    }

    /// [`Self::tile`] of numbers that lit pixels have.
    ///
    /// # Errors
    /// As [`Self::tile`].
    pub fn pixels_tile(
        &self,
        numbers: &PixelNumbers,
        z: u8,
        x: u32,
        y: u32,
        size_px: u32,
    ) -> Result<RasterTile, SceneError> {
        map_tile::sample_pixels(self, numbers, z, x, y, size_px)
    }

    fn light(&self) -> Light<'_> {
        Light {
            grid: &self.grid,
            pixels: &self.pixels,
            pyramid: &self.pyramid,
            calibration: self.metadata.calibration,
            skylines: None,
        }
    }
}
