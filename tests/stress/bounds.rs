//! What lies at the ends of the ranges and beyond: counted as the end, or refused by name, never extrapolated.

use crate::{
    checks::{Check, Outcome, Report},
    detectors::lost_digits,
    rig::{Bench, Lamp, Rig, grid_of, row_maxima, widened},
};
use skyglow_physics::{
    GeoPoint, SourcePixel, Turbidity,
    source_pixel::{MAX_SOURCE_DISTANCE_M, MIN_SOURCE_DISTANCE_M, point_sources},
};
use skyglow_render::{RenderRequest, prepare::Prepared};
use skyglow_scene::{PolarGrid, RING_COUNT};
use std::error::Error;

pub(crate) fn run(bench: &Bench, report: &mut Report) -> Outcome {
    let rig = &bench.shipped;
    distances(report, rig)?;
    source_altitudes(report, rig)?;
    observer_below_sea(report, rig)?;
    refusals(report, rig)
}

/// A pixel of 10 m that far to the east-north-east, as the sky's grid has it, over the observer's own place.
fn grid_at(distance_m: f64) -> PolarGrid {
    let here = GeoPoint::from_rad_unchecked(0.3, 1.0);
    let corner = |k: u8| {
        let turn = std::f64::consts::FRAC_PI_4 * f64::from(2 * k + 1);
        here.destination(1.1, distance_m).destination(turn, 7.0).unit_vector()
    };
    let pixel = SourcePixel { corners: [0, 1, 2, 3].map(corner), flux_dnb_w: 1e6, altitude_m: 500.0 };
    let sources = point_sources(here, &[pixel]);
    PolarGrid::from_sources(here, sources.into_iter().map(|source| (source, 0.0)))
}

/// Nearer than 250 m counts as 250 m, to 300 km every light counts whole, beyond it none does.
fn distances(report: &mut Report, rig: &Rig) -> Outcome {
    let sky = |distance_m: f64| -> Result<Vec<f32>, Box<dyn Error>> {
        Ok(rig.sky(&rig.request(grid_at(distance_m))?)?)
    };
    let at_limit: Vec<f64> = widened(&sky(MIN_SOURCE_DISTANCE_M)?).collect();
    let error = |distance_m: f64| -> Result<f64, Box<dyn Error>> {
        Ok(lost_digits(widened(&sky(distance_m)?), at_limit.iter().copied(), row_maxima(&at_limit)))
    };
    let near = [8.0, 20.0, 100.0, 200.0, 249.0, 249.999];
    let mut worst: f64 = 0.0;
    for distance_m in near {
        worst = worst.max(error(distance_m)?);
    }
    let check =
        Check::new("a light nearer than 250 m counts as at 250 m", "of the row's brightest", near.len());
    // The azimuth of a centre 8 m away is that of 10 m of pixel.
    report.add(check.found(worst, 1e-3, error(260.0)?).note("planted: 260 m"));

    let share = |distance_m: f64| grid_at(distance_m).flux_dnb_w / 1e6;
    let (inside, beyond) =
        ([299_000.0, 299_999.0, 299_999.999], [300_000.001, 300_001.0, 301_000.0, 2e6, 2e7]);
    let lost = inside.into_iter().map(|d| (share(d) - 1.0).abs()).fold(0.0, f64::max);
    let check = Check::new("a light within 300 km counts whole", "share of its flux lost", inside.len());
    report
        .add(check.found(lost, 1e-12, (share(300_000.001) - 1.0).abs()).note("planted: a millimetre beyond"));
    let kept = beyond.into_iter().map(share).fold(0.0, f64::max);
    let check =
        Check::new("a light beyond 300 km counts for nothing", "share of its flux kept", beyond.len());
    report.add(check.found(kept, 0.0, share(299_999.999)).note("planted: a millimetre within"));

    // The same where point sources come ready-made.
    let ready_made = |distance_m: f64| {
        let source =
            skyglow_physics::PointSource { azimuth_rad: 1.0, distance_m, altitude_m: 0.0, flux_dnb_w: 1.0 };
        PolarGrid::from_sources(GeoPoint::from_rad_unchecked(0.0, 0.0), [(source, 0.0)]).flux_dnb_w
    };
    let kept = beyond.into_iter().map(ready_made).fold(0.0, f64::max);
    let check = Check::new("ready-made sources beyond 300 km too", "share of its flux kept", beyond.len());
    report.add(check.found(kept, 0.0, ready_made(MAX_SOURCE_DISTANCE_M)));
    Ok(())
}

