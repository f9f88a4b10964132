//! The source tree: a linear quadtree (Gargantini 1982) of lit pixels by Morton code. Each block of 2^k × 2^k pixels has their
//! flux, its centroid, their mean altitude and their mean skyline. Built when a scene is opened.

use crate::array::Array;
use crate::grid::Grid;
use crate::lit_pixels::LitPixels;
use crate::morton;
use crate::skylines::Skylines;
use glam::DVec3;
use skyglow_physics::EARTH_RADIUS_M;
use std::ops::Range;

/// A block that holds at least one lit pixel.
#[derive(Clone, Copy, Debug, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
pub(crate) struct Block {
    /// Flux-weighted mean of the pixel centres, as a unit vector.
    pub(crate) direction: DVec3,
    /// Flux of all pixels, DNB watts, calibration included.
    pub(crate) flux_dnb_w: f64,
    /// Flux-weighted mean altitude, metres.
    pub(crate) altitude_m: f64,
    /// No pixel centre of the block lies farther than this from `direction`, metres along the chord.
    pub(crate) radius_m: f64,
    /// Sum of the pixels' radiances, nW cm⁻² sr⁻¹.
    pub(crate) radiance_sum_nw_cm2_sr: f64,
    /// Index of the first child in the level below (pixels below level 1); the next block's is the end.
    pub(crate) first_child: u32,
    unused: u32,
}

/// The blocks of one level, ascending by Morton code.
#[derive(Clone, Debug, Default)]
pub(crate) struct Level {
    /// Pixels' code shifted right by 2·level.
    pub(crate) codes: Array<u64>,
    /// The blocks, in parallel with the codes.
    pub(crate) blocks: Array<Block>,
    /// The blocks' skylines; None where those of the pixels are not known.
    pub(crate) skylines: Option<Skylines>,
    /// Number of blocks (pixels) in the level below.
    child_count: u32,
}

impl Level {
    /// The children of block `index`, as a range in the level below.
    pub(crate) fn children(&self, index: usize) -> Range<usize> {
        let end = self.blocks.get(index + 1).map_or(self.child_count, |next| next.first_child);
        self.blocks[index].first_child as usize..end as usize
    }

    /// Its skylines from those of its children, weighted by their flux.
    fn mean_skylines(&self, below: &Skylines, flux_dnb_w: impl Fn(usize) -> f64 + Sync) -> Skylines {
        below.of_blocks(self.blocks.len(), |block| self.children(block), flux_dnb_w)
    }
}

/// Levels 1, 2 … up to the one with a single block.
#[derive(Clone, Debug, Default)]
pub(crate) struct LightPyramid {
    levels: Vec<Level>,
}

/// A child while its block is summed.
struct Child {
    direction: DVec3,
    flux_dnb_w: f64,
    altitude_m: f64,
    radius_m: f64,
    radiance_sum_nw_cm2_sr: f64,
}

impl LightPyramid {
    /// Sums up `pixels` with their skylines, where those are known.
    pub(crate) fn build(
        grid: &Grid,
        pixels: &LitPixels,
        skylines: Option<&Skylines>,
        calibration: f64,
    ) -> Self {
        let pixel = |index: usize| {
            let (column, row) = morton::decode(pixels.codes[index]);
            Child {
                direction: grid.center(column, row),
                flux_dnb_w: pixels.flux_dnb_w(grid, calibration, index),
                altitude_m: f64::from(pixels.altitude_m[index]),
                radius_m: 0.0,
                radiance_sum_nw_cm2_sr: f64::from(pixels.radiance_nw_cm2_sr[index]),
            }
        };
        let mut levels: Vec<Level> = Vec::new();
        if pixels.len() > 0 {
            let mut level = group(&pixels.codes, pixel);
            level.skylines = skylines
                .map(|below| level.mean_skylines(below, |index| pixels.flux_dnb_w(grid, calibration, index)));
            levels.push(level);
        }
        while let Some(below) = levels.last().filter(|level| level.blocks.len() > 1) {
            let block = |index: usize| {
                let b = &below.blocks[index];
                Child {
                    direction: b.direction,
                    flux_dnb_w: b.flux_dnb_w,
                    altitude_m: b.altitude_m,
                    radius_m: b.radius_m,
                    radiance_sum_nw_cm2_sr: b.radiance_sum_nw_cm2_sr,
                }
            };
            let mut above = group(&below.codes, block);
            above.skylines = below
                .skylines
                .as_ref()
                .map(|skylines| above.mean_skylines(skylines, |index| below.blocks[index].flux_dnb_w));
            levels.push(above);
        }
        Self { levels }
    }

    /// Of levels that were stored, from level 1 up, over so many pixels; no skylines are known.
    pub(crate) fn of_levels(levels: Vec<(Array<u64>, Array<Block>)>, pixel_count: usize) -> Self {
        let mut child_count = pixel_count as u32;
        let level = |(codes, blocks): (Array<u64>, Array<Block>)| {
            let below = std::mem::replace(&mut child_count, blocks.len() as u32);
            Level { codes, blocks, skylines: None, child_count: below }
        };
        Self { levels: levels.into_iter().map(level).collect() }
    }

    /// The levels, from level 1 up.
    pub(crate) fn levels(&self) -> &[Level] {
        &self.levels
    }

    /// The number of the highest level; 0 without light.
    pub(crate) fn top(&self) -> usize {
        self.levels.len()
    }

    /// The pixels of a block of level `number`.
    pub(crate) fn pixels(&self, number: usize, index: usize) -> Range<usize> {
        self.levels[..number].iter().rev().fold(index..index + 1, |range, level| {
            level.children(range.start).start..level.children(range.end - 1).end
        })
    }

