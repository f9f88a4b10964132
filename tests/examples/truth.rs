//! The truth at random places of a scene, for several turbidities at once: slow, written to a file that the
//! `accuracy` example compares panoramas with.
//!
//! `truth DATA_DIR SCENE PLACES DIRECTIONS OUT_DIR`: one JSON file a place; files that are there are kept.

use skyglow_physics::{
    Atmosphere, EmissionMix, GeoPoint, LampPreset, Turbidity,
    direct_sum::{direct_sum, grid_direction, stratified_samples},
    source_pixel::{FARTHEST_SOURCE_M, point_sources},
};
use skyglow_scene::{Scene, SceneId, SceneStore};
use std::{error::Error, path::Path, time::Instant};

/// The packs' turbidities and two between them.
const TURBIDITIES: [f64; 7] = [1.5, 2.0, 2.5, 3.5, 4.0, 4.75, 6.0];
const SLOTS: usize = TURBIDITIES.len() * 3;

/// Places spread over the scene's bounds (additive recurrence): the same every time.
fn places(scene: &Scene, count: usize) -> Vec<GeoPoint> {
    let [west, south, east, north] = scene.metadata().bounds;
    (1..)
        .map(|i| {
            let spread = |ratio: f64| (f64::from(i) * ratio).fract();
            (south + (north - south) * spread(0.754_877_666), west + (east - west) * spread(0.569_840_291))
        })
        .filter_map(|(lat, lon)| GeoPoint::from_deg(lat, lon).ok())
        .filter(|place| scene.contains(*place))
        .take(count)
        .collect()
}

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().collect();
    let [_, data, id, count, directions, out] = arguments.as_slice() else {
        return Err("usage: truth DATA_DIR SCENE PLACES DIRECTIONS OUT_DIR".into());
    };
    let scene = SceneStore::new(data).open(&SceneId::parse(id)?)?;
    let atmospheres =
        TURBIDITIES.iter().map(|&t| Turbidity::new(t).map(Atmosphere::new)).collect::<Result<Vec<_>, _>>()?;
    let samples = stratified_samples(directions.parse()?);
    std::fs::create_dir_all(out)?;
    for (index, place) in places(&scene, count.parse()?).into_iter().enumerate() {
        let file = Path::new(out).join(format!("{id}-{index:02}.json"));
        if file.exists() {
            continue;
        }
        let start = Instant::now();
        let observer_altitude_m = scene.terrain_altitude_m(place).unwrap_or(0.0) + 2.0;
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
            "scene": id, "latitude_deg": place.latitude_deg(), "longitude_deg": place.longitude_deg(),
            "observer_altitude_m": observer_altitude_m, "turbidities": TURBIDITIES, "sources": sources.len(),
            "flux_dnb_w": sources.iter().map(|s| s.flux_dnb_w).sum::<f64>(), "seconds": seconds,
            "samples": samples, "radiance": radiance.iter().map(|r| r.to_vec()).collect::<Vec<_>>(),
        }))?;
        std::fs::write(&file, text)?;
        println!("{} {place:?}: {} sources, {seconds:.0} s", file.display(), sources.len());
    }
    Ok(())
}
