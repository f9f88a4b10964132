//! The laws of the sky: turning the scene turns it, mirroring mirrors it, light adds up.

use crate::{
    checks::{Check, Outcome, Report},
    detectors::lost_digits,
    rig::{Bench, Lamp, Rig, grid_of, lamps_of, row_maxima, widened},
};
use skyglow_physics::{AZIMUTH_COUNT, Turbidity, error_metric::BAND_FLOOR_W_M2_SR};
use skyglow_render::{RenderRequest, synthetic};
use std::error::Error;

/// A limit of rounding alone: 25 roundings of f32, relative to the brightest of a row.
const ROUNDING: f64 = 3e-6;

pub(crate) fn run(bench: &Bench, report: &mut Report) -> Outcome {
    turning(report, &bench.shipped)?;
    mirroring(report, &bench.shipped)?;
    adding(report, &bench.shipped)?;
    scaling(report, &bench.shipped)
}

/// A region of 3 000 lit cells, part of them behind skylines.
fn region() -> Vec<Lamp> {
    lamps_of(&synthetic::polar_grid_with_skylines(11, 3_000))
}

/// The sky with column i of each row where `to(i)` is.
fn rearranged(sky: &[f32], to: impl Fn(usize) -> usize) -> Vec<f64> {
    let mut moved = vec![0.0; sky.len()];
    for (at, value) in sky.iter().enumerate() {
        moved[at - at % AZIMUTH_COUNT + to(at % AZIMUTH_COUNT)] = f64::from(*value);
    }
    moved
}

fn moved_lamps(lamps: &[Lamp], to: impl Fn(usize) -> usize) -> Vec<Lamp> {
    lamps.iter().map(|lamp| Lamp { column: to(lamp.column), ..*lamp }).collect()
}

/// Largest difference of each executor between the sky of moved lamps and the moved sky, and the same where the sky is
/// moved wrongly.
fn compare_moved(
    rig: &Rig,
    request: &RenderRequest,
    lamps: &[Lamp],
    to: impl Fn(usize) -> usize,
    wrongly: impl Fn(usize) -> usize,
) -> Result<Vec<(f64, f64)>, Box<dyn Error>> {
    let still = rig.skies(request)?;
    let mut moved = request.clone();
    moved.polar = grid_of(&moved_lamps(lamps, &to)).into();
    let compare = |((_, still), (_, moved)): (&(_, Vec<f32>), &(_, Vec<f32>))| {
        let (right, wrong) = (rearranged(still, &to), rearranged(still, &wrongly));
        let error = |wanted: &[f64]| lost_digits(widened(moved), wanted.iter().copied(), row_maxima(wanted));
        (error(&right), error(&wrong))
    };
    Ok(still.iter().zip(&rig.skies(&moved)?).map(compare).collect())
}

fn turning(report: &mut Report, rig: &Rig) -> Outcome {
    let lamps = region();
    let request = rig.request(grid_of(&lamps))?;
    let names: Vec<_> = rig.executors().collect();
    let mut worst = vec![(0f64, f64::INFINITY); names.len()];
    for turn in 0..AZIMUTH_COUNT {
        let by = |turn: usize| move |column: usize| (column + turn) % AZIMUTH_COUNT;
        let figures = compare_moved(rig, &request, &lamps, by(turn), by(turn + 1))?;
        for (worst, (right, wrong)) in worst.iter_mut().zip(figures) {
            *worst = (worst.0.max(right), worst.1.min(wrong));
        }
    }
    for (name, (right, wrong)) in names.iter().zip(worst) {
        let check =
            Check::new(format!("turned by each of 256 columns, {name}"), "of the row's brightest", 256);
        report.add(check.found(right, ROUNDING, wrong).note("planted: one column too many"));
    }
    Ok(())
}

fn mirroring(report: &mut Report, rig: &Rig) -> Outcome {
    let lamps = region();
    let request = rig.request(grid_of(&lamps))?;
    let mirror = |column: usize| (AZIMUTH_COUNT - column) % AZIMUTH_COUNT;
    let figures = compare_moved(rig, &request, &lamps, mirror, |column| AZIMUTH_COUNT - 1 - column)?;
    for (name, (right, wrong)) in rig.executors().zip(figures) {
        let check = Check::new(format!("mirrored east to west, {name}"), "of the row's brightest", 1);
        report.add(check.found(right, ROUNDING, wrong).note("planted: mirrored about the edge of column 0"));
    }
    Ok(())
}

