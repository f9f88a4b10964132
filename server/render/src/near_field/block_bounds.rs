//! Bounds of blocks of lights, as of bounding boxes: lights side by side in a polar grid's list are side by side on the ground.

use rayon::prelude::*;
use skyglow_scene::NearLight;

/// Lights of a block.
pub(crate) const BLOCK: usize = 64;
/// Blocks whose bounds a task finds.
const BLOCKS_PER_TASK: usize = 256;

/// What bounds are of: radians, metres, metres, DNB watts.
pub(crate) const AZIMUTH: usize = 0;
pub(crate) const DISTANCE: usize = 1;
pub(crate) const ALTITUDE: usize = 2;
pub(crate) const FLUX: usize = 3;

/// The smallest and the largest of each that a block's lights have.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct BlockBounds {
    pub min: [f32; 4],
    pub max: [f32; 4],
}

impl BlockBounds {
    fn of(lights: &[NearLight]) -> Self {
        let (mut min, mut max) = ([f32::INFINITY; 4], [f32::NEG_INFINITY; 4]);
        for light in lights {
            let values = [light.azimuth_rad, light.distance_m, light.altitude_m, light.flux_dnb_w];
            for axis in 0..4 {
                min[axis] = if values[axis] < min[axis] { values[axis] } else { min[axis] };
                max[axis] = if values[axis] > max[axis] { values[axis] } else { max[axis] };
            }
        }
        Self { min, max }
    }
}

/// The bounds of all blocks, the last of which may have fewer lights.
pub(crate) fn block_bounds(lights: &[NearLight]) -> Vec<BlockBounds> {
    let tasks = lights.par_chunks(BLOCK * BLOCKS_PER_TASK);
    tasks.flat_map_iter(|lights| lights.chunks(BLOCK).map(BlockBounds::of)).collect()
}
