//! Times of a panorama of a place, pass by pass, and of the direct sum.

use crate::arguments::{Outcome, PlaceArguments};
use skyglow_lab::setup::{clear_sky, engine_of};
use skyglow_physics::{
    AZIMUTH_COUNT, Atmosphere, BAND_COUNT, ELEVATION_COUNT, EmissionMix,
    direct_sum::{direct_sum, grid_direction, stratified_samples},
    source_pixel::{MAX_SOURCE_DISTANCE_M, point_sources},
};
use skyglow_render::{DeviceChoice, RenderError, resident_tables};
use skyglow_tables::{Scattering, packs_in};
use std::{sync::Arc, time::Instant};

const ROUNDS: usize = 30;
const DIRECTIONS: usize = 16;

/// A panorama of a real place pass by pass, and the direct sum of the same sky, in one run: the executors in turn, then the
/// sum over every pixel in 16 directions, scaled to the panorama's 16 384.
#[derive(Debug, clap::Args)]
pub(crate) struct Arguments {
    #[command(flatten)]
    place: PlaceArguments,
}

pub(crate) fn run(Arguments { place: asked }: &Arguments) -> Outcome {
    let (scene, place, turbidity) = (asked.open()?, asked.place()?, asked.turbidity);
    let observer_altitude_m = scene.ground(place).altitude_m() + 2.0;
    let (tables, _) = resident_tables(&packs_in(&asked.packs)?)?;

    // All kinds of packs take the same passes.
    let scattering = tables.iter().map(|tables| tables.scattering).max().unwrap_or(Scattering::Single);

    let start = Instant::now();
    let polar = Arc::new(scene.polar_grid(place, false));
    println!("polar grid: {:.1} ms, {} lit cells", 1e3 * start.elapsed().as_secs_f64(), polar.cells.len());
    let mut best_time_s = f64::INFINITY;
    for device in [DeviceChoice::Gpu, DeviceChoice::Lavapipe, DeviceChoice::Cpu] {
        let started = engine_of(tables.clone(), device);
        if let Err(RenderError::NoAdapter { .. }) = started {
            println!("{device:?}: there is none here");
            continue;
        }
        let engine = started?;
        let mut rounds = Vec::with_capacity(ROUNDS);
        for _ in 0..ROUNDS {
            let start = Instant::now();
            let request = clear_sky(Arc::clone(&polar), observer_altitude_m, turbidity, scattering);
            let rendered = engine.render_blocking(request)?;
            rounds.push((start.elapsed().as_secs_f64(), rendered.passes));
        }
        rounds.sort_by(|a, b| a.0.total_cmp(&b.0));
        let (median_s, passes) = &rounds[ROUNDS / 2];
        print!("{}: {:.2} ms, median of {ROUNDS} |", engine.info().executor.name(), 1e3 * median_s);
        for pass in passes {
            print!(" {} {:.2}", pass.name, pass.microseconds / 1e3);
        }
        println!();
        best_time_s = best_time_s.min(*median_s);
    }

    let sources = point_sources(place, &scene.source_pixels_within(place, MAX_SOURCE_DISTANCE_M));
    let directions: Vec<_> = stratified_samples(DIRECTIONS).into_iter().map(grid_direction).collect();
    let start = Instant::now();
    let sum: Vec<[f64; BAND_COUNT]> = direct_sum(
        &[Atmosphere::new(turbidity)],
        &sources,
        observer_altitude_m,
        EmissionMix::garstang(),
        skyglow_bench::options::REFERENCE_FLUX,
        &directions,
        &|| (),
    );
    let seconds = start.elapsed().as_secs_f64();
    let whole_s = seconds * (AZIMUTH_COUNT * ELEVATION_COUNT) as f64 / sum.len() as f64;
    println!(
        "direct sum: {} sources, {} directions in {seconds:.2} s, so a panorama in {:.2} h: {:.0} times the faster of \
         those above",
        sources.len(),
        sum.len(),
        whole_s / 3600.0,
        whole_s / best_time_s
    );
    Ok(())
}
