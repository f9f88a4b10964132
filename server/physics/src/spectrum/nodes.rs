//! The monochromatic nodes of a sky, and Lagrange interpolation between them in ln λ.

use crate::bands::{BAND_COUNT, Band};

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

    #[test]
    fn a_node_is_its_own_value() {
        for (node, at) in nodes_nm().into_iter().enumerate() {
            for (other, weight) in lagrange(at).into_iter().enumerate() {
                assert!((weight - f64::from(u8::from(node == other))).abs() < 1e-13);
            }
        }
    }
}
