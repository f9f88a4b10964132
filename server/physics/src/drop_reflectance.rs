//! What a plane layer of cloud drops reflects, by adding and doubling (van de Hulst 1963; Hansen and Travis 1974;
//! `docs/model.md#overcast`).
//!
//! A layer so thin that light is scattered once in it is doubled until it has its optical depth. Drops scatter by Henyey and
//! Greenstein's phase function and absorb nothing. Reflectance R is relative to a white Lambertian surface,
//!
//!   L = R(μ, μ₀, φ)·E/π,
//!
//! with the cosines μ₀ and μ of the zenith angles of the arriving and the leaving light and the azimuth φ by which it turns, 0 where it
//! goes straight on. It is a Fourier series in φ, of which each term is doubled by itself: terms are matrices over the nodes of a
//! Gauss–Legendre rule and, with the weight 0, over the angles of the table.

use crate::quadrature::gauss_legendre;
use faer::{Accum, Mat, Par, linalg::matmul::matmul};
use std::{
    collections::BTreeMap,
    f64::consts::{FRAC_PI_2, PI},
    sync::{Mutex, OnceLock, PoisonError},
};

/// Asymmetry g of the phase function of cloud drops.
pub const DROP_ASYMMETRY: f64 = 0.85;

/// Nodes of the rule over the cosine of the zenith angle.
const NODE_COUNT: usize = 36;
/// Terms of the phase function in Legendre polynomials: as many as the rule integrates. g^72 is 8e-6.
const DEGREE_COUNT: usize = 2 * NODE_COUNT;
/// Angles over the base in the table, crowding at the horizon: number i is at 90°·(i/40)².
const ANGLE_COUNT: usize = 41;
/// Azimuths in the table, crowding at 0: number i is at 180°·(i/40)².
const AZIMUTH_COUNT: usize = 41;
/// The lowest angle, radians.
const MIN_ANGLE_RAD: f64 = 2e-3;
/// Optical depth in which light is scattered once, at most.
const THIN_DEPTH: f64 = 1e-6;
/// What comes back between two layers is summed up to this share.
const SMALLEST_TERM: f64 = 1e-13;
/// Least R in the table: its logarithm is interpolated.
const DARKNESS: f64 = 1e-9;

/// Reflectance of a layer of drops.
#[derive(Debug)]
pub(crate) struct DropReflectance {
    /// ln(R·(μ + μ₀)), `[angle of light][angle of view][azimuth]`.
    ln_scaled: Vec<f64>,
    /// Share of the light from an angle that is reflected, `[angle]`.
    plane_albedo: Vec<f64>,
    /// Share of diffuse light that is reflected.
    spherical_albedo: f64,
}

/// A layer of an optical depth, whose reflectance is computed when it is first asked for: who only names the layer does not wait.
#[derive(Debug)]
pub(crate) struct DropLayer {
    optical_depth: f64,
    reflectance: OnceLock<DropReflectance>,
}

/// Layers by the bits of their optical depths: few, and each serves as long as the program runs.
static KNOWN: Mutex<BTreeMap<u64, &'static DropLayer>> = Mutex::new(BTreeMap::new());

impl DropLayer {
    /// The layer of an optical depth.
    pub(crate) fn of_depth(optical_depth: f64) -> &'static Self {
        let mut known = KNOWN.lock().unwrap_or_else(PoisonError::into_inner);
        known
            .entry(optical_depth.to_bits())
            .or_insert_with(|| Box::leak(Box::new(Self { optical_depth, reflectance: OnceLock::new() })))
    }

    /// Its reflectance.
    pub(crate) fn get(&self) -> &DropReflectance {
        self.reflectance.get_or_init(|| DropReflectance::new(self.optical_depth, DROP_ASYMMETRY))
    }
}

/// The place of a share of the largest angle or azimuth among so many nodes: the lower one and the weight of the next.
fn stencil(share: f64, count: usize) -> (usize, f64) {
    let place = share.max(0.0).sqrt() * (count - 1) as f64;
    let lower = (place as usize).min(count - 2);
    // Linear in the angle, not in the place.
    let squares = [lower, lower + 1].map(|node| (node * node) as f64);
    (lower, ((place * place - squares[0]) / (squares[1] - squares[0])).min(1.0))
}

fn squared_share(node: usize, count: usize) -> f64 {
    (node as f64 / (count - 1) as f64).powi(2)
}

