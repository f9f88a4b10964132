//! Barnes–Hut (1986) traversal of the light pyramid for one observer.
//!
//! How light is taken:
//! * pixels whose centre is nearer than 5 km are split by `physics`' own rule;
//! * a block stands for its pixels where all their centres are within [`FAR_BLOCK_RATIO`] (the opening angle) of its distance
//!   from its flux-weighted centre and all lie between 30 km, within which every pixel is taken by itself, and 300 km; it is
//!   opened otherwise;
//! * so a pixel counts exactly when its own centre is within 300 km, as in the reference solution.
//!
//! Light has the blocking angle of its skyline towards the observer: a pixel's pieces that of
//! the pixel's skyline at their own azimuth and distance, a block its own.
//!
//! A block with removed lights is opened, and skipped where all are removed: changed lights are in another
//! layer with a pyramid of its own.
//!
//! Taking a block moves no light by more than that ratio (in radians of azimuth, and relatively in
//! distance), the width of an azimuth column, and leaves the mean position of the block's light where it was:
//! the error is of second order and below that of the splat itself. A block's skyline is the mean of its lights', which
//! differs from the sky of lights behind different ones by 0.001 to 0.22 % in the mean over the sky at ten places of the
//! demo and Kenya (`docs/notebook/2026-11-21.md`).

use crate::grid::Grid;
use crate::light_pyramid::LightPyramid;
use crate::lit_pixels::LitPixels;
use crate::morton;
use crate::polar_grid::{PlacedLight, PolarAccumulator, log_distance};
use crate::removed_lights::RemovedLights;
use crate::skyline_view::SkylineView;
use crate::skylines::Skylines;
use crate::turns::turns_from_light;
use glam::DVec3;
use skyglow_physics::geometry::{Bearing, LocalFrame};
use skyglow_physics::source_pixel::{MAX_SOURCE_DISTANCE_M, SPLIT_WITHIN_M};
use skyglow_physics::{EARTH_RADIUS_M, PointSource, SourcePixel};
use std::{f64::consts::TAU, ops::Range};

/// Largest distance of a pixel from its block's centre, relative to the block's distance from the observer:
/// a quarter of an azimuth column, π/512, so that in the sky next to it a block is as good as a point.
pub const FAR_BLOCK_RATIO: f64 = std::f64::consts::PI / 512.0;

/// Within this of the observer every pixel is taken by itself, metres.
pub const NO_BLOCKS_WITHIN_M: f64 = 30_000.0;

/// A `far_block_ratio` that takes every pixel by itself.
pub(crate) const NO_BLOCKS: f64 = -1.0;

/// Receives gathered light.
pub(crate) trait LightSink {
    /// Takes a point of light of a lit pixel, or of a block of several, by their numbers in the scene. All points of a pixel come one
    /// after the other.
    fn take(&mut self, numbers: Range<u32>, light: PlacedLight);
}

impl LightSink for PolarAccumulator {
    #[inline(always)]
    fn take(&mut self, numbers: Range<u32>, light: PlacedLight) {
        self.add(light);
        self.push_near(numbers, light);
    }
}

/// A block of the pyramid.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct BlockIndex {
    pub(crate) level: usize,
    pub(crate) index: usize,
}

/// A block from which light is gathered.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Subtree {
    pub(crate) from: BlockIndex,
    /// Its pixels.
    pub(crate) pixels: usize,
}

/// Where the skylines of lights and blocks are.
#[derive(Clone, Copy, Debug)]
pub(crate) enum LightSkylines<'a> {
    /// Those of all lights here, of blocks in the pyramid.
    Whole(&'a Skylines),
    /// Those that are needed, made by tile.
    View(&'a SkylineView),
}

/// The lights of a layer, as the functions of this module need them.
#[derive(Clone, Copy)]
pub(crate) struct LightTree<'a> {
    pub(crate) grid: &'a Grid,
    pub(crate) pixels: &'a LitPixels,
    pub(crate) pyramid: &'a LightPyramid,
    pub(crate) calibration: f64,
    /// The skylines; None where nothing hides light, or it is not to.
    pub(crate) skylines: Option<LightSkylines<'a>>,
    /// Removed lights; None where there are none.
    pub(crate) removed: Option<&'a RemovedLights>,
    /// Number of the layer's first light in the scene.
    pub(crate) first_number: u32,
}

/// Chord of an arc, metres.
fn chord_m(arc_m: f64) -> f64 {
    2.0 * EARTH_RADIUS_M * (0.5 * arc_m / EARTH_RADIUS_M).sin()
}

/// The chord within which a traversal searches, metres, with half a metre of slack: chords of centres are compared, arcs decide in the end.
fn reach_m(radius_m: f64) -> f64 {
    chord_m(radius_m.min(std::f64::consts::PI * EARTH_RADIUS_M)) + 0.5
}

