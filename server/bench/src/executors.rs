//! The engine on one executor after the other, timed.

use crate::{
    error::BenchError,
    machine::best_time_s,
    options::{Extent, Setting},
    report::{ExecutorRecord, Machine, PassRow},
};
use skyglow_physics::Turbidity;
use skyglow_render::{
    DeviceChoice, DeviceRates, Engine, EngineConfig, ExecutorKind, PassTime, RatesExtent, RenderError,
    RenderRequest, Rendered, WorkCount, device_rates,
};
use skyglow_scene::PolarGrid;
use std::{
    sync::Arc,
    time::{Duration, Instant},
};

/// How long an engine may take to warm up.
const WARM_UP: Duration = Duration::from_secs(120);

/// The executors that a bench asks for, each by itself.
pub(crate) const CHOICES: [(DeviceChoice, &str); 3] =
    [(DeviceChoice::Cpu, "cpu"), (DeviceChoice::Lavapipe, "lavapipe"), (DeviceChoice::Gpu, "gpu")];

/// An engine with all packs, warmed up; None where there is no such device.
///
/// # Errors
/// Whatever else keeps the engine from starting.
pub(crate) fn start(choice: DeviceChoice, setting: &Setting) -> Result<Option<Engine>, BenchError> {
    let config =
        EngineConfig { device: choice, tables: setting.set.tables().to_vec(), ..EngineConfig::default() };
    let engine = match Engine::start(config) {
        Err(RenderError::NoAdapter { .. }) => return Ok(None),
        started => started?,
    };
    let start = Instant::now();
    while !engine.is_ready() && start.elapsed() < WARM_UP {
        std::thread::sleep(Duration::from_millis(5));
    }
    Ok(Some(engine))
}

/// What an engine runs on. A GPU is measured beside it; the others are the machine, which was.
///
/// # Errors
/// A GPU that fails.
pub(crate) fn record(
    engine: &Engine,
    machine: &Machine,
    extent: &Extent,
) -> Result<ExecutorRecord, BenchError> {
    let info = engine.info();
    let rates = match info.executor {
        ExecutorKind::Gpu => Some(gpu_rates(info.executor, extent)?),
        ExecutorKind::Cpu | ExecutorKind::Lavapipe => None,
    };
    Ok(ExecutorRecord {
        executor: info.executor.name().to_owned(),
        adapter: info.adapter.clone(),
        driver: info.driver.clone(),
        resident_bytes: info.resident_bytes,
        bandwidth_gb_s: rates.map_or(machine.bandwidth_gb_s, |rates| rates.bandwidth_bytes_s / 1e9),
        multiply_adds_g_s: rates.map_or(machine.multiply_adds_g_s, |rates| rates.multiply_adds_s / 1e9),
        read_back_ms: rates.map(|rates| 1e3 * rates.read_back_s),
    })
}

/// Multiply-adds of a dispatch over those of a thread: some two thousand workgroups, which fill any GPU.
const GPU_OVER_THREAD: usize = 8;

fn gpu_rates(executor: ExecutorKind, extent: &Extent) -> Result<DeviceRates, RenderError> {
    let measured = RatesExtent {
        stream_bytes: extent.stream_bytes,
        multiply_adds: GPU_OVER_THREAD * extent.multiply_adds,
    };
    device_rates(executor, measured, &|work| best_time_s(extent.time_for_tries, work))
}

/// A sky of the setting.
pub(crate) fn request(
    setting: &Setting,
    polar: &Arc<PolarGrid>,
    observer_altitude_m: f64,
    turbidity: Turbidity,
    basis_count: usize,
) -> RenderRequest {
    RenderRequest {
        polar: Arc::clone(polar),
        observer_altitude_m,
        turbidity,
        scattering: setting.kind.scattering,
        cloud_base_m: setting.kind.cloud_base_m,
        emission: setting.emission,
        flux_per_dnb_flux: setting.flux_per_dnb_flux,
        basis: Some(basis_count),
    }
}

/// How long a request took.
#[derive(Clone, Debug)]
pub(crate) struct Timed {
    /// Median over the rounds, milliseconds.
    pub(crate) median_ms: f64,
    /// Fastest round, milliseconds.
    pub(crate) fastest_ms: f64,
    /// Passes of the median's round.
    pub(crate) passes: Vec<PassRow>,
    /// What was worked on.
    pub(crate) work: WorkCount,
    /// The sky of the last round.
    pub(crate) rendered: Rendered,
}

/// Times requests, each `rounds` times. All requests take their turns in every round, so that other work on the machine
/// slows all of them alike.
///
/// # Errors
/// A request that the engine refuses.
pub(crate) fn time(
    engine: &Engine,
    requests: &[RenderRequest],
    rounds: usize,
) -> Result<Vec<Timed>, BenchError> {
    let mut times: Vec<Vec<(f64, Vec<PassTime>)>> = vec![Vec::new(); requests.len()];
    let mut skies: Vec<Rendered> = Vec::with_capacity(requests.len());
    for request in requests {
        // The first of its size may have to make room.
        skies.push(engine.render_blocking(request.clone())?);
    }
    for _ in 0..rounds.max(1) {
        for ((request, times), sky) in requests.iter().zip(&mut times).zip(&mut skies) {
            let request = request.clone();
            let start = Instant::now();
            let rendered = engine.render_blocking(request)?;
            times.push((1e3 * start.elapsed().as_secs_f64(), rendered.passes.clone()));
            *sky = rendered;
        }
    }
    let timed = |(mut times, rendered): (Vec<(f64, Vec<PassTime>)>, Rendered)| {
        times.sort_by(|a, b| a.0.total_cmp(&b.0));
        let (median_ms, passes) = times.swap_remove(times.len() / 2);
        let fastest_ms = times.first().map_or(median_ms, |fastest| fastest.0.min(median_ms));
        let passes = passes
            .into_iter()
            .map(|pass| PassRow { pass: pass.name.to_owned(), ms: pass.microseconds / 1e3 })
            .collect();
        Timed { median_ms, fastest_ms, passes, work: rendered.work, rendered }
    };
    Ok(times.into_iter().zip(skies).map(timed).collect())
}
