//! The near-field correction: what the polar grid blurs of near lights.
//!
//! The grid shares a light among two columns and two rings, packs hold images averaged across a column, and between two
//! offsets a light above the observer has two peaks. In the sum over many lights this averages out; in a direction that looks
//! past one near light it was wrong by tens of per cent. So for every near light that is visible, the first order next to its
//! direction is added as it is and taken away as the grid has it ([`patch`]), both by the closed form of
//! [`skyglow_physics::near_light`]: only the difference counts, and with it the form's own error.
//!
//! A light is visible where its peak reaches a certain part of the sky there ([`selection`]); most are ruled out by bounds
//! ([`culling`]). What is added belongs to the sky as it is: to influences it is linear in the lights
//! ([`NearFieldCorrection::influences`]).

mod air;
mod block_bounds;
mod culling;
mod low_rows;
mod patch;
mod selection;
mod sight_line;

use crate::{request::RenderRequest, table_set::TableSet};
use air::Air;
use patch::{GridLimit, PatchMaker, SelectedLight};
use rayon::prelude::*;
use selection::Selector;
use skyglow_physics::{
    AZIMUTH_COUNT, Atmosphere, BAND_COUNT, ELEVATION_COUNT, EmissionMix, Panorama, Turbidity,
    near_light::NearScattering,
};
use skyglow_scene::PolarGrid;
use std::sync::Arc;

/// No direction is darkened to less than this part of its radiance: the pack's own peak is not quite the closed form's.
const MIN_REMAINDER: f32 = 0.1;
/// Tasks at most, each with a sky of its own: few, and the same on every machine, so that sums have the same order.
const MAX_TASKS: usize = 8;
/// Lights that a task has at least.
const LIGHTS_PER_TASK: usize = 64;

/// The near lights of a request and what their correction depends on.
#[derive(Clone, Debug)]
pub struct NearFieldCorrection {
    polar: Arc<PolarGrid>,
    observer_altitude_m: f64,
    turbidity: Turbidity,
    emission: EmissionMix,
    flux_per_dnb_flux: [f32; BAND_COUNT],
}

/// The near lights that are visible in a sky.
#[derive(Debug)]
pub struct VisibleLights {
    lights: Vec<SelectedLight>,
    /// What they add in every direction, `[band][row][column]`.
    added: Vec<f32>,
}

impl VisibleLights {
    /// Bytes that it holds.
    pub fn byte_count(&self) -> usize {
        size_of_val(self.lights.as_slice()) + size_of_val(self.added.as_slice())
    }

    /// Corrects the sky that they were found in.
    pub fn add_to(&self, sky: &mut [f32]) {
        for (radiance, added) in sky.iter_mut().zip(&self.added).filter(|(_, added)| **added != 0.0) {
            *radiance += applied_share(*radiance, *added) * added;
        }
    }
}

impl NearFieldCorrection {
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

    /// Corrects a sky, `[band][row][column]`, W m⁻² sr⁻¹. Nothing falls to less than a tenth of what it was.
    pub fn apply(&self, set: &TableSet, sky: &mut [f32]) {
        let visible = self.visible_lights(set, sky);
        if !visible.lights.is_empty() {
            visible.add_to(sky);
        }
    }

    /// What is visible in `sky`, which is the sky as the cells make it, before [`Self::apply`].
    pub fn visible_lights(&self, set: &TableSet, sky: &[f32]) -> VisibleLights {
        let air = self.air();
        let flux_per_dnb_flux = self.flux_per_dnb_flux;
        let lights = Selector::new(&self.polar.near, flux_per_dnb_flux, &air, set, sky).select();
        let added = self.sum(&air, set, sky, &lights);
        VisibleLights { lights, added }
    }

    /// What each near light adds to Σ weight·radiance beyond what the cells have of it, by its place in [`PolarGrid::near`], given
    /// what is visible in `sky`. `weights` are those of samples, in the order of [`Panorama::samples`].
    pub fn influences(
        &self,
        set: &TableSet,
        sky: &[f32],
        VisibleLights { lights, added }: &VisibleLights,
        mut weights: Vec<f32>,
    ) -> Vec<(usize, f64)> {
        let air = self.air();
        let limit = GridLimit::new(sky, 1.0 - MIN_REMAINDER);
        for (at, weight) in weights.iter_mut().enumerate().filter(|(_, weight)| **weight != 0.0) {
            *weight *= applied_share(sky[at], added[at]);
        }
        // Patches of lights where nothing is asked for add nothing: all of them at the zenith.
        let weighs: [bool; ELEVATION_COUNT] = std::array::from_fn(|row| {
            let of_row = |band: usize| &weights[Panorama::index(band, row, 0)..][..AZIMUTH_COUNT];
            (0..BAND_COUNT).any(|band| of_row(band).iter().any(|weight| *weight != 0.0))
        });
        let weighed: Vec<SelectedLight> =
            lights.iter().filter(|light| weighs[light.nodes.rows()].contains(&true)).copied().collect();
        let tasks = weighed.par_chunks(lights_per_task(&weighed)).map(|lights| {
            let mut maker = PatchMaker::new(&air, set);
            lights
                .iter()
                .map(|light| {
                    let mut sum = 0.0;
                    maker.for_each(light, self.flux_per_dnb_flux, &limit, |at, values| {
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
    fn sum(&self, air: &Air, set: &TableSet, sky: &[f32], selected: &[SelectedLight]) -> Vec<f32> {
        if selected.is_empty() {
            return vec![0.0; Panorama::LEN];
        }
        let limit = GridLimit::new(sky, 1.0 - MIN_REMAINDER);
        let of_task = |lights: &[SelectedLight]| {
            let mut added = vec![0f32; Panorama::LEN];
            let mut maker = PatchMaker::new(air, set);
            for light in lights {
                maker.for_each(light, self.flux_per_dnb_flux, &limit, |at, values| {
                    added[at..].iter_mut().zip(values).for_each(|(sum, value)| *sum += value);
                });
            }
            added
        };
        let tasks: Vec<Vec<f32>> = selected.par_chunks(lights_per_task(selected)).map(of_task).collect();
        let mut tasks = tasks.into_iter();
        let mut added = tasks.next().unwrap_or_else(|| vec![0.0; Panorama::LEN]);
        for more in tasks {
            added.iter_mut().zip(more).for_each(|(sum, more)| *sum += more);
        }
        added
    }
}

/// Lights of a task: what a task remembers of nodes is made once for it.
fn lights_per_task(selected: &[SelectedLight]) -> usize {
    selected.len().div_ceil(MAX_TASKS).max(LIGHTS_PER_TASK)
}

/// The part of what is added that counts: all of it where enough is left.
fn applied_share(radiance: f32, added: f32) -> f32 {
    let limit = (1.0 - MIN_REMAINDER) * radiance;
    if added < -limit { limit / -added } else { 1.0 }
}
