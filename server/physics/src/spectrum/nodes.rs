//! The four monochromatic nodes of a sky, and Lagrange interpolation between them in ln λ.

/// Number of nodes: a sky's radiance at each is one of four numbers.
pub const NODE_COUNT: usize = 4;
/// Wavelengths of the nodes, nm.
pub const NODES_NM: [f64; NODE_COUNT] = [440.0, 510.0, 590.0, 680.0];

/// Lagrange's weights of the nodes at a wavelength, nm, for a polynomial of the third degree in ln λ; they add up to 1.
pub fn lagrange(wavelength_nm: f64) -> [f64; NODE_COUNT] {
    let x = wavelength_nm.ln();
    std::array::from_fn(|node| {
        let own = NODES_NM[node].ln();
        NODES_NM
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
        /// At a node it is that node's own value, elsewhere a polynomial of the third degree is met, and the weights add up to 1.
        #[test]
        fn cubics_are_interpolated_exactly(c in prop::array::uniform4(-2.0..2.0_f64), at in 380.0..900.0_f64) {
            let value = |nm: f64| {
                let x = (nm / 550.0).ln();
                c[0] + x * (c[1] + x * (c[2] + x * c[3]))
            };
            let weights = lagrange(at);
            prop_assert!((weights.iter().sum::<f64>() - 1.0).abs() < 1e-12);
            let found: f64 = weights.iter().zip(NODES_NM).map(|(weight, node)| weight * value(node)).sum();
            prop_assert!((found - value(at)).abs() < 1e-11);
        }
    }

    #[test]
    fn a_node_is_its_own_value() {
        for (node, at) in NODES_NM.into_iter().enumerate() {
            for (other, weight) in lagrange(at).into_iter().enumerate() {
                assert!((weight - f64::from(u8::from(node == other))).abs() < 1e-13);
            }
        }
    }
}
