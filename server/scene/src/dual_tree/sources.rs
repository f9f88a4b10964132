//! The source trees: blocks of lights of the light pyramids, each as one cluster at its flux-weighted centre.

use crate::grid::Grid;
use crate::light_tree::LightTree;
use crate::morton;
use crate::place_kernel::{PlaceKernel, RingPosition};
use glam::{DVec3, Vec2};
use skyglow_physics::source_pixel::SPLIT_WITHIN_M;

/// A block of lights (a pixel at level 0) of a layer.
#[derive(Clone, Copy, Debug)]
pub(super) struct Candidate {
    pub(super) layer: u32,
    pub(super) level: u32,
    pub(super) index: u32,
}

/// A block of lights as one point.
#[derive(Clone, Copy, Debug)]
pub(super) struct Cluster {
    pub(super) direction: DVec3,
    pub(super) flux_dnb_w: f64,
    pub(super) altitude_m: f64,
    pub(super) radius_m: f64,
}

/// The layers of lights of a scene, each with the kernel of its fixture.
#[derive(Clone, Copy)]
pub(crate) struct Sources<'a> {
    pub(crate) grid: &'a Grid,
    pub(crate) layers: &'a [(LightTree<'a>, &'a PlaceKernel)],
    pub(crate) sum: SumOf,
}

/// What is summed over the lights.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum SumOf {
    /// What they do to a place.
    All,
    /// What their skylines take from it: at most 0. A small part of the whole, it may be less exact.
    Hidden,
}

impl SumOf {
    /// Largest radius (half-diagonal) of a patch relative to the distance of lights whose sum is interpolated over it.
    pub(super) fn far_ground_ratio(self) -> f64 {
        match self {
            Self::All => 0.22,
            Self::Hidden => 0.4,
        }
    }

    /// Opening ratio: largest radius of a cluster relative to the distance of the ground to which it stands for its lights.
    pub(super) fn far_light_ratio(self) -> f64 {
        match self {
            Self::All => 0.06,
            Self::Hidden => 0.15,
        }
    }

    /// Nearer than this every pixel stands for itself, metres.
    pub(super) fn pixels_within_m(self) -> f64 {
        match self {
            Self::All => SPLIT_WITHIN_M,
            Self::Hidden => 0.5 * SPLIT_WITHIN_M,
        }
    }

    /// Nearer than this a pixel is the mean over its ground, metres.
    pub(super) fn split_within_m(self) -> f64 {
        match self {
            Self::All => SPLIT_WITHIN_M,
            Self::Hidden => 0.2 * SPLIT_WITHIN_M,
        }
    }

    /// The kernel at a node of the axis of altitudes, as [`PlaceKernel::at`] has it, or what a skyline takes from it.
    #[inline(always)]
    pub(super) fn at(
        self,
        kernel: &PlaceKernel,
        altitude: usize,
        ring: RingPosition,
        offset_m: f32,
        blocking: f32,
        towards: Vec2,
    ) -> f32 {
        match self {
            Self::All => kernel.at(altitude, ring, offset_m, blocking, towards),
            Self::Hidden => kernel.hidden(altitude, ring, offset_m, blocking, towards),
        }
    }
}

impl<'a> Sources<'a> {
    /// Whether no sum is below 0: azimuths may weigh lights with either sign, and what is hidden is taken away.
    pub(super) fn is_positive(&self) -> bool {
        self.sum == SumOf::All && !self.layers.iter().any(|(_, kernel)| kernel.knows_azimuth())
    }

    /// The block of all lights of each layer.
    pub(super) fn roots(&self) -> Vec<Candidate> {
        let tops = self.layers.iter().map(|(light, _)| light.pyramid.top() as u32);
        let roots = (0u32..).zip(tops).filter(|(_, top)| *top > 0);
        roots.map(|(layer, level)| Candidate { layer, level, index: 0 }).collect()
    }

    pub(super) fn layer(&self, candidate: Candidate) -> (&'a LightTree<'a>, &'a PlaceKernel) {
        let (light, kernel) = &self.layers[candidate.layer as usize];
        (light, kernel)
    }

    /// Whether a block has lost some of its lights.
    pub(super) fn is_touched(&self, Candidate { layer, level, index }: Candidate) -> bool {
        let removed = self.layers[layer as usize].0.removed;
        level > 0 && removed.is_some_and(|removed| removed.is_touched(level as usize, index as usize))
    }

    /// Whether a block has no lights that count any more.
    pub(super) fn is_removed(&self, Candidate { layer, level, index }: Candidate) -> bool {
        let light = &self.layers[layer as usize].0;
        if self.sum == SumOf::Hidden && light.skylines_of(level as usize, index as usize).is_none() {
            return true;
        }
        self.layers[layer as usize].0.removed.is_some_and(|removed| match level {
            0 => removed.is_removed(index as usize),
            level => removed.is_empty_block(level as usize, index as usize),
        })
    }

    pub(super) fn children(
        &self,
        Candidate { layer, level, index }: Candidate,
    ) -> impl Iterator<Item = Candidate> + use<> {
        let children = self.layers[layer as usize].0.pyramid.level(level as usize).children(index as usize);
        children.map(move |child| Candidate { layer, level: level - 1, index: child as u32 })
    }

    pub(super) fn cluster(&self, Candidate { layer, level, index }: Candidate) -> Cluster {
        let light = &self.layers[layer as usize].0;
        let index = index as usize;
        if level > 0 {
            let block = &light.pyramid.level(level as usize).blocks[index];
            return Cluster {
                direction: block.direction,
                flux_dnb_w: block.flux_dnb_w,
                altitude_m: block.altitude_m,
                radius_m: block.radius_m,
            };
        }
        let (column, row) = morton::decode(light.pixels.codes[index]);
        Cluster {
            direction: self.grid.center(column, row),
            flux_dnb_w: light.pixels.flux_dnb_w(self.grid, light.calibration, index),
            altitude_m: f64::from(light.pixels.altitude_m[index]),
            radius_m: 0.0,
        }
    }
}
