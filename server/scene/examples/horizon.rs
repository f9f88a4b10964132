//! Compares horizons with a slow walk over the terrain in small steps, and times them: `horizon DATA SCENE
//! [PLACES [SAMPLE_M]]`
//! at PLACES random places (default 12); SAMPLE_M is the size of the terrain's samples (default 100 m).
//!
//! `cargo run --release -p skyglow-scene --example horizon -- DATA kenya 12`

#![expect(clippy::expect_used, reason = "a measuring tool for developers stops at the first error")]

use skyglow_physics::horizon::{farthest_terrain_m, terrain_elevation_tangent};
use skyglow_physics::panorama::azimuth_rad;
use skyglow_physics::{AZIMUTH_COUNT, GeoPoint};
use skyglow_scene::{Scene, SceneId, SceneStore};
use std::time::Instant;

/// Steps of the walk, metres: fine near the observer, where a step is a large angle.
fn step_m(distance_m: f64, sample_m: f64) -> f64 {
    (distance_m / 3000.0).clamp(0.002, sample_m / 32.0)
}

/// tan e of the highest ground towards an azimuth, at least 0, by bilinear elevations at every step.
fn walk(scene: &Scene, place: GeoPoint, eye_m: f64, azimuth_rad: f64, sample_m: f64, farthest_m: f64) -> f64 {
    let (mut best, mut distance_m) = (0.0f64, 1.0);
    while distance_m < farthest_m {
        if let Some(altitude_m) = scene.terrain_altitude_m(place.destination(azimuth_rad, distance_m)) {
            best = best.max(terrain_elevation_tangent(eye_m, altitude_m, distance_m));
        }
        distance_m += step_m(distance_m, sample_m);
    }
    best
}

/// CPU time of all threads so far, milliseconds; 0 where the system does not tell.
fn cpu_ms() -> f64 {
    let tasks = std::fs::read_dir("/proc/self/task").into_iter().flatten().flatten();
    let nanoseconds = tasks.filter_map(|task| {
        let text = std::fs::read_to_string(task.path().join("schedstat")).ok()?;
        text.split_whitespace().next()?.parse::<f64>().ok()
    });
    1e-6 * nanoseconds.sum::<f64>()
}

fn main() {
    let arguments: Vec<String> = std::env::args().collect();
    let store = SceneStore::new(&arguments[1]);
    let start = Instant::now();
    let scene = store.open(&SceneId::parse(&arguments[2]).expect("an id")).expect("a scene");
    println!("open {:.1} ms", 1e3 * start.elapsed().as_secs_f64());
    let count: usize = arguments.get(3).map_or(12, |text| text.parse().expect("a number"));
    let sample_m: f64 = arguments.get(4).map_or(100.0, |text| text.parse().expect("metres"));
    let [west, south, east, north] = scene.metadata().bounds;
    let mut seed = 0x9e37_79b9_7f4a_7c15u64;
    let mut unit = || {
        seed ^= seed << 13;
        seed ^= seed >> 7;
        seed ^= seed << 17;
        (seed >> 11) as f64 / (1u64 << 53) as f64
    };
    let mut places = Vec::new();
    let mut highest_m = 0.0f64;
    for _ in 0..200_000 {
        let place = GeoPoint::from_deg(south + unit() * (north - south), west + unit() * (east - west));
        let place = place.expect("a place");
        if let Some(altitude_m) = scene.terrain_altitude_m(place) {
            highest_m = highest_m.max(altitude_m);
            if places.len() < count {
                places.push(place);
            }
        }
    }
    // The walk goes on a little beyond the highest point that was found.
    highest_m += 400.0;
    let start = Instant::now();
    scene.horizon(places[0], 0.0);
    println!("first horizon, with the bounds of the terrain: {:.1} ms", 1e3 * start.elapsed().as_secs_f64());
    let (mut all_ms, mut worst_deg, mut sum_deg, mut samples) = (Vec::new(), 0.0f64, 0.0, 0usize);
    for place in &places {
        let eye_m = scene.ground(*place).altitude_m() + 2.0;
        let cpu_before_ms = cpu_ms();
        let times: Vec<f64> = (0..20)
            .map(|_| {
                let start = Instant::now();
                std::hint::black_box(scene.horizon(*place, eye_m));
                1e3 * start.elapsed().as_secs_f64()
            })
            .collect();
        let cpu_ms = (cpu_ms() - cpu_before_ms) / times.len() as f64;
        let (first_ms, mut sorted_ms) = (times[0], times);
        sorted_ms.sort_by(f64::total_cmp);
        let horizon = scene.horizon(*place, eye_m);
        let farthest_m = farthest_terrain_m(eye_m, highest_m);
        let start = Instant::now();
        let errors_deg: Vec<f64> = (0..AZIMUTH_COUNT)
            .map(|column| {
                let walked = walk(&scene, *place, eye_m, azimuth_rad(column), sample_m, farthest_m).atan();
                (horizon.elevations_rad()[column] - walked).to_degrees()
            })
            .collect();
        let worst = errors_deg.iter().copied().max_by(|a, b| a.abs().total_cmp(&b.abs())).unwrap_or(0.0);
        println!(
            "{:9.4} {:9.4} eye {eye_m:6.0} m: first {first_ms:5.2} ms, median {:5.2} ms, fastest {:5.2} ms, {cpu_ms:5.2} ms \
             of all cores; highest {:5.2} deg; error largest {worst:+.5}, mean {:.6} deg; the walk took {:.1} s",
            place.latitude_deg(),
            place.longitude_deg(),
            sorted_ms[sorted_ms.len() / 2],
            sorted_ms[0],
            horizon.elevations_rad().iter().copied().fold(0.0, f64::max).to_degrees(),
            errors_deg.iter().map(|e| e.abs()).sum::<f64>() / AZIMUTH_COUNT as f64,
            start.elapsed().as_secs_f64(),
        );
        all_ms.push(sorted_ms[sorted_ms.len() / 2]);
        worst_deg = worst_deg.max(worst.abs());
        sum_deg += errors_deg.iter().map(|e| e.abs()).sum::<f64>();
        samples += AZIMUTH_COUNT;
    }
    all_ms.sort_by(f64::total_cmp);
    println!(
        "{} places: median {:.2} ms, slowest {:.2} ms; error largest {worst_deg:.5}, mean {:.6} deg",
        places.len(),
        all_ms[all_ms.len() / 2],
        all_ms[all_ms.len() - 1],
        sum_deg / samples as f64
    );
}
