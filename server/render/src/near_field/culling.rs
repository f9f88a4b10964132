//! Culling with conservative bounds, in blocks as in a bounding-volume hierarchy: most of a city's lights are too small a part of its
//! sky to be visible, and a few multiplications for each say so.
//!
//! Lights side by side in the list are side by side on the ground: for most blocks of them one bound rules out all.

use super::{
    air::Air,
    block_bounds::{ALTITUDE, AZIMUTH, BLOCK, BlockBounds, DISTANCE, FLUX, block_bounds},
    low_rows::{LOW_ROWS, MIN_SHARE, PER_COLUMN},
};
use crate::cpu::lanes::LANES;
use skyglow_physics::{
    AZIMUTH_COUNT, BAND_COUNT, EARTH_RADIUS_M, Panorama, near_light::trunc_to_u32, panorama::azimuth_rad,
    simd_dispatch, source_pixel::MAX_SOURCE_DISTANCE_M,
};
use skyglow_scene::NearLight;
use std::ops::RangeInclusive;

/// A value for each band, and one more, so that they lie as vectors do.
type Bands = [f32; BAND_COUNT + 1];

/// Directions and bounds over which a block may reach: a larger one is tested light by light.
const MAX_DIRECTIONS: u32 = 48;
const MAX_BOUNDS: u32 = 8;

/// Bounds on the peaks of lights and on the sky around them.
pub(crate) struct Culling {
    /// Of every block of the near lights.
    blocks: Vec<BlockBounds>,
    peaks: PeakBounds,
    /// `[row][column]`: the least of the sky's radiance around a direction, W m⁻² sr⁻¹; infinite beyond the bands and in dark ones.
    min_sky: Vec<Bands>,
    observer_altitude_m: f32,
}

impl Culling {
    pub(crate) fn new(
        air: &Air,
        lights: &[NearLight],
        flux_per_dnb_flux: [f32; BAND_COUNT],
        sky: &[f32],
    ) -> Self {
        let blocks = block_bounds(lights);
        let range_m = blocks.iter().fold([f32::INFINITY, f32::NEG_INFINITY], |[low, high], block| {
            [low.min(block.min[ALTITUDE]), high.max(block.max[ALTITUDE])]
        });
        Self {
            blocks,
            peaks: PeakBounds::new(air, range_m, flux_per_dnb_flux),
            min_sky: min_sky(sky, flux_per_dnb_flux),
            observer_altitude_m: air.observer_altitude_m as f32,
        }
    }

    /// The places of the lights that may be visible; the `first` of them starts a block.
    pub(crate) fn candidates(&self, first: usize, lights: &[NearLight]) -> Vec<u32> {
        let mut found = Vec::new();
        let blocks = &self.blocks[first / BLOCK..];
        for (start, (block, lights)) in (0..).step_by(BLOCK).zip(blocks.iter().zip(lights.chunks(BLOCK))) {
            if self.may_hold_candidates(block) {
                cull(self, start, lights, &mut found);
            }
        }
        found
    }

    /// Whether one of a block's lights may be visible: if the brightest one were the nearest, under the largest bound of theirs and
    /// beside the dimmest sky, would it?
    fn may_hold_candidates(&self, BlockBounds { min, max }: &BlockBounds) -> bool {
        let [nearest_m, farthest_m] = [min[DISTANCE], max[DISTANCE]];
        let [lower_m, upper_m] = [min[ALTITUDE], max[ALTITUDE]].map(|m| m - self.observer_altitude_m);
        let lowest = row_above(lower_m, if lower_m > 0.0 { farthest_m } else { nearest_m }, farthest_m);
        let highest = row_above(upper_m, if upper_m > 0.0 { nearest_m } else { farthest_m }, nearest_m);
        let columns = column_of(min[AZIMUTH])..=column_of(max[AZIMUTH]);
        let rows = lowest..=highest;
        let [altitudes, distances] = self.peaks.steps(min, max);
        let count = |range: &RangeInclusive<u32>| (range.end() + 1).saturating_sub(*range.start());
        if count(&rows) * count(&columns) > MAX_DIRECTIONS
            || count(&altitudes) * count(&distances) > MAX_BOUNDS
        {
            return true;
        }
        let mut min_sky = [f32::INFINITY; BAND_COUNT + 1];
        for (row, column) in rows.flat_map(|row| columns.clone().map(move |column| (row, column))) {
            let sky = &self.min_sky[(row * AZIMUTH_COUNT as u32 + column % AZIMUTH_COUNT as u32) as usize];
            for (min_sky, sky) in min_sky.iter_mut().zip(sky) {
                *min_sky = if *sky < *min_sky { *sky } else { *min_sky };
            }
        }
        let mut bound = [0f32; BAND_COUNT + 1];
        for (altitude, distance) in
            altitudes.flat_map(|altitude| distances.clone().map(move |distance| (altitude, distance)))
        {
            let peak = &self.peaks.per_m[(altitude * DISTANCE_STEPS + distance) as usize];
            for (bound, peak) in bound.iter_mut().zip(peak) {
                *bound = if *peak > *bound { *peak } else { *bound };
            }
        }
        let needed = nearest_m * MIN_SHARE;
        (0..BAND_COUNT).any(|band| max[FLUX] * bound[band] >= needed * min_sky[band])
    }
}

