//! Layers of drops beside closed forms and beside themselves.

use super::*;
use crate::CloudBase;
use std::f64::consts::TAU;

/// Chandrasekhar's H of isotropic scattering without absorption at μ = 0.5 and 1 (Chandrasekhar 1950, table XI).
const H: [(f64, f64); 2] = [(0.5, 2.0128), (1.0, 2.9078)];

/// A thick layer that scatters alike in all directions reflects H·H/(4(μ + μ₀)), but for what a finite one lets through.
#[test]
fn thick_isotropic_layers_follow_chandrasekhar() {
    let layer = DropReflectance::new(4_000.0, 0.0);
    for (light, h_light) in H {
        for (view, h_view) in H {
            let expected = h_light * h_view / (4.0 * (light + view));
            let got = layer.reflectance(light, view, 0.3);
            assert!((got / expected - 1.0).abs() < 1e-2, "{light} {view}: {got} {expected}");
        }
    }
}

/// Without absorption, what is not reflected comes through, from every angle.
#[test]
fn nothing_is_lost_in_the_layer() {
    let angles = Angles::new([0.05, 0.3, 1.0].into_iter());
    for depth in [0.1, 3.0, 40.0] {
        let (reflected, transmitted) = angles.doubled(0, depth, DROP_ASYMMETRY);
        for light in 0..angles.cosines.len() {
            let diffuse: f64 = (0..NODE_COUNT)
                .map(|node| angles.weights[node] * (reflected[(node, light)] + transmitted[(node, light)]))
                .sum();
            let all = diffuse + (-depth / angles.cosines[light]).exp();
            assert!((all - 1.0).abs() < 2e-3, "{depth} {}: {all}", angles.cosines[light]);
        }
    }
}

/// A layer with the optical depth of an albedo by two streams reflects about that of light from the zenith, and more at a slant.
#[test]
fn albedo_is_that_of_steep_light() {
    for albedo in [0.3, 0.5, 0.7] {
        let layer = DropLayer::of_depth(CloudBase::optical_depth(albedo)).get();
        let [steep, flat] = [1.0, 0.1].map(|cosine| layer.plane_albedo(cosine));
        assert!((steep - albedo).abs() < 0.04, "{albedo}: {steep}");
        assert!(flat > albedo + 0.15 && layer.spherical_albedo() > albedo, "{albedo}: {flat}");
    }
}

/// The table's integral over all directions is the plane albedo, so it interpolates well at grazing angles too.
#[test]
fn the_table_keeps_energy() {
    let layer = DropLayer::of_depth(CloudBase::optical_depth(0.5)).get();
    let rule = gauss_legendre(60);
    for light in [0.03f64, 0.11, 0.37, 0.93] {
        let mut sum = 0.0;
        for &(x, weight) in &rule {
            // Even in the angle over the base, crowding at the horizon.
            let angle = FRAC_PI_2 * x * x;
            let (view, width) = (angle.sin(), FRAC_PI_2 * 2.0 * x * weight * angle.cos());
            for step in 0..720 {
                let azimuth = TAU * (f64::from(step) + 0.5) / 720.0;
                let flat = ((1.0 - light * light) * (1.0 - view * view)).sqrt();
                let turn = flat * azimuth.cos() - light * view;
                sum += layer.reflectance(light, view, turn) * view * width * TAU / 720.0 / PI;
            }
        }
        let expected = layer.plane_albedo(light);
        assert!((sum / expected - 1.0).abs() < 0.01, "{light}: {sum} {expected}");
    }
}

/// Light that goes the other way is reflected as much (Helmholtz), and grazing light goes on rather than back.
#[test]
fn reciprocal_and_forward() {
    let layer = DropLayer::of_depth(CloudBase::optical_depth(0.5)).get();
    for (light, view, turn) in [(0.2, 0.7, 0.1), (0.05, 0.4, 0.6), (0.9, 0.15, -0.3)] {
        let ratio = layer.reflectance(light, view, turn) / layer.reflectance(view, light, turn);
        assert!((ratio - 1.0).abs() < 1e-4, "{light} {view}: {ratio}");
    }
    let sine2 = 1.0 - 0.2f64 * 0.2;
    let [on, back] = [1.0, -1.0].map(|side| layer.reflectance(0.2, 0.2, side * sine2 - 0.04));
    assert!(on > 5.0 * back, "{on} {back}");
}
