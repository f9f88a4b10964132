//! Performance targets of the engine, and whether this run meets them.

use crate::report::{RunTimeRow, TargetRow};

/// How many times faster than the direct sum, at least, at 2 048 lit cells.
const TIMES_DIRECT_SUM: f64 = 100_000.0;
/// How many times faster than the accumulation, at least, at 2 048 lit cells.
const TIMES_ACCUMULATION: f64 = 50.0;
/// Slowest over fastest scene with nothing skipped, at most.
const FLATNESS: f64 = 1.1;
/// With skipping over without, at most.
const SKIPPED_OVER_WHOLE: f64 = 1.0;

/// The targets on every executor, with the largest basis at a pack's turbidity, by fastest rounds.
pub(crate) fn of(run_times: &[RunTimeRow]) -> Vec<TargetRow> {
    let mut executors: Vec<&str> = run_times.iter().map(|row| row.executor.as_str()).collect();
    executors.dedup();
    executors.into_iter().flat_map(|executor| of_executor(run_times, executor)).collect()
}

fn of_executor(run_times: &[RunTimeRow], executor: &str) -> Vec<TargetRow> {
    let rows = || run_times.iter().filter(|row| row.executor == executor && row.packs == 1);
    let largest = rows().map(|row| row.basis_count).max().unwrap_or(0);
    let rows = || rows().filter(|row| row.basis_count == largest);
    let target = |target: String, wanted: f64, measured: f64, is_met: bool| TargetRow {
        target,
        executor: executor.to_owned(),
        wanted,
        measured,
        is_met,
    };
    let mut targets = Vec::new();
    let max_cells =
        rows().filter(|row| row.scene == "cells" && row.skipping).max_by_key(|row| row.lit_sources);
    if let Some(row) = max_cells {
        let at = format!("at {} lit cells, {largest} functions", row.lit_sources);
        for (baseline, wanted, measured) in [
            ("direct sum", TIMES_DIRECT_SUM, row.times_direct_sum),
            ("accumulation of images", TIMES_ACCUMULATION, row.times_accumulation),
            ("same with images ready for this observer", TIMES_ACCUMULATION, row.times_ready_accumulation),
        ] {
            targets.push(target(
                format!("times faster than the {baseline} {at}"),
                wanted,
                measured,
                measured >= wanted,
            ));
        }
    }
    let whole = || rows().filter(|row| !row.skipping).map(|row| row.fastest_ms);
    let (slowest, fastest) = (whole().fold(0.0, f64::max), whole().fold(f64::INFINITY, f64::min));
    if slowest > 0.0 {
        let flatness = slowest / fastest;
        let words = "slowest over fastest scene, nothing skipped".to_owned();
        targets.push(target(words, FLATNESS, flatness, flatness <= FLATNESS));
        let of_passes = || rows().filter(|row| !row.skipping).map(without_near_field_ms);
        let flatness = of_passes().fold(0.0, f64::max) / of_passes().fold(f64::INFINITY, f64::min);
        let words = "the same without the near-field correction".to_owned();
        targets.push(target(words, FLATNESS, flatness, flatness <= FLATNESS));
    }
    let of_whole = |skipped: &&RunTimeRow| {
        let same = |row: &&RunTimeRow| {
            !row.skipping && (&row.scene, row.lit_sources) == (&skipped.scene, skipped.lit_sources)
        };
        rows().find(same).map(|whole| skipped.fastest_ms / whole.fastest_ms)
    };
    let worst = rows().filter(|row| row.skipping).filter_map(|row| of_whole(&row)).fold(0.0, f64::max);
    if worst > 0.0 {
        let words = "largest time with skipping over without, any scene".to_owned();
        targets.push(target(words, SKIPPED_OVER_WHOLE, worst, worst <= SKIPPED_OVER_WHOLE));
    }
    targets
}

/// The median without what the near-field correction takes of it, which no grid of cells needs.
fn without_near_field_ms(row: &RunTimeRow) -> f64 {
    let near = row.passes.iter().filter(|pass| pass.pass == "near_lights");
    row.median_ms - near.map(|pass| pass.ms).sum::<f64>()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::PassRow;

    fn row(lit_sources: usize, skipping: bool, median_ms: f64) -> RunTimeRow {
        RunTimeRow {
            executor: "cpu".to_owned(),
            scene: "cells".to_owned(),
            lit_sources,
            skipping,
            turbidity: 2.0,
            packs: 1,
            basis_count: 64,
            cells: lit_sources,
            nodes: lit_sources,
            columns: lit_sources.min(256),
            rounds: 3,
            median_ms,
            fastest_ms: median_ms,
            passes: Vec::new(),
            times_direct_sum: 150_000.0 / median_ms,
            times_accumulation: 80.0 / median_ms,
            times_ready_accumulation: 60.0 / median_ms,
        }
    }

    /// Targets are met or missed as the rows say.
    #[test]
    fn targets_are_met_or_missed_as_the_rows_say() {
        let good = [row(1, true, 0.5), row(2_048, true, 1.0), row(1, false, 2.0), row(2_048, false, 2.1)];
        let met = |rows: &[RunTimeRow]| of(rows).iter().map(|target| target.is_met).collect::<Vec<_>>();
        assert_eq!(met(&good), [true; 6]);
        let slow = [row(1, true, 0.5), row(2_048, true, 2.0), row(1, false, 1.0), row(2_048, false, 1.2)];
        assert_eq!(met(&slow), [false; 6]);
        // The near-field correction is no work of the passes, and reported apart.
        let mut lit = good;
        lit[3].passes = vec![PassRow { pass: "near_lights".to_owned(), ms: 1.0 }];
        (lit[3].median_ms, lit[3].fastest_ms) = (3.1, 3.1);
        assert_eq!(met(&lit), [true, true, true, false, true, true]);
        assert!(of(&[]).is_empty());
    }
}
