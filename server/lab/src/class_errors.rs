//! The engine's skies against references with each lobe apart.

use crate::{
    class_scenes::Class,
    lobe_reference::LobeReference,
    sky_errors::{SkyErrors, sky_errors},
};
use skyglow_bench::{accuracy::zenith_and_horizontal, scenes::grid_under_open_sky};
use skyglow_physics::{
    BAND_COUNT, EmissionMix, PhysicsError, Turbidity, photometry::natural_sky_luminance_cd_m2,
};
use skyglow_render::{Engine, RenderError, RenderRequest};
use skyglow_scene::PolarGrid;
use skyglow_tables::{Scattering, TablesError};
use std::sync::Arc;

/// Why a reference cannot be judged by.
#[derive(Debug, thiserror::Error)]
pub enum JudgeError {
    /// It is of none of the classes.
    #[error("a reference of {name} seen from {observer_altitude_m} m, which is no sky of a class")]
    NoClass {
        /// What it is of.
        name: String,
        /// From where.
        observer_altitude_m: f64,
    },
    /// It has no directions.
    #[error("a reference without directions")]
    NoDirections,
    /// A number of it is out of range.
    #[error(transparent)]
    Physics(#[from] PhysicsError),
    /// Rendering failed.
    #[error(transparent)]
    Engine(#[from] RenderError),
    /// A pack cannot be read.
    #[error(transparent)]
    Tables(#[from] TablesError),
}

/// The light of the sky of a class that a reference is of.
///
/// # Errors
/// [`JudgeError::NoClass`].
pub fn class_grid(reference: &LobeReference) -> Result<PolarGrid, JudgeError> {
    let scenes = Class::from_name(&reference.name).map(Class::scenes);
    let mut same = scenes.iter().flatten().filter(|s| s.observer_altitude_m == reference.observer_altitude_m);
    same.next().map(|scene| grid_under_open_sky(&scene.sources)).ok_or_else(|| JudgeError::NoClass {
        name: reference.name.clone(),
        observer_altitude_m: reference.observer_altitude_m,
    })
}

/// Errors of the engine's sky of a grid, as [`skies_of`] has it.
///
/// # Errors
/// [`JudgeError`].
pub fn errors_of_sky(
    engine: &Engine,
    reference: &LobeReference,
    grid: &PolarGrid,
    emission: EmissionMix,
    basis: Option<usize>,
) -> Result<SkyErrors, JudgeError> {
    let [fast, exact] = skies_of(engine, reference, grid, emission, basis)?;
    sky_errors(&reference.samples, &fast, &exact).ok_or(JudgeError::NoDirections)
}

/// Radiance in each direction of a reference, W m⁻² sr⁻¹.
pub type Directions = Vec<[f64; BAND_COUNT]>;

/// The engine's sky of a grid and the true one. A class is lit such that its zenith is as bright as the natural sky, places
/// as they are; `basis` as requests have it.
///
/// # Errors
/// [`JudgeError`].
pub fn skies_of(
    engine: &Engine,
    reference: &LobeReference,
    grid: &PolarGrid,
    emission: EmissionMix,
    basis: Option<usize>,
) -> Result<[Directions; 2], JudgeError> {
    let flux_per_dnb_flux = skyglow_bench::options::REFERENCE_FLUX;
    let mut exact = reference.mixed_w_m2_sr(emission, flux_per_dnb_flux);
    let mut grid = grid.clone();
    if reference.place_deg.is_none() {
        let scale = natural_sky_luminance_cd_m2() / zenith_and_horizontal(&reference.samples, &exact)[0];
        exact.as_flattened_mut().iter_mut().for_each(|value| *value *= scale);
        grid = grid.scaled(scale);
    }
    let rendered = engine.render_blocking(RenderRequest {
        polar: Arc::new(grid),
        observer_altitude_m: reference.observer_altitude_m,
        turbidity: Turbidity::new(reference.turbidity)?,
        scattering: Scattering::Multiple,
        cloud_base_m: None,
        emission,
        flux_per_dnb_flux,
        basis,
    })?;
    let fast = reference
        .samples
        .iter()
        .map(|&(row, column)| std::array::from_fn(|b| rendered.panorama.radiance_w_m2_sr(b, row, column)))
        .collect();
    Ok([fast, exact])
}
