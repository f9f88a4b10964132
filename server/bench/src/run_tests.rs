//! A small run over made-up packs, and what its report must hold.

use super::*;
use crate::{reference, text::sections};
use skyglow_render::synthetic;
use skyglow_tables::{
    MultipleAxes, Scattering, TableAxes,
    manifest::{MeasuredError, PackParameters},
};

fn options(basis_count: usize, extent: Extent) -> BenchOptions {
    let manifest = |turbidity| {
        let parameters = PackParameters {
            turbidity,
            scattering: Scattering::Single,
            multiple: None::<MultipleAxes>,
            clouds: None,
            axes: TableAxes::coarse(),
            basis_count,
            training_geometries: 1,
            fit_iterations: 1,
            blocked: None,
            fit: skyglow_tables::fit_constants::FitConstants::current(),
        };
        parameters.manifest(MeasuredError::default(), format!("checksum of {turbidity}"))
    };
    BenchOptions {
        tables: synthetic::table_set(&[2.0, 3.0], basis_count),
        manifests: vec![manifest(2.0), manifest(3.0)],
        extent,
        reference_files: Vec::new(),
        data: "/nowhere".into(),
    }
}

/// Made-up packs of turbidity 2 and 3.
pub(crate) fn setting(basis_count: usize) -> Setting {
    Setting::of(&options(basis_count, Extent::quick())).unwrap()
}

/// What a test can wait for.
pub(crate) fn tiny() -> Extent {
    Extent {
        cell_counts: vec![1, 32],
        pixel_counts: vec![500],
        bases: vec![8, 16, 64],
        rounds: 2,
        direct_sum_integrals: 200,
        accumulated_cells: 16,
        mixed_nodes: 8,
        time_for_tries: std::time::Duration::from_millis(5),
        stream_bytes: 1 << 20,
        multiply_adds: 1 << 20,
        ..Extent::quick()
    }
}

/// A file that is no reference is refused by its name before anything is measured.
#[test]
fn a_bad_reference_file_is_refused_by_name() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("reference.json");
    std::fs::write(&file, "{}").unwrap();
    for path in [file, folder.path().to_owned()] {
        // Without packs nothing can be measured: that is not what is complained of.
        let options = BenchOptions {
            tables: Vec::new(),
            manifests: Vec::new(),
            reference_files: vec![path.clone()],
            ..options(16, tiny())
        };
        let error = run(&options).err().unwrap().to_string();
        assert!(error.contains(&path.display().to_string()), "{error}");
    }
}

