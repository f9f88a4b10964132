//! Whole skies from the packs that come with the program, against stored reference: the sum over every pixel, all orders of
//! scattering (`lab reference`, then `lab reference-multiple`).
#![allow(clippy::unwrap_used, clippy::expect_used, reason = "what cannot be set up fails the test")]

mod common;

use skyglow_lab::setup::open_sky;
use skyglow_observatory::{BrightnessRequest, MapLight, MapMeasure, Observatory, SkyRequest};
use skyglow_physics::{
    BAND_COUNT, ELEVATION_COUNT, EmissionMix, GeoPoint, LampPreset, Response, Turbidity,
    error_metric::{ErrorStatistics, relative_error},
    photometry::luminance_cd_m2,
    source_pixel::{MAX_SOURCE_DISTANCE_M, point_sources},
};
use skyglow_render::{Engine, RenderRequest};
use skyglow_scene::{Scene, SceneId};
use skyglow_tables::Scattering;
use skyglow_tests::tree;
use std::{
    path::PathBuf,
    sync::{Arc, LazyLock},
};

static OBSERVATORY: LazyLock<Observatory> = LazyLock::new(|| common::demo("accuracy"));

/// Largest mean error allowed at any place and turbidity.
const MAX_MEAN_ERROR: f64 = 0.01;
/// Largest error of the luminance in the highest row, where it is a thousandth of the natural sky or more.
const MAX_ZENITH_ERROR: f64 = 0.005;
/// A thousandth of the natural sky, cd m⁻².
const VISIBLE_CD_M2: f64 = 1.7e-7;

/// A reference file.
#[derive(serde::Deserialize)]
struct StoredReference {
    scattering: Scattering,
    latitude_deg: f64,
    longitude_deg: f64,
    observer_altitude_m: f64,
    sources: usize,
    flux_dnb_w: f64,
    turbidities: Vec<f64>,
    samples: Vec<(usize, usize)>,
    radiance: Vec<Vec<f64>>,
}

impl StoredReference {
    fn place(&self) -> GeoPoint {
        GeoPoint::from_deg(self.latitude_deg, self.longitude_deg).unwrap()
    }

    /// Radiance of the bands at a sample.
    fn bands(&self, sample: usize, turbidity: usize) -> [f64; BAND_COUNT] {
        std::array::from_fn(|band| self.radiance[sample][turbidity * BAND_COUNT + band])
    }
}

fn reference_files() -> Vec<PathBuf> {
    let mut files: Vec<_> = std::fs::read_dir(tree::root().join("tests/reference"))
        .unwrap()
        .map(|entry| entry.unwrap().path())
        .filter(|path| path.extension().is_some_and(|extension| extension == "json"))
        .collect();
    files.sort();
    assert!(!files.is_empty());
    files
}

/// Error statistics over the directions, and the largest relative error of the luminance in the highest row.
fn compare(
    engine: &Engine,
    scene: &Scene,
    reference: &StoredReference,
    turbidity: usize,
    raised_m: f64,
) -> (ErrorStatistics, f64) {
    let rendered = engine
        .render_blocking(RenderRequest {
            polar: Arc::new(scene.polar_grid(reference.place(), false)),
            observer_altitude_m: reference.observer_altitude_m + raised_m,
            turbidity: Turbidity::new(reference.turbidities[turbidity]).unwrap(),
            scattering: reference.scattering,
            cloud_base_m: None,
            emission: EmissionMix::garstang(),
            flux_per_dnb_flux: skyglow_bench::options::REFERENCE_FLUX,
            basis: None,
        })
        .unwrap();
    let mut zenith: f64 = 0.0;
    let errors: Vec<f64> = reference
        .samples
        .iter()
        .enumerate()
        .map(|(sample, &(row, column))| {
            let fast = std::array::from_fn(|band| rendered.panorama.radiance_w_m2_sr(band, row, column));
            let exact = reference.bands(sample, turbidity);
            let luminance = luminance_cd_m2(exact);
            if row == ELEVATION_COUNT - 1 && luminance > VISIBLE_CD_M2 {
                zenith = zenith.max((luminance_cd_m2(fast) / luminance - 1.0).abs());
            }
            relative_error(fast, exact)
        })
        .collect();
    (ErrorStatistics::of(errors).unwrap(), zenith)
}

