//! Panoramas of places in scenes against their reference solutions.

use crate::arguments::{Outcome, device};
use skyglow_bench::accuracy::zenith_and_horizontal;
use skyglow_lab::setup::{clear_sky, engine_of};
use skyglow_physics::{
    BAND_COUNT, GeoPoint, Turbidity,
    error_metric::{ErrorStatistics, relative_error},
};
use skyglow_render::{DeviceChoice, resident_tables};
use skyglow_scene::{SceneId, SceneStore};
use skyglow_tables::{Scattering, packs_in};
use std::{
    error::Error,
    path::{Path, PathBuf},
    sync::Arc,
};

/// One reference file.
struct Reference {
    scene: String,
    scattering: Scattering,
    place: GeoPoint,
    observer_altitude_m: f64,
    turbidities: Vec<f64>,
    samples: Vec<(usize, usize)>,
    radiance: Vec<Vec<f64>>,
    flux_dnb_w: f64,
}

fn read(path: &Path) -> Result<Reference, Box<dyn Error>> {
    let file = path.display();
    let json: serde_json::Value = serde_json::from_slice(&std::fs::read(path)?)?;
    let number = |name: &str| json[name].as_f64().ok_or(format!("{file}: {name} is missing"));
    Ok(Reference {
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

/// Panoramas against files of `reference` or `reference-multiple`: the error of `docs/model.md#error` at every place and turbidity, none
/// left out, as a table.
#[derive(Debug, clap::Args)]
pub(crate) struct Arguments {
    /// Folder of scenes.
    data: PathBuf,
    /// Folder of packs.
    packs: PathBuf,
    /// auto, gpu, lavapipe or cpu.
    #[arg(value_parser = device)]
    device: DeviceChoice,
    /// Reference files solutions.
    #[arg(required = true)]
    files: Vec<PathBuf>,
}

pub(crate) fn run(Arguments { data, packs, device, files }: &Arguments) -> Outcome {
    let (tables, _) = resident_tables(&packs_in(packs)?)?;
    let packs: Vec<(Scattering, f64)> = tables.iter().map(|t| (t.scattering, t.turbidity)).collect();
    let engine = engine_of(tables, *device)?;
    println!("executor {:?}, packs {packs:?}", engine.info().executor);
    println!(
        "place latitude longitude turbidity flux_dnb_w zenith_cd_m2 mean p99 max zenith_error horizontal_error"
    );
    let store = SceneStore::new(data);
    let mut every: Vec<f64> = Vec::new();
    let mut worst_mean: f64 = 0.0;
    for file in files {
        let reference = read(file)?;
        let scene = store.open(&SceneId::parse(&reference.scene)?)?;
        let polar = Arc::new(scene.polar_grid(reference.place, false));
        let comparable = packs.iter().filter(|pack| pack.0 == reference.scattering);
        let resident: Vec<f64> = comparable.map(|pack| pack.1).collect();
        let range = resident.iter().copied().fold(f64::INFINITY, f64::min)
            ..=resident.iter().copied().fold(0.0, f64::max);
        for (index, &turbidity) in reference.turbidities.iter().enumerate() {
            if !range.contains(&turbidity) {
                println!("{} {turbidity}: outside the resident range", file.display());
                continue;
            }
            let rendered = engine.render_blocking(clear_sky(
                polar.clone(),
                reference.observer_altitude_m,
                Turbidity::new(turbidity)?,
                reference.scattering,
            ))?;
            let mut errors = Vec::with_capacity(reference.samples.len());
            let (mut fast, mut exact) = (Vec::new(), Vec::new());
            for (&(row, column), radiance) in reference.samples.iter().zip(&reference.radiance) {
                let value = std::array::from_fn(|b| rendered.panorama.radiance_w_m2_sr(b, row, column));
                let reference = std::array::from_fn(|b| radiance[index * BAND_COUNT + b]);
                errors.push(relative_error(value, reference));
                fast.push(value);
                exact.push(reference);
            }
            let [zenith, horizontal] = zenith_and_horizontal(&reference.samples, &fast);
            let [true_zenith, true_horizontal] = zenith_and_horizontal(&reference.samples, &exact);
            let statistics = ErrorStatistics::of(errors.iter().copied()).ok_or("no directions")?;
            println!(
                "{} {:.4} {:.4} {turbidity} {:.3e} {true_zenith:.3e} {:.4} {:.4} {:.3} {:+.4} {:+.4}",
                file.file_stem().unwrap_or_default().to_string_lossy(),
                reference.place.latitude_deg(),
                reference.place.longitude_deg(),
                reference.flux_dnb_w,
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
