//! The kernel of one source in f64, over all of its ranges: turbidity 1 to 10, 250 m to 300 km, 0 to 9 000 m, sources
//! beside, under and above the observer, rays that pass through them.

use crate::{
    checks::{Check, Outcome, Report},
    detectors::{Faults, lost_digits},
    rig::Bench,
};
use rayon::prelude::*;
use skyglow_physics::{
    Atmosphere, BAND_COUNT, LOBE_COUNT, Turbidity,
    panorama::{ELEVATION_COUNT, elevation_rad},
    single_source::{SourceGeometry, radiance_per_watt},
};
use std::f64::consts::{FRAC_PI_2, PI};

/// Turbidities of the kernel, all asked for at once.
const TURBIDITIES: [f64; 10] = [1.0, 1.000_001, 1.5, 2.0, 3.0, 4.0, 5.0, 6.0, 8.0, 10.0];
/// Numbers of one ray.
const N: usize = TURBIDITIES.len() * BAND_COUNT * LOBE_COUNT;
/// Below this nothing is seen however bright the source: 1e12 W would give a thousandth of the natural sky.
const FLOOR_PER_M2_SR: f64 = 1e-22;

/// One source and one ray.
#[derive(Clone, Copy, Debug)]
struct Case {
    geometry: SourceGeometry,
    azimuth_rad: f64,
    elevation_rad: f64,
}

impl Case {
    fn radiance(self, atmospheres: &[Atmosphere], tolerance: f64) -> [f64; N] {
        radiance_per_watt(
            atmospheres,
            &self.geometry,
            self.azimuth_rad,
            self.elevation_rad,
            tolerance,
            FLOOR_PER_M2_SR,
        )
    }
}

pub(crate) fn run(_: &Bench, report: &mut Report) -> Outcome {
    let atmospheres = atmospheres()?;
    let (ordinary, aimed) = (cases(&DISTANCES_M), aimed_cases());
    finite(report, &atmospheres, "whole grid of places", &ordinary);
    finite(report, &atmospheres, "aimed at the source", &aimed);
    digits(report, &atmospheres, &ordinary);
    mirrored(report, &atmospheres, &ordinary);
    clean_air(report, &atmospheres, &ordinary);
    Ok(())
}

fn atmospheres() -> Result<Vec<Atmosphere>, skyglow_physics::PhysicsError> {
    TURBIDITIES.into_iter().map(|turbidity| Turbidity::new(turbidity).map(Atmosphere::new)).collect()
}

/// 0 m is right under or above the observer, which a scene never has: there nothing is nearer than 250 m.
const DISTANCES_M: [f64; 8] = [0.0, 250.0, 251.0, 1_000.0, 5_000.0, 20_000.0, 100_000.0, 300_000.0];

fn cases(distances_m: &[f64]) -> Vec<Case> {
    let mut cases = Vec::new();
    for &distance_m in distances_m {
        for source_altitude_m in [0.0, 100.0, 3_000.0, 9_000.0] {
            for observer_altitude_m in [0.0, 100.0, 3_000.0, 9_000.0] {
                // Two at one place are no geometry: the source would be the eye.
                if distance_m == 0.0 && source_altitude_m == observer_altitude_m {
                    continue;
                }
                let geometry = SourceGeometry { distance_m, source_altitude_m, observer_altitude_m };
                for azimuth_rad in [0.0, 1e-9, PI / 3.0, PI - 1e-9, PI] {
                    for elevation_rad in
                        [0.0, elevation_rad(0), 0.3, elevation_rad(ELEVATION_COUNT - 1), FRAC_PI_2]
                    {
                        cases.push(Case { geometry, azimuth_rad, elevation_rad });
                    }
                }
            }
        }
    }
    cases
}

/// Rays from below straight through the source, and just beside it.
fn aimed_cases() -> Vec<Case> {
    let mut cases = Vec::new();
    for distance_m in [0.0f64, 250.0, 2_000.0, 20_000.0] {
        for above_m in [1.0, 100.0, 249.0, 1_000.0, 8_000.0f64] {
            let geometry =
                SourceGeometry { distance_m, source_altitude_m: 600.0 + above_m, observer_altitude_m: 600.0 };
            let straight_rad = if distance_m == 0.0 { FRAC_PI_2 } else { (above_m / distance_m).atan() };
            for off_rad in [0.0, 1e-12, 1e-6, -1e-6] {
                let elevation_rad = (straight_rad + off_rad).clamp(0.0, FRAC_PI_2);
                cases.push(Case { geometry, azimuth_rad: 0.0, elevation_rad });
            }
        }
    }
    cases
}

