//! What responses see of lamps, from the kernel at the nodes, beside the integral over the whole spectrum.

use crate::arguments::{List, Outcome};
use rayon::prelude::*;
use skyglow_lab::setup::later_orders;
use skyglow_physics::{
    Atmosphere, BAND_COUNT, Band, Direction, LampPreset, PointSource, Response, Turbidity,
    direct_sum::{direct_sum, grid_direction, stratified_samples},
    spectrum::{NODE_COUNT, Spectrum, nodes_nm},
};
use std::{error::Error, time::Instant};

/// Wavelengths of the integral's kernel, nm: every 30 nm, between them a cubic in the logarithms.
const WAVELENGTHS_NM: [f64; 18] = [
    390.0, 420.0, 450.0, 480.0, 510.0, 540.0, 570.0, 600.0, 630.0, 660.0, 690.0, 720.0, 750.0, 780.0, 810.0,
    840.0, 870.0, 900.0,
];
/// Distances of the sources, metres.
const DISTANCES_M: [f64; 5] = [1e3, 3e3, 1e4, 3e4, 1e5];

/// What every response sees of every lamp, all orders of scattering: from the kernel at the nodes by Gauss rules, beside the 5 nm
/// integral of a kernel that is known every 30 nm. Skies are sums over five lights, 1 to 100 km away, mixed at random. Prints the mean
/// error, its 99th percentile and the largest over skies, directions and turbidities.
#[derive(Debug, clap::Args)]
pub(crate) struct Arguments {
    /// Turbidities, such as `1.5,2.5,6`.
    turbidities: List<f64>,
    /// Skies of each.
    skies: usize,
    /// Directions of each.
    directions: usize,
}

/// `[source][direction][wavelength]`.
type Kernels = Vec<Vec<Vec<f64>>>;

pub(crate) fn run(Arguments { turbidities, skies, directions }: &Arguments) -> Outcome {
    let start = Instant::now();
    let looks: Vec<Direction> = stratified_samples(*directions).into_iter().map(grid_direction).collect();
    let nodes = nodes_nm();
    // What is known where: the integral's wavelengths, and the nodes.
    let mut errors: Vec<Vec<f64>> = vec![Vec::new(); LampPreset::ALL.len() * Response::ALL.len()];
    let mut random = 0x9e37_79b9_7f4a_7c15_u64;
    for &turbidity in &turbidities.0 {
        let fine = kernels(turbidity, &WAVELENGTHS_NM, &looks)?;
        let coarse = kernels(turbidity, &nodes, &looks)?;
        for _ in 0..*skies {
            let weights = DISTANCES_M.map(|distance_m| {
                random =
                    random.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
                // Between e⁻³ and e³ of what makes all distances alike.
                distance_m.powi(2) * (6.0 * ((random >> 40) as f64 / (1u64 << 24) as f64) - 3.0).exp()
            });
            for look in 0..looks.len() {
                let mixed = |kernels: &Kernels, at: usize| -> f64 {
                    kernels.iter().zip(weights).map(|(of, weight)| weight * of[look][at]).sum()
                };
                let logs: Vec<f64> = (0..WAVELENGTHS_NM.len()).map(|at| mixed(&fine, at).ln()).collect();
                if !logs.iter().all(|log| log.is_finite()) {
                    continue;
                }
                let spectrum = Spectrum::from_fn(|nm| between(&logs, nm));
                let kernel: [f64; NODE_COUNT] = std::array::from_fn(|node| mixed(&coarse, node));
                errors.par_iter_mut().enumerate().for_each(|(at, errors)| {
                    let (lamp, response) = (at / Response::ALL.len(), at % Response::ALL.len());
                    let (lamp, response) = (LampPreset::ALL[lamp].lamp(), &Response::ALL[response]);
                    let exact = response.value_of(&lamp.light().spectrum().product(&spectrum));
                    if exact > 0.0 {
                        errors.push((lamp.light().rule(response).value(kernel) / exact - 1.0).abs());
                    }
                });
            }
        }
    }
    let names: Vec<&str> = Response::ALL.iter().map(Response::name).collect();
    println!("mean / 99 % / largest error, %; nodes {nodes:?} nm; {:.0} s", start.elapsed().as_secs_f64());
    println!("| lamp | {} |\n|---{}|", names.join(" | "), "|---".repeat(names.len()));
    for (lamp, of_lamp) in LampPreset::ALL.iter().zip(errors.chunks_mut(Response::ALL.len())) {
        let cells: Vec<String> = of_lamp.iter_mut().map(|errors| summary(errors)).collect();
        println!("| `{}` | {} |", lamp.name(), cells.join(" | "));
    }
    let mut all = errors.concat();
    println!("all: {}", summary(&mut all));
    Ok(())
}

