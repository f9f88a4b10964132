//! Compression filters of sections: byte shuffle and linear prediction along the distance. All are lossless but
//! [`round_to_steps`], which is applied before anything is packed.

use half::{f16, slice::HalfFloatSliceExt};
use rayon::prelude::*;

/// Equal byte positions of `width`-byte values side by side: smooth tables then compress.
pub(crate) fn shuffle(bytes: &[u8], width: usize) -> Vec<u8> {
    let count = bytes.len() / width;
    let mut out = vec![0; bytes.len()];
    for (byte, plane) in out.chunks_exact_mut(count.max(1)).enumerate() {
        for (i, slot) in plane.iter_mut().enumerate() {
            *slot = bytes[i * width + byte];
        }
    }
    out
}

/// Undoes [`shuffle`].
pub(crate) fn unshuffle(bytes: &[u8], width: usize) -> Vec<u8> {
    let count = bytes.len() / width;
    let mut out = vec![0; bytes.len()];
    for (byte, plane) in bytes.chunks_exact(count.max(1)).enumerate() {
        for (i, &value) in plane.iter().enumerate() {
            out[i * width + byte] = value;
        }
    }
    out
}

/// Values `[table][distance][rest]` → wrapping differences of their bits from one distance to the next.
pub(crate) fn distance_differences(values: &[f16], distances: usize, rest: usize) -> Vec<u16> {
    let mut bits: Vec<u16> = values.iter().map(|value| value.to_bits()).collect();
    for table in bits.chunks_exact_mut(distances * rest) {
        for i in (rest..table.len()).rev() {
            table[i] = table[i].wrapping_sub(table[i - rest]);
        }
    }
    bits
}

/// Undoes [`distance_differences`].
pub(crate) fn from_distance_differences(mut bits: Vec<u16>, distances: usize, rest: usize) -> Vec<f16> {
    for table in bits.chunks_exact_mut(distances * rest) {
        for i in rest..table.len() {
            table[i] = table[i].wrapping_add(table[i - rest]);
        }
    }
    bits.into_iter().map(f16::from_bits).collect()
}

/// A node's largest coefficient is at most two to the power of this in steps.
const STEP_BITS: i32 = 13;
/// Power of two of the smallest step: half precision has none smaller.
const MIN_EXPONENT: i32 = -24;
/// Largest number of steps that one is expected to be from those before it.
const MAX_EXPECTED: i64 = 1 << STEP_BITS;

/// Power of two of the step of a node with these coefficients.
fn step_exponent(node: &[f16]) -> i32 {
    let largest = node.iter().fold(0.0, |largest: f32, value| largest.max(value.to_f32().abs()));
    // The power of two at or above it: no half-precision number is subnormal in single precision.
    let (above, is_power) = (largest.to_bits() >> 23, largest.to_bits() << 9 == 0);
    (above as i32 - 127 + i32::from(!is_power) - STEP_BITS).max(MIN_EXPONENT)
}

/// Rounds the coefficients of nodes, `[node][basis]`, to whole steps of a power of two, 2⁻¹³ of the one at or above the
/// node's largest. A sky is a sum over the functions, so what counts is a coefficient's error beside the largest, and
/// half precision gives small ones digits that the largest has not. Done twice it changes nothing more.
pub(crate) fn round_to_steps(values: &mut [f16], basis: usize) {
    values.par_chunks_exact_mut(basis.max(1)).for_each(|node| {
        let step = 2f32.powi(step_exponent(node));
        for value in node {
            // Adding 0 makes -0 one, which no number of steps is.
            *value = f16::from_f32((value.to_f32() / step).round() * step + 0.0);
        }
    });
}

/// Sample points of coefficients `[table][distance][offset][basis]`.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ShapeLayout {
    pub(crate) distances: usize,
    pub(crate) offsets: usize,
    pub(crate) basis: usize,
}

impl ShapeLayout {
    fn row(self) -> usize {
        self.offsets * self.basis
    }

    fn table(self) -> usize {
        (self.distances * self.row()).max(1)
    }
}

