//! Which near lights show in a sky, and by how much they count.

use super::{
    NearLights, ROWS,
    extents::BLOCK,
    patch::{Chosen, Place},
    screen::{PER_COLUMN, Screen},
    sight::{Air, Sight, Sights},
};
use crate::{
    cpu::lanes::LANES,
    table_set::TableSet,
};
use rayon::prelude::*;
use skyglow_physics::{AZIMUTH_COUNT, BAND_COUNT, Panorama, near_light::whole_part, panorama::azimuth_rad, simd_dispatch};
use skyglow_scene::NearLight;
use std::sync::LazyLock;

/// A light's peak counts in full from twice this part of the sky's radiance on, and not at all below it.
pub(crate) const LEAST_SHARE: f32 = 0.002;
/// Lights this many rows up (45°) count for nothing, and in full so many rows below: no ridge stands there.
const HIGHEST_ROW: f32 = 32.0;
const ROWS_TO_NOTHING: f32 = 8.0;
/// Below the lowest row by more than a patch reaches.
const LOWEST_ROW: f32 = -4.0;
/// Sine and cosine of half a column's width, which is half a row's height.
static HALF_A_COLUMN: LazyLock<[f32; 2]> = LazyLock::new(|| {
    let (sin, cos) = (0.5 * azimuth_rad(1)).sin_cos();
    [sin as f32, cos as f32]
});
/// Lights that a task looks through: whole blocks.
const LOOKED_THROUGH: usize = 16 * BLOCK;

/// The sky in which lights are to show.
pub(crate) struct Choosing<'a> {
    of: &'a NearLights,
    air: &'a Air,
    set: &'a TableSet,
    sky: &'a [f32],
    screen: Screen,
}

impl<'a> Choosing<'a> {
    pub(crate) fn new(of: &'a NearLights, air: &'a Air, set: &'a TableSet, sky: &'a [f32]) -> Self {
        Self { of, air, set, sky, screen: Screen::new(air, of, sky) }
    }

    /// The lights that show, those that share patches side by side.
    pub(crate) fn chosen(&self) -> Vec<Chosen> {
        let near = &self.of.polar.near;
        let of_task = |(task, lights): (usize, &[NearLight])| {
            let first = task * LOOKED_THROUGH;
            let mut chosen = Vec::new();
            for together in self.screen.that_may_show(first, lights).chunks(LANES) {
                self.choose(first, lights, together, &mut chosen);
            }
            chosen
        };
        let mut chosen: Vec<Chosen> =
            near.par_chunks(LOOKED_THROUGH).enumerate().flat_map_iter(of_task).collect();
        chosen.par_sort_unstable_by_key(|light| (light.place.key(), light.index));
        chosen
    }

    /// Adds those of up to [`LANES`] lights whose peaks show: `together` are their places among `lights`, of which the first is
    /// the `first` of the near ones.
    fn choose(&self, first: usize, lights: &[NearLight], together: &[u32], chosen: &mut Vec<Chosen>) {
        let mut peaks = Peaks::default();
        let light = |lane: usize| lights[together[lane.min(together.len() - 1)] as usize];
        peak(self.air, self.of.observer_altitude_m, &std::array::from_fn(light), &mut peaks);
        for (lane, index) in together.iter().enumerate() {
            let light = lights[*index as usize];
            let row = peaks.row[lane];
            if !(LOWEST_ROW..HIGHEST_ROW).contains(&row) {
                continue;
            }
            let column = light.azimuth_rad * PER_COLUMN;
            let left = column as usize % AZIMUTH_COUNT;
            let share = (0..BAND_COUNT).map(|band| {
                let at =
                    |column: usize| self.sky[Panorama::index(band, nearest_row(row), column % AZIMUTH_COUNT)];
                let flux = light.flux_dnb_w * self.of.flux_per_dnb_flux[band];
                flux * peaks.peak[band][lane] / at(left).min(at(left + 1)).max(f32::MIN_POSITIVE)
            });
            let share = share.fold(0.0, f32::max);
            let weight = (share / LEAST_SHARE - 1.0).clamp(0.0, 1.0)
                * ((HIGHEST_ROW - row) / ROWS_TO_NOTHING).min(1.0);
            if weight > 0.0 {
                let offset_m = (f64::from(light.altitude_m) - self.of.observer_altitude_m) as f32;
                let (place, between) = Place::of(self.set, light.distance_m, offset_m, row);
                chosen.push(Chosen {
                    index: first as u32 + index,
                    place,
                    between,
                    sight: peaks.sight[lane],
                    row,
                    column,
                    flux_dnb_w: light.flux_dnb_w,
                    weight,
                });
            }
        }
    }
}

/// The row nearest above a light.
fn nearest_row(row: f32) -> usize {
    (row + 0.5).max(0.0) as usize
}