impl DropReflectance {
    fn new(optical_depth: f64, asymmetry: f64) -> Self {
        let angle_rad = |node| (FRAC_PI_2 * squared_share(node, ANGLE_COUNT)).max(MIN_ANGLE_RAD);
        let angles = Angles::new((0..ANGLE_COUNT).map(angle_rad).map(f64::sin));
        // On this thread alone: one of the pool that waited for others here could take up work that waits for this table.
        let terms: Vec<Mat<f64>> =
            (0..DEGREE_COUNT).map(|order| angles.doubled(order, optical_depth, asymmetry).0).collect();
        let cosine = |angle: usize| angles.cosines[NODE_COUNT + angle];
        let mut ln_scaled = Vec::with_capacity(ANGLE_COUNT * ANGLE_COUNT * AZIMUTH_COUNT);
        for light in 0..ANGLE_COUNT {
            for view in 0..ANGLE_COUNT {
                let at = (NODE_COUNT + view, NODE_COUNT + light);
                for azimuth in 0..AZIMUTH_COUNT {
                    let azimuth_rad = PI * squared_share(azimuth, AZIMUTH_COUNT);
                    let reflectance: f64 = terms
                        .iter()
                        .enumerate()
                        .map(|(order, term)| term[at] * (order as f64 * azimuth_rad).cos())
                        .sum();
                    ln_scaled.push((reflectance.max(DARKNESS) * (cosine(light) + cosine(view))).ln());
                }
            }
        }
        let plane = |light: usize| -> f64 {
            (0..NODE_COUNT).map(|node| angles.weights[node] * terms[0][(node, light)]).sum()
        };
        Self {
            ln_scaled,
            plane_albedo: (0..ANGLE_COUNT).map(|angle| plane(NODE_COUNT + angle)).collect(),
            spherical_albedo: (0..NODE_COUNT).map(|node| angles.weights[node] * plane(node)).sum(),
        }
    }

    /// R for the cosines of the zenith angles of the arriving and the leaving light, 0..=1, and of the angle by which it turns.
    pub(crate) fn reflectance(&self, cos_light: f64, cos_view: f64, cos_turn: f64) -> f64 {
        let [light, view] = [cos_light, cos_view].map(|cosine| cosine.clamp(MIN_ANGLE_RAD, 1.0));
        let flat = ((1.0 - light * light) * (1.0 - view * view)).sqrt();
        // Light from the zenith, or seen there, has no azimuth.
        let cos_azimuth = if flat > 1e-12 { (cos_turn + light * view) / flat } else { 1.0 };
        let (azimuth, to_next) = stencil(cos_azimuth.clamp(-1.0, 1.0).acos() / PI, AZIMUTH_COUNT);
        let [from, to] = [light, view].map(|cosine| stencil(cosine.asin() / FRAC_PI_2, ANGLE_COUNT));
        let mut sum = 0.0;
        for (row, row_weight) in [(from.0, 1.0 - from.1), (from.0 + 1, from.1)] {
            for (column, weight) in [(to.0, 1.0 - to.1), (to.0 + 1, to.1)] {
                let first = (row * ANGLE_COUNT + column) * AZIMUTH_COUNT + azimuth;
                let (here, next) = (self.ln_scaled[first], self.ln_scaled[first + 1]);
                sum += row_weight * weight * (here + to_next * (next - here));
            }
        }
        sum.exp() / (light + view)
    }

    /// Share of the light from an angle that is reflected, by the cosine of its zenith angle.
    pub(crate) fn plane_albedo(&self, cos_light: f64) -> f64 {
        let (lower, weight) = stencil(cos_light.clamp(0.0, 1.0).asin() / FRAC_PI_2, ANGLE_COUNT);
        (1.0 - weight) * self.plane_albedo[lower] + weight * self.plane_albedo[lower + 1]
    }

    /// Share of diffuse light that is reflected.
    pub(crate) fn spherical_albedo(&self) -> f64 {
        self.spherical_albedo
    }
}

/// The angles of the matrices: those of the rule, then those of the table.
struct Angles {
    cosines: Vec<f64>,
    /// 2μw of the rule, 0 for the table.
    weights: Vec<f64>,
}

impl Angles {
    fn new(table: impl Iterator<Item = f64>) -> Self {
        let rule = gauss_legendre(NODE_COUNT);
        let cosines: Vec<f64> = rule.iter().map(|node| node.0).chain(table).collect();
        let mut weights: Vec<f64> = rule.iter().map(|(cosine, weight)| 2.0 * cosine * weight).collect();
        weights.resize(cosines.len(), 0.0);
        Self { cosines, weights }
    }

