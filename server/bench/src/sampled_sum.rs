//! The first baseline: the direct sum over every source, first order alone, timed on a share of it.

use crate::{
    machine::best_time_s,
    options::{Extent, Setting},
    report::BaselineTime,
    scenes::LitScene,
};
use skyglow_physics::{
    AZIMUTH_COUNT, Atmosphere, BAND_COUNT, ELEVATION_COUNT, PointSource,
    direct_sum::{direct_sum, grid_direction, stratified_samples},
};
use std::hint::black_box;

/// Directions of a panorama.
pub(crate) const DIRECTION_COUNT: usize = AZIMUTH_COUNT * ELEVATION_COUNT;
/// Directions timed for each thread, so that none waits long for the last.
const DIRECTIONS_PER_THREAD: usize = 8;

/// Times at most about as many integrals (a source in a direction) as the extent allows, and scales to all sources and
/// 16 384 directions.
///
/// Later orders are left out also where the packs have them: the sum over those would take longer still.
pub(crate) fn time(scene: &LitScene, setting: &Setting, extent: &Extent) -> BaselineTime {
    let integrals = extent.direct_sum_integrals;
    let wanted = DIRECTIONS_PER_THREAD * rayon::current_num_threads();
    let samples = stratified_samples(wanted.min(integrals).max(1));
    let directions: Vec<_> = samples.into_iter().map(grid_direction).collect();
    let most = (integrals / directions.len()).max(1);
    // Every n-th source, so that near and far ones are there as in the whole.
    let stride = scene.sources.len().div_ceil(most).max(1);
    let sources: Vec<PointSource> = scene.sources.iter().step_by(stride).copied().collect();
    let timed_s = best_time_s(extent.time_for_tries, || {
        black_box(direct_sum::<BAND_COUNT>(
            &[Atmosphere::new(setting.turbidity)],
            &sources,
            scene.observer_altitude_m,
            setting.emission,
            setting.flux_per_dnb_flux,
            &directions,
            &|| (),
        ));
    });
    let of_sources = sources.len() as f64 / scene.sources.len().max(1) as f64;
    let share_timed = of_sources * directions.len() as f64 / DIRECTION_COUNT as f64;
    BaselineTime {
        seconds: timed_s / share_timed,
        share_timed,
        sources_timed: sources.len(),
        directions_timed: directions.len(),
    }
}