fn summary(errors: &mut [f64]) -> String {
    if errors.is_empty() {
        return "–".to_owned();
    }
    errors.sort_by(f64::total_cmp);
    let mean = errors.iter().sum::<f64>() / errors.len() as f64;
    let most = errors[errors.len() - 1];
    let near_most = errors[(errors.len() - 1) * 99 / 100];
    format!("{:.2} / {:.2} / {:.1}", 100.0 * mean, 100.0 * near_most, 100.0 * most)
}

/// The sky of a watt at each distance, all orders, at some wavelengths, from the ground.
fn kernels(turbidity: f64, wavelengths_nm: &[f64], looks: &[Direction]) -> Result<Kernels, Box<dyn Error>> {
    let source = |(at, distance_m): (usize, &f64)| PointSource {
        azimuth_rad: 1.3 * at as f64,
        distance_m: *distance_m,
        altitude_m: 0.0,
        flux_dnb_w: 1.0,
    };
    let sources: Vec<PointSource> = DISTANCES_M.iter().enumerate().map(source).collect();
    let mut found: Kernels = vec![vec![Vec::new(); looks.len()]; sources.len()];
    let mut sum = later_orders(Turbidity::new(turbidity)?, 2.0);
    for some in wavelengths_nm.chunks(BAND_COUNT) {
        // In the order of the bands' own lengths; what is missing of a last group is there twice.
        let mut sorted: Vec<f64> = (0..BAND_COUNT).map(|at| some[at.min(some.len() - 1)]).collect();
        sorted.sort_by(f64::total_cmp);
        let rank = |band: Band| Band::ALL.iter().filter(|b| b.wavelength_nm() < band.wavelength_nm()).count();
        let of_bands = Band::ALL.map(|band| sorted[rank(band)]);
        sum.atmosphere = Atmosphere::at(Turbidity::new(turbidity)?, of_bands);
        let later = sum.radiance_of_each(&sources, [1.0; BAND_COUNT], looks)?;
        for (at, source) in sources.iter().enumerate() {
            let first = direct_sum::<BAND_COUNT>(
                &[sum.atmosphere],
                std::slice::from_ref(source),
                sum.observer_altitude_m,
                sum.emission,
                [1.0; BAND_COUNT],
                looks,
                &|| (),
            );
            for (look, found) in found[at].iter_mut().enumerate() {
                found.extend(some.iter().map(|nm| {
                    let band = of_bands.iter().position(|of| of == nm).unwrap_or_default();
                    first[look][band] + later[at][look][band]
                }));
            }
        }
    }
    Ok(found)
}

/// The kernel between the wavelengths at which its logarithm is known: a cubic through the four around.
fn between(logs: &[f64], nm: f64) -> f64 {
    let after = WAVELENGTHS_NM.partition_point(|at| *at < nm);
    let first = after.saturating_sub(2).min(logs.len() - 4);
    let places = &WAVELENGTHS_NM[first..first + 4];
    let weight = |node: usize| -> f64 {
        let others = (0..4).filter(|other| *other != node);
        others
            .map(|other| (nm.ln() - places[other].ln()) / (places[node].ln() - places[other].ln()))
            .product()
    };
    (0..4).map(|node| weight(node) * logs[first + node]).sum::<f64>().exp()
}
