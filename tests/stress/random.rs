//! Random scenes: 1 to 200 lit cells of any column, ring, altitude and skyline, under any air. Where one breaks a rule,
//! proptest takes cells away until no smaller scene breaks it, and the note says what is left.

use crate::{
    checks::{Check, Outcome, Report},
    detectors::{Faults, lost_digits},
    rig::{Bench, Lamp, Rig, grid_of, row_maxima, widened},
};
use proptest::{
    prelude::*,
    test_runner::{Config, RngAlgorithm, TestError, TestRng, TestRunner},
};
use skyglow_physics::{BAND_COUNT, EmissionMix, Turbidity, error_metric::BAND_FLOOR_W_M2_SR};
use skyglow_render::{RenderRequest, synthetic};
use skyglow_scene::RING_COUNT;
use std::{cell::RefCell, error::Error};

/// A scene and what it is seen through.
#[derive(Clone, Debug)]
struct Scene {
    lamps: Vec<Lamp>,
    observer_altitude_m: f64,
    turbidity: f64,
    emission: [f64; 3],
    basis: usize,
}

/// What one scene gave: each figure the worst of both executors.
#[derive(Clone, Copy, Debug, Default)]
struct Figures {
    faults: usize,
    /// Difference of the executors, of the row's brightest.
    apart: f64,
    /// Largest loss of light in any direction when a lamp is added, of the row's brightest; of all functions alone, for
    /// few of them are a glow with dark rings.
    darker: f64,
    /// The same of the mean over the grid of a band.
    darker_mean: f64,
}

/// What the figures may be.
struct Limits {
    apart: f64,
    darker: f64,
    darker_mean: f64,
}

/// What f32 and the packs leave. Executors: rounding where functions cancel, as in `digits`. A single direction: packs of
/// 64 functions are negative by up to half of a row's brightest where a lamp right below an eye kilometres up should be
/// black. The whole sky: nothing but rounding.
const SHIPPED: Limits = Limits { apart: 1e-2, darker: 0.8, darker_mean: 1e-3 };
/// The same of made-up packs.
const MADE_UP: Limits = Limits { apart: 1e-3, darker: 0.5, darker_mean: 1e-3 };

pub(crate) fn run(bench: &Bench, report: &mut Report) -> Outcome {
    explore(report, "packs that come along", &bench.shipped, 150, &SHIPPED)?;
    let made_up = Rig::of(synthetic::table_set_with_skylines(&[1.5, 2.0, 2.5, 3.5, 4.75, 6.0], 16))?;
    explore(report, "made-up packs", &made_up, 150, &MADE_UP)?;
    against_f64(report, &made_up, 30)
}

fn lamp() -> impl Strategy<Value = Lamp> {
    let open_or_not = prop_oneof![2 => Just(0u32), 1 => 1..8u32];
    let altitude_m = prop_oneof![4 => 0.0..3_000.0f32, 1 => -500.0..9_000.0f32];
    (0..256usize, 0..RING_COUNT as u32, -6.0..9.0f32, altitude_m, open_or_not).prop_map(
        |(column, ring, log_flux, altitude_m, blocking)| Lamp {
            column,
            ring,
            flux_dnb_w: 10f32.powf(log_flux),
            altitude_m,
            blocking,
        },
    )
}

fn scene(basis: usize) -> impl Strategy<Value = Scene> {
    let turbidity =
        prop_oneof![3 => 1.5..6.0f64, 1 => prop::sample::select(vec![1.5, 2.0, 2.5, 3.5, 4.75, 6.0])];
    let emission =
        prop_oneof![Just([0.46, 0.54, 0.0]), Just([0.0, 0.0, 1.0]), prop::array::uniform3(1e-12..1.0f64)];
    (
        prop::collection::vec(lamp(), 1..=200),
        0.0..=6_000.0f64,
        turbidity,
        emission,
        prop_oneof![2 => Just(basis), 1 => 1..=basis],
    )
        .prop_map(|(lamps, observer_altitude_m, turbidity, emission, basis)| Scene {
            lamps,
            observer_altitude_m,
            turbidity,
            emission,
            basis,
        })
}

