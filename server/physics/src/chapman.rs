//! Columns through an exponential species of a spherical atmosphere: the Chapman function (Chapman 1931), tabulated
//! (`docs/model.md#optical-depth`).
//!
//! For a ray that starts at altitude z with cosine of the zenith angle μ ≥ 0, the column above it is
//! `∫₀^∞ e^{−z(t)/H} dt = H · e^{−z/H} · Ch(X, μ)`, with X = (R + z)/H and Ch the Chapman function. With
//! 2v = (r/r₀)² − 1 the path element is r₀dv/√(μ² + 2v), and with y = Xv, a = Xμ²/2
//!
//!   Ch = √(X/2) · ∫₀^∞ exp(−X(√(1 + 2y/X) − 1)) / √(a + y) dy
//!      = √(X/2) · [J₀(a) + εJ₁(a) + ε²J₂(a) + ε³J₃(a) + …],   ε = 1/X,
//!
//! with moments J of e^{−y}·(1, y²/2, y⁴/8 − y³/2, y⁶/48 − y⁵/4 + 5y⁴/8)/√(a + y). X is 800 for molecules and
//! 5 300 for aerosol, so the rest is below 1e-8. The sum depends on p = √a alone but for a small change of ε
//! with altitude, so one table over s = 1/(1 + p) serves every altitude, band and turbidity.

use crate::{
    atmosphere::{AEROSOL_SCALE_HEIGHT_M, MOLECULE_SCALE_HEIGHT_M},
    geometry::EARTH_RADIUS_M,
    quadrature::gauss_legendre,
};
use std::sync::LazyLock;

const INTERVALS: usize = 1024;

/// The Chapman function of one species, tabulated. Relative error below 1e-7 for 0 ≤ μ ≤ 1 and altitudes
/// from 0 to 300 km (tested against adaptive quadrature).
#[derive(Debug)]
pub struct ChapmanTable {
    scale_height_m: f64,
    reference_epsilon: f64,
    /// Cubic Hermite coefficients per interval of s: value at the reference ε, and its derivative by ε, both
    /// times (1 + p) to stay finite.
    cells: Vec<[[f64; 4]; 2]>,
}

static MOLECULES: LazyLock<ChapmanTable> = LazyLock::new(|| ChapmanTable::new(MOLECULE_SCALE_HEIGHT_M));
static AEROSOL: LazyLock<ChapmanTable> = LazyLock::new(|| ChapmanTable::new(AEROSOL_SCALE_HEIGHT_M));

/// The table for molecules (H = 8.0 km); computed at first use.
pub fn molecules() -> &'static ChapmanTable {
    &MOLECULES
}

/// The table for aerosol (H = 1.2 km); computed at first use.
pub fn aerosol() -> &'static ChapmanTable {
    &AEROSOL
}

/// J₀ … J₃ at a = p².
fn moments(p: f64, nodes: &[(f64, f64)]) -> [f64; 4] {
    // y = q²: the integrand becomes smooth but for a kink near q = p, where the range is split. e^{−q²} ends
    // it at q = 7.5 (3e-25).
    let mut edges = vec![0.0, 1.5, 3.5, 7.5];
    edges.extend((-1..7).map(|k| p * 4f64.powi(k)).filter(|&edge| edge < 7.5));
    edges.sort_by(f64::total_cmp);
    let mut sums = [0.0; 4];
    for pair in edges.windows(2) {
        let (low, high) = (pair[0], pair[1]);
        if high - low < 1e-14 {
            continue;
        }
        for &(x, weight) in nodes {
            let q = low + (high - low) * x;
            let y = q * q;
            let kernel = (high - low) * weight * 2.0 * q * (-y).exp() / (p * p + y).sqrt();
            let y2 = y * y;
            sums[0] += kernel;
            sums[1] += kernel * y2 / 2.0;
            sums[2] += kernel * (y2 * y2 / 8.0 - y2 * y / 2.0);
            sums[3] += kernel * (y2 * y2 * y2 / 48.0 - y2 * y2 * y / 4.0 + 5.0 * y2 * y2 / 8.0);
        }
    }
    sums
}

impl ChapmanTable {
    fn new(scale_height_m: f64) -> Self {
        let reference_epsilon = scale_height_m / EARTH_RADIUS_M;
        let e = reference_epsilon;
        let nodes = gauss_legendre(40);
        let values: Vec<[f64; 2]> = (0..=INTERVALS)
            .map(|i| {
                let s = i as f64 / INTERVALS as f64;
                if i == 0 {
                    // p → ∞: (1 + p)·J_n → ∫ e^{−y}·polynomial dy = 1, 1, 0, …
                    return [1.0 + e, 1.0];
                }
                let p = 1.0 / s - 1.0;
                let j = moments(p, &nodes);
                [
                    (1.0 + p) * (j[0] + e * (j[1] + e * (j[2] + e * j[3]))),
                    (1.0 + p) * (j[1] + e * (2.0 * j[2] + 3.0 * e * j[3])),
                ]
            })
            .collect();
        let slope = |i: usize, k: usize| {
            // Fourth-order differences, one-sided at the ends.
            let v = |j: usize| values[j][k];
            match i {
                0 => (-25.0 * v(0) + 48.0 * v(1) - 36.0 * v(2) + 16.0 * v(3) - 3.0 * v(4)) / 12.0,
                1 => (-3.0 * v(0) - 10.0 * v(1) + 18.0 * v(2) - 6.0 * v(3) + v(4)) / 12.0,
                i if i == INTERVALS => {
                    (25.0 * v(i) - 48.0 * v(i - 1) + 36.0 * v(i - 2) - 16.0 * v(i - 3) + 3.0 * v(i - 4))
                        / 12.0
                }
                i if i == INTERVALS - 1 => {
                    (3.0 * v(i + 1) + 10.0 * v(i) - 18.0 * v(i - 1) + 6.0 * v(i - 2) - v(i - 3)) / 12.0
                }
                i => (v(i - 2) - 8.0 * v(i - 1) + 8.0 * v(i + 1) - v(i + 2)) / 12.0,
            }
        };
        let cells = (0..INTERVALS)
            .map(|i| {
                std::array::from_fn(|k| {
                    let (v0, v1, d0, d1) = (values[i][k], values[i + 1][k], slope(i, k), slope(i + 1, k));
                    [v0, d0, 3.0 * (v1 - v0) - 2.0 * d0 - d1, 2.0 * (v0 - v1) + d0 + d1]
                })
            })
            .collect();
        Self { scale_height_m, reference_epsilon, cells }
    }

