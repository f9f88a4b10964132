//! First-order reference solutions at places of a scene.

use crate::arguments::{Outcome, SceneArguments, place};
use skyglow_lab::{lobe_reference::seven_digits, places::places};
use skyglow_physics::{
    Atmosphere, BAND_COUNT, EmissionMix, GeoPoint, Turbidity,
    direct_sum::{direct_sum, grid_direction, stratified_samples},
    source_pixel::{MAX_SOURCE_DISTANCE_M, point_sources},
};
use skyglow_scene::Scene;
use std::{error::Error, path::PathBuf, time::Instant};

/// The first-order sum over every pixel at places of a scene, for several turbidities at once, slow: a JSON file a place,
/// which `accuracy` compares panoramas with. Files that are there stay.
#[derive(Debug, clap::Args)]
pub(crate) struct Arguments {
    #[command(flatten)]
    scene: SceneArguments,
    /// How many places spread over the scene, or a list such as `48.2,14.6;42.6,7` of latitudes and longitudes.
    places: String,
    /// Directions a place.
    directions: usize,
    /// Folder for the files; each choice of turbidities needs its own.
    out: PathBuf,
    /// Which turbidities.
    #[arg(long, value_enum, default_value_t = Choice::All)]
    turbidities: Choice,
}

/// Sets of turbidities.
#[derive(Clone, Copy, Debug, clap::ValueEnum)]
enum Choice {
    /// 1.5, 2, 2.5, 3.5, 4, 4.75, 6.
    All,
    /// 1.5, 4, 6, in about half the time.
    Few,
    /// All but those few.
    Rest,
    /// 1.75 and 4, which lie between packs.
    Between,
}

pub(crate) fn run(arguments: &Arguments) -> Outcome {
    match arguments.turbidities {
        Choice::All => reference::<{ 7 * BAND_COUNT }>(&[1.5, 2.0, 2.5, 3.5, 4.0, 4.75, 6.0], arguments),
        Choice::Few => reference::<{ 3 * BAND_COUNT }>(&[1.5, 4.0, 6.0], arguments),
        Choice::Rest => reference::<{ 4 * BAND_COUNT }>(&[2.0, 2.5, 3.5, 4.75], arguments),
        Choice::Between => reference::<{ 2 * BAND_COUNT }>(&[1.75, 4.0], arguments),
    }
}

/// The places that the argument asks for.
fn wanted_places(scene: &Scene, wanted: &str) -> Result<Vec<GeoPoint>, Box<dyn Error>> {
    if let Ok(count) = wanted.parse() {
        return Ok(places(scene, count));
    }
    wanted.split(';').map(place).collect::<Result<_, _>>().map_err(|error| error as Box<dyn Error>)
}

/// `SLOTS` is the bands times the turbidities.
fn reference<const SLOTS: usize>(turbidities: &[f64], arguments: &Arguments) -> Outcome {
    let Arguments { scene, places, directions, out, .. } = arguments;
    let (id, scene) = (scene.scene.as_str(), scene.open()?);
    let atmospheres =
        turbidities.iter().map(|&t| Turbidity::new(t).map(Atmosphere::new)).collect::<Result<Vec<_>, _>>()?;
    let samples = stratified_samples(*directions);
    std::fs::create_dir_all(out)?;
    for (index, place) in wanted_places(&scene, places)?.into_iter().enumerate() {
        let file = out.join(format!("{id}-{index:02}.json"));
        if file.exists() {
            continue;
        }
        let start = Instant::now();
        let observer_altitude_m = scene.ground(place).altitude_m() + 2.0;
        let pixels = scene.source_pixels_within(place, MAX_SOURCE_DISTANCE_M);
        let sources = point_sources(place, &pixels);
        let view: Vec<_> = samples.iter().map(|&sample| grid_direction(sample)).collect();
        let radiance: Vec<[f64; SLOTS]> = direct_sum(
            &atmospheres,
            &sources,
            observer_altitude_m,
            EmissionMix::garstang(),
            skyglow_bench::options::REFERENCE_FLUX,
            &view,
            &|| (),
        );
        let seconds = start.elapsed().as_secs_f64();
        let text = serde_json::to_string(&serde_json::json!({
            "scene": id, "scene_version": scene.metadata().version, "latitude_deg": place.latitude_deg(), "longitude_deg": place.longitude_deg(),
            "observer_altitude_m": observer_altitude_m, "turbidities": turbidities, "sources": sources.len(),
            "flux_dnb_w": sources.iter().map(|s| s.flux_dnb_w).sum::<f64>(), "seconds": seconds,
            "samples": samples, "radiance": radiance.iter().map(|r| r.map(seven_digits).to_vec()).collect::<Vec<_>>(),
        }))?;
        std::fs::write(&file, text)?;
        println!("{} {place:?}: {} sources, {seconds:.0} s", file.display(), sources.len());
    }
    Ok(())
}
