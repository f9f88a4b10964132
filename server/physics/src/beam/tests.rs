//! Skies of beams against quadrature and Monte Carlo of other programs, in the air that those had: T = 2, molecules
//! exp(−z/8 km) with 13.558e-6 m⁻¹ at 550 nm up to 80 km, no ozone, no refraction, seen from sea level.

use super::*;
use crate::{BAND_COUNT, Turbidity};
use std::f64::consts::FRAC_PI_2;

fn former_air() -> BeamAir {
    let profile = MoleculeProfile::Exponential {
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
