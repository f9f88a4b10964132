//! The skylines that some places need, of a scene whose skylines are made by tile.

use crate::skyline_part::Observer;
use crate::skyline_tiles::{SkylineTile, SkylineTiles, TileGround};
use crate::skylines::{Skyline, Skylines, mean};
use glam::DVec3;
use skyglow_physics::EARTH_RADIUS_M;
use std::collections::{BTreeSet, HashMap};
use std::sync::Arc;

/// Lights within a distance of a place.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Disc {
    /// Its middle, as a unit vector.
    pub(crate) middle: DVec3,
    pub(crate) radius_m: f64,
}

/// The skylines of all lights of some discs, and of their blocks up to a size.
#[derive(Debug)]
pub(crate) struct SkylineView {
    /// By block.
    tiles: Vec<Arc<SkylineTile>>,
    /// The level of their blocks.
    level: usize,
    /// Index of the first light, or block, of each tile, by level.
    first: Vec<Vec<usize>>,
    /// Skylines of blocks above tiles, by level and index, in `above`.
    at: HashMap<(usize, usize), usize>,
    above: Skylines,
    /// Of a block that is too large to count as one: it is no open sky, and nothing else is said of it.
    unknown: Skylines,
}

impl SkylineView {
    /// * `largest_m`: no block of a larger radius counts as one.
    /// * `observer`: who looks at the lights, where it is one alone.
    ///
    /// Makes the tiles that are not there yet, at some tenths of a millisecond of a core a light, for one observer a fifteenth of it.
    pub(crate) fn new(
        store: &SkylineTiles,
        ground: &TileGround<'_>,
        discs: &[Disc],
        largest_m: f64,
        observer: Option<&Observer>,
    ) -> Self {
        let level = ground.level();
        let (wanted, above_tiles) = needed(ground, discs, largest_m);
        let wanted = Vec::from_iter(wanted);
        let tiles = store.tiles(ground, &wanted, observer);
        let first = (0..=level).map(|level| tiles.iter().map(|tile| tile.first(level)).collect()).collect();
        let mut unknown = Skylines::default();
        unknown.push(&[[u8::MAX; _]; _]);
        let mut view = Self { tiles, level, first, at: HashMap::new(), above: Skylines::default(), unknown };
        // From below, so that a block's children are known before it.
        for (level, index) in above_tiles {
            let known =
                |child: usize| view.find(level - 1, child).map(|(skylines, index)| skylines.skyline(index));
            let flux_dnb_w = |child: usize| ground.flux_dnb_w(level - 1, child);
            let skyline: Skyline = mean(ground.pyramid.level(level).children(index), known, flux_dnb_w);
            view.at.insert((level, index), view.at.len());
            view.above.push(&skyline);
        }
        view
    }

    /// Whether terrain hides any of the lights.
    pub(crate) fn is_blocked(&self) -> bool {
        self.tiles.iter().any(|tile| tile.is_blocked())
    }

    /// The skylines that those of a block, of a light at level 0, are among, and its index there; None where it is under an open sky.
    #[inline]
    pub(crate) fn find(&self, level: usize, index: usize) -> Option<(&Skylines, usize)> {
        let (skylines, index) = if level > self.level {
            match self.at.get(&(level, index)) {
                Some(&at) => (&self.above, at),
                None => (&self.unknown, 0),
            }
        } else {
            let first = &self.first[level];
            let tile = first.partition_point(|first| *first <= index).checked_sub(1)?;
            (self.tiles[tile].skylines(level), index - first[tile])
        };
        (!skylines.is_open(index)).then_some((skylines, index))
    }
}

/// The tiles of the lights of some discs.
pub(crate) fn tiles_of(ground: &TileGround<'_>, discs: &[Disc]) -> BTreeSet<usize> {
    needed(ground, discs, 0.0).0
}

/// The tiles of the lights of some discs, and the blocks above tiles that may count as one, by level and index.
fn needed(
    ground: &TileGround<'_>,
    discs: &[Disc],
    largest_m: f64,
) -> (BTreeSet<usize>, BTreeSet<(usize, usize)>) {
    let (mut tiles, mut above) = (BTreeSet::new(), BTreeSet::new());
    let pyramid = &ground.pyramid;
    let mut open: Vec<(usize, usize, bool)> = Vec::new();
    if pyramid.top() > 0 {
        open.push((pyramid.top(), 0, false));
    }
    while let Some((level, index, is_whole)) = open.pop() {
        let block = &pyramid.level(level).blocks[index];
        // Chords are shorter than arcs: a little more is taken than is within reach.
        let is_near = |disc: &Disc| {
            EARTH_RADIUS_M * disc.middle.distance(block.direction) <= disc.radius_m + block.radius_m + 1.0
        };
        if !is_whole && !discs.iter().any(is_near) {
            continue;
        }
        if level == ground.level() {
            tiles.insert(index);
            continue;
        }
        let is_whole = is_whole || block.radius_m <= largest_m;
        if is_whole {
            above.insert((level, index));
        }
        let children = pyramid.level(level).children(index);
        open.extend(children.map(|index| (level - 1, index, is_whole)));
    }
    (tiles, above)
}
