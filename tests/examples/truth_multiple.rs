//! The truth with all orders of scattering: adds what the first order leaves out to files of the `truth` example.
//!
//! `truth_multiple DATA_DIR TURBIDITIES OUT_DIR TRUTH_FILE...`: for those of the TURBIDITIES (such as `1.5,4`) that a
//! file holds, a file of the same name in OUT_DIR. A minute or two a place and turbidity: one field for every 300 m
//! of source altitude, solved for the place's own altitude.

use skyglow_physics::{
    Atmosphere, EmissionMix, GeoPoint, LampPreset, Turbidity,
    direct_sum::grid_direction,
    multiple_scattering::{DEFAULT_GROUND_ALBEDO, MultipleSum, Resolution, SumDensity},
    source_pixel::{FARTHEST_SOURCE_M, point_sources},
};
use skyglow_scene::{SceneId, SceneStore};
use skyglow_tests::lobe_truth::seven_digits;
use std::{error::Error, path::Path, time::Instant};

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().collect();
    let [_, data, wanted, out, files @ ..] = arguments.as_slice() else {
        return Err("usage: truth_multiple DATA_DIR TURBIDITIES OUT_DIR TRUTH_FILE...".into());
    };
    let wanted: Vec<f64> = wanted.split(',').map(str::parse).collect::<Result<_, _>>()?;
    std::fs::create_dir_all(out)?;
    let store = SceneStore::new(data);
    for file in files {
        let target = Path::new(out).join(Path::new(file).file_name().ok_or("a truth file has a name")?);
        if target.exists() {
            continue;
        }
        let mut json: serde_json::Value = serde_json::from_slice(&std::fs::read(file)?)?;
        let number = |name: &str| json[name].as_f64().ok_or(format!("{file}: {name} is missing"));
        let place = GeoPoint::from_deg(number("latitude_deg")?, number("longitude_deg")?)?;
        let observer_altitude_m = number("observer_altitude_m")?;
        let id = json["scene"].as_str().ok_or("scene is missing")?;
        let scene = store.open(&SceneId::parse(id)?)?;
        let sources = point_sources(place, &scene.source_pixels_within(place, FARTHEST_SOURCE_M));
        let samples: Vec<(usize, usize)> = serde_json::from_value(json["samples"].clone())?;
        let directions: Vec<_> = samples.iter().map(|&sample| grid_direction(sample)).collect();
        let first: Vec<Vec<f64>> = serde_json::from_value(json["radiance"].clone())?;
        let held: Vec<f64> = serde_json::from_value(json["turbidities"].clone())?;
        let mut radiance = vec![Vec::new(); samples.len()];
        let mut turbidities = Vec::new();
        for (index, turbidity) in held.into_iter().enumerate().filter(|(_, t)| wanted.contains(t)) {
            let start = Instant::now();
            let sum = MultipleSum {
                atmosphere: Atmosphere::new(Turbidity::new(turbidity)?),
                ground_albedo: DEFAULT_GROUND_ALBEDO,
                observer_altitude_m,
                emission: EmissionMix::garstang(),
                resolution: Resolution::table(),
                density: SumDensity::default(),
            };
            let more = sum.radiance(&sources, LampPreset::Mixed.lamp().flux_per_dnb_flux, &directions)?;
            for ((radiance, first), more) in radiance.iter_mut().zip(&first).zip(more) {
                radiance.extend((0..3).map(|band| seven_digits(first[index * 3 + band] + more[band])));
            }
            turbidities.push(turbidity);
            println!("{file} turbidity {turbidity}: {:.0} s", start.elapsed().as_secs_f64());
        }
        json["scattering"] = "multiple".into();
        json["ground_albedo"] = DEFAULT_GROUND_ALBEDO.into();
        json["turbidities"] = serde_json::to_value(turbidities)?;
        json["radiance"] = serde_json::to_value(radiance)?;
        std::fs::write(&target, serde_json::to_string(&json)?)?;
    }
    Ok(())
}
