//! Skies of beams against quadrature and Monte Carlo of other programs, in the air that those had: T = 2, molecules
//! exp(−z/8 km) with 13.558e-6 m⁻¹ at 550 nm up to 80 km, no ozone, no refraction, seen from sea level.

use super::{monte_carlo::BeamTracer, *};
use crate::{
    BAND_COUNT, Band, Response, Turbidity,
    spectrum::{SpectralRule, Spectrum},
};
use std::f64::consts::FRAC_PI_2;

fn former_air() -> BeamAir {
    let profile = MoleculeProfile::Exponential {
        ozone_dobson: 0.0,
        scale_height_m: 8_000.0,
        extinction_550_per_m: 13.558e-6,
        top_m: 80_000.0,
    };
    BeamAir::with_profile(Turbidity::new(2.0).unwrap(), profile, false, [550.0; BAND_COUNT])
}

/// First order by quadrature to 1 % (the shadow's edge 98° away is 2 km below the top of that air), all orders by Monte
/// Carlo within three of its standard errors and 2 %.
#[test]
#[ignore = "slow: `make check` leaves it to `make test`"]
fn skies_agree_with_other_programs() {
    let field = BeamField::solve(BeamSetting::new(former_air()));
    let zenith = field.view(0.0, FRAC_PI_2);
    let slant = field.view(0.0, 30f64.to_radians());
    let off = |got: [f64; BAND_COUNT], wanted: f64| (got[0] / wanted - 1.0).abs();
    for (view, zenith_deg, first) in [
        (&zenith, 30.0f64, 2.616e-2),
        (&zenith, 60.0, 8.617e-3),
        (&zenith, 85.0, 3.411e-3),
        (&zenith, 90.0, 1.276e-3),
        (&zenith, 92.0, 4.890e-4),
        (&zenith, 94.0, 9.785e-5),
        (&zenith, 96.0, 8.107e-6),
        (&slant, 60.0, 0.4697),
        (&slant, 90.0, 4.115e-3),
        (&slant, 94.0, 3.833e-4),
    ] {
        let off = off(view.first_order_per_sr(zenith_deg.to_radians(), 0.0), first);
        assert!(off < 0.01, "first order, {zenith_deg}: {off}");
    }
    for (zenith_deg, all, error) in [
        (60.0f64, 1.257e-2, 0.002),
        (85.0, 5.35e-3, 0.005),
        (90.0, 1.867e-3, 0.006),
        (92.0, 7.04e-4, 0.011),
        (94.0, 1.41e-4, 0.024),
        (96.0, 1.47e-5, 0.08),
    ] {
        let off = off(zenith.radiance_per_sr(zenith_deg.to_radians(), 0.0), all);
        assert!(off < 3.0 * error + 0.02, "all orders, {zenith_deg}: {off}");
    }
}

/// The field and Monte Carlo, which share no solver, on the air of tables: by day, at the horizon and in dusk, at the zenith and low in
/// the sky.
#[test]
#[ignore = "slow: `make check` leaves it to `make test`"]
fn skies_agree_with_monte_carlo() {
    let setting = BeamSetting::new(BeamAir::new(Turbidity::new(2.5).unwrap()));
    let (field, middle) = (BeamField::solve(setting.clone()), Band::MIDDLE);
    let tracer = BeamTracer::new(setting, middle);
    for (altitude_m, elevation_deg, zenith_deg, azimuth_deg, paths) in [
        (0.0, 90.0f64, 50.0f64, 0.0f64, 200_000),
        (0.0, 20.0, 50.0, 120.0, 200_000),
        (1_500.0, 60.0, 85.0, 60.0, 200_000),
        (1_500.0, 90.0, 94.0, 0.0, 1_000_000),
        (1_500.0, 10.0, 96.0, 0.0, 500_000),
        (1_500.0, 90.0, 98.0, 0.0, 2_000_000),
    ] {
        let (elevation, zenith, azimuth) =
            (elevation_deg.to_radians(), zenith_deg.to_radians(), azimuth_deg.to_radians());
        let judged = tracer.estimate(altitude_m, elevation, zenith, azimuth, paths, 1);
        let error = judged.standard_error_per_sr / judged.radiance_per_sr;
        let got = field.view(altitude_m, elevation).radiance_per_sr(zenith, azimuth)[middle.index()];
        let off = got / judged.radiance_per_sr - 1.0;
        assert!(error < 0.1, "{zenith_deg}: {error}");
        assert!(off.abs() < 3.0 * error + 0.02, "{zenith_deg}: {off} with an error of {error}");
    }
}
/// V at the zenith over Paranal with the Sun 6, 9, 12 and 15° down (Patat et al. 2006) with the night sky of V = 21.61 in it: within
/// 0.35 mag, and 0.1 mag at 6°.
#[test]
#[ignore = "slow: `make check` leaves it to `make test`"]
fn twilight_is_near_what_was_measured() {
    let field = BeamField::solve(BeamSetting::new(BeamAir::new(Turbidity::new(1.5).unwrap())));
    let rule = SpectralRule::exact(&Spectrum::from_fn(|_| 1.0), &Response::JohnsonV.curve());
    let view = field.view(2_635.0, FRAC_PI_2);
    for (below_deg, measured, limit) in
        [(6.0f64, 13.30, 0.1), (9.0, 17.00, 0.35), (12.0, 19.67, 0.35), (15.0, 21.32, 0.35)]
    {
        let kernel = view.radiance_per_sr((90.0 + below_deg).to_radians(), 0.0);
        let share = rule.value(kernel) / rule.value([1.0; BAND_COUNT]);
        // V of the Sun, and square seconds in a steradian.
        let sunlit = 10f64.powf(-0.4 * (-26.74 + 26.572)) * share;
        let off = -2.5 * (sunlit + 10f64.powf(-0.4 * 21.61)).log10() - measured;
        assert!(off.abs() < limit, "{below_deg}: {off}");
    }
}
