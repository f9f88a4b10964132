//! The whole run, step by step.

use crate::{
    accuracy, baselines, batches,
    error::BenchError,
    executors::{self, CHOICES},
    machine,
    options::{BenchOptions, Extent, Setting},
    reference::{self, ReferenceSky},
    report::{ExecutorRecord, PackRecord, Report, SceneRow},
    rows::{self, Subject},
    scenes::LitScene,
    skies, targets,
};
use skyglow_render::{DeviceChoice, Engine, PackKind, RenderRequest, prepare::Prepared};
use skyglow_scene::PolarGrid;
use skyglow_tables::Manifest;
use std::sync::Arc;

/// Basis functions with which a panorama was wanted.
const FEW_FUNCTIONS: usize = 32;

/// Runs everything. What it is about is logged as it goes.
///
/// # Errors
/// Packs that do not fit together or none of a clear sky, a device that fails, reference files that are none.
pub fn run(options: &BenchOptions) -> Result<Report, BenchError> {
    reference::check_files(&options.reference_files)?;
    let setting = Setting::of(options)?;
    let extent = &options.extent;
    tracing::info!("measuring the machine");
    let machine = machine::measure(extent);
    let mut notes = notes(&setting, extent);
    let lit: Vec<LitScene> = lit_scenes(extent);
    let whole: Vec<Arc<PolarGrid>> =
        lit.iter().map(|scene| Arc::new(scene.without_skipping(&setting.set))).collect();
    let mut scenes = Vec::with_capacity(lit.len());
    for scene in &lit {
        tracing::info!("baselines of {} {}", scene.name, scene.lit_sources);
        scenes.push(baselines::of_scene(&setting, scene, extent)?);
    }
    let skies = skies::of_run(options, &setting, &lit, &mut notes)?;
    let subjects = subjects(&setting, &lit, &whole, &scenes);
    let mut report = Report {
        program_version: env!("CARGO_PKG_VERSION").to_owned(),
        quick: extent.quick,
        packs: pack_records(&options.manifests, setting.kind),
        machine,
        executors: Vec::new(),
        scenes: Vec::new(),
        run_times: Vec::new(),
        batches: Vec::new(),
        roofline: Vec::new(),
        errors: Vec::new(),
        targets: Vec::new(),
        notes,
    };
    let mut missing = Vec::new();
    for (choice, name) in CHOICES {
        tracing::info!("panoramas on {name}");
        // One that fails leaves the rows of the others.
        match on_executor(choice, &setting, &subjects, &skies, extent, &mut report) {
            Ok(true) => {}
            Ok(false) => missing.push(format!("{name}: there is no such device here")),
            Err(error) => missing.push(format!("{name}: {error}")),
        }
    }
    if report.executors.is_empty() {
        return Err(BenchError::NothingRenders { reason: missing.join("; ") });
    }
    report.notes.append(&mut missing);
    tracing::info!("sums in f64");
    report.errors.extend(accuracy::of_f64(&setting, &skies)?);
    report.targets = targets::of(&report.run_times);
    drop(subjects);
    report.scenes = scenes;
    Ok(report)
}

fn notes(setting: &Setting, extent: &Extent) -> Vec<String> {
    let mut notes = vec![
        "scene cells: N cells of the polar grid, a source in the middle of each; scene raster: N pixels of 463 m, evenly \
         over the disc of 300 km, which the polar grid's 256 × 192 cells gather. Both over made-up hills"
            .to_owned(),
        "skipping off: every dark cell is given 1e-6 W, and some cells besides at altitudes that touch every node, so \
         that all cells, columns and nodes are worked on whatever the scene"
            .to_owned(),
        "the direct sum is of the first order alone, also beside packs of all orders".to_owned(),
        "baselines whose share is below 1 were timed on that share and scaled; factors are fastest over fastest, for other \
         work on the machine only ever slows"
            .to_owned(),
        format!(
            "the accumulation starts from images at the pack's altitudes and lobes, which at all its nodes would be {:.1} \
             GB in f32, and mixes those of this observer (mixing); ready ones would serve this observer and these lobes \
             alone.",
            setting.stored_image_bytes() / 1e9,
        ),
        "the number of rings and of directions is fixed, and packs hold coefficients in half precision alone: there is no \
         other resolution or precision to compare"
            .to_owned(),
    ];
    if extent.reference_directions == 0 {
        notes.push("errors were left out: they take a reference, which takes minutes".to_owned());
    }
    if setting.between.is_none() {
        notes.push("no turbidity between packs: there is one pack".to_owned());
    }
    notes
}