fn request(rig: &Rig, scene: &Scene, lamps: &[Lamp]) -> Result<RenderRequest, Box<dyn Error>> {
    let mut request = rig.request(grid_of(lamps))?;
    request.observer_altitude_m = scene.observer_altitude_m;
    request.turbidity = Turbidity::new(scene.turbidity)?;
    request.emission = EmissionMix::new(scene.emission)?;
    request.basis = Some(scene.basis);
    Ok(request)
}

fn floored(sky: &[f32]) -> Vec<f64> {
    let wide: Vec<f64> = widened(sky).collect();
    row_maxima(&wide).into_iter().map(|value| value.max(BAND_FLOOR_W_M2_SR)).collect()
}

/// `spoil` is what the executors' skies go through: nothing, or a fault.
fn figures(rig: &Rig, scene: &Scene, spoil: fn(usize, &mut [f32])) -> Result<Figures, Box<dyn Error>> {
    let mut skies = rig.skies(&request(rig, scene, &scene.lamps)?)?;
    skies.iter_mut().enumerate().for_each(|(position, (_, sky))| spoil(position, sky));
    // With the brightest lamp taken away no direction may be brighter.
    let mut fewer = scene.lamps.clone();
    fewer.sort_by(|a, b| a.flux_dnb_w.total_cmp(&b.flux_dnb_w));
    fewer.pop();
    let before = rig.skies(&request(rig, scene, &fewer)?)?;
    let mut figures = Figures::default();
    for ((_, sky), (_, before)) in skies.iter().zip(&before) {
        figures.faults += Faults::of_f32(sky).total();
        let lost = widened(before).zip(widened(sky)).map(|(before, now)| (before - now).max(0.0));
        let none = std::iter::repeat(0.0);
        if scene.basis == rig.set.basis_count() {
            figures.darker = figures.darker.max(lost_digits(lost, none, floored(sky)));
            for (before, now) in before.chunks(sky.len() / BAND_COUNT).zip(sky.chunks(sky.len() / BAND_COUNT))
            {
                let mean = |band: &[f32]| widened(band).sum::<f64>() / band.len() as f64;
                let (before, now) = (mean(before), mean(now));
                figures.darker_mean =
                    figures.darker_mean.max((before - now).max(0.0) / now.max(BAND_FLOOR_W_M2_SR));
            }
        }
    }
    let (first, second) = (&skies[0].1, &skies[1].1);
    figures.apart = lost_digits(widened(second), widened(first), floored(first));
    Ok(figures)
}

/// The worst figures over `cases` random scenes, and the smallest scene that breaks a limit, in words.
fn search(
    rig: &Rig,
    basis: usize,
    (cases, max_shrink_iters): (u32, u32),
    limits: &Limits,
    spoil: fn(usize, &mut [f32]),
) -> (Figures, Option<String>) {
    let worst = RefCell::new(Figures::default());
    let config = Config { cases, failure_persistence: None, max_shrink_iters, ..Config::default() };
    let mut runner = TestRunner::new_with_rng(config, TestRng::deterministic_rng(RngAlgorithm::ChaCha));
    let outcome = runner.run(&scene(basis), |scene| {
        let found = figures(rig, &scene, spoil).map_err(|error| TestCaseError::fail(error.to_string()))?;
        let mut worst = worst.borrow_mut();
        worst.faults = worst.faults.max(found.faults);
        worst.apart = worst.apart.max(found.apart);
        worst.darker = worst.darker.max(found.darker);
        worst.darker_mean = worst.darker_mean.max(found.darker_mean);
        let is_right = found.faults == 0
            && found.apart <= limits.apart
            && found.darker <= limits.darker
            && found.darker_mean <= limits.darker_mean;
        prop_assert!(is_right, "{:?}", found);
        Ok(())
    });
    let smallest = match outcome {
        Ok(()) => None,
        Err(TestError::Fail(reason, scene)) => Some(format!("{reason}; smallest: {scene:?}")),
        Err(TestError::Abort(reason)) => Some(reason.to_string()),
    };
    (worst.into_inner(), smallest)
}

