//! Quadrature: Gauss–Legendre nodes (Gauss 1814), and adaptive Gauss–Kronrod for several integrals at once (Kronrod 1965;
//! QUADPACK, Piessens et al. 1983), and the steps of a sequence of points (R2, Roberts 2018).

/// Steps of the additive recurrence R2, a sequence that fills the unit square evenly (Roberts 2018).
pub const R2: [f64; 2] = [0.754_877_666_246_692_7, 0.569_840_290_998_053_2];

/// Nodes on 0..1 and weights summing to 1 of the n-point Gauss–Legendre rule.
pub fn gauss_legendre(n: usize) -> Vec<(f64, f64)> {
    let count = n as f64;
    let mut nodes: Vec<(f64, f64)> = (0..n)
        .map(|i| {
            // Newton from the Chebyshev guess; p and its derivative by the three-term recurrence.
            let mut x = (std::f64::consts::PI * (i as f64 + 0.75) / (count + 0.5)).cos();
            let mut derivative = 0.0;
            for _ in 0..100 {
                let (mut p0, mut p1) = (1.0, x);
                for k in 2..=n {
                    let k = k as f64;
                    (p0, p1) = (p1, ((2.0 * k - 1.0) * x * p1 - (k - 1.0) * p0) / k);
                }
                if n == 1 {
                    p0 = 1.0;
                }
                derivative = count * (x * p1 - p0) / (x * x - 1.0);
                let step = p1 / derivative;
                x -= step;
                if step.abs() < 1e-16 {
                    break;
                }
            }
            (0.5 * (1.0 - x), 1.0 / ((1.0 - x * x) * derivative * derivative))
        })
        .collect();
    nodes.sort_by(|a, b| a.0.total_cmp(&b.0));
    nodes
}

/// Positive abscissae of the 15-point Kronrod rule; odd positions are the 7-point Gauss rule's.
const KRONROD_X: [f64; 8] = [
    0.991_455_371_120_812_6,
    0.949_107_912_342_758_5,
    0.864_864_423_359_769_1,
    0.741_531_185_599_394_4,
    0.586_087_235_467_691_1,
    0.405_845_151_377_397_2,
    0.207_784_955_007_898_47,
    0.0,
];
const KRONROD_W: [f64; 8] = [
    0.022_935_322_010_529_224,
    0.063_092_092_629_978_55,
    0.104_790_010_322_250_18,
    0.140_653_259_715_525_92,
    0.169_004_726_639_267_9,
    0.190_350_578_064_785_4,
    0.204_432_940_075_298_9,
    0.209_482_141_084_727_82,
];
const GAUSS_W: [f64; 4] =
    [0.129_484_966_168_869_7, 0.279_705_391_489_276_64, 0.381_830_050_505_118_9, 0.417_959_183_673_469_4];

/// Kronrod value and error estimate of N integrals over low..high.
fn kronrod<const N: usize>(
    low: f64,
    high: f64,
    integrand: &mut impl FnMut(f64) -> [f64; N],
) -> ([f64; N], [f64; N]) {
    let (center, half) = (0.5 * (low + high), 0.5 * (high - low));
    let mut fine = [0.0; N];
    let mut coarse = [0.0; N];
    for (i, (&x, &weight)) in KRONROD_X.iter().zip(&KRONROD_W).enumerate() {
        let gauss_weight = if i % 2 == 1 { GAUSS_W[i / 2] } else { 0.0 };
        let mut add = |value: [f64; N]| {
            for k in 0..N {
                fine[k] += weight * value[k];
                coarse[k] += gauss_weight * value[k];
            }
        };
        add(integrand(center + half * x));
        if x != 0.0 {
            add(integrand(center - half * x));
        }
    }
    let mut error = [0.0; N];
    for k in 0..N {
        fine[k] *= half;
        coarse[k] *= half;
        // QUADPACK's: the difference is the error of the 7-point rule; the 15-point one has nearly twice the
        // digits.
        let difference = (fine[k] - coarse[k]).abs();
        let scale = fine[k].abs().max(f64::MIN_POSITIVE);
        let ratio = 200.0 * difference / scale;
        error[k] = scale * (ratio * ratio.sqrt()).min(difference / scale);
    }
    (fine, error)
}

