//! What interpolation between altitudes of sources costs the truth of all orders.
//!
//! `sum_nodes TURBIDITY OBSERVER_M ALTITUDE,ALTITUDE,… NODES;NODES;…`: fields solved for every one of the altitudes [m], and
//! the same light interpolated in its logarithm between those of a list of nodes (such as `0,300`), four at a time, as
//! `MultipleSum` does. `2|2,50,150` cuts the line at the observer: nodes below it, nodes above. For every list the mean and
//! largest error of what is not a node, over distances, looks, bands and lobes, as a share of the whole radiance, first
//! order included.

use skyglow_physics::{
    Atmosphere, Turbidity,
    interpolation::Stencil,
    multiple_scattering::{DEFAULT_GROUND_ALBEDO, Resolution, SourceField, SourceSetting},
};
use std::error::Error;

mod looks;
use looks::{DISTANCE_M, Pair};

/// Of one altitude: later orders, and all orders, at every distance, look, band and lobe.
struct Light {
    altitude_m: f64,
    later: Vec<f64>,
    whole: Vec<f64>,
}

fn light(atmosphere: Atmosphere, observer_altitude_m: f64, altitude_m: f64) -> Result<Light, Box<dyn Error>> {
    let setting =
        SourceSetting::for_observer(atmosphere, altitude_m, observer_altitude_m, DEFAULT_GROUND_ALBEDO)?;
    let field = SourceField::solve(setting, &Resolution::table());
    let pair = Pair { source_altitude_m: altitude_m, observer_altitude_m };
    let later = pair.later(&field)?.concat();
    let first = pair.first(&atmosphere)?.concat();
    let whole = later.iter().zip(&first).map(|(later, first)| later + first).collect();
    println!("# {altitude_m} m: {:?} places", field.size());
    Ok(Light { altitude_m, later, whole })
}

fn numbers(text: &str) -> Result<Vec<f64>, std::num::ParseFloatError> {
    text.split(',').map(str::parse).collect()
}

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().collect();
    let [_, turbidity, observer_m, altitudes, lists] = arguments.as_slice() else {
        return Err("usage: sum_nodes TURBIDITY OBSERVER_M ALTITUDE,… NODES;NODES;…".into());
    };
    let atmosphere = Atmosphere::new(Turbidity::new(turbidity.parse()?)?);
    let observer_altitude_m: f64 = observer_m.parse()?;
    let lights = numbers(altitudes)?
        .into_iter()
        .map(|altitude_m| light(atmosphere, observer_altitude_m, altitude_m))
        .collect::<Result<Vec<_>, _>>()?;
    for list in lists.split(';') {
        let sides = list.split('|').map(numbers).collect::<Result<Vec<_>, _>>()?;
        let mut errors = Vec::new();
        for light in &lights {
            let is_above = light.altitude_m > observer_altitude_m;
            let nodes = if is_above { sides.last() } else { sides.first() }.ok_or("no nodes")?;
            let inside = nodes[0] <= light.altitude_m && light.altitude_m <= nodes[nodes.len() - 1];
            if nodes.contains(&light.altitude_m) || !inside {
                continue;
            }
            let taps = Stencil::lagrange(nodes, light.altitude_m);
            let at = |node: usize| lights.iter().find(|light| light.altitude_m == nodes[node]);
            let taps = taps
                .into_iter()
                .map(|(node, weight)| Ok((at(node).ok_or("a node is none of the altitudes")?, weight)))
                .collect::<Result<Vec<_>, &str>>()?;
            let mut own = Vec::new();
            for (sample, whole) in light.whole.iter().enumerate() {
                let log: f64 =
                    taps.iter().map(|(node, weight)| weight * node.later[sample].max(1e-36).ln()).sum();
                own.push((log.exp() - light.later[sample]) / whole.max(1e-30));
            }
            let mean = |values: &[f64]| values.iter().map(|v| v.abs()).sum::<f64>() / values.len() as f64;
            let bias = own.iter().sum::<f64>() / own.len() as f64;
            let each = own.len() / DISTANCE_M.len();
            let by_distance: Vec<String> =
                own.chunks(each).map(|part| format!("{:.2}", 100.0 * mean(part))).collect();
            println!(
                "{list:28} {:6.0} m: mean {:6.3} %, bias {:+6.3} %, by distance {}",
                light.altitude_m,
                100.0 * mean(&own),
                100.0 * bias,
                by_distance.join(" ")
            );
            errors.extend(own);
        }
        errors.iter_mut().for_each(|error| *error = error.abs());
        errors.sort_by(f64::total_cmp);
        if let Some(largest) = errors.last() {
            println!(
                "{list:28} all: mean {:.3} %, 99 % {:.3} %, largest {:.3} %",
                100.0 * errors.iter().sum::<f64>() / errors.len() as f64,
                100.0 * errors[errors.len() * 99 / 100],
                100.0 * largest
            );
        }
    }
    Ok(())
}
