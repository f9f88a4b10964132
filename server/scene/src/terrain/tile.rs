//! Terrain tiles: 128 × 128 samples quantized to 16 bits above the tile's minimum, delta coded and packed with zstd.

use crate::sections::Flaw;
use std::fs::File;
use std::os::unix::fs::FileExt;

/// Samples along a side of a tile.
pub(super) const SIDE: usize = 128;
/// Samples of a tile.
pub(super) const SAMPLES: usize = SIDE * SIDE;
/// The step between stored heights, metres, unless a tile spans more than 6.5 km.
const STEP_M: f64 = 0.1;
/// The code of a void.
const VOID: u16 = u16::MAX;

/// Where a packed tile lies and how its codes become metres: offset + code · step.
#[derive(Clone, Copy, Debug, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
pub(super) struct TileEntry {
    /// First byte in the blob.
    pub(super) start: u64,
    /// Packed bytes; 0 for a tile that is all void.
    pub(super) length: u32,
    /// Height of code 0, metres.
    pub(super) offset_m: f32,
    /// Metres a code.
    pub(super) step_m: f32,
    /// Checksum of the packed bytes; 0 where the checksum of the file is enough.
    pub(super) checksum: u32,
}

/// The packed tiles of a raster.
#[derive(Debug)]
pub(super) enum Blob {
    /// In memory.
    Memory(Vec<u8>),
    /// In a file, from a byte on: a tile is read when it is needed.
    File(File, u64),
}

impl Blob {
    /// Bytes of memory that it takes.
    pub(super) fn byte_count(&self) -> usize {
        match self {
            Self::Memory(bytes) => bytes.len(),
            Self::File(..) => 0,
        }
    }

    /// The samples of a tile, metres; NaN is void.
    pub(super) fn unpack(&self, entry: &TileEntry) -> Result<Vec<f32>, Flaw> {
        match self {
            Self::Memory(bytes) => unpack(entry, bytes),
            Self::File(file, start) => {
                let mut packed = vec![0u8; entry.length as usize];
                let at = start.checked_add(entry.start).unwrap_or(u64::MAX);
                file.read_exact_at(&mut packed, at).map_err(|error| format!("cannot be read ({error})"))?;
                unpack(&TileEntry { start: 0, ..*entry }, &packed)
            }
        }
    }
}

/// The checksum of packed bytes, not 0.
pub(super) fn checksum(packed: &[u8]) -> u32 {
    let [a, b, c, d, ..] = *blake3::hash(packed).as_bytes();
    u32::from_le_bytes([a, b, c, d]).max(1)
}

/// Packs `samples` (NaN is void) behind `blob`.
pub(super) fn pack(samples: &[f32], blob: &mut Vec<u8>) -> Result<TileEntry, std::io::Error> {
    let valid = samples.iter().copied().filter(|h| h.is_finite());
    let (low, high) = valid.fold((f32::INFINITY, f32::NEG_INFINITY), |(l, h), v| (l.min(v), h.max(v)));
    let start = blob.len() as u64;
    if low > high {
        return Ok(TileEntry { start, length: 0, offset_m: 0.0, step_m: 0.0, checksum: 0 });
    }
    let step_m = STEP_M.max(f64::from(high - low) / f64::from(VOID - 1)) as f32;
    // Differences along a row pack twice as well as heights.
    let mut codes = vec![0u16; samples.len()];
    let mut previous = 0u16;
    for (code, height) in codes.iter_mut().zip(samples) {
        let value = if height.is_finite() {
            (f64::from(height - low) / f64::from(step_m)).round().min(f64::from(VOID - 1)) as u16
        } else {
            VOID
        };
        *code = value.wrapping_sub(previous);
        previous = value;
    }
    let packed = zstd::bulk::compress(bytemuck::cast_slice(&codes), 3)?;
    blob.extend_from_slice(&packed);
    Ok(TileEntry { start, length: packed.len() as u32, offset_m: low, step_m, checksum: 0 })
}

/// The samples of a tile, metres; NaN is void.
fn unpack(entry: &TileEntry, blob: &[u8]) -> Result<Vec<f32>, Flaw> {
    if entry.length == 0 {
        return Ok(vec![f32::NAN; SAMPLES]);
    }
    let broken = || "does not unpack in a tile".to_owned();
    let end = entry.start.checked_add(u64::from(entry.length)).ok_or_else(broken)?;
    let packed = blob.get(entry.start as usize..end as usize).ok_or_else(broken)?;
    if entry.checksum != 0 && checksum(packed) != entry.checksum {
        return Err(broken());
    }
    let bytes = zstd::bulk::decompress(packed, 2 * SAMPLES).map_err(|_| broken())?;
    if bytes.len() != 2 * SAMPLES {
        return Err(broken());
    }
    let mut previous = 0u16;
    let height = |difference: u16| {
        previous = previous.wrapping_add(difference);
        if previous == VOID { f32::NAN } else { entry.offset_m + f32::from(previous) * entry.step_m }
    };
    Ok(bytes.chunks_exact(2).map(|b| u16::from_le_bytes([b[0], b[1]])).map(height).collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn heights_come_back_within_half_a_step(low in -400.0f32..4000.0, span in 0.1f32..9000.0, seed: u64) {
            let mut state = seed | 1;
            let samples: Vec<f32> = (0..SAMPLES).map(|_| {
                state ^= state << 13; state ^= state >> 7; state ^= state << 17;
                if state % 11 == 0 { f32::NAN } else { low + span * ((state >> 40) as f32 / 16_777_216.0) }
            }).collect();
            let mut blob = vec![1, 2, 3];
            let entry = pack(&samples, &mut blob).unwrap();
            let back = unpack(&entry, &blob).unwrap();
            for (a, b) in samples.iter().zip(&back) {
                prop_assert_eq!(a.is_nan(), b.is_nan());
                prop_assert!(a.is_nan() || (a - b).abs() <= 0.51 * entry.step_m + 1e-3, "{} {}", a, b);
            }
            prop_assert!(entry.step_m < 0.15);
            prop_assert!(unpack(&entry, &blob[..blob.len() - 1]).is_err());
        }
    }

    #[test]
    fn a_void_tile_takes_no_bytes() {
        let mut blob = Vec::new();
        let entry = pack(&[f32::NAN; SAMPLES], &mut blob).unwrap();
        assert!(blob.is_empty() && unpack(&entry, &blob).unwrap().iter().all(|h| h.is_nan()));
    }
}
