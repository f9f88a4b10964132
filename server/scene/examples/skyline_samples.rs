//! How many azimuths and reaches the skyline of a light needs, and from where on terrain is a wall to it:
//! `skyline_samples DATA SCENE [LIGHTS [WEST,SOUTH,EAST,NORTH]]`.
//!
//! For some lights (default 500) and an observer each, at random azimuths and distances of 1 to 200 km (even in the
//! logarithm): the exact blocking angle towards the observer, against what is interpolated from samples as the scene
//! does it. Differences are places on the axis of blocking angles, of which the tables have 8. Within bounds, lights
//! are put anywhere on the ground instead of where the scene has them.
//!
//! Then the light at its pixel's centre, past terrain nearer than some part of the pixel's side, against 25 lamps
//! spread over the pixel, each on its own ground.
//!
//! `cargo run --release -p skyglow-scene --example skyline_samples -- DATA kenya`

#![expect(clippy::expect_used, reason = "a measuring tool for developers stops at the first error")]

use rayon::prelude::*;
use skyglow_physics::GeoPoint;
use skyglow_physics::blocking::blocking_position;
use skyglow_scene::{DEMO_ID, Scene, SceneId, SceneStore, create_demo};
use std::f64::consts::TAU;

/// A light's place and altitude, metres.
type Light = (GeoPoint, f64);

/// The side of a pixel in the second comparison, metres.
const PIXEL_M: f64 = 463.0;

/// A way of sampling: azimuths, the first reach [m], the factor from reach to reach, the number of reaches.
const WAYS: [(usize, f64, f64, i32); 9] = [
    (16, 500.0, 2.0, 9),
    (32, 1000.0, 4.0, 4),
    (32, 1000.0, 4.0, 5),
    (32, 500.0, 2.0, 8),
    (32, 1000.0, 2.0, 8),
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
fn compare(scene: &Scene, (light, altitude_m): Light, azimuth_rad: f64, distance_m: f64) -> Vec<f64> {
    let size_m = scene.metadata().pixel_size_m;
    let sample = |azimuth_rad: f64, distance_m: f64| {
        let towards = light.destination(azimuth_rad, distance_m);
        place_of(scene.blocking_angle_rad(light, altitude_m, size_m, towards))
    };
    let ways = WAYS.iter().map(|&way| sampled(&sample, way, azimuth_rad, distance_m));
    std::iter::once(sample(azimuth_rad, distance_m)).chain(ways).collect()
}

/// Parts of the pixel's side within which terrain is no wall.
const NEAREST_PARTS: [f64; 5] = [0.0, 0.125, 0.25, 0.5, 1.0];

/// The mean place of lamps spread over a pixel, and that of its centre by each of [`NEAREST_PARTS`].
fn compare_spread(scene: &Scene, (light, altitude_m): Light, azimuth_rad: f64, distance_m: f64) -> Vec<f64> {
    let size_m = PIXEL_M;
    let towards = light.destination(azimuth_rad, distance_m);
    let lamps: Vec<f64> = (0..25)
        .filter_map(|number| {
            let offset_m = |n: i32| f64::from(n - 2) * 0.2 * size_m;
            let (east_m, north_m) = (offset_m(number % 5), offset_m(number / 5));
            let lamp = light.destination(east_m.atan2(north_m), east_m.hypot(north_m));
            let altitude_m = scene.terrain_altitude_m(lamp)?;
            Some(place_of(scene.blocking_angle_rad(lamp, altitude_m, 0.2 * size_m, towards)))
        })
        .collect();
    let mean = lamps.iter().sum::<f64>() / lamps.len().max(1) as f64;
    let by_part = NEAREST_PARTS
        .iter()
        .map(|part| place_of(scene.blocking_angle_rad(light, altitude_m, 8.0 * part * size_m, towards)));
    std::iter::once(mean).chain(by_part).collect()
}

/// Mean, bias and 90th percentile of the errors of column `column` against the first.
fn statistics(rows: &[Vec<f64>], column: usize) -> String {
    let mut errors: Vec<f64> = rows.iter().map(|row| row[column] - row[0]).collect();
    let bias = errors.iter().sum::<f64>() / rows.len() as f64;
    errors.iter_mut().for_each(|error| *error = error.abs());
    errors.sort_by(f64::total_cmp);
    let mean = errors.iter().sum::<f64>() / rows.len() as f64;
    format!("mean error {mean:.3}, bias {bias:+.3}, 90 % below {:.3}", errors[rows.len() * 9 / 10])
}

/// Number `number` of a sequence that is even over 0..1, instead of chance: the golden ratio and its kin.
fn even(number: usize, ratio: f64) -> f64 {
    (number as f64 * ratio).fract()
}

fn lights_of(scene: &Scene, count: usize, bounds: Option<&str>) -> Vec<Light> {
    if let Some(text) = bounds {
        let edges: Vec<f64> = text.split(',').map(|edge| edge.parse().expect("degrees")).collect();
        let place = |number: usize| {
            let across = |low: f64, high: f64, ratio: f64| low + even(number, ratio) * (high - low);
            let latitude_deg = across(edges[1], edges[3], 0.819_172_513_396_164_4);
            let longitude_deg = across(edges[0], edges[2], 0.671_043_606_703_789_2);
            GeoPoint::from_deg(latitude_deg, longitude_deg).expect("a place")
        };
        let ground = |place: GeoPoint| scene.terrain_altitude_m(place).map(|altitude_m| (place, altitude_m));
        return (0..count).filter_map(|number| ground(place(number))).collect();
    }
    let [west, south, east, north] = scene.metadata().bounds;
    let middle = GeoPoint::from_deg(0.5 * (south + north), 0.5 * (west + east)).expect("a place");
    let pixels = scene.source_pixels_within(middle, 1.2e6);
    assert!(!pixels.is_empty(), "a scene with light");
    let pixel = |number: usize| {
        let pixel = &pixels[(even(number, 0.618_033_988_749_894_9) * pixels.len() as f64) as usize];
        (GeoPoint::from_vector(pixel.center()), pixel.altitude_m)
    };
    (0..count).map(pixel).collect()
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
    let lights = lights_of(&scene, count, arguments.get(4).map(String::as_str));
    let rows_of = |compare: &(dyn Fn(&Scene, Light, f64, f64) -> Vec<f64> + Sync)| -> Vec<Vec<f64>> {
        lights
            .par_iter()
            .enumerate()
            .map(|(number, light)| {
                let azimuth_rad = TAU * even(number, 0.754_877_666_246_692_8);
                compare(
                    &scene,
                    *light,
                    azimuth_rad,
                    1000.0 * 200f64.powf(even(number, 0.569_840_290_998_053_3)),
                )
            })
            .collect()
    };
    let rows = rows_of(&compare);
    let blocked = rows.iter().filter(|row| row[0] > 0.0).count();
    let mean_place = rows.iter().map(|row| row[0]).sum::<f64>() / rows.len() as f64;
    println!("{} lights, {blocked} blocked, mean place {mean_place:.3}", rows.len());
    for (index, (azimuths, first_m, factor, reaches)) in WAYS.into_iter().enumerate() {
        println!(
            "{azimuths:3} azimuths, {reaches:2} reaches from {first_m:.0} m by {factor:.2}: {}",
            statistics(&rows, index + 1)
        );
    }
    println!("a light of {PIXEL_M} m at its centre against lamps all over it");
    let rows = rows_of(&compare_spread);
    for (index, part) in NEAREST_PARTS.into_iter().enumerate() {
        println!("no wall within {part:.3} of its side: {}", statistics(&rows, index + 1));
    }
}
