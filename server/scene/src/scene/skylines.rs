//! Skylines of a scene that are made by tile: those that a query needs, and making them beforehand.

use super::Scene;
use crate::error::SceneError;
use crate::skyline_tiles::{SkylineTiles, TileGround, lights_of, tiles_within};
use crate::skyline_view::{Disc, SkylineView};
use serde::Serialize;
use skyglow_physics::GeoPoint;
use skyglow_physics::source_pixel::MAX_SOURCE_DISTANCE_M;

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
    pub(super) fn skyline_view(
        &self,
        terrain_hides: bool,
        discs: impl FnOnce() -> Vec<Disc>,
        largest_m: f64,
    ) -> Option<SkylineView> {
        let tiles = self.skyline_tiles().filter(|_| terrain_hides)?;
        Some(SkylineView::new(tiles, &self.tile_ground(), &discs(), largest_m))
    }

    /// The same of all lights that reach a place, whose blocks count as one up to a ratio of radius to distance.
    pub(super) fn view_from(
        &self,
        place: GeoPoint,
        terrain_hides: bool,
        far_block_ratio: f64,
    ) -> Option<SkylineView> {
        let disc = Disc { middle: place.unit_vector(), radius_m: MAX_SOURCE_DISTANCE_M };
        self.skyline_view(terrain_hides, || vec![disc], far_block_ratio * MAX_SOURCE_DISTANCE_M)
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
