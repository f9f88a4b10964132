//! The engine as a whole: queue, batches, losses, shutdown.
#![allow(clippy::unwrap_used, reason = "a test that cannot be set up fails")]

mod common;

use common::{engine, largest_error, request, vulkan};
use skyglow_physics::{BAND_COUNT, Turbidity};
use skyglow_render::{
    DeviceChoice, Engine, EngineConfig, ExecutorKind, RenderError, RenderRequest, TableSet, WorkCount,
    prepare::Prepared, reference::render_f64, synthetic,
};
use std::{
    array::from_fn,
    sync::Arc,
    time::{Duration, Instant},
};

fn wait_until_ready(engine: &Engine) {
    let start = Instant::now();
    while !engine.is_ready() {
        assert!(start.elapsed() < Duration::from_secs(60), "it never became ready");
        std::thread::sleep(Duration::from_millis(1));
    }
}

/// Sends all requests at once and waits for all answers.
fn render_all(
    engine: &Arc<Engine>,
    requests: Vec<RenderRequest>,
) -> Vec<Result<skyglow_render::Rendered, RenderError>> {
    let runtime = tokio::runtime::Builder::new_current_thread().build().unwrap();
    runtime.block_on(async {
        let mut answers = Vec::new();
        let tasks: Vec<_> = requests
            .into_iter()
            .map(|request| {
                let engine = Arc::clone(engine);
                tokio::spawn(async move { engine.render(request).await })
            })
            .collect();
        for task in tasks {
            answers.push(task.await.unwrap());
        }
        answers
    })
}

/// Vulkan and CPU agree with f64 at and between turbidities.
#[test]
fn vulkan_and_cpu_agree_with_f64() {
    let engines = [
        (engine(vulkan(), &[1.5, 2.0, 3.0, 4.0], 16), synthetic::tested_device()),
        (engine(DeviceChoice::Cpu, &[1.5, 2.0, 3.0, 4.0], 16), ExecutorKind::Cpu),
    ];
    let set = TableSet::new(engines[0].0.tables().to_vec()).unwrap();
    for turbidity in [2.0, 2.3] {
        for basis in [None, Some(5)] {
            let mut request = request(synthetic::polar_grid(7, 3000), turbidity);
            request.basis = basis;
            let exact = render_f64(&Prepared::new(&request, &set).unwrap(), &set);
            for (engine, kind) in &engines {
                let rendered = engine.render_blocking(request.clone()).unwrap();
                assert_eq!(rendered.executor, *kind);
                let error = largest_error(rendered.panorama.samples(), &exact);
                println!("{kind:?}, T = {turbidity}, basis {basis:?}: largest relative error {error:.1e}");
                assert!(error < 1e-5, "{error}");
            }
        }
    }
}

/// A changed input exceeds the tolerance of that comparison.
#[test]
fn a_changed_input_exceeds_the_tolerance() {
    let engine = engine(DeviceChoice::Cpu, &[2.0], 16);
    let set = TableSet::new(engine.tables().to_vec()).unwrap();
    let unchanged = request(synthetic::polar_grid(7, 300), 2.0);
    let exact = render_f64(&Prepared::new(&unchanged, &set).unwrap(), &set);
    let changes: [fn(&mut RenderRequest); 4] = [
        |request| request.observer_altitude_m += 1.0,
        |request| request.basis = Some(15),
        |request| request.flux_per_dnb_flux[2] *= 1.0001,
        |request| Arc::make_mut(&mut request.polar).cells.iter_mut().for_each(|cell| cell.altitude_m += 1.0),
    ];
    for (position, change) in changes.into_iter().enumerate() {
        let mut changed = unchanged.clone();
        change(&mut changed);
        let rendered = engine.render_blocking(changed).unwrap();
        let error = largest_error(rendered.panorama.samples(), &exact);
        assert!(error > 1e-5, "change {position} makes {error:.1e}");
    }
}

