//! Skylines: the horizon profile of each light, by azimuth and distance.
//!
//! For each light, 32 azimuths and 9 distances: the highest elevation angle of terrain within the distance, as a position on
//! the axis of blocking angles ([`blocking_position`]), in a byte. Towards an observer the value is linear in azimuth
//! and in ln(distance) between the distances, so at one of them it is that of the terrain within it: terrain behind the
//! observer blocks nothing. Lights with an open sky take no memory.
//!
//! The position of a single light is good to 0.05 in the mean in Kenya, 0.12 in the Alps, to half of that with 64
//! azimuths, and over many lights to 0.01. Distances four times as far apart, or
//! none beyond 64 km, have errors half again as large.

use crate::sections::{Flaw, Sections, pack_ascending, unpack_ascending};
use bytemuck::cast_slice;
use rayon::prelude::*;
use skyglow_physics::blocking::{BLOCKING_COUNT, blocking_position};
use std::{borrow::Cow, ops::Range};

/// Azimuths of the horizon profile of a light; number i is at i·360/32 degrees clockwise from north.
pub const SKYLINE_AZIMUTH_COUNT: usize = 32;
/// Within these distances of the light the highest terrain is known, metres. Each is twice the one before, and the
/// first is twice [`MIN_SOURCE_DISTANCE_M`](skyglow_physics::source_pixel::MIN_SOURCE_DISTANCE_M).
pub const SKYLINE_DISTANCES_M: [f64; DISTANCE_COUNT] =
    [500.0, 1_000.0, 2_000.0, 4_000.0, 8_000.0, 16_000.0, 32_000.0, 64_000.0, 128_000.0];
const DISTANCE_COUNT: usize = 9;
/// ln of a distance over the one before.
const DISTANCE_LOG_STEP: f64 = std::f64::consts::LN_2;
/// Codes a node of the axis of blocking angles: 0.014° near the open sky, 2 % of the angle above half a degree.
const STEPS_PER_NODE: f64 = 36.0;
/// The largest code.
const MAX_CODE: f64 = STEPS_PER_NODE * (BLOCKING_COUNT - 1) as f64;

/// Tangent of an elevation angle so low (0.007°) that its code is that of the open sky.
pub(crate) const MIN_TANGENT: f64 = 1.2e-4;

/// Highest terrain of one light, `[azimuth][distance]`.
pub(crate) type Skyline = [[u8; DISTANCE_COUNT]; SKYLINE_AZIMUTH_COUNT];

/// The skylines of lights, by the index of the light.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Skylines {
    /// Index of the light's skyline in each column of `blocked`; [`OPEN`] for an open sky.
    at: Vec<u32>,
    /// `[azimuth][skyline]`: neighbouring lights see an observer in nearly the same azimuth, and theirs lie side by side.
    blocked: [Vec<[u8; DISTANCE_COUNT]>; SKYLINE_AZIMUTH_COUNT],
}

/// A light under an open sky.
const OPEN: u32 = u32::MAX;

/// The code of an elevation angle, by its tangent.
pub(crate) fn code_of(tangent: f64) -> u8 {
    let (node, weight) = blocking_position(tangent.atan().to_degrees());
    (STEPS_PER_NODE * (node as f64 + weight)).round() as u8
}

/// Differences from the code of the distance before: mostly 0, so they pack well.
fn steps(codes: &[u8; DISTANCE_COUNT]) -> [u8; DISTANCE_COUNT] {
    let mut steps = *codes;
    for distance in 1..DISTANCE_COUNT {
        steps[distance] = codes[distance].wrapping_sub(codes[distance - 1]);
    }
    steps
}

/// The skyline of a block: the mean of those of its children, weighted by their flux.
///
/// * `skyline`: of a child by its index; None under an open sky.
pub(crate) fn mean(
    children: Range<usize>,
    skyline: impl Fn(usize) -> Option<Skyline>,
    flux_dnb_w: impl Fn(usize) -> f64,
) -> Skyline {
    let mut sums = [[0f32; DISTANCE_COUNT]; SKYLINE_AZIMUTH_COUNT];
    let (mut total, mut is_open) = (0.0, true);
    for child in children {
        let flux = flux_dnb_w(child);
        total += flux;
        if let Some(skyline) = skyline(child) {
            is_open = false;
            let codes = skyline.iter().flatten();
            sums.iter_mut().flatten().zip(codes).for_each(|(sum, &code)| {
                *sum += flux as f32 * f32::from(code);
            });
        }
    }
    if is_open {
        return Skyline::default();
    }
    sums.map(|column| column.map(|sum| (sum / total as f32 + 0.5) as u8))
}

impl Skylines {
    /// Adds the next light's.
    pub(crate) fn push(&mut self, skyline: &Skyline) {
        if skyline.iter().flatten().all(|&code| code == 0) {
            self.at.push(OPEN);
        } else {
            self.at.push(self.blocked_count() as u32);
            self.blocked.iter_mut().zip(skyline).for_each(|(column, codes)| column.push(*codes));
        }
    }

    /// The skyline of a light.
    pub(crate) fn skyline(&self, light: usize) -> Skyline {
        let at = self.at[light];
        if at == OPEN { Skyline::default() } else { self.blocked_skyline(at as usize) }
    }

