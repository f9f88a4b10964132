//! Reference skies: computed for made-up scenes, or read from files for places of the demo.

use crate::{error::BenchError, options::Setting, scenes::LitScene};
use serde::Deserialize;
use skyglow_physics::{
    AZIMUTH_COUNT, Atmosphere, BAND_COUNT, ELEVATION_COUNT, GeoPoint, PointSource, Turbidity,
    direct_sum::{GridSample, direct_sum, grid_direction, stratified_samples},
    multiple_scattering::{MultipleSum, Resolution, SumDensity},
    source_pixel::{MAX_SOURCE_DISTANCE_M, point_sources},
};
use skyglow_scene::{DEMO_ID, PolarGrid, Scene};
use skyglow_tables::Scattering;
use std::{
    path::{Path, PathBuf},
    sync::Arc,
};

/// Largest relative difference of the flux around a place from that of its reference: the raster is the same.
const SAME_FLUX: f64 = 1e-3;

/// A sky and its reference in some directions.
#[derive(Clone, Debug)]
pub struct ReferenceSky {
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

/// A reference file, as `tests/reference` has them.
#[derive(Debug, Deserialize)]
struct StoredReference {
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
) -> Result<ReferenceSky, BenchError> {
    let samples = stratified_samples(directions);
    Ok(ReferenceSky {
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
) -> Result<ReferenceSky, BenchError> {
    let place = GeoPoint::from_deg(latitude_deg, longitude_deg)?;
    let observer_altitude_m = scene.ground(place).altitude_m() + 2.0;
    let sources = point_sources(place, &scene.source_pixels_within(place, MAX_SOURCE_DISTANCE_M));
    let samples = stratified_samples(directions);
    Ok(ReferenceSky {
        name: format!("{DEMO_ID} {latitude_deg:.2} {longitude_deg:.2}"),
        polar: Arc::new(scene.polar_grid(place, false)),
        observer_altitude_m,
        turbidity: setting.turbidity,
        flux_dnb_w: sources.iter().map(|source| source.flux_dnb_w).sum(),
        radiance_w_m2_sr: radiance_w_m2_sr(setting, &sources, observer_altitude_m, &samples)?,
        samples,
    })
}

/// Reads a reference file.
///
/// # Errors
/// A file that is none, or of another scene than the demo.
fn read(path: &Path) -> Result<StoredReference, BenchError> {
    let refuse = |reason: String| BenchError::Reference { path: path.to_owned(), reason };
    let bytes = std::fs::read(path).map_err(BenchError::file(path))?;
    let stored: StoredReference =
        serde_json::from_slice(&bytes).map_err(|error| refuse(error.to_string()))?;
    if stored.scene != DEMO_ID {
        return Err(refuse(format!("it is of the scene {:?}, not of the demo", stored.scene)));
    }
    let width = BAND_COUNT * stored.turbidities.len();
    if stored.radiance.len() != stored.samples.len()
        || stored.radiance.iter().any(|bands| bands.len() != width)
    {
        return Err(refuse("its radiances do not fit its samples".to_owned()));
    }
    let is_outside = |&(row, column): &GridSample| row >= ELEVATION_COUNT || column >= AZIMUTH_COUNT;
    if stored.samples.iter().any(is_outside) {
        return Err(refuse("it has samples outside the panorama".to_owned()));
    }
    Ok(stored)
}

/// Reads reference files: before minutes of work that end with one that is none.
///
/// # Errors
/// The first that cannot be read or is no reference.
pub(crate) fn check_files(paths: &[PathBuf]) -> Result<(), BenchError> {
    paths.iter().try_for_each(|path| read(path).map(drop))
}

/// The skies of a file, one a turbidity within the packs'; none where the file has other orders of scattering.
///
/// # Errors
/// A file that is no reference, of another scene, or of another demo than `scene`.
pub(crate) fn of_file(
    setting: &Setting,
    scene: &Scene,
    path: &Path,
) -> Result<Vec<ReferenceSky>, BenchError> {
    let stored = read(path)?;
    if stored.scattering.unwrap_or(Scattering::Single) != setting.kind.scattering {
        return Ok(Vec::new());
    }
    let place = GeoPoint::from_deg(stored.latitude_deg, stored.longitude_deg)?;
    let polar = Arc::new(scene.polar_grid(place, false));
    if (polar.flux_dnb_w / stored.flux_dnb_w - 1.0).abs() > SAME_FLUX {
        let reason =
            format!("the demo has {} DNB watts there, the reference {}", polar.flux_dnb_w, stored.flux_dnb_w);
        return Err(BenchError::Reference { path: path.to_owned(), reason });
    }
    Ok(stored.skies(&setting.turbidities, &polar))
}

impl StoredReference {
    /// One sky for each turbidity within those of the packs, ascending.
    fn skies(&self, resident: &[f64], polar: &Arc<PolarGrid>) -> Vec<ReferenceSky> {
        let range = resident.first().zip(resident.last());
        let is_served = |turbidity: f64| range.is_some_and(|(low, high)| (*low..=*high).contains(&turbidity));
        let sky = |(index, &turbidity): (usize, &f64)| {
            let bands = |values: &Vec<f64>| std::array::from_fn(|band| values[index * BAND_COUNT + band]);
            Some(ReferenceSky {
                name: format!("{DEMO_ID} {:.2} {:.2}", self.latitude_deg, self.longitude_deg),
                polar: Arc::clone(polar),
                observer_altitude_m: self.observer_altitude_m,
                turbidity: Turbidity::new(turbidity).ok().filter(|_| is_served(turbidity))?,
                flux_dnb_w: self.flux_dnb_w,
                samples: self.samples.clone(),
                radiance_w_m2_sr: self.radiance.iter().map(bands).collect(),
            })
        };
        self.turbidities.iter().enumerate().filter_map(sky).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use skyglow_render::synthetic;

    /// A stored reference gives a sky for each turbidity that packs serve and a broken one is refused.
    #[test]
    fn stored_references_give_skies_bad_ones_fail() {
        let path = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../../tests/reference/demo-03.json"));
        let stored = read(path).unwrap();
        assert_eq!(stored.scattering, Some(Scattering::Multiple));
        let polar = Arc::new(synthetic::dark_grid());
        let turbidities = |resident: &[f64]| -> Vec<f64> {
            stored.skies(resident, &polar).iter().map(|sky| sky.turbidity.value()).collect()
        };
        assert_eq!(turbidities(&[1.5, 2.5, 6.0]), stored.turbidities);
        assert_eq!(turbidities(&[3.0, 5.0]), [4.0]);
        let sky = &stored.skies(&[3.0, 5.0], &polar)[0];
        assert_eq!(sky.radiance_w_m2_sr.len(), sky.samples.len());
        assert_eq!(sky.radiance_w_m2_sr[7][2], stored.radiance[7][BAND_COUNT + 2]);

        let whole: serde_json::Value = serde_json::from_slice(&std::fs::read(path).unwrap()).unwrap();
        let folder = tempfile::tempdir().unwrap();
        let refusal = |change: fn(&mut serde_json::Value)| {
            let mut broken = whole.clone();
            change(&mut broken);
            let path = folder.path().join("broken.json");
            std::fs::write(&path, broken.to_string()).unwrap();
            read(&path).unwrap_err().to_string()
        };
        assert!(refusal(|reference| reference["scene"] = "kenya".into()).contains("not of the demo"));
        assert!(
            refusal(|reference| reference["turbidities"] = [2.0].as_slice().into()).contains("do not fit")
        );
        assert!(refusal(|reference| reference["samples"][0][0] = 64.into()).contains("outside the panorama"));
        assert!(refusal(|reference| reference["samples"] = "all".into()).contains("broken.json"));
    }
}
