use super::*;
use crate::{
    atmosphere::{Atmosphere, Turbidity},
    bands::{BAND_COUNT, Band},
    emission::LOBE_COUNT,
    geometry::EARTH_RADIUS_M,
    phase::{henyey_greenstein_per_sr, rayleigh_per_sr},
};
use glam::DVec3;
use proptest::prelude::*;

fn atmosphere(turbidity: f64) -> Atmosphere {
    Atmosphere::new(Turbidity::new(turbidity).unwrap())
}

fn at(distance_m: f64) -> SourceGeometry {
    SourceGeometry { distance_m, source_altitude_m: 0.0, observer_altitude_m: 0.0 }
}

fn zenith(turbidity: f64, distance_m: f64) -> f64 {
    radiance_per_watt_of(&atmosphere(turbidity), &at(distance_m), 0.0, std::f64::consts::FRAC_PI_2, 1e-8)
        [Band::MIDDLE.index()][0]
}

/// Flat-Earth integrals agree with the closed form.
#[test]
fn flat_earth_agrees_with_closed_form() {
    // ∫e^{−h/H}/(D²+h²)dh and the same with 1 + h²/(D²+h²), km⁻¹, H = 8 km.
    let cases = [
        (1.0, 1.2468470482, 1.7656051940),
        (5.0, 0.1568780610, 0.2008046473),
        (10.0, 0.0545951724, 0.0652829580),
        (50.0, 0.0030679407, 0.0031782711),
    ];
    for (distance_km, plain, weighted) in cases {
        let geometry = at(distance_km * 1e3);
        let ray = SourceRay::on_sphere(1e13, &geometry, 0.0, std::f64::consts::FRAC_PI_2);
        let got = ray.integrate(1e-9, 0.0, |p| {
            let isotropic = (-p.altitude_m / 8_000.0).exp() / p.source_distance_m2;
            let h2 = p.altitude_m * p.altitude_m;
            let d2 = geometry.distance_m * geometry.distance_m;
            [isotropic, isotropic * (1.0 + h2 / (d2 + h2))]
        });
        assert!((got[0] * 1e3 / plain - 1.0).abs() < 1e-7, "{distance_km} km: {}", got[0] * 1e3);
        assert!((got[1] * 1e3 / weighted - 1.0).abs() < 1e-7, "{distance_km} km: {}", got[1] * 1e3);
        // The curved Earth is another integral: the check can fail.
        let curved = SourceRay::new(&geometry, 0.0, std::f64::consts::FRAC_PI_2)
            .integrate(1e-9, 0.0, |p| [(-p.altitude_m / 8_000.0).exp() / p.source_distance_m2]);
        assert!((curved[0] * 1e3 / plain - 1.0).abs() > 1e-7);
    }
}

/// More turbidity brightens the zenith of a near source and dims that of a far one.
#[test]
fn turbidity_brightens_near_and_dims_far() {
    for distance_m in [250.0, 500.0, 750.0, 1_000.0] {
        assert!(zenith(2.0, distance_m) > zenith(1.0, distance_m), "{distance_m}");
    }
    assert!(zenith(4.0, 500.0) > zenith(2.0, 500.0));
    for distance_m in [10_000.0, 20_000.0, 50_000.0] {
        assert!(zenith(4.0, distance_m) < zenith(2.0, distance_m), "{distance_m}");
    }
}

/// Near 20 km the zenith falls about as the distance to the power of −2.5 (Walker 1977).
#[test]
fn walkers_law_near_20_km() {
    let slope = (zenith(2.0, 25_000.0) / zenith(2.0, 16_000.0)).ln() / (25.0f64 / 16.0).ln();
    assert!((-3.2..=-2.2).contains(&slope), "{slope}");
}

/// In the Earth's shadow there is exactly nothing.
#[test]
fn the_earths_shadow_is_exactly_dark() {
    let dark = radiance_per_watt_of(&atmosphere(2.0), &at(300_000.0), std::f64::consts::PI, 0.012, 1e-6);
    assert_eq!(dark, [[0.0; LOBE_COUNT]; BAND_COUNT]);
    let lit = radiance_per_watt_of(&atmosphere(2.0), &at(300_000.0), std::f64::consts::PI, 0.3, 1e-6);
    assert!(lit[1][0] > 0.0);
}

/// A tighter tolerance changes nothing by more than 1e-6.
#[test]
fn the_integral_has_converged() {
    // Converged to 1e-6 means: the value at the working tolerance is within 1e-6 of a much tighter one,
    // for every band and lobe, also near the horizon, through the source's vertical and at high turbidity.
    let mut worst: f64 = 0.0;
    for turbidity in [1.0, 2.0, 6.0] {
        let atmosphere = atmosphere(turbidity);
        for distance_m in [250.0, 2_000.0, 17_000.0, 80_000.0, 300_000.0] {
            for (source_altitude_m, observer_altitude_m) in
                [(0.0, 0.0), (1_500.0, 0.0), (0.0, 3_000.0), (6_000.0, 5_500.0)]
            {
                let geometry = SourceGeometry { distance_m, source_altitude_m, observer_altitude_m };
                for azimuth_deg in [0.0f64, 0.3, 1.4, 20.0, 90.0, 180.0] {
                    for elevation_deg in [0.1f64, 0.703125, 5.0, 30.0, 75.0, 89.3] {
                        let (az, el) = (azimuth_deg.to_radians(), elevation_deg.to_radians());
                        let working = radiance_per_watt_of(&atmosphere, &geometry, az, el, 1e-6);
                        let tight = radiance_per_watt_of(&atmosphere, &geometry, az, el, 1e-10);
                        for band in 0..BAND_COUNT {
                            for lobe in 0..LOBE_COUNT {
                                let (w, t) = (working[band][lobe], tight[band][lobe]);
                                assert!(t >= 0.0 && t.is_finite());
                                if t > 1e-40 {
                                    let error = (w / t - 1.0).abs();
                                    worst = worst.max(error);
                                    assert!(
                                        error < 1e-6,
                                        "T {turbidity} {geometry:?} az {azimuth_deg} el {elevation_deg} band {band} lobe {lobe}: {error:e}"
                                    );
                                }
                            }
                        }
                    }
                }
            }
        }
    }
    println!("worst change {worst:e}");
}

