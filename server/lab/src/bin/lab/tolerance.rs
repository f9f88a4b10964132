//! How many basis functions a tolerance takes.

use crate::arguments::{Outcome, PlaceArguments};
use skyglow_lab::setup::{clear_sky, engine_of};
use skyglow_render::{DeviceChoice, RenderRequest, resident_tables, truncation::relative_difference};
use skyglow_tables::{Scattering, packs_in};
use std::time::Instant;

const ROUNDS: usize = 20;

/// How many basis functions a tolerance takes at a real place, on the processor: the bound that is reported, the difference
/// that there really is to the sky of all functions, and the time.
#[derive(Debug, clap::Args)]
pub(crate) struct Arguments {
    #[command(flatten)]
    place: PlaceArguments,
}

pub(crate) fn run(Arguments { place: asked }: &Arguments) -> Outcome {
    let (scene, place) = (asked.open()?, asked.place()?);
    let (tables, _) = resident_tables(&packs_in(&asked.packs)?)?;
    let scattering = tables.iter().map(|tables| tables.scattering).max().unwrap_or(Scattering::Single);
    let observer_altitude_m = scene.ground(place).altitude_m() + 2.0;
    let request = clear_sky(scene.polar_grid(place, true), observer_altitude_m, asked.turbidity, scattering);
    let engine = engine_of(tables, DeviceChoice::Cpu)?;
    let all = engine.render_blocking(request.clone())?;
    let chooser = engine.basis_chooser();
    let start = Instant::now();
    chooser.basis_within(&request, 0.5)?;
    println!("norms of the pack: {:.0} ms, once", 1e3 * start.elapsed().as_secs_f64());
    for tolerance in [0.5, 0.2, 0.1, 0.05, 0.02, 0.01, 0.005, 0.001] {
        let mut rounds = Vec::with_capacity(ROUNDS);
        let mut within = chooser.basis_within(&request, tolerance)?;
        let mut sky = all.panorama.clone();
        for _ in 0..ROUNDS {
            let start = Instant::now();
            within = chooser.basis_within(&request, tolerance)?;
            let chosen_s = start.elapsed().as_secs_f64();
            let request = RenderRequest { basis: Some(within.basis_count), ..request.clone() };
            sky = engine.render_blocking(request)?.panorama;
            rounds.push((start.elapsed().as_secs_f64(), chosen_s));
        }
        rounds.sort_by(|a, b| a.0.total_cmp(&b.0));
        let (whole_s, chosen_s) = rounds[ROUNDS / 10];
        println!(
            "tolerance {tolerance}: {} functions, bound {:.4}, difference {:.5}; {:.2} ms, of which choosing {:.2}",
            within.basis_count,
            within.error_bound,
            relative_difference(&all.panorama, &sky),
            1e3 * whole_s,
            1e3 * chosen_s
        );
    }
    Ok(())
}
