//! What interpolation over the offset axis costs.

use crate::arguments::{Outcome, turbidity};
use rayon::prelude::*;
use skyglow_lab::field_cache::stored_table;
use skyglow_physics::{Atmosphere, Band, Turbidity, single_source::SourceGeometry};
use skyglow_tables::{
    MultipleTable, OffsetAxis, TableAxes,
    curvature::log_scale_at,
    images::images_of,
    layout::{HALF_COLUMN_COUNT, PIXEL_COUNT, image_index},
};
use std::path::PathBuf;

/// Observers and distances where none are given, metres.
const PLACES: &str = "100:600,100:2400,300:2400,300:8000,0:40000,300:40000,300:160000,950:80000,2900:5000,2900:20000,2900:60000";
/// Sources about level with the observer, metres.
const AROUND_LEVEL_M: [f64; 9] = [-300.0, -150.0, -60.0, -30.0, -10.0, 0.0, 30.0, 100.0, 300.0];
/// Sources tried between two nodes.
const BETWEEN: usize = 4;
const MIDDLE: usize = Band::MIDDLE.index();

/// What interpolation over the offset axis costs: single sources between nodes, from images at the nodes of the very
/// observer and distance, against images of the sources themselves. Errors in the middle band in %, for lobes `lambert` and `horizon`:
/// of ln of the scale, of the radiance at the zenith, and of the lowest row within 12° of the source's azimuth, for sources
/// not above the observer's plane; shapes are lines between nodes. The mean of the absolute, and the worst with its offset.
/// First, of sources about level with the observer, where the first order or the later ones have a kink, the mean over the
/// lowest row, all columns.
#[derive(Debug, clap::Args)]
pub(crate) struct Arguments {
    /// Turbidity.
    #[arg(value_parser = turbidity)]
    turbidity: Turbidity,
    /// Folder of `multiple-accuracy`, or `-` for the first order alone.
    cache: PathBuf,
    /// Observers and distances, `OBSERVER_M:DISTANCE_M` with commas between them.
    #[arg(default_value = PLACES)]
    places: String,
}

pub(crate) fn run(Arguments { turbidity, cache, places }: &Arguments) -> Outcome {
    let air = Atmosphere::new(*turbidity);
    let axes = TableAxes::full();
    let multiple = if cache.as_os_str() == "-" { Vec::new() } else { vec![stored_table(air, cache)?] };
    for place in places.split(',') {
        let (observer_m, distance_m) = place.split_once(':').ok_or("expected OBSERVER_M:DISTANCE_M")?;
        judge(observer_m.parse()?, distance_m.parse()?, &axes, air, &multiple);
    }
    Ok(())
}

/// Columns of the lowest row that count: within 12° of the source's azimuth.
const NEAR_COLUMNS: usize = 9;

/// Of one lobe's middle image: ln of the scale, and the shape at the zenith and near the source.
#[derive(Clone, Copy)]
struct Looked {
    log_scale: f64,
    zenith: f64,
    near: [f64; NEAR_COLUMNS],
    lowest: [f64; HALF_COLUMN_COUNT],
}

impl Looked {
    /// The radiance between this node and the next, `weight` of the way, with this scale.
    fn between(self, above: Self, weight: f64, log_scale: f64) -> Self {
        let line = |below: f64, above: f64| below + (above - below) * weight;
        Self {
            log_scale,
            zenith: log_scale.exp() * line(self.zenith, above.zenith),
            near: std::array::from_fn(|at| log_scale.exp() * line(self.near[at], above.near[at])),
            lowest: std::array::from_fn(|at| log_scale.exp() * line(self.lowest[at], above.lowest[at])),
        }
    }
}

/// What is looked at of the first two lobes.
fn looked_at(geometry: SourceGeometry, air: Atmosphere, multiple: &[MultipleTable]) -> [Looked; 2] {
    let images = images_of(&[air], multiple, &geometry).swap_remove(0);
    [0, 1].map(|lobe| {
        let image = image_index(lobe, MIDDLE);
        let shape = &images.shape[image * PIXEL_COUNT..(image + 1) * PIXEL_COUNT];
        Looked {
            log_scale: images.log_scale[image],
            zenith: f64::from(shape[PIXEL_COUNT - HALF_COLUMN_COUNT / 2]),
            near: std::array::from_fn(|at| f64::from(shape[at])),
            lowest: std::array::from_fn(|at| f64::from(shape[at])),
        }
    })
}

