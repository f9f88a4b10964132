//! The four errors that whole skies are judged by, and the mixes of lobes they are judged in.

use skyglow_bench::accuracy::zenith_and_horizontal;
use skyglow_physics::{
    BAND_COUNT, EmissionMix, Lobe,
    direct_sum::GridSample,
    error_metric::{ErrorStatistics, relative_error},
};

/// Mean and 99th percentile of the relative error, and with their signs the errors at the zenith and in horizontal
/// illuminance.
pub type SkyErrors = [f64; 4];

/// Every lobe alone, and the common mix, with their names.
pub fn mixes() -> [(&'static str, EmissionMix); 4] {
    [
        ("garstang", EmissionMix::garstang()),
        ("lambert", EmissionMix::lambert()),
        ("horizon", EmissionMix::only(Lobe::Horizon)),
        ("oblique", EmissionMix::only(Lobe::Oblique)),
    ]
}

/// Of radiances in the same directions, W m⁻² sr⁻¹; None without directions.
pub fn sky_errors(
    samples: &[GridSample],
    fast: &[[f64; BAND_COUNT]],
    exact: &[[f64; BAND_COUNT]],
) -> Option<SkyErrors> {
    let each = fast.iter().zip(exact).map(|(fast, exact)| relative_error(*fast, *exact));
    let statistics = ErrorStatistics::of(each)?;
    let [zenith, horizontal] = zenith_and_horizontal(samples, fast);
    let [true_zenith, true_horizontal] = zenith_and_horizontal(samples, exact);
    let off = |value: f64, reference: f64| value / reference - 1.0;
    Some([statistics.mean, statistics.p99, off(zenith, true_zenith), off(horizontal, true_horizontal)])
}

#[cfg(test)]
mod tests {
    use super::*;
    use skyglow_physics::direct_sum::stratified_samples;

    /// A sky a tenth too bright is a tenth off in all four errors.
    #[test]
    fn a_tenth_too_bright_is_a_tenth_off() {
        let samples = stratified_samples(100);
        let exact = vec![[2e-7; BAND_COUNT]; samples.len()];
        let fast = vec![[2.2e-7; BAND_COUNT]; samples.len()];
        let errors = sky_errors(&samples, &fast, &exact).unwrap();
        assert!(errors.iter().all(|error| (error - 0.1).abs() < 1e-9), "{errors:?}");
        assert_eq!(sky_errors(&samples, &exact, &exact).unwrap(), [0.0; 4]);
    }
}
