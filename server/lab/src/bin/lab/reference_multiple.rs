//! Reference solutions of all orders of scattering at places of a scene.

use crate::arguments::{List, Outcome};
use skyglow_lab::{lobe_reference::seven_digits, setup::later_orders};
use skyglow_physics::{
    BAND_COUNT, GeoPoint, Turbidity,
    direct_sum::grid_direction,
    multiple_scattering::DEFAULT_GROUND_ALBEDO,
    source_pixel::{MAX_SOURCE_DISTANCE_M, point_sources},
};
use skyglow_scene::{SceneId, SceneStore};
use std::{path::PathBuf, time::Instant};

/// Adds the later orders of scattering to files of `reference`: for those of the turbidities that a file holds, a file of the
/// same name. A minute or two a place and turbidity: one field for every 300 m of source altitude, solved for the place's
/// own altitude.
#[derive(Debug, clap::Args)]
pub(crate) struct Arguments {
    /// Folder of scenes.
    data: PathBuf,
    /// Turbidities, such as `1.5,4`.
    turbidities: List<f64>,
    /// Folder for the files.
    out: PathBuf,
    /// Files of `reference`.
    #[arg(required = true)]
    files: Vec<PathBuf>,
}

pub(crate) fn run(Arguments { data, turbidities: wanted, out, files }: &Arguments) -> Outcome {
    std::fs::create_dir_all(out)?;
    let store = SceneStore::new(data);
    for path in files {
        let file = path.display();
        let target = out.join(path.file_name().ok_or("a reference file has a name")?);
        if target.exists() {
            continue;
        }
        let mut json: serde_json::Value = serde_json::from_slice(&std::fs::read(path)?)?;
        let number = |name: &str| json[name].as_f64().ok_or(format!("{file}: {name} is missing"));
        let place = GeoPoint::from_deg(number("latitude_deg")?, number("longitude_deg")?)?;
        let observer_altitude_m = number("observer_altitude_m")?;
        let id = json["scene"].as_str().ok_or("scene is missing")?;
        let scene = store.open(&SceneId::parse(id)?)?;
        let sources = point_sources(place, &scene.source_pixels_within(place, MAX_SOURCE_DISTANCE_M));
        let samples: Vec<(usize, usize)> = serde_json::from_value(json["samples"].clone())?;
        let directions: Vec<_> = samples.iter().map(|&sample| grid_direction(sample)).collect();
        let first: Vec<Vec<f64>> = serde_json::from_value(json["radiance"].clone())?;
        let held: Vec<f64> = serde_json::from_value(json["turbidities"].clone())?;
        let mut radiance = vec![Vec::new(); samples.len()];
        let mut turbidities = Vec::new();
        for (index, turbidity) in held.into_iter().enumerate().filter(|(_, t)| wanted.0.contains(t)) {
            let start = Instant::now();
            let sum = later_orders(Turbidity::new(turbidity)?, observer_altitude_m);
            let more = sum.radiance(&sources, skyglow_bench::options::REFERENCE_FLUX, &directions)?;
            for ((radiance, first), more) in radiance.iter_mut().zip(&first).zip(more) {
                radiance.extend(
                    (0..BAND_COUNT).map(|band| seven_digits(first[index * BAND_COUNT + band] + more[band])),
                );
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
