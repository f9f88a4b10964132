//! Panoramas a second where several callers ask at once: the engine renders what waits together.

use crate::{
    error::BenchError,
    options::Setting,
    report::{BatchRow, ExecutorRecord},
    roofline,
    rows::Subject,
};
use skyglow_render::{Engine, MAX_BATCH, RenderError, RenderRequest, prepare::Prepared};
use std::time::Instant;

/// Callers: one, a batch of them, and twice as many, so that the next batch waits when one is done.
const CALLERS: [usize; 3] = [1, MAX_BATCH, 2 * MAX_BATCH];
/// Panoramas that each caller asks for in a round.
const PANORAMAS_EACH: usize = 8;
/// Rounds at most.
const MAX_ROUNDS: usize = 5;

/// A row for each number of callers and each of these.
///
/// # Errors
/// A request that the engine refuses.
pub(crate) fn of_engine(
    engine: &Engine,
    executor: &ExecutorRecord,
    setting: &Setting,
    subjects: &[&Subject<'_>],
    rounds: usize,
) -> Result<Vec<BatchRow>, BenchError> {
    let mut rows = Vec::new();
    for subject in subjects {
        let prepared = Prepared::new(&subject.request, &setting.set)?;
        let passes = roofline::of_request(&prepared, &setting.set);
        for callers in CALLERS {
            let mut timed = Vec::new();
            // The first round warms up.
            for round in 0..=rounds.clamp(1, MAX_ROUNDS) {
                let of_round = round_of(engine, &subject.request, callers)?;
                if round > 0 {
                    timed.push(of_round);
                }
            }
            timed.sort_by(|a, b| b.panoramas_per_s.total_cmp(&a.panoramas_per_s));
            rows.push(BatchRow {
                executor: executor.executor.clone(),
                scene: subject.scene.scene.clone(),
                lit_sources: subject.scene.lit_sources,
                basis_count: prepared.basis_count,
                callers,
                batch_size: timed[0].batch_size,
                panoramas_per_s: timed[0].panoramas_per_s,
                median_panoramas_per_s: timed[timed.len() / 2].panoramas_per_s,
                passes_roofline_ms: passes.iter().map(|pass| pass.ms(executor)).sum(),
            });
        }
    }
    Ok(rows)
}

/// What came out of a round.
struct Round {
    batch_size: f64,
    panoramas_per_s: f64,
}

fn round_of(engine: &Engine, request: &RenderRequest, callers: usize) -> Result<Round, RenderError> {
    // Panoramas over batches: each panorama is its part of a batch.
    let call = || -> Result<f64, RenderError> {
        let mut batches = 0.0;
        for _ in 0..PANORAMAS_EACH {
            batches += 1.0 / engine.render_blocking(request.clone())?.batch_size.max(1) as f64;
        }
        Ok(batches)
    };
    let start = Instant::now();
    let shares: Vec<Result<f64, RenderError>> = std::thread::scope(|scope| {
        let threads: Vec<_> = (0..callers).map(|_| scope.spawn(call)).collect();
        threads.into_iter().map(|thread| thread.join().unwrap_or(Err(RenderError::Stopped))).collect()
    });
    let seconds = start.elapsed().as_secs_f64();
    let batches: f64 = shares.into_iter().sum::<Result<f64, RenderError>>()?;
    let panoramas = (callers * PANORAMAS_EACH) as f64;
    Ok(Round { batch_size: panoramas / batches, panoramas_per_s: panoramas / seconds })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{baselines, executors, run, scenes::LitScene};

    /// Callers that ask together are rendered together.
    #[test]
    fn concurrent_callers_are_rendered_in_one_batch() {
        let setting = run::tests::setting(8);
        let lit = LitScene::of_cells(40);
        let scene = baselines::of_scene(&setting, &lit, &run::tests::tiny()).unwrap();
        let turbidity = setting.turbidity;
        let request = executors::request(&setting, &lit.polar, lit.observer_altitude_m, turbidity, 8);
        let subject = Subject { scene: &scene, skipping: true, turbidity, request };
        let engine = executors::start(skyglow_render::DeviceChoice::Cpu, &setting).unwrap().unwrap();
        let machine = crate::machine::measure(&run::tests::tiny());
        let record = executors::record(&engine, &machine, &run::tests::tiny()).unwrap();
        let rows = of_engine(&engine, &record, &setting, &[&subject], 2).unwrap();
        assert_eq!(rows.iter().map(|row| row.callers).collect::<Vec<_>>(), CALLERS);
        assert_eq!(rows[0].batch_size, 1.0);
        assert!(rows[2].batch_size > 1.0 && rows[2].batch_size <= MAX_BATCH as f64, "{rows:?}");
        for row in &rows {
            assert!(row.panoramas_per_s >= row.median_panoramas_per_s && row.median_panoramas_per_s > 1.0);
            assert!(
                row.passes_roofline_ms > 0.0 && row.passes_roofline_ms < 1e3 / row.panoramas_per_s * 100.0,
                "{row:?}"
            );
        }
    }
}