/// Some lights as they are seen.
#[derive(Default)]
pub(crate) struct Peaks {
    sight: [Sight; LANES],
    /// Their elevations in rows.
    row: [f32; LANES],
    /// Radiance per watt half a column beside each, and half a row above it if there is a row, m⁻² sr⁻¹.
    peak: [[f32; LANES]; BAND_COUNT],
}

simd_dispatch! {
    /// Some lights as an observer sees them.
    fn peak(
        air: &Air,
        observer_altitude_m: f64,
        lights: &[NearLight; LANES],
        peaks: &mut Peaks,
    ) = peak_body::<FUSED>;
}

#[inline(always)]
fn peak_body<const FUSED: bool>(
    air: &Air,
    observer_altitude_m: f64,
    lights: &[NearLight; LANES],
    peaks: &mut Peaks,
) {
    let step = azimuth_rad(1) as f32;
    let [sin_aside, cos_aside] = *HALF_A_COLUMN;
    let (mut distance_m, mut offset_m) = ([0f64; LANES], [0f64; LANES]);
    for (lane, light) in lights.iter().enumerate() {
        distance_m[lane] = f64::from(light.distance_m);
        offset_m[lane] = f64::from(light.altitude_m) - observer_altitude_m;
    }
    let sights = Sights::new(air, &distance_m, &offset_m);
    let [mut sines, mut cosines] = sights.elevations();
    let mut is_row = [false; LANES];
    let mut nearest = [0u32; LANES];
    for (lane, elevation_rad) in sights.elevations_rad().into_iter().enumerate() {
        let row = elevation_rad / step - 0.5;
        peaks.row[lane] = row;
        nearest[lane] = whole_part((row + 0.5).min((LOW_ROWS - 1) as f32));
        // Half a row above it, or in the row above it where that is higher.
        is_row[lane] = row + 0.5 <= nearest[lane] as i32 as f32;
        let (sin, cos) = (sines[lane], cosines[lane]);
        (sines[lane], cosines[lane]) = (sin * cos_aside + cos * sin_aside, cos * cos_aside - sin * sin_aside);
    }
    for lane in (0..LANES).filter(|lane| is_row[*lane]) {
        [sines[lane], cosines[lane]] = ROWS[nearest[lane] as usize];
    }
    peaks.sight = std::array::from_fn(|lane| sights.alone(lane));
    let through = sights.through::<FUSED>(air, [&sines, &cosines]);
    let aside = [&[cos_aside; LANES], &[sin_aside; LANES]];
    peaks.peak = sights.radiance::<FUSED>(air, through, [&sines, &cosines], aside);
}

/// Rows in which lights may show.
pub(crate) const LOW_ROWS: usize = HIGHEST_ROW as usize + 2;

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        near_lights::sight::tests::{elevation_of, one},
    };
    use skyglow_physics::{Atmosphere, EmissionMix, Turbidity, near_light::NearScattering, simd};

    fn light(number: u32, distance_m: f32, altitude_m: f32) -> NearLight {
        NearLight { number, pixel_count: 1, azimuth_rad: 1.0, distance_m, altitude_m, flux_dnb_w: 1.0 }
    }

    #[test]
    fn lights_side_by_side_are_seen_as_each_alone() {
        let air = Air::new(
            NearScattering::of(EmissionMix::garstang()),
            &Atmosphere::new(Turbidity::new(2.5).unwrap()),
            640.0,
        );
        let lights: [NearLight; LANES] = std::array::from_fn(|lane| {
            light(lane as u32, 400.0 * 2f32.powi(lane as i32), 600.0 + 90.0 * lane as f32)
        });
        let compare = || {
            let mut together = Peaks::default();
            peak(&air, 640.0, &lights, &mut together);
            for lane in 0..LANES {
                let mut alone = Peaks::default();
                peak(&air, 640.0, &[lights[lane]; LANES], &mut alone);
                assert_eq!(together.row[lane], alone.row[0]);
                assert_eq!(together.peak.map(|of_band| of_band[lane]), alone.peak.map(|of_band| of_band[0]));
                // By the forms for one light, half a column beside it in the row above it or half a row higher.
                let sight = Sight::new(
                    &air,
                    f64::from(lights[lane].distance_m),
                    f64::from(lights[lane].altitude_m) - 640.0,
                );
                let elevation = (elevation_of(&sight) + 0.5 * azimuth_rad(1) as f32)
                    .max(0.5 * azimuth_rad(1) as f32 * (1.0 + 2.0 * nearest_row(together.row[lane]) as f32));
                let alone = one(&sight, &air, 0.5 * azimuth_rad(1), f64::from(elevation));
                for (together, alone) in together.peak.iter().zip(alone) {
                    let together = f64::from(together[lane]);
                    assert!((together / alone - 1.0).abs() < 1e-3, "{lane}: {together} {alone}");
                }
            }
        };
        compare();
        simd::with_baseline(compare);
    }
}
