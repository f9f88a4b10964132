//! Between what the lights of blocks have: lights side by side in a polar grid's list are side by side on the ground.

use rayon::prelude::*;
use skyglow_scene::NearLight;

/// Lights of a block.
pub(crate) const BLOCK: usize = 64;
/// Blocks whose extents a task finds.
const BLOCKS_PER_TASK: usize = 256;

/// What an extent is over: radians, metres, metres, DNB watts.
pub(crate) const AZIMUTH: usize = 0;
pub(crate) const DISTANCE: usize = 1;
pub(crate) const ALTITUDE: usize = 2;
pub(crate) const FLUX: usize = 3;

/// The least and the most of each that a block's lights have.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Extent {
    pub least: [f32; 4],
    pub most: [f32; 4],
}

impl Extent {
    fn of(lights: &[NearLight]) -> Self {
        let (mut least, mut most) = ([f32::INFINITY; 4], [f32::NEG_INFINITY; 4]);
        for light in lights {
            let values = [light.azimuth_rad, light.distance_m, light.altitude_m, light.flux_dnb_w];
            for axis in 0..4 {
                least[axis] = if values[axis] < least[axis] { values[axis] } else { least[axis] };
                most[axis] = if values[axis] > most[axis] { values[axis] } else { most[axis] };
            }
        }
        Self { least, most }
    }
}

/// The extents of all blocks, the last of which may have fewer lights.
pub(crate) fn extents(lights: &[NearLight]) -> Vec<Extent> {
    let tasks = lights.par_chunks(BLOCK * BLOCKS_PER_TASK);
    tasks.flat_map_iter(|lights| lights.chunks(BLOCK).map(Extent::of)).collect()
}