fn explore(report: &mut Report, words: &str, rig: &Rig, cases: u32, limits: &Limits) -> Outcome {
    let basis = rig.set.basis_count();
    let (found, smallest) = search(rig, basis, (cases, 100), limits, |_, _| ());
    // Planted: one executor's sky black, but for a sample below 0. Without limits the first scenes are all looked at.
    let none = Limits { apart: f64::INFINITY, darker: f64::INFINITY, darker_mean: f64::INFINITY };
    let (black, _) = search(rig, basis, (6, 0), &none, |position, sky| {
        if position == 1 {
            sky.fill(0.0);
        }
    });
    let (negative, _) = search(rig, basis, (1, 0), &none, |_, sky| sky[7] = -1e-20);
    let note = smallest.unwrap_or_default();
    let count = cases as usize;
    let check = |name: &str, figure| Check::new(format!("random scenes, {words}: {name}"), figure, count);
    report.add(
        check("finite and not negative", "samples")
            .found(found.faults as f64, 0.0, negative.faults as f64)
            .note(&note),
    );
    report.add(
        check("both executors agree", "of the row's brightest")
            .found(found.apart, limits.apart, black.apart)
            .note(&note),
    );
    report.add(
        check("more light is not darker", "loss, of the row's brightest")
            .found(found.darker, limits.darker, black.darker)
            .note(&note),
    );
    report.add(
        check("more light makes no darker sky", "loss of a band's mean")
            .found(found.darker_mean, limits.darker_mean, black.darker_mean)
            .note(&note),
    );
    Ok(())
}

/// Both executors against f64.
fn against_f64(report: &mut Report, rig: &Rig, cases: u32) -> Outcome {
    let config = Config { cases, failure_persistence: None, max_shrink_iters: 40, ..Config::default() };
    let mut runner = TestRunner::new_with_rng(config, TestRng::deterministic_rng(RngAlgorithm::ChaCha));
    let (worst, planted) = (RefCell::new(0f64), RefCell::new(0f64));
    let outcome = runner.run(&scene(16), |scene| {
        let fail = |error: &dyn std::fmt::Display| TestCaseError::fail(error.to_string());
        let request = request(rig, &scene, &scene.lamps).map_err(|error| fail(&error))?;
        let exact = rig.exact(&request).map_err(|error| fail(&error))?;
        let magnitude: Vec<f64> =
            row_maxima(&exact).into_iter().map(|value| value.max(BAND_FLOOR_W_M2_SR)).collect();
        for (_, sky) in rig.skies(&request).map_err(|error| fail(&error))? {
            let error = |more: f64| {
                lost_digits(
                    widened(&sky).map(|value| value * more),
                    exact.iter().copied(),
                    magnitude.iter().copied(),
                )
            };
            let (error, wrong) = (error(1.0), error(1.01));
            worst.replace_with(|worst| worst.max(error));
            planted.replace_with(|planted| planted.max(wrong));
            prop_assert!(error <= 1e-3, "{}", error);
        }
        Ok(())
    });
    let note = outcome.err().map_or(String::new(), |error| error.to_string());
    let check =
        Check::new("random scenes, made-up packs: f32 against f64", "of the row's brightest", cases as usize);
    report.add(check.found(worst.into_inner(), 1e-3, planted.into_inner()).note(note));
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use skyglow_render::DeviceChoice;

    fn made_up() -> Rig {
        Rig::of(synthetic::table_set_with_skylines(&[1.5, 2.5, 6.0], 8)).unwrap()
    }

    /// Random scenes are finite, and alike by both executors.
    #[test]
    fn both_executors_agree_on_random_scenes() {
        let (found, smallest) = search(&made_up(), 8, (12, 400), &MADE_UP, |_, _| ());
        assert_eq!((found.faults, smallest), (0, None), "{found:?}");
    }

    /// A fault in a random scene is found, and the scene reduced to few lights.
    #[test]
    fn a_fault_in_a_random_scene_is_reduced() {
        let tables = synthetic::table_set_with_skylines(&[1.5, 2.5, 6.0], 8);
        // Plain Rust twice: making a scene small takes hundreds of skies.
        let rig = Rig::with(tables, &[DeviceChoice::Cpu, DeviceChoice::Cpu]).unwrap();
        let (found, smallest) = search(&rig, 8, (12, 400), &MADE_UP, |position, sky| {
            // A fault where there is any light at all: one lamp must be left.
            if position == 1 {
                sky[100] = f32::NAN;
            }
        });
        assert!(found.faults > 0);
        let words = smallest.unwrap();
        assert_eq!(words.matches("Lamp {").count(), 1, "{words}");
    }
}
