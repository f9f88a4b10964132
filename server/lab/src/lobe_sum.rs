//! The reference of one sky with each lobe apart, computed.

use crate::lobe_reference::{LobeReference, seven_digits};
use skyglow_physics::{
    Atmosphere, PhysicsError, PointSource, Turbidity,
    direct_sum::{GridSample, direct_sum_by_lobe, grid_direction},
    multiple_scattering::{DEFAULT_GROUND_ALBEDO, FieldCache, Resolution, SumDensity},
    single_source::OUTPUT_COUNT,
};
use std::time::Instant;

/// Tolerance of every integral of the first order: far below what packs can have.
const TOLERANCE: f64 = 1e-5;

/// A sky whose reference solution is wanted.
#[derive(Clone, Debug)]
pub struct ReferenceSky<'a> {
    /// A class or a scene.
    pub name: &'a str,
    /// Latitude and longitude in the scene, degrees; None in a class.
    pub place_deg: Option<[f64; 2]>,
    /// Altitude of the observer's eye, metres.
    pub observer_altitude_m: f64,
    /// Its light.
    pub sources: &'a [PointSource],
    /// Flux of the raster there, DNB watts.
    pub flux_dnb_w: f64,
}

/// Fields for one turbidity: finer over distance and azimuth than whole skies need.
pub fn fields(turbidity: Turbidity) -> FieldCache {
    let density = SumDensity { distances: 107, azimuths: 61, ..SumDensity::default() };
    FieldCache::new(Atmosphere::new(turbidity), DEFAULT_GROUND_ALBEDO, Resolution::table(), density)
}

/// The reference at some directions; says on stdout how long it took. `fields` are those of [`fields`] for the turbidity. The first
/// order of `before`, a reference of the same sky and directions, is taken over: it does not depend on the solver.
///
/// # Errors
/// Altitudes beyond the solver's.
pub fn reference(
    sky: &ReferenceSky<'_>,
    turbidity: Turbidity,
    samples: &[GridSample],
    fields: &mut FieldCache,
    before: Option<LobeReference>,
) -> Result<LobeReference, PhysicsError> {
    let directions: Vec<_> = samples.iter().copied().map(grid_direction).collect();
    let ReferenceSky { name, place_deg, observer_altitude_m, sources, flux_dnb_w } = *sky;
    let start = Instant::now();
    let digits = |values: &[f64]| values.iter().copied().map(seven_digits).collect::<Vec<_>>();
    let same = |before: &LobeReference| before.samples == samples && before.sources == sources.len();
    let first_w_m2_sr = before.filter(same).map_or_else(
        || {
            let air = [Atmosphere::new(turbidity)];
            let first: Vec<[f64; OUTPUT_COUNT]> =
                direct_sum_by_lobe(&air, sources, observer_altitude_m, &directions, TOLERANCE);
            first.iter().map(|outputs| digits(outputs)).collect()
        },
        |before| before.first_w_m2_sr,
    );
    let first_s = start.elapsed().as_secs_f64();
    let solved = fields.solved_count();
    let later = fields.radiance_by_lobe_w_m2_sr(sources, observer_altitude_m, &directions)?;
    let seconds = start.elapsed().as_secs_f64();
    println!(
        "{name} {place_deg:?} {observer_altitude_m:.0} m, turbidity {}: {} sources {first_s:.0} s, {} fields {:.0} s",
        turbidity.value(),
        sources.len(),
        fields.solved_count() - solved,
        seconds - first_s,
    );
    Ok(LobeReference {
        name: name.to_owned(),
        place_deg,
        observer_altitude_m,
        turbidity: turbidity.value(),
        ground_albedo: DEFAULT_GROUND_ALBEDO,
        sources: sources.len(),
        flux_dnb_w,
        seconds,
        samples: samples.to_vec(),
        first_w_m2_sr,
        later_w_m2_sr: later.iter().map(|bands| digits(bands.as_flattened())).collect(),
    })
}