fn finite(report: &mut Report, atmospheres: &[Atmosphere], name: &str, cases: &[Case]) {
    let faults = cases.par_iter().map(|case| Faults::of(case.radiance(atmospheres, 1e-6))).reduce(
        Faults::default,
        |mut sum, faults| {
            sum += faults;
            sum
        },
    );
    let mut broken = cases[0].radiance(atmospheres, 1e-6);
    broken[N / 2] = -1e-30 - broken[N / 2];
    let planted = Faults::of(broken).total() as f64;
    let check = Check::new(name, "values NaN, infinite or negative", cases.len() * N);
    report.add(
        check.found(faults.total() as f64, 0.0, planted).note(format!("{faults:?}; planted: one negative")),
    );
}

/// The largest share by which two quadratures of one ray differ, over the cases.
fn largest(cases: &[Case], error: impl Fn(&Case) -> f64 + Sync) -> (f64, Option<Case>) {
    let worse = |a: (f64, Option<Case>), b: (f64, Option<Case>)| if b.0 > a.0 { b } else { a };
    cases.par_iter().map(|case| (error(case), Some(*case))).reduce(|| (0.0, None), worse)
}

/// |a − b| over the larger of b and the floor.
fn difference(a: [f64; N], b: [f64; N]) -> f64 {
    lost_digits(a, b, b.map(|value| value.max(FLOOR_PER_M2_SR)))
}

/// A tolerance of 1e-6 against one of 1e-9: the digits that quadrature says it has.
fn digits(report: &mut Report, atmospheres: &[Atmosphere], cases: &[Case]) {
    let error = |tolerance: f64| {
        move |case: &Case| difference(case.radiance(atmospheres, tolerance), case.radiance(atmospheres, 1e-9))
    };
    let (worst, at) = largest(cases, error(1e-6));
    let (planted, _) = largest(cases, error(1e-2));
    let check = Check::new("quadrature to 1e-6 against 1e-9", "relative difference", cases.len() * N);
    report.add(check.found(worst, 2e-6, planted).note(format!("{at:?}; planted: a tolerance of 1e-2")));
}

fn mirrored(report: &mut Report, atmospheres: &[Atmosphere], cases: &[Case]) {
    let error = |off_rad: f64| {
        move |case: &Case| {
            let mirror = Case { azimuth_rad: off_rad - case.azimuth_rad, ..*case };
            difference(mirror.radiance(atmospheres, 1e-6), case.radiance(atmospheres, 1e-6))
        }
    };
    let (worst, at) = largest(cases, error(0.0));
    let (planted, _) = largest(cases, error(1e-3));
    let check = Check::new("left and right of the source alike", "relative difference", cases.len() * N);
    report.add(check.found(worst, 1e-12, planted).note(format!("{at:?}; planted: 1e-3 rad")));
}

/// Haze that goes to nothing: turbidity 1 + 1e-6 is turbidity 1 but for about 1e-5.
fn clean_air(report: &mut Report, atmospheres: &[Atmosphere], cases: &[Case]) {
    const PER_AIR: usize = BAND_COUNT * LOBE_COUNT;
    let step = |hazier: usize| {
        move |case: &Case| {
            let values = case.radiance(atmospheres, 1e-9);
            let (clean, hazy) = (&values[..PER_AIR], &values[hazier * PER_AIR..][..PER_AIR]);
            let floored = clean.iter().map(|value| value.max(FLOOR_PER_M2_SR));
            lost_digits(hazy.iter().copied(), clean.iter().copied(), floored)
        }
    };
    let (worst, at) = largest(cases, step(1));
    let (planted, _) = largest(cases, step(2));
    let check = Check::new("turbidity 1.000001 beside 1", "relative difference", cases.len() * PER_AIR);
    report.add(check.found(worst, 1e-4, planted).note(format!("{at:?}; planted: turbidity 1.5")));
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The kernel is finite and symmetric beside, under and above the source.
    #[test]
    fn the_kernel_is_finite_and_symmetric() {
        let atmospheres = atmospheres().unwrap();
        let mut report = Report::new();
        report.run("kernel", |report| {
            let few = cases(&[0.0, 250.0, 300_000.0]);
            finite(report, &atmospheres, "few places", &few);
            finite(report, &atmospheres, "aimed at the source", &aimed_cases());
            mirrored(report, &atmospheres, &few);
            Ok(())
        });
        assert_eq!(report.failed(), 0);
    }
}