/// Requests that wait together are rendered together and come out as alone.
#[test]
fn waiting_requests_are_rendered_together() {
    for device in [vulkan(), DeviceChoice::Cpu] {
        let engine = Arc::new(engine(device, &[2.0, 3.0], 8));
        wait_until_ready(&engine);
        let requests: Vec<_> =
            (0..12).map(|seed| request(synthetic::polar_grid(seed, 400 + 50 * seed as usize), 2.0)).collect();
        let alone: Vec<_> = requests
            .iter()
            .map(|request| engine.render_blocking(request.clone()).unwrap().panorama)
            .collect();
        assert_eq!(engine.stats().largest_batch, 1);
        let together = render_all(&engine, requests);
        for (alone, together) in alone.iter().zip(together) {
            assert_eq!(*alone, together.unwrap().panorama);
        }
        let stats = engine.stats();
        assert!((2..=8).contains(&stats.largest_batch), "{}", stats.largest_batch);
        assert!(stats.batches < 24);
        assert_eq!(stats.queue_length, 0);
    }
}

/// Requests of different turbidity are not mixed up.
#[test]
fn requests_of_two_turbidities_stay_apart() {
    let engine = Arc::new(engine(vulkan(), &[2.0, 3.0], 8));
    let grid = synthetic::polar_grid(3, 500);
    let requests: Vec<_> = (0..10).map(|i| request(grid.clone(), [2.0, 2.5, 3.0][i % 3])).collect();
    let answers: Vec<_> = render_all(&engine, requests).into_iter().map(Result::unwrap).collect();
    for (i, answer) in answers.iter().enumerate() {
        assert_eq!(answer.panorama, answers[i % 3].panorama, "{i}");
    }
    assert_ne!(answers[0].panorama, answers[1].panorama);
    assert_ne!(answers[0].panorama, answers[2].panorama);
    assert_eq!(answers[1].work.packs, 2);
}

#[test]
fn a_lost_device_comes_back_by_itself() {
    let engine = Arc::new(engine(vulkan(), &[2.0, 3.0], 8));
    wait_until_ready(&engine);
    let request = request(synthetic::polar_grid(5, 500), 2.5);
    let before = engine.render_blocking(request.clone()).unwrap();
    engine.lose_device().unwrap();
    let after = engine.render_blocking(request.clone()).unwrap();
    assert_eq!(before.panorama, after.panorama);
    assert_eq!(engine.stats().device_losses, 1);
    // Requests behind the loss in the queue are answered too.
    engine.lose_device().unwrap();
    for answer in render_all(&engine, vec![request; 5]) {
        assert_eq!(answer.unwrap().panorama, before.panorama);
    }
    assert_eq!(engine.stats().device_losses, 2);
    assert_eq!(engine.stats().failed, 0);
}

/// A device that is lost again and again under load loses no answer.
#[test]
fn a_lost_device_loses_no_answer() {
    let engine = engine(vulkan(), &[2.0, 3.0], 8);
    wait_until_ready(&engine);
    let request = request(synthetic::polar_grid(5, 500), 2.5);
    let wanted = engine.render_blocking(request.clone()).unwrap().panorama;
    std::thread::scope(|scope| {
        for _ in 0..4 {
            scope.spawn(|| {
                // Until the last loss is behind, and then some.
                let mut after = 0;
                let deadline = std::time::Instant::now() + std::time::Duration::from_secs(300);
                while after < 10 && std::time::Instant::now() < deadline {
                    after += usize::from(engine.stats().device_losses == 3);
                    assert_eq!(engine.render_blocking(request.clone()).unwrap().panorama, wanted);
                }
            });
        }
        for lost in 1..=3 {
            let rendered = engine.stats().rendered;
            engine.lose_device().unwrap();
            let is_back = || engine.stats().device_losses == lost && engine.stats().rendered > rendered + 20;
            let deadline = std::time::Instant::now() + std::time::Duration::from_secs(120);
            while !is_back() {
                assert!(std::time::Instant::now() < deadline, "loss {lost} is not made good");
                std::thread::sleep(std::time::Duration::from_millis(2));
            }
        }
    });
    assert_eq!((engine.stats().device_losses, engine.stats().failed), (3, 0));
}

