//! Rows of the report from what was timed.

use crate::{
    executors::Timed,
    options::Setting,
    report::{BaselineTime, ExecutorRecord, RooflineRow, RunTimeRow, SceneRow},
    roofline::{self, PassRoofline},
};
use skyglow_physics::Turbidity;
use skyglow_render::{RenderRequest, prepare::Prepared};

/// Name of all passes together, with what is listed, queued and handed over between them.
const WHOLE: &str = "whole panorama";

/// A request of a run, and what its row says of it.
pub(crate) struct Subject<'a> {
    /// Its scene, with the times of the baselines.
    pub(crate) scene: &'a SceneRow,
    /// Whether what is dark is left out.
    pub(crate) skipping: bool,
    /// Its turbidity.
    pub(crate) turbidity: Turbidity,
    /// What the engine renders.
    pub(crate) request: RenderRequest,
}

/// The row of a run time.
pub(crate) fn run_time(executor: &str, subject: &Subject<'_>, timed: Timed, rounds: usize) -> RunTimeRow {
    let times = |baselines: &[BaselineTime]| {
        1e3 * baselines.iter().map(|baseline| baseline.seconds).sum::<f64>() / timed.fastest_ms
    };
    let scene = subject.scene;
    RunTimeRow {
        executor: executor.to_owned(),
        scene: subject.scene.scene.clone(),
        lit_sources: subject.scene.lit_sources,
        skipping: subject.skipping,
        turbidity: subject.turbidity.value(),
        packs: timed.work.packs,
        basis_count: timed.rendered.basis_count,
        cells: timed.work.lit_cells,
        nodes: timed.work.mixed_nodes,
        columns: timed.work.lit_columns,
        rounds,
        median_ms: timed.median_ms,
        fastest_ms: timed.fastest_ms,
        times_direct_sum: times(&[scene.direct_sum]),
        times_accumulation: times(&[scene.image_mixing, scene.accumulation]),
        times_ready_accumulation: times(&[scene.accumulation]),
        passes: timed.passes,
    }
}

/// The rows of its roofline, pass by pass and all together.
pub(crate) fn roofline(
    executor: &ExecutorRecord,
    subject: &Subject<'_>,
    prepared: &Prepared,
    timed: &Timed,
    setting: &Setting,
) -> Vec<RooflineRow> {
    let measured = |name: &str| timed.passes.iter().find(|pass| pass.pass == name).map(|pass| pass.ms);
    let row = |pass_roofline: PassRoofline, pass: &str, measured_ms: f64| RooflineRow {
        executor: executor.executor.clone(),
        scene: subject.scene.scene.clone(),
        lit_sources: subject.scene.lit_sources,
        basis_count: prepared.basis_count,
        pass: pass.to_owned(),
        bytes: pass_roofline.bytes,
        operations: pass_roofline.operations,
        bytes_ms: pass_roofline.bytes_ms(executor),
        operations_ms: pass_roofline.operations_ms(executor),
        measured_ms,
    };
    let passes = roofline::of_request(prepared, &setting.set);
    let whole = roofline::whole(&passes);
    let passes = passes.iter().filter_map(|pass_roofline| {
        let name = pass_roofline.pass.name();
        Some(row(*pass_roofline, name, measured(name)?))
    });
    passes.chain(whole.map(|whole| row(whole, WHOLE, timed.median_ms))).collect()
}
