//! f32 against f64 on the packs that come with the program: single lamps at the ends and in the middle of every axis.

use crate::{
    checks::{Check, Outcome, Report},
    detectors::{Faults, holes, lost_digits},
    rig::{Bench, Lamp, Rig, grid_of, row_maxima, widened},
};
use rayon::prelude::*;
use skyglow_physics::{Turbidity, error_metric::BAND_FLOOR_W_M2_SR};
use skyglow_render::{RenderError, RenderRequest};
use std::error::Error;

/// Of the row's brightest sample. Low in the shadow of a lamp that stands far above the eye nearby, 64 functions cancel to
/// less than a thousandth of themselves, and so many times the rounding of f32 is left.
const LOST: f64 = 1e-2;

pub(crate) fn run(bench: &Bench, report: &mut Report) -> Outcome {
    let rig = &bench.shipped;
    for (words, turbidity) in [("at a pack's turbidity", 2.5), ("between packs", 3.0)] {
        let mut requests = requests(rig, turbidity)?;
        if turbidity != 2.5 {
            // Four packs in f64 take seconds a sky: a third of the lamps.
            let mut index = 0..;
            requests.retain(|_| index.next().is_some_and(|index| index % 3 == 0));
        }
        let exact: Vec<Vec<f64>> =
            requests.par_iter().map(|request| rig.exact(request)).collect::<Result<_, RenderError>>()?;
        compare(report, rig, words, &requests, &exact)?;
    }
    Ok(())
}

/// Lamps as bright as give a visible sky, at the ends and between nodes, open and behind a skyline.
fn requests(rig: &Rig, turbidity: f64) -> Result<Vec<RenderRequest>, Box<dyn Error>> {
    let mut requests = Vec::new();
    for (ring, flux_dnb_w) in [(0, 1e3), (3, 1e3), (54, 1e4), (116, 1e7), (191, 1e12)] {
        for altitude_m in [0.0, 300.0, 6_000.0] {
            for (observer_altitude_m, blocking) in
                [(0.0, 0), (640.0, 0), (4_199.0, 0), (6_000.0, 0), (640.0, 3)]
            {
                let lamp = Lamp { column: 200, ring, flux_dnb_w, altitude_m, blocking };
                let mut request = rig.request(grid_of(&[lamp]))?;
                request.observer_altitude_m = observer_altitude_m;
                request.turbidity = Turbidity::new(turbidity)?;
                requests.push(request);
            }
        }
    }
    Ok(requests)
}

fn compare(
    report: &mut Report,
    rig: &Rig,
    words: &str,
    requests: &[RenderRequest],
    exact: &[Vec<f64>],
) -> Outcome {
    for (position, executor) in rig.executors().enumerate() {
        let (mut faults, mut black, mut worst, mut at) = (Faults::default(), 0, 0.0, 0);
        let mut planted: (usize, f64) = (0, 0.0);
        for (index, (request, exact)) in requests.iter().zip(exact).enumerate() {
            let mut sky = rig.skies(request)?.swap_remove(position).1;
            faults += Faults::of_f32(&sky);
            let floored: Vec<f64> =
                row_maxima(exact).into_iter().map(|value| value.max(BAND_FLOOR_W_M2_SR)).collect();
            let dark = |sky: &[f32]| holes(widened(sky), exact.iter().copied(), BAND_FLOOR_W_M2_SR);
            let lost =
                |sky: &[f32]| lost_digits(widened(sky), exact.iter().copied(), floored.iter().copied());
            black += dark(&sky);
            let error = lost(&sky);
            if error > worst {
                (worst, at) = (error, index);
            }
            sky.iter_mut().for_each(|value| *value *= 0.95);
            planted.1 = planted.1.max(lost(&sky));
            sky.fill(0.0);
            planted.0 = planted.0.max(dark(&sky));
        }
        let cell = requests[at].polar.cells[0];
        let lost = Check::new(
            format!("single lamps {words}, {executor}"),
            "f32 − f64, of the row's brightest",
            requests.len(),
        );
        report.add(lost.found(worst, LOST, planted.1).note(format!(
            "ring {}, lamp at {} m, blocking {}, eye at {} m; planted: 5 % less",
            cell.ring, cell.altitude_m, cell.blocking, requests[at].observer_altitude_m
        )));
        let broken = (faults.total() + black) as f64;
        let whole = Check::new(
            format!("single lamps {words}, {executor}: no fault, no hole"),
            "samples NaN, infinite, negative or black by mistake",
            requests.len() * exact[0].len(),
        );
        report.add(
            whole
                .found(broken, 0.0, planted.0 as f64)
                .note(format!("{faults:?}, {black} holes; planted: a black sky")),
        );
    }
    Ok(())
}