/// `value` steps in steps that are smaller by 2^`shift`.
fn in_other_steps(value: i32, shift: i32) -> i64 {
    let value = i64::from(value);
    match shift {
        0.. => value << shift.min(24),
        _ => (value + (1 << (-shift - 1).min(40))) >> (-shift).min(40),
    }
}

/// Visits every coefficient of a table: `visit` has its place and what the line through the two distances before, which
/// have steps of their own, says of it in steps of its node.
fn along_distances(
    layout: ShapeLayout,
    exponents: &[i8],
    steps: &mut [i32],
    mut visit: impl FnMut(usize, i32) -> i32,
) {
    let row = layout.row();
    for (node, &exponent) in exponents.iter().enumerate() {
        // By how much the steps at the nearer distance and at the farther are larger.
        let shifts = [1, 2].map(|back| {
            let before = node.checked_sub(back * layout.offsets)?;
            Some(i32::from(exponents[before]) - i32::from(exponent))
        });
        for at in node * layout.basis..(node + 1) * layout.basis {
            let line = match shifts {
                [None, _] => 0,
                [Some(nearer), None] => in_other_steps(steps[at - row], nearer),
                [Some(nearer), Some(farther)] => {
                    2 * in_other_steps(steps[at - row], nearer) - in_other_steps(steps[at - 2 * row], farther)
                }
            };
            steps[at] = visit(at, line.clamp(-MAX_EXPECTED, MAX_EXPECTED) as i32);
        }
    }
}

/// Coefficients rounded by [`round_to_steps`] → the power of two of each node's step, and for every coefficient by how many steps it
/// is off the line through the two distances before, its sign in the lowest bit.
pub(crate) fn to_steps(values: &[f16], layout: ShapeLayout) -> (Vec<i8>, Vec<u16>) {
    let exponents: Vec<i8> =
        values.par_chunks_exact(layout.basis.max(1)).map(|node| step_exponent(node) as i8).collect();
    let mut off = vec![0u16; values.len()];
    off.par_chunks_exact_mut(layout.table())
        .zip(values.par_chunks_exact(layout.table()))
        .zip(exponents.par_chunks_exact((layout.distances * layout.offsets).max(1)))
        .for_each(|((off, values), exponents)| {
            let mut steps = vec![0i32; values.len()];
            along_distances(layout, exponents, &mut steps, |at, expected| {
                let step = 2f32.powi(i32::from(exponents[at / layout.basis]));
                let whole = (values[at].to_f32() / step).round() as i32;
                let by = whole - expected;
                off[at] = ((by << 1) ^ (by >> 31)) as u16;
                whole
            });
        });
    (exponents, off)
}

/// Undoes [`to_steps`]. What no steps were made of comes out as other numbers, infinite ones at worst.
pub(crate) fn from_steps(exponents: &[i8], off: &[u16], layout: ShapeLayout) -> Vec<f16> {
    let mut values = vec![f16::ZERO; off.len()];
    values
        .par_chunks_exact_mut(layout.table())
        .zip(off.par_chunks_exact(layout.table()))
        .zip(exponents.par_chunks_exact((layout.distances * layout.offsets).max(1)))
        .for_each(|((values, off), exponents)| {
            let mut steps = vec![0i32; values.len()];
            along_distances(layout, exponents, &mut steps, |at, expected| {
                expected + (i32::from(off[at] >> 1) ^ -i32::from(off[at] & 1))
            });
            let mut wide = vec![0f32; layout.basis];
            let nodes = values.chunks_mut(layout.basis).zip(steps.chunks(layout.basis));
            for ((values, steps), exponent) in nodes.zip(exponents) {
                let step = 2f32.powi(i32::from(*exponent));
                wide.iter_mut().zip(steps).for_each(|(wide, steps)| *wide = *steps as f32 * step);
                values.convert_from_f32_slice(&wide);
            }
        });
    values
}