/// Errors of [scale, zenith, lowest row].
fn errors(found: Looked, reference: Looked) -> [f64; 3] {
    let reference = reference.between(reference, 0.0, reference.log_scale);
    let off = found.near.iter().zip(reference.near).map(|(found, reference)| found - reference).sum::<f64>();
    [
        found.log_scale - reference.log_scale,
        found.zenith / reference.zenith - 1.0,
        off / reference.near.iter().sum::<f64>(),
    ]
}

fn judge(observer_m: f64, distance_m: f64, axes: &TableAxes, air: Atmosphere, multiple: &[MultipleTable]) {
    let axis = OffsetAxis::at_distance(distance_m, axes.offset_count);
    let of = |offset_m: f64| {
        let source_m = (observer_m + offset_m).clamp(-2_000.0, 7_500.0);
        let geometry =
            SourceGeometry { distance_m, source_altitude_m: source_m, observer_altitude_m: observer_m };
        looked_at(geometry, air, multiple)
    };
    let nodes: Vec<[Looked; 2]> =
        (0..axis.count).into_par_iter().map(|node| of(axis.offset_m(node as f64))).collect();
    let tried: Vec<(f64, [[f64; 3]; 2])> = (0..BETWEEN * (axis.count - 1))
        .into_par_iter()
        .map(|i| (i as f64 + 0.5) / BETWEEN as f64)
        .filter(|&position| {
            let offset_m = axis.offset_m(position);
            (0.0..4_000.0).contains(&(observer_m + offset_m)) && offset_m < 0.3 * distance_m
        })
        .map(|position| {
            let reference = of(axis.offset_m(position));
            let low = position as usize;
            let of_lobe = |lobe: usize| {
                let log_scale = log_scale_at(&axis, position, |node| nodes[node][lobe].log_scale);
                let [below, above] = [low, low + 1].map(|node| nodes[node][lobe]);
                errors(below.between(above, position - low as f64, log_scale), reference[lobe])
            };
            (axis.offset_m(position), [of_lobe(0), of_lobe(1)])
        })
        .collect();
    println!("{observer_m:6.0} m, {:5.1} km", distance_m / 1e3);
    print!("    around level");
    for offset_m in AROUND_LEVEL_M {
        let (reference, position) = (of(offset_m), axis.position(offset_m));
        let low = (position as usize).min(axis.count - 2);
        let off = [0, 1].map(|lobe| {
            let log_scale = log_scale_at(&axis, position, |node| nodes[node][lobe].log_scale);
            let [below, above] = [low, low + 1].map(|node| nodes[node][lobe]);
            let (found, reference) = (
                below.between(above, position - low as f64, log_scale),
                reference[lobe].between(reference[lobe], 0.0, reference[lobe].log_scale),
            );
            let pairs = found.lowest.iter().zip(reference.lowest);
            100.0 * pairs.map(|(found, reference)| found / reference - 1.0).sum::<f64>()
                / HALF_COLUMN_COUNT as f64
        });
        print!("  {offset_m:+.0} m {:+.1}, {:+.1}", off[0], off[1]);
    }
    println!();
    for (what, name) in ["scale", "zenith", "lowest row"].into_iter().enumerate() {
        print!("    {name:10}");
        for lobe in 0..2 {
            let counted: Vec<(f64, f64)> = tried
                .iter()
                .filter(|(offset_m, _)| what < 2 || *offset_m <= axis.kink_m)
                .map(|(offset_m, errors)| (*offset_m, errors[lobe][what]))
                .collect();
            let mean = counted.iter().map(|(_, error)| error.abs()).sum::<f64>() / counted.len() as f64;
            let worst = counted.iter().max_by(|a, b| a.1.abs().total_cmp(&b.1.abs()));
            let Some(&(at_m, worst)) = worst else { continue };
            print!("  mean {:5.2}, worst {:+6.2} at {at_m:+6.0} m", 100.0 * mean, 100.0 * worst);
        }
        println!();
    }
}
