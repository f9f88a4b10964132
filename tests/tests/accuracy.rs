//! Whole skies from the packs that come with the program, against the direct sum over every pixel.
#![allow(clippy::unwrap_used, clippy::expect_used, reason = "what cannot be set up fails the test")]

use skyglow_engine::{DeviceChoice, Engine, EngineConfig, RenderRequest};
use skyglow_physics::{
    Atmosphere, EmissionMix, GeoPoint, LampPreset, Turbidity,
    direct_sum::{direct_sum, grid_direction, stratified_samples},
    error_metric::{ErrorStatistics, relative_error},
    source_pixel::{FARTHEST_SOURCE_M, point_sources},
};
use skyglow_scene::{RING_COUNT, Scene, SceneId, SceneStore, create_demo, ring_distance_m};
use skyglow_tables::{Pack, Scattering, packs_in};
use skyglow_tests::tree;
use std::sync::Arc;

/// A pack's turbidity, and one between two.
const TURBIDITIES: [f64; 2] = [2.5, 3.0];
/// Largest mean error allowed at any place (model section 9).
const LARGEST_MEAN: f64 = 0.05;
/// Directions tried a place: few, because the truth costs 20 µs a source and direction.
const DIRECTIONS: usize = 40;

fn engine() -> Engine {
    let rings: Vec<f64> = (0..RING_COUNT).map(ring_distance_m).collect();
    let tables = packs_in(&tree::root().join("precomputed"))
        .unwrap()
        .iter()
        .map(|path| Arc::new(Pack::open(path).unwrap().resident(&rings)))
        .collect();
    Engine::start(EngineConfig { device: DeviceChoice::Cpu, tables, ..EngineConfig::default() }).unwrap()
}

fn error(
    engine: &Engine,
    scene: &Scene,
    place: GeoPoint,
    turbidity: usize,
    observer_altitude_m: f64,
    truth: &[[f64; 6]],
) -> ErrorStatistics {
    let rendered = engine
        .render_blocking(RenderRequest {
            polar: Arc::new(scene.polar_grid(place)),
            observer_altitude_m,
            turbidity: Turbidity::new(TURBIDITIES[turbidity]).unwrap(),
            scattering: Scattering::Single,
            emission: EmissionMix::garstang(),
            flux_per_dnb_flux: LampPreset::Mixed.lamp().flux_per_dnb_flux,
            basis: None,
        })
        .unwrap();
    let errors = stratified_samples(DIRECTIONS).into_iter().zip(truth).map(|((row, column), truth)| {
        let fast = std::array::from_fn(|band| rendered.panorama.radiance_w_m2_sr(band, row, column));
        relative_error(fast, std::array::from_fn(|band| truth[turbidity * 3 + band]))
    });
    ErrorStatistics::of(errors).unwrap()
}

/// A truth file of the `truth` example.
#[derive(serde::Deserialize)]
struct StoredTruth {
    scene_version: String,
    latitude_deg: f64,
    longitude_deg: f64,
    observer_altitude_m: f64,
    turbidities: Vec<f64>,
    samples: Vec<(usize, usize)>,
    radiance: Vec<Vec<f64>>,
}

#[test]
fn skies_of_the_demo_are_within_five_per_cent_of_stored_direct_sums_at_every_turbidity() {
    let folder = tempfile::tempdir().unwrap();
    let store = SceneStore::new(folder.path());
    create_demo(&store, &mut |_| ()).unwrap();
    let scene = store.open(&SceneId::parse("demo").unwrap()).unwrap();
    let engine = engine();
    let mut files: Vec<_> = std::fs::read_dir(tree::root().join("tests/truth"))
        .unwrap()
        .map(|entry| entry.unwrap().path())
        .filter(|path| path.extension().is_some_and(|extension| extension == "json"))
        .collect();
    files.sort();
    assert!(!files.is_empty());
    for path in files {
        let truth: StoredTruth = serde_json::from_slice(&std::fs::read(&path).unwrap()).unwrap();
        assert_eq!(
            truth.scene_version,
            scene.metadata().version,
            "{}: the demo has changed; make the truth anew (see tests/examples/truth.rs)",
            path.display()
        );
        let place = GeoPoint::from_deg(truth.latitude_deg, truth.longitude_deg).unwrap();
        let polar = Arc::new(scene.polar_grid(place));
        for (index, &turbidity) in truth.turbidities.iter().enumerate() {
            let rendered = engine
                .render_blocking(RenderRequest {
                    polar: Arc::clone(&polar),
                    observer_altitude_m: truth.observer_altitude_m,
                    turbidity: Turbidity::new(turbidity).unwrap(),
                    scattering: Scattering::Single,
                    emission: EmissionMix::garstang(),
                    flux_per_dnb_flux: LampPreset::Mixed.lamp().flux_per_dnb_flux,
                    basis: None,
                })
                .unwrap();
            let errors = truth.samples.iter().zip(&truth.radiance).map(|(&(row, column), radiance)| {
                let fast = std::array::from_fn(|band| rendered.panorama.radiance_w_m2_sr(band, row, column));
                relative_error(fast, std::array::from_fn(|band| radiance[index * 3 + band]))
            });
            let error = ErrorStatistics::of(errors).unwrap();
            println!("{} turbidity {turbidity}: {error:?}", path.display());
            assert!(error.mean < LARGEST_MEAN, "{} turbidity {turbidity}: {error:?}", path.display());
        }
    }
}

#[test]
fn skies_of_the_demo_are_within_five_per_cent_of_the_direct_sum_in_the_mean() {
    let folder = tempfile::tempdir().unwrap();
    let store = SceneStore::new(folder.path());
    create_demo(&store, &mut |_| ()).unwrap();
    let scene = store.open(&SceneId::parse("demo").unwrap()).unwrap();
    let engine = engine();
    let atmospheres = TURBIDITIES.map(|t| Atmosphere::new(Turbidity::new(t).unwrap()));
    // Over the sea 60 km off the coast, and near a city at the edge of the map.
    for (latitude_deg, longitude_deg) in [(42.6, 7.0), (48.2, 14.6)] {
        let place = GeoPoint::from_deg(latitude_deg, longitude_deg).unwrap();
        let observer_altitude_m = scene.ground(place).altitude_m() + 2.0;
        let sources = point_sources(place, &scene.source_pixels_within(place, FARTHEST_SOURCE_M));
        let directions: Vec<_> = stratified_samples(DIRECTIONS).into_iter().map(grid_direction).collect();
        let truth: Vec<[f64; 6]> = direct_sum(
            &atmospheres,
            &sources,
            observer_altitude_m,
            EmissionMix::garstang(),
            LampPreset::Mixed.lamp().flux_per_dnb_flux,
            &directions,
            &|| (),
        );
        for (turbidity, value) in TURBIDITIES.into_iter().enumerate() {
            let right = error(&engine, &scene, place, turbidity, observer_altitude_m, &truth);
            println!(
                "{latitude_deg} {longitude_deg}, {} sources, turbidity {}: {right:?}",
                sources.len(),
                value
            );
            assert!(right.mean < LARGEST_MEAN, "{latitude_deg} {longitude_deg}: {right:?}");
            // The check can fail: an observer 1500 m higher has another sky.
            let wrong = error(&engine, &scene, place, turbidity, observer_altitude_m + 1_500.0, &truth);
            assert!(wrong.mean > LARGEST_MEAN, "{wrong:?}");
        }
    }
}
