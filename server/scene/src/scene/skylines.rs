//! Skylines of a scene that are made by tile: those that a query needs, and making them beforehand.

use super::Scene;
use crate::error::SceneError;
use crate::light_tree::FAR_BLOCK_RATIO;
use crate::skyline_part::Observer;
use crate::skyline_tiles::{SkylineTiles, TileGround, lights_of, tiles_within};
use crate::skyline_view::{Disc, SkylineView, tiles_of};
use crate::skylines::Skyline;
use serde::Serialize;
use skyglow_physics::GeoPoint;
use skyglow_physics::source_pixel::MAX_SOURCE_DISTANCE_M;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Arc;
use std::time::{Duration, Instant};

/// For so long at a time those who wait for parts of tiles have the processor for themselves.
const PAUSE: Duration = Duration::from_millis(50);
/// Of the time of the thread that makes tiles, at least this part is its own, however many wait.
const OWN_PART: f64 = 0.5;
/// Seconds that are given to them before the first tile.
const FIRST_GIVEN_S: f64 = 1.0;

/// What [`Scene::prepare_skylines`] did.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct Prepared {
    /// Tiles whose lights reach into the bounds.
    pub tiles: u64,
    /// Lights in them.
    pub lights: u64,
    /// Tiles that had to be made.
    pub made: u64,
}