    /// The blocks of level `below` within a block of level `number`, which is no lower.
    pub(crate) fn blocks_within(&self, number: usize, index: usize, below: usize) -> Range<usize> {
        self.levels[below..number].iter().rev().fold(index..index + 1, |range, level| {
            level.children(range.start).start..level.children(range.end - 1).end
        })
    }

    /// Level `number`, 1..=top.
    pub(crate) fn level(&self, number: usize) -> &Level {
        &self.levels[number - 1]
    }
}

/// Fewer children are not worth waking another thread.
const CHILDREN_PER_THREAD: usize = 1 << 16;

/// Groups the children by code >> 2, on as many threads as there are cores.
fn group(child_codes: &[u64], child: impl Fn(usize) -> Child + Sync) -> Level {
    let threads = std::thread::available_parallelism().map_or(1, usize::from);
    let threads = threads.min(child_codes.len() / CHILDREN_PER_THREAD).max(1);
    // No block is cut in two.
    let cut = |part: usize| match part * child_codes.len() / threads {
        0 => 0,
        even => (even..child_codes.len())
            .find(|&at| child_codes[at] >> 2 != child_codes[at - 1] >> 2)
            .unwrap_or(child_codes.len()),
    };
    let cuts: Vec<usize> = (0..=threads).map(cut).collect();
    let counts: Vec<usize> =
        cuts.windows(2).map(|cuts| block_count(&child_codes[cuts[0]..cuts[1]])).collect();
    let mut level = Level { child_count: child_codes.len() as u32, ..Level::default() };
    // Plain threads: in a pool that steals work somebody who waits for this scene could be taken up by one who opens it.
    std::thread::scope(|scope| {
        let child = &child;
        let of = |part: usize| {
            let range = cuts[part]..cuts[part + 1];
            // The first has room for all: a planet's blocks are gigabytes, and are not to be moved often.
            let room = if part == 0 { counts.iter().sum() } else { counts[part] };
            move || group_part(child_codes, range, room, child)
        };
        let others: Vec<_> = (1..threads).map(|part| scope.spawn(of(part))).collect();
        let (mut codes, mut blocks) = of(0)();
        for (part, worker) in (1..threads).zip(others) {
            // A thread that died left its part undone.
            let (of_part, blocks_of_part) = worker.join().unwrap_or_else(|_| of(part)());
            codes.extend(of_part);
            blocks.extend(blocks_of_part);
        }
        (level.codes, level.blocks) = (codes.into(), blocks.into());
    });
    level
}

/// Blocks of some children.
fn block_count(child_codes: &[u64]) -> usize {
    let ends = child_codes.windows(2).filter(|pair| pair[0] >> 2 != pair[1] >> 2).count();
    ends + usize::from(!child_codes.is_empty())
}

/// The blocks of a range of children, in vectors with room for so many.
fn group_part(
    child_codes: &[u64],
    range: Range<usize>,
    room: usize,
    child: &impl Fn(usize) -> Child,
) -> (Vec<u64>, Vec<Block>) {
    let (mut codes, mut blocks) = (Vec::with_capacity(room), Vec::with_capacity(room));
    let mut start = range.start;
    while start < range.end {
        let code = child_codes[start] >> 2;
        let mut end = start + 1;
        while end < range.end && child_codes[end] >> 2 == code {
            end += 1;
        }
        codes.push(code);
        blocks.push(sum_up(start, (start..end).map(child)));
        start = end;
    }
    (codes, blocks)
}

fn sum_up(first_child: usize, children: impl Iterator<Item = Child> + Clone) -> Block {
    let (mut weighted, mut flux_dnb_w, mut flux_altitude, mut radiance) = (DVec3::ZERO, 0.0, 0.0, 0.0);
    for child in children.clone() {
        weighted += child.direction * child.flux_dnb_w;
        flux_dnb_w += child.flux_dnb_w;
        flux_altitude += child.altitude_m * child.flux_dnb_w;
        radiance += child.radiance_sum_nw_cm2_sr;
    }
    let direction = weighted.normalize();
    let radius_m = children
        .map(|child| EARTH_RADIUS_M * child.direction.distance(direction) + child.radius_m)
        .fold(0.0, f64::max);
    Block {
        direction,
        flux_dnb_w,
        altitude_m: flux_altitude / flux_dnb_w,
        radius_m,
        radiance_sum_nw_cm2_sr: radiance,
        first_child: first_child as u32,
        unused: 0,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Threads cut between blocks: theirs are the blocks of one thread.
    #[test]
    fn threads_make_the_same_blocks() {
        let codes: Vec<u64> = (0..5 * CHILDREN_PER_THREAD as u64 / 2).map(|at| at + at / 3 * 2).collect();
        let child = |index: usize| Child {
            direction: DVec3::new(1.0, index as f64 * 1e-6, 0.0).normalize(),
            flux_dnb_w: 1.0 + (index % 7) as f64,
            altitude_m: (index % 100) as f64,
            radius_m: 0.0,
            radiance_sum_nw_cm2_sr: 1.0,
        };
        let level = group(&codes, child);
        let (alone, blocks) = group_part(&codes, 0..codes.len(), 0, &child);
        assert_eq!(block_count(&codes), alone.len());
        assert_eq!(*level.codes, *alone);
        let bits = |blocks: &[Block]| -> Vec<[u64; 3]> {
            let of = |block: &Block| {
                [u64::from(block.first_child), block.flux_dnb_w.to_bits(), block.radius_m.to_bits()]
            };
            blocks.iter().map(of).collect()
        };
        assert_eq!(bits(&level.blocks), bits(&blocks));
    }
}
