//! Function multiversioning: inner loops compiled for AVX2, FMA and F16C too, and chosen at run time.
//!
//! A loop whose body takes `FUSED` rounds a multiply-add once where the processor can: its sums differ by some 1e-7 between
//! processors that have the instructions and others, and [`instruction_set`] says which one this is. A body without it
//! gives the same bits everywhere, for nothing is fused or reordered by the compiler. On one machine all answers are the
//! same bits every time.

use std::cell::Cell;

thread_local! {
    static BASELINE_ALONE: Cell<bool> = const { Cell::new(false) };
}

/// Whether the processor has what the fast loops are compiled for.
#[inline]
pub fn is_wide() -> bool {
    #[cfg(target_arch = "x86_64")]
    {
        is_x86_feature_detected!("avx2")
            && is_x86_feature_detected!("fma")
            && is_x86_feature_detected!("f16c")
            && !BASELINE_ALONE.get()
    }
    #[cfg(not(target_arch = "x86_64"))]
    {
        false
    }
}

/// Runs `work` on this thread as on a processor without the instructions: for tests that compare the two.
pub fn with_baseline<T>(work: impl FnOnce() -> T) -> T {
    let before = BASELINE_ALONE.replace(true);
    let result = work();
    BASELINE_ALONE.set(before);
    result
}

/// Which of the two forms of the loops runs, in words.
pub fn instruction_set() -> &'static str {
    if is_wide() { "AVX2 and FMA" } else { "baseline instructions" }
}

/// a·b + c, rounded once where `FUSED`: without the instruction that would be a library call.
#[inline(always)]
pub fn multiply_add<const FUSED: bool>(a: f32, b: f32, c: f32) -> f32 {
    if FUSED { a.mul_add(b, c) } else { a * b + c }
}

/// e^x to 2e-7 for −87 < x < 88, 0 below; without branches, so that several at once are vector code.
#[inline(always)]
pub(crate) fn exponential(x: f32) -> f32 {
    // 2^t with t = n + r: adding 1.5·2²³ rounds t to the integer n and leaves it in the low bits.
    const ROUND: f32 = 12_582_912.0;
    let t = (x * std::f32::consts::LOG2_E).clamp(-125.0, 126.0);
    let rounded = t + ROUND;
    let r = (t - (rounded - ROUND)) * std::f32::consts::LN_2;
    let power = f32::from_bits((rounded.to_bits() << 23).wrapping_add(127 << 23));
    let series =
        1.0 + r * (1.0 + r * (0.5 + r * (1.0 / 6.0 + r * (1.0 / 24.0 + r * (1.0 / 120.0 + r / 720.0)))));
    power * series
}

/// ln x to 1e-6 for normal x > 0, without branches.
#[inline(always)]
pub(crate) fn logarithm(x: f32) -> f32 {
    // x = 2ⁿ·m with m between √½ and √2; ln m = 2·artanh(s), s = (m − 1)/(m + 1).
    const SQRT_HALF_BITS: u32 = 0x3f35_04f3;
    let shifted = x.to_bits().wrapping_sub(SQRT_HALF_BITS);
    let exponent = (shifted as i32) >> 23;
    let m = f32::from_bits((shifted & 0x007f_ffff) + SQRT_HALF_BITS);
    let s = (m - 1.0) / (m + 1.0);
    let s2 = s * s;
    let series = 2.0 * s * (1.0 + s2 * (1.0 / 3.0 + s2 * (0.2 + s2 * (1.0 / 7.0 + s2 / 9.0))));
    exponent as f32 * std::f32::consts::LN_2 + series
}

