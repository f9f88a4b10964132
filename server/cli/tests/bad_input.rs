//! What a user is told about a raster that is wrong, or odd: exit status, one line, nothing left behind.
#![allow(clippy::unwrap_used, clippy::expect_used, reason = "what cannot be set up fails the test")]

mod common;

use common::{
    Finished,
    geotiff::{Crs, SIDE, town, write_picture, write_radiance},
    skyglow, text,
};
use std::path::{Path, PathBuf};

/// A folder with one raster in it.
struct Bench {
    folder: tempfile::TempDir,
}

impl Bench {
    fn new() -> Self {
        Self { folder: tempfile::tempdir().unwrap() }
    }

    fn raster(&self) -> PathBuf {
        self.folder.path().join("lights.tif")
    }

    fn data(&self) -> PathBuf {
        self.folder.path().join("data")
    }

    fn ingest(&self, more: &[&str]) -> Finished {
        let (raster, data) = (self.raster(), self.data());
        skyglow(&[&["ingest", text(&raster), "--data", text(&data), "--json"], more].concat())
    }
}

/// Name, how the raster is written, and a part of what is said.
type Case = (&'static str, Box<dyn Fn(&Path)>, &'static str);

fn with_crs(crs: Crs) -> impl Fn(&Path) {
    move |path| write_radiance(path, crs, &town())
}

fn with_radiance(change: impl Fn(usize, f32) -> f32) -> impl Fn(&Path) {
    move |path| {
        let changed: Vec<f32> = town().into_iter().enumerate().map(|(i, v)| change(i, v)).collect();
        write_radiance(path, Crs::Geographic, &changed);
    }
}

fn truncated(path: &Path) {
    write_radiance(path, Crs::Geographic, &town());
    let bytes = std::fs::read(path).unwrap();
    std::fs::write(path, &bytes[..bytes.len() / 2]).unwrap();
}

/// A raster that is no radiance is refused in one line, and nothing is left of it.
#[test]
fn bad_rasters_are_refused_in_one_line() {
    let cases: Vec<Case> = vec![
        ("wrong CRS", Box::new(with_crs(Crs::Projected(32637))), "cannot be meant"),
        ("no CRS", Box::new(with_crs(Crs::PositionOnly)), "no coordinate reference system"),
        ("no position", Box::new(with_crs(Crs::None)), "no "),
        ("all no-data", Box::new(with_radiance(|_, _| -999.0)), "no measurement"),
        ("all NaN", Box::new(with_radiance(|_, _| f32::NAN)), "no measurement"),
        ("all negative", Box::new(with_radiance(|_, _| -0.3)), "no light"),
        ("uint8 picture", Box::new(write_picture), "8-bit"),
        ("truncated", Box::new(truncated), "cannot be read as a raster"),
        ("no raster at all", Box::new(|path| std::fs::write(path, "lights").unwrap()), "cannot be read"),
    ];
    for (name, write, reason) in cases {
        let bench = Bench::new();
        write(&bench.raster());
        let finished = bench.ingest(&[]).expect_status(1);
        println!("{name}: {}", finished.stderr.trim_end());
        assert_eq!(finished.stdout, "", "{name}");
        let said: Vec<&str> = finished.stderr.lines().filter(|line| line.starts_with("skyglow: ")).collect();
        assert_eq!(said.len(), 1, "{name}: {}", finished.stderr);
        assert!(said[0].contains(reason) && said[0].contains("lights.tif"), "{name}: {}", said[0]);
        let left = skyglow(&["scenes", "--json", "--data", text(&bench.data())]).expect_status(0);
        assert_eq!(left.json(), serde_json::json!([]), "{name}");
        let folder = bench.data().join("scenes");
        let rest = std::fs::read_dir(&folder).map_or(0, Iterator::count);
        assert_eq!(rest, 0, "{name}: something is left in {}", folder.display());
    }
}

#[test]
fn the_good_raster_of_these_tests_is_taken() {
    let bench = Bench::new();
    write_radiance(&bench.raster(), Crs::Geographic, &town());
    let scene = bench.ingest(&[]).expect_status(0).json();
    assert_eq!(scene["id"], "lights");
    let lit = town().iter().filter(|&&radiance| radiance > 0.0).count();
    assert_eq!(scene["lit_pixels"], lit);
    let listed = skyglow(&["scenes", "--data", text(&bench.data())]).expect_status(0);
    assert!(listed.stdout.contains(&format!("{lit} pixels")), "{}", listed.stdout);
}

/// NaN, infinite and negative pixels are counted apart and give no light.
#[test]
fn pixels_without_a_value_give_no_light() {
    let bench = Bench::new();
    with_radiance(|index, value| match index {
        0..3 => f32::NAN,
        3..8 => -0.2,
        8..10 => -999.0,
        10..14 => f32::INFINITY,
        14 => f32::NEG_INFINITY,
        _ => value,
    })(&bench.raster());
    let report = bench.ingest(&[]).expect_status(0).json()["report"].clone();
    assert_eq!(report["nan"]["count"], 3);
    assert_eq!(report["infinite"]["count"], 5);
    assert!(report["warnings"][0].as_str().unwrap().starts_with("5 pixels are infinite"), "{report}");
    assert_eq!(report["negative"]["count"], 5);
    assert_eq!(report["no_data"]["count"], 2);
    assert_eq!(report["pixels"], SIDE * SIDE);
    assert_eq!(report["negative"]["examples"].as_array().map(Vec::is_empty), Some(false));
}

/// Missing terrain is refused when it was named, and reported when there is none.
#[test]
fn missing_terrain_is_refused_or_reported() {
    let bench = Bench::new();
    write_radiance(&bench.raster(), Crs::Geographic, &town());
    let nowhere = bench.folder.path().join("nowhere.tif");
    let refused = bench.ingest(&["--terrain", text(&nowhere)]).expect_status(1);
    assert!(refused.stderr.contains("nowhere.tif"), "{}", refused.stderr);
    let scene = bench.ingest(&[]).expect_status(0).json();
    assert_eq!(scene["terrain"], false);
    let listed = skyglow(&["scenes", "--data", text(&bench.data())]).expect_status(0);
    assert!(listed.stdout.contains("every lamp and observer at sea level"), "{}", listed.stdout);
}

#[test]
fn a_taken_id_and_wrong_options_are_refused() {
    let bench = Bench::new();
    write_radiance(&bench.raster(), Crs::Geographic, &town());
    bench.ingest(&["--id", "town"]).expect_status(0);
    let taken = bench.ingest(&["--id", "town"]).expect_status(1);
    assert!(taken.stderr.contains("--replace"), "{}", taken.stderr);
    bench.ingest(&["--id", "town", "--replace"]).expect_status(0);
    bench.ingest(&["--id", "Town!"]).expect_status(2);
    bench.ingest(&["--units", "lux"]).expect_status(2);
    bench.ingest(&["--id", "other", "--calibration", "-1"]).expect_status(2);
    let date = bench.ingest(&["--id", "other", "--date", "last summer"]).expect_status(2);
    assert!(date.stderr.contains("\"last summer\" is no date"), "{}", date.stderr);
    bench.ingest(&["--id", "other", "--date", "2023-06/2023-08"]).expect_status(0);
}
