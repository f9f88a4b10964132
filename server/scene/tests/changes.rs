//! Edited and dimmed scenes against scenes of rasters that were changed before ingest.

#![expect(clippy::unwrap_used, reason = "a test stops at the first error")]

mod common;

use common::{STEP, TestRaster, TestStore, place};
use proptest::prelude::*;
use skyglow_physics::{EmissionMix, GeoPoint, LampChange, LampPreset, PreservedFlux};
use skyglow_scene::{Area, Change, ChangeError, ChangeStep, Edit, PixelFactors, PolarGrid, Scene, TileLayer};
use std::sync::OnceLock;

const SIZE: usize = 160;

fn world() -> &'static (TestRaster, Scene) {
    static WORLD: OnceLock<(TestRaster, Scene)> = OnceLock::new();
    WORLD.get_or_init(|| {
        let raster = TestRaster::scattered(SIZE, SIZE);
        let scene = TestStore::new().scene(&raster);
        (raster, scene)
    })
}

/// Centre of a pixel of the raster, longitude and latitude.
fn center(column: usize, row: usize) -> [f64; 2] {
    [37.0 + STEP * (column as f64 + 0.5), -1.0 - STEP * (row as f64 + 0.5)]
}

/// A rectangle around pixels `columns` × `rows`, through no centre.
fn rectangle(columns: [usize; 2], rows: [usize; 2]) -> Area {
    let (west, east) = (37.0 + STEP * columns[0] as f64, 37.0 + STEP * (columns[1] + 1) as f64);
    let (north, south) = (-1.0 - STEP * rows[0] as f64, -1.0 - STEP * (rows[1] + 1) as f64);
    Area::Polygons(vec![vec![vec![
        [west, south],
        [east, south],
        [east, north],
        [west, north],
        [west, south],
    ]]])
}

fn alter(area: Area, factor: f64) -> Edit {
    Edit { area, change: Change::Alter { factor, lamp: None, emission: None } }
}

fn add(area: Area, radiance_nw_cm2_sr: f64) -> Edit {
    Edit { area, change: Change::Add { radiance_nw_cm2_sr, lamp: None, emission: None } }
}

fn painted(scene: &Scene, edits: Vec<Edit>) -> Scene {
    scene.changed(&[ChangeStep::Painted(edits)], "test").unwrap().0
}

fn cell_flux(grid: &PolarGrid) -> f64 {
    grid.cells.iter().map(|cell| f64::from(cell.flux_dnb_w)).sum()
}

