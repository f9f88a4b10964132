//! Morton codes (Morton 1966): column and row of a pixel interleaved, so that a block of 2^k × 2^k pixels is one run of
//! codes and its code is the pixels' code shifted right by 2k.

/// Spreads the 32 bits of `x` over the even bits of the result.
fn spread(x: u32) -> u64 {
    let mut v = u64::from(x);
    v = (v | (v << 16)) & 0x0000_ffff_0000_ffff;
    v = (v | (v << 8)) & 0x00ff_00ff_00ff_00ff;
    v = (v | (v << 4)) & 0x0f0f_0f0f_0f0f_0f0f;
    v = (v | (v << 2)) & 0x3333_3333_3333_3333;
    (v | (v << 1)) & 0x5555_5555_5555_5555
}

/// The even bits of `v`, pressed together.
fn press(v: u64) -> u32 {
    let mut v = v & 0x5555_5555_5555_5555;
    v = (v | (v >> 1)) & 0x3333_3333_3333_3333;
    v = (v | (v >> 2)) & 0x0f0f_0f0f_0f0f_0f0f;
    v = (v | (v >> 4)) & 0x00ff_00ff_00ff_00ff;
    v = (v | (v >> 8)) & 0x0000_ffff_0000_ffff;
    ((v | (v >> 16)) & 0xffff_ffff) as u32
}

/// The code of a pixel; columns take the even bits.
pub(crate) fn encode(column: u32, row: u32) -> u64 {
    spread(column) | (spread(row) << 1)
}

/// (column, row) of a code.
pub(crate) fn decode(code: u64) -> (u32, u32) {
    (press(code), press(code >> 1))
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn decoding_undoes_encoding(column: u32, row: u32) {
            prop_assert_eq!(decode(encode(column, row)), (column, row));
        }

        /// The code of a block is the shifted code of its pixels.
        #[test]
        fn a_block_code_is_a_shifted_pixel_code(column: u32, row: u32, k in 0u32..16) {
            prop_assert_eq!(encode(column, row) >> (2 * k), encode(column >> k, row >> k));
        }
    }
}