/// Bearing of a point known to lie within 300 km: `asin` by its series, exact to 1e-14 there.
fn near_bearing(frame: &LocalFrame, target: DVec3) -> Bearing {
    let (east, north) = (target.dot(frame.east), target.dot(frame.north));
    let square = east * east + north * north;
    let stretch = 1.0
        + square * (1.0 / 6.0 + square * (3.0 / 40.0 + square * (15.0 / 336.0 + square * (105.0 / 3456.0))));
    let azimuth = east.atan2(north);
    Bearing {
        distance_m: EARTH_RADIUS_M * square.sqrt() * stretch,
        azimuth_rad: if azimuth < 0.0 { azimuth + std::f64::consts::TAU } else { azimuth },
    }
}

impl<'a> LightTree<'a> {
    /// The skylines that a block's (a pixel's at level 0) are among, and its index there; None where it is under an open sky.
    #[inline(always)]
    pub(crate) fn skylines_of(&self, level: usize, index: usize) -> Option<(&'a Skylines, usize)> {
        let skylines = match (self.skylines?, level) {
            (LightSkylines::View(view), level) => return view.find(level, index),
            (LightSkylines::Whole(of_pixels), 0) => of_pixels,
            (LightSkylines::Whole(_), level) => self.pyramid.level(level).skylines.as_ref()?,
        };
        (!skylines.is_open(index)).then_some((skylines, index))
    }

    /// Calls `visit` with the index of each pixel of a block whose centre may be within `radius_m` of `place` (a few
    /// more may come), by walking down the blocks that reach into the disc; `take_block` may take a block
    /// whole by returning true.
    fn traverse(
        &self,
        from: BlockIndex,
        place: DVec3,
        radius_m: f64,
        mut take_block: impl FnMut(usize, usize, f64) -> bool,
        mut visit: impl FnMut(usize),
    ) {
        let reach_m = reach_m(radius_m);
        let mut stack = vec![from];
        while let Some(BlockIndex { level, index }) = stack.pop() {
            let blocks = self.pyramid.level(level);
            let block = &blocks.blocks[index];
            let distance_m = EARTH_RADIUS_M * block.direction.distance(place);
            let touched = self.removed.filter(|removed| removed.is_touched(level, index));
            if distance_m - block.radius_m > reach_m
                || touched.is_some_and(|removed| removed.is_empty_block(level, index))
                || touched.is_none() && take_block(level, index, distance_m)
            {
                continue;
            }
            for child in blocks.children(index) {
                if level > 1 {
                    stack.push(BlockIndex { level: level - 1, index: child });
                } else if touched.is_none_or(|removed| !removed.is_removed(child)) {
                    visit(child);
                }
            }
        }
    }

    /// The block of all lights; None where there are none.
    pub(crate) fn root(&self) -> Option<BlockIndex> {
        let level = self.pyramid.top();
        (level > 0).then_some(BlockIndex { level, index: 0 })
    }

    /// The blocks of at most `max_pixels` pixels within 300 km of the observer that hold all light there, in the order in which it is
    /// gathered; larger ones where all their light counts as one.
    pub(crate) fn subtrees(&self, frame: &LocalFrame, max_pixels: usize) -> Vec<Subtree> {
        let mut subtrees = Vec::new();
        let reach_m = reach_m(MAX_SOURCE_DISTANCE_M);
        let mut stack = Vec::from_iter(self.root());
        while let Some(from) = stack.pop() {
            let BlockIndex { level, index } = from;
            let blocks = self.pyramid.level(level);
            let block = &blocks.blocks[index];
            let distance_m = EARTH_RADIUS_M * block.direction.distance(frame.up);
            if distance_m - block.radius_m > reach_m {
                continue;
            }
            let pixels = self.pyramid.pixels(level, index).len();
            if pixels <= max_pixels || level == 1 || block.radius_m <= FAR_BLOCK_RATIO * distance_m {
                subtrees.push(Subtree { from, pixels });
            } else {
                let children = blocks.children(index);
                stack.extend(children.map(|index| BlockIndex { level: level - 1, index }));
            }
        }
        subtrees
    }

    /// Adds all light within 300 km of the observer to `sink`. `far_block_ratio` 0 opens every block of more than one place,
    /// [`NO_BLOCKS`] every one.
    pub(crate) fn gather(&self, frame: &LocalFrame, far_block_ratio: f64, sink: &mut impl LightSink) {
        if let Some(root) = self.root() {
            self.gather_block(root, frame, far_block_ratio, sink);
        }
    }

