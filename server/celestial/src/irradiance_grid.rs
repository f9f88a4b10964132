//! Light of a component on beams: irradiance outside the air by azimuth and zenith angle, for skies that single beams make.

use crate::{components::Component, heavens::Heavens, heavens::PointLight};
use glam::DVec3;
use skyglow_physics::{
    panorama::{AZIMUTH_COUNT, azimuth_rad},
    spectrum::NODE_COUNT,
};
use std::{
    f64::consts::{FRAC_PI_2, PI, TAU},
    sync::LazyLock,
};

/// Irradiance across each beam, in the unit of the component: `[node][zenith angle][azimuth]`, azimuth i at i·360/256° from north.
#[derive(Clone, Debug, PartialEq)]
pub struct IrradianceGrid {
    zenith_angles_rad: Vec<f64>,
    irradiance: Vec<f64>,
}

/// Samples of an extended component lie no farther apart than this, rad, along zenith angle.
const STEP_RAD: f64 = 2.5 * PI / 180.0;
/// One is taken every so many azimuths, 2.8° apart: finer than the tables are, and what lies in between is linear there too.
const AZIMUTH_STRIDE: usize = 2;
/// Those of airglow, which ends at the horizon where it is brightest.
pub(crate) const AIRGLOW_STEP_RAD: f64 = 0.25 * PI / 180.0;

/// Sine and cosine of every azimuth.
static AZIMUTHS: LazyLock<[(f64, f64); AZIMUTH_COUNT]> =
    LazyLock::new(|| std::array::from_fn(|azimuth| azimuth_rad(azimuth).sin_cos()));

impl IrradianceGrid {
    /// A grid of a component on zenith angles that ascend, rad, 0..=π. A beam of an extended component has the light of its cell,
    /// which reaches half-way to its neighbours: the first cell from the zenith on, the last as far beyond as before. A point of
    /// light is divided among the four beams around it; points beyond the last zenith angle are left out.
    pub fn of(heavens: &Heavens, component: Component, zenith_angles_rad: &[f64]) -> Self {
        let mut grid = Self {
            zenith_angles_rad: zenith_angles_rad.to_vec(),
            irradiance: vec![0.0; NODE_COUNT * zenith_angles_rad.len() * AZIMUTH_COUNT],
        };
        for point in heavens.points(component) {
            grid.add_point(point);
        }
        if component.is_extended() {
            for row in 0..zenith_angles_rad.len() {
                grid.add_row(heavens, component, row);
            }
        }
        grid
    }

    /// The zenith angles, rad.
    pub fn zenith_angles_rad(&self) -> &[f64] {
        &self.zenith_angles_rad
    }

    /// All values, `[node][zenith angle][azimuth]`.
    pub fn values(&self) -> &[f64] {
        &self.irradiance
    }

    /// Irradiance of one zenith angle at a node, by azimuth.
    pub fn row(&self, node: usize, zenith_angle: usize) -> &[f64] {
        &self.irradiance[self.index(node, zenith_angle, 0)..][..AZIMUTH_COUNT]
    }

    /// Sum over all beams at a node.
    pub fn total(&self, node: usize) -> f64 {
        let count = self.zenith_angles_rad.len() * AZIMUTH_COUNT;
        self.irradiance[node * count..(node + 1) * count].iter().sum()
    }

    fn index(&self, node: usize, zenith_angle: usize, azimuth: usize) -> usize {
        (node * self.zenith_angles_rad.len() + zenith_angle) * AZIMUTH_COUNT + azimuth
    }

    fn add_row(&mut self, heavens: &Heavens, component: Component, row: usize) {
        let (begin, end) = cell_rad(&self.zenith_angles_rad, row);
        let finest = if component == Component::Airglow { AIRGLOW_STEP_RAD } else { STEP_RAD };
        let count = ((end - begin) / finest).ceil().max(1.0);
        let step = (end - begin) / count;
        for ring in 0..count as usize {
            let top = begin + step * ring as f64;
            let solid_angle_sr = TAU / AZIMUTH_COUNT as f64 * (top.cos() - (top + step).cos());
            let (sin_zenith, cos_zenith) = (top + 0.5 * step).sin_cos();
            let radiance = |(sin, cos): &(f64, f64)| {
                let enu = DVec3::new(sin * sin_zenith, cos * sin_zenith, cos_zenith);
                heavens.radiance_outside_enu(component, enu)
            };
            let strided = AZIMUTHS.iter().step_by(AZIMUTH_STRIDE);
            let samples: Vec<[f64; NODE_COUNT]> = match component {
                // Airglow is the same in every azimuth.
                Component::Airglow => vec![radiance(&AZIMUTHS[0])],
                _ => strided.map(radiance).collect(),
            };
            for (place, from) in samples.iter().enumerate() {
                let to = &samples[(place + 1) % samples.len()];
                let columns = AZIMUTH_COUNT / samples.len();
                for node in 0..NODE_COUNT {
                    let first = self.index(node, row, place * columns);
                    let slope = (to[node] - from[node]) / columns as f64;
                    for (column, value) in self.irradiance[first..first + columns].iter_mut().enumerate() {
                        *value += (from[node] + slope * column as f64) * solid_angle_sr;
                    }
                }
            }
        }
    }

