//! Inner loops compiled for AVX2 with fused multiply-add too, and chosen at run time: baselines and measures of the machine
//! get the vectors that the engine's own loops have.

/// Defines `$name`, which runs `$body` with AVX2 and fused multiply-add where the processor has both. `$body` takes
/// whether multiply-adds are to be fused as its constant parameter: without the instruction that is a library call.
macro_rules! dispatch_wide {
    ($(#[$docs:meta])* $name:ident, $wide:ident, $body:ident, ($($argument:ident: $kind:ty),*) -> $result:ty) => {
        $(#[$docs])*
        fn $name($($argument: $kind),*) -> $result {
            #[cfg(target_arch = "x86_64")]
            if is_x86_feature_detected!("avx2") && is_x86_feature_detected!("fma") {
                #[expect(unsafe_code, reason = "the processor was just asked for what the callee needs; the baseline's \
                    code takes several times as long, and a slow baseline would flatter the engine")]
                // SAFETY: AVX2 and FMA are there, and the function has no other precondition.
                return unsafe { $wide($($argument),*) };
            }
            $body::<false>($($argument),*)
        }

        #[cfg(target_arch = "x86_64")]
        #[target_feature(enable = "avx2,fma")]
        fn $wide($($argument: $kind),*) -> $result {
            $body::<true>($($argument),*)
        }
    };
}
pub(crate) use dispatch_wide;

/// `a · b + c`, fused or not.
#[inline(always)]
pub(crate) fn multiply_add<const FUSED: bool>(a: f32, b: f32, c: f32) -> f32 {
    if FUSED { a.mul_add(b, c) } else { a * b + c }
}
