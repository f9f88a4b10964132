//! How wrong panoramas are, by basis size and executor.

use crate::{
    error::BenchError,
    executors::{self, Timed},
    options::Setting,
    reference::ReferenceSky,
    report::ErrorRow,
};
use skyglow_physics::{
    AZIMUTH_COUNT, BAND_COUNT, Panorama,
    direct_sum::GridSample,
    error_metric::{ErrorStatistics, relative_error},
    panorama::{elevation_rad, solid_angle_sr},
    photometry::{luminance_cd_m2, natural_sky_luminance_cd_m2},
    sky_quantities::ZENITH_CAP_RAD,
};
use skyglow_render::{Engine, prepare::Prepared, reference::render_f64};
use std::collections::BTreeMap;

/// Errors of all skies on an executor at every basis size, with the run time of each panorama.
///
/// # Errors
/// A sky that the engine refuses.
pub(crate) fn of_engine(
    engine: &Engine,
    setting: &Setting,
    skies: &[ReferenceSky],
    rounds: usize,
) -> Result<Vec<ErrorRow>, BenchError> {
    let asked: Vec<(&ReferenceSky, usize)> =
        skies.iter().flat_map(|sky| setting.bases.iter().map(move |&basis| (sky, basis))).collect();
    let requests: Vec<_> = asked
        .iter()
        .map(|(sky, basis)| {
            executors::request(setting, &sky.polar, sky.observer_altitude_m, sky.turbidity, *basis)
        })
        .collect();
    let name = engine.info().executor.name();
    let row = |((sky, _), timed): (&(&ReferenceSky, usize), Timed)| {
        let sample = |position: usize| f64::from(timed.rendered.panorama.samples()[position]);
        let packs = timed.work.packs;
        let row = compare(sky, setting, name, timed.rendered.basis_count, packs, &sample)?;
        Some(ErrorRow { median_ms: Some(timed.median_ms), fastest_ms: Some(timed.fastest_ms), ..row })
    };
    Ok(asked.iter().zip(executors::time(engine, &requests, rounds)?).filter_map(row).collect())
}

/// Errors of all skies by plain sums in f64 over the same tables with the largest basis: what is left is the tables' own.
///
/// # Errors
/// A sky that the tables refuse.
pub(crate) fn of_f64(setting: &Setting, skies: &[ReferenceSky]) -> Result<Vec<ErrorRow>, BenchError> {
    let mut rows = Vec::new();
    for sky in skies {
        let basis_count = setting.basis_count();
        let request =
            executors::request(setting, &sky.polar, sky.observer_altitude_m, sky.turbidity, basis_count);
        let prepared = Prepared::new(&request, &setting.set)?;
        let radiance = render_f64(&prepared, &setting.set);
        let packs = prepared.work().packs;
        let in_use = prepared.basis_count;
        rows.extend(compare(sky, setting, "f64", in_use, packs, &|position| radiance[position]));
    }
    Ok(rows)
}

/// One row; None without directions.
fn compare(
    sky: &ReferenceSky,
    setting: &Setting,
    executor: &str,
    basis_count: usize,
    packs: usize,
    sample: &dyn Fn(usize) -> f64,
) -> Option<ErrorRow> {
    let fast: Vec<[f64; BAND_COUNT]> = sky
        .samples
        .iter()
        .map(|&(row, column)| std::array::from_fn(|band| sample(Panorama::index(band, row, column))))
        .collect();
    let reference = &sky.radiance_w_m2_sr;
    let statistics = ErrorStatistics::of(
        fast.iter().zip(reference).map(|(fast, reference)| relative_error(*fast, *reference)),
    )?;
    let [zenith, horizontal] = zenith_and_horizontal(&sky.samples, &fast);
    let [true_zenith, true_horizontal] = zenith_and_horizontal(&sky.samples, reference);
    Some(ErrorRow {
        scene: sky.name.clone(),
        turbidity: sky.turbidity.value(),
        packs,
        scattering: setting.kind.scattering.name().to_owned(),
        flux_dnb_w: sky.flux_dnb_w,
        zenith_cd_m2: true_zenith,
        zenith_over_natural: true_zenith / natural_sky_luminance_cd_m2(),
        executor: executor.to_owned(),
        coefficients: "f16".to_owned(),
        basis_count,
        directions: statistics.directions,
        mean: statistics.mean,
        p99: statistics.p99,
        maximum: statistics.maximum,
        zenith_error: zenith / true_zenith - 1.0,
        horizontal_error: horizontal / true_horizontal - 1.0,
        median_ms: None,
        fastest_ms: None,
    })
}

