//! An opened scene: all queries on the light and the terrain of a region.

mod place_sums;
mod rasters;
mod skylines;

pub use place_sums::SumWay;
pub use skylines::Prepared;

use crate::blocked_sources;
use crate::changes::{Base, ChangeError, ChangeStep, ChangeSummary};
use crate::coverage;
use crate::gather;
use crate::grid::Grid;
use crate::ground::Ground;
use crate::land_cover::{Land, LandCover};
use crate::light_layer::{LightLayer, by_fixture};
use crate::light_shares::{LightShares, ShareCollector};
use crate::light_tree::{FAR_BLOCK_RATIO, LightTree, NO_BLOCKS};
use crate::mask::ValidMask;
use crate::metadata::{NamedPlace, SceneMetadata};
use crate::morton;
use crate::polar_grid::PolarGrid;
use crate::skyline_view::SkylineView;
use crate::terrain::{GroundLine, GroundSight, Terrain};
use glam::DVec3;
use skyglow_physics::geometry::LocalFrame;
use skyglow_physics::source_pixel::{MAX_SOURCE_DISTANCE_M, upward_flux_dnb_w};
use skyglow_physics::{BlockedSource, Fixture, GeoPoint, Horizon, Slope, SourcePixel};
use std::sync::Arc;

/// A scene in memory. It needs no GDAL to answer queries, and of its files those that are too large to be read whole. A clone shares everything but its metadata.
#[derive(Clone, Debug)]
pub struct Scene {
    pub(crate) metadata: SceneMetadata,
    pub(crate) grid: Arc<Grid>,
    pub(crate) mask: Arc<ValidMask>,
    /// Its lights: those of the raster first, then changed and new ones.
    pub(crate) light_layers: Vec<LightLayer>,
    pub(crate) terrain: Arc<Terrain>,
    pub(crate) land_cover: Arc<LandCover>,
    pub(crate) places: Arc<[NamedPlace]>,
}

impl Scene {
    /// Its metadata.
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

    /// Whether it is known what covers the ground.
    pub fn has_land_cover(&self) -> bool {
        !self.land_cover.is_empty()
    }

    /// What covers the ground within about `resolution_m` around a place; None where nothing is known of it.
    pub fn land(&self, place: GeoPoint, resolution_m: f64) -> Option<Land> {
        self.land_cover.at(place, resolution_m)
    }