    fn add_point(&mut self, point: &PointLight) {
        let zenith_rad = FRAC_PI_2 - point.direction.elevation_rad;
        let angles = &self.zenith_angles_rad;
        let after = angles.partition_point(|angle| *angle < zenith_rad);
        let (first, second, down) = match (after.checked_sub(1), angles.get(after)) {
            (_, None) => return,
            (None, Some(_)) => (after, after, 0.0),
            (Some(before), Some(next)) => {
                (before, after, (zenith_rad - angles[before]) / (next - angles[before]))
            }
        };
        let place = point.direction.azimuth_rad.rem_euclid(TAU) / TAU * AZIMUTH_COUNT as f64;
        let (left, along) = (place as usize % AZIMUTH_COUNT, place.fract());
        let right = (left + 1) % AZIMUTH_COUNT;
        for (row, up) in [(first, 1.0 - down), (second, down)] {
            for (azimuth, part) in [(left, 1.0 - along), (right, along)] {
                for (node, value) in point.irradiance.into_iter().enumerate() {
                    let at = self.index(node, row, azimuth);
                    self.irradiance[at] += value * up * part;
                }
            }
        }
    }
}

/// Where the cell of a zenith angle begins and ends, rad.
pub(crate) fn cell_rad(angles: &[f64], row: usize) -> (f64, f64) {
    let half_after = angles.get(row + 1).map(|next| 0.5 * (next - angles[row]));
    let half_before = row.checked_sub(1).map(|before| 0.5 * (angles[row] - angles[before]));
    let begin = half_before.map_or(0.0, |half| angles[row] - half);
    let end = angles[row] + half_after.or(half_before).unwrap_or(PI);
    (begin, end.min(PI))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{site::Site, time::Instant};
    use proptest::prelude::*;

    fn heavens(latitude_deg: f64, longitude_deg: f64, unix_s: f64) -> Heavens {
        let site = Site::new(latitude_deg, longitude_deg, 0.0).unwrap();
        Heavens::new(site, Instant::from_unix_s(unix_s).unwrap(), 100.0).unwrap()
    }

    fn whole_sphere() -> Vec<f64> {
        (0..46).map(|step| f64::from(step) * PI / 45.0).collect()
    }

    /// Airglow of a layer: ∫ over the upper hemisphere by zenith angle alone.
    #[test]
    fn airglow_is_even_in_azimuth() {
        let heavens = heavens(30.0, 20.0, 1.77e9);
        let angles: Vec<f64> = (0..46).map(|step| f64::from(step) * PI / 90.0).collect();
        let grid = IrradianceGrid::of(&heavens, Component::Airglow, &angles);
        let exact: f64 = (0..9_000)
            .map(|step| (f64::from(step) + 0.5) * FRAC_PI_2 / 9_000.0)
            .map(|zenith| crate::airglow::van_rhijn(zenith.cos(), 0.0) * zenith.sin())
            .sum::<f64>()
            * FRAC_PI_2
            / 9_000.0
            * TAU
            * crate::airglow::zenith_s10(100.0);
        assert!((grid.total(0) / exact - 1.0).abs() < 0.005, "{} {exact}", grid.total(0));
        let row = grid.row(1, 20);
        assert!(row.iter().all(|value| (value / row[0] - 1.0).abs() < 1e-12));
    }

    /// Between the azimuths that are looked at, light is what it is there to 0.15 of the ring's mean at an edge of the Milky Way, and
    /// rings have the light that they would have with all to a thousandth: what is scattered does not know one azimuth from the next.
    #[test]
    fn azimuths_between_samples_are_near() {
        let heavens = heavens(46.0, 9.0, 1.787e9);
        let angles: Vec<f64> = (0..40).map(|step| f64::from(step) * PI / 72.0).collect();
        for component in [Component::Starlight, Component::ZodiacalLight] {
            let grid = IrradianceGrid::of(&heavens, component, &angles);
            for row in [3, 17, 30] {
                let (begin, end) = cell_rad(&angles, row);
                let (sin_zenith, cos_zenith) = (0.5 * (begin + end)).sin_cos();
                let solid_angle_sr = TAU / AZIMUTH_COUNT as f64 * (begin.cos() - end.cos());
                let exact: Vec<f64> = AZIMUTHS
                    .iter()
                    .map(|(sin, cos)| DVec3::new(sin * sin_zenith, cos * sin_zenith, cos_zenith))
                    .map(|enu| solid_angle_sr * heavens.radiance_outside_enu(component, enu)[0])
                    .collect();
                let mean = exact.iter().sum::<f64>() / AZIMUTH_COUNT as f64;
                let off = grid.row(0, row).iter().zip(&exact).map(|(found, exact)| (found - exact) / mean);
                let worst = off.clone().fold(0.0f64, |worst, off| worst.max(off.abs()));
                let bias = off.sum::<f64>() / AZIMUTH_COUNT as f64;
                println!("{component:?}, ring {row}: {worst:.4} at most, {bias:.5} in the mean");
                assert!(worst < 0.2 && bias.abs() < 1e-3, "{component:?} {row}: {worst} {bias}");
            }
        }
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(6))]

        /// The whole sphere holds the same light whatever time it is and wherever one stands.
        #[test]
        fn turning_the_sky_keeps_its_light(
            latitude in -90.0..90.0_f64, longitude in -180.0..180.0_f64, hour in 0.0..24.0_f64,
        ) {
            let angles = whole_sphere();
            let [one, two] = [(0.0, 0.0, 1.77e9), (latitude, longitude, 1.77e9 + hour * 3_600.0)]
                .map(|(latitude, longitude, unix_s)| heavens(latitude, longitude, unix_s));
            for (component, tolerance) in
                [(Component::Starlight, 0.01), (Component::ZodiacalLight, 0.02), (Component::Stars, 1e-9)]
            {
                let [one, two] = [&one, &two].map(|heavens| IrradianceGrid::of(heavens, component, &angles));
                for node in 0..NODE_COUNT {
                    let ratio = two.total(node) / one.total(node);
                    prop_assert!((ratio - 1.0).abs() < tolerance, "{component:?}: {ratio}");
                }
            }
        }
    }
}
