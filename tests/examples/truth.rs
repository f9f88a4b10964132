//! The truth at random places of a scene, for several turbidities at once: slow, written to a file that the
//! `accuracy` example compares panoramas with.
//!
//! `truth DATA_DIR SCENE PLACES DIRECTIONS OUT_DIR [few|rest|between]`: one JSON file a place; files that are there are
//! kept.
//! PLACES is how many random ones, or a list such as `48.2,14.6;42.6,7` of latitudes and longitudes. `few` takes three
//! turbidities instead of seven, in about half the time; `rest` the others, and `between` the two that lie between packs.
//! Each of these choices needs a folder of its own.

use skyglow_physics::{
    Atmosphere, EmissionMix, GeoPoint, LampPreset, Turbidity,
    direct_sum::{direct_sum, grid_direction, stratified_samples},
    source_pixel::{FARTHEST_SOURCE_M, point_sources},
};
use skyglow_scene::{Scene, SceneId, SceneStore};
use skyglow_tests::{lobe_truth::seven_digits, places::places};
use std::{error::Error, path::Path, time::Instant};

/// The packs' turbidities and one between them.
const TURBIDITIES: [f64; 7] = [1.5, 2.0, 2.5, 3.5, 4.0, 4.75, 6.0];
/// Two packs and one between.
const FEW_TURBIDITIES: [f64; 3] = [1.5, 4.0, 6.0];
/// The others.
const REST_TURBIDITIES: [f64; 4] = [2.0, 2.5, 3.5, 4.75];

/// Those between packs.
const BETWEEN_TURBIDITIES: [f64; 2] = [1.75, 4.0];

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().collect();
    match arguments.as_slice() {
        [_, data, id, count, directions, out] => {
            truth::<21>(&TURBIDITIES, data, id, count, directions.parse()?, out)
        }
        [_, data, id, count, directions, out, few] if few == "few" => {
            truth::<9>(&FEW_TURBIDITIES, data, id, count, directions.parse()?, out)
        }
        [_, data, id, count, directions, out, rest] if rest == "rest" => {
            truth::<12>(&REST_TURBIDITIES, data, id, count, directions.parse()?, out)
        }
        [_, data, id, count, directions, out, between] if between == "between" => {
            truth::<6>(&BETWEEN_TURBIDITIES, data, id, count, directions.parse()?, out)
        }
        _ => Err("usage: truth DATA_DIR SCENE PLACES DIRECTIONS OUT_DIR [few|rest|between]".into()),
    }
}

/// The places that the argument asks for.
fn wanted_places(scene: &Scene, wanted: &str) -> Result<Vec<GeoPoint>, Box<dyn Error>> {
    if let Ok(count) = wanted.parse() {
        return Ok(places(scene, count));
    }
    wanted
        .split(';')
        .map(|place| {
            let (latitude, longitude) = place.split_once(',').ok_or("PLACES: a number or LAT,LON;LAT,LON")?;
            Ok(GeoPoint::from_deg(latitude.parse()?, longitude.parse()?)?)
        })
        .collect()
}

/// `SLOTS` is three bands times the turbidities.
fn truth<const SLOTS: usize>(
    turbidities: &[f64],
    data: &str,
    id: &str,
    wanted: &str,
    directions: usize,
    out: &str,
) -> Result<(), Box<dyn Error>> {
    let scene = SceneStore::new(data).open(&SceneId::parse(id)?)?;
    let atmospheres =
        turbidities.iter().map(|&t| Turbidity::new(t).map(Atmosphere::new)).collect::<Result<Vec<_>, _>>()?;
    let samples = stratified_samples(directions);
    std::fs::create_dir_all(out)?;
    for (index, place) in wanted_places(&scene, wanted)?.into_iter().enumerate() {
        let file = Path::new(out).join(format!("{id}-{index:02}.json"));
        if file.exists() {
            continue;
        }
        let start = Instant::now();
        let observer_altitude_m = scene.ground(place).altitude_m() + 2.0;
        let pixels = scene.source_pixels_within(place, FARTHEST_SOURCE_M);
        let sources = point_sources(place, &pixels);
        let view: Vec<_> = samples.iter().map(|&sample| grid_direction(sample)).collect();
        let radiance: Vec<[f64; SLOTS]> = direct_sum(
            &atmospheres,
            &sources,
            observer_altitude_m,
            EmissionMix::garstang(),
            LampPreset::Mixed.lamp().flux_per_dnb_flux,
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