/// A part of the range with its Kronrod values and error estimates.
struct Part<const N: usize> {
    low: f64,
    high: f64,
    value: [f64; N],
    error: [f64; N],
    depth: u32,
}

/// N integrals at once over low..high, bisecting until for each of them the estimated error of a part is
/// below `tolerance` times its share of max(|its whole|, `floor`). At most 40 levels deep.
pub fn integrate_adaptive<const N: usize>(
    low: f64,
    high: f64,
    tolerance: f64,
    floor: f64,
    mut integrand: impl FnMut(f64) -> [f64; N],
) -> [f64; N] {
    integrate_pieces(&[low, high], tolerance, floor, &mut integrand)
}

/// As [`integrate_adaptive`], over pieces between ascending `edges` where the integrand is known to have kinks.
pub fn integrate_pieces<const N: usize>(
    edges: &[f64],
    tolerance: f64,
    floor: f64,
    integrand: &mut impl FnMut(f64) -> [f64; N],
) -> [f64; N] {
    let mut parts: Vec<Part<N>> = Vec::with_capacity(32);
    let mut total = [0.0; N];
    for pair in edges.windows(2) {
        if pair[1] > pair[0] {
            let (value, error) = kronrod(pair[0], pair[1], integrand);
            for k in 0..N {
                total[k] += value[k];
            }
            parts.push(Part { low: pair[0], high: pair[1], value, error, depth: 0 });
        }
    }
    // Depth first; `total` always holds the best values of all parts, so the criterion sharpens as it goes.
    let mut sum = [0.0; N];
    while let Some(Part { low, high, value, error, depth }) = parts.pop() {
        // Errors of the parts add up: a few dozen parts at most, each allowed a tenth.
        let good = (0..N).all(|k| error[k] <= 0.1 * tolerance * total[k].abs().max(floor));
        if good || depth >= 40 {
            for k in 0..N {
                sum[k] += value[k];
            }
            continue;
        }
        let middle = 0.5 * (low + high);
        for (a, b) in [(low, middle), (middle, high)] {
            let (half_value, half_error) = kronrod(a, b, integrand);
            for k in 0..N {
                total[k] += half_value[k];
            }
            parts.push(Part { low: a, high: b, value: half_value, error: half_error, depth: depth + 1 });
        }
        for k in 0..N {
            total[k] -= value[k];
        }
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Gauss–Legendre rules integrate polynomials of twice their order.
    #[test]
    fn gauss_legendre_integrates_polynomials() {
        for n in [1, 2, 5, 12, 24, 40] {
            let nodes = gauss_legendre(n);
            assert!((nodes.iter().map(|node| node.1).sum::<f64>() - 1.0).abs() < 1e-13);
            let power = 2 * n as i32 - 1;
            let integral: f64 = nodes.iter().map(|&(x, w)| w * x.powi(power)).sum();
            assert!((integral * f64::from(power + 1) - 1.0).abs() < 1e-11, "{n}");
        }
    }

    /// The adaptive rule reaches its tolerance on a sharp peak and a root.
    #[test]
    fn adaptive_rule_reaches_its_tolerance() {
        let exact = 2.0 * (1.0f64 / 1e-4).atan() / 1e-4;
        let got = integrate_adaptive(-1.0, 1.0, 1e-9, 0.0, |x| [1.0 / (x * x + 1e-8), x.abs().sqrt()]);
        assert!((got[0] / exact - 1.0).abs() < 1e-9);
        assert!((got[1] / (4.0 / 3.0) - 1.0).abs() < 1e-9);
    }
}