    /// How the ground lies at a place, over two samples of the terrain each way; level where the terrain has a gap.
    pub fn slope(&self, place: GeoPoint) -> Slope {
        self.terrain.slope(place)
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

    /// tan of that elevation towards some azimuths, radians, 1 % and 0.007° too low at most.
    ///
    /// * `sights`: azimuths, and what the tangents are at least, itself at least 0: no time is spent below it.
    ///
    /// Takes some microseconds for each azimuth.
    pub fn coarse_horizon<const N: usize>(
        &self,
        place: GeoPoint,
        eye_altitude_m: f64,
        sights: [(f64, f64); N],
    ) -> [f64; N] {
        self.terrain.coarse_tangents(place, eye_altitude_m, sights)
    }

    /// Ground seen by an eye over a place, a line for each azimuth.
    ///
    /// * `eye_altitude_m`: metres above sea level; below the ground counts as on it.
    ///
    /// Takes some ten milliseconds of two cores for a thousand azimuths.
    pub fn visible_ground(
        &self,
        place: GeoPoint,
        eye_altitude_m: f64,
        sight: &GroundSight,
    ) -> Vec<GroundLine> {
        let eye_altitude_m = eye_altitude_m.max(self.ground(place).altitude_m());
        self.terrain.visible_ground(place, eye_altitude_m, sight)
    }

    /// The blocking angle of a light towards a place, radians, 0..=π/2: the highest elevation of the terrain between
    /// them, seen from the light, in the vertical plane through both. Exact for the bilinear terrain.
    ///
    /// * `light`, `light_altitude_m`: where the light is, metres above sea level.
    /// * `pixel_size_m`: the side of its pixel; terrain nearer than an eighth of it does not block, since the lamps are
    ///   spread over the pixel.
    pub fn blocking_angle_rad(
        &self,
        light: GeoPoint,
        light_altitude_m: f64,
        pixel_size_m: f64,
        towards: GeoPoint,
    ) -> f64 {
        self.terrain.blocking_angle_rad(light, light_altitude_m, pixel_size_m, towards)
    }

    /// Whether terrain stands between a light and a point that it would shine on: the straight segment between them
    /// meets the bilinear terrain, farther from the light than an eighth of its pixel's side `pixel_size_m`.
    ///
    /// * `light_m`, `point_m`: positions from the Earth's centre, metres, in the frame of [`GeoPoint::unit_vector`].
    ///
    /// Light that leaves below the light's horizontal plane counts as hidden only by terrain above that plane.
    pub fn blocks(&self, light_m: DVec3, point_m: DVec3, pixel_size_m: f64) -> bool {
        self.terrain.blocks(light_m, point_m, pixel_size_m)
    }

    /// The raster's radiance at a place, nW cm⁻² sr⁻¹, without the calibration: 0 where it measured no
    /// light (or less than none), `None` outside and without data.
    pub fn radiance_nw_cm2_sr(&self, place: GeoPoint) -> Option<f64> {
        let (column, row) = self.grid.pixel_at(place)?;
        let lights = self.light_layers.iter().filter_map(|layer| layer.radiance_at(column, row));
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
        let layers: Vec<&LightLayer> = self.light_layers.iter().collect();
        let view = self.view_from(place, terrain_hides, far_block_ratio);
        self.polar_grid_of(&layers, place, terrain_hides.then_some(view.as_ref()), far_block_ratio)
    }

    /// [`Self::polar_grid`] for each kind of fixture, that of the raster's own lights first, be there light or not.
    pub fn polar_grids(&self, place: GeoPoint, terrain_hides: bool) -> Vec<(Fixture, PolarGrid)> {
        let view = self.view_from(place, terrain_hides, FAR_BLOCK_RATIO);
        let hides = terrain_hides.then_some(view.as_ref());
        let polar = |layers: &[&LightLayer]| self.polar_grid_of(layers, place, hides, FAR_BLOCK_RATIO);
        by_fixture(&self.light_layers, polar)
    }

    /// The kinds of fixtures, that of the raster's own lights first.
    pub fn fixtures(&self) -> Vec<Fixture> {
        by_fixture(&self.light_layers, |_| ()).into_iter().map(|(fixture, ())| fixture).collect()
    }

    /// * `hides`: None where nothing hides light; else the skylines that are made by tile, where they are.
    fn polar_grid_of(
        &self,
        layers: &[&LightLayer],
        place: GeoPoint,
        hides: Option<Option<&SkylineView>>,
        far_block_ratio: f64,
    ) -> PolarGrid {
        let calibration = self.metadata.calibration;
        let lights: Vec<LightTree> =
            layers.iter().map(|layer| layer.light(&self.grid, calibration, hides)).collect();
        gather::polar_grid(&lights, place, far_block_ratio, self.coverage(place))
    }

    /// The same with every pixel by itself, and where the light of each went.
    pub fn light_shares(&self, place: GeoPoint, terrain_hides: bool) -> Vec<(Fixture, LightShares)> {
        let frame = LocalFrame::at(place);
        let view = self.view_from(place, terrain_hides, NO_BLOCKS);
        by_fixture(&self.light_layers, |layers| {
            let mut collector = ShareCollector::new();
            for layer in layers {
                let hides = terrain_hides.then_some(view.as_ref());
                let light = layer.light(&self.grid, self.metadata.calibration, hides);
                light.gather(&frame, NO_BLOCKS, &mut collector);
            }
            collector.finish(place, &frame, self.coverage(place), |number| {
                let (column, row) = self.column_and_row(number);
                self.grid.center(column, row)
            })
        })
    }

    /// Bytes of memory that a scene takes as it was ingested, about.
    pub fn byte_count(&self) -> u64 {
        let (row_start, runs) = self.mask.parts();
        let of_mask = 4 * row_start.len() + 8 * runs.len();
        self.first_layer().lights.byte_count()
            + of_mask as u64
            + self.terrain.byte_count()
            + self.land_cover.byte_count()
    }

    /// Bytes of a changed scene that are not shared, about.
    pub fn unshared_bytes(&self) -> usize {
        self.light_layers.iter().map(LightLayer::unshared_bytes).sum()
    }

    /// The lowest and the highest altitude of lights, metres; None without light.
    pub fn light_altitude_range_m(&self) -> Option<[f32; 2]> {
        let ranges = self.light_layers.iter().filter_map(|layer| layer.lights.altitude_range_m);
        ranges.reduce(|[lowest, highest], [low, high]| [lowest.min(low), highest.max(high)])
    }

    /// The lights of the raster, as it was ingested.
    pub(crate) fn first_layer(&self) -> &LightLayer {
        &self.light_layers[0]
    }

    /// The layer of a lit pixel by its number, and the pixel's index in it.
    fn light(&self, number: u32) -> (&LightLayer, usize) {
        let layer = self.light_layers.partition_point(|layer| layer.first_number <= number) - 1;
        let layer = &self.light_layers[layer];
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

    /// Columns and rows from the raster's corner to a place, in parts of pixels; `None` off the raster.
    pub fn position_at(&self, place: GeoPoint) -> Option<(f64, f64)> {
        self.grid.position_of(place)
    }

    /// All light of a pixel: radiance, nW cm⁻² sr⁻¹, without the calibration, and upward flux, DNB watts, with it.
    pub fn pixel_light(&self, column: u32, row: u32) -> (f64, f64) {
        let lights = self.light_layers.iter().filter_map(|layer| layer.radiance_at(column, row));
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
        by_fixture(&self.light_layers, |layers| {
            let calibration = self.metadata.calibration;
            let lights = layers.iter().map(|layer| layer.open_light(&self.grid, calibration));
            lights.flat_map(|light| light.pixels_within(&frame, radius_m)).collect()
        })
    }

    /// Every lit pixel within 300 km of a place as point sources, in the order of
    /// [`point_sources`](skyglow_physics::source_pixel::point_sources), each with its blocking angle from the bilinear
    /// terrain itself. Stored skylines are not used, so a scene need not have them.
    ///
    /// A pixel's horizon is that of its centre at its own altitude, as for the stored skylines; for a piece of a near pixel it is
    /// taken towards the azimuth in which the piece sees the observer and as far as the piece is away. Where the
    /// ground under a pixel is unknown, nothing blocks it: it was put at sea level, and the edge of the terrain would be
    /// a wall. Seconds for a hundred thousand pixels.
    pub fn blocked_sources(&self, place: GeoPoint) -> Vec<BlockedSource> {
        self.blocked_sources_by_fixture(place).into_iter().flat_map(|(_, sources)| sources).collect()
    }

    /// The same for each kind of fixture, that of the raster's own lights first.
    pub fn blocked_sources_by_fixture(&self, place: GeoPoint) -> Vec<(Fixture, Vec<BlockedSource>)> {
        let pixels = self.source_pixels_by_fixture(place, MAX_SOURCE_DISTANCE_M).into_iter();
        pixels
            .map(|(fixture, pixels)| (fixture, blocked_sources::of_pixels(&self.terrain, &pixels, place)))
            .collect()
    }

    /// The code of a pixel in [`PixelFactors`](crate::PixelFactors).
    pub fn pixel_code(column: u32, row: u32) -> u64 {
        morton::encode(column, row)
    }

    /// Column and row of a code.
    pub fn column_and_row_of(code: u64) -> (u32, u32) {
        morton::decode(code)
    }

    /// The scene with changes, one step after the other. What no change touches is shared with this scene; pyramids are made
    /// of the touched lights alone. New lights stand on the terrain and behind its skylines as those of the raster do.
    ///
    /// * `mark`: identifies these changes; the version is made from it and the scene's.
    ///
    /// # Errors
    /// [`ChangeError`].
    ///
    /// # Panics
    /// If the scene is a changed one itself: give all steps to the scene that was ingested.
    pub fn changed(&self, steps: &[ChangeStep], mark: &str) -> Result<(Self, ChangeSummary), ChangeError> {
        assert!(self.light_layers.len() == 1, "steps belong to a scene as it was ingested");
        let base = Base {
            grid: &self.grid,
            mask: &self.mask,
            layer: self.first_layer(),
            terrain: &self.terrain,
            calibration: self.metadata.calibration,
        };
        let (light_layers, summary) = base.changed(steps)?;
        let mut metadata = self.metadata.clone();
        metadata.lit_pixels = light_layers.iter().map(|layer| layer.len() as u64).sum();
        let version = blake3::hash(format!("{} {mark}", self.metadata.version).as_bytes());
        metadata.version = version.to_hex()[..32].to_owned();
        Ok((Self { metadata, light_layers, ..self.clone() }, summary))
    }
}

#[cfg(test)]
#[path = "scene_tests.rs"]
mod tests;
