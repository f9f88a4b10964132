//! The basis: weighted low-rank approximation by alternating least squares (Gabriel and Zamir 1979;
//! `docs/model.md#basis`).
//!
//! Plain PCA (the paper's Eq. 4) minimises absolute error and is wrong by 70–700 % for a dark place near a
//! city. Here image n at direction p weighs w = max(x, δ)^−q, x the image over its mean, δ a thousandth of
//! its zenith or more ([`Floor`]): nearly relative error, without wasting functions on what is too dim to see. Elementwise
//! weights have no closed form; alternating least squares starts from a PCA of pixel-weighted images and solves
//! coefficients and functions in turn. One basis serves all bands, lobes and altitudes.
//!
//! Coefficients are stored in half precision, so each least-squares step expects that rounding: see
//! [`ROUNDING_VARIANCE`]. Without it, directions where large terms cancel come out wrong by many times their value.

use crate::{
    error::TablesError,
    fit_constants::{
        ELEVATED_DEG, ELEVATED_FLOOR_FACTOR, FLOOR_OVER_MEAN, FLOOR_OVER_ZENITH, NEAR_FLOOR_M,
        NEAR_SOURCE_OF_COEFFICIENTS, NEAR_SOURCE_OF_FUNCTIONS, OVERCAST_FLOOR_FACTORS, ROUNDING_VARIANCE,
        SHADOW_DEPTH_M, SHADOW_FLOOR_FACTOR, SPOT_FLOOR, WEIGHT_EXPONENT, ZENITH_BOOST, ZENITH_ROW_COUNT,
    },
    layout::{HALF_COLUMN_COUNT, PIXEL_COUNT},
    manifest::Scattering,
};
use faer::{
    Accum, Mat, MatRef, Par, Side,
    linalg::{
        matmul::{
            matmul,
            triangular::{self, BlockStructure},
        },
        solvers::Solve,
    },
};
use half::f16;
use rayon::prelude::*;
use skyglow_physics::{ELEVATION_COUNT, geometry::EARTH_RADIUS_M};
use std::sync::LazyLock;

/// Basis functions B_k sampled on half a panorama.
#[derive(Clone, Debug)]
pub struct Basis {
    /// Number of functions.
    pub count: usize,
    /// `[basis][row][column]`, column 0..=128.
    pub functions: Vec<f32>,
}

/// Weights of samples by their place, for fitting functions.
static FUNCTION_WEIGHTS: LazyLock<Vec<f64>> = LazyLock::new(|| place_weights(NEAR_SOURCE_OF_FUNCTIONS));
/// The same for fitting coefficients.
static COEFFICIENT_WEIGHTS: LazyLock<Vec<f64>> = LazyLock::new(|| place_weights(NEAR_SOURCE_OF_COEFFICIENTS));
/// How near the source's azimuth and the horizon a sample is, by [`SPOT_FLOOR`], 0..=1.
static SPOT: LazyLock<Vec<f32>> = LazyLock::new(|| {
    let [_, row_count, column_count] = SPOT_FLOOR;
    let near = |p: usize| {
        let up = (p / HALF_COLUMN_COUNT) as f64 / row_count;
        (-up * up - (p % HALF_COLUMN_COUNT) as f64 / column_count).exp() as f32
    };
    (0..PIXEL_COUNT).map(near).collect()
});

fn place_weights([boost, row_count, column_count]: [f64; 3]) -> Vec<f64> {
    (0..PIXEL_COUNT)
        .map(|p| {
            let (row, column) = (p / HALF_COLUMN_COUNT, p % HALF_COLUMN_COUNT);
            let up = row as f64 / row_count;
            let aside = column as f64 / column_count;
            let down = (ELEVATION_COUNT - 1 - row) as f64 / ZENITH_ROW_COUNT;
            1.0 + boost * (-up * up - aside).exp() + ZENITH_BOOST * (-down * down).exp()
        })
        .collect()
}

/// How far a source stands above the observer's horizontal plane, as a share 0..1 that is ½ at 6°; 0 for one that does
/// not. `offset_m` is source altitude − observer altitude.
fn elevated_share(offset_m: f64, distance_m: f64) -> f64 {
    let elevated = (offset_m.max(0.0) / distance_m).atan().to_degrees() / ELEVATED_DEG;
    elevated * elevated / (1.0 + elevated * elevated)
}

/// How much δ grows, so that what is dark in one image does not decide a fit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Floor {
    /// In the whole image.
    pub factor: f64,
    /// Next to the source's azimuth, besides.
    pub at_spot: f64,
}