/// Every scene has a row for every executor basis and way and the report reads back.
#[test]
fn reports_have_all_rows_and_read_back() {
    let report = run(&options(16, tiny())).unwrap();
    assert_eq!(report.scenes.len(), 3);
    assert!(report.executors.iter().any(|executor| executor.executor == "cpu"));
    // 64 functions are more than there are: two sizes, the larger one unskipped and between packs too.
    assert_eq!(report.run_times.len(), report.executors.len() * 3 * 4);
    for executor in &report.executors {
        for scene in &report.scenes {
            let rows: Vec<_> = report
                .run_times
                .iter()
                .filter(|row| row.executor == executor.executor)
                .filter(|row| (&row.scene, row.lit_sources) == (&scene.scene, scene.lit_sources))
                .collect();
            let kinds: Vec<_> = rows.iter().map(|row| (row.basis_count, row.skipping, row.packs)).collect();
            assert_eq!(kinds, [(8, true, 1), (16, true, 1), (16, false, 1), (16, true, 2)]);
            assert!(rows.iter().all(|row| row.fastest_ms > 0.0 && row.fastest_ms <= row.median_ms));
            assert!(rows.iter().all(|row| row.times_direct_sum > 0.0 && row.times_accumulation > 0.0));
            let ratio = 1e3 * scene.direct_sum.seconds / rows[0].fastest_ms;
            assert!((rows[0].times_direct_sum / ratio - 1.0).abs() < 1e-9);
        }
        let passes = report.roofline.iter().filter(|row| row.executor == executor.executor).count();
        assert_eq!(passes, 3 * 8);
        assert!(executor.bandwidth_gb_s > 0.0 && executor.multiply_adds_g_s > 0.0, "{executor:?}");
        assert_eq!(executor.read_back_ms.is_some(), executor.executor == "gpu");
        // The largest scene of each kind, for each number of callers.
        let batches = report.batches.iter().filter(|batch| batch.executor == executor.executor);
        let asked: Vec<_> = batches.map(|batch| (batch.scene.as_str(), batch.lit_sources)).collect();
        assert_eq!(asked, [[("cells", 32); 3], [("raster", 500); 3]].concat());
    }
    assert_eq!(report.targets.len(), 6 * report.executors.len());
    assert_eq!(report.packs.len(), 2);
    assert!(
        report.errors.is_empty() && report.notes.iter().any(|note| note.contains("errors were left out"))
    );
    let folder = tempfile::tempdir().unwrap();
    report.write(folder.path()).unwrap();
    let text = std::fs::read_to_string(folder.path().join("bench.json")).unwrap();
    let back: Report = serde_json::from_str(&text).unwrap();
    assert_eq!(back.run_times.len(), report.run_times.len());
    assert_eq!((&back.packs, &back.notes), (&report.packs, &report.notes));
    let timed = |report: &Report| report.run_times.iter().map(|row| row.median_ms).sum::<f64>();
    assert!((timed(&back) / timed(&report) - 1.0).abs() < 1e-12);
    let words: String = sections(&report).iter().map(|section| format!("{section:?}")).collect();
    for scene in ["cells", "raster"] {
        assert!(words.contains(scene), "{words}");
    }
}

/// Baselines that were timed in part say how large a part.
#[test]
fn baselines_report_the_share_timed() {
    let setting = setting(8);
    let row = baselines::of_scene(&setting, &LitScene::of_cells(64), &tiny()).unwrap();
    assert_eq!(row.accumulation.sources_timed, 16);
    assert!((row.accumulation.share_timed - 0.25).abs() < 1e-9);
    assert_eq!(row.image_mixing.sources_timed, 8);
    assert!(row.image_mixing.share_timed < 0.2);
    let sum = row.direct_sum;
    let share = sum.sources_timed as f64 / 64.0 * sum.directions_timed as f64 / 16_384.0;
    assert!(sum.share_timed < 0.01 && (sum.share_timed / share - 1.0).abs() < 1e-12);
    let all = baselines::of_scene(&setting, &LitScene::of_cells(10), &tiny()).unwrap();
    assert_eq!(all.accumulation.share_timed, 1.0);
}

#[test]
fn packs_under_clouds_alone_are_refused() {
    let mut options = options(8, tiny());
    options.tables = synthetic::under_clouds(options.tables, 1_000);
    assert!(matches!(run(&options), Err(BenchError::NoClearPacks)));
}

/// Errors have a row for every sky basis and executor and made-up packs are wrong.
#[test]
fn errors_have_a_row_for_every_sky_and_basis() {
    let setting = setting(16);
    let sky = reference::of_scene(&setting, &LitScene::of_cells(20), 24).unwrap();
    let skies = [sky];
    let engine = executors::start(skyglow_render::DeviceChoice::Cpu, &setting).unwrap().unwrap();
    let rows = accuracy::of_engine(&engine, &setting, &skies, 1).unwrap();
    assert_eq!(rows.iter().map(|row| row.basis_count).collect::<Vec<_>>(), setting.bases);
    assert!(rows.iter().all(|row| row.mean > 0.1 && row.median_ms.is_some()), "{rows:?}");
    let exact = accuracy::of_f64(&setting, &skies).unwrap();
    let largest = rows.last().unwrap();
    assert!((exact[0].mean / largest.mean - 1.0).abs() < 1e-3);
}
