//! Influences of single pixels beside their reference solutions.

use crate::arguments::{Outcome, PlaceArguments};
use skyglow_lab::setup::{later_orders, observatory, open_sky};
use skyglow_observatory::{InfluenceRequest, Measure};
use skyglow_physics::{
    AZIMUTH_COUNT, BAND_COUNT, Direction, ELEVATION_COUNT, Horizon, LampPreset, LinearMeasure, PointSource,
    Response, SkyCurve,
    direct_sum::{direct_sum, grid_direction},
    panorama::solid_angle_sr,
    source_pixel::{MAX_SOURCE_DISTANCE_M, point_sources},
};
use std::{error::Error, time::Instant};

/// Influences of single pixels beside the sum over each alone, all orders, every direction of the grid: of lit pixels
/// within 300 km, drawn by chance, half of them with chances in proportion to their influence on the zenith. Lights are
/// under an open sky on both sides. Minutes: a field of later orders for every 300 m of source altitude.
#[derive(Debug, clap::Args)]
pub(crate) struct Arguments {
    #[command(flatten)]
    place: PlaceArguments,
    /// How many pixels.
    count: usize,
}

pub(crate) fn run(Arguments { place: asked, count }: &Arguments) -> Outcome {
    let (id, place, turbidity) = (asked.scene.clone(), asked.place()?, asked.turbidity);
    let observatory = observatory(&asked.data, &asked.packs)?;
    let rule = LampPreset::Mixed.lamp().light().rule(&Response::Photopic);
    let sky = open_sky(id.clone(), place, turbidity);
    let measures = [
        ("zenith", Measure::Zenith),
        ("mean", Measure::Mean),
        ("horizontal", Measure::Horizontal),
        (
            "region that wraps north",
            Measure::Region(curve(&[(340.0, 10.0), (25.0, 10.0), (25.0, 40.0), (340.0, 40.0)])?),
        ),
        (
            "region that touches the zenith",
            Measure::Region(curve(&[(0.0, 90.0), (200.0, 20.0), (260.0, 20.0)])?),
        ),
        (
            "region that crosses itself",
            Measure::Region(curve(&[(80.0, 15.0), (130.0, 50.0), (130.0, 15.0), (80.0, 50.0)])?),
        ),
        ("norm", Measure::Norm),
    ];
    let mut maps = Vec::new();
    for (name, measure) in &measures {
        let map = observatory.influence(&InfluenceRequest { sky: sky.clone(), measure: measure.clone() })?;
        maps.push((*name, measure, map));
    }
    let (_, _, zenith) = &maps[0];
    let chosen = draw(zenith.influence(), *count);
    let scene = asked.open()?;
    let pixels = scene.source_pixels_within(place, MAX_SOURCE_DISTANCE_M);
    if pixels.len() != zenith.pixels().len() {
        return Err("the maps hold other pixels than the scene".into());
    }
    // The points that each pixel stands for, one pixel after the other.
    let points: Vec<Vec<PointSource>> = chosen
        .iter()
        .map(|&position| point_sources(place, std::slice::from_ref(&pixels[position])))
        .collect();
    let sources = points.concat();
    let directions: Vec<Direction> = (0..ELEVATION_COUNT * AZIMUTH_COUNT)
        .map(|at| grid_direction((at / AZIMUTH_COUNT, at % AZIMUTH_COUNT)))
        .collect();
    let sum = later_orders(turbidity, zenith.context.altitude_m);
    let start = Instant::now();
    let later = sum.radiance_of_each(&sources, [1.0; BAND_COUNT], &directions)?;
    let mut luminance = Vec::new();
    let mut first_source = 0;
    for points in &points {
        let first = direct_sum::<BAND_COUNT>(
            &[sum.atmosphere],
            points,
            sum.observer_altitude_m,
            sum.emission,
            [1.0; BAND_COUNT],
            &directions,
            &|| (),
        );
        let of_pixel: Vec<f64> = (0..directions.len())
            .map(|direction| {
                let later: [f64; BAND_COUNT] = std::array::from_fn(|band| {
                    later[first_source..][..points.len()].iter().map(|one| one[direction][band]).sum()
                });
                // Of the light by itself: what it adds to the sky of all has the colour of that sky.
                rule.value(std::array::from_fn(|band| first[direction][band] + later[band]))
            })
            .collect();
        luminance.push(of_pixel);
        first_source += points.len();
    }
    println!(
        "{} pixels of {} within 300 km of {:.4}, {:.4} at {:.0} m; reference {:.0} s",
        chosen.len(),
        pixels.len(),
        place.latitude_deg(),
        place.longitude_deg(),
        sum.observer_altitude_m,
        start.elapsed().as_secs_f64()
    );
    println!(
        "{:<32} {:>8} {:>8} {:>8} {:>8}   over all, %",
        "measure", "mean %", "50 % %", "90 % %", "100 % %"
    );
    for (name, measure, map) in &maps {
        let weights = weights(measure);
        let reference = |luminance: &Vec<f64>| -> f64 {
            match &weights {
                Some(weights) => weights.weights().iter().zip(luminance).map(|(w, l)| w * l).sum(),
                None => (luminance.iter().enumerate())
                    .map(|(at, l)| solid_angle_sr(at / AZIMUTH_COUNT) * l * l)
                    .sum::<f64>()
                    .sqrt(),
            }
        };
        let references: Vec<f64> = luminance.iter().map(reference).collect();
        let found: Vec<f64> = chosen.iter().map(|&position| f64::from(map.influence()[position])).collect();
        let mut errors: Vec<f64> = found
            .iter()
            .zip(&references)
            .map(|(found, reference)| 100.0 * (found / reference - 1.0).abs())
            .collect();
        errors.sort_by(f64::total_cmp);
        let all = 100.0 * (found.iter().sum::<f64>() / references.iter().sum::<f64>() - 1.0);
        let mean = errors.iter().sum::<f64>() / errors.len() as f64;
        let at = |part: f64| errors[((errors.len() - 1) as f64 * part) as usize];
        println!("{name:<32} {mean:8.2} {:8.2} {:8.2} {:8.2}   {all:+.2}", at(0.5), at(0.9), at(1.0));
    }
    Ok(())
}

