//! Whole skies of classes of places by the engine on the CPU against their truth: sampling, interpolation and compression
//! all count.
//!
//! `class_accuracy PACKS_DIR TRUTH_DIR [basis=N] [data=DATA_DIR] [every]`: TRUTH_DIR holds files of `class_truth` and
//! `place_truth`; those of places in a scene need DATA_DIR. For every class, and every mix of lobes in it, the worst over
//! observers and turbidities of the mean, the 99th percentile, the zenith and the horizontal illuminance, and which limit
//! is missed; with `every` a line for each sky too. A class is lit such that its zenith is as bright as the natural sky,
//! places as their raster says.

use skyglow_bench::{accuracy::zenith_and_horizontal, scenes::grid_under_open_sky};
use skyglow_engine::{DeviceChoice, Engine, EngineConfig, RenderRequest};
use skyglow_physics::{
    BAND_COUNT, EmissionMix, GeoPoint, LampPreset, Turbidity, photometry::natural_sky_luminance_cd_m2,
};
use skyglow_scene::{PolarGrid, RING_COUNT, SceneId, SceneStore, ring_distance_m};
use skyglow_tables::{Pack, Scattering, packs_in};
use skyglow_tests::{
    class_scenes::Class,
    lobe_truth::LobeTruth,
    sky_errors::{SkyErrors, mixes, sky_errors},
};
use std::{
    collections::BTreeMap,
    error::Error,
    path::{Path, PathBuf},
    sync::Arc,
};

/// What is wanted of the mean, the 99th percentile, the zenith and the horizontal illuminance, and their names.
const LIMITS: [(f64, &str); 4] = [(0.01, "mean"), (0.05, "99 %"), (0.005, "zenith"), (0.005, "horizontal")];

/// What was asked for.
struct Options {
    basis: Option<usize>,
    data: Option<PathBuf>,
    every: bool,
}

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().collect();
    let [_, packs, truths, rest @ ..] = arguments.as_slice() else {
        return Err("usage: class_accuracy PACKS_DIR TRUTH_DIR [basis=N] [data=DATA_DIR] [every]".into());
    };
    let mut options = Options { basis: None, data: None, every: false };
    for argument in rest {
        match argument.split_once('=') {
            Some(("basis", count)) => options.basis = Some(count.parse()?),
            Some(("data", folder)) => options.data = Some(folder.into()),
            None if argument == "every" => options.every = true,
            _ => return Err(format!("{argument}: expected basis=N, data=DATA_DIR or every").into()),
        }
    }
    let rings: Vec<f64> = (0..RING_COUNT).map(ring_distance_m).collect();
    let tables = packs_in(Path::new(packs))?
        .iter()
        .map(|path| Pack::open(path).map(|pack| Arc::new(pack.resident(&rings))))
        .collect::<Result<Vec<_>, _>>()?;
    let engine =
        Engine::start(EngineConfig { device: DeviceChoice::Cpu, tables, ..EngineConfig::default() })?;
    let mut files: Vec<PathBuf> =
        std::fs::read_dir(truths)?.map(|entry| Ok(entry?.path())).collect::<std::io::Result<_>>()?;
    files.retain(|path| path.extension().is_some_and(|extension| extension == "json"));
    files.sort();
    println!("# all in %: mean, 99 %, zenith, horizontal illuminance; limits 1, 5, 0.5, 0.5");
    let mut worst: BTreeMap<(String, &str), SkyErrors> = BTreeMap::new();
    for path in files {
        let truth: LobeTruth = serde_json::from_slice(&std::fs::read(&path)?)?;
        let polar = polar_grid(&truth, options.data.as_deref())?;
        for (mix, emission) in mixes() {
            let errors = errors(&engine, &truth, &polar, emission, options.basis)?;
            if options.every {
                let sky =
                    format!("{} {:.0} m T {:.2}", truth.name, truth.observer_altitude_m, truth.turbidity);
                print_line(&sky, mix, errors);
            }
            let kept = worst.entry((truth.name.clone(), mix)).or_default();
            kept.iter_mut().zip(errors).for_each(|(kept, error)| *kept = larger(*kept, error));
        }
    }
    println!("# the worst over observers and turbidities");
    let mut classes: BTreeMap<&str, SkyErrors> = BTreeMap::new();
    for ((name, mix), errors) in &worst {
        print_line(name, mix, *errors);
        let kept = classes.entry(name).or_default();
        kept.iter_mut().zip(errors).for_each(|(kept, error)| *kept = larger(*kept, *error));
    }
    println!("# the worst over mixes too");
    for (name, errors) in classes {
        print_line(name, "all", errors);
    }
    Ok(())
}

