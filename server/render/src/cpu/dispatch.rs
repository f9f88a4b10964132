//! The inner loops, compiled for AVX2, FMA and F16C too and chosen at run time.
//!
//! A processor with fused multiply-add rounds once where another rounds twice: answers differ by some 1e-7 of the sum
//! between machines that have it and machines that do not, and the adapter's name, which is part of every ETag, says which
//! one it is ([`instruction_set`]). On one machine the same request gives the same bits.

/// Values side by side in one vector of eight.
pub const LANES: usize = 8;

/// A value on cache lines of its own: a vector that lies across two of them is read in twice the time.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[repr(C, align(64))]
pub struct Aligned<T>(pub T);

/// Whether the processor has what the fast loops are compiled for.
#[inline]
pub fn is_wide() -> bool {
    #[cfg(test)]
    if tests::BASELINE.get() {
        return false;
    }
    #[cfg(target_arch = "x86_64")]
    {
        is_x86_feature_detected!("avx2")
            && is_x86_feature_detected!("fma")
            && is_x86_feature_detected!("f16c")
    }
    #[cfg(not(target_arch = "x86_64"))]
    {
        false
    }
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

/// e^x for |x| ≤ 8, to 2e-5 there and 4e-6 within ±2: (e^{x/8})^8. A library's takes three times as long, and keeps loops from vectors.
#[inline(always)]
pub fn exponential<const FUSED: bool>(x: f32) -> f32 {
    let x = 0.125 * x;
    let add = multiply_add::<FUSED>;
    let root = add(x, add(x, add(x, add(x, add(x, 1.0 / 120.0, 1.0 / 24.0), 1.0 / 6.0), 0.5), 1.0), 1.0);
    let square = root * root;
    let fourth = square * square;
    fourth * fourth
}

/// Defines `$name`, which runs `$body::<true>` compiled with AVX2, FMA and F16C where the processor has them, and
/// `$body::<false>` elsewhere.
#[macro_export]
macro_rules! dispatch_wide {
    ($(#[$docs:meta])* $name:ident, $wide:ident, $body:ident, ($($argument:ident: $kind:ty),* $(,)?)) => {
        $(#[$docs])*
        pub(crate) fn $name($($argument: $kind),*) {
            #[cfg(target_arch = "x86_64")]
            if $crate::cpu::dispatch::is_wide() {
                #[expect(unsafe_code, reason = "the processor was just asked for all that the callee needs; the \
                    auto-vectoriser's baseline code takes three times as long")]
                // SAFETY: the features are there, and the function has no other precondition.
                unsafe { $wide($($argument),*) };
                return;
            }
            $body::<false>($($argument),*);
        }

        #[cfg(target_arch = "x86_64")]
        #[target_feature(enable = "avx2,fma,f16c")]
        fn $wide($($argument: $kind),*) {
            $body::<true>($($argument),*);
        }
    };
}
pub use crate::dispatch_wide;

#[cfg(test)]
pub(crate) mod tests {
    use std::cell::Cell;

    thread_local! {
        /// Whether this thread runs the loops as on a processor without the instructions.
        pub(crate) static BASELINE: Cell<bool> = const { Cell::new(false) };
    }
}