/// Rounds single precision to 15 bits of mantissa, 1.5 parts in a hundred thousand: what is left compresses. Done twice it
/// changes nothing more.
pub(crate) fn round_mantissas(values: &mut [f32]) {
    for value in values {
        *value = f32::from_bits(value.to_bits().saturating_add(0x80) & !0xff);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn what_is_packed_comes_back_bit_for_bit() {
        let values: Vec<f16> = (0..2 * 5 * 6).map(|i| f16::from_f32((i as f32 * 0.7).sin() - 0.3)).collect();
        let packed = distance_differences(&values, 5, 6);
        assert_eq!(packed[..6], values[..6].iter().map(|v| v.to_bits()).collect::<Vec<_>>());
        assert_eq!(packed[30..36], values[30..36].iter().map(|v| v.to_bits()).collect::<Vec<_>>());
        assert_eq!(from_distance_differences(packed, 5, 6), values);
        let bytes: Vec<u8> = (0..24).collect();
        assert_eq!(unshuffle(&shuffle(&bytes, 4), 4), bytes);
        assert_ne!(shuffle(&bytes, 4), bytes);
    }

    const LAYOUT: ShapeLayout = ShapeLayout { distances: 5, offsets: 3, basis: 4 };

    proptest! {
        /// Steps come back bit for bit and are fine beside the largest value.
        #[test]
        fn steps_round_trip_and_are_fine(
            values in prop::collection::vec(
                prop_oneof![-2.0f32..2.0, -1e-3f32..1e-3, -3e-7f32..3e-7, -6e4f32..6e4, Just(0.0f32)],
                2 * 5 * 3 * 4,
            ),
        ) {
            let exact: Vec<f16> = values.into_iter().map(f16::from_f32).collect();
            let mut rounded = exact.clone();
            round_to_steps(&mut rounded, LAYOUT.basis);
            for (rounded, exact) in rounded.chunks(LAYOUT.basis).zip(exact.chunks(LAYOUT.basis)) {
                let largest = exact.iter().map(|v| v.to_f32().abs()).fold(0.0, f32::max);
                for (rounded, exact) in rounded.iter().zip(exact) {
                    // Half a step, and steps are smaller than 2^-12 of the largest.
                    let off = (rounded.to_f32() - exact.to_f32()).abs();
                    prop_assert!(off <= largest / 8192.0 + 3e-8, "{} {}", off, largest);
                }
            }
            let (exponents, off) = to_steps(&rounded, LAYOUT);
            let bits = |values: &[f16]| values.iter().map(|v| v.to_bits()).collect::<Vec<_>>();
            prop_assert_eq!(bits(&from_steps(&exponents, &off, LAYOUT)), bits(&rounded));
            let mut twice = rounded.clone();
            round_to_steps(&mut twice, LAYOUT.basis);
            prop_assert_eq!(bits(&twice), bits(&rounded));
        }

        #[test]
        fn no_numbers_of_a_file_break_anything(
            exponents in prop::collection::vec(any::<i8>(), 5 * 3),
            off in prop::collection::vec(any::<u16>(), 5 * 3 * 4),
        ) {
            prop_assert_eq!(from_steps(&exponents, &off, LAYOUT).len(), off.len());
        }
    }

    /// What lies on a line along the distance is packed as zeros.
    #[test]
    fn lines_along_distance_pack_to_zeros() {
        let layout = ShapeLayout { distances: 6, offsets: 1, basis: 2 };
        // 1 and 0.5 + d/16: the step is that of numbers up to 1.
        let mut values: Vec<f16> =
            (0..6).flat_map(|d| [f16::ONE, f16::from_f32(0.5 + d as f32 / 16.0)]).collect();
        round_to_steps(&mut values, 2);
        let (exponents, off) = to_steps(&values, layout);
        assert!(exponents.iter().all(|&e| e == -13));
        assert_eq!(off[4..], [0; 8]);
        assert_eq!(off[..2], [2 << 13, 2 << 12]);
    }

    #[test]
    fn mantissas_keep_fifteen_bits() {
        let exact = [1.0f32, -0.1, 3.3e-30, 0.0, 7.654_321e5];
        let mut rounded = exact;
        round_mantissas(&mut rounded);
        assert!(rounded.iter().zip(exact).all(|(a, b)| (a - b).abs() <= 1.6e-5 * b.abs()));
        assert_ne!(rounded, exact);
        let mut twice = rounded;
        round_mantissas(&mut twice);
        assert_eq!(twice, rounded);
    }
}
