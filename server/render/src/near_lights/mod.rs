//! Near-field correction: what the polar grid blurs of near lights (`docs/model.md#near-field`).
//!
//! The grid shares a light among two columns and two rings, packs hold images averaged across a column, and between two
//! offsets a light above the observer has two peaks. In the sum over many lights this averages out; in a direction that looks
//! past one near light it was wrong by tens of per cent. So for every near light that shows, the first order next to its
//! direction is added as it is and taken away as the grid has it ([`patch`]), both by the closed form of
//! [`skyglow_physics::near_light`]: only the difference counts, and with it the form's own error.
//!
//! A light shows where its peak reaches a certain part of the sky there ([`choosing`]). What is added belongs to the sky as it is: to influences
//! it is linear in the lights ([`NearLights::influences`]).

mod choosing;
mod extents;
mod patch;
mod screen;
mod sight;

use crate::{request::RenderRequest, table_set::TableSet};
use choosing::Choosing;
use patch::{Chosen, MostOfGrid, PatchMaker};
use rayon::prelude::*;
use sight::Air;
use skyglow_physics::{
    AZIMUTH_COUNT, Atmosphere, BAND_COUNT, Band, ELEVATION_COUNT, EmissionMix, LinearMeasure, Panorama,
    Turbidity, near_light::NearScattering, panorama::elevation_rad,
};
use skyglow_scene::PolarGrid;
use std::sync::{Arc, LazyLock};

/// Sine and cosine of the elevation of every row.
static ROWS: LazyLock<[[f32; 2]; ELEVATION_COUNT]> = LazyLock::new(|| {
    std::array::from_fn(|row| {
        let (sin, cos) = elevation_rad(row).sin_cos();
        [sin as f32, cos as f32]
    })
});
/// No direction is darkened to less than this part of what it was: the pack's own peak is not quite the closed form's.
const LEAST_LEFT: f32 = 0.1;
/// Tasks at most, each with a sky of its own: few, and the same on every machine, so that sums have the same order.
const MOST_TASKS: usize = 8;
/// Lights that a task has at least.
const LIGHTS_PER_TASK: usize = 64;

/// The near lights of a request.
#[derive(Clone, Debug)]
pub struct NearLights {
    polar: Arc<PolarGrid>,
    observer_altitude_m: f64,
    turbidity: Turbidity,
    emission: EmissionMix,
    flux_per_dnb_flux: [f32; BAND_COUNT],
}

/// The near lights that show in a sky.
#[derive(Debug)]
pub struct ShownLights {
    chosen: Vec<Chosen>,
    /// What they add in every direction, `[band][row][column]`.
    added: Vec<f32>,
}

impl ShownLights {
    /// Bytes that it holds.
    pub fn byte_count(&self) -> usize {
        size_of_val(self.chosen.as_slice()) + size_of_val(self.added.as_slice())
    }
}

impl NearLights {
    /// None where there are none, and under clouds, where this was not measured.
    pub fn of(request: &RenderRequest) -> Option<Self> {
        let lit = request.flux_per_dnb_flux.iter().any(|flux| *flux > 0.0);
        (lit && request.cloud_base_m.is_none() && !request.polar.near.is_empty()).then(|| Self {
            polar: Arc::clone(&request.polar),
            observer_altitude_m: request.observer_altitude_m.max(0.0),
            turbidity: request.turbidity,
            emission: request.emission,
            flux_per_dnb_flux: request.flux_per_dnb_flux.map(|flux| flux as f32),
        })
    }

    /// Puts a sky right, `[band][row][column]`, W m⁻² sr⁻¹. Nothing falls to less than a tenth of what it was.
    pub fn add_to(&self, set: &TableSet, sky: &mut [f32]) {
        let ShownLights { chosen, added } = self.shown(set, sky);
        if chosen.is_empty() {
            return;
        }
        for (radiance, added) in sky.iter_mut().zip(&added).filter(|(_, added)| **added != 0.0) {
            *radiance += kept_share(*radiance, *added) * added;
        }
    }