/// A lamp above the end of the offset axis is one at its end; so is one below its start.
fn source_altitudes(report: &mut Report, rig: &Rig) -> Outcome {
    let tables = &rig.set.tables()[0];
    let last = (tables.offset_count - 1) as f64;
    for (words, node, beyond_m) in [
        ("above", last, [9_000.0, 20_000.0, 1e6, f32::MAX]),
        ("below", 0.0, [-7_000.0, -20_000.0, -1e6, f32::MIN]),
    ] {
        let (mut worst, mut planted) = (0f64, f64::INFINITY);
        let mut faults = 0;
        let rings = [0, 60, 120, RING_COUNT - 1];
        for ring in rings {
            let end_m = tables.offset_axis[ring].offset_m(node) as f32;
            let sky = |altitude_m: f32| -> Result<Vec<f32>, Box<dyn Error>> {
                let mut request = rig.request(grid_of(&[Lamp::open(3, ring as u32, 1e9, altitude_m)]))?;
                request.observer_altitude_m = 0.0;
                Ok(rig.sky(&request)?)
            };
            let wanted: Vec<f64> = widened(&sky(end_m)?).collect();
            let error = |sky: &[f32]| lost_digits(widened(sky), wanted.iter().copied(), row_maxima(&wanted));
            for altitude_m in beyond_m {
                let sky = sky(altitude_m)?;
                worst = worst.max(error(&sky));
                faults += crate::detectors::Faults::of_f32(&sky).total();
            }
            planted = planted.min(error(&sky(0.0)?));
        }
        let figure = "of the row's brightest";
        let check = Check::new(
            format!("a lamp {words} the axis of offsets is one at its end"),
            figure,
            4 * rings.len(),
        );
        let worst = if faults > 0 { f64::INFINITY } else { worst };
        report.add(check.found(worst, 1e-5, planted).note("planted: a lamp at the sea"));
    }
    Ok(())
}

fn observer_below_sea(report: &mut Report, rig: &Rig) -> Outcome {
    let sky = |observer_altitude_m: f64| -> Result<Vec<f32>, Box<dyn Error>> {
        let mut request = rig.request(grid_of(&[Lamp::open(3, 60, 1e6, 0.0)]))?;
        request.observer_altitude_m = observer_altitude_m;
        Ok(rig.sky(&request)?)
    };
    let at_sea: Vec<f64> = widened(&sky(0.0)?).collect();
    let error = |altitude_m: f64| -> Result<f64, Box<dyn Error>> {
        Ok(lost_digits(widened(&sky(altitude_m)?), at_sea.iter().copied(), row_maxima(&at_sea)))
    };
    let below = [-0.0, -1e-9, -430.0, -1e9, f64::MIN];
    let mut worst: f64 = 0.0;
    for altitude_m in below {
        worst = worst.max(error(altitude_m)?);
    }
    let check =
        Check::new("an observer below the sea is one at the sea", "of the row's brightest", below.len());
    report.add(check.found(worst, 0.0, error(1.0)?).note("planted: 1 m above"));
    Ok(())
}

/// One request that must be refused with words.
struct Refusal {
    words: &'static str,
    change: fn(&mut RenderRequest, f64),
    bad: Vec<f64>,
    /// A value that is right, and so is not refused: the control.
    right: f64,
}

/// Changes the first cell of a request's grid.
fn cell(request: &mut RenderRequest) -> &mut skyglow_scene::PolarCell {
    &mut std::sync::Arc::make_mut(&mut request.polar).cells[0]
}

fn refusals(report: &mut Report, rig: &Rig) -> Outcome {
    let (nan, infinity) = (f64::NAN, f64::INFINITY);
    let set_turbidity = |request: &mut RenderRequest, value: f64| {
        request.turbidity = Turbidity::new(value).unwrap_or_default();
    };
    let refusals = [
        Refusal {
            words: "altitude is",
            change: |request, value| request.observer_altitude_m = value,
            bad: vec![6_000.000_001, 6_001.0, 9_000.0, infinity, -infinity, nan],
            right: 6_000.0,
        },
        Refusal {
            words: "turbidity is",
            change: set_turbidity,
            bad: vec![1.0, 1.499_999, 6.000_001, 10.0, 20.0],
            right: 1.5,
        },
        Refusal {
            words: "basis is",
            change: |request, value| request.basis = Some(value as usize),
            bad: vec![0.0, 113.0, 1e9],
            right: 112.0,
        },
        Refusal {
            words: "a cell has flux",
            change: |request, value| cell(request).flux_dnb_w = value as f32,
            bad: vec![nan, infinity, -infinity, -1e-30, 1e25],
            right: 0.0,
        },
        Refusal {
            words: "a cell has flux",
            change: |request, value| cell(request).altitude_m = value as f32,
            bad: vec![nan, infinity, -infinity],
            right: 9_000.0,
        },
        Refusal {
            words: "ring",
            change: |request, value| cell(request).ring = value as u32,
            bad: vec![192.0, 4e9],
            right: 191.0,
        },
        Refusal {
            words: "blocking angle",
            change: |request, value| cell(request).blocking = value as u32,
            bad: vec![8.0, 4e9],
            right: 7.0,
        },
        Refusal {
            words: "lamp",
            change: |request, value| request.flux_per_dnb_flux[1] = value,
            bad: vec![nan, infinity, -infinity, -1e-3, 1e300],
            right: 1.5,
        },
    ];
    for Refusal { words, change, bad, right } in refusals {
        let passed_over = |value: f64| -> Result<usize, Box<dyn Error>> {
            let mut request = rig.request(grid_of(&[Lamp::open(3, 60, 1e6, 0.0)]))?;
            change(&mut request, value);
            let refused = Prepared::new(&request, &rig.set).err().map(|error| error.to_string());
            Ok(usize::from(!refused.is_some_and(|said| said.contains(words))))
        };
        let (mut count, mut passed) = (0, Vec::new());
        for &value in &bad {
            let over = passed_over(value)?;
            count += over;
            passed.extend((over > 0).then_some(value));
        }
        let check = Check::new(format!("refused by name: \"{words} …\""), "values not refused", bad.len());
        report.add(
            check
                .found(count as f64, 0.0, passed_over(right)? as f64)
                .note(format!("{passed:?}; planted: {right}")),
        );
    }
    Ok(())
}
