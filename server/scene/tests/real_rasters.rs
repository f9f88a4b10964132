//! Rasters of real products. Ignored unless asked for, since they are not in the repository: see [`common::real_raster`].

#![expect(clippy::unwrap_used, reason = "a test stops at the first error")]

mod common;

use common::{TestStore, place, real_raster};
use skyglow_scene::{IngestOptions, Scene, SceneId};
use std::time::Instant;

fn ingest(name: &str, terrain: &[&str]) -> Scene {
    let mut options = IngestOptions::new(real_raster(name));
    for file in terrain {
        options.terrain.push(real_raster(file));
    }
    options.id = Some(SceneId::parse("real").unwrap());
    let test_store = TestStore::new();
    let start = Instant::now();
    let metadata = test_store.ingest(&options).unwrap();
    println!(
        "{name}: ingested in {:.2} s, {} lit pixels",
        start.elapsed().as_secs_f64(),
        metadata.lit_pixels
    );
    for warning in &metadata.report.warnings {
        println!("  {warning}");
    }
    test_store.store.open(&metadata.id).unwrap()
}

#[test]
#[ignore = "needs the folder of real rasters"]
fn kenya_keeps_its_flux_from_every_place() {
    let scene = ingest("VNP46A4_kenya_2023.tif", &["elevation_30s_kenya.tif"]);
    let report = &scene.metadata().report;
    assert_eq!(report.pixels, 1924 * 2348);
    assert!((report.zero.count as f64 / report.pixels as f64 - 0.914).abs() < 1e-3);
    assert!((report.no_data.count as f64 / report.pixels as f64 - 0.066).abs() < 1e-3);
    assert!((report.maximum_nw_cm2_sr - 215.2).abs() < 1e-3);
    // The elevations are those of the country, and its neighbours shine too.
    assert!(
        report.warnings.len() == 1 && report.warnings[0].contains("have no terrain"),
        "{:?}",
        report.warnings
    );
    let terrain = report.terrain.as_ref().unwrap();
    let without = (terrain.nearest.count + terrain.missing.count) as f64 / scene.metadata().lit_pixels as f64;
    assert!((without - 0.14).abs() < 0.01, "{without}");
    let altitude = |lat, lon| scene.terrain_altitude_m(place(lat, lon)).unwrap();
    assert!((1_600.0..1_750.0).contains(&altitude(-1.2864, 36.8172)), "{}", altitude(-1.2864, 36.8172));
    assert!(altitude(-0.1521, 37.3084) > 4_300.0, "{}", altitude(-0.1521, 37.3084));
    for (lat, lon) in [(-1.2864, 36.8172), (-0.1521, 37.3084), (-4.05, 39.66), (4.9, 34.0), (-1.6, 36.6)] {
        let observer = place(lat, lon);
        let direct: f64 = scene.source_pixels_within(observer, 300_000.0).iter().map(|p| p.flux_dnb_w).sum();
        let start = Instant::now();
        let grid = scene.polar_grid(observer, false);
        let time_ms = 1e3 * start.elapsed().as_secs_f64();
        let cells: f64 = grid.cells.iter().map(|c| f64::from(c.flux_dnb_w)).sum();
        println!(
            "  {lat} {lon}: {time_ms:.1} ms, {} cells, coverage {:.3}, flux error {:.1e}, of the cells {:.1e}",
            grid.cells.len(),
            grid.coverage,
            grid.flux_dnb_w / direct - 1.0,
            cells / direct - 1.0
        );
        assert!((grid.flux_dnb_w / direct - 1.0).abs() < 1e-9 && (cells / direct - 1.0).abs() < 1e-6);
    }
}

#[test]
#[ignore = "needs the folder of real rasters"]
fn nigeria_is_reported_capped() {
    let scene = ingest("VNP46A4_nigeria_2023.tif", &[]);
    let report = &scene.metadata().report;
    assert_eq!(report.maximum_nw_cm2_sr, 3000.0);
    assert!(report.capped.count >= 1 && report.warnings.iter().any(|w| w.contains("capped")), "{report:?}");
}

#[test]
#[ignore = "needs the folder of real rasters"]
fn burundi_is_reported_negative_in_january() {
    let january = ingest("viirs_burundi_2016_01.tif", &[]);
    let report = &january.metadata().report;
    assert!(report.negative.count as f64 > 0.9 * (report.negative.count + report.lit.count) as f64);
    assert!(report.warnings.iter().any(|w| w.contains("negative")), "{:?}", report.warnings);
    assert!(january.source_pixels_within(place(-3.4, 29.9), 3e5).iter().all(|p| p.flux_dnb_w > 0.0));
    let july = ingest("viirs_burundi_2016_07.tif", &[]);
    assert!((july.metadata().report.maximum_nw_cm2_sr - 165.26).abs() < 1e-3);
}

#[test]
#[ignore = "needs the folder of real rasters"]
fn srtm_tiles_are_read_as_geotiff_and_as_hgt() {
    // The lights lie elsewhere: only the terrain is looked at.
    let files = ["N46E008_srtm3.tif", "N44W072.hgt", "elevation_30s_kenya.tif"];
    let scene = ingest("VNP46A4_kenya_2020.tif", &files);
    let altitude = |lat, lon| scene.terrain_altitude_m(place(lat, lon));
    let andermatt = altitude(46.636, 8.594).unwrap();
    assert!((1_400.0..1_500.0).contains(&andermatt), "{andermatt}");
    let mount_washington = altitude(44.2706, -71.3033).unwrap();
    assert!((1_850.0..1_920.0).contains(&mount_washington), "{mount_washington}");
    assert_eq!(altitude(47.5, 8.5), None);
}