/// Row up to the one above a light `offset_m` above the observer: the tangent is larger than the angle. Both distances are the
/// light's own; bounds on many lights take one for the height and another for the Earth's curve.
#[inline(always)]
fn row_above(offset_m: f32, distance_m: f32, curved_m: f32) -> u32 {
    let slope = offset_m / distance_m - curved_m * (0.5 / EARTH_RADIUS_M as f32);
    trunc_to_u32((slope * (1.0 / azimuth_rad(1) as f32) + 0.5).min((LOW_ROWS - 1) as f32))
}

/// Column of an azimuth, up to 256 where it is the whole circle.
#[inline(always)]
fn column_of(azimuth_rad: f32) -> u32 {
    trunc_to_u32(azimuth_rad * PER_COLUMN)
}

simd_dispatch! {
    /// Adds the places of lights that may be visible, counted from `start` on.
    fn cull(
        culling: &Culling,
        start: u32,
        lights: &[NearLight],
        found: &mut Vec<u32>,
    ) = cull_body;
}

#[inline(always)]
fn cull_body(culling: &Culling, start: u32, lights: &[NearLight], found: &mut Vec<u32>) {
    let mut count = found.len();
    found.resize(count + lights.len(), 0);
    for (start, lights) in (start..).step_by(LANES).zip(lights.chunks(LANES)) {
        let [mut azimuth_rad, mut distance_m, mut altitude_m] = [[0f32; LANES]; 3];
        for lane in 0..LANES {
            let light = &lights[lane.min(lights.len() - 1)];
            (azimuth_rad[lane], distance_m[lane]) = (light.azimuth_rad, light.distance_m);
            altitude_m[lane] = light.altitude_m;
        }
        let [mut sky_at, mut bounds_at] = [[0u32; LANES]; 2];
        for lane in 0..LANES {
            let offset_m = altitude_m[lane] - culling.observer_altitude_m;
            let row = row_above(offset_m, distance_m[lane], distance_m[lane]);
            sky_at[lane] = row * AZIMUTH_COUNT as u32 + column_of(azimuth_rad[lane]) % AZIMUTH_COUNT as u32;
            bounds_at[lane] = culling.peaks.place(altitude_m[lane], distance_m[lane]);
        }
        for (lane, light) in lights.iter().enumerate() {
            let bound = &culling.peaks.per_m[bounds_at[lane] as usize];
            let sky = &culling.min_sky[sky_at[lane] as usize];
            let needed = light.distance_m * MIN_SHARE;
            let mut is_candidate = [false; BAND_COUNT + 1];
            for band in 0..=BAND_COUNT {
                is_candidate[band] = light.flux_dnb_w * bound[band] >= needed * sky[band];
            }
            found[count] = start + lane as u32;
            count += usize::from(is_candidate.contains(&true));
        }
    }
    found.truncate(count);
}