/// The one farther from 0.
fn larger(a: f64, b: f64) -> f64 {
    if b.abs() > a.abs() { b } else { a }
}

fn print_line(name: &str, mix: &str, errors: SkyErrors) {
    let missed: Vec<&str> = LIMITS
        .iter()
        .zip(errors)
        .filter(|((limit, _), error)| error.abs() > *limit)
        .map(|((_, name), _)| *name)
        .collect();
    let [mean, p99, zenith, horizontal] = errors.map(|error| 100.0 * error);
    println!("{name:36} {mix:9} {mean:7.3} {p99:8.3} {zenith:+8.3} {horizontal:+8.3}  {}", missed.join(", "));
}

/// The light that the engine gets.
fn polar_grid(truth: &LobeTruth, data: Option<&Path>) -> Result<PolarGrid, Box<dyn Error>> {
    let grid = match truth.place_deg {
        Some([latitude_deg, longitude_deg]) => {
            let data = data.ok_or("a truth of a place in a scene: data=DATA_DIR is missing")?;
            let scene = SceneStore::new(data).open(&SceneId::parse(&truth.name)?)?;
            scene.polar_grid(GeoPoint::from_deg(latitude_deg, longitude_deg)?, false)
        }
        None => {
            let class = Class::from_name(&truth.name).ok_or("a truth of no known class")?;
            let scenes = class.scenes();
            let same = scenes.iter().find(|scene| scene.observer_altitude_m == truth.observer_altitude_m);
            grid_under_open_sky(&same.ok_or("a truth of no known observer")?.sources)
        }
    };
    if (grid.flux_dnb_w / truth.flux_dnb_w - 1.0).abs() > 1e-3 {
        return Err(format!(
            "{}: {} DNB watts, the truth has {}",
            truth.name, grid.flux_dnb_w, truth.flux_dnb_w
        )
        .into());
    }
    Ok(grid)
}

fn errors(
    engine: &Engine,
    truth: &LobeTruth,
    grid: &PolarGrid,
    emission: EmissionMix,
    basis: Option<usize>,
) -> Result<SkyErrors, Box<dyn Error>> {
    let flux_per_dnb_flux = LampPreset::Mixed.lamp().flux_per_dnb_flux;
    let mut exact = truth.mixed_w_m2_sr(emission, flux_per_dnb_flux);
    let mut grid = grid.clone();
    if truth.place_deg.is_none() {
        let scale = natural_sky_luminance_cd_m2() / zenith_and_horizontal(&truth.samples, &exact)[0];
        exact.as_flattened_mut().iter_mut().for_each(|value| *value *= scale);
        grid.cells.iter_mut().for_each(|cell| cell.flux_dnb_w *= scale as f32);
        grid.flux_dnb_w *= scale;
    }
    let rendered = engine.render_blocking(RenderRequest {
        polar: Arc::new(grid),
        observer_altitude_m: truth.observer_altitude_m,
        turbidity: Turbidity::new(truth.turbidity)?,
        scattering: Scattering::Multiple,
        cloud_base_m: None,
        emission,
        flux_per_dnb_flux,
        basis,
    })?;
    let fast: Vec<[f64; BAND_COUNT]> = truth
        .samples
        .iter()
        .map(|&(row, column)| std::array::from_fn(|b| rendered.panorama.radiance_w_m2_sr(b, row, column)))
        .collect();
    Ok(sky_errors(&truth.samples, &fast, &exact).ok_or("no directions")?)
}
