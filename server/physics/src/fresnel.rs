//! Reflectance of calm water by Fresnel's equations (1823), unpolarized (`docs/model.md#lit-ground`).

/// Refractive index of water for visible light; between 400 and 700 nm it differs by 0.7 %.
const REFRACTIVE_INDEX: f64 = 1.334;

/// Share of light that calm water reflects, given the sine of the angle between the ray and its surface, 0..=1.
pub fn water_reflectance(sine: f64) -> f64 {
    let cos_incident = sine.clamp(0.0, 1.0);
    let sin_refracted_squared = (1.0 - cos_incident * cos_incident) / (REFRACTIVE_INDEX * REFRACTIVE_INDEX);
    let cos_refracted = (1.0 - sin_refracted_squared).sqrt();
    let amplitude = |a: f64, b: f64| (a - b) / (a + b);
    let across = amplitude(cos_incident, REFRACTIVE_INDEX * cos_refracted);
    let along = amplitude(REFRACTIVE_INDEX * cos_incident, cos_refracted);
    0.5 * (across * across + along * along)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// ((n − 1)/(n + 1))² from above, 6 % at 60° from the vertical, everything at grazing incidence, and ever more on the way.
    #[test]
    fn it_has_known_values() {
        let n = REFRACTIVE_INDEX;
        assert!((water_reflectance(1.0) - ((n - 1.0) / (n + 1.0)).powi(2)).abs() < 1e-12);
        assert!((water_reflectance(0.5) - 0.060).abs() < 0.001, "{}", water_reflectance(0.5));
        assert_eq!((water_reflectance(0.0), water_reflectance(-0.1)), (1.0, 1.0));
        let falls = |step: usize| {
            water_reflectance(step as f64 / 100.0) > water_reflectance((step + 1) as f64 / 100.0)
        };
        assert!((0..100).all(falls));
    }

    /// At Brewster's angle, tan θ = n, what is polarized in the plane of incidence is not reflected: the mean is half of the rest.
    #[test]
    fn at_brewsters_angle_one_polarization_is_left() {
        let theta = REFRACTIVE_INDEX.atan();
        let n2 = REFRACTIVE_INDEX * REFRACTIVE_INDEX;
        let expected = 0.5 * ((n2 - 1.0) / (n2 + 1.0)).powi(2);
        assert!((water_reflectance(theta.cos()) / expected - 1.0).abs() < 1e-9);
    }
}