fn curve(corners_deg: &[(f64, f64)]) -> Result<SkyCurve, Box<dyn Error>> {
    let corner = |&(azimuth_deg, elevation_deg): &(f64, f64)| Direction {
        azimuth_rad: azimuth_deg.to_radians(),
        elevation_rad: elevation_deg.to_radians(),
    };
    Ok(SkyCurve::new(corners_deg.iter().map(corner).collect())?)
}

fn weights(measure: &Measure) -> Option<LinearMeasure> {
    let open = Horizon::flat();
    Some(match measure {
        Measure::Norm => return None,
        Measure::Zenith => LinearMeasure::zenith(&open),
        Measure::Mean => LinearMeasure::mean(&open),
        Measure::Horizontal => LinearMeasure::horizontal(&open),
        Measure::Region(curve) => LinearMeasure::region(curve, &open),
    })
}

/// Positions drawn by chance without repeats: half evenly, half by influence.
fn draw(influence: &[f32], count: usize) -> Vec<usize> {
    let mut state = 0x9e37_79b9_7f4a_7c15u64;
    let mut uniform = move || {
        state ^= state << 13;
        state ^= state >> 7;
        state ^= state << 17;
        (state >> 11) as f64 / (1u64 << 53) as f64
    };
    let total: f64 = influence.iter().map(|value| f64::from(*value)).sum();
    let mut chosen = std::collections::BTreeSet::new();
    while chosen.len() < count.min(influence.len()) {
        if chosen.len() % 2 == 0 {
            chosen.insert((uniform() * influence.len() as f64) as usize);
            continue;
        }
        let mut left = uniform() * total;
        let drawn = influence.iter().position(|value| {
            left -= f64::from(*value);
            left <= 0.0
        });
        chosen.extend(drawn);
    }
    chosen.into_iter().collect()
}
