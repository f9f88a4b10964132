//! Reference solutions of places in a scene.

use crate::arguments::{List, Outcome, SceneArguments};
use skyglow_lab::{
    lobe_reference::{LobeReference, file_name},
    lobe_sum::{ReferenceSky, fields, reference},
    merged_sources::merged,
    places::places,
};
use skyglow_physics::{
    GeoPoint, PointSource, Turbidity,
    direct_sum::stratified_samples,
    source_pixel::{MAX_SOURCE_DISTANCE_M, point_sources},
};
use skyglow_scene::Scene;
use std::path::PathBuf;

/// The reference solutions of places spread over a scene, every lobe apart, for `class-accuracy`: one packed JSON file a
/// place. Files that are there stay. Place after place takes the next of the turbidities; all the places of one share what
/// fields do not depend on the observer.
#[derive(Debug, clap::Args)]
pub(crate) struct Arguments {
    #[command(flatten)]
    scene: SceneArguments,
    /// Folder for the files.
    out: PathBuf,
    /// How many places.
    places: usize,
    /// Directions a sky.
    directions: usize,
    /// Sources in one bin, this share of their distance deep and wide, are one; 0 sums every source.
    share: f64,
    /// Turbidities, such as `2.5,6`.
    turbidities: List<f64>,
    /// Solves the later orders of files that are there anew, and adds none.
    #[arg(long)]
    later: bool,
}

pub(crate) fn run(arguments: &Arguments) -> Outcome {
    let Arguments { scene, out, places: count, directions, share, turbidities, later } = arguments;
    let (id, scene) = (scene.scene.as_str(), scene.open()?);
    std::fs::create_dir_all(out)?;
    let samples = stratified_samples(*directions);
    let places = places(&scene, *count);
    let mut turbidities = turbidities
        .0
        .iter()
        .map(|&turbidity| Turbidity::new(turbidity).map(|turbidity| (turbidity, fields(turbidity))))
        .collect::<Result<Vec<_>, _>>()?;
    let count = turbidities.len();
    for (number, place) in places.into_iter().enumerate() {
        let (turbidity, solved) = &mut turbidities[number % count];
        let observer_altitude_m = scene.ground(place).altitude_m() + 2.0;
        let name = file_name(&format!("{id}-{number:02}"), observer_altitude_m, turbidity.value());
        let path = out.join(name);
        if path.exists() != *later {
            continue;
        }
        let before = later.then(|| LobeReference::read(&path)).transpose()?;
        let (sources, flux_dnb_w) = sources_at(&scene, place, *share);
        if sources.is_empty() {
            println!("{place:?}: dark");
            continue;
        }
        let sky = ReferenceSky {
            name: id,
            place_deg: Some([place.latitude_deg(), place.longitude_deg()]),
            observer_altitude_m,
            sources: &sources,
            flux_dnb_w,
        };
        reference(&sky, *turbidity, &samples, solved, before)?.write(&path)?;
    }
    Ok(())
}

/// The sources of a place, merged, and their flux [DNB W].
fn sources_at(scene: &Scene, place: GeoPoint, share: f64) -> (Vec<PointSource>, f64) {
    let every = point_sources(place, &scene.source_pixels_within(place, MAX_SOURCE_DISTANCE_M));
    let flux_dnb_w = every.iter().map(|source| source.flux_dnb_w).sum();
    let sources = if share > 0.0 { merged(&every, share) } else { every };
    (sources, flux_dnb_w)
}