    /// The table at altitude z [m] above the sphere: what several directions there share.
    #[inline]
    pub fn at(&self, altitude_m: f64) -> ChapmanAt<'_> {
        let x = (EARTH_RADIUS_M + altitude_m) / self.scale_height_m;
        ChapmanAt {
            table: self,
            root: (0.5 * x).sqrt(),
            epsilon_less_reference: 1.0 / x - self.reference_epsilon,
        }
    }

    /// Ch(X, μ) at altitude z [m] above the sphere for 0 ≤ μ ≤ 1: the column along the ray over the
    /// column H·e^{−z/H} straight up (of a plane-parallel atmosphere).
    #[inline]
    pub fn chapman(&self, altitude_m: f64, cos_zenith: f64) -> f64 {
        self.at(altitude_m).chapman(cos_zenith)
    }

    /// Column [m] above a point along an upward ray, relative to the density at z = 0:
    /// H·e^{−z/H}·Ch. Times the extinction at z = 0 it is the optical depth to space.
    #[inline]
    pub fn column_m(&self, altitude_m: f64, cos_zenith: f64, relative_density: f64) -> f64 {
        self.at(altitude_m).column_m(cos_zenith, relative_density)
    }
}

/// A [`ChapmanTable`] at one altitude.
#[derive(Clone, Copy, Debug)]
pub struct ChapmanAt<'a> {
    table: &'a ChapmanTable,
    /// √(X/2).
    root: f64,
    /// ε less the table's own.
    epsilon_less_reference: f64,
}

impl ChapmanAt<'_> {
    /// As [`ChapmanTable::chapman`].
    #[inline]
    pub fn chapman(&self, cos_zenith: f64) -> f64 {
        let one_plus_p = 1.0 + cos_zenith.max(0.0) * self.root;
        let position = INTERVALS as f64 / one_plus_p;
        let cell = (position as usize).min(INTERVALS - 1);
        let t = position - cell as f64;
        let [value, slope] = &self.table.cells[cell];
        let cubic = |c: &[f64; 4]| c[0] + t * (c[1] + t * (c[2] + t * c[3]));
        self.root / one_plus_p * (cubic(value) + self.epsilon_less_reference * cubic(slope))
    }

    /// As [`ChapmanTable::column_m`].
    #[inline]
    pub fn column_m(&self, cos_zenith: f64, relative_density: f64) -> f64 {
        self.table.scale_height_m * relative_density * self.chapman(cos_zenith)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::quadrature::integrate_adaptive;

    /// The column by brute force along the ray, relative to H·e^{−z/H}.
    fn chapman_by_quadrature(scale_height_m: f64, altitude_m: f64, mu: f64) -> f64 {
        let r0 = EARTH_RADIUS_M + altitude_m;
        let density = |t: f64| {
            // z − z₀ without cancellation: (2 r₀ μ t + t²)/(r + r₀).
            let r = (r0 * r0 + 2.0 * r0 * mu * t + t * t).sqrt();
            (-(2.0 * r0 * mu * t + t * t) / (r + r0) / scale_height_m).exp()
        };
        let mut total = 0.0;
        let mut low = 0.0;
        let mut high = scale_height_m;
        for _ in 0..14 {
            total += integrate_adaptive(low, high, 1e-12, 0.0, |t| [density(t)])[0];
            (low, high) = (high, high * 2.0);
        }
        total / scale_height_m
    }

    /// The table agrees with quadrature to 1e-7 everywhere.
    #[test]
    fn table_agrees_with_quadrature() {
        let mut worst: f64 = 0.0;
        for table in [molecules(), aerosol()] {
            for altitude_m in [0.0, 100.0, 1_700.0, 6_000.0, 30_000.0, 120_000.0, 300_000.0] {
                for mu in [0.0, 1e-5, 1e-4, 1e-3, 3e-3, 0.01, 0.02, 0.05, 0.1, 0.2, 0.4, 0.7, 0.95, 1.0] {
                    let reference = chapman_by_quadrature(table.scale_height_m, altitude_m, mu);
                    let error = (table.chapman(altitude_m, mu) / reference - 1.0).abs();
                    worst = worst.max(error);
                    assert!(error < 1e-7, "H {} z {altitude_m} mu {mu}: {error:e}", table.scale_height_m);
                }
            }
        }
        // Negative control: the plane-parallel 1/μ is far outside.
        assert!((1.0 / 0.1 / molecules().chapman(0.0, 0.1) - 1.0).abs() > 1e-2);
        println!("worst relative error {worst:e}");
    }
}