/// Everything that a scene answers about its light.
fn assert_same_light(changed: &Scene, ingested: &Scene, observer: GeoPoint) {
    let (a, b) = (
        changed.polar_grid_with_ratio(observer, false, 0.0),
        ingested.polar_grid_with_ratio(observer, false, 0.0),
    );
    assert!((a.flux_dnb_w - b.flux_dnb_w).abs() <= 1e-6 * b.flux_dnb_w, "{} {}", a.flux_dnb_w, b.flux_dnb_w);
    assert_eq!(a.azimuth_start, b.azimuth_start);
    for (a, b) in a.cells.iter().zip(&b.cells) {
        assert_eq!((a.ring, a.blocking), (b.ring, b.blocking));
        assert!((a.flux_dnb_w - b.flux_dnb_w).abs() <= 1e-5 * b.flux_dnb_w, "{a:?} {b:?}");
    }
    let (a, b) = (changed.polar_grid(observer, false), ingested.polar_grid(observer, false));
    assert!((cell_flux(&a) - cell_flux(&b)).abs() <= 1e-5 * cell_flux(&b));
    let sum = |scene: &Scene| -> f64 {
        scene
            .light_shares(observer, false)
            .iter()
            .flat_map(|(_, shares)| shares.pixels())
            .map(|p| f64::from(p.flux_dnb_w))
            .sum()
    };
    assert!((sum(changed) - sum(ingested)).abs() <= 1e-5 * sum(ingested));
    assert_eq!(changed.metadata().lit_pixels, ingested.metadata().lit_pixels);
    let exact = |scene: &Scene| scene.source_pixels_within(observer, 300_000.0).len();
    assert_eq!(exact(changed), exact(ingested));
    for (z, x, y) in [(0, 0, 0), (6, 38, 32), (9, 308, 257), (12, 2469, 2059)] {
        let tile = |scene: &Scene| scene.tile(TileLayer::Radiance, z, x, y, 64).unwrap();
        let (a, b) = (tile(changed), tile(ingested));
        assert_eq!(a.has_data, b.has_data);
        for (a, b) in a.values.iter().zip(&b.values) {
            assert!((a - b).abs() <= 1e-5 * b.abs() + 1e-9, "{z}/{x}/{y}: {a} {b}");
        }
    }
    for (column, row) in [(0, 0), (20, 31), (80, 80), (159, 2)] {
        let [longitude, latitude] = center(column, row);
        let at = |scene: &Scene| scene.radiance_nw_cm2_sr(place(latitude, longitude)).unwrap();
        assert!((at(changed) - at(ingested)).abs() <= 1e-5 * at(ingested));
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 12, failure_persistence: None, ..ProptestConfig::default() })]

    /// A painted scene equals the scene of the painted raster.
    #[test]
    fn painting_a_scene_is_painting_its_raster(
        columns in (0usize..140, 0usize..20), rows in (0usize..140, 0usize..20),
        factor in prop_oneof![Just(0.0), Just(1.0), 0.1f64..3.0],
        new in (5usize..150, 5usize..150), added in 0.5f64..50.0,
        x in -0.2f64..1.2, y in -0.2f64..1.2,
    ) {
        let (raster, scene) = world();
        let (columns, rows) = ([columns.0, columns.0 + columns.1], [rows.0, rows.0 + rows.1]);
        let fresh = ([new.0 - 3, new.0 + 3], [new.1 - 2, new.1 + 2]);
        let mut other = raster.clone();
        for row in rows[0]..=rows[1] {
            for column in columns[0]..=columns[1] {
                // As f32: the raster's numbers are.
                let value = &mut other.values[row * SIZE + column];
                *value = f64::from(*value as f32) * factor;
            }
        }
        for row in fresh.1[0]..=fresh.1[1] {
            for column in fresh.0[0]..=fresh.0[1] {
                other.values[row * SIZE + column] += added;
            }
        }
        let edits = vec![alter(rectangle(columns, rows), factor), add(rectangle(fresh.0, fresh.1), added)];
        let changed = painted(scene, edits);
        let observer = place(-1.0 - STEP * SIZE as f64 * y, 37.0 + STEP * SIZE as f64 * x);
        assert_same_light(&changed, &TestStore::new().scene(&other), observer);
        prop_assert_ne!(&changed.metadata().version, &scene.metadata().version);
    }
}