/// No more than the sky's radiance around a direction: of the row, one or some below it, and two columns. Nothing is visible in a
/// band in which no lamp shines.
fn min_sky(sky: &[f32], flux_per_dnb_flux: [f32; BAND_COUNT]) -> Vec<Bands> {
    let mut min_sky = vec![[f32::INFINITY; BAND_COUNT + 1]; LOW_ROWS * AZIMUTH_COUNT];
    for (row, of_row) in min_sky.chunks_exact_mut(AZIMUTH_COUNT).enumerate() {
        for band in (0..BAND_COUNT).filter(|band| flux_per_dnb_flux[*band] > 0.0) {
            let at = |row: usize| &sky[Panorama::index(band, row, 0)..][..AZIMUTH_COUNT];
            let (here, lower) = (at(row), at(row.saturating_sub(row / 8 + 1)));
            let mut of_both = [0f32; AZIMUTH_COUNT + 1];
            for column in 0..AZIMUTH_COUNT {
                of_both[column] = here[column].min(lower[column]);
            }
            of_both[AZIMUTH_COUNT] = of_both[0];
            for (column, min_sky) in of_row.iter_mut().enumerate() {
                min_sky[band] = of_both[column].min(of_both[column + 1]);
            }
        }
    }
    min_sky
}

/// [`Air::max_peak_per_m`] by altitude and distance of the light.
struct PeakBounds {
    lowest_m: f32,
    altitude_steps: u32,
    /// `[altitude][distance]`, times the flux of a band over that in the DNB; 0 beyond the bands.
    per_m: Vec<Bands>,
}

/// Steps of the altitude and of the distance of lights, metres.
const ALTITUDE_STEP_M: f32 = 500.0;
const DISTANCE_STEP_M: f32 = 5_000.0;
const DISTANCE_STEPS: u32 = (MAX_SOURCE_DISTANCE_M / DISTANCE_STEP_M as f64) as u32 + 1;

impl PeakBounds {
    fn new(air: &Air, [lowest_m, highest_m]: [f32; 2], flux_per_dnb_flux: [f32; BAND_COUNT]) -> Self {
        let altitude_steps = ((highest_m - lowest_m) / ALTITUDE_STEP_M) as u32 + 1;
        let range = |from: f32, index: u32, step: f32| {
            [index, index + 1].map(|index| f64::from(from + index as f32 * step))
        };
        let scattered = air.scattering.largest_above();
        let per_m = (0..altitude_steps * DISTANCE_STEPS).map(|at| {
            let (altitude, distance) = (at / DISTANCE_STEPS, at % DISTANCE_STEPS);
            let altitude_m = range(lowest_m, altitude, ALTITUDE_STEP_M);
            let peak = air.max_peak_per_m(scattered, altitude_m, range(0.0, distance, DISTANCE_STEP_M));
            let mut per_m = [0.0; BAND_COUNT + 1];
            for (band, peak) in peak.into_iter().enumerate() {
                per_m[band] = flux_per_dnb_flux[band] * peak;
            }
            per_m
        });
        Self { lowest_m, altitude_steps, per_m: per_m.collect() }
    }

    /// Where a light's bound is.
    #[inline(always)]
    fn place(&self, altitude_m: f32, distance_m: f32) -> u32 {
        self.altitude_step(altitude_m) * DISTANCE_STEPS + distance_step(distance_m)
    }

    #[inline(always)]
    fn altitude_step(&self, altitude_m: f32) -> u32 {
        trunc_to_u32((altitude_m - self.lowest_m) * (1.0 / ALTITUDE_STEP_M)).min(self.altitude_steps - 1)
    }

    /// Steps of altitude and distance that a block reaches over.
    fn steps(&self, min: &[f32; 4], max: &[f32; 4]) -> [RangeInclusive<u32>; 2] {
        [
            self.altitude_step(min[ALTITUDE])..=self.altitude_step(max[ALTITUDE]),
            distance_step(min[DISTANCE])..=distance_step(max[DISTANCE]),
        ]
    }
}