/// At a pack's turbidity: two scenes together are the sum of each.
fn adding(report: &mut Report, rig: &Rig) -> Outcome {
    let lamps = region();
    let (one, two): (Vec<Lamp>, Vec<Lamp>) = lamps.iter().partition(|lamp| lamp.ring % 2 == 0);
    let skies =
        |lamps: &[Lamp]| -> Result<_, Box<dyn Error>> { Ok(rig.skies(&rig.request(grid_of(lamps))?)?) };
    let (both, one, two) = (skies(&lamps)?, skies(&one)?, skies(&two)?);
    for (((name, both), (_, one)), (_, two)) in both.iter().zip(&one).zip(&two) {
        let sum: Vec<f64> = widened(one).zip(widened(two)).map(|(one, two)| one + two).collect();
        // Where a part's functions cancel to less than nothing it is held at 0, and there is no sum.
        let is_held: Vec<bool> = widened(one).zip(widened(two)).map(|(a, b)| a == 0.0 || b == 0.0).collect();
        let share = |held: usize| held as f64 / is_held.len() as f64;
        let held = share(is_held.iter().filter(|is_held| **is_held).count());
        // Planted: rows that sink by a twentieth of their brightest.
        let alone: Vec<f64> = widened(one).collect();
        let sunk = alone.iter().zip(row_maxima(&alone)).filter(|(value, most)| **value < 0.05 * most);
        let check = Check::new(format!("directions of parts held at 0, {name}"), "of all", is_held.len());
        report.add(check.found(held, 0.002, share(sunk.count())));
        let error = |sum: &[f64]| {
            let error = |(at, maximum): (usize, f64)| if is_held[at] { f64::INFINITY } else { maximum };
            let magnitude = row_maxima(sum).into_iter().enumerate().map(error);
            lost_digits(widened(both), sum.iter().copied(), magnitude)
        };
        let wrong: Vec<f64> = sum.iter().map(|value| value * 1.000_1).collect();
        let check = Check::new(
            format!("light adds up at a pack's turbidity, {name}"),
            "of the row's brightest",
            both.len(),
        );
        report.add(check.found(error(&sum), ROUNDING, error(&wrong)));
    }
    Ok(())
}

/// A 1e12th of the light to 1e12 times it, at a pack's turbidity and between packs, where what is below the floor of the
/// logarithm is black.
fn scaling(report: &mut Report, rig: &Rig) -> Outcome {
    const FACTORS: [f32; 6] = [1e-12, 1e-6, 1e-3, 1e3, 1e6, 1e12];
    let lamps = region();
    for (turbidity, floor_w_m2_sr) in [(2.5, 0.0), (3.1, BAND_FLOOR_W_M2_SR)] {
        let sky = |factor: f32| -> Result<_, Box<dyn Error>> {
            let brighter = |lamp: &Lamp| Lamp { flux_dnb_w: factor * lamp.flux_dnb_w, ..*lamp };
            let mut request = rig.request(grid_of(&lamps.iter().map(brighter).collect::<Vec<_>>()))?;
            request.turbidity = Turbidity::new(turbidity)?;
            Ok(rig.skies(&request)?)
        };
        let plain = sky(1.0)?;
        let mut worst = vec![(0f64, 0f64); plain.len()];
        for factor in FACTORS {
            for ((worst, (_, plain)), (_, scaled)) in worst.iter_mut().zip(&plain).zip(&sky(factor)?) {
                let error = |more: f64| {
                    let wanted: Vec<f64> =
                        widened(plain).map(|value| value * f64::from(factor) * more).collect();
                    let magnitude = row_maxima(&wanted).into_iter().map(|value| value.max(floor_w_m2_sr));
                    lost_digits(widened(scaled), wanted.iter().copied(), magnitude)
                };
                *worst = (worst.0.max(error(1.0)), worst.1.max(error(1.001)));
            }
        }
        for ((name, _), (right, wrong)) in plain.iter().zip(worst) {
            let name = format!("1e-12 to 1e12 times the light at turbidity {turbidity}, {name}");
            let check = Check::new(name, "of the row's brightest", FACTORS.len());
            report.add(check.found(right, 1e-4, wrong));
        }
    }
    Ok(())
}