/// Pixels are dimmed one by one, and those dimmed to zero are removed.
#[test]
fn pixels_dimmed_to_zero_are_removed() {
    let (raster, scene) = world();
    let mut other = raster.clone();
    let mut factors: Vec<(u64, f32)> = Vec::new();
    for (number, value) in other.values.iter_mut().enumerate().filter(|(_, value)| **value > 0.0) {
        let factor = (number % 5) as f32 * 0.25;
        factors.push((Scene::pixel_code((number % SIZE) as u32, (number / SIZE) as u32), factor));
        *value = f64::from(*value as f32) * f64::from(factor);
    }
    factors.sort_unstable_by_key(|factor| factor.0);
    let (codes, factors) = factors.into_iter().unzip();
    let dimmed = ChangeStep::Dimmed(PixelFactors { codes, factors });
    let (changed, summary) = scene.changed(std::slice::from_ref(&dimmed), "plan").unwrap();
    assert_same_light(&changed, &TestStore::new().scene(&other), place(-1.3, 37.2));
    let unchanged = raster.values.iter().enumerate().filter(|(n, v)| **v > 0.0 && n % 5 == 4).count() as u64;
    assert_eq!(summary.changed_pixels, scene.metadata().lit_pixels - unchanged);
    assert_eq!(summary.new_pixels, 0);
    // Steps go on from each other.
    let twice = scene.changed(&[dimmed.clone(), dimmed], "twice").unwrap().0;
    let square = |v: f64| v * v;
    for (number, value) in raster.values.iter().enumerate().filter(|(_, value)| **value > 0.0).step_by(17) {
        let [longitude, latitude] = center(number % SIZE, number / SIZE);
        let at = twice.radiance_nw_cm2_sr(place(latitude, longitude)).unwrap();
        let wanted = value * square((number % 5) as f64 * 0.25);
        assert!((at - wanted).abs() <= 1e-5 * value, "{at} {wanted}");
    }
}

/// Replaced lamps are lights of their own in the place of the old ones.
#[test]
fn replaced_lamps_are_separate_lights() {
    let (_, scene) = world();
    let area = rectangle([20, 90], [30, 100]);
    let to_led =
        LampChange { from: None, to: LampPreset::Led4000k.lamp(), preserved: PreservedFlux::LuminousFlux };
    let lamps = Edit {
        area: area.clone(),
        change: Change::Alter { factor: 1.0, lamp: Some(to_led.clone()), emission: None },
    };
    let shield = EmissionMix::lambert();
    let shades = Edit {
        area: area.clone(),
        change: Change::Alter { factor: 1.0, lamp: None, emission: Some(shield) },
    };
    let changed = painted(scene, vec![lamps, shades]);
    let observer = place(-1.2, 37.3);
    let grids = changed.polar_grids(observer, false);
    assert_eq!(grids.len(), 2);
    assert!(grids[0].0.is_unchanged());
    assert_eq!((grids[1].0.lamps.as_slice(), grids[1].0.emission), ([to_led].as_slice(), Some(shield)));
    let whole = scene.polar_grid(observer, false).flux_dnb_w;
    let dark = painted(scene, vec![alter(area, 0.0)]).polar_grid(observer, false).flux_dnb_w;
    assert!((grids[0].1.flux_dnb_w - dark).abs() < 1e-6 * whole);
    assert!((grids[0].1.flux_dnb_w + grids[1].1.flux_dnb_w - whole).abs() < 1e-6 * whole);
    // Numbers name each light once, whatever layer it is in.
    let shares = changed.light_shares(observer, false);
    let mut numbers: Vec<u32> =
        shares.iter().flat_map(|(_, s)| s.pixels()).map(|pixel| pixel.number).collect();
    numbers.sort_unstable();
    assert!(numbers.windows(2).all(|pair| pair[0] < pair[1]));
    assert_eq!(numbers.len() as u64, scene.metadata().lit_pixels);
    let mut codes: Vec<u64> = numbers.iter().map(|&number| changed.code(number)).collect();
    codes.sort_unstable();
    codes.dedup();
    assert_eq!(codes.len(), numbers.len());
}

/// A brush paints the pixels under it, however thin it is.
#[test]
fn a_thin_brush_still_paints_pixels() {
    let (_, scene) = world();
    let summary = |edit: Edit| scene.changed(&[ChangeStep::Painted(vec![edit])], "x").unwrap().1;
    let dot = Area::Brush { points: vec![center(40, 50)], radius_m: 1.0 };
    assert_eq!(
        summary(add(dot, 3.0)).new_pixels
            + summary(alter(Area::Brush { points: vec![center(40, 50)], radius_m: 1.0 }, 0.5)).changed_pixels,
        1
    );
    let line = Area::Brush { points: vec![center(10, 20), center(60, 20), center(60, 70)], radius_m: 1.0 };
    let drawn = summary(add(line, 3.0));
    assert_eq!(drawn.new_pixels + drawn.changed_pixels, 101);
    // A wide one all within its radius: 463 m a pixel.
    let wide = Area::Brush { points: vec![center(80, 80)], radius_m: 5_000.0 };
    let drawn = summary(add(wide, 3.0));
    let circle = std::f64::consts::PI * 5_000f64.powi(2) / 463.3f64.powi(2);
    assert!(((drawn.new_pixels + drawn.changed_pixels) as f64 / circle - 1.0).abs() < 0.03);
}

