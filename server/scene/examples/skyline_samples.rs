//! How many azimuths and reaches the skyline of a light needs: `skyline_samples DATA SCENE [LIGHTS]`.
//!
//! For some lights (default 500) and an observer each, at random azimuths and distances of 1 to 200 km (even in the
//! logarithm): the exact blocking angle towards the observer, against what is interpolated from samples as the scene
//! does it. Differences are places on the axis of blocking angles, of which the tables have 8.
//!
//! `cargo run --release -p skyglow-scene --example skyline_samples -- DATA kenya`

#![expect(clippy::expect_used, reason = "a measuring tool for developers stops at the first error")]

use rayon::prelude::*;
use skyglow_physics::blocking::blocking_position;
use skyglow_physics::geometry::LocalFrame;
use skyglow_physics::{GeoPoint, SourcePixel};
use skyglow_scene::{DEMO_ID, Scene, SceneId, SceneStore, create_demo};
use std::f64::consts::TAU;

/// A way of sampling: azimuths, the first reach [m], the factor from reach to reach, the number of reaches.
const WAYS: [(usize, f64, f64, i32); 8] = [
    (16, 500.0, 2.0, 9),
    (32, 1000.0, 4.0, 4),
    (32, 1000.0, 4.0, 5),
    (32, 500.0, 2.0, 8),
    (32, 500.0, 2.0, 9),
    (32, 500.0, std::f64::consts::SQRT_2, 17),
    (64, 500.0, 2.0, 9),
    (64, 500.0, std::f64::consts::SQRT_2, 17),
];

fn place_of(angle_rad: f64) -> f64 {
    let (node, weight) = blocking_position(angle_rad.to_degrees());
    node as f64 + weight
}

/// Interpolated place of the skyline, by samples asked for as they are needed.
fn sampled(
    sample: &dyn Fn(f64, f64) -> f64,
    (azimuths, first_m, factor, reaches): (usize, f64, f64, i32),
    azimuth_rad: f64,
    distance_m: f64,
) -> f64 {
    let reach = ((distance_m / first_m).ln() / factor.ln()).min(f64::from(reaches - 1));
    if reach <= -1.0 {
        return 0.0;
    }
    let column = azimuth_rad / TAU * azimuths as f64;
    let at = |column: f64| {
        let azimuth_rad = column * TAU / azimuths as f64;
        let within = |reach: f64| {
            if reach < 0.0 { 0.0 } else { sample(azimuth_rad, first_m * factor.powf(reach)) }
        };
        let inner = reach.floor();
        let low = within(inner);
        if reach > inner { low + (reach - inner) * (within(inner + 1.0) - low) } else { low }
    };
    let along = column - column.floor();
    (1.0 - along) * at(column.floor()) + along * at(column.floor() + 1.0)
}

/// The exact place and those of all ways for a light and one observer.
fn compare(scene: &Scene, pixel: &SourcePixel, azimuth_rad: f64, distance_m: f64) -> Vec<f64> {
    let light = GeoPoint::from_vector(pixel.center());
    let size_m = scene.metadata().pixel_size_m;
    let sample = |azimuth_rad: f64, distance_m: f64| {
        let towards = light.destination(azimuth_rad, distance_m);
        place_of(scene.blocking_angle_rad(light, pixel.altitude_m, size_m, towards))
    };
    let ways = WAYS.iter().map(|&way| sampled(&sample, way, azimuth_rad, distance_m));
    std::iter::once(sample(azimuth_rad, distance_m)).chain(ways).collect()
}

fn main() {
    let arguments: Vec<String> = std::env::args().collect();
    let store = SceneStore::new(&arguments[1]);
    let id = SceneId::parse(&arguments[2]).expect("an id");
    if id.as_str() == DEMO_ID && !store.exists(&id) {
        create_demo(&store, &mut |_| {}).expect("the demo");
    }
    let scene = store.open(&id).expect("a scene");
    let count: usize = arguments.get(3).map_or(500, |text| text.parse().expect("a number"));
    let [west, south, east, north] = scene.metadata().bounds;
    let middle = GeoPoint::from_deg(0.5 * (south + north), 0.5 * (west + east)).expect("a place");
    let pixels = scene.source_pixels_within(middle, 1.2e6);
    let frame = LocalFrame::at(middle);
    assert!(frame.up.is_normalized() && !pixels.is_empty(), "a scene with light");
    let rows: Vec<Vec<f64>> = (0..count)
        .into_par_iter()
        .map(|number| {
            // Even sequences instead of chance: the golden ratio and its kin.
            let even = |ratio: f64| (number as f64 * ratio).fract();
            let pixel = &pixels[(even(0.618_033_988_749_894_9) * pixels.len() as f64) as usize];
            let (azimuth_rad, log) = (TAU * even(0.754_877_666_246_692_8), even(0.569_840_290_998_053_3));
            compare(&scene, pixel, azimuth_rad, 1000.0 * 200f64.powf(log))
        })
        .collect();
    let blocked = rows.iter().filter(|row| row[0] > 0.0).count();
    let mean_place = rows.iter().map(|row| row[0]).sum::<f64>() / count as f64;
    println!("{count} lights, {blocked} blocked, mean place {mean_place:.3}");
    for (index, (azimuths, first_m, factor, reaches)) in WAYS.into_iter().enumerate() {
        let mut errors: Vec<f64> = rows.iter().map(|row| row[index + 1] - row[0]).collect();
        let bias = errors.iter().sum::<f64>() / count as f64;
        errors.iter_mut().for_each(|error| *error = error.abs());
        errors.sort_by(f64::total_cmp);
        println!(
            "{azimuths:3} azimuths, {reaches:2} reaches from {first_m:.0} m by {factor:.2}: mean error {:.3}, bias {bias:+.3}, \
             90 % below {:.3}",
            errors.iter().sum::<f64>() / count as f64,
            errors[count * 9 / 10]
        );
    }
}
