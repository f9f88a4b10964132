//! The monochromatic nodes of a sky, and Lagrange interpolation between them in ln λ.

use crate::{
    bands::{BAND_COUNT, Band},
    beam::ozone::absorption_per_atm_cm,
};

/// Number of nodes: a sky's radiance at each is one of so many numbers.
pub const NODE_COUNT: usize = BAND_COUNT;

/// Wavelengths of the nodes, nm, in the order of bands.
pub fn nodes_nm() -> [f64; NODE_COUNT] {
    Band::ALL.map(Band::wavelength_nm)
}

/// Lagrange's weights of the nodes at a wavelength, nm, for a polynomial in ln λ through all nodes; they add up to 1.
pub fn lagrange(wavelength_nm: f64) -> [f64; NODE_COUNT] {
    let x = wavelength_nm.ln();
    let nodes_nm = nodes_nm();
    std::array::from_fn(|node| {
        let own = nodes_nm[node].ln();
        nodes_nm
            .iter()
            .enumerate()
            .filter(|(other, _)| *other != node)
            .map(|(_, at)| (x - at.ln()) / (own - at.ln()))
            .product()
    })
}

/// Weights of the nodes at a wavelength, nm, for the logarithm of light that came a long way through ozone: the polynomial's highest
/// power gives way to ozone's absorption (the Chappuis band), which a cubic through its dip near 600 nm would turn into a flood beyond
/// 680 nm. They add up to 1.
pub fn through_ozone(wavelength_nm: f64) -> [f64; NODE_COUNT] {
    let nodes_nm = nodes_nm();
    let weights = lagrange(wavelength_nm);
    // The highest divided difference: 0 for every polynomial of a lower degree.
    let difference: [f64; NODE_COUNT] = std::array::from_fn(|node| {
        let others = nodes_nm.iter().enumerate().filter(|(other, _)| *other != node);
        others.map(|(_, at)| 1.0 / (nodes_nm[node] / at).ln()).product()
    });
    let of_ozone = nodes_nm.map(absorption_per_atm_cm);
    let sum =
        |of: &[f64; NODE_COUNT]| of.iter().zip(of_ozone).map(|(weight, value)| weight * value).sum::<f64>();
    let beside = (absorption_per_atm_cm(wavelength_nm) - sum(&weights)) / sum(&difference);
    std::array::from_fn(|node| weights[node] + beside * difference[node])
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        /// A polynomial with as many coefficients as there are nodes is met everywhere, and the weights add up to 1.
        #[test]
        fn polynomials_are_interpolated_exactly(
            c in prop::array::uniform4(-2.0..2.0_f64), at in 380.0..900.0_f64,
        ) {
            let value = |nm: f64| {
                let x = (nm / 550.0).ln();
                c[..NODE_COUNT].iter().rev().fold(0.0, |sum, c| sum * x + c)
            };
            let weights = lagrange(at);
            prop_assert!((weights.iter().sum::<f64>() - 1.0).abs() < 1e-12);
            let found: f64 = weights.iter().zip(nodes_nm()).map(|(weight, node)| weight * value(node)).sum();
            prop_assert!((found - value(at)).abs() < 1e-11);
        }
    }

    /// A parabola with any depth of ozone is met everywhere, where a cubic goes far astray.
    #[test]
    fn ozone_is_interpolated_exactly() {
        for atm_cm in [0.0, 1.0, 15.0] {
            let value = |nm: f64| {
                let x = (nm / 550.0).ln();
                0.3 - 2.0 * x + 1.5 * x * x - atm_cm * absorption_per_atm_cm(nm)
            };
            let found = |weights: [f64; NODE_COUNT]| {
                weights.iter().zip(nodes_nm()).map(|(weight, node)| weight * value(node)).sum::<f64>()
            };
            for nm in [400.0, 470.0, 555.0, 600.0, 720.0, 850.0] {
                assert!((through_ozone(nm).iter().sum::<f64>() - 1.0).abs() < 1e-12);
                assert!((found(through_ozone(nm)) - value(nm)).abs() < 1e-9, "{nm}");
            }
            let astray = (found(lagrange(850.0)) - value(850.0)).abs();
            assert!(astray > 0.5 * atm_cm, "{astray}");
        }
    }

    #[test]
    fn a_node_is_its_own_value() {
        for (node, at) in nodes_nm().into_iter().enumerate() {
            for (other, weight) in lagrange(at).into_iter().enumerate() {
                assert!((weight - f64::from(u8::from(node == other))).abs() < 1e-13);
            }
        }
    }
}
