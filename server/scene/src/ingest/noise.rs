//! Noise around zero: monthly composites have it, half of it below zero. Cutting the negatives alone leaves the other half, which
//! adds up to more light than a dark country has.
//!
//! Every negative value takes as much from the faintest pixels around it, in its block of 8 × 8 pixels first, then in blocks of
//! twice the side up to 1024 pixels. So the light of a block stays the sum of its pixels, what is left of noise is what its sum
//! happens to be, and pixels brighter than three standard deviations are never touched.

use crate::lit_pixels::LitPixels;
use std::collections::BTreeMap;

/// Negatives are taken for noise where they are at least this many, and this part of the measured pixels.
const MIN_NEGATIVES: u64 = 100;
const MIN_SHARE: f64 = 0.01;
/// Blocks of 2^FIRST_LEVEL pixels a side balance first, those of 2^LAST_LEVEL last.
const FIRST_LEVEL: u32 = 3;
const LAST_LEVEL: u32 = 10;
/// Standard deviations up to which a pixel can be noise.
const NOISE_DEVIATIONS: f64 = 3.0;
/// The median of |x| of a normal distribution, in standard deviations.
const MEDIAN_DEVIATION: f64 = 0.674_49;
/// Bins of the histogram of magnitudes: 32 to a factor of ten from 1e-6 on.
const BINS: usize = 512;
const BINS_PER_DECADE: f64 = 32.0;
const FIRST_DECADE: f64 = -6.0;

/// The negative values of a raster, by block.
#[derive(Clone, Debug, Default)]
pub(super) struct Negatives {
    /// Σ |value| by the Morton code of the block, nW cm⁻² sr⁻¹.
    deficit: BTreeMap<u64, f64>,
    histogram: Vec<u64>,
    count: u64,
    sum: f64,
}

/// What balancing did.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Balanced {
    /// Standard deviation of the noise, nW cm⁻² sr⁻¹.
    pub(super) deviation: f64,
    /// Lit pixels that became dark.
    pub(super) darkened: u64,
    /// Light taken from faint pixels, nW cm⁻² sr⁻¹ summed over pixels.
    pub(super) taken: f64,
    /// Negatives that found no faint light nearby, as well.
    pub(super) left: f64,
}

impl Negatives {
    /// Adds one negative pixel.
    pub(super) fn add(&mut self, code: u64, value: f64) {
        let magnitude = -value;
        *self.deficit.entry(code >> (2 * FIRST_LEVEL)).or_default() += magnitude;
        if self.histogram.is_empty() {
            self.histogram = vec![0; BINS];
        }
        let bin = (magnitude.log10() - FIRST_DECADE) * BINS_PER_DECADE;
        self.histogram[(bin.max(0.0) as usize).min(BINS - 1)] += 1;
        self.count += 1;
        self.sum += magnitude;
    }

    /// Σ |value|.
    pub(super) fn sum(&self) -> f64 {
        self.sum
    }

    /// Whether there are enough of them to be noise.
    pub(super) fn are_noise(&self, measured: u64) -> bool {
        self.count >= MIN_NEGATIVES && self.count as f64 >= MIN_SHARE * measured as f64
    }

    /// Standard deviation by the median of the magnitudes, nW cm⁻² sr⁻¹.
    fn deviation(&self) -> f64 {
        let mut below = 0;
        let median = self.histogram.iter().position(|count| {
            below += count;
            2 * below >= self.count
        });
        let decade = FIRST_DECADE + (median.unwrap_or(0) as f64 + 0.5) / BINS_PER_DECADE;
        10f64.powf(decade) / MEDIAN_DEVIATION
    }

    /// What there is where nothing is balanced.
    pub(super) fn left_alone(&self) -> Balanced {
        Balanced { deviation: self.deviation(), darkened: 0, taken: 0.0, left: self.sum }
    }

