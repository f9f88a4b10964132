//! An opened scene: everything that is asked of the light and the terrain of a region.

use crate::coverage;
use crate::error::SceneError;
use crate::gather::{FAR_BLOCK_RATIO, Light, NO_BLOCKS};
use crate::gather_tasks;
use crate::grid::Grid;
use crate::ground::Ground;
use crate::light_layer::LightLayer;
use crate::light_shares::{LightShares, ShareCollector};
use crate::map_tile::{self, PixelValues, RasterTile, TileLayer};
use crate::mask::ValidMask;
use crate::metadata::{NamedPlace, SceneMetadata};
use crate::morton;
use crate::place_sum::PlaceValues;
use crate::polar_grid::PolarGrid;
use crate::terrain::{Terrain, nearest_wall_m};
use glam::DVec3;
use skyglow_physics::geometry::LocalFrame;
use skyglow_physics::horizon::terrain_elevation_tangent;
use skyglow_physics::source_pixel::upward_flux_dnb_w;
use skyglow_physics::{EARTH_RADIUS_M, Fixture, GeoPoint, Horizon, SourcePixel};
use std::sync::Arc;

/// A scene in memory. It needs neither its files nor GDAL to answer. A clone shares all but what is said about it.
#[derive(Clone, Debug)]
pub struct Scene {
    pub(crate) metadata: SceneMetadata,
    pub(crate) grid: Arc<Grid>,
    pub(crate) mask: Arc<ValidMask>,
    /// Its lights: those of the raster first, then changed and new ones.
    pub(crate) layers: Vec<LightLayer>,
    pub(crate) terrain: Arc<Terrain>,
    pub(crate) places: Arc<[NamedPlace]>,
}

impl Scene {
    /// What is said about the scene.
    pub fn metadata(&self) -> &SceneMetadata {
        &self.metadata
    }

    /// Places with names, the most populous first.
    pub fn places(&self) -> &[NamedPlace] {
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
        let lights = self.layers.iter().filter_map(|layer| layer.radiance_at(column, row));
        let radiance = lights.map(f64::from).reduce(|sum, light| sum + light);
        radiance.or_else(|| self.mask.is_valid(column, row).then_some(0.0))
    }

