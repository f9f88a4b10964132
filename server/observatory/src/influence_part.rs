//! The influence, flux and number of some lights together.

use rayon::prelude::*;
use skyglow_scene::LitPixel;

/// Pixels that a task adds up.
const PIXELS_PER_TASK: usize = 16_384;

/// What some of the lights do together.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Part {
    /// Sum of their influences, in the measure's unit.
    pub influence: f64,
    /// Their upward flux, DNB watts.
    pub flux_dnb_w: f64,
    /// Number of pixels.
    pub pixels: u64,
}

impl Part {
    pub(crate) fn add(&mut self, pixel: &LitPixel, influence: f32) {
        self.influence += f64::from(influence);
        self.flux_dnb_w += f64::from(pixel.flux_dnb_w);
        self.pixels += 1;
    }

    /// Added up in order, piece by piece: the same map is to give the same bits.
    pub(crate) fn of_all(pixels: &[LitPixel], influence: &[f32]) -> Self {
        let pieces = pixels.par_chunks(PIXELS_PER_TASK).zip(influence.par_chunks(PIXELS_PER_TASK));
        let parts: Vec<Self> = pieces
            .map(|(pixels, influence)| {
                let mut part = Self::default();
                pixels.iter().zip(influence).for_each(|(pixel, influence)| part.add(pixel, *influence));
                part
            })
            .collect();
        parts.into_iter().fold(Self::default(), Self::with)
    }

    /// Both together.
    #[must_use]
    pub fn with(self, other: Self) -> Self {
        Self {
            influence: self.influence + other.influence,
            flux_dnb_w: self.flux_dnb_w + other.flux_dnb_w,
            pixels: self.pixels + other.pixels,
        }
    }
}
