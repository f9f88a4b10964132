//! Repeatable value noise on the plane, summed over octaves (fractal noise), hashed by SplitMix64's finalizer.

/// A number in 0..1 for a lattice point (splitmix64 of the coordinates).
fn hash(x: i64, y: i64, seed: u64) -> f64 {
    let mut z = (x as u64)
        .wrapping_mul(0x9e37_79b9_7f4a_7c15)
        .wrapping_add((y as u64).wrapping_mul(0xd1b5_4a32_d192_ed03))
        .wrapping_add(seed.wrapping_mul(0x8cb9_2ba7_2f3d_8dd7));
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    ((z ^ (z >> 31)) >> 11) as f64 / (1u64 << 53) as f64
}

/// Smooth noise in 0..1 with features of size 1.
fn smooth(x: f64, y: f64, seed: u64) -> f64 {
    let (x0, y0) = (x.floor(), y.floor());
    let ease = |t: f64| t * t * (3.0 - 2.0 * t);
    let (s, t) = (ease(x - x0), ease(y - y0));
    let (i, j) = (x0 as i64, y0 as i64);
    let top = hash(i, j, seed) * (1.0 - s) + hash(i + 1, j, seed) * s;
    let bottom = hash(i, j + 1, seed) * (1.0 - s) + hash(i + 1, j + 1, seed) * s;
    top * (1.0 - t) + bottom * t
}

/// Octaves of smooth noise, each half as large and twice as fine; 0..1, mean ½.
pub fn octaves(x: f64, y: f64, count: u32, seed: u64) -> f64 {
    let (mut sum, mut weight, mut total, mut scale) = (0.0, 1.0, 0.0, 1.0);
    for octave in 0..count {
        sum += weight * smooth(x * scale, y * scale, seed + u64::from(octave));
        total += weight;
        weight *= 0.5;
        scale *= 2.0;
    }
    sum / total
}

/// The same with creases, as mountains have: 1 on ridges, 0 in the valleys between.
pub fn ridges(x: f64, y: f64, count: u32, seed: u64) -> f64 {
    let (mut sum, mut weight, mut total, mut scale) = (0.0, 1.0, 0.0, 1.0);
    for octave in 0..count {
        let crease = 1.0 - (2.0 * smooth(x * scale, y * scale, seed + u64::from(octave)) - 1.0).abs();
        sum += weight * crease * crease;
        total += weight;
        weight *= 0.5;
        scale *= 2.0;
    }
    sum / total
}
