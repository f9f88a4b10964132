//! `beams`: skies of beams beside Monte Carlo, and twilight at the zenith beside what was measured.

use crate::arguments::Outcome;
use skyglow_physics::{
    BAND_COUNT, Band, Response, Turbidity,
    beam::{BeamAir, BeamField, BeamSetting, MoleculeProfile, USUAL_OZONE_DOBSON, monte_carlo::BeamTracer},
    spectrum::{SpectralRule, Spectrum},
};
use std::{f64::consts::FRAC_PI_2, time::Instant};

/// Compares skies of beams with Monte Carlo, and twilight over Paranal with Patat et al. (2006).
#[derive(Debug, clap::Args)]
pub(crate) struct Arguments {
    /// Turbidity of the skies beside Monte Carlo
    #[arg(default_value_t = 2.5)]
    turbidity: f64,
    /// Paths of each estimate
    #[arg(default_value_t = 1_000_000)]
    paths: u64,
}

/// Degrees below the horizon and V at the zenith, mag arcsec⁻², over Paranal (Patat et al. 2006).
const MEASURED: [(f64, f64); 4] = [(6.0, 13.30), (9.0, 17.00), (12.0, 19.67), (15.0, 21.32)];
const PARANAL_M: f64 = 2_635.0;
/// V of the Sun less that of 1 sr⁻¹ of it.
const SUN_PER_SR: f64 = -26.74 + 26.572;
/// The night sky there, V.
const NIGHT: f64 = 21.61;
/// Altitude of the observer [m], elevation, zenith angle of the source and azimuth from it, degrees.
const DIRECTIONS: [(f64, f64, f64, f64); 9] = [
    (0.0, 90.0, 30.0, 0.0),
    (0.0, 20.0, 50.0, 120.0),
    (1_500.0, 60.0, 85.0, 60.0),
    (1_500.0, 5.0, 90.0, 20.0),
    (1_500.0, 90.0, 92.0, 0.0),
    (1_500.0, 90.0, 94.0, 0.0),
    (1_500.0, 10.0, 96.0, 0.0),
    (1_500.0, 90.0, 96.0, 0.0),
    (1_500.0, 90.0, 98.0, 0.0),
];

pub(crate) fn run(arguments: &Arguments) -> Outcome {
    let setting = BeamSetting::new(BeamAir::new(Turbidity::new(arguments.turbidity)?));
    let start = Instant::now();
    let field = BeamField::solve(setting.clone());
    println!(
        "field of T = {}: {:.1} s, {} orders",
        arguments.turbidity,
        start.elapsed().as_secs_f64(),
        field.orders()
    );
    println!(
        "| observer, m | elevation | source's zenith angle | azimuth | nm | Monte Carlo, sr-1 | its error, % | field, % |"
    );
    for band in [Band::MIDDLE, Band::SHORTEST] {
        let tracer = BeamTracer::new(setting.clone(), band);
        for (altitude_m, elevation, zenith, azimuth) in DIRECTIONS {
            let [elevation_rad, zenith_rad, azimuth_rad] = [elevation, zenith, azimuth].map(f64::to_radians);
            let judged =
                tracer.estimate(altitude_m, elevation_rad, zenith_rad, azimuth_rad, arguments.paths, 1);
            let got = field.view(altitude_m, elevation_rad).radiance_per_sr(zenith_rad, azimuth_rad);
            println!(
                "| {altitude_m} | {elevation} | {zenith} | {azimuth} | {} | {:.3e} | {:.1} | {:+.1} |",
                band.wavelength_nm(),
                judged.radiance_per_sr,
                100.0 * judged.standard_error_per_sr / judged.radiance_per_sr,
                100.0 * (got[band.index()] / judged.radiance_per_sr - 1.0)
            );
        }
    }
    twilight()
}

/// V at the zenith over Paranal, with sunlight of the same power at every wavelength of V.
fn twilight() -> Outcome {
    let rule = SpectralRule::exact(&Spectrum::from_fn(|_| 1.0), &Response::JohnsonV.curve());
    let whole = rule.value([1.0; BAND_COUNT]);
    for (turbidity, ozone_dobson) in [(1.5, USUAL_OZONE_DOBSON), (1.2, USUAL_OZONE_DOBSON), (1.5, 260.0)] {
        let air = BeamAir::with_profile(
            Turbidity::new(turbidity)?,
            MoleculeProfile::Standard { ozone_dobson },
            true,
            Band::ALL.map(Band::wavelength_nm),
        );
        let field = BeamField::solve(BeamSetting::new(air));
        let view = field.view(PARANAL_M, FRAC_PI_2);
        for (below, measured) in MEASURED {
            let kernel = view.radiance_per_sr((90.0 + below).to_radians(), 0.0);
            let share = rule.value(kernel) / whole;
            let sunlit = SUN_PER_SR - 2.5 * share.log10();
            let sum = 10f64.powf(-0.4 * sunlit) + 10f64.powf(-0.4 * NIGHT);
            let seen = -2.5 * sum.log10();
            println!(
                "T = {turbidity}, {ozone_dobson} DU, {below}° below: V {sunlit:.2}, with the night sky {seen:.2}, \
                 measured {measured}: {:+.2}",
                seen - measured
            );
        }
    }
    Ok(())
}
