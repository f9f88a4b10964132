//! What the polar grid blurs of near lights, put right.
//!
//! The grid shares a light among two columns and two rings, packs hold images averaged across a column, and between two
//! offsets a light above the observer has two peaks. In the sum over many lights this averages out; in a direction that looks
//! past one near light it was wrong by tens of per cent. So for every near light that shows, the first order next to its
//! direction is added as it is and taken away as the grid has it ([`patch`]), both by the closed form of
//! [`skyglow_physics::near_light`]: only the difference counts, and with it the form's own error.
//!
//! A light shows where its peak reaches [`LEAST_SHARE`] of the sky there. What is added belongs to the sky as it is: to influences
//! it is linear in the lights ([`NearLights::influences`]).

mod patch;
mod sight;

use crate::{request::RenderRequest, table_set::TableSet};
use patch::{Chosen, PatchMaker, Place};
use rayon::prelude::*;
use sight::{Air, Most, Sight};
use skyglow_physics::{
    AZIMUTH_COUNT, Atmosphere, BAND_COUNT, Band, EARTH_RADIUS_M, ELEVATION_COUNT, EmissionMix, LinearMeasure,
    Panorama, Turbidity,
    near_light::NearScattering,
    panorama::{azimuth_rad, elevation_rad},
};
use skyglow_scene::{NearLight, PolarGrid};
use std::{
    f32::consts::TAU,
    sync::{Arc, LazyLock},
};

/// A light's peak counts in full from twice this part of the sky's radiance on, and not at all below it.
const LEAST_SHARE: f32 = 0.004;
/// Sine and cosine of half a column's width, which is half a row's height.
static HALF_A_COLUMN: LazyLock<[f32; 2]> = LazyLock::new(|| {
    let (sin, cos) = (0.5 * azimuth_rad(1)).sin_cos();
    [sin as f32, cos as f32]
});
/// Sine and cosine of the elevation of every row.
static ROWS: LazyLock<[[f32; 2]; ELEVATION_COUNT]> = LazyLock::new(|| {
    std::array::from_fn(|row| {
        let (sin, cos) = elevation_rad(row).sin_cos();
        [sin as f32, cos as f32]
    })
});
/// No direction is darkened to less than this part of what it was: the pack's own peak is not quite the closed form's.
const LEAST_LEFT: f32 = 0.1;
/// Lights this many rows up (45°) count for nothing, and in full so many rows below: no ridge stands there.
const HIGHEST_ROW: f32 = 32.0;
const ROWS_TO_NOTHING: f32 = 8.0;
/// Tasks at most, each with a sky of its own: few, and the same on every machine, so that sums have the same order.
const MOST_TASKS: usize = 4;
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
pub(crate) struct ShownLights {
    chosen: Vec<Chosen>,
    /// What they add in every direction, `[band][row][column]`.
    added: Vec<f32>,
}

impl ShownLights {
    pub(crate) fn byte_count(&self) -> usize {
        size_of_val(self.chosen.as_slice()) + size_of_val(self.added.as_slice())
    }
}

