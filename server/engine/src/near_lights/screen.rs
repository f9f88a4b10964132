//! Most of a city's lights are too small a part of its sky to show, and that is told by a few multiplications for each.

use super::{
    NearLights,
    choosing::{LEAST_SHARE, LOW_ROWS},
    sight::Air,
};
use crate::cpu::dispatch::{LANES, dispatch_wide};
use rayon::prelude::*;
use skyglow_physics::{
    AZIMUTH_COUNT, BAND_COUNT, EARTH_RADIUS_M, Panorama, near_light::whole_part, panorama::azimuth_rad,
    source_pixel::FARTHEST_SOURCE_M,
};
use skyglow_scene::NearLight;
use std::f32::consts::TAU;

/// A value for each band, and one more, so that they lie as vectors do.
type Bands = [f32; BAND_COUNT + 1];

/// Bounds on what lights show and on the sky around them.
pub(super) struct Screen {
    most: Most,
    /// `[row][column]`: the least of the sky's radiance around a direction, W m⁻² sr⁻¹; infinite beyond the bands and in dark ones.
    dimmest: Vec<Bands>,
    observer_altitude_m: f32,
}

impl Screen {
    pub(super) fn new(air: &Air, lights: &NearLights, sky: &[f32]) -> Self {
        Self {
            most: Most::new(air, altitude_range_m(&lights.polar.near), lights.flux_per_dnb_flux),
            dimmest: dimmest(sky, lights.flux_per_dnb_flux),
            observer_altitude_m: lights.observer_altitude_m as f32,
        }
    }

    /// The places of those lights that may show.
    pub(super) fn that_may_show(&self, lights: &[NearLight]) -> Vec<u32> {
        let mut found = Vec::new();
        screened(self, lights, &mut found);
        found
    }
}

dispatch_wide!(
    /// Adds the places of lights that may show.
    screened, screened_wide, screened_body, (screen: &Screen, lights: &[NearLight], found: &mut Vec<u32>)
);

#[inline(always)]
fn screened_body<const FUSED: bool>(screen: &Screen, lights: &[NearLight], found: &mut Vec<u32>) {
    let (per_step, per_column) = (1.0 / azimuth_rad(1) as f32, AZIMUTH_COUNT as f32 / TAU);
    found.resize(lights.len(), 0);
    let mut count = 0;
    for (block, lights) in lights.chunks(LANES).enumerate() {
        let mut bounds_at = [0u32; LANES];
        let mut sky_at = [0u32; LANES];
        let mut needed = [0f32; LANES];
        for lane in 0..LANES {
            let light = &lights[lane.min(lights.len() - 1)];
            let offset_m = light.altitude_m - screen.observer_altitude_m;
            let slope = offset_m / light.distance_m - light.distance_m * (0.5 / EARTH_RADIUS_M as f32);
            // Rows up to the one above the light's; the tangent is the larger.
            let row = whole_part((slope * per_step + 0.5).min((LOW_ROWS - 1) as f32));
            let column = whole_part(light.azimuth_rad * per_column) % AZIMUTH_COUNT as u32;
            sky_at[lane] = row * AZIMUTH_COUNT as u32 + column;
            bounds_at[lane] = screen.most.place(light.altitude_m, light.distance_m);
            needed[lane] = light.distance_m * LEAST_SHARE;
        }
        for (lane, light) in lights.iter().enumerate() {
            let most = &screen.most.per_m[bounds_at[lane] as usize];
            let sky = &screen.dimmest[sky_at[lane] as usize];
            let mut shows = false;
            for band in 0..=BAND_COUNT {
                shows |= light.flux_dnb_w * most[band] >= needed[lane] * sky[band];
            }
            found[count] = (block * LANES + lane) as u32;
            count += usize::from(shows);
        }
    }
    found.truncate(count);
}

/// Lowest and highest altitude, metres.
fn altitude_range_m(lights: &[NearLight]) -> [f32; 2] {
    let wider = |[low, high]: [f32; 2], [lower, higher]: [f32; 2]| {
        [if lower < low { lower } else { low }, if higher > high { higher } else { high }]
    };
    const NONE: [f32; 2] = [f32::INFINITY, f32::NEG_INFINITY];
    let of_task = |lights: &[NearLight]| {
        let mut ranges = [NONE; LANES];
        for lights in lights.chunks(LANES) {
            for (range, light) in ranges.iter_mut().zip(lights) {
                *range = wider(*range, [light.altitude_m; 2]);
            }
        }
        ranges.into_iter().fold(NONE, wider)
    };
    lights.par_chunks(LIGHTS_PER_TASK).map(of_task).reduce(|| NONE, wider)
}

/// Lights whose altitudes a task looks at.
const LIGHTS_PER_TASK: usize = 16_384;

