//! The skylines of a tile: of the lights of a block of the light pyramid, and of the blocks within it.

use crate::grid::Grid;
use crate::light_pyramid::LightPyramid;
use crate::lit_pixels::LitPixels;
use crate::skylines::Skylines;
use crate::terrain::Terrain;

/// Level of the blocks that are tiles, or the highest where that is lower.
const TILE_LEVEL: usize = 7;

/// What skylines are made of.
#[derive(Clone, Copy)]
pub(crate) struct TileGround<'a> {
    pub(crate) grid: &'a Grid,
    pub(crate) terrain: &'a Terrain,
    pub(crate) pixels: &'a LitPixels,
    pub(crate) pyramid: &'a LightPyramid,
    pub(crate) calibration: f64,
}

impl TileGround<'_> {
    /// The level of tiles.
    pub(crate) fn level(&self) -> usize {
        TILE_LEVEL.min(self.pyramid.top())
    }

    /// Upward flux of a block, of a pixel at level 0, DNB watts.
    pub(crate) fn flux_dnb_w(&self, level: usize, index: usize) -> f64 {
        match level {
            0 => self.pixels.flux_dnb_w(self.grid, self.calibration, index),
            level => self.pyramid.level(level).blocks[index].flux_dnb_w,
        }
    }
}

/// The skylines of a tile.
#[derive(Debug)]
pub(crate) struct SkylineTile {
    /// Of its lights, then of its blocks of each level up to itself: the index of the first, and the skylines.
    levels: Vec<(usize, Skylines)>,
}

impl SkylineTile {
    /// From the skylines of its lights.
    pub(crate) fn new(ground: &TileGround<'_>, tile: usize, of_lights: Skylines) -> Self {
        let pyramid = &ground.pyramid;
        let mut levels = vec![(pyramid.pixels(ground.level(), tile).start, of_lights)];
        for number in 1..=ground.level() {
            let blocks = pyramid.blocks_within(ground.level(), tile, number);
            let (first_child, below) = &levels[number - 1];
            let children = |block: usize| {
                let children = pyramid.level(number).children(blocks.start + block);
                children.start - first_child..children.end - first_child
            };
            let flux_dnb_w = |child: usize| ground.flux_dnb_w(number - 1, first_child + child);
            let above = below.of_blocks(blocks.len(), children, flux_dnb_w);
            levels.push((blocks.start, above));
        }
        Self { levels }
    }

    /// Index of the first light, or block, of a level.
    pub(crate) fn first(&self, level: usize) -> usize {
        self.levels[level].0
    }

    /// The skylines of its lights, or blocks, of a level.
    pub(crate) fn skylines(&self, level: usize) -> &Skylines {
        &self.levels[level].1
    }

    /// Whether terrain hides any of its lights.
    pub(crate) fn is_blocked(&self) -> bool {
        self.levels[0].1.blocked_count() > 0
    }

    pub(crate) fn byte_count(&self) -> usize {
        self.levels.iter().map(|(_, skylines)| skylines.byte_count()).sum()
    }
}
