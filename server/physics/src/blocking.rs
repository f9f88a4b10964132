//! Skylines that block a source's low light: the blocking angle, and the angles that tables are computed for.
//!
//! Of a source's light, what leaves below the skyline in the vertical plane from source to observer, as seen from the
//! source, does not count in any order (`docs/model.md#blocking`). In the tables that plane stands for all azimuths: the
//! lobe is cut at the blocking angle all around.

/// Number of blocking angles that tables are made for, the open sky among them.
pub const BLOCKING_COUNT: usize = 8;

/// Blocking angles that tables are made for, degrees above the source's horizontal plane, ascending from the open sky.
pub const BLOCKING_ANGLES_DEG: [f64; BLOCKING_COUNT] = [0.0, 0.5, 1.0, 2.0, 4.0, 8.0, 16.0, 32.0];

/// The angle at or below a blocking angle, by its place in [`BLOCKING_ANGLES_DEG`], and the weight 0..=1 of the next one:
/// linear up to the first angle above 0, then linear in the logarithm. Below 0 the sky is open; skylines above the
/// last angle count as that one.
pub fn blocking_position(blocking_deg: f64) -> (usize, f64) {
    let last = BLOCKING_COUNT - 1;
    if blocking_deg.is_nan() || blocking_deg <= 0.0 {
        return (0, 0.0);
    }
    if blocking_deg >= BLOCKING_ANGLES_DEG[last] {
        return (last, 0.0);
    }
    let lower = BLOCKING_ANGLES_DEG.partition_point(|&node| node <= blocking_deg) - 1;
    let (low, high) = (BLOCKING_ANGLES_DEG[lower], BLOCKING_ANGLES_DEG[lower + 1]);
    let weight = if lower == 0 { blocking_deg / high } else { (blocking_deg / low).ln() / (high / low).ln() };
    (lower, weight.clamp(0.0, 1.0))
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// Nodes are found exactly, and angles outside count as the nearest one.
    #[test]
    fn nodes_are_exact_and_ends_are_clamped() {
        for (node, angle_deg) in BLOCKING_ANGLES_DEG.into_iter().enumerate() {
            assert_eq!(blocking_position(angle_deg), (node, 0.0));
        }
        assert_eq!(blocking_position(-3.0), (0, 0.0));
        assert_eq!(blocking_position(f64::NAN), (0, 0.0));
        assert_eq!(blocking_position(80.0), (BLOCKING_COUNT - 1, 0.0));
        assert_eq!(blocking_position(0.25), (0, 0.5));
        let (lower, weight) = blocking_position(32f64.sqrt());
        assert!(lower == 4 && (weight - 0.5).abs() < 1e-12);
    }

    proptest! {
        #[test]
        fn a_higher_skyline_is_never_at_a_lower_place(a in 0.0f64..40.0, b in 0.0f64..40.0) {
            let place = |angle: f64| { let (node, weight) = blocking_position(angle); node as f64 + weight };
            prop_assert!((a <= b) == (place(a) <= place(b)) || a.min(b) >= 32.0);
        }
    }
}
