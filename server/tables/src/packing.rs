//! What makes sections small: bytes in another order, and differences along the distance. All of it is lossless.

use half::f16;

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

#[cfg(test)]
mod tests {
    use super::*;

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
}
