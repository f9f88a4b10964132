//! Rows of the report from what was timed.

use crate::{
    executors::Timed,
    floor::{self, PassFloor},
    options::Setting,
    report::{ExecutorRecord, FloorRow, RivalTime, RunTimeRow, SceneRow},
};
use skyglow_physics::Turbidity;
use skyglow_render::{RenderRequest, prepare::Prepared};

/// Name of all passes together, with what is listed, queued and handed over between them.
const WHOLE: &str = "whole panorama";

/// A request of a run, and what its row says of it.
pub(crate) struct Subject<'a> {
    /// Its scene, with the rivals' times.
    pub(crate) scene: &'a SceneRow,
    /// Whether what is dark is left out.
    pub(crate) skipping: bool,
    /// Its turbidity.
    pub(crate) turbidity: Turbidity,
    /// What the engine is asked.
    pub(crate) request: RenderRequest,
}

/// The row of a run time.
pub(crate) fn run_time(executor: &str, subject: &Subject<'_>, timed: Timed, rounds: usize) -> RunTimeRow {
    let times =
        |rivals: &[RivalTime]| 1e3 * rivals.iter().map(|rival| rival.seconds).sum::<f64>() / timed.fastest_ms;
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

/// The rows of the floor under it, pass by pass and all together.
pub(crate) fn floors(
    executor: &ExecutorRecord,
    subject: &Subject<'_>,
    prepared: &Prepared,
    timed: &Timed,
    setting: &Setting,
) -> Vec<FloorRow> {
    let measured = |name: &str| timed.passes.iter().find(|pass| pass.pass == name).map(|pass| pass.ms);
    let row = |floor: PassFloor, pass: &str, measured_ms: f64| FloorRow {
        executor: executor.executor.clone(),
        scene: subject.scene.scene.clone(),
        lit_sources: subject.scene.lit_sources,
        basis_count: prepared.basis_count,
        pass: pass.to_owned(),
        bytes: floor.bytes,
        operations: floor.operations,
        bytes_ms: floor.bytes_ms(executor),
        operations_ms: floor.operations_ms(executor),
        measured_ms,
    };
    let floors = floor::floors(prepared, &setting.set);
    let whole = floor::whole(&floors);
    let passes = floors.iter().filter_map(|floor| {
        let name = floor.pass.name();
        Some(row(*floor, name, measured(name)?))
    });
    passes.chain(whole.map(|whole| row(whole, WHOLE, timed.median_ms))).collect()
}