impl Floor {
    /// Of a source: where `scattering` and geometry leave low rows black, or clouds overhead make them dark beside those.
    pub fn of(scattering: Scattering, is_overcast: bool, offset_m: f64, distance_m: f64) -> Self {
        let open = Self::behind_skyline(scattering, offset_m, distance_m, 0.0);
        if !is_overcast {
            return open;
        }
        let [near, below] = OVERCAST_FLOOR_FACTORS;
        let nearness = 1.0 / (1.0 + (distance_m / NEAR_FLOOR_M).powi(2));
        let factor = open.factor + near * nearness + below * elevated_share(-offset_m, distance_m);
        Self { factor, at_spot: SPOT_FLOOR[0] }
    }

    /// Of a source behind a skyline of `blocking_deg`, whose cone leaves more in the shadow.
    pub fn behind_skyline(scattering: Scattering, offset_m: f64, distance_m: f64, blocking_deg: f64) -> Self {
        let elevated = 1.0 + ELEVATED_FLOOR_FACTOR * elevated_share(offset_m, distance_m);
        let factor = match scattering {
            Scattering::Multiple => elevated,
            Scattering::Single => {
                // Height of the source's horizontal plane, or of its skyline's cone, above the observer.
                let lift_m = distance_m * blocking_deg.to_radians().tan();
                let depth_m = (offset_m + 0.5 * distance_m * distance_m / EARTH_RADIUS_M + lift_m).max(0.0);
                let depth = depth_m / SHADOW_DEPTH_M;
                elevated + SHADOW_FLOOR_FACTOR * depth * depth / (1.0 + depth * depth)
            }
        };
        Self { factor, at_spot: 0.0 }
    }
}

/// Weights w of one image (over its mean), one a sample, when its coefficients are sought.
pub fn sample_weights(shape: &[f32], floor: Floor) -> Vec<f32> {
    weights(shape, floor, &COEFFICIENT_WEIGHTS)
}

fn weights(shape: &[f32], growth: Floor, place_weights: &[f64]) -> Vec<f32> {
    let zenith_row = &shape[(ELEVATION_COUNT - 1) * HALF_COLUMN_COUNT..];
    let zenith = zenith_row.iter().sum::<f32>() / zenith_row.len() as f32;
    let floor_over_zenith = FLOOR_OVER_ZENITH * growth.factor as f32;
    let floor = (floor_over_zenith * zenith).max(FLOOR_OVER_MEAN);
    let at_spot = growth.at_spot as f32;
    let places = place_weights.iter().zip(SPOT.iter());
    shape
        .iter()
        .zip(places)
        .map(|(&x, (&place, spot))| {
            let floor = floor * (1.0 + at_spot * spot);
            (f64::from(x.max(floor)).powf(-WEIGHT_EXPONENT) * place) as f32
        })
        .collect()
}

/// Least squares with one weight a sample: argmin_c Σ_p w_p²(x_p − Σ_k c_k B_k(p))².
#[derive(Debug)]
pub struct Projector {
    /// Samples × functions.
    basis: Mat<f64>,
}

impl Projector {
    /// For a basis.
    pub fn new(basis: &Basis) -> Self {
        Self {
            basis: Mat::from_fn(PIXEL_COUNT, basis.count, |p, k| {
                f64::from(basis.functions[k * PIXEL_COUNT + p])
            }),
        }
    }

    /// Number of functions.
    pub fn count(&self) -> usize {
        self.basis.ncols()
    }

    /// Coefficients of several images that share the same weights (bands of one geometry and lobe do,
    /// nearly), images × functions.
    ///
    /// # Errors
    /// [`TablesError::Fit`] when the normal equations are not positive definite.
    pub fn project(&self, weights: &[f32], shapes: &[&[f32]]) -> Result<Vec<Vec<f64>>, TablesError> {
        let count = self.count();
        let weights: Vec<f64> = weights.iter().map(|&weight| f64::from(weight)).collect();
        let targets = Mat::from_fn(PIXEL_COUNT, shapes.len(), |p, n| weights[p] * f64::from(shapes[n][p]));
        let solution = solve_weighted(&weights, &self.basis, targets, "projection")?;
        Ok((0..shapes.len()).map(|n| (0..count).map(|k| solution[(k, n)]).collect()).collect())
    }
}

/// Packs store coefficients in half precision; a training set too small for its functions gives arbitrary ones.
///
/// # Errors
/// [`TablesError::Fit`] where one of them is beyond it.
pub(crate) fn check_half_precision(coefficients: &[f64]) -> Result<(), TablesError> {
    if coefficients.iter().all(|c| c.abs() <= f64::from(f16::MAX)) {
        return Ok(());
    }
    let reason =
        "a coefficient is beyond half precision: too few geometries for so many functions".to_owned();
    Err(TablesError::Fit { stage: "projection", reason })
}

