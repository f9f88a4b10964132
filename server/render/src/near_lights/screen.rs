//! Most of a city's lights are too small a part of its sky to show, and that is told by a few multiplications for each.
//!
//! Lights side by side in the list are side by side on the ground: of most blocks of them a bound on all shows that none can show.

use super::{
    NearLights,
    choosing::{LEAST_SHARE, LOW_ROWS},
    extents::{ALTITUDE, AZIMUTH, BLOCK, DISTANCE, Extent, FLUX, extents},
    sight::Air,
};
use crate::cpu::lanes::LANES;
use skyglow_physics::{AZIMUTH_COUNT, BAND_COUNT, EARTH_RADIUS_M, Panorama, near_light::whole_part, panorama::azimuth_rad,
    source_pixel::FARTHEST_SOURCE_M, simd_dispatch};
use skyglow_scene::NearLight;
use std::{f32::consts::TAU, ops::RangeInclusive};

/// A value for each band, and one more, so that they lie as vectors do.
type Bands = [f32; BAND_COUNT + 1];

/// Directions and bounds over which a block may reach: one that reaches over more is looked at light by light.
const MOST_DIRECTIONS: u32 = 48;
const MOST_BOUNDS: u32 = 8;

/// Bounds on what lights show and on the sky around them.
pub(crate) struct Screen {
    /// Of every block of the near lights.
    blocks: Vec<Extent>,
    most: Most,
    /// `[row][column]`: the least of the sky's radiance around a direction, W m⁻² sr⁻¹; infinite beyond the bands and in dark ones.
    dimmest: Vec<Bands>,
    observer_altitude_m: f32,
}

impl Screen {
    pub(crate) fn new(air: &Air, lights: &NearLights, sky: &[f32]) -> Self {
        let blocks = extents(&lights.polar.near);
        let range_m = blocks.iter().fold([f32::INFINITY, f32::NEG_INFINITY], |[low, high], block| {
            [low.min(block.least[ALTITUDE]), high.max(block.most[ALTITUDE])]
        });
        Self {
            blocks,
            most: Most::new(air, range_m, lights.flux_per_dnb_flux),
            dimmest: dimmest(sky, lights.flux_per_dnb_flux),
            observer_altitude_m: lights.observer_altitude_m as f32,
        }
    }

    /// The places of those lights that may show; the `first` of them starts a block.
    pub(crate) fn that_may_show(&self, first: usize, lights: &[NearLight]) -> Vec<u32> {
        let mut found = Vec::new();
        let blocks = &self.blocks[first / BLOCK..];
        for (start, (block, lights)) in (0..).step_by(BLOCK).zip(blocks.iter().zip(lights.chunks(BLOCK))) {
            if self.may_show(block) {
                screened(self, start, lights, &mut found);
            }
        }
        found
    }

    /// Whether one of a block's lights may: if the brightest one were the nearest, under the largest bound of theirs and beside
    /// the dimmest sky, would it?
    fn may_show(&self, Extent { least, most }: &Extent) -> bool {
        let [nearest_m, farthest_m] = [least[DISTANCE], most[DISTANCE]];
        let [lower_m, upper_m] = [least[ALTITUDE], most[ALTITUDE]].map(|m| m - self.observer_altitude_m);
        let lowest = row_above(lower_m, if lower_m > 0.0 { farthest_m } else { nearest_m }, farthest_m);
        let highest = row_above(upper_m, if upper_m > 0.0 { nearest_m } else { farthest_m }, nearest_m);
        let columns = column_of(least[AZIMUTH])..=column_of(most[AZIMUTH]);
        let rows = lowest..=highest;
        let [altitudes, distances] = self.most.steps(least, most);
        let count = |range: &RangeInclusive<u32>| (range.end() + 1).saturating_sub(*range.start());
        if count(&rows) * count(&columns) > MOST_DIRECTIONS
            || count(&altitudes) * count(&distances) > MOST_BOUNDS
        {
            return true;
        }
        let mut dimmest = [f32::INFINITY; BAND_COUNT + 1];
        for (row, column) in rows.flat_map(|row| columns.clone().map(move |column| (row, column))) {
            let sky = &self.dimmest[(row * AZIMUTH_COUNT as u32 + column % AZIMUTH_COUNT as u32) as usize];
            for (dimmest, sky) in dimmest.iter_mut().zip(sky) {
                *dimmest = if *sky < *dimmest { *sky } else { *dimmest };
            }
        }
        let mut bound = [0f32; BAND_COUNT + 1];
        for (altitude, distance) in
            altitudes.flat_map(|altitude| distances.clone().map(move |distance| (altitude, distance)))
        {
            let most = &self.most.per_m[(altitude * DISTANCE_STEPS + distance) as usize];
            for (bound, most) in bound.iter_mut().zip(most) {
                *bound = if *most > *bound { *most } else { *bound };
            }
        }
        let needed = nearest_m * LEAST_SHARE;
        (0..BAND_COUNT).any(|band| most[FLUX] * bound[band] >= needed * dimmest[band])
    }
}

/// Row up to the one above a light `offset_m` above the observer: the tangent is larger than the angle. Both distances are the
/// light's own; bounds on many lights take one for the climb and another for the Earth's curve.
#[inline(always)]
fn row_above(offset_m: f32, distance_m: f32, curved_m: f32) -> u32 {
    let slope = offset_m / distance_m - curved_m * (0.5 / EARTH_RADIUS_M as f32);
    whole_part((slope * (1.0 / azimuth_rad(1) as f32) + 0.5).min((LOW_ROWS - 1) as f32))
}

/// Columns a radian: which column a light is in must be one number everywhere.
pub(crate) const PER_COLUMN: f32 = AZIMUTH_COUNT as f32 / TAU;

