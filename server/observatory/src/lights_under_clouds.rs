//! How the lights around an observer lie under a layer of cloud, by which the error of tables is known (`docs/accuracy.md#overcast`).

use skyglow_scene::{PolarCell, ring_distance_m};
use skyglow_tables::clouds::ceiling_m;

/// Lights as far away are nearby, metres.
const NEARBY_M: f64 = 5_000.0;

/// How the lights around an observer lie, each counted by its flux over the squared distance.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct LightsUnderClouds {
    /// How far the observer is above the lights nearby, metres; below 0 where those are higher, 0 without any.
    pub above_lights_m: f64,
    /// Share of the light below the base that is higher than tables know lights under these clouds, 0..=1.
    pub at_clouds: f64,
}

impl LightsUnderClouds {
    /// Of the cells around an observer at an altitude, under clouds with a base at another, metres above sea level.
    pub(crate) fn of<'a>(cells: impl Iterator<Item = &'a PolarCell>, altitude_m: f64, base_m: f64) -> Self {
        let (mut nearby, mut nearby_m, mut high, mut all) = (0.0, 0.0, 0.0, 0.0);
        for cell in cells {
            let (altitude_m, distance_m) = (f64::from(cell.altitude_m), ring_distance_m(cell.ring as usize));
            if altitude_m >= base_m {
                continue;
            }
            let weight = f64::from(cell.flux_dnb_w) / distance_m.powi(2);
            all += weight;
            if altitude_m > ceiling_m(base_m) {
                high += weight;
            }
            if distance_m <= NEARBY_M {
                nearby += weight;
                nearby_m += weight * altitude_m;
            }
        }
        Self {
            above_lights_m: if nearby > 0.0 { altitude_m - nearby_m / nearby } else { 0.0 },
            at_clouds: if all > 0.0 { high / all } else { 0.0 },
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What is near and bright counts most, and what is higher than 100 m below the base is at the clouds; above them nothing counts.
    #[test]
    fn lights_count_by_flux_and_distance() {
        let cell = |ring: u32, altitude_m: f32, flux_dnb_w: f32| PolarCell {
            ring,
            altitude_m,
            flux_dnb_w,
            ..PolarCell::default()
        };
        let of = |cells: &[PolarCell]| LightsUnderClouds::of(cells.iter(), 600.0, 800.0);
        assert_eq!(of(&[]), LightsUnderClouds::default());
        let level = of(&[cell(0, 200.0, 3.0), cell(0, 400.0, 1.0)]);
        assert!((level.above_lights_m - 350.0).abs() < 1e-9 && level.at_clouds == 0.0, "{level:?}");
        // Far away nothing is nearby, and it counts little beside what is.
        let far = of(&[cell(0, 200.0, 1.0), cell(191, 750.0, 1.0)]);
        assert!((far.above_lights_m - 400.0).abs() < 1e-9, "{far:?}");
        assert!(far.at_clouds > 0.0 && far.at_clouds < 1e-5, "{far:?}");
        assert_eq!(of(&[cell(5, 750.0, 1.0), cell(5, 700.0, 1.0), cell(0, 800.0, 9.0)]).at_clouds, 0.5);
    }
}