/// [`solve_normal_equations`] with A = diag(weights) · matrix, made column after column: a fit of 64 functions takes 32 s with it
/// and took 52 s by index.
fn solve_weighted(
    weights: &[f64],
    matrix: &Mat<f64>,
    y: Mat<f64>,
    stage: &'static str,
) -> Result<Mat<f64>, TablesError> {
    let mut weighted = Vec::with_capacity(matrix.nrows() * matrix.ncols());
    for k in 0..matrix.ncols() {
        weighted.extend(matrix.col_as_slice(k).iter().zip(weights).map(|(value, weight)| weight * value));
    }
    let a = MatRef::from_column_major_slice(&weighted, matrix.nrows(), matrix.ncols());
    solve_normal_equations(a, y, stage)
}

/// argmin ‖A·X − Y‖² + [`ROUNDING_VARIANCE`] · Σ_k ‖A_k‖²‖X_k‖², over columns A_k and rows X_k. Columns are brought
/// to length 1 first, so that functions of very different size do not lose precision.
fn solve_normal_equations(
    a: MatRef<'_, f64>,
    y: Mat<f64>,
    stage: &'static str,
) -> Result<Mat<f64>, TablesError> {
    let count = a.ncols();
    let mut normal = Mat::<f64>::zeros(count, count);
    let (lower, whole) = (BlockStructure::TriangularLower, BlockStructure::Rectangular);
    triangular::matmul(&mut normal, lower, Accum::Replace, a.transpose(), whole, a, whole, 1.0, Par::Seq);
    let mut right = Mat::<f64>::zeros(count, y.ncols());
    matmul(&mut right, Accum::Replace, a.transpose(), &y, 1.0, Par::Seq);
    let per_length: Vec<f64> =
        (0..count).map(|k| 1.0 / normal[(k, k)].sqrt().max(f64::MIN_POSITIVE)).collect();
    let normal = Mat::from_fn(count, count, |i, j| {
        let ridge = if i == j { ROUNDING_VARIANCE } else { 0.0 };
        normal[(i, j)] * per_length[i] * per_length[j] + ridge
    });
    let right = Mat::from_fn(count, y.ncols(), |i, n| right[(i, n)] * per_length[i]);
    let factor =
        normal.llt(Side::Lower).map_err(|error| TablesError::Fit { stage, reason: format!("{error:?}") })?;
    let scaled = factor.solve(&right);
    Ok(Mat::from_fn(count, y.ncols(), |i, n| scaled[(i, n)] * per_length[i]))
}

/// One image of the training set.
#[derive(Clone, Debug)]
pub struct TrainingImage {
    /// Image over its mean, [`PIXEL_COUNT`] samples.
    pub shape: Vec<f32>,
    /// Of its source.
    pub floor: Floor,
    /// Factor on w.
    pub importance: f64,
}

/// A basis of `count` functions for a training set.
/// `advance` is called once an iteration.
///
/// # Errors
/// [`TablesError::Fit`] when a least-squares step breaks down.
pub fn fit_basis(
    images: &[TrainingImage],
    count: usize,
    iterations: usize,
    advance: &(dyn Fn() + Sync),
) -> Result<Basis, TablesError> {
    faer::set_global_parallelism(Par::Seq);
    let shapes: Vec<&[f32]> = images.iter().map(|image| image.shape.as_slice()).collect();
    let weights: Vec<Vec<f32>> =
        images.par_iter().map(|image| weights(&image.shape, image.floor, &FUNCTION_WEIGHTS)).collect();
    let rms = pixel_rms(&shapes);
    let mut basis = orthonormal(start_by_pca(&shapes, &rms, count), &rms)?;
    advance();
    for _ in 0..iterations {
        let projector = Projector::new(&basis);
        let coefficients: Vec<Vec<f64>> = shapes
            .par_iter()
            .zip(&weights)
            .map(|(shape, w)| projector.project(w, &[shape]).map(|mut rows| rows.swap_remove(0)))
            .collect::<Result<_, _>>()?;
        let coefficients = Mat::from_fn(shapes.len(), count, |n, k| coefficients[n][k]);
        let columns: Vec<Vec<f64>> = (0..PIXEL_COUNT)
            .into_par_iter()
            .map(|p| {
                let weights: Vec<f64> = images
                    .iter()
                    .zip(&weights)
                    .map(|(image, weights)| image.importance * f64::from(weights[p]))
                    .collect();
                let y = Mat::from_fn(shapes.len(), 1, |n, _| weights[n] * f64::from(shapes[n][p]));
                let x = solve_weighted(&weights, &coefficients, y, "basis functions")?;
                Ok((0..count).map(|k| x[(k, 0)]).collect())
            })
            .collect::<Result<_, TablesError>>()?;
        basis = orthonormal(Mat::from_fn(PIXEL_COUNT, count, |p, k| columns[p][k]), &rms)?;
        advance();
    }
    order_by_use(basis, &shapes, &weights, &rms)
}