/// Skies of the demo are those of the stored reference solutions.
#[test]
fn demo_skies_match_the_stored_reference() {
    let view = OBSERVATORY.view(&SceneId::parse("demo").unwrap(), None).unwrap();
    let scene = view.scene();
    let engine = OBSERVATORY.engine();
    for path in reference_files() {
        let name = path.file_name().unwrap().to_string_lossy().into_owned();
        let reference: StoredReference = serde_json::from_slice(&std::fs::read(&path).unwrap()).unwrap();
        let pixels = scene.source_pixels_within(reference.place(), MAX_SOURCE_DISTANCE_M);
        let sources = point_sources(reference.place(), &pixels);
        let flux_dnb_w: f64 = sources.iter().map(|source| source.flux_dnb_w).sum();
        assert!(
            sources.len() == reference.sources && (flux_dnb_w / reference.flux_dnb_w - 1.0).abs() < 1e-9,
            "{name}: the demo has changed; make the reference anew (see `lab reference`)"
        );
        for (index, turbidity) in reference.turbidities.iter().enumerate() {
            let (error, zenith) = compare(engine, scene, &reference, index, 0.0);
            println!("{name} turbidity {turbidity}: {error:?}, zenith {zenith:.4}");
            assert!(error.mean < MAX_MEAN_ERROR, "{name} turbidity {turbidity}: {error:?}");
            assert!(zenith < MAX_ZENITH_ERROR, "{name} turbidity {turbidity}: zenith {zenith}");
            // The check can fail: an observer 1 500 m higher has another sky.
            let (wrong, _) = compare(engine, scene, &reference, index, 1_500.0);
            assert!(wrong.mean > 2.0 * error.mean, "{name} turbidity {turbidity}: {wrong:?}");
        }
    }
}

/// A map of every place against the skies of single places, at the zenith with light behind skylines hidden, on the ground without
/// terrain, and under clouds: what far light taken together and tables between altitudes cost.
#[test]
fn each_place_is_that_of_its_panorama() {
    let id = SceneId::parse("demo").unwrap();
    // At a pack and between packs.
    for (turbidity, max_places, measure, cloud_base_m) in [
        (2.5, 20_000, MapMeasure::Zenith, None),
        (3.0, 5_000, MapMeasure::Zenith, None),
        (2.5, 5_000, MapMeasure::Mean, None),
        (2.5, 5_000, MapMeasure::Horizontal, None),
        (2.5, 5_000, MapMeasure::Horizontal, Some(3_000)),
        (2.5, 5_000, MapMeasure::Zenith, Some(1_500)),
    ] {
        let turbidity = Turbidity::new(turbidity).unwrap();
        let request = BrightnessRequest {
            cloud_base_m,
            scene: id.clone(),
            scenario: None,
            turbidity,
            scattering: Scattering::Multiple,
            lamp: LampPreset::Mixed.lamp(),
            measure,
            light: MapLight::Artificial,
            response: Response::Photopic,
            emission: EmissionMix::garstang().into(),
            terrain_hides: measure == MapMeasure::Zenith,
            max_places,
        };
        let map = OBSERVATORY.brightness(&request, &|_: f64| true).unwrap();
        let lattice = map.places().lattice();
        let mut errors: Vec<f64> = (0..lattice.len())
            .step_by(lattice.len() / 60)
            .filter_map(|at| {
                let (column, row) = (at as u32 % lattice.columns, at as u32 / lattice.columns);
                let place = map.open_scene().lattice_place(lattice, column, row);
                let sky = SkyRequest {
                    cloud_base_m,
                    terrain_hides: request.terrain_hides,
                    ..open_sky(id.clone(), place, turbidity)
                };
                let sky = OBSERVATORY.sky_blocking(&sky);
                let of_map = f64::from(map.places().values()[at]);
                // Ground at the clouds has no value in either.
                assert_eq!(sky.is_ok(), of_map.is_finite(), "{place:?}");
                let found = sky.ok()?.quantities;
                let wanted = match measure {
                    MapMeasure::Zenith => found.zenith_luminance_cd_m2,
                    MapMeasure::Mean => found.mean_luminance_cd_m2,
                    _ => found.horizontal_illuminance_lx,
                };
                (wanted > 1.7e-8).then(|| (of_map / wanted - 1.0).abs())
            })
            .collect();
        errors.sort_by(f64::total_cmp);
        let (median, largest) = (errors[errors.len() / 2], errors[errors.len() - 1]);
        println!(
            "{measure:?}, turbidity {}, clouds {cloud_base_m:?}: {median:.5} in the median, {largest:.5} at most",
            turbidity.value()
        );
        // Beside a lamp most light is low in the sky, and its distance counts to the metre.
        let most = if measure == MapMeasure::Zenith { 0.03 } else { 0.08 };
        // Under clouds lights near the base count by their depth, which blocks of lights blur.
        let most_in_median = if cloud_base_m.is_some() { 0.006 } else { 0.003 };
        assert!(median <= most_in_median && largest <= most, "{median} {largest}");
    }
}
