//! Panoramas against the truth files of the `truth` example: the error of `docs/model.md#error` at every place and
//! turbidity, none left out.
//!
//! `accuracy DATA_DIR PACKS_DIR auto|gpu|lavapipe|cpu TRUTH_FILE...`: a table on stdout.

use skyglow_bench::accuracy::zenith_and_horizontal;
use skyglow_physics::{
    EmissionMix, GeoPoint, LampPreset, Turbidity,
    error_metric::{ErrorStatistics, relative_error},
};
use skyglow_render::{DeviceChoice, Engine, EngineConfig, RenderRequest};
use skyglow_scene::{RING_COUNT, SceneId, SceneStore, ring_distance_m};
use skyglow_tables::{Pack, Scattering, packs_in};
use std::{error::Error, path::Path, sync::Arc};

/// One truth file.
struct Truth {
    scene: String,
    scattering: Scattering,
    place: GeoPoint,
    observer_altitude_m: f64,
    turbidities: Vec<f64>,
    samples: Vec<(usize, usize)>,
    radiance: Vec<Vec<f64>>,
    flux_dnb_w: f64,
}

fn read(path: &str) -> Result<Truth, Box<dyn Error>> {
    let json: serde_json::Value = serde_json::from_slice(&std::fs::read(path)?)?;
    let number = |name: &str| json[name].as_f64().ok_or(format!("{path}: {name} is missing"));
    Ok(Truth {
        scene: json["scene"].as_str().ok_or("scene is missing")?.to_owned(),
        // Files without it hold first-order light.
        scattering: match json.get("scattering") {
            Some(value) => serde_json::from_value(value.clone())?,
            None => Scattering::Single,
        },
        place: GeoPoint::from_deg(number("latitude_deg")?, number("longitude_deg")?)?,
        observer_altitude_m: number("observer_altitude_m")?,
        turbidities: serde_json::from_value(json["turbidities"].clone())?,
        samples: serde_json::from_value(json["samples"].clone())?,
        radiance: serde_json::from_value(json["radiance"].clone())?,
        flux_dnb_w: number("flux_dnb_w")?,
    })
}

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().collect();
    let [_, data, packs, device, files @ ..] = arguments.as_slice() else {
        return Err("usage: accuracy DATA_DIR PACKS_DIR DEVICE TRUTH_FILE...".into());
    };
    let rings: Vec<f64> = (0..RING_COUNT).map(ring_distance_m).collect();
    let tables = packs_in(Path::new(packs))?
        .iter()
        .map(|path| Pack::open(path).map(|pack| Arc::new(pack.resident(&rings))))
        .collect::<Result<Vec<_>, _>>()?;
    let device = DeviceChoice::from_name(device).ok_or("device: auto, gpu, lavapipe or cpu")?;
    let packs: Vec<(Scattering, f64)> = tables.iter().map(|t| (t.scattering, t.turbidity)).collect();
    let engine = Engine::start(EngineConfig { device, tables, ..EngineConfig::default() })?;
    println!("executor {:?}, packs {packs:?}", engine.info().executor);
    println!(
        "place latitude longitude turbidity flux_dnb_w zenith_cd_m2 mean p99 max zenith_error horizontal_error"
    );
    let store = SceneStore::new(data);
    let mut every: Vec<f64> = Vec::new();
    let mut worst_mean: f64 = 0.0;
    for file in files {
        let truth = read(file)?;
        let scene = store.open(&SceneId::parse(&truth.scene)?)?;
        let polar = Arc::new(scene.polar_grid(truth.place, false));
        let comparable = packs.iter().filter(|pack| pack.0 == truth.scattering);
        let resident: Vec<f64> = comparable.map(|pack| pack.1).collect();
        let range = resident.iter().copied().fold(f64::INFINITY, f64::min)
            ..=resident.iter().copied().fold(0.0, f64::max);
        for (index, &turbidity) in truth.turbidities.iter().enumerate() {
            if !range.contains(&turbidity) {
                println!("{file} {turbidity}: outside the resident range");
                continue;
            }
            let rendered = engine.render_blocking(RenderRequest {
                polar: polar.clone(),
                observer_altitude_m: truth.observer_altitude_m,
                turbidity: Turbidity::new(turbidity)?,
                scattering: truth.scattering,
                cloud_base_m: None,
                emission: EmissionMix::garstang(),
                flux_per_dnb_flux: LampPreset::Mixed.lamp().flux_per_dnb_flux,
                basis: None,
            })?;
            let mut errors = Vec::with_capacity(truth.samples.len());
            let (mut fast, mut exact) = (Vec::new(), Vec::new());
            for (&(row, column), radiance) in truth.samples.iter().zip(&truth.radiance) {
                let value = std::array::from_fn(|b| rendered.panorama.radiance_w_m2_sr(b, row, column));
                let reference = std::array::from_fn(|b| radiance[index * 3 + b]);
                errors.push(relative_error(value, reference));
                fast.push(value);
                exact.push(reference);
            }
            let [zenith, horizontal] = zenith_and_horizontal(&truth.samples, &fast);
            let [true_zenith, true_horizontal] = zenith_and_horizontal(&truth.samples, &exact);
            let statistics = ErrorStatistics::of(errors.iter().copied()).ok_or("no directions")?;
            println!(
                "{} {:.4} {:.4} {turbidity} {:.3e} {true_zenith:.3e} {:.4} {:.4} {:.3} {:+.4} {:+.4}",
                Path::new(file).file_stem().unwrap_or_default().to_string_lossy(),
                truth.place.latitude_deg(),
                truth.place.longitude_deg(),
                truth.flux_dnb_w,
                statistics.mean,
                statistics.p99,
                statistics.maximum,
                zenith / true_zenith - 1.0,
                horizontal / true_horizontal - 1.0,
            );
            worst_mean = worst_mean.max(statistics.mean);
            every.extend(errors);
        }
    }
    if let Some(all) = ErrorStatistics::of(every) {
        println!("all: {all:?}; worst mean of a place and turbidity {worst_mean:.4}");
    }
    Ok(())
}