/// Luminance of the zenith [cd m⁻²] and horizontal illuminance [lx] from sampled directions alone, each row's samples
/// standing for the whole row. Radiances in W m⁻² sr⁻¹.
pub fn zenith_and_horizontal(samples: &[GridSample], radiance: &[[f64; BAND_COUNT]]) -> [f64; 2] {
    let mut rows: BTreeMap<usize, (f64, f64)> = BTreeMap::new();
    for (&(row, _), bands) in samples.iter().zip(radiance) {
        let entry = rows.entry(row).or_default();
        entry.0 += luminance_cd_m2(*bands);
        entry.1 += 1.0;
    }
    let (mut zenith, mut cap_sr, mut horizontal) = (0.0, 0.0, 0.0);
    for (row, (sum, count)) in rows {
        let row_sr = solid_angle_sr(row) * AZIMUTH_COUNT as f64;
        if std::f64::consts::FRAC_PI_2 - elevation_rad(row) <= ZENITH_CAP_RAD {
            zenith += row_sr * sum / count;
            cap_sr += row_sr;
        }
        horizontal += row_sr * sum / count * elevation_rad(row).sin();
    }
    [zenith / cap_sr, horizontal]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{reference, scenes::LitScene};
    use skyglow_physics::direct_sum::stratified_samples;

    const BAND_LEN: usize = Panorama::LEN / BAND_COUNT;

    /// A uniform sky gives its luminance at the zenith and pi times it on the ground.
    #[test]
    fn a_uniform_sky_gives_pi_times_its_luminance() {
        let samples = stratified_samples(16_384);
        let radiance = vec![std::array::from_fn(|band| 1e-6 * (band + 1) as f64); samples.len()];
        let luminance = luminance_cd_m2(radiance[0]);
        let [zenith, horizontal] = zenith_and_horizontal(&samples, &radiance);
        assert!((zenith / luminance - 1.0).abs() < 1e-9);
        assert!((horizontal / (std::f64::consts::PI * luminance) - 1.0).abs() < 1e-3);
    }

    /// A sky is no error from itself and one a tenth too bright is a tenth off.
    #[test]
    fn a_tenth_too_bright_is_an_error_of_a_tenth() {
        let setting = crate::run::tests::setting(8);
        let scene = LitScene::of_cells(40);
        let sky = reference::of_scene(&setting, &scene, 30).unwrap();
        let error = |factor: f64| {
            let sample = |position: usize| {
                let (band, rest) = (position / BAND_LEN, position % BAND_LEN);
                let at = (rest / AZIMUTH_COUNT, rest % AZIMUTH_COUNT);
                let known = sky.samples.iter().position(|&sample| sample == at).unwrap();
                factor * sky.radiance_w_m2_sr[known][band]
            };
            compare(&sky, &setting, "f64", 8, 1, &sample).unwrap()
        };
        let (same, brighter) = (error(1.0), error(1.1));
        assert_eq!((same.mean, same.maximum, same.zenith_error), (0.0, 0.0, 0.0));
        assert!((brighter.maximum - 0.1).abs() < 1e-9 && brighter.mean > 0.05, "{brighter:?}");
        assert!((brighter.zenith_error - 0.1).abs() < 1e-9 && (brighter.horizontal_error - 0.1).abs() < 1e-9);
    }
}
