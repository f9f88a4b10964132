//! What interpolation over the offset axis costs: the scale of single sources between nodes, from images at the nodes of the
//! very observer and distance, against images of the sources themselves.
//!
//! `offset_interpolation TURBIDITY CACHE [OBSERVER_M:DISTANCE_M,...]`: CACHE is one of `multiple_accuracy`. Errors of ln of the
//! green scale in %, for lobes `lambert` and `horizon`, then of the radiance at the zenith, whose shape is a line between
//! nodes: the mean of the absolute, and the worst with its offset.

use rayon::prelude::*;
use skyglow_physics::{Atmosphere, Turbidity, single_source::SourceGeometry};
use skyglow_tables::{
    MultipleTable, OffsetAxis, TableAxes,
    bow::log_scale_at,
    images::{HALF_COLUMN_COUNT, PIXEL_COUNT, image_index, images_of},
};
use std::{error::Error, path::Path};

mod kept_fields;
use kept_fields::kept_table;

/// Observers and distances where none are given, metres.
const PLACES: &str =
    "0:20000,0:40000,0:80000,0:160000,10:40000,300:40000,300:160000,950:80000,2900:20000,2900:60000";
/// Sources tried between two nodes.
const BETWEEN: usize = 4;
const GREEN: usize = 1;

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().collect();
    let [_, turbidity, cache, places @ ..] = arguments.as_slice() else {
        return Err("usage: offset_interpolation TURBIDITY CACHE [OBSERVER_M:DISTANCE_M,...]".into());
    };
    let air = Atmosphere::new(Turbidity::new(turbidity.parse()?)?);
    let axes = TableAxes::full();
    let multiple = vec![kept_table(air, &axes.distance_m, Path::new(cache))?];
    for place in places.first().map_or(PLACES, String::as_str).split(',') {
        let (observer_m, distance_m) = place.split_once(':').ok_or("expected OBSERVER_M:DISTANCE_M")?;
        judge(observer_m.parse()?, distance_m.parse()?, &axes, air, &multiple);
    }
    Ok(())
}

/// ln of the green scale of the first two lobes, and their shapes at the zenith.
fn scale_and_zenith(geometry: SourceGeometry, air: Atmosphere, multiple: &[MultipleTable]) -> [[f64; 2]; 2] {
    let images = images_of(&[air], multiple, &geometry).swap_remove(0);
    [0, 1].map(|lobe| {
        let image = image_index(lobe, GREEN);
        let zenith = (image + 1) * PIXEL_COUNT - HALF_COLUMN_COUNT / 2;
        [images.log_scale[image], f64::from(images.shape[zenith])]
    })
}

fn judge(observer_m: f64, distance_m: f64, axes: &TableAxes, air: Atmosphere, multiple: &[MultipleTable]) {
    let axis = OffsetAxis::at_distance(distance_m, axes.offset_count);
    let of = |offset_m: f64| {
        let source_m = (observer_m + offset_m).clamp(-2_000.0, 7_500.0);
        let geometry =
            SourceGeometry { distance_m, source_altitude_m: source_m, observer_altitude_m: observer_m };
        scale_and_zenith(geometry, air, multiple)
    };
    let nodes: Vec<[[f64; 2]; 2]> =
        (0..axis.count).into_par_iter().map(|node| of(axis.offset_m(node as f64))).collect();
    let positions: Vec<f64> = (0..BETWEEN * (axis.count - 1))
        .map(|i| (i as f64 + 0.5) / BETWEEN as f64)
        .filter(|&position| {
            let offset_m = axis.offset_m(position);
            (0.0..4_000.0).contains(&(observer_m + offset_m)) && offset_m < 0.3 * distance_m
        })
        .collect();
    let errors: Vec<(f64, [f64; 4])> = positions
        .par_iter()
        .map(|&position| {
            let truth = of(axis.offset_m(position));
            let scale = [0, 1]
                .map(|lobe| log_scale_at(&axis, position, |node| nodes[node][lobe][0]) - truth[lobe][0]);
            let low = position as usize;
            let zenith = [0, 1].map(|lobe| {
                let [below, above] = [low, low + 1].map(|node| nodes[node][lobe][1]);
                let shape = below + (above - below) * (position - low as f64);
                scale[lobe] + (shape / truth[lobe][1]).ln()
            });
            (axis.offset_m(position), [scale[0], scale[1], zenith[0], zenith[1]])
        })
        .collect();
    print!("{observer_m:6.0} m, {:5.0} km:", distance_m / 1e3);
    for lobe in 0..4 {
        let mean = errors.iter().map(|(_, error)| error[lobe].abs()).sum::<f64>() / errors.len() as f64;
        let worst = errors.iter().max_by(|a, b| a.1[lobe].abs().total_cmp(&b.1[lobe].abs()));
        let (at_m, worst) = worst.map_or((f64::NAN, f64::NAN), |(at_m, error)| (*at_m, error[lobe]));
        print!("  mean {:5.2}, worst {:+6.2} at {at_m:+6.0} m", 100.0 * mean, 100.0 * worst);
    }
    let near: Vec<String> = errors
        .iter()
        .filter(|(offset_m, _)| offset_m.abs() < 250.0)
        .map(|(offset_m, error)| format!("{offset_m:.0}: {:+.2} {:+.2}", 100.0 * error[0], 100.0 * error[2]))
        .collect();
    println!("  [{}]", near.join(", "));
}
