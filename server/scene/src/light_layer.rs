//! Layers of lights, one for each fixture. A scene as it was ingested has one layer; a changed scene shares that layer,
//! knows which of its lights are removed, and has layers of its own for those that were changed or are new.

use crate::grid::Grid;
use crate::light_pyramid::{Block, LightPyramid};
use crate::light_tree::{LightSkylines, LightTree};
use crate::lit_pixels::LitPixels;
use crate::memory::LightCount;
use crate::morton;
use crate::removed_lights::RemovedLights;
use crate::skyline_tiles::{MAX_KEPT_BYTES, SkylineTiles, TileGround};
use crate::skyline_view::SkylineView;
use crate::skylines::{Skyline, Skylines};
use crate::terrain::Terrain;
use skyglow_physics::Fixture;
use std::sync::Arc;

/// Lit pixels with what was made of them.
#[derive(Clone, Debug, Default)]
pub(crate) struct Lights {
    pub(crate) pixels: LitPixels,
    /// The skyline of each lit pixel; None without terrain, for scenes of format 1, and where they are made by tile.
    pub(crate) skylines: Option<Skylines>,
    /// Skylines that are made by tile when they are needed.
    pub(crate) tiles: Option<Arc<SkylineTiles>>,
    pub(crate) pyramid: LightPyramid,
    /// The lowest and the highest altitude of the pixels, metres; None without light.
    pub(crate) altitude_range_m: Option<[f32; 2]>,
}

impl Lights {
    /// Bytes of memory that they take, about.
    pub(crate) fn byte_count(&self) -> u64 {
        let skylines = self.skylines.as_ref().map_or(0, |skylines| skylines.blocked_count() as u64);
        let blocks = self.pyramid.levels().iter().map(|level| level.blocks.len() as u64).sum();
        let of = |skylines: u64| LightCount { lit: self.pixels.len() as u64, blocks, skylines }.scene_bytes();
        let of_tiles = match self.tiles {
            Some(_) => (MAX_KEPT_BYTES as u64).min(of(self.pixels.len() as u64) - of(0)),
            None => 0,
        };
        // What is in a file the system can have back.
        let of_lights = if self.pixels.codes.is_in_file() { 0 } else { of(skylines) };
        of_lights + of_tiles
    }

    /// What their skylines are made of.
    pub(crate) fn tile_ground<'a>(
        &'a self,
        grid: &'a Grid,
        terrain: &'a Terrain,
        calibration: f64,
    ) -> TileGround<'a> {
        TileGround { grid, terrain, pixels: &self.pixels, pyramid: &self.pyramid, calibration }
    }

    /// Whether it is known, or can be found, what terrain hides of each light.
    pub(crate) fn knows_skylines(&self) -> bool {
        self.skylines.is_some() || self.tiles.is_some()
    }

    /// Builds the pyramid.
    pub(crate) fn new(grid: &Grid, pixels: LitPixels, skylines: Option<Skylines>, calibration: f64) -> Self {
        let pyramid = LightPyramid::build(grid, &pixels, skylines.as_ref(), calibration);
        let altitude_range_m = pixels.altitude_range_m();
        Self { pixels, skylines, tiles: None, pyramid, altitude_range_m }
    }

    /// The same with skylines that are made by tile.
    pub(crate) fn with_tiles(self, tiles: SkylineTiles) -> Self {
        Self { tiles: Some(Arc::new(tiles)), ..self }
    }
}