/// Column of an azimuth, up to 256 where it is the whole circle.
#[inline(always)]
fn column_of(azimuth_rad: f32) -> u32 {
    whole_part(azimuth_rad * PER_COLUMN)
}

simd_dispatch! {
    /// Adds the places of lights that may show, counted from `start` on.
    fn screened(
        screen: &Screen,
        start: u32,
        lights: &[NearLight],
        found: &mut Vec<u32>,
    ) = screened_body::<FUSED>;
}

#[inline(always)]
fn screened_body<const FUSED: bool>(screen: &Screen, start: u32, lights: &[NearLight], found: &mut Vec<u32>) {
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
            let offset_m = altitude_m[lane] - screen.observer_altitude_m;
            let row = row_above(offset_m, distance_m[lane], distance_m[lane]);
            sky_at[lane] = row * AZIMUTH_COUNT as u32 + column_of(azimuth_rad[lane]) % AZIMUTH_COUNT as u32;
            bounds_at[lane] = screen.most.place(altitude_m[lane], distance_m[lane]);
        }
        for (lane, light) in lights.iter().enumerate() {
            let most = &screen.most.per_m[bounds_at[lane] as usize];
            let sky = &screen.dimmest[sky_at[lane] as usize];
            let needed = light.distance_m * LEAST_SHARE;
            let mut shows = [false; BAND_COUNT + 1];
            for band in 0..=BAND_COUNT {
                shows[band] = light.flux_dnb_w * most[band] >= needed * sky[band];
            }
            found[count] = start + lane as u32;
            count += usize::from(shows.contains(&true));
        }
    }
    found.truncate(count);
}

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
        self.altitude_step(altitude_m) * DISTANCE_STEPS + distance_step(distance_m)
    }

    #[inline(always)]
    fn altitude_step(&self, altitude_m: f32) -> u32 {
        whole_part((altitude_m - self.lowest_m) * (1.0 / ALTITUDE_STEP_M)).min(self.altitude_steps - 1)
    }

    /// Steps of altitude and distance that a block reaches over.
    fn steps(&self, least: &[f32; 4], most: &[f32; 4]) -> [RangeInclusive<u32>; 2] {
        [
            self.altitude_step(least[ALTITUDE])..=self.altitude_step(most[ALTITUDE]),
            distance_step(least[DISTANCE])..=distance_step(most[DISTANCE]),
        ]
    }
}

#[inline(always)]
fn distance_step(distance_m: f32) -> u32 {
    whole_part(distance_m * (1.0 / DISTANCE_STEP_M)).min(DISTANCE_STEPS - 1)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        near_lights::sight::{
            Sight,
            tests::{elevation_of, one},
        },
        synthetic::{Noise, dark_grid},
    };
    use skyglow_physics::{
        Atmosphere, ELEVATION_COUNT, EmissionMix, Lobe, Turbidity, near_light::NearScattering,
    };
    use skyglow_scene::PolarGrid;
    use std::{collections::HashSet, sync::Arc};

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

    #[test]
    fn blocks_in_which_no_light_shows_are_passed_over_and_no_other() {
        let air = Air::new(
            NearScattering::of(EmissionMix::garstang()),
            &Atmosphere::new(Turbidity::new(2.5).unwrap()),
            640.0,
        );
        let near = squares();
        let lights = NearLights {
            polar: Arc::new(PolarGrid { near: near.clone(), ..dark_grid() }),
            observer_altitude_m: 640.0,
            turbidity: Turbidity::new(2.5).unwrap(),
            emission: EmissionMix::garstang(),
            flux_per_dnb_flux: [1.0, 0.5, 0.0],
        };
        // Brighter below and towards the east.
        let sky: Vec<f32> = (0..Panorama::LEN)
            .map(|at| {
                let (row, column) = (at / AZIMUTH_COUNT % ELEVATION_COUNT, at % AZIMUTH_COUNT);
                let east = (column as f32 * azimuth_rad(1) as f32).sin();
                10.0 * (1.0 + 0.8 * east) / (1.0 + row as f32)
            })
            .collect();
        let mut screen = Screen::new(&air, &lights, &sky);
        let all = |screen: &Screen| screen.that_may_show(0, &near);
        let mut one_by_one = Vec::new();
        screened(&screen, 0, &near, &mut one_by_one);
        assert!(one_by_one.len() > 200 && one_by_one.len() < near.len() / 3, "{}", one_by_one.len());
        assert_eq!(all(&screen), one_by_one);
        // From a later block on, as another task has them.
        let later = one_by_one.iter().filter(|at| **at >= 640).map(|at| at - 640);
        assert_eq!(screen.that_may_show(640, &near[640..]), later.collect::<Vec<_>>());
        let looked_at = screen.blocks.iter().filter(|block| screen.may_show(block)).count();
        let lit = one_by_one.iter().map(|at| at / BLOCK as u32).collect::<HashSet<_>>().len();
        assert!(lit <= looked_at && looked_at < screen.blocks.len() * 2 / 3, "{lit} {looked_at}");
        // With less light than they have, blocks are passed over in which some shows.
        screen.blocks.iter_mut().for_each(|block| block.most[FLUX] *= 0.1);
        assert!(all(&screen).len() < one_by_one.len());
    }

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
                    if elevation_of(&sight) > 0.78 {
                        continue;
                    }
                    let bound = bounds.per_m[bounds.place(altitude_m, distance_m) as usize];
                    // From half a row above it to one and a half, and not below the lowest.
                    for above in [0.5f32, 0.8, 1.2, 1.5] {
                        let elevation = (elevation_of(&sight) + above * step).max(0.5 * step);
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