/// No more than the sky's radiance around a direction: of the row, one or some below it, and two columns. Nothing shows in a band
/// in which no lamp shines.
fn dimmest(sky: &[f32], flux_per_dnb_flux: [f32; BAND_COUNT]) -> Vec<Bands> {
    let mut dimmest = vec![[f32::INFINITY; BAND_COUNT + 1]; LOW_ROWS * AZIMUTH_COUNT];
    for (row, of_row) in dimmest.chunks_exact_mut(AZIMUTH_COUNT).enumerate() {
        for band in (0..BAND_COUNT).filter(|band| flux_per_dnb_flux[*band] > 0.0) {
            let at = |row: usize| &sky[Panorama::index(band, row, 0)..][..AZIMUTH_COUNT];
            let (here, lower) = (at(row), at(row.saturating_sub(row / 8 + 1)));
            let mut of_both = [0f32; AZIMUTH_COUNT + 1];
            for column in 0..AZIMUTH_COUNT {
                of_both[column] = here[column].min(lower[column]);
            }
            of_both[AZIMUTH_COUNT] = of_both[0];
            for (column, dimmest) in of_row.iter_mut().enumerate() {
                dimmest[band] = of_both[column].min(of_both[column + 1]);
            }
        }
    }
    dimmest
}

/// [`Air::most_per_m`] by altitude and distance of the light.
struct Most {
    lowest_m: f32,
    altitude_steps: u32,
    /// `[altitude][distance]`, times the flux of a band over that in the DNB; 0 beyond the bands.
    per_m: Vec<Bands>,
}

/// Steps of the altitude and of the distance of lights, metres.
const ALTITUDE_STEP_M: f32 = 500.0;
const DISTANCE_STEP_M: f32 = 5_000.0;
const DISTANCE_STEPS: u32 = (FARTHEST_SOURCE_M / DISTANCE_STEP_M as f64) as u32 + 1;

impl Most {
    fn new(air: &Air, [lowest_m, highest_m]: [f32; 2], flux_per_dnb_flux: [f32; BAND_COUNT]) -> Self {
        let altitude_steps = ((highest_m - lowest_m) / ALTITUDE_STEP_M) as u32 + 1;
        let range = |from: f32, index: u32, step: f32| {
            [index, index + 1].map(|index| f64::from(from + index as f32 * step))
        };
        let scattered = air.scattering.largest_above();
        let per_m = (0..altitude_steps * DISTANCE_STEPS).map(|at| {
            let (altitude, distance) = (at / DISTANCE_STEPS, at % DISTANCE_STEPS);
            let altitude_m = range(lowest_m, altitude, ALTITUDE_STEP_M);
            let most = air.most_per_m(scattered, altitude_m, range(0.0, distance, DISTANCE_STEP_M));
            let mut per_m = [0.0; BAND_COUNT + 1];
            for (band, most) in most.into_iter().enumerate() {
                per_m[band] = flux_per_dnb_flux[band] * most;
            }
            per_m
        });
        Self { lowest_m, altitude_steps, per_m: per_m.collect() }
    }

    /// Where a light's bound is.
    #[inline(always)]
    fn place(&self, altitude_m: f32, distance_m: f32) -> u32 {
        let step = |from: f32, per_step: f32| whole_part(from * per_step);
        let altitude = step(altitude_m - self.lowest_m, 1.0 / ALTITUDE_STEP_M).min(self.altitude_steps - 1);
        altitude * DISTANCE_STEPS + step(distance_m, 1.0 / DISTANCE_STEP_M).min(DISTANCE_STEPS - 1)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::near_lights::sight::{Sight, tests::one};
    use skyglow_physics::{Atmosphere, EmissionMix, Lobe, Turbidity, near_light::NearScattering};

    #[test]
    fn no_light_shows_more_than_the_bound_on_it() {
        let mut closest = 0f32;
        for (turbidity, eye_m) in [(1.5, 2.0), (2.5, 640.0), (6.0, 2_900.0)] {
            let atmosphere = Atmosphere::new(Turbidity::new(turbidity).unwrap());
            for emission in [EmissionMix::garstang(), EmissionMix::only(Lobe::Oblique)] {
                let air = Air::new(NearScattering::of(emission), &atmosphere, eye_m);
                let bounds = Most::new(&air, [-20.0, 4_100.0], [1.0; BAND_COUNT]);
                for (distance_m, altitude_m) in [250.0f32, 1_900.0, 14_000.0, 61_000.0, 140_000.0, 299_000.0]
                    .into_iter()
                    .flat_map(|d| [-20.0f32, 300.0, 1_100.0, 2_750.0, 4_100.0].map(|a| (d, a)))
                {
                    let sight = Sight::new(&air, f64::from(distance_m), f64::from(altitude_m) - eye_m);
                    let step = azimuth_rad(1) as f32;
                    if sight.elevation_rad() > 0.78 {
                        continue;
                    }
                    let bound = bounds.per_m[bounds.place(altitude_m, distance_m) as usize];
                    // From half a row above it to one and a half, and not below the lowest.
                    for above in [0.5f32, 0.8, 1.2, 1.5] {
                        let elevation = (sight.elevation_rad() + above * step).max(0.5 * step);
                        let shown = one(&sight, &air, f64::from(0.5 * step), f64::from(elevation));
                        for (shown, bound) in shown.iter().zip(bound) {
                            let share = *shown as f32 * distance_m / bound;
                            assert!(share <= 1.001, "{distance_m} m, {altitude_m} m from {eye_m}: {share}");
                            closest = closest.max(share);
                        }
                    }
                }
            }
        }
        assert!(closest > 0.3, "{closest}");
    }
}