#[inline(always)]
fn distance_step(distance_m: f32) -> u32 {
    trunc_to_u32(distance_m * (1.0 / DISTANCE_STEP_M)).min(DISTANCE_STEPS - 1)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        near_field::sight_line::{
            SightLine,
            tests::{elevation_of, one},
        },
        synthetic::Noise,
    };
    use skyglow_physics::{
        Atmosphere, ELEVATION_COUNT, EmissionMix, Lobe, Turbidity, near_light::NearScattering,
    };
    use std::{collections::HashSet, f32::consts::TAU};

    /// Squares of 64 lights each, at every distance and all around, north too; some of them on hills.
    fn squares() -> Vec<NearLight> {
        let mut noise = Noise::new(5);
        let mut lights = Vec::new();
        for square in 0..150 {
            let [azimuth, out, hill] = std::array::from_fn(|_| noise.unit() as f32);
            let distance_m = 300.0 * 900f32.powf(out);
            for light in 0..BLOCK as u16 {
                let [east_m, north_m] = [light % 8, light / 8].map(|at| 460.0 * f32::from(at) - 1_600.0);
                lights.push(NearLight {
                    number: square * BLOCK as u32 + u32::from(light),
                    pixel_count: 1,
                    azimuth_rad: (TAU * azimuth + east_m / distance_m).rem_euclid(TAU),
                    distance_m: (distance_m + north_m).max(250.0),
                    altitude_m: 400.0 + 2_500.0 * hill * noise.unit() as f32,
                    flux_dnb_w: 1e3 * 100f32.powf(noise.unit() as f32),
                });
            }
        }
        lights.truncate(lights.len() - 10);
        lights
    }

    /// Blocks without a visible light are culled, and no other.
    #[test]
    fn only_blocks_without_candidates_are_culled() {
        let air = Air::new(
            NearScattering::of(EmissionMix::garstang()),
            &Atmosphere::new(Turbidity::new(2.5).unwrap()),
            640.0,
        );
        let near = squares();
        // Brighter below and towards the east.
        let sky: Vec<f32> = (0..Panorama::LEN)
            .map(|at| {
                let (row, column) = (at / AZIMUTH_COUNT % ELEVATION_COUNT, at % AZIMUTH_COUNT);
                let east = (column as f32 * azimuth_rad(1) as f32).sin();
                10.0 * (1.0 + 0.8 * east) / (1.0 + row as f32)
            })
            .collect();
        let mut lamp = [0.0; BAND_COUNT];
        (lamp[0], lamp[1]) = (1.0, 0.5);
        let mut culling = Culling::new(&air, &near, lamp, &sky);
        let all = |culling: &Culling| culling.candidates(0, &near);
        let mut one_by_one = Vec::new();
        cull(&culling, 0, &near, &mut one_by_one);
        assert!(one_by_one.len() > 200 && one_by_one.len() < near.len() / 3, "{}", one_by_one.len());
        assert_eq!(all(&culling), one_by_one);
        // From a later block on, as another task has them.
        let later = one_by_one.iter().filter(|at| **at >= 640).map(|at| at - 640);
        assert_eq!(culling.candidates(640, &near[640..]), later.collect::<Vec<_>>());
        let looked_at = culling.blocks.iter().filter(|block| culling.may_hold_candidates(block)).count();
        let lit = one_by_one.iter().map(|at| at / BLOCK as u32).collect::<HashSet<_>>().len();
        assert!(lit <= looked_at && looked_at < culling.blocks.len() * 2 / 3, "{lit} {looked_at}");
        // With less light than they have, blocks are culled in which some are visible.
        culling.blocks.iter_mut().for_each(|block| block.max[FLUX] *= 0.1);
        assert!(all(&culling).len() < one_by_one.len());
    }

    #[test]
    fn no_peak_exceeds_its_bound() {
        let mut closest = 0f32;
        for (turbidity, eye_m) in [(1.5, 2.0), (2.5, 640.0), (6.0, 2_900.0)] {
            let atmosphere = Atmosphere::new(Turbidity::new(turbidity).unwrap());
            for emission in [EmissionMix::garstang(), EmissionMix::only(Lobe::Oblique)] {
                let air = Air::new(NearScattering::of(emission), &atmosphere, eye_m);
                let bounds = PeakBounds::new(&air, [-20.0, 4_100.0], [1.0; BAND_COUNT]);
                for (distance_m, altitude_m) in [250.0f32, 1_900.0, 14_000.0, 61_000.0, 140_000.0, 299_000.0]
                    .into_iter()
                    .flat_map(|d| [-20.0f32, 300.0, 1_100.0, 2_750.0, 4_100.0].map(|a| (d, a)))
                {
                    let sight_line =
                        SightLine::new(&air, f64::from(distance_m), f64::from(altitude_m) - eye_m);
                    let step = azimuth_rad(1) as f32;
                    if elevation_of(&sight_line) > 0.78 {
                        continue;
                    }
                    let bound = bounds.per_m[bounds.place(altitude_m, distance_m) as usize];
                    // From half a row above it to one and a half, and not below the lowest.
                    for above in [0.5f32, 0.8, 1.2, 1.5] {
                        let elevation = (elevation_of(&sight_line) + above * step).max(0.5 * step);
                        let shown = one(&sight_line, &air, f64::from(0.5 * step), f64::from(elevation));
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