/// What cannot be painted is refused with the number of its edit.
#[test]
fn bad_edits_are_refused_by_number() {
    let (_, scene) = world();
    let refused = |edits: Vec<Edit>| scene.changed(&[ChangeStep::Painted(edits)], "x").unwrap_err();
    let fine = alter(rectangle([1, 2], [1, 2]), 0.5);
    let far = Area::Brush { points: vec![[10.0, 50.0]], radius_m: 100.0 };
    assert_eq!(refused(vec![fine.clone(), alter(far, 0.5)]), ChangeError::Outside { number: 2 });
    let open = Area::Polygons(vec![vec![vec![[37.0, -1.0], [37.1, -1.0], [37.1, -1.1]]]]);
    assert!(matches!(refused(vec![alter(open, 0.5)]), ChangeError::Area { number: 1, .. }));
    let everywhere = rectangle([0, SIZE - 1], [0, SIZE - 1]);
    assert_eq!(refused(vec![add(everywhere.clone(), 2e7)]), ChangeError::TooBright { number: 1 });
    assert_eq!(refused(vec![fine, alter(everywhere.clone(), 1e9)]), ChangeError::TooBright { number: 2 });
    for points in [vec![], vec![[f64::NAN, 0.0]], vec![[37.0, -95.0]], vec![[37.0, -1.0], [57.0, -1.0]]] {
        let brush = Area::Brush { points, radius_m: 100.0 };
        assert!(matches!(refused(vec![alter(brush, 0.5)]), ChangeError::Area { number: 1, .. }));
    }
    for radius_m in [0.0, -1.0, f64::NAN, f64::INFINITY, 60_000.0] {
        let brush = Area::Brush { points: vec![[37.1, -1.1]], radius_m };
        assert!(matches!(refused(vec![alter(brush, 0.5)]), ChangeError::Area { number: 1, .. }));
    }
    // Strokes over and over each other.
    let zigzag: Vec<[f64; 2]> = (0..1000).map(|step| center(40 + step % 80, 80)).collect();
    let brush = Area::Brush { points: zigzag, radius_m: 50_000.0 };
    assert!(matches!(refused(vec![alter(brush, 0.9); 25]), ChangeError::TooMuch { .. }));
    // A dark corner is no mistake: there is nothing to dim.
    let (unchanged, summary) =
        scene.changed(&[ChangeStep::Painted(vec![alter(everywhere, 1.0)])], "x").unwrap();
    assert_eq!((summary.changed_pixels, unchanged.metadata().lit_pixels), (0, scene.metadata().lit_pixels));
}

