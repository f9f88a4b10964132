//! Which near lights are visible in a sky, and how much of each counts.

use super::{
    air::Air,
    block_bounds::BLOCK,
    culling::Culling,
    low_rows::{LOW_ROWS, MAX_ROW, MIN_SHARE, PER_COLUMN, ROWS},
    patch::{PatchNodes, SelectedLight},
    sight_line::{SightLine, SightLines},
};
use crate::{cpu::lanes::LANES, table_set::TableSet};
use rayon::prelude::*;
use skyglow_physics::{
    AZIMUTH_COUNT, BAND_COUNT, Panorama, near_light::trunc_to_u32, panorama::azimuth_rad, simd_dispatch,
};
use skyglow_scene::NearLight;
use std::sync::LazyLock;

/// Rows below [`MAX_ROW`] from which on a light counts in full.
const TAPER_ROWS: f32 = 8.0;
/// Below the lowest row by more than a patch reaches.
const MIN_ROW: f32 = -4.0;
/// Sine and cosine of half a column's width, which is half a row's height.
static HALF_A_COLUMN: LazyLock<[f32; 2]> = LazyLock::new(|| {
    let (sin, cos) = (0.5 * azimuth_rad(1)).sin_cos();
    [sin as f32, cos as f32]
});
/// Lights that a task looks through: whole blocks.
const LIGHTS_PER_TASK: usize = 16 * BLOCK;

/// Selects the lights that are visible in a sky.
pub(crate) struct Selector<'a> {
    lights: &'a [NearLight],
    flux_per_dnb_flux: [f32; BAND_COUNT],
    air: &'a Air,
    set: &'a TableSet,
    sky: &'a [f32],
    culling: Culling,
}

impl<'a> Selector<'a> {
    pub(crate) fn new(
        lights: &'a [NearLight],
        flux_per_dnb_flux: [f32; BAND_COUNT],
        air: &'a Air,
        set: &'a TableSet,
        sky: &'a [f32],
    ) -> Self {
        let culling = Culling::new(air, lights, flux_per_dnb_flux, sky);
        Self { lights, flux_per_dnb_flux, air, set, sky, culling }
    }

    /// The visible lights, those that share patches side by side.
    pub(crate) fn select(&self) -> Vec<SelectedLight> {
        let of_task = |(task, lights): (usize, &[NearLight])| {
            let first = task * LIGHTS_PER_TASK;
            let mut selected = Vec::new();
            for together in self.culling.candidates(first, lights).chunks(LANES) {
                self.select_some(first, lights, together, &mut selected);
            }
            selected
        };
        let mut selected: Vec<SelectedLight> =
            self.lights.par_chunks(LIGHTS_PER_TASK).enumerate().flat_map_iter(of_task).collect();
        selected.par_sort_unstable_by_key(|light| (light.nodes.key(), light.index));
        selected
    }

