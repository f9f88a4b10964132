//! Skies whose truth is known: computed for made-up scenes, or read from files for places of the demo.

use crate::{error::BenchError, options::Setting, scenes::LitScene};
use serde::Deserialize;
use skyglow_physics::{
    Atmosphere, BAND_COUNT, GeoPoint, PointSource, Turbidity,
    direct_sum::{GridSample, direct_sum, grid_direction, stratified_samples},
    multiple_scattering::{MultipleSum, Resolution, SumDensity},
    source_pixel::{FARTHEST_SOURCE_M, point_sources},
};
use skyglow_scene::{DEMO_ID, PolarGrid, Scene};
use skyglow_tables::Scattering;
use std::{path::Path, sync::Arc};

/// A sky and its truth in some directions.
#[derive(Clone, Debug)]
pub struct TruthSky {
    /// The scene, and the place in it.
    pub name: String,
    /// What the engine takes.
    pub polar: Arc<PolarGrid>,
    /// Altitude of the observer, metres.
    pub observer_altitude_m: f64,
    /// Turbidity.
    pub turbidity: Turbidity,
    /// Flux within 300 km, DNB watts.
    pub flux_dnb_w: f64,
    /// Directions.
    pub samples: Vec<GridSample>,
    /// Radiance there, W m⁻² sr⁻¹.
    pub radiance_w_m2_sr: Vec<[f64; BAND_COUNT]>,
}

/// A file of truth, as `tests/truth` has them.
#[derive(Debug, Deserialize)]
struct StoredTruth {
    scene: String,
    #[serde(default)]
    scattering: Option<Scattering>,
    latitude_deg: f64,
    longitude_deg: f64,
    observer_altitude_m: f64,
    flux_dnb_w: f64,
    turbidities: Vec<f64>,
    samples: Vec<GridSample>,
    radiance: Vec<Vec<f64>>,
}

/// The sum over every source with the orders that the packs have: where those are all, fields of the later ones are
/// solved, ten seconds or so for every 300 m of source altitude.
///
/// # Errors
/// Altitudes beyond the solver's.
fn radiance_w_m2_sr(
    setting: &Setting,
    sources: &[PointSource],
    observer_altitude_m: f64,
    samples: &[GridSample],
) -> Result<Vec<[f64; BAND_COUNT]>, BenchError> {
    let directions: Vec<_> = samples.iter().copied().map(grid_direction).collect();
    let atmosphere = Atmosphere::new(setting.turbidity);
    let (emission, lamp) = (setting.emission, setting.flux_per_dnb_flux);
    let mut radiance =
        direct_sum(&[atmosphere], sources, observer_altitude_m, emission, lamp, &directions, &|| ());
    if !setting.is_first_order() {
        let later = MultipleSum {
            atmosphere,
            ground_albedo: setting.ground_albedo,
            observer_altitude_m,
            emission,
            resolution: Resolution::table(),
            density: SumDensity::default(),
        };
        for (bands, later) in radiance.iter_mut().zip(later.radiance(sources, lamp, &directions)?) {
            bands.iter_mut().zip(later).for_each(|(band, later)| *band += later);
        }
    }
    Ok(radiance)
}

/// A made-up scene in about so many directions, at the setting's turbidity.
///
/// # Errors
/// As the solver's.
pub(crate) fn of_scene(
    setting: &Setting,
    scene: &LitScene,
    directions: usize,
) -> Result<TruthSky, BenchError> {
    let samples = stratified_samples(directions);
    Ok(TruthSky {
        name: format!("{} {}", scene.name, scene.lit_sources),
        polar: Arc::clone(&scene.polar),
        observer_altitude_m: scene.observer_altitude_m,
        turbidity: setting.turbidity,
        flux_dnb_w: scene.flux_dnb_w(),
        radiance_w_m2_sr: radiance_w_m2_sr(setting, &scene.sources, scene.observer_altitude_m, &samples)?,
        samples,
    })
}

/// A place of a stored scene, eye 2 m above the ground, in about so many directions; for packs of the first order.
///
/// # Errors
/// A place that there is not.
pub(crate) fn of_place(
    setting: &Setting,
    scene: &Scene,
    [latitude_deg, longitude_deg]: [f64; 2],
    directions: usize,
) -> Result<TruthSky, BenchError> {
    let place = GeoPoint::from_deg(latitude_deg, longitude_deg)?;
    let observer_altitude_m = scene.ground(place).altitude_m() + 2.0;
    let sources = point_sources(place, &scene.source_pixels_within(place, FARTHEST_SOURCE_M));
    let samples = stratified_samples(directions);
    Ok(TruthSky {
        name: format!("{DEMO_ID} {latitude_deg:.2} {longitude_deg:.2}"),
        polar: Arc::new(scene.polar_grid(place, false)),
        observer_altitude_m,
        turbidity: setting.turbidity,
        flux_dnb_w: sources.iter().map(|source| source.flux_dnb_w).sum(),
        radiance_w_m2_sr: radiance_w_m2_sr(setting, &sources, observer_altitude_m, &samples)?,
        samples,
    })
}

/// The skies of a file, one a turbidity within the packs'; none where the file has other orders of scattering.
///
/// # Errors
/// A file that is no truth, of another scene, or of another demo than `scene`.
pub(crate) fn of_file(setting: &Setting, scene: &Scene, path: &Path) -> Result<Vec<TruthSky>, BenchError> {
    let refuse = |reason: String| BenchError::Truth { path: path.to_owned(), reason };
    let bytes = std::fs::read(path).map_err(BenchError::file(path))?;
    let stored: StoredTruth = serde_json::from_slice(&bytes).map_err(|error| refuse(error.to_string()))?;
    if stored.scene != DEMO_ID {
        return Err(refuse(format!("it is of the scene {:?}, not of the demo", stored.scene)));
    }
    let width = BAND_COUNT * stored.turbidities.len();
    if stored.radiance.len() != stored.samples.len()
        || stored.radiance.iter().any(|bands| bands.len() != width)
    {
        return Err(refuse("its radiances do not fit its samples".to_owned()));
    }
    if stored.scattering.unwrap_or(Scattering::Single) != setting.kind.scattering {
        return Ok(Vec::new());
    }
    let place = GeoPoint::from_deg(stored.latitude_deg, stored.longitude_deg)?;
    let polar = Arc::new(scene.polar_grid(place, false));
    if (polar.flux_dnb_w / stored.flux_dnb_w - 1.0).abs() > 1e-3 {
        return Err(refuse(format!(
            "the demo has {} DNB watts there, the truth {}",
            polar.flux_dnb_w, stored.flux_dnb_w
        )));
    }
    let range = setting.turbidities.first().zip(setting.turbidities.last());
    let resident = |turbidity: f64| range.is_some_and(|(low, high)| (*low..=*high).contains(&turbidity));
    let mut skies = Vec::new();
    for (index, &turbidity) in stored.turbidities.iter().enumerate().filter(|(_, t)| resident(**t)) {
        let bands = |values: &Vec<f64>| std::array::from_fn(|band| values[index * BAND_COUNT + band]);
        skies.push(TruthSky {
            name: format!("{DEMO_ID} {:.2} {:.2}", stored.latitude_deg, stored.longitude_deg),
            polar: Arc::clone(&polar),
            observer_altitude_m: stored.observer_altitude_m,
            turbidity: Turbidity::new(turbidity)?,
            flux_dnb_w: stored.flux_dnb_w,
            samples: stored.samples.clone(),
            radiance_w_m2_sr: stored.radiance.iter().map(bands).collect(),
        });
    }
    Ok(skies)
}
