//! Times of maps of influences, step by step: `cargo run --release -p skyglow-engine --example influence_times -- PACKS`.
//!
//! Arguments: folder of packs; pixels a side of a made-up square of lights of 463 m, all of them lit (1000); rounds (20).
//! On the processor; the place is in the middle. The first map finds the light, the others have it.

#[allow(clippy::unwrap_used, reason = "what the tests set a scene up with stops at the first error")]
#[path = "../tests/common/mod.rs"]
mod common;

use skyglow_engine::{
    DeviceChoice, Engine, EngineConfig, InfluenceRequest, Measure, Observatory, ObserverHeight, SkyRequest,
    resident_tables,
};
use skyglow_physics::{Direction, EmissionMix, GeoPoint, LampPreset, SkyCurve, Turbidity};
use skyglow_tables::Scattering;
use std::{error::Error, path::Path, time::Instant};

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let packs = arguments.first().ok_or("which folder of packs?")?;
    let number = |position: usize, default: usize| {
        arguments.get(position).and_then(|text| text.parse().ok()).unwrap_or(default)
    };
    let (side, rounds) = (number(1, 1000), number(2, 20));
    let folder = tempfile::tempdir()?;
    let step_deg = 463.0 / 111_195.0;
    let (west_deg, north_deg) = (37.0 - 0.5 * side as f64 * step_deg, 0.5 * side as f64 * step_deg);
    // Hills, and light that falls off from some towns.
    let ground_m = |row: usize, column: usize| {
        600.0 + 300.0 * (0.013 * row as f32).sin() + 200.0 * (0.017 * column as f32).cos()
    };
    let light = |row: usize, column: usize| {
        0.3 + 40.0 * ((0.05 * row as f32).sin() * (0.06 * column as f32).sin()).max(0.0).powi(8)
    };
    common::store_scene(folder.path(), side, [west_deg, north_deg, step_deg], 1.0, &ground_m, &light);
    let (tables, manifests) = resident_tables(&skyglow_tables::packs_in(Path::new(packs))?)?;
    let engine =
        Engine::start(EngineConfig { device: DeviceChoice::Cpu, tables, ..EngineConfig::default() })?;
    let observatory = Observatory::new(engine, manifests, folder.path(), 1);
    let corner = |azimuth_deg: f64, elevation_deg: f64| Direction {
        azimuth_rad: azimuth_deg.to_radians(),
        elevation_rad: elevation_deg.to_radians(),
    };
    let region = SkyCurve::new(vec![corner(350.0, 10.0), corner(20.0, 10.0), corner(5.0, 50.0)])?;
    let measures = [Measure::Zenith, Measure::Mean, Measure::Region(region), Measure::Norm];
    println!("milliseconds: first map, then fastest and median of {rounds}, with the steps of the median");
    for turbidity in [2.5, 3.5] {
        for measure in &measures {
            let mut place = 0.0;
            let mut map = |is_new: bool| -> Result<_, Box<dyn Error>> {
                // Another place has no light found yet.
                place += if is_new { 1e-4 } else { 0.0 };
                let request = InfluenceRequest {
                    sky: SkyRequest {
                        scene: common::town(),
                        scenario: None,
                        place: GeoPoint::from_deg(0.003 + place + 0.01 * turbidity, 37.002)?,
                        observer_height: ObserverHeight::AboveGround(2.0),
                        turbidity: Turbidity::new(turbidity)?,
                        scattering: Scattering::Multiple,
                        cloud_base_m: None,
                        lamp: LampPreset::Mixed.lamp(),
                        emission: EmissionMix::garstang(),
                        basis: None,
                        tolerance: None,
                        terrain_hides: true,
                    },
                    measure: measure.clone(),
                };
                let start = Instant::now();
                let map = observatory.influence(&request)?;
                Ok((1e3 * start.elapsed().as_secs_f64(), map))
            };
            let (first_ms, _) = map(true)?;
            let mut times = (0..rounds).map(|_| map(false)).collect::<Result<Vec<_>, _>>()?;
            times.sort_by(|a, b| a.0.total_cmp(&b.0));
            let (median_ms, median) = &times[rounds / 2];
            let steps: Vec<String> = median
                .steps
                .iter()
                .map(|(name, time)| format!("{name} {:.1}", 1e3 * time.as_secs_f64()))
                .collect();
            println!(
                "T {turbidity} {:<28} {} pixels: {first_ms:.0}; {:.1}, {median_ms:.1} ({})",
                format!("{measure:?}").chars().take(20).collect::<String>(),
                median.pixels().len(),
                times[0].0,
                steps.join(", ")
            );
        }
    }
    Ok(())
}
