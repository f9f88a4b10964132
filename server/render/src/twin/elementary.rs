//! exp by Cody–Waite range reduction (Cody and Waite 1980) and a Taylor series in Horner's form, ln by the series of
//! artanh: the same few ulp on every device, where built-ins are allowed errors that grow with the argument. And [`Real`], over
//! which twins are generic.

use std::ops::{Add, Div, Mul, Neg, Sub};

/// A number that kernels are written for: f32 in the executors, f64 in the reference solution and in sensitivities.
pub trait Real:
    Copy
    + PartialOrd
    + From<f32>
    + Neg<Output = Self>
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
{
    /// e^x.
    fn natural_exp(self) -> Self;
    /// ln x.
    fn natural_log(self) -> Self;

    /// The larger of two numbers. Unlike `max` it says nothing of NaN, so that loops become vectors.
    #[inline(always)]
    fn maximum(self, other: Self) -> Self {
        if self > other { self } else { other }
    }

    /// The smaller of two numbers.
    #[inline(always)]
    fn minimum(self, other: Self) -> Self {
        if self < other { self } else { other }
    }
}

impl Real for f32 {
    #[inline(always)]
    fn natural_exp(self) -> Self {
        natural_exp(self)
    }

    #[inline(always)]
    fn natural_log(self) -> Self {
        natural_log(self)
    }
}

impl Real for f64 {
    fn natural_exp(self) -> Self {
        self.exp()
    }

    fn natural_log(self) -> Self {
        self.ln()
    }
}

/// High part of ln 2: few bits, so that its product with a small integer is exact.
const LN_2_HIGH: f32 = 0.693_359_4;
/// ln 2 − [`LN_2_HIGH`].
const LN_2_LOW: f32 = -2.121_944_4e-4;
/// Adding and taking away 1.5·2²³ rounds to the nearest integer, in vector code too.
const ROUNDER: f32 = 12_582_912.0;

/// e^x for x in −87..=88; x beyond counts as the end.
///
/// n = round(x / ln 2), r = x − n ln 2 in two steps, e^x = 2^n · Σ_{i≤7} r^i / i!; |r| ≤ 0.35 leaves 6e-9.
#[inline(always)]
pub fn natural_exp(x: f32) -> f32 {
    let x = x.clamp(-87.0, 88.0);
    let rounded = x * std::f32::consts::LOG2_E + ROUNDER;
    let n = rounded - ROUNDER;
    let r = x - n * LN_2_HIGH - n * LN_2_LOW;
    let mut sum = 1.0 / 720.0 + r * (1.0 / 5040.0);
    sum = 1.0 / 120.0 + r * sum;
    sum = 1.0 / 24.0 + r * sum;
    sum = 1.0 / 6.0 + r * sum;
    sum = 0.5 + r * sum;
    sum = 1.0 + r * sum;
    sum = 1.0 + r * sum;
    // The low bits of the rounded number are n: no conversion, whose care for infinities keeps loops from vectors.
    sum * f32::from_bits((rounded.to_bits() << 23).wrapping_add(127 << 23))
}

/// ln x for normal x > 0.
///
/// x = 2^e · m with √½ < m ≤ √2, s = (m − 1)/(m + 1), ln m = 2 artanh s = 2s·Σ_{i≤5} s^{2i}/(2i + 1);
/// |s| ≤ 0.172 leaves 1e-10.
#[inline(always)]
pub fn natural_log(x: f32) -> f32 {
    let bits = x.to_bits();
    let fraction = f32::from_bits((bits & 0x007f_ffff) | 0x3f80_0000);
    let high = fraction > std::f32::consts::SQRT_2;
    let m = if high { 0.5 * fraction } else { fraction };
    let exponent = ((bits >> 23) as i32 - 127 + i32::from(high)) as f32;
    let s = (m - 1.0) / (m + 1.0);
    let z = s * s;
    let mut sum = 1.0 / 9.0 + z * (1.0 / 11.0);
    sum = 1.0 / 7.0 + z * sum;
    sum = 1.0 / 5.0 + z * sum;
    sum = 1.0 / 3.0 + z * sum;
    sum = 1.0 + z * sum;
    exponent * LN_2_HIGH + (exponent * LN_2_LOW + 2.0 * s * sum)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The exponential is right to a few ulp everywhere.
    #[test]
    fn exp_is_right_to_a_few_ulp() {
        for step in -87_000..=88_000 {
            let x = step as f32 / 1000.0;
            let exact = f64::from(x).exp();
            let error = (f64::from(natural_exp(x)) - exact).abs() / exact;
            assert!(error < 2.5e-7, "{x}: {error}");
        }
        assert_eq!(natural_exp(0.0), 1.0);
        assert_eq!(natural_exp(-1000.0), natural_exp(-87.0));
    }

    /// The logarithm is right to a few ulp everywhere.
    #[test]
    fn ln_is_right_to_a_few_ulp() {
        let mut x = 1.2e-38f32;
        while x < 1e38 {
            let exact = f64::from(x).ln();
            let error = (f64::from(natural_log(x)) - exact).abs();
            assert!(error < 2e-7 * exact.abs().max(1e-1), "{x}: {error}");
            x *= 1.0037;
        }
        assert_eq!(natural_log(1.0), 0.0);
    }
}