    /// A term of reflection and transmission (without what goes straight through) of a layer.
    fn doubled(&self, order: usize, optical_depth: f64, asymmetry: f64) -> (Mat<f64>, Mat<f64>) {
        let doublings = (optical_depth / THIN_DEPTH).max(1.0).log2().ceil() as i32;
        let mut depth = optical_depth * 0.5f64.powi(doublings);
        let (mut reflected, mut transmitted) = self.thin(order, depth, asymmetry);
        // ∫cos² over a turn is half of that of 1.
        let share = if order == 0 { 1.0 } else { 0.5 };
        let through = |a: &Mat<f64>, b: &Mat<f64>| {
            let weighted = Mat::from_fn(a.nrows(), a.ncols(), |i, j| a[(i, j)] * share * self.weights[j]);
            let mut product = Mat::zeros(a.nrows(), b.ncols());
            matmul(&mut product, Accum::Replace, &weighted, b, 1.0, Par::Seq);
            product
        };
        for _ in 0..doublings {
            let straight: Vec<f64> = self.cosines.iter().map(|cosine| (-depth / cosine).exp()).collect();
            let before = |a: &Mat<f64>| Mat::from_fn(a.nrows(), a.ncols(), |i, j| a[(i, j)] * straight[j]);
            let after = |a: &Mat<f64>| Mat::from_fn(a.nrows(), a.ncols(), |i, j| straight[i] * a[(i, j)]);
            // Back and forth between both halves, any number of times: (1 + Q)(1 + Q²)(1 + Q⁴)… − 1.
            let mut power = through(&reflected, &reflected);
            let mut between = power.clone();
            while largest(&power) > SMALLEST_TERM {
                power = through(&power, &power);
                between = &between + &power + through(&between, &power);
            }
            let down = &transmitted + before(&between) + through(&between, &transmitted);
            let up = before(&reflected) + through(&reflected, &down);
            (reflected, transmitted) = (
                &reflected + after(&up) + through(&transmitted, &up),
                after(&down) + before(&transmitted) + through(&transmitted, &down),
            );
            depth *= 2.0;
        }
        (reflected, transmitted)
    }

    /// The same of a layer in which light is scattered once.
    fn thin(&self, order: usize, depth: f64, asymmetry: f64) -> (Mat<f64>, Mat<f64>) {
        let functions: Vec<Vec<f64>> =
            self.cosines.iter().map(|cosine| legendre_functions(order, *cosine)).collect();
        let count = self.cosines.len();
        let scattered = |to: usize, from: usize, is_reflected: bool| {
            let mut phase = 0.0;
            for degree in order..DEGREE_COUNT {
                let sign = if is_reflected && (degree + order) % 2 == 1 { -1.0 } else { 1.0 };
                let moment = (2 * degree + 1) as f64 * asymmetry.powi(degree as i32);
                phase += sign * moment * functions[to][degree - order] * functions[from][degree - order];
            }
            let orders = if order == 0 { 1.0 } else { 2.0 };
            let (to, from) = (self.cosines[to], self.cosines[from]);
            orders * phase * depth / (4.0 * to * from) * (-0.5 * depth * (1.0 / to + 1.0 / from)).exp()
        };
        let of = |is_reflected| Mat::from_fn(count, count, |to, from| scattered(to, from, is_reflected));
        (of(true), of(false))
    }
}

fn largest(terms: &Mat<f64>) -> f64 {
    terms.col_iter().flat_map(|column| column.iter()).fold(0.0, |largest, term| largest.max(term.abs()))
}

/// Associated Legendre functions P_l^m·√((l − m)!/(l + m)!) of an order m for the degrees l from m on.
fn legendre_functions(order: usize, cosine: f64) -> Vec<f64> {
    let sine = (1.0 - cosine * cosine).max(0.0).sqrt();
    let first: f64 = (1..=order).map(|k| sine * ((2 * k - 1) as f64 / (2 * k) as f64).sqrt()).product();
    let mut functions = vec![first];
    let (mut before, mut last) = (0.0, first);
    for degree in order..DEGREE_COUNT - 1 {
        let (l, m) = (degree as f64, order as f64);
        let next = ((2.0 * l + 1.0) * cosine * last - (l * l - m * m).sqrt() * before)
            / ((l + 1.0) * (l + 1.0) - m * m).sqrt();
        (before, last) = (last, next);
        functions.push(next);
    }
    functions
}

#[cfg(test)]
#[path = "drop_reflectance_tests.rs"]
mod tests;
