//! The report as tables of text.

use crate::report::{BaselineTime, BatchRow, ErrorRow, Report, RooflineRow, RunTimeRow, SceneRow};

/// A titled table; the first row is its head.
#[derive(Clone, Debug, PartialEq)]
pub struct Section {
    /// What it shows.
    pub title: String,
    /// Its rows, all of the same length.
    pub rows: Vec<Vec<String>>,
}

/// The tables of a report; those without rows are left out.
pub fn sections(report: &Report) -> Vec<Section> {
    let machine = &report.machine;
    let title = format!(
        "skyglow {}, {}, {} cores, {} threads: {:.1} GB/s, {:.1} · 10⁹ multiply-adds a second{}",
        report.program_version,
        machine.processor,
        machine.logical_cores,
        machine.threads,
        machine.bandwidth_gb_s,
        machine.multiply_adds_g_s,
        machine.load_average.map_or_else(String::new, |load| format!("; load average at the start {load}"))
    );
    let executors = report.executors.iter().map(|executor| {
        let megabytes = format!("{:.0}", executor.resident_bytes as f64 / 1e6);
        vec![
            executor.executor.clone(),
            executor.adapter.clone(),
            executor.driver.clone(),
            megabytes,
            figures(executor.bandwidth_gb_s),
            figures(executor.multiply_adds_g_s),
            executor.read_back_ms.map_or_else(|| "-".to_owned(), figures),
        ]
    });
    let run_times = "run times, milliseconds (the factors are those over the baselines of the scene)";
    let targets = report.targets.iter().map(|target| {
        let met = if target.is_met { "met" } else { "missed" };
        vec![
            target.executor.clone(),
            target.target.clone(),
            figures(target.wanted),
            figures(target.measured),
            met.to_owned(),
        ]
    });
    let all = [
        table(&title, &EXECUTORS, executors),
        table("baselines", &BASELINES, report.scenes.iter().map(baseline)),
        table(run_times, &RUN_TIMES, report.run_times.iter().map(run_time)),
        table("callers at once, panoramas a second", &BATCHES, report.batches.iter().map(batch)),
        table("roofline: milliseconds that bytes and operations need at least", &ROOFLINE, {
            let shown = report.roofline.iter().filter(|row| is_shown(report, row));
            shown.map(roofline)
        }),
        table("errors against the reference", &ERRORS, report.errors.iter().map(error)),
        table("targets", &["executor", "target", "wanted", "measured", ""], targets),
        table("notes", &[""], report.notes.iter().map(|note| vec![note.clone()])),
    ];
    all.into_iter().filter(|section| section.rows.len() > 1).collect()
}

const EXECUTORS: [&str; 7] =
    ["executor", "adapter", "driver", "MB resident", "GB/s", "10⁹ multiply-adds/s", "read-back ms"];
const BATCHES: [&str; 9] = [
    "executor",
    "scene",
    "lit",
    "basis",
    "callers",
    "together",
    "fastest /s",
    "median /s",
    "passes' least ms",
];
const BASELINES: [&str; 10] = [
    "scene",
    "lit",
    "polar cells",
    "binning ms",
    "direct sum s",
    "(share timed)",
    "mixing images s",
    "(share timed)",
    "accumulation s",
    "(share timed, MB of images)",
];
const RUN_TIMES: [&str; 12] = [
    "executor", "scene", "lit", "basis", "T", "packs", "skipping", "median", "fastest", "x direct",
    "x accum.", "x ready",
];
const ROOFLINE: [&str; 8] =
    ["executor", "scene", "lit", "pass", "kB", "bytes ms", "operations ms", "measured ms"];
const ERRORS: [&str; 12] = [
    "executor",
    "sky",
    "T",
    "basis",
    "flux W",
    "zenith/natural",
    "mean %",
    "99 % %",
    "largest %",
    "zenith %",
    "horizontal %",
    "median ms",
];

fn table(title: &str, head: &[&str], rows: impl Iterator<Item = Vec<String>>) -> Section {
    let head = head.iter().map(|word| (*word).to_owned()).collect();
    Section { title: title.to_owned(), rows: std::iter::once(head).chain(rows).collect() }
}

/// Three figures, or all before the point.
fn figures(value: f64) -> String {
    if value == 0.0 {
        return "0".to_owned();
    }
    let digits = (2.0 - value.abs().log10().floor()).clamp(0.0, 9.0) as usize;
    format!("{value:.digits$}")
}

fn percent(share: f64) -> String {
    figures(100.0 * share)
}

fn share(baseline: BaselineTime) -> String {
    format!("{:.1e}", baseline.share_timed)
}

fn baseline(scene: &SceneRow) -> Vec<String> {
    let megabytes = scene.image_bytes as f64 / 1e6;
    vec![
        scene.scene.clone(),
        scene.lit_sources.to_string(),
        scene.polar_cells.to_string(),
        scene.binning_ms.map_or_else(|| "-".to_owned(), figures),
        figures(scene.direct_sum.seconds),
        share(scene.direct_sum),
        figures(scene.image_mixing.seconds),
        share(scene.image_mixing),
        figures(scene.accumulation.seconds),
        format!("{}, {megabytes:.0}", figures(scene.accumulation.share_timed)),
    ]
}

fn run_time(row: &RunTimeRow) -> Vec<String> {
    vec![
        row.executor.clone(),
        row.scene.clone(),
        row.lit_sources.to_string(),
        row.basis_count.to_string(),
        row.turbidity.to_string(),
        row.packs.to_string(),
        if row.skipping { "on" } else { "off" }.to_owned(),
        figures(row.median_ms),
        figures(row.fastest_ms),
        figures(row.times_direct_sum),
        figures(row.times_accumulation),
        figures(row.times_ready_accumulation),
    ]
}

fn batch(row: &BatchRow) -> Vec<String> {
    vec![
        row.executor.clone(),
        row.scene.clone(),
        row.lit_sources.to_string(),
        row.basis_count.to_string(),
        row.callers.to_string(),
        figures(row.batch_size),
        figures(row.panoramas_per_s),
        figures(row.median_panoramas_per_s),
        figures(row.passes_roofline_ms),
    ]
}

/// Rooflines of the largest scene of each name: the others are in the file.
fn is_shown(report: &Report, row: &RooflineRow) -> bool {
    let largest =
        report.scenes.iter().filter(|scene| scene.scene == row.scene).map(|scene| scene.lit_sources);
    largest.max() == Some(row.lit_sources)
}

fn roofline(row: &RooflineRow) -> Vec<String> {
    vec![
        row.executor.clone(),
        row.scene.clone(),
        row.lit_sources.to_string(),
        row.pass.clone(),
        figures(row.bytes / 1e3),
        figures(row.bytes_ms),
        figures(row.operations_ms),
        figures(row.measured_ms),
    ]
}

fn error(row: &ErrorRow) -> Vec<String> {
    vec![
        row.executor.clone(),
        row.scene.clone(),
        row.turbidity.to_string(),
        row.basis_count.to_string(),
        format!("{:.2e}", row.flux_dnb_w),
        figures(row.zenith_over_natural),
        percent(row.mean),
        percent(row.p99),
        percent(row.maximum),
        percent(row.zenith_error),
        percent(row.horizontal_error),
        row.median_ms.map_or_else(|| "-".to_owned(), figures),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_have_three_figures() {
        let shown = [0.0, 0.012_345, 1.234_56, -12.345, 1234.5, 2_500_000.4].map(figures);
        assert_eq!(shown, ["0", "0.0123", "1.23", "-12.3", "1234", "2500000"]);
    }
}