#[test]
fn a_full_queue_is_said_to_be_busy() {
    let tables = synthetic::table_set(&[2.0, 3.0], 64);
    let config = EngineConfig { device: vulkan(), tables, queue_capacity: 2, ..Default::default() };
    let engine = Arc::new(Engine::start(config).unwrap());
    let answers = render_all(&engine, vec![request(synthetic::polar_grid(5, 20_000), 2.5); 60]);
    let busy =
        answers.iter().filter(|answer| matches!(answer, Err(RenderError::Busy { capacity: 2 }))).count();
    let rendered = answers.iter().filter(|answer| answer.is_ok()).count();
    assert_eq!(busy + rendered, 60);
    assert!(busy > 0 && rendered > 0, "{busy} busy, {rendered} rendered");
    assert_eq!(engine.stats().refused, busy as u64);
}

#[test]
fn dark_parts_cost_nothing() {
    let engine = engine(vulkan(), &[2.0], 8);
    wait_until_ready(&engine);
    let before = engine.stats();
    let dark = engine.render_blocking(request(synthetic::dark_grid(), 2.0)).unwrap();
    assert!(dark.panorama.samples().iter().all(|value| *value == 0.0));
    assert_eq!((dark.batch_size, dark.work), (0, WorkCount::default()));
    assert_eq!((engine.stats().batches, engine.stats().dark_requests), (before.batches, 1));
    let few = synthetic::polar_grid_of(&[(10, 3, 5e5, 100.0), (10, 80, 0.0, 100.0), (200, 80, 3e3, 900.0)]);
    let rendered = engine.render_blocking(request(few, 2.0)).unwrap();
    assert_eq!((rendered.work.lit_cells, rendered.work.lit_columns), (2, 2));
    assert!((2..=4).contains(&rendered.work.mixed_nodes));
    let after = engine.stats();
    assert_eq!(after.lit_cells - before.lit_cells, 2);
    assert_eq!(after.lit_columns - before.lit_columns, 2);
    assert!(rendered.panorama.samples().iter().any(|value| *value > 0.0));
}

/// Bands without light are left out and the others stay as they are bit for bit.
#[test]
fn dark_bands_are_left_out() {
    for device in [vulkan(), DeviceChoice::Cpu] {
        let engine = engine(device, &[2.0], 40);
        let all = request(synthetic::polar_grid(5, 2000), 2.0);
        let lit = |is_lit: &dyn Fn(usize) -> bool| {
            let flux = synthetic::flux_per_dnb_flux();
            let flux_per_dnb_flux = from_fn(|band| if is_lit(band) { flux[band] } else { 0.0 });
            engine.render_blocking(RenderRequest { flux_per_dnb_flux, ..all.clone() }).unwrap()
        };
        let (first_dark, second_alone, all) =
            (lit(&|band| band != 0), lit(&|band| band == 1), lit(&|_| true));
        let counts = [&all, &first_dark, &second_alone].map(|sky| sky.work.lit_bands);
        assert_eq!(counts, [BAND_COUNT, BAND_COUNT - 1, 1]);
        let per_band = all.panorama.samples().len() / BAND_COUNT;
        let band = |sky: &skyglow_render::Rendered, band: usize| {
            sky.panorama.samples()[band * per_band..][..per_band].to_vec()
        };
        let black = vec![0.0; per_band];
        for b in 0..BAND_COUNT {
            assert!(band(&all, b) != black);
            assert!(band(&first_dark, b) == if b == 0 { black.clone() } else { band(&all, b) });
            assert!(band(&second_alone, b) == if b == 1 { band(&all, b) } else { black.clone() });
        }
    }
}

