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
