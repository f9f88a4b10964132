//! The truth of places spread over a scene, every lobe apart, for the `class_accuracy` example.
//!
//! `place_truth DATA_DIR SCENE OUT_DIR PLACES DIRECTIONS SHARE TURBIDITY,… [later]`: one packed JSON file a place, files that are there are
//! kept, with `later` their first order (and no place is added); place after place takes the next of the turbidities. All the places of one turbidity share what fields do not depend
//! on the observer. Sources in one bin, SHARE of their distance deep and wide, are one (0 sums every source).

use skyglow_physics::{
    GeoPoint, PointSource, Turbidity,
    direct_sum::stratified_samples,
    source_pixel::{FARTHEST_SOURCE_M, point_sources},
};
use skyglow_scene::{Scene, SceneId, SceneStore};
use skyglow_tests::{
    lobe_sum::{PreparedSky, fields, truth},
    lobe_truth::{LobeTruth, file_name},
    merged_sources::merged,
    places::places,
};
use std::{error::Error, path::Path};

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().collect();
    let (arguments, later) = match arguments.as_slice() {
        [arguments @ .., last] if last == "later" => (arguments, true),
        arguments => (arguments, false),
    };
    let [_, data, id, out, count, directions, share, turbidities] = arguments else {
        return Err(
            "usage: place_truth DATA_DIR SCENE OUT_DIR PLACES DIRECTIONS SHARE TURBIDITY,… [later]".into()
        );
    };
    let scene = SceneStore::new(data).open(&SceneId::parse(id)?)?;
    std::fs::create_dir_all(out)?;
    let samples = stratified_samples(directions.parse()?);
    let share: f64 = share.parse()?;
    let turbidities = turbidities.split(',').map(str::parse).collect::<Result<Vec<f64>, _>>()?;
    let places = places(&scene, count.parse()?);
    let mut turbidities = turbidities
        .into_iter()
        .map(|turbidity| Turbidity::new(turbidity).map(|turbidity| (turbidity, fields(turbidity))))
        .collect::<Result<Vec<_>, _>>()?;
    let count = turbidities.len();
    for (number, place) in places.into_iter().enumerate() {
        let (turbidity, kept) = &mut turbidities[number % count];
        let observer_altitude_m = scene.ground(place).altitude_m() + 2.0;
        let name = file_name(&format!("{id}-{number:02}"), observer_altitude_m, turbidity.value());
        let path = Path::new(out).join(name);
        if path.exists() != later {
            continue;
        }
        let before = later.then(|| LobeTruth::read(&path)).transpose()?;
        let (sources, flux_dnb_w) = sources_at(&scene, place, share);
        if sources.is_empty() {
            println!("{place:?}: dark");
            continue;
        }
        let sky = PreparedSky {
            name: id,
            place_deg: Some([place.latitude_deg(), place.longitude_deg()]),
            observer_altitude_m,
            sources: &sources,
            flux_dnb_w,
        };
        truth(&sky, *turbidity, &samples, kept, before)?.write(&path)?;
    }
    Ok(())
}

/// The sources of a place, merged, and their flux [DNB W].
fn sources_at(scene: &Scene, place: GeoPoint, share: f64) -> (Vec<PointSource>, f64) {
    let every = point_sources(place, &scene.source_pixels_within(place, FARTHEST_SOURCE_M));
    let flux_dnb_w = every.iter().map(|source| source.flux_dnb_w).sum();
    let sources = if share > 0.0 { merged(&every, share) } else { every };
    (sources, flux_dnb_w)
}