    /// What shows in `sky`, which is the sky as the cells make it, before [`Self::add_to`].
    pub fn shown(&self, set: &TableSet, sky: &[f32]) -> ShownLights {
        let air = self.air();
        let chosen = Choosing::new(self, &air, set, sky).chosen();
        let added = self.sum(&air, set, sky, &chosen);
        ShownLights { chosen, added }
    }

    /// What each near light adds to a linear measure of luminance beyond what the cells have of it, by its place in
    /// [`PolarGrid::near`]; `shown` is what shows in `sky`.
    pub fn influences(
        &self,
        set: &TableSet,
        sky: &[f32],
        ShownLights { chosen, added }: &ShownLights,
        measure: &LinearMeasure,
    ) -> Vec<(usize, f64)> {
        let air = self.air();
        let most = MostOfGrid::new(sky, 1.0 - LEAST_LEFT);
        let mut weights = vec![0f32; Panorama::LEN];
        for band in Band::ALL {
            for (direction, weight) in measure.weights().iter().enumerate().filter(|(_, w)| **w > 0.0) {
                let at = Panorama::index(band.index(), 0, 0) + direction;
                let share = kept_share(sky[at], added[at]);
                weights[at] = (weight * band.luminous_efficacy_lm_w()) as f32 * share;
            }
        }
        // Patches of lights where nothing is asked for add nothing: all of them at the zenith.
        let weighs: [bool; ELEVATION_COUNT] = std::array::from_fn(|row| {
            let of_row = |band: usize| &weights[Panorama::index(band, row, 0)..][..AZIMUTH_COUNT];
            (0..BAND_COUNT).any(|band| of_row(band).iter().any(|weight| *weight != 0.0))
        });
        let weighed: Vec<Chosen> =
            chosen.iter().filter(|light| weighs[light.place.rows()].contains(&true)).copied().collect();
        let tasks = weighed.par_chunks(lights_per_task(&weighed)).map(|lights| {
            let mut maker = PatchMaker::new(&air, set);
            lights
                .iter()
                .map(|light| {
                    let mut sum = 0.0;
                    maker.for_each(light, self.flux_per_dnb_flux, &most, |at, values| {
                        let weighted = weights[at..].iter().zip(values).map(|(weight, value)| weight * value);
                        sum += f64::from(weighted.sum::<f32>());
                    });
                    (light.index as usize, sum)
                })
                .collect::<Vec<_>>()
        });
        tasks.collect::<Vec<_>>().concat()
    }

    fn air(&self) -> Air {
        let atmosphere = Atmosphere::new(self.turbidity);
        Air::new(NearScattering::of(self.emission), &atmosphere, self.observer_altitude_m)
    }

    /// What is added in every direction.
    fn sum(&self, air: &Air, set: &TableSet, sky: &[f32], chosen: &[Chosen]) -> Vec<f32> {
        if chosen.is_empty() {
            return vec![0.0; Panorama::LEN];
        }
        let most = MostOfGrid::new(sky, 1.0 - LEAST_LEFT);
        let of_task = |lights: &[Chosen]| {
            let mut added = vec![0f32; Panorama::LEN];
            let mut maker = PatchMaker::new(air, set);
            for light in lights {
                maker.for_each(light, self.flux_per_dnb_flux, &most, |at, values| {
                    added[at..].iter_mut().zip(values).for_each(|(sum, value)| *sum += value);
                });
            }
            added
        };
        let tasks: Vec<Vec<f32>> = chosen.par_chunks(lights_per_task(chosen)).map(of_task).collect();
        let mut tasks = tasks.into_iter();
        let mut added = tasks.next().unwrap_or_else(|| vec![0.0; Panorama::LEN]);
        for more in tasks {
            added.iter_mut().zip(more).for_each(|(sum, more)| *sum += more);
        }
        added
    }
}

/// Lights of a task: what a task remembers of nodes is made once for it.
fn lights_per_task(chosen: &[Chosen]) -> usize {
    chosen.len().div_ceil(MOST_TASKS).max(LIGHTS_PER_TASK)
}

/// The part of what is added that counts: all of it where enough is left.
fn kept_share(radiance: f32, added: f32) -> f32 {
    let most = (1.0 - LEAST_LEFT) * radiance;
    if added < -most { most / -added } else { 1.0 }
}