/// Something made of the layers of each kind of fixture, in the order in which the kinds come first.
pub(crate) fn by_fixture<'a, T>(
    layers: &'a [LightLayer],
    make: impl Fn(&[&'a LightLayer]) -> T,
) -> Vec<(Fixture, T)> {
    let mut kinds: Vec<(Fixture, Vec<&LightLayer>)> = Vec::new();
    for layer in layers {
        match kinds.iter_mut().find(|(fixture, _)| *fixture == layer.fixture) {
            Some((_, layers)) => layers.push(layer),
            None => kinds.push((layer.fixture.clone(), vec![layer])),
        }
    }
    kinds.into_iter().map(|(fixture, layers)| (fixture, make(&layers))).collect()
}

/// Lights of one fixture.
#[derive(Clone, Debug)]
pub(crate) struct LightLayer {
    pub(crate) lights: Arc<Lights>,
    /// Number of the first of them in the scene.
    pub(crate) first_number: u32,
    /// Removed ones; None where there are none.
    pub(crate) removed: Option<Arc<RemovedLights>>,
    pub(crate) fixture: Fixture,
}

impl LightLayer {
    /// All lights of a scene as it was ingested.
    pub(crate) fn whole(lights: Lights) -> Self {
        Self { lights: Arc::new(lights), first_number: 0, removed: None, fixture: Fixture::default() }
    }

    /// The layer for walking through it, under an open sky.
    pub(crate) fn open_light<'a>(&'a self, grid: &'a Grid, calibration: f64) -> LightTree<'a> {
        self.light(grid, calibration, None)
    }

    /// The layer for walking through it.
    ///
    /// * `hides`: None where nothing hides light; else the skylines that are needed, where they are made by tile.
    pub(crate) fn light<'a>(
        &'a self,
        grid: &'a Grid,
        calibration: f64,
        hides: Option<Option<&'a SkylineView>>,
    ) -> LightTree<'a> {
        let whole = self.lights.skylines.as_ref().filter(|skylines| skylines.blocked_count() > 0);
        let view = hides.flatten().filter(|view| self.lights.tiles.is_some() && view.is_blocked());
        let skylines = whole.map(LightSkylines::Whole).or(view.map(LightSkylines::View));
        LightTree {
            grid,
            pixels: &self.lights.pixels,
            pyramid: &self.lights.pyramid,
            calibration,
            skylines: skylines.filter(|_| hides.is_some()),
            removed: self.removed.as_deref(),
            first_number: self.first_number,
        }
    }

    /// Bytes in addition to the raster's own lights, about.
    pub(crate) fn unshared_bytes(&self) -> usize {
        let (pixels, removed) =
            (self.lights.pixels.len(), self.removed.as_ref().map_or(0, |removed| removed.byte_count()));
        // Blocks are a third of the pixels; a skyline is for those that have one.
        let of_skylines = |skylines: &Skylines| skylines.blocked_count() * 2 * size_of::<Skyline>();
        let of_lights = pixels * (24 + size_of::<Block>() / 2);
        let is_shared = self.first_number == 0;
        removed + if is_shared { 0 } else { of_lights + self.lights.skylines.as_ref().map_or(0, of_skylines) }
    }

    /// Number of its lights that are not removed.
    pub(crate) fn len(&self) -> usize {
        self.lights.pixels.len() - self.removed.as_ref().map_or(0, |removed| removed.len())
    }

    /// Its light at a pixel, nW cm⁻² sr⁻¹.
    pub(crate) fn radiance_at(&self, column: u32, row: u32) -> Option<f32> {
        let index = self.lights.pixels.index_at(column, row)?;
        let is_removed = self.removed.as_ref().is_some_and(|removed| removed.is_removed(index));
        (!is_removed).then(|| self.lights.pixels.radiance_nw_cm2_sr[index])
    }

    /// Sum of radiances in the block of 2^level × 2^level pixels at block coordinates, nW cm⁻² sr⁻¹.
    pub(crate) fn radiance_sum_nw_cm2_sr(&self, level: u32, column: u32, row: u32) -> f64 {
        if level == 0 {
            return self.radiance_at(column, row).map_or(0.0, f64::from);
        }
        let (pyramid, top) = (&self.lights.pyramid, self.lights.pyramid.top());
        if top == 0 {
            return 0.0;
        }
        let (level, code) = (level as usize, morton::encode(column, row));
        if level > top {
            // The one block at the top lies in one of the requested level.
            let holds_all = pyramid.level(top).codes[0] >> (2 * (level - top)) == code;
            return if holds_all { self.sum_in_block(top, 0) } else { 0.0 };
        }
        let index = pyramid.level(level).codes.binary_search(&code).ok();
        index.map_or(0.0, |index| self.sum_in_block(level, index))
    }

    fn sum_in_block(&self, level: usize, index: usize) -> f64 {
        let blocks = self.lights.pyramid.level(level);
        let Some(removed) = self.removed.as_ref().filter(|removed| removed.is_touched(level, index)) else {
            return blocks.blocks[index].radiance_sum_nw_cm2_sr;
        };
        if removed.is_empty_block(level, index) {
            return 0.0;
        }
        let radiance = &self.lights.pixels.radiance_nw_cm2_sr;
        let children = blocks.children(index);
        if level > 1 {
            return children.map(|child| self.sum_in_block(level - 1, child)).sum();
        }
        children.filter(|&child| !removed.is_removed(child)).map(|child| f64::from(radiance[child])).sum()
    }
}
