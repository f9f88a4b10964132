//! The inner loops, compiled for AVX2 too and chosen at run time.
//!
//! No fused multiply-add, so that every machine gives the same bits.

/// Defines `$name`, which runs `$body` compiled with AVX2 where the processor has it.
macro_rules! dispatch_avx2 {
    ($(#[$docs:meta])* $name:ident, $avx2:ident, $body:ident, ($($argument:ident: $kind:ty),*)) => {
        $(#[$docs])*
        pub(crate) fn $name($($argument: $kind),*) {
            #[cfg(target_arch = "x86_64")]
            if is_x86_feature_detected!("avx2") {
                #[expect(unsafe_code, reason = "the processor was just asked for AVX2, all that the callee needs; \
                    the auto-vectoriser's baseline code takes three times as long")]
                // SAFETY: AVX2 is there, and the function has no other precondition.
                unsafe { $avx2($($argument),*) };
                return;
            }
            $body($($argument),*);
        }

        #[cfg(target_arch = "x86_64")]
        #[target_feature(enable = "avx2")]
        fn $avx2($($argument: $kind),*) {
            $body($($argument),*);
        }
    };
}
pub(crate) use dispatch_avx2;