fn pack_records(manifests: &[Manifest], kind: PackKind) -> Vec<PackRecord> {
    let of_kind = manifests.iter().filter(|manifest| PackKind::of_manifest(manifest) == kind);
    of_kind
        .map(|manifest| PackRecord {
            turbidity: manifest.turbidity,
            scattering: manifest.scattering.name().to_owned(),
            basis_count: manifest.basis_count,
            checksum: manifest.checksum.clone(),
        })
        .collect()
}

fn lit_scenes(extent: &Extent) -> Vec<LitScene> {
    let cells = extent.cell_counts.iter().map(|&count| LitScene::of_cells(count));
    cells.chain(extent.pixel_counts.iter().map(|&count| LitScene::of_pixels(count))).collect()
}

/// Every scene at every basis size; with the largest also unskipped, and between packs.
fn subjects<'a>(
    setting: &Setting,
    lit: &[LitScene],
    whole: &[Arc<PolarGrid>],
    rows: &'a [SceneRow],
) -> Vec<Subject<'a>> {
    let mut subjects = Vec::new();
    for ((lit, whole), scene) in lit.iter().zip(whole).zip(rows) {
        let mut add = |polar: &Arc<PolarGrid>, skipping, turbidity, basis_count| {
            let altitude_m = lit.observer_altitude_m;
            let request = executors::request(setting, polar, altitude_m, turbidity, basis_count);
            subjects.push(Subject { scene, skipping, turbidity, request });
        };
        for &basis_count in &setting.bases {
            add(&lit.polar, true, setting.turbidity, basis_count);
        }
        add(whole, false, setting.turbidity, setting.basis_count());
        if let Some(between) = setting.between {
            add(&lit.polar, true, between, setting.basis_count());
        }
    }
    subjects
}

/// Times and errors on one executor; false where there is no such device.
fn on_executor(
    choice: DeviceChoice,
    setting: &Setting,
    subjects: &[Subject<'_>],
    skies: &[ReferenceSky],
    extent: &Extent,
    report: &mut Report,
) -> Result<bool, BenchError> {
    let Some(engine) = executors::start(choice, setting)? else { return Ok(false) };
    let record = executors::record(&engine, &report.machine, extent)?;
    report.executors.push(record.clone());
    time_engine(&engine, &record, setting, subjects, extent.rounds, report)?;
    let together = rendered_together(setting, subjects);
    report.batches.extend(batches::of_engine(&engine, &record, setting, &together, extent.rounds)?);
    report.errors.extend(accuracy::of_engine(&engine, setting, skies, extent.rounds)?);
    Ok(true)
}

/// Of each kind of scene the largest, at a pack's turbidity with the largest basis, and the cells with 32 functions too.
fn rendered_together<'a, 'b>(setting: &Setting, subjects: &'b [Subject<'a>]) -> Vec<&'b Subject<'a>> {
    let largest = |scene: &str, basis: usize| {
        let of_scene = subjects.iter().filter(|subject| subject.skipping && subject.scene.scene == scene);
        let at_pack = of_scene.filter(|subject| subject.turbidity == setting.turbidity);
        at_pack
            .filter(|subject| subject.request.basis == Some(basis))
            .max_by_key(|subject| subject.scene.lit_sources)
    };
    let all = setting.basis_count();
    let few = setting.bases.iter().copied().find(|&basis| basis == FEW_FUNCTIONS && basis < all);
    let few = few.and_then(|basis| largest("cells", basis));
    [few, largest("cells", all), largest("raster", all)].into_iter().flatten().collect()
}

fn time_engine(
    engine: &Engine,
    record: &ExecutorRecord,
    setting: &Setting,
    subjects: &[Subject<'_>],
    rounds: usize,
    report: &mut Report,
) -> Result<(), BenchError> {
    let requests: Vec<RenderRequest> = subjects.iter().map(|subject| subject.request.clone()).collect();
    for (subject, timed) in subjects.iter().zip(executors::time(engine, &requests, rounds)?) {
        let is_whole = subject.request.basis == Some(setting.basis_count()) && timed.work.packs == 1;
        if is_whole && subject.skipping {
            let prepared = Prepared::new(&subject.request, &setting.set)?;
            report.roofline.extend(rows::roofline(record, subject, &prepared, &timed, setting));
        }
        report.run_times.push(rows::run_time(&record.executor, subject, timed, rounds));
    }
    Ok(())
}

#[cfg(test)]
#[path = "run_tests.rs"]
pub(crate) mod tests;