impl NearLights {
    /// None where there are none, and under clouds, where this was not measured.
    pub(crate) fn of(request: &RenderRequest) -> Option<Self> {
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
    pub(crate) fn add_to(&self, set: &TableSet, sky: &mut [f32]) {
        let ShownLights { chosen, added } = self.shown(set, sky);
        if chosen.is_empty() {
            return;
        }
        for (radiance, added) in sky.iter_mut().zip(&added).filter(|(_, added)| **added != 0.0) {
            *radiance += kept_share(*radiance, *added) * added;
        }
    }

    /// What shows in `sky`, which is the sky as the cells make it, before [`Self::add_to`].
    pub(crate) fn shown(&self, set: &TableSet, sky: &[f32]) -> ShownLights {
        let air = self.air();
        let chosen = self.chosen(&air, set, sky);
        let added = self.sum(&air, set, &chosen);
        ShownLights { chosen, added }
    }

    /// What each near light adds to a linear measure of luminance beyond what the cells have of it, by its place in
    /// [`PolarGrid::near`]; `shown` is what shows in `sky`.
    pub(crate) fn influences(
        &self,
        set: &TableSet,
        sky: &[f32],
        ShownLights { chosen, added }: &ShownLights,
        measure: &LinearMeasure,
    ) -> Vec<(usize, f64)> {
        let air = self.air();
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
                    maker.for_each(light, self.flux_per_dnb_flux, |at, values| {
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

    /// The lights that show in a sky, those that share patches side by side.
    fn chosen(&self, air: &Air, set: &TableSet, sky: &[f32]) -> Vec<Chosen> {
        let near = &self.polar.near;
        let step = azimuth_rad(1) as f32;
        let eye_m = self.observer_altitude_m as f32;
        let range_m = near.iter().fold([f32::INFINITY, f32::NEG_INFINITY], |[low, high], light| {
            [low.min(light.altitude_m), high.max(light.altitude_m)]
        });
        let most = Most::new(air, range_m);
        // Most lights of a city are too small a part of its sky, and that is told by a few multiplications.
        let dimmest = dimmest(sky);
        let (per_step, per_column) = (1.0 / step, AZIMUTH_COUNT as f32 / TAU);
        let may_show = |light: &NearLight| {
            let slope = (light.altitude_m - eye_m) / light.distance_m
                - light.distance_m * (0.5 / EARTH_RADIUS_M as f32);
            // Rows up to the one above the light's; the tangent is the larger.
            let row = (slope * per_step + 0.5).clamp(0.0, (LOW_ROWS - 1) as f32) as i32 as usize;
            let column = (light.azimuth_rad * per_column) as i32 as usize % AZIMUTH_COUNT;
            let needed = light.distance_m * LEAST_SHARE;
            let most = most.per_m(light.altitude_m, light.distance_m);
            let per_band = most.iter().zip(self.flux_per_dnb_flux).zip(&dimmest);
            per_band
                .map(|((most, flux), dimmest)| {
                    light.flux_dnb_w * flux * most >= needed * dimmest[row * AZIMUTH_COUNT + column]
                })
                .fold(false, |any, shows| any | shows)
        };
        let lights = near.par_iter().enumerate().with_min_len(512).filter(|(_, light)| may_show(light));
        let mut chosen: Vec<Chosen> =
            lights.filter_map(|(index, light)| self.choose(air, set, sky, index, light)).collect();
        chosen.par_sort_unstable_by_key(|light| (light.place.key(), light.index));
        chosen
    }

    /// A light, if its peak shows.
    fn choose(
        &self,
        air: &Air,
        set: &TableSet,
        sky: &[f32],
        index: usize,
        light: &NearLight,
    ) -> Option<Chosen> {
        let offset_m = f64::from(light.altitude_m) - self.observer_altitude_m;
        let sight = Sight::new(air, f64::from(light.distance_m), offset_m);
        let step = azimuth_rad(1) as f32;
        let row = sight.elevation_rad() / step - 0.5;
        // Below the lowest row by more than a patch reaches, or so high that columns crowd.
        if !(-4.0..HIGHEST_ROW).contains(&row) {
            return None;
        }
        let column = light.azimuth_rad / step;
        // Half a column beside it, and half a row above if there is a row.
        let nearest = (row + 0.5).max(0.0) as usize;
        let [sin_aside, cos_aside] = *HALF_A_COLUMN;
        let [sin, cos] = if row + 0.5 > nearest as f32 {
            let [sin, cos] = sight.elevation();
            [sin * cos_aside + cos * sin_aside, cos * cos_aside - sin * sin_aside]
        } else {
            ROWS[nearest]
        };
        let through = sight.through::<false, 1>(air, [&[sin], &[cos]]).map(|of_band| of_band[0]);
        let peak = sight.radiance::<false, 1>(air, through, [sin, cos], [&[cos_aside], &[sin_aside]]);
        let first = column as usize % AZIMUTH_COUNT;
        let share = (0..BAND_COUNT).map(|band| {
            let at = |column: usize| sky[Panorama::index(band, nearest, column % AZIMUTH_COUNT)];
            let flux = light.flux_dnb_w * self.flux_per_dnb_flux[band];
            flux * peak[band][0] / at(first).min(at(first + 1)).max(f32::MIN_POSITIVE)
        });
        let share = share.fold(0.0, f32::max);
        let weight =
            (share / LEAST_SHARE - 1.0).clamp(0.0, 1.0) * ((HIGHEST_ROW - row) / ROWS_TO_NOTHING).min(1.0);
        (weight > 0.0).then(|| Chosen {
            index: index as u32,
            place: Place::of(set, light.distance_m, offset_m as f32, row),
            sight,
            row,
            column,
            distance_m: light.distance_m,
            offset_m: offset_m as f32,
            flux_dnb_w: weight * light.flux_dnb_w,
        })
    }

    /// What is added in every direction.
    fn sum(&self, air: &Air, set: &TableSet, chosen: &[Chosen]) -> Vec<f32> {
        let of_task = |lights: &[Chosen]| {
            let mut added = vec![0f32; Panorama::LEN];
            let mut maker = PatchMaker::new(air, set);
            for light in lights {
                maker.for_each(light, self.flux_per_dnb_flux, |at, values| {
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

/// Rows in which lights may show.
const LOW_ROWS: usize = HIGHEST_ROW as usize + 2;

/// No more than the sky's radiance around a direction, `[band][row][column]`: of the row, one or some below it, and two columns.
fn dimmest(sky: &[f32]) -> [Vec<f32>; BAND_COUNT] {
    std::array::from_fn(|band| {
        let of_row = |row: usize| &sky[Panorama::index(band, row, 0)..][..AZIMUTH_COUNT];
        let mut dimmest = Vec::with_capacity(LOW_ROWS * AZIMUTH_COUNT);
        for row in 0..LOW_ROWS {
            let of_both: Vec<f32> = of_row(row)
                .iter()
                .zip(of_row(row.saturating_sub(row / 8 + 1)))
                .map(|(here, lower)| here.min(*lower))
                .collect();
            let next = of_both.iter().cycle().skip(1);
            dimmest.extend(of_both.iter().zip(next).map(|(here, next)| here.min(*next)));
        }
        dimmest
    })
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