/// Defines a function that runs a body compiled with AVX2, FMA and F16C where the processor has them:
/// `fn name(arguments) -> Result = body::<FUSED>;` calls `body::<true>` there and `body::<false>` elsewhere,
/// `… = body;` the same body in both. The body and what it calls must be `#[inline(always)]` to gain by that.
#[macro_export]
macro_rules! simd_dispatch {
    (@define [$($head:tt)*] ($($argument:ident: $kind:ty),*) [$($result:tt)*] [$($wide:tt)*] [$($baseline:tt)*]) => {
        $($head)*($($argument: $kind),*) $($result)* {
            #[cfg(target_arch = "x86_64")]
            {
                #[target_feature(enable = "avx2,fma,f16c")]
                fn wide($($argument: $kind),*) $($result)* {
                    $($wide)*($($argument),*)
                }
                if $crate::simd::is_wide() {
                    #[expect(unsafe_code, reason = "the processor was just asked for all that the callee needs; the \
                        auto-vectoriser's baseline code takes up to three times as long")]
                    // SAFETY: the features are there, and the function has no other precondition.
                    return unsafe { wide($($argument),*) };
                }
            }
            $($baseline)*($($argument),*)
        }
    };
    ($(#[$docs:meta])* $visibility:vis fn $name:ident($($argument:ident: $kind:ty),* $(,)?) $(-> $result:ty)?
        = $body:ident::<FUSED>;) => {
        $crate::simd_dispatch!(@define [$(#[$docs])* $visibility fn $name] ($($argument: $kind),*) [$(-> $result)?]
            [$body::<true>] [$body::<false>]);
    };
    ($(#[$docs:meta])* $visibility:vis fn $name:ident($($argument:ident: $kind:ty),* $(,)?) $(-> $result:ty)?
        = $body:ident;) => {
        $crate::simd_dispatch!(@define [$(#[$docs])* $visibility fn $name] ($($argument: $kind),*) [$(-> $result)?]
            [$body] [$body]);
    };
}

#[cfg(test)]
mod tests {
    use super::*;

    simd_dispatch! {
        /// A sum of products.
        fn dot(a: &[f32], b: &[f32]) -> f32 = dot_body::<FUSED>;
    }

    #[inline(always)]
    fn dot_body<const FUSED: bool>(a: &[f32], b: &[f32]) -> f32 {
        a.iter().zip(b).fold(0.0, |sum, (a, b)| multiply_add::<FUSED>(*a, *b, sum))
    }

    simd_dispatch! {
        /// The same without fused sums.
        fn dot_unfused(a: &[f32], b: &[f32]) -> f32 = dot_unfused_body;
    }

    #[inline(always)]
    fn dot_unfused_body(a: &[f32], b: &[f32]) -> f32 {
        dot_body::<false>(a, b)
    }

    #[test]
    fn fast_functions_keep_their_tolerance() {
        for i in 0..2_000 {
            let x = 1.013f32.powi(i) * 1e-3;
            assert!((logarithm(x) - x.ln()).abs() < 2e-6 + 1e-7 * x.ln().abs(), "{x}");
        }
        for i in -800..800 {
            let x = i as f32 * 0.1;
            let error = f64::from(exponential(x)) / f64::from(x).exp() - 1.0;
            assert!(error.abs() < 1e-6 * (1.0 + f64::from(x).abs()), "{x}");
        }
    }

    /// Fused sums differ where the processor has the instruction; others are the same bits.
    #[test]
    fn only_fused_loops_depend_on_the_processor() {
        let a: Vec<f32> = (0..1_000u16).map(|at| 1.0 + f32::from(at) / 977.0).collect();
        let b: Vec<f32> = a.iter().map(|a| 1.0 / a + 1e-3).collect();
        // Of many lengths: one sum alone may round to the same number by chance.
        let sums = |dot: fn(&[f32], &[f32]) -> f32| -> Vec<f32> {
            (1..=a.len()).map(|length| dot(&a[..length], &b[..length])).collect()
        };
        let baseline = with_baseline(|| {
            assert!(!is_wide());
            (sums(dot), sums(dot_unfused))
        });
        assert_eq!(sums(dot_unfused), baseline.1);
        assert_eq!(baseline.0, baseline.1);
        assert_eq!(sums(dot) != baseline.0, is_wide());
    }
}