/// Parts of the sky that need no work are not in its count.
#[test]
fn dark_parts_are_not_in_the_work_count() {
    let engine = engine(DeviceChoice::Cpu, &[2.0, 3.0, 4.0], 8);
    let work = |request: &RenderRequest| engine.render_blocking(request.clone()).unwrap().work;
    let grid = synthetic::polar_grid(5, 4000);
    let all = request(grid.clone(), 2.3);
    let full = work(&all);
    assert_eq!((full.lit_columns, full.lit_bands, full.packs), (256, BAND_COUNT, 3));
    let darkened = |keep: &dyn Fn(usize, u32) -> bool| {
        let mut dark = grid.clone();
        for azimuth in 0..256 {
            let column = grid.azimuth_start[azimuth] as usize..grid.azimuth_start[azimuth + 1] as usize;
            for cell in dark.cells[column].iter_mut().filter(|cell| !keep(azimuth, cell.ring)) {
                cell.flux_dnb_w = 0.0;
            }
        }
        RenderRequest { polar: Arc::new(dark), ..all.clone() }
    };
    let half_dark = work(&darkened(&|azimuth, _| azimuth < 128));
    assert_eq!(half_dark.lit_columns, 128);
    assert!(half_dark.lit_cells < full.lit_cells * 6 / 10, "{half_dark:?}");
    let near = work(&darkened(&|_, ring| ring < 96));
    assert!(
        near.mixed_nodes < full.mixed_nodes * 7 / 10 && near.lit_cells < full.lit_cells * 6 / 10,
        "{near:?}"
    );
    let resident = RenderRequest { turbidity: Turbidity::new(3.0).unwrap(), ..all.clone() };
    assert_eq!(work(&resident).packs, 1);
}

/// Passes are timed and the times add up to less than the whole.
#[test]
fn pass_times_add_up_to_less_than_the_whole() {
    for device in [vulkan(), DeviceChoice::Cpu] {
        let engine = engine(device, &[2.0, 3.0], 16);
        wait_until_ready(&engine);
        let request = request(synthetic::polar_grid(5, 20_000), 2.5);
        let start = Instant::now();
        let rendered = engine.render_blocking(request).unwrap();
        let whole = start.elapsed().as_secs_f64() * 1e6;
        let names: Vec<_> = rendered.passes.iter().map(|time| time.name).collect();
        assert_eq!(names, skyglow_render::plan::Pass::ALL.map(skyglow_render::plan::Pass::name));
        let sum: f64 = rendered.passes.iter().map(|time| time.microseconds).sum();
        assert!(sum > 0.0 && sum < whole, "{sum} of {whole} µs");
    }
}

/// A dropped engine ends its thread and answers what it took.
#[test]
fn a_dropped_engine_answers_what_it_took() {
    let engine = Arc::new(engine(vulkan(), &[2.0], 8));
    let runtime = tokio::runtime::Builder::new_multi_thread().worker_threads(1).build().unwrap();
    let tasks: Vec<_> = (0..6)
        .map(|seed| {
            let (engine, request) = (Arc::clone(&engine), request(synthetic::polar_grid(seed, 500), 2.0));
            runtime.spawn(async move { engine.render(request).await.is_ok() })
        })
        .collect();
    drop(engine);
    for task in tasks {
        assert!(runtime.block_on(task).unwrap());
    }
}

/// Without a GPU it is asked for in vain and plain Rust goes before lavapipe.
#[test]
fn without_a_gpu_rust_goes_before_lavapipe() {
    let tables = synthetic::table_set(&[2.0], 8);
    let best = match Engine::start(EngineConfig {
        device: DeviceChoice::Gpu,
        tables: tables.clone(),
        ..Default::default()
    }) {
        Err(RenderError::NoAdapter { wanted: "gpu", found }) => {
            assert!(found.contains("llvmpipe"), "{found}");
            ExecutorKind::Cpu
        }
        Err(error) => panic!("{error}"),
        Ok(engine) => {
            assert_eq!(engine.info().executor, ExecutorKind::Gpu);
            ExecutorKind::Gpu
        }
    };
    let auto = Engine::start(EngineConfig { tables, ..Default::default() }).unwrap();
    assert_eq!(auto.info().executor, best);
}