    /// The skyline at an index of `blocked`.
    fn blocked_skyline(&self, at: usize) -> Skyline {
        std::array::from_fn(|azimuth| self.blocked[azimuth][at])
    }

    /// How many lights have terrain around them.
    pub(crate) fn blocked_count(&self) -> usize {
        self.blocked[0].len()
    }

    /// Whether a light has an open sky.
    pub(crate) fn is_open(&self, light: usize) -> bool {
        self.at[light] == OPEN
    }

    /// Place of the skyline on the axis of blocking angles, 0..=7, from a light towards an observer.
    ///
    /// * `turns`: azimuth of the observer seen from the light over 2π, 0..=1.
    /// * `log_distance`: ln of the distance between them over the nearest
    ///   distance of any source (250 m), at least 0.
    pub(crate) fn blocking(&self, light: usize, turns: f64, log_distance: f64) -> f64 {
        let at = self.at[light];
        if at == OPEN {
            return 0.0;
        }
        // Towards the nearest distance of any source, half of the first distance, it falls to nothing.
        let distance = (log_distance / DISTANCE_LOG_STEP).clamp(0.0, DISTANCE_COUNT as f64);
        let outer = (distance as usize).min(DISTANCE_COUNT - 1);
        let out = distance - outer as f64;
        let column = turns * SKYLINE_AZIMUTH_COUNT as f64;
        let left = column as usize;
        let along = column - left as f64;
        let code_at = |column: usize| {
            let codes = &self.blocked[column % SKYLINE_AZIMUTH_COUNT][at as usize];
            let inner = if outer == 0 { 0.0 } else { f64::from(codes[outer - 1]) };
            inner + out * (f64::from(codes[outer]) - inner)
        };
        let code = (1.0 - along) * code_at(left) + along * code_at(left + 1);
        code.min(MAX_CODE) / STEPS_PER_NODE
    }

    /// The skylines of the blocks of a level of the light pyramid from those of the level below (pixels below level
    /// 1): the mean of the places on the axis of blocking angles, weighted by flux, in which the tables are linear.
    ///
    /// * `children`: of each of `block_count` blocks, as a range in the level below.
    /// * `flux_dnb_w`: upward flux of a child by its index.
    pub(crate) fn of_blocks(
        &self,
        block_count: usize,
        children: impl Fn(usize) -> Range<usize> + Sync,
        flux_dnb_w: impl Fn(usize) -> f64 + Sync,
    ) -> Self {
        let of_block = |block: usize| {
            let known = |child: usize| (!self.is_open(child)).then(|| self.skyline(child));
            mean(children(block), known, &flux_dnb_w)
        };
        let skylines: Vec<Skyline> = (0..block_count).into_par_iter().map(of_block).collect();
        let mut above = Self::default();
        skylines.iter().for_each(|skyline| above.push(skyline));
        above
    }

    /// Bytes of memory that it takes, about.
    pub(crate) fn byte_count(&self) -> usize {
        self.at.len() * size_of::<u32>() + self.blocked_count() * size_of::<Skyline>()
    }

    /// The sections to store.
    pub(crate) fn to_sections(&self) -> Vec<(String, Cow<'_, [u8]>)> {
        let blocked: Vec<u64> = (0..self.at.len() as u64).filter(|&i| !self.is_open(i as usize)).collect();
        let skylines = (0..self.blocked_count()).map(|at| self.blocked_skyline(at));
        let codes = skylines.flat_map(|skyline| skyline.map(|codes| steps(&codes))).flatten();
        vec![
            ("reaches".into(), Cow::Borrowed(cast_slice(&SKYLINE_DISTANCES_M))),
            ("blocked".into(), Cow::Owned(pack_ascending(&blocked))),
            ("codes".into(), Cow::Owned(codes.collect())),
        ]
    }

    /// Undoes [`Self::to_sections`] for a number of lights.
    pub(crate) fn from_sections(sections: &Sections<'_>, lights: usize) -> Result<Self, Flaw> {
        if sections.numbers::<f64>("reaches")? != SKYLINE_DISTANCES_M {
            return Err("holds skylines of other reaches than this program's".to_owned());
        }
        let indices = unpack_ascending(&sections.bytes("blocked")?)?;
        let codes = sections.numbers::<u8>("codes")?;
        let is_ascending = indices.windows(2).all(|pair| pair[0] < pair[1]);
        if !is_ascending
            || indices.last().is_some_and(|&last| last >= lights as u64)
            || codes.len() != indices.len() * size_of::<Skyline>()
        {
            return Err("holds skylines that do not fit the lights".to_owned());
        }
        let mut at = vec![OPEN; lights];
        for (number, &index) in indices.iter().enumerate() {
            at[index as usize] = number as u32;
        }
        let mut blocked: [Vec<[u8; DISTANCE_COUNT]>; SKYLINE_AZIMUTH_COUNT] =
            std::array::from_fn(|_| Vec::with_capacity(indices.len()));
        for (number, steps) in codes.as_chunks::<DISTANCE_COUNT>().0.iter().enumerate() {
            let mut codes = *steps;
            for distance in 1..DISTANCE_COUNT {
                codes[distance] = codes[distance].wrapping_add(codes[distance - 1]);
            }
            blocked[number % SKYLINE_AZIMUTH_COUNT].push(codes);
        }
        Ok(Self { at, blocked })
    }
}

#[cfg(test)]
#[path = "skylines_tests.rs"]
mod tests;