/// Strokes of one lamp are one fixture, and too many fixtures are refused.
#[test]
fn too_many_fixtures_are_refused() {
    let (_, scene) = world();
    let with = |lamp: LampPreset, area: Area| {
        let lamp = LampChange { from: None, to: lamp.lamp(), preserved: PreservedFlux::LuminousFlux };
        Edit { area, change: Change::Alter { factor: 1.0, lamp: Some(lamp), emission: None } }
    };
    // Over each other, in turns.
    let strokes = (0..10).map(|step| {
        let lamp = if step % 2 == 0 { LampPreset::Hps } else { LampPreset::Led3000k };
        with(lamp, rectangle([10 + step, 60 + step], [10, 60]))
    });
    let changed = painted(scene, strokes.collect());
    assert_eq!(changed.polar_grids(place(-1.2, 37.3), false).len(), 3);
    let mixes = (0..40).map(|step| {
        let emission = EmissionMix::new([1.0, f64::from(step), 0.0]).unwrap();
        Edit {
            area: rectangle([0, 100], [3 * step as usize, 3 * step as usize + 2]),
            change: Change::Alter { factor: 1.0, lamp: None, emission: Some(emission) },
        }
    });
    let refused = scene.changed(&[ChangeStep::Painted(mixes.collect())], "x").unwrap_err();
    assert!(matches!(refused, ChangeError::TooManyFixtures { number: 33 }), "{refused}");
}

/// Light that is added and then removed leaves nothing.
#[test]
fn adding_then_removing_light_leaves_nothing() {
    let (raster, scene) = world();
    let dark = (0..SIZE * SIZE).find(|at| raster.values[*at] == 0.0).unwrap();
    let dot = || Area::Brush { points: vec![center(dark % SIZE, dark / SIZE)], radius_m: 5.0 };
    let edits = vec![add(dot(), 7.0), alter(dot(), 0.0), add(dot(), 5.0), alter(dot(), 0.0)];
    let (changed, summary) = scene.changed(&[ChangeStep::Painted(edits)], "x").unwrap();
    assert_eq!((summary.new_pixels, summary.changed_pixels), (0, 0));
    assert_eq!(summary.lit_pixels_in_edit, [0, 1, 0, 1]);
    assert_eq!(changed.metadata().lit_pixels, scene.metadata().lit_pixels);
    // Where there are no data there is nothing to add to.
    let mut holes = raster.clone();
    holes.no_data = Some(-1.0);
    holes.values[dark] = -1.0;
    let refused = TestStore::new().scene(&holes).changed(&[ChangeStep::Painted(vec![add(dot(), 7.0)])], "x");
    assert_eq!(refused.unwrap_err(), ChangeError::Outside { number: 1 });
}

/// New lights stand on the terrain and behind its skylines.
#[test]
fn new_lights_use_terrain_and_skylines() {
    let test_store = TestStore::new();
    // A ridge north of the middle, 600 m high.
    let mut hills = TestRaster::new(SIZE, SIZE, |_, r| if (60..64).contains(&r) { 1_600.0 } else { 1_000.0 });
    hills.geotransform = [37.0, STEP, 0.0, -1.0, 0.0, -STEP];
    let path = test_store.path("hills.tif");
    hills.write_f32(&path);
    let lights = |lit: fn(usize, usize) -> bool| {
        let raster = TestRaster::new(SIZE, SIZE, |c, r| if lit(c, r) { 20.0 } else { 0.0 });
        test_store.scene_with(&raster, |options| options.terrain = vec![path.clone()])
    };
    let ingested = lights(|c, r| (c, r) == (80, 57) || (c, r) == (20, 20));
    let bare = lights(|c, r| (c, r) == (20, 20));
    let dot = Area::Brush { points: vec![center(80, 57)], radius_m: 10.0 };
    let changed = painted(&bare, vec![add(dot, 20.0)]);
    let observer = place(-1.0 - STEP * 90.0, 37.0 + STEP * 80.0);
    let (a, b) = (changed.polar_grid(observer, true), ingested.polar_grid(observer, true));
    assert!(b.cells.iter().any(|cell| cell.blocking > 0), "the ridge hides nothing");
    assert_eq!(a.cells.len(), b.cells.len());
    for (a, b) in a.cells.iter().zip(&b.cells) {
        assert_eq!((a.ring, a.blocking), (b.ring, b.blocking));
        assert!((a.flux_dnb_w - b.flux_dnb_w).abs() < 1e-5 * b.flux_dnb_w);
        assert!((a.altitude_m - b.altitude_m).abs() < 0.1);
    }
}