    /// Adds those of up to [`LANES`] lights whose peaks are visible: `together` are their places among `lights`, of which the first is
    /// the `first` of the near ones.
    fn select_some(
        &self,
        first: usize,
        lights: &[NearLight],
        together: &[u32],
        selected: &mut Vec<SelectedLight>,
    ) {
        let mut peaks = Peaks::default();
        let light = |lane: usize| lights[together[lane.min(together.len() - 1)] as usize];
        peak(self.air, &std::array::from_fn(light), &mut peaks);
        for (lane, index) in together.iter().enumerate() {
            let light = lights[*index as usize];
            let row = peaks.row[lane];
            if !(MIN_ROW..MAX_ROW).contains(&row) {
                continue;
            }
            let column = light.azimuth_rad * PER_COLUMN;
            let left = column as usize % AZIMUTH_COUNT;
            let share = (0..BAND_COUNT).map(|band| {
                let at =
                    |column: usize| self.sky[Panorama::index(band, nearest_row(row), column % AZIMUTH_COUNT)];
                let flux = light.flux_dnb_w * self.flux_per_dnb_flux[band];
                flux * peaks.peak[band][lane] / at(left).min(at(left + 1)).max(f32::MIN_POSITIVE)
            });
            let share = share.fold(0.0, f32::max);
            let weight = (share / MIN_SHARE - 1.0).clamp(0.0, 1.0) * ((MAX_ROW - row) / TAPER_ROWS).min(1.0);
            if weight > 0.0 {
                let offset_m = (f64::from(light.altitude_m) - self.air.observer_altitude_m) as f32;
                let (nodes, fractions) = PatchNodes::of(self.set, light.distance_m, offset_m, row);
                selected.push(SelectedLight {
                    index: first as u32 + index,
                    nodes,
                    fractions,
                    sight_line: peaks.sight_lines[lane],
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
    sight_lines: [SightLine; LANES],
    /// Their elevations in rows.
    row: [f32; LANES],
    /// Radiance per watt half a column beside each, and half a row above it if there is a row, m⁻² sr⁻¹.
    peak: [[f32; LANES]; BAND_COUNT],
}

simd_dispatch! {
    /// Some lights as an observer sees them.
    fn peak(air: &Air, lights: &[NearLight; LANES], peaks: &mut Peaks) = peak_body::<FUSED>;
}

#[inline(always)]
fn peak_body<const FUSED: bool>(air: &Air, lights: &[NearLight; LANES], peaks: &mut Peaks) {
    let step = azimuth_rad(1) as f32;
    let [sin_aside, cos_aside] = *HALF_A_COLUMN;
    let (mut distance_m, mut offset_m) = ([0f64; LANES], [0f64; LANES]);
    for (lane, light) in lights.iter().enumerate() {
        distance_m[lane] = f64::from(light.distance_m);
        offset_m[lane] = f64::from(light.altitude_m) - air.observer_altitude_m;
    }
    let sight_lines = SightLines::new(air, &distance_m, &offset_m);
    let [mut sines, mut cosines] = sight_lines.elevations();
    let mut is_row = [false; LANES];
    let mut nearest = [0u32; LANES];
    for (lane, elevation_rad) in sight_lines.elevations_rad().into_iter().enumerate() {
        let row = elevation_rad / step - 0.5;
        peaks.row[lane] = row;
        nearest[lane] = trunc_to_u32((row + 0.5).min((LOW_ROWS - 1) as f32));
        // Half a row above it, or in the row above it where that is higher.
        is_row[lane] = row + 0.5 <= nearest[lane] as i32 as f32;
        let (sin, cos) = (sines[lane], cosines[lane]);
        (sines[lane], cosines[lane]) = (sin * cos_aside + cos * sin_aside, cos * cos_aside - sin * sin_aside);
    }
    for lane in (0..LANES).filter(|lane| is_row[*lane]) {
        [sines[lane], cosines[lane]] = ROWS[nearest[lane] as usize];
    }
    peaks.sight_lines = std::array::from_fn(|lane| sight_lines.alone(lane));
    let transmittance = sight_lines.transmittance::<FUSED>(air, [&sines, &cosines]);
    let aside = [&[cos_aside; LANES], &[sin_aside; LANES]];
    peaks.peak = sight_lines.radiance::<FUSED>(air, transmittance, [&sines, &cosines], aside);
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::near_field::sight_line::tests::{elevation_of, one};
    use skyglow_physics::{Atmosphere, EmissionMix, Turbidity, near_light::NearScattering, simd};

    fn light(number: u32, distance_m: f32, altitude_m: f32) -> NearLight {
        NearLight { number, pixel_count: 1, azimuth_rad: 1.0, distance_m, altitude_m, flux_dnb_w: 1.0 }
    }

    #[test]
    fn lights_side_by_side_are_seen_as_alone() {
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
            peak(&air, &lights, &mut together);
            for lane in 0..LANES {
                let mut alone = Peaks::default();
                peak(&air, &[lights[lane]; LANES], &mut alone);
                assert_eq!(together.row[lane], alone.row[0]);
                assert_eq!(together.peak.map(|of_band| of_band[lane]), alone.peak.map(|of_band| of_band[0]));
                // By the forms for one light, half a column beside it in the row above it or half a row higher.
                let sight_line = SightLine::new(
                    &air,
                    f64::from(lights[lane].distance_m),
                    f64::from(lights[lane].altitude_m) - 640.0,
                );
                let elevation = (elevation_of(&sight_line) + 0.5 * azimuth_rad(1) as f32)
                    .max(0.5 * azimuth_rad(1) as f32 * (1.0 + 2.0 * nearest_row(together.row[lane]) as f32));
                let alone = one(&sight_line, &air, 0.5 * azimuth_rad(1), f64::from(elevation));
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