/// The same integral by plain means: uniform fine steps, optical depths by their own quadrature.
fn brute_force(atmosphere: &Atmosphere, geometry: &SourceGeometry, azimuth: f64, elevation: f64) -> f64 {
    let r0 = EARTH_RADIUS_M + geometry.observer_altitude_m;
    let arc = geometry.distance_m / EARTH_RADIUS_M;
    let observer = DVec3::new(0.0, 0.0, r0);
    let up = DVec3::new(arc.sin(), 0.0, arc.cos());
    let source = up * (EARTH_RADIUS_M + geometry.source_altitude_m);
    let view = DVec3::new(elevation.cos() * azimuth.cos(), elevation.cos() * azimuth.sin(), elevation.sin());
    let extinction = |p: DVec3| {
        let z = p.length() - EARTH_RADIUS_M;
        let molecules = atmosphere.molecule_extinction_per_m()[1] * (-z / 8_430.0).exp();
        (molecules, atmosphere.aerosol_extinction_per_m()[1] * (-z / 1_200.0).exp())
    };
    let optical_depth = |a: DVec3, b: DVec3| {
        let steps = 400;
        (0..steps)
            .map(|i| {
                let (m, h) = extinction(a.lerp(b, (f64::from(i) + 0.5) / f64::from(steps)));
                (m + h) * (b - a).length() / f64::from(steps)
            })
            .sum::<f64>()
    };
    let steps = 6_000;
    let mut sum = 0.0;
    for i in 0..steps {
        // u = 150 km·s³: fine near the observer.
        let s = (f64::from(i) + 0.5) / f64::from(steps);
        let (u, du) = (4e5 * s * s * s, 4e5 * 3.0 * s * s / f64::from(steps));
        let p = observer + view * u;
        let light = (p - source).normalize();
        let cos_psi = light.dot(up);
        if cos_psi <= 0.0 {
            continue;
        }
        let (m, h) = extinction(p);
        let cos_gamma = -light.dot(view);
        let scattering = m * rayleigh_per_sr(cos_gamma) + 0.9 * h * henyey_greenstein_per_sr(cos_gamma, 0.8);
        sum += cos_psi / std::f64::consts::PI / (p - source).length_squared()
            * scattering
            * (-optical_depth(source, p) - optical_depth(p, observer)).exp()
            * du;
    }
    sum
}

/// The integral agrees with plain steps along the ray.
#[test]
fn integral_agrees_with_plain_steps() {
    let atmosphere = atmosphere(2.5);
    for (distance_m, source_altitude_m, observer_altitude_m, azimuth, elevation) in [
        (3_000.0, 0.0, 0.0, 0.5, 0.8f64),
        (40_000.0, 1_200.0, 300.0, 2.0, 0.3),
        (120_000.0, 0.0, 2_500.0, 0.1, 1.2),
    ] {
        let geometry = SourceGeometry { distance_m, source_altitude_m, observer_altitude_m };
        let plain = brute_force(&atmosphere, &geometry, azimuth, elevation);
        let got = radiance_per_watt_of(&atmosphere, &geometry, azimuth, elevation, 1e-8)[1][0];
        assert!((got / plain - 1.0).abs() < 2e-4, "{geometry:?}: {got:e} {plain:e}");
    }
}

proptest! {
    /// The sky of a source is mirror symmetric and never negative.
    #[test]
    fn sky_is_symmetric_and_never_negative(
        log_distance in 0.0f64..1.0, source_altitude_m in 0.0f64..6e3, observer_altitude_m in 0.0f64..6e3,
        azimuth in 0.0f64..3.1, elevation in 0.005f64..1.57, turbidity in 1.0f64..6.0,
    ) {
        let geometry = SourceGeometry { distance_m: 250.0 * 1200f64.powf(log_distance), source_altitude_m, observer_altitude_m };
        let atmosphere = atmosphere(turbidity);
        let left = radiance_per_watt_of(&atmosphere, &geometry, azimuth, elevation, 1e-6);
        let right = radiance_per_watt_of(&atmosphere, &geometry, -azimuth, elevation, 1e-6);
        for band in 0..BAND_COUNT {
            for lobe in 0..LOBE_COUNT {
                prop_assert!(left[band][lobe] >= 0.0 && left[band][lobe].is_finite());
                let scale = left[band][lobe].max(1e-60);
                prop_assert!((left[band][lobe] - right[band][lobe]).abs() <= 1e-6 * scale);
            }
        }
    }
}