    /// The light around a place by azimuth and distance: all lit pixels whose centre is within 300 km, far
    /// ones by blocks (see [`FAR_BLOCK_RATIO`]), whatever shines in them. Works for places off the raster too.
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
        let layers: Vec<&LightLayer> = self.layers.iter().collect();
        self.polar_grid_of(&layers, place, terrain_hides, far_block_ratio)
    }

    /// [`Self::polar_grid`] for each kind of fixture, that of the raster's own lights first, be there light or not.
    pub fn polar_grids(&self, place: GeoPoint, terrain_hides: bool) -> Vec<(Fixture, PolarGrid)> {
        let polar =
            |layers: &[&LightLayer]| self.polar_grid_of(layers, place, terrain_hides, FAR_BLOCK_RATIO);
        self.by_fixture(polar)
    }

    fn polar_grid_of(
        &self,
        layers: &[&LightLayer],
        place: GeoPoint,
        terrain_hides: bool,
        far_block_ratio: f64,
    ) -> PolarGrid {
        let lights: Vec<Light> = layers
            .iter()
            .map(|layer| layer.light(&self.grid, self.metadata.calibration, terrain_hides))
            .collect();
        gather_tasks::polar_grid(&lights, place, far_block_ratio, self.coverage(place))
    }

    /// The same with every pixel by itself, and where the light of each went.
    pub fn light_shares(&self, place: GeoPoint, terrain_hides: bool) -> Vec<(Fixture, LightShares)> {
        let frame = LocalFrame::at(place);
        self.by_fixture(|layers| {
            let mut collector = ShareCollector::new();
            for layer in layers {
                let light = layer.light(&self.grid, self.metadata.calibration, terrain_hides);
                light.gather(&frame, NO_BLOCKS, &mut collector);
            }
            collector.finish(place, &frame, self.coverage(place), |number| {
                let (column, row) = self.column_and_row(number);
                self.grid.center(column, row)
            })
        })
    }

    /// Something made of the layers of each kind of fixture, that of the raster's own lights first.
    pub(crate) fn by_fixture<T>(&self, make: impl Fn(&[&LightLayer]) -> T) -> Vec<(Fixture, T)> {
        let mut kinds: Vec<(Fixture, Vec<&LightLayer>)> = Vec::new();
        for layer in &self.layers {
            match kinds.iter_mut().find(|(fixture, _)| *fixture == layer.fixture) {
                Some((_, layers)) => layers.push(layer),
                None => kinds.push((layer.fixture.clone(), vec![layer])),
            }
        }
        kinds.into_iter().map(|(fixture, layers)| (fixture, make(&layers))).collect()
    }

    /// Bytes that a changed scene takes beside what it shares, about.
    pub fn unshared_bytes(&self) -> usize {
        self.layers.iter().map(LightLayer::unshared_bytes).sum()
    }

    /// The lowest and the highest altitude of lights, metres; None without light.
    pub fn light_altitude_range_m(&self) -> Option<[f32; 2]> {
        let altitudes = self.layers.iter().flat_map(|layer| layer.lights.pixels.altitude_m.iter().copied());
        altitudes.fold(None, |range, altitude_m| {
            let [lowest, highest] = range.unwrap_or([altitude_m; 2]);
            Some([altitude_m.min(lowest), altitude_m.max(highest)])
        })
    }

    /// The lights of the raster, as it was ingested.
    pub(crate) fn first_layer(&self) -> &LightLayer {
        &self.layers[0]
    }

    /// The layer of a lit pixel by its number, and the pixel's index in it.
    fn light(&self, number: u32) -> (&LightLayer, usize) {
        let layer = self.layers.partition_point(|layer| layer.first_number <= number) - 1;
        let layer = &self.layers[layer];
        (layer, (number - layer.first_number) as usize)
    }

    /// The code ([`Self::pixel_code`]) of a lit pixel by its number.
    ///
    /// # Panics
    /// For a number that no lit pixel has.
    pub fn code(&self, number: u32) -> u64 {
        let (layer, index) = self.light(number);
        layer.lights.pixels.codes[index]
    }

    /// Column and row on the raster of a lit pixel by its number, as [`LightShares`] names it. In a changed scene a pixel may
    /// have lights of several kinds, each with a number of its own.
    ///
    /// # Panics
    /// For a number that no lit pixel has.
    pub fn column_and_row(&self, number: u32) -> (u32, u32) {
        morton::decode(self.code(number))
    }

    /// The raster's radiance of a lit pixel by its number, nW cm⁻² sr⁻¹, without the calibration.
    ///
    /// # Panics
    /// For a number that no lit pixel has.
    pub fn lit_radiance_nw_cm2_sr(&self, number: u32) -> f32 {
        let (layer, index) = self.light(number);
        layer.lights.pixels.radiance_nw_cm2_sr[index]
    }

    /// Column and row of the pixel at a place; `None` off the raster.
    pub fn column_and_row_at(&self, place: GeoPoint) -> Option<(u32, u32)> {
        self.grid.pixel_at(place)
    }

    /// All light of a pixel: radiance, nW cm⁻² sr⁻¹, without the calibration, and upward flux, DNB watts, with it.
    pub fn pixel_light(&self, column: u32, row: u32) -> (f64, f64) {
        let lights = self.layers.iter().filter_map(|layer| layer.radiance_at(column, row));
        let radiance: f64 = lights.map(f64::from).sum();
        let flux_dnb_w = upward_flux_dnb_w(radiance, self.grid.area_m2(column, row));
        (radiance, self.metadata.calibration * flux_dnb_w)
    }

    /// The centre of a pixel of the raster.
    pub fn pixel_center(&self, column: u32, row: u32) -> GeoPoint {
        GeoPoint::from_vector(self.grid.center(column, row))
    }

    /// The part of the 300 km disc around a place for which the raster has data, 0..=1, to about 0.005.
    /// Dark ground counts as covered; no-data and what is beyond the raster do not.
    pub fn coverage(&self, place: GeoPoint) -> f64 {
        coverage::covered_fraction(&self.grid, &self.mask, place)
    }

    /// Every lit pixel whose centre is within `radius_m` of a place, exactly as the raster has it.
    pub fn source_pixels_within(&self, place: GeoPoint, radius_m: f64) -> Vec<SourcePixel> {
        self.source_pixels_by_fixture(place, radius_m).into_iter().flat_map(|(_, pixels)| pixels).collect()
    }

    /// The same for each kind of fixture, that of the raster's own lights first.
    pub fn source_pixels_by_fixture(
        &self,
        place: GeoPoint,
        radius_m: f64,
    ) -> Vec<(Fixture, Vec<SourcePixel>)> {
        let frame = LocalFrame::at(place);
        self.by_fixture(|layers| {
            let calibration = self.metadata.calibration;
            let lights = layers.iter().map(|layer| layer.light(&self.grid, calibration, false));
            lights.flat_map(|light| light.pixels_within(&frame, radius_m)).collect()
        })
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
        numbers: &PixelValues,
        z: u8,
        x: u32,
        y: u32,
        size_px: u32,
    ) -> Result<RasterTile, SceneError> {
        map_tile::sample_pixels(self, numbers, z, x, y, size_px)
    }

    /// [`Self::tile`] of numbers that places have.
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
        map_tile::sample_places(self, places, z, x, y, size_px)
    }
}