/// Root mean square of each sample over the images.
fn pixel_rms(shapes: &[&[f32]]) -> Vec<f64> {
    (0..PIXEL_COUNT)
        .map(|p| {
            let sum: f64 = shapes.iter().map(|s| f64::from(s[p]) * f64::from(s[p])).sum();
            (sum / shapes.len() as f64).sqrt().max(1e-30)
        })
        .collect()
}

/// Leading right singular vectors of the images over each sample's rms, by subspace iteration from a fixed
/// pseudo-random start; samples × functions, times the rms again.
fn start_by_pca(shapes: &[&[f32]], rms: &[f64], count: usize) -> Mat<f64> {
    let scaled = Mat::from_fn(shapes.len(), PIXEL_COUNT, |n, p| f64::from(shapes[n][p]) / rms[p]);
    // A hash of the position is random enough to start from and the same everywhere.
    let mut vectors = Mat::from_fn(PIXEL_COUNT, count, |p, k| {
        let mut h = (p as u64).wrapping_mul(0x9E37_79B9_7F4A_7C15)
            ^ (k as u64 + 1).wrapping_mul(0xD1B5_4A32_D192_ED03);
        h ^= h >> 31;
        h = h.wrapping_mul(0x94D0_49BB_1331_11EB);
        h ^= h >> 29;
        (h >> 11) as f64 / (1u64 << 53) as f64 - 0.5
    });
    for _ in 0..8 {
        let mut images = Mat::<f64>::zeros(shapes.len(), count);
        matmul(&mut images, Accum::Replace, &scaled, &vectors, 1.0, Par::Seq);
        let images = images.qr().compute_thin_Q();
        matmul(&mut vectors, Accum::Replace, scaled.transpose(), &images, 1.0, Par::Seq);
        vectors = vectors.qr().compute_thin_Q();
    }
    Mat::from_fn(PIXEL_COUNT, count, |p, k| vectors[(p, k)] * rms[p])
}

/// The same span with functions orthonormal over rms-scaled samples: keeps the normal equations well
/// conditioned.
fn orthonormal(functions: Mat<f64>, rms: &[f64]) -> Result<Basis, TablesError> {
    let count = functions.ncols();
    let q = Mat::from_fn(PIXEL_COUNT, count, |p, k| functions[(p, k)] / rms[p]).qr().compute_thin_Q();
    to_basis(count, |k, p| q[(p, k)] * rms[p])
}

fn to_basis(count: usize, value: impl Fn(usize, usize) -> f64) -> Result<Basis, TablesError> {
    let functions: Vec<f32> =
        (0..count * PIXEL_COUNT).map(|i| value(i / PIXEL_COUNT, i % PIXEL_COUNT) as f32).collect();
    if functions.iter().all(|f| f.is_finite()) {
        Ok(Basis { count, functions })
    } else {
        Err(TablesError::Fit { stage: "basis functions", reason: "a sample is not finite".to_owned() })
    }
}

/// Rotates the basis so that its first functions carry most (principal axes of the coefficients), and scales
/// each to a largest coefficient of 1, which half precision stores best.
fn order_by_use(
    basis: Basis,
    shapes: &[&[f32]],
    weights: &[Vec<f32>],
    rms: &[f64],
) -> Result<Basis, TablesError> {
    let count = basis.count;
    let projector = Projector::new(&basis);
    let coefficients: Vec<Vec<f64>> = shapes
        .par_iter()
        .zip(weights)
        .map(|(shape, w)| projector.project(w, &[shape]).map(|mut rows| rows.swap_remove(0)))
        .collect::<Result<_, _>>()?;
    let c = Mat::from_fn(shapes.len(), count, |n, k| coefficients[n][k]);
    let mut covariance = Mat::<f64>::zeros(count, count);
    matmul(&mut covariance, Accum::Replace, c.transpose(), &c, 1.0, Par::Seq);
    let eigen = covariance
        .self_adjoint_eigen(Side::Lower)
        .map_err(|error| TablesError::Fit { stage: "ordering", reason: format!("{error:?}") })?;
    let axes = eigen.U();
    // Eigenvalues ascend.
    let axis = |k: usize, j: usize| axes[(j, count - 1 - k)];
    let largest: Vec<f64> = (0..count)
        .map(|k| {
            coefficients
                .iter()
                .map(|c| (0..count).map(|j| c[j] * axis(k, j)).sum::<f64>().abs())
                .fold(1e-30, f64::max)
        })
        .collect();
    debug_assert_eq!(rms.len(), PIXEL_COUNT);
    to_basis(count, |k, p| {
        largest[k]
            * (0..count).map(|j| axis(k, j) * f64::from(basis.functions[j * PIXEL_COUNT + p])).sum::<f64>()
    })
}