impl Scene {
    fn tile_ground(&self) -> TileGround<'_> {
        self.first_layer().lights.tile_ground(&self.grid, &self.terrain, self.metadata.calibration)
    }

    fn skyline_tiles(&self) -> Option<&SkylineTiles> {
        self.first_layer().lights.tiles.as_deref()
    }

    /// The skylines of the lights of some discs, where those hide light and are made by tile.
    ///
    /// * `largest_m`: no block of a larger radius counts as one.
    /// * `observer`: who looks at them, where it is one alone.
    pub(super) fn skyline_view(
        &self,
        terrain_hides: bool,
        discs: impl FnOnce() -> Vec<Disc>,
        largest_m: f64,
        observer: Option<&Observer>,
    ) -> Option<SkylineView> {
        let tiles = self.skyline_tiles().filter(|_| terrain_hides)?;
        Some(SkylineView::new(tiles, &self.tile_ground(), &discs(), largest_m, observer))
    }

    /// The same of all lights that reach a place, whose blocks count as one up to a ratio of radius to distance.
    pub(super) fn view_from(
        &self,
        place: GeoPoint,
        terrain_hides: bool,
        far_block_ratio: f64,
    ) -> Option<SkylineView> {
        let disc = Disc { middle: place.unit_vector(), radius_m: MAX_SOURCE_DISTANCE_M };
        // At least of the usual ratio, so that all that is asked of a place shares its parts.
        let observer = Observer::new(disc.middle, far_block_ratio.max(FAR_BLOCK_RATIO));
        let largest_m = far_block_ratio * MAX_SOURCE_DISTANCE_M;
        self.skyline_view(terrain_hides, || vec![disc], largest_m, Some(&observer))
    }

    /// Whether the skylines of all lights that reach a place are there, or so few are missing that who asks finds what it needs of them
    /// at once, where they are made by tile. A thread begins to make and store those that are missing, nearest first, and goes on
    /// whoever asks.
    ///
    /// * `few`: so many lights.
    ///
    /// # Errors
    /// [`SceneError::SkylinesBeingFound`].
    pub fn find_skylines_around(self: &Arc<Self>, place: GeoPoint, few: usize) -> Result<(), SceneError> {
        let Some(store) = self.skyline_tiles().filter(|store| !store.queue.is_given_up()) else {
            return Ok(());
        };
        let ground = self.tile_ground();
        let here = place.unit_vector();
        let disc = Disc { middle: here, radius_m: MAX_SOURCE_DISTANCE_M };
        let count = |tiles: &[usize]| tiles.iter().map(|tile| lights_of(&ground, *tile).len()).sum::<usize>();
        let wanted = Vec::from_iter(tiles_of(&ground, &[disc]));
        let mut missing = store.missing(&ground, wanted.iter().copied());
        let lights = count(&missing);
        if missing.is_empty() {
            return Ok(());
        }
        let blocks = &ground.pyramid.level(ground.level()).blocks;
        let distance = |tile: &usize| blocks[*tile].direction.distance_squared(here);
        missing.sort_by(|a, b| distance(a).total_cmp(&distance(b)));
        if store.queue.add(missing) {
            let scene = Arc::clone(self);
            std::thread::spawn(move || scene.work_on_skylines());
        }
        if lights <= few {
            return Ok(());
        }
        Err(SceneError::SkylinesBeingFound {
            progress: 1.0 - lights as f64 / count(&wanted) as f64,
            left_s: (lights - few) as f64 / store.queue.lights_per_s(),
        })
    }

    /// Makes the tiles of the queue until it is empty. Where one cannot be made or stored, those who ask make it, and wait.
    fn work_on_skylines(&self) {
        let Some(store) = self.skyline_tiles() else { return };
        let ground = self.tile_ground();
        // In the pool of all, the work of others would wait for that of a tile; and half of the processor is theirs.
        let threads = rayon::current_num_threads().div_ceil(2);
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
        let make = |tile: usize| {
            let start = Instant::now();
            let pool = pool.as_ref().ok()?;
            let made = catch_unwind(AssertUnwindSafe(|| pool.install(|| store.prepare(&ground, tile))));
            made.ok()?.ok()?;
            Some(start.elapsed().as_secs_f64())
        };
        // Who asked first finds the part of its own.
        std::thread::sleep(PAUSE);
        let mut given_s = FIRST_GIVEN_S;
        while let Some(tile) = store.queue.next() {
            while store.is_waited_for() && given_s > 0.0 {
                std::thread::sleep(PAUSE);
                given_s -= PAUSE.as_secs_f64();
            }
            match make(tile) {
                Some(seconds) => {
                    given_s = (1.0 - OWN_PART) / OWN_PART * seconds;
                    store.queue.done(tile, lights_of(&ground, tile).len(), seconds);
                }
                None => store.queue.give_up(),
            }
        }
    }

    /// Whether a map of the whole scene may have its lights hidden, in so many bytes: all skylines are then in memory where they are
    /// made by tile.
    ///
    /// # Errors
    /// [`SceneError::MapTooLarge`].
    pub fn check_skylines_of_all(&self, limit_bytes: u64) -> Result<(), SceneError> {
        let lights = self.metadata.lit_pixels;
        let needed_bytes = lights * size_of::<Skyline>() as u64;
        match self.skyline_tiles() {
            Some(_) if needed_bytes > limit_bytes => {
                let scene = self.metadata.id.to_string();
                Err(SceneError::MapTooLarge { scene, lights, needed_bytes, limit_bytes })
            }
            _ => Ok(()),
        }
    }

    /// Makes the skylines of all lights that reach places within bounds, where they are made by tile and are not stored yet; without
    /// bounds all. In other scenes there is nothing to do.
    ///
    /// * `bounds`: west, south, east, north, degrees; west of east beyond the antimeridian.
    /// * `progress`: is told of lights, done and in all.
    ///
    /// # Errors
    /// [`SceneError::Io`] where a tile cannot be stored.
    pub fn prepare_skylines(
        &self,
        bounds: Option<[f64; 4]>,
        progress: &mut dyn FnMut(u64, u64),
    ) -> Result<Prepared, SceneError> {
        let (Some(store), ground) = (self.skyline_tiles(), self.tile_ground()) else {
            return Ok(Prepared::default());
        };
        let tiles =
            tiles_within(&ground, bounds.unwrap_or([-180.0, -90.0, 180.0, 90.0]), MAX_SOURCE_DISTANCE_M);
        let count = |tile: &usize| lights_of(&ground, *tile).len() as u64;
        let total = tiles.iter().map(count).sum();
        let mut prepared = Prepared { tiles: tiles.len() as u64, lights: total, made: 0 };
        let mut done = 0;
        for tile in &tiles {
            progress(done, total);
            prepared.made += u64::from(store.prepare(&ground, *tile)?);
            done += count(tile);
        }
        progress(total, total);
        Ok(prepared)
    }
}