    /// [`Self::gather`] of the light of one block.
    pub(crate) fn gather_block(
        &self,
        from: BlockIndex,
        frame: &LocalFrame,
        far_block_ratio: f64,
        sink: &mut impl LightSink,
    ) {
        let (nearest_m, farthest_m) =
            (chord_m(NO_BLOCKS_WITHIN_M) + 1.0, chord_m(MAX_SOURCE_DISTANCE_M) - 1.0);
        let shared = std::cell::RefCell::new(sink);
        let take_block = |number: usize, index: usize, distance_m: f64| {
            let level = self.pyramid.level(number);
            let block = &level.blocks[index];
            let taken = block.radius_m <= far_block_ratio * distance_m
                && distance_m - block.radius_m > nearest_m
                && distance_m + block.radius_m < farthest_m;
            if taken {
                let bearing = near_bearing(frame, block.direction);
                let log_distance = log_distance(bearing.distance_m);
                let blocking = self.skylines_of(number, index).map_or(0.0, |(skylines, index)| {
                    skylines.blocking(index, turns_from_light(block.direction, frame.up), log_distance)
                });
                let azimuth_rad = bearing.azimuth_rad;
                let (altitude_m, flux_dnb_w) = (block.altitude_m, block.flux_dnb_w);
                let light = PlacedLight { azimuth_rad, log_distance, altitude_m, blocking, flux_dnb_w };
                let pixels = self.pyramid.pixels(number, index);
                let numbers = pixels.start as u32..pixels.end as u32;
                shared
                    .borrow_mut()
                    .take(self.first_number + numbers.start..self.first_number + numbers.end, light);
            }
            taken
        };
        let visit = |index: usize| {
            let (column, row) = morton::decode(self.pixels.codes[index]);
            let center = self.grid.center(column, row);
            let bearing = near_bearing(frame, center);
            if bearing.distance_m > MAX_SOURCE_DISTANCE_M || center.dot(frame.up) <= 0.0 {
                return;
            }
            let mut sink = shared.borrow_mut();
            let number = self.first_number + index as u32;
            let numbers = number..number + 1;
            let skylines = self.skylines_of(0, index);
            if bearing.distance_m < SPLIT_WITHIN_M + 1.0 {
                let pixel = self.pixels.source_pixel(self.grid, self.calibration, index);
                // Meridians of the pixel's pieces are parallel, so its centre's share of the turn is theirs.
                let back = turns_from_light(center, frame.up) - bearing.azimuth_rad / TAU;
                pixel.for_each_point_source(frame, &mut |s| {
                    let log_distance = log_distance(s.distance_m);
                    let blocking = skylines.map_or(0.0, |(skylines, index)| {
                        skylines.blocking(index, (back + s.azimuth_rad / TAU).rem_euclid(1.0), log_distance)
                    });
                    let PointSource { azimuth_rad, altitude_m, flux_dnb_w, .. } = s;
                    let light = PlacedLight { azimuth_rad, log_distance, altitude_m, blocking, flux_dnb_w };
                    sink.take(numbers.clone(), light);
                });
            } else {
                let flux_dnb_w = self.pixels.flux_dnb_w(self.grid, self.calibration, index);
                let altitude_m = f64::from(self.pixels.altitude_m[index]);
                let log_distance = log_distance(bearing.distance_m);
                let blocking = skylines.map_or(0.0, |(skylines, index)| {
                    skylines.blocking(index, turns_from_light(center, frame.up), log_distance)
                });
                let azimuth_rad = bearing.azimuth_rad;
                let light = PlacedLight { azimuth_rad, log_distance, altitude_m, blocking, flux_dnb_w };
                sink.take(numbers, light);
            }
        };
        self.traverse(from, frame.up, MAX_SOURCE_DISTANCE_M, take_block, visit);
    }

    /// Calls `visit` with index and centre of every light whose centre may be within `radius_m` of a place; a few more may come.
    pub(crate) fn for_each_near(&self, place: DVec3, radius_m: f64, mut visit: impl FnMut(usize, DVec3)) {
        let visit = |index: usize| {
            let (column, row) = morton::decode(self.pixels.codes[index]);
            visit(index, self.grid.center(column, row));
        };
        if let Some(root) = self.root() {
            self.traverse(root, place, radius_m, |_, _, _| false, visit);
        }
    }

    /// Every lit pixel whose centre is within `radius_m` of the observer, in the raster's Morton order.
    pub(crate) fn pixels_within(&self, frame: &LocalFrame, radius_m: f64) -> Vec<SourcePixel> {
        let mut found = Vec::new();
        if let Some(root) = self.root() {
            self.traverse(root, frame.up, radius_m, |_, _, _| false, |index| found.push(index));
        }
        found.sort_unstable();
        let pixels = found.into_iter().map(|i| self.pixels.source_pixel(self.grid, self.calibration, i));
        pixels.filter(|pixel| frame.bearing_to(pixel.center()).distance_m <= radius_m).collect()
    }
}
