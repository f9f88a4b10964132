//! Times of the passes of a panorama.

use crate::arguments::{Outcome, device};
use skyglow_lab::setup::{clear_sky, engine_of};
use skyglow_physics::Turbidity;
use skyglow_render::{DeviceChoice, Engine, RenderRequest, synthetic};
use skyglow_tables::Scattering;
use std::{error::Error, sync::Arc, time::Instant};

/// The time of a panorama, pass by pass, from made-up tables.
#[derive(Debug, clap::Args)]
pub(crate) struct Arguments {
    /// Lit cells.
    #[arg(default_value_t = 20_000)]
    lit_cells: usize,
    /// Basis functions.
    #[arg(default_value_t = 64)]
    basis_count: usize,
    /// Rounds.
    #[arg(default_value_t = 30)]
    rounds: usize,
    /// lavapipe, cpu or another device; both of these if left out.
    #[arg(value_parser = device)]
    device: Option<DeviceChoice>,
}

pub(crate) fn run(Arguments { lit_cells, basis_count, rounds, device }: &Arguments) -> Outcome {
    let (lit_cells, basis_count, rounds) = (*lit_cells, *basis_count, *rounds);
    let devices = device.map_or(vec![DeviceChoice::Lavapipe, DeviceChoice::Cpu], |device| vec![device]);
    let tables = synthetic::table_set(&[2.0, 3.0], basis_count);
    println!("{lit_cells} lit cells, {basis_count} functions, median of {rounds} rounds, ms a panorama");
    for device in devices {
        let start = Instant::now();
        let engine = Arc::new(engine_of(tables.clone(), device)?);
        let opened = start.elapsed();
        while !engine.is_ready() {
            std::thread::sleep(std::time::Duration::from_millis(1));
        }
        println!(
            "\n{} ({}): open after {:.0} ms, ready after {:.0} ms, {} MB resident",
            engine.info().executor.name(),
            engine.info().adapter,
            opened.as_secs_f64() * 1e3,
            start.elapsed().as_secs_f64() * 1e3,
            engine.info().resident_bytes / 1_000_000
        );
        for (turbidity, batch) in [(2.0, 1), (2.0, 4), (2.5, 1)] {
            measure(&engine, lit_cells, turbidity, batch, rounds)?;
        }
    }
    Ok(())
}

fn measure(engine: &Arc<Engine>, lit_cells: usize, turbidity: f64, batch: usize, rounds: usize) -> Outcome {
    let requests: Vec<RenderRequest> = (0..batch)
        .map(|seed| {
            let polar = synthetic::polar_grid(seed as u64, lit_cells);
            Ok(clear_sky(polar, 1661.0, Turbidity::new(turbidity)?, Scattering::Single))
        })
        .collect::<Result<_, Box<dyn Error>>>()?;
    let runtime = tokio::runtime::Builder::new_current_thread().build()?;
    let mut whole = Vec::new();
    let mut passes: Vec<(&'static str, Vec<f64>)> = Vec::new();
    for _ in 0..rounds {
        let start = Instant::now();
        let answers = runtime.block_on(async {
            let mut tasks = tokio::task::JoinSet::new();
            for request in requests.clone() {
                let engine = Arc::clone(engine);
                tasks.spawn(async move { engine.render(request).await });
            }
            tasks.join_all().await
        });
        let milliseconds = start.elapsed().as_secs_f64() * 1e3;
        let answers: Vec<_> = answers.into_iter().collect::<Result<_, _>>()?;
        // The first of several requests may have gone alone: such a round says nothing about the batch.
        if answers.iter().any(|answer| answer.batch_size != batch) {
            continue;
        }
        whole.push(milliseconds / batch as f64);
        for time in &answers[0].passes {
            let value = time.microseconds / 1e3 / batch as f64;
            match passes.iter_mut().find(|(name, _)| *name == time.name) {
                Some((_, values)) => values.push(value),
                None => passes.push((time.name, vec![value])),
            }
        }
    }
    if whole.is_empty() {
        println!("T = {turbidity}, batch {batch}: in no round were all requests rendered together");
        return Ok(());
    }
    let at = |values: &mut Vec<f64>, share: f64| {
        values.sort_by(f64::total_cmp);
        values.get((share * values.len() as f64) as usize).copied().unwrap_or(f64::NAN)
    };
    // Other programs on the machine make rounds slower, never faster.
    for (word, share) in [("median", 0.5), ("fastest tenth", 0.1)] {
        print!(
            "T = {turbidity}, batch {batch} ({} rounds), {word}: whole {:.2} |",
            whole.len(),
            at(&mut whole, share)
        );
        for (name, values) in &mut passes {
            print!(" {name} {:.3}", at(values, share));
        }
        println!();
    }
    Ok(())
}
