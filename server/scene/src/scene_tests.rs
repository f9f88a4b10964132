use super::*;
use crate::changes::{Area, Change, Edit};
use crate::grid::GeographicAxes;
use crate::light_layer::Lights;
use crate::lit_pixels::LitPixels;
use crate::metadata::{GridMetadata, IngestReport};
use crate::scene_id::SceneId;

const SIDE: u32 = 64;
const STEP_DEG: f64 = 0.01;

/// All pixels lit, none alike.
fn scene() -> Scene {
    let axes = GeographicAxes {
        first_longitude_deg: 7.0,
        first_latitude_deg: 47.0,
        longitude_step_deg: STEP_DEG,
        latitude_step_deg: -STEP_DEG,
    };
    let grid = Grid::geographic(axes, SIDE, SIDE);
    let mut mask = ValidMask::begin(SIDE);
    (0..SIDE).for_each(|_| mask.push_row((0..SIDE).map(|_| true)));
    let mut pixels = LitPixels::default();
    for row in 0..SIDE {
        for column in 0..SIDE {
            pixels.codes.push(morton::encode(column, row));
            pixels.radiance_nw_cm2_sr.push(1.0 + (row * SIDE + column) as f32);
            pixels.altitude_m.push(0.0);
        }
    }
    pixels.sort();
    let metadata = SceneMetadata {
        id: SceneId::parse("square").unwrap(),
        title: String::new(),
        bounds: grid.bounds_deg(),
        grid: GridMetadata { width: SIDE, height: SIDE, geotransform: [0.0; 6], crs_wkt: String::new() },
        crs: String::new(),
        calibration: 1.0,
        report: IngestReport::default(),
        pixel_size_m: grid.pixel_size_m(),
        lit_pixels: pixels.len() as u64,
        date: None,
        attribution: None,
        illustrative: true,
        terrain: false,
        light_skylines: false,
        land_cover: false,
        places_count: 0,
        places_source: None,
        ingested_unix_s: None,
        version: "v".to_owned(),
    };
    let lights = Lights::new(&grid, pixels, None, 1.0);
    Scene {
        metadata,
        grid: Arc::new(grid),
        mask: Arc::new(mask.finish()),
        light_layers: vec![LightLayer::whole(lights)],
        terrain: Arc::new(Terrain::default()),
        land_cover: Arc::default(),
        places: Vec::new().into(),
    }
}

/// A changed scene shares what is untouched, and nothing of that is rebuilt.
#[test]
fn changed_scenes_share_what_is_untouched() {
    let scene = scene();
    let area = Area::Brush { points: vec![[7.105, 46.905]], radius_m: 2_000.0 };
    let change = Change::Alter { factor: 0.5, lamp: None, emission: None };
    let steps = [ChangeStep::Painted(vec![Edit { area, change }])];
    let (changed, summary) = scene.changed(&steps, "x").unwrap();
    assert!(Arc::ptr_eq(&changed.grid, &scene.grid) && Arc::ptr_eq(&changed.terrain, &scene.terrain));
    assert!(Arc::ptr_eq(&changed.mask, &scene.mask) && Arc::ptr_eq(&changed.places, &scene.places));
    assert!(Arc::ptr_eq(&changed.light_layers[0].lights, &scene.light_layers[0].lights));
    // Of 4096 pixels some 14 lie within 2 km: those alone have a new pyramid.
    assert!((8..25).contains(&summary.changed_pixels), "{}", summary.changed_pixels);
    assert_eq!(changed.light_layers.len(), 2);
    let of_changed = &changed.light_layers[1].lights;
    assert_eq!(of_changed.pixels.len() as u64, summary.changed_pixels);
    let blocks: usize =
        (1..=of_changed.pyramid.top()).map(|level| of_changed.pyramid.level(level).blocks.len()).sum();
    assert!(blocks < 40, "{blocks}");
    // Blocks that lost no light are still taken whole.
    let removed = changed.light_layers[0].removed.as_ref().unwrap();
    let touched = |level: usize| {
        let count = scene.light_layers[0].lights.pyramid.level(level).blocks.len();
        (0..count).filter(|&block| removed.is_touched(level, block)).count()
    };
    assert!(touched(1) <= 14 && touched(3) <= 4, "{} {}", touched(1), touched(3));
    let full = (0..1024).filter(|&block| removed.is_empty_block(1, block)).count();
    assert!(full > 0 && full < touched(1) && removed.len() as u64 == summary.changed_pixels);
    let sum = |scene: &Scene| -> f64 {
        scene.light_layers.iter().map(|layer| layer.radiance_sum_nw_cm2_sr(6, 0, 0)).sum()
    };
    assert!(sum(&changed) < sum(&scene) - 1.0);
    let of_pixels: f64 = (0..SIDE * SIDE).map(|at| changed.pixel_light(at % SIDE, at / SIDE).0).sum();
    assert!((sum(&changed) / of_pixels - 1.0).abs() < 1e-6);
}