    /// Takes the negatives from the faint pixels around them. The pixels stay sorted.
    pub(super) fn balance(self, pixels: &mut LitPixels) -> Balanced {
        let deviation = self.deviation();
        let faint_below = (NOISE_DEVIATIONS * deviation) as f32;
        let (mut deficit, mut taken) = (self.deficit, 0.0);
        let mut faint: Vec<u32> = (0..pixels.len() as u32)
            .filter(|&i| pixels.radiance_nw_cm2_sr[i as usize] < faint_below)
            .collect();
        for level in FIRST_LEVEL..=LAST_LEVEL {
            let mut left = BTreeMap::new();
            let mut start = 0;
            for (block, mut missing) in deficit {
                let block_of = |i: &u32| pixels.codes[*i as usize] >> (2 * level);
                start += faint[start..].partition_point(|i| block_of(i) < block);
                let end = start + faint[start..].partition_point(|i| block_of(i) == block);
                let mut order = faint[start..end].to_vec();
                order.sort_by(|a, b| {
                    let value = |i: &u32| pixels.radiance_nw_cm2_sr[*i as usize];
                    value(a).total_cmp(&value(b)).then(a.cmp(b))
                });
                for pixel in order {
                    let value = &mut pixels.radiance_nw_cm2_sr[pixel as usize];
                    let part = f64::from(*value).min(missing);
                    *value = if part < f64::from(*value) { (f64::from(*value) - part) as f32 } else { 0.0 };
                    missing -= part;
                    taken += part;
                    if missing <= 0.0 {
                        break;
                    }
                }
                start = end;
                if missing > 0.0 {
                    *left.entry(block >> 2).or_insert(0.0) += missing;
                }
            }
            faint.retain(|i| pixels.radiance_nw_cm2_sr[*i as usize] > 0.0);
            deficit = left;
        }
        let before = pixels.len();
        pixels.drop_dark();
        let darkened = (before - pixels.len()) as u64;
        Balanced { deviation, darkened, taken, left: deficit.values().sum() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::morton;

    const SIDE: u32 = 256;

    /// Noise of a repeatable generator, standard deviation about 0.15, and a town of 9 pixels.
    fn noisy(town: f32) -> (LitPixels, Negatives, f64) {
        let (mut pixels, mut negatives, mut sum) = (LitPixels::default(), Negatives::default(), 0.0);
        let mut state = 7u64;
        let mut unit = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 11) as f64 / (1u64 << 53) as f64
        };
        for row in 0..SIDE {
            for column in 0..SIDE {
                let normal: f64 = (0..12).map(|_| unit()).sum::<f64>() - 6.0;
                let is_town = (100..103).contains(&row) && (100..103).contains(&column);
                let value = 0.15 * normal + if is_town { f64::from(town) } else { 0.0 };
                sum += value;
                let code = morton::encode(column, row);
                if value < 0.0 {
                    negatives.add(code, value);
                } else if value > 0.0 {
                    pixels.codes.push(code);
                    pixels.radiance_nw_cm2_sr.push(value as f32);
                    pixels.altitude_m.push(0.0);
                }
            }
        }
        pixels.sort();
        (pixels, negatives, sum)
    }

    /// What is left of noise is its sum, not its positive half; a town keeps every watt.
    #[test]
    fn symmetric_noise_goes_and_light_stays() {
        let (mut pixels, negatives, sum) = noisy(20.0);
        let cut: f64 = pixels.radiance_nw_cm2_sr.iter().map(|v| f64::from(*v)).sum();
        assert!(negatives.are_noise(u64::from(SIDE * SIDE)));
        let balanced = negatives.balance(&mut pixels);
        let kept: f64 = pixels.radiance_nw_cm2_sr.iter().map(|v| f64::from(*v)).sum();
        assert!((0.14..0.16).contains(&balanced.deviation), "{balanced:?}");
        assert!((kept - sum - balanced.left).abs() < 1e-2, "{kept} {sum} {balanced:?}");
        // Cutting alone keeps 0.4 σ a pixel, some 3 900; the town is 180.
        assert!(cut > 10.0 * sum.abs().max(180.0) && kept < 1.3 * 180.0, "{cut} {kept}");
        let town = pixels.index_at(101, 101).map(|i| pixels.radiance_nw_cm2_sr[i]);
        assert!(town.is_some_and(|value| value > 19.0), "{town:?}");
        assert!(pixels.codes.windows(2).all(|pair| pair[0] < pair[1]));
    }

    /// A few negatives are no noise.
    #[test]
    fn a_few_negatives_are_no_noise() {
        let mut negatives = Negatives::default();
        (0..99).for_each(|i| negatives.add(i, -0.1));
        assert!(!negatives.are_noise(1_000));
        negatives.add(99, -0.1);
        assert!(negatives.are_noise(1_000) && !negatives.are_noise(100_000));
    }
}
