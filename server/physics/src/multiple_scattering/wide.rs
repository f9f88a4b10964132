//! Inner loops compiled for AVX2 too and chosen at run time: vectors of eight where the baseline has four. Nothing is
//! fused or reordered, so both give the same bits, and tables do not depend on the processor.

/// Defines `$name`, which runs `$body` compiled with AVX2 where the processor has it. `$body` and what it calls must be
/// `#[inline(always)]` to gain by that.
macro_rules! dispatch_wide {
    ($(#[$docs:meta])* $name:ident, $wide:ident, $body:ident, ($($argument:ident: $kind:ty),* $(,)?)) => {
        $(#[$docs])*
        fn $name($($argument: $kind),*) {
            #[cfg(target_arch = "x86_64")]
            if is_x86_feature_detected!("avx2") {
                #[expect(unsafe_code, reason = "the processor was just asked for what the callee needs; fields are solved in \
                    four fifths of the time and seen in three fifths")]
                // SAFETY: AVX2 is there, and the function has no other precondition.
                unsafe { $wide($($argument),*) };
                return;
            }
            $body($($argument),*);
        }

        #[cfg(target_arch = "x86_64")]
        #[target_feature(enable = "avx2")]
        fn $wide($($argument: $kind),*) {
            $body($($argument),*);
        }
    };
}
pub(super) use dispatch_wide;
