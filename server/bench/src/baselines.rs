//! The two baselines of a scene, timed on as much of it as a run can wait for.

use crate::{
    accumulation::SourceImages,
    error::BenchError,
    executors,
    image_mixing::StoredImages,
    machine,
    options::{Extent, Setting},
    report::{BaselineTime, SceneRow},
    sampled_sum,
    scenes::LitScene,
};
use skyglow_render::prepare::Prepared;
use std::hint::black_box;

/// The times of the baselines on a scene.
///
/// # Errors
/// A scene that the packs refuse.
pub(crate) fn of_scene(setting: &Setting, scene: &LitScene, extent: &Extent) -> Result<SceneRow, BenchError> {
    let request = executors::request(
        setting,
        &scene.polar,
        scene.observer_altitude_m,
        setting.turbidity,
        setting.basis_count(),
    );
    let prepared = Prepared::new(&request, &setting.set)?;
    let tables = &setting.set.tables()[prepared.turbidity_stencil.nodes().start];
    let images = SourceImages::of(&prepared, tables, extent.accumulated_cells);
    let accumulated_s = machine::best_time_s(extent.time_for_tries, || {
        black_box(images.accumulate());
    });
    let (cells_timed, image_bytes) = (images.cell_count(), images.bytes());
    drop(images);
    let stored = StoredImages::of(&prepared, tables, extent.mixed_nodes);
    let mut buffer = stored.buffer();
    let mixed_s = machine::best_time_s(extent.time_for_tries, || stored.mix(black_box(&mut buffer)));
    Ok(SceneRow {
        scene: scene.name.to_owned(),
        lit_sources: scene.lit_sources,
        polar_cells: scene.polar.cells.len(),
        point_sources: scene.sources.len(),
        binning_ms: scene.binning_ms,
        direct_sum: sampled_sum::time(scene, setting, extent),
        accumulation: scaled(accumulated_s, cells_timed, prepared.cells.len()),
        image_bytes,
        image_mixing: scaled(mixed_s, stored.node_count(), prepared.nodes.len()),
    })
}

/// The time of all cells or nodes, in all directions, from that of some.
fn scaled(timed_s: f64, timed: usize, all: usize) -> BaselineTime {
    let share_timed = timed as f64 / all.max(1) as f64;
    BaselineTime {
        seconds: timed_s / share_timed,
        share_timed,
        sources_timed: timed,
        directions_timed: sampled_sum::DIRECTION_COUNT,
    }
}
