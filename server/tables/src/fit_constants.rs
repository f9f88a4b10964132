//! Constants of the fit of a basis and of its training set.

use serde::{Deserialize, Serialize};

/// Exponent q of the weights: 1 would be pure relative error; slightly less serves the bright part. At 0.85 the lowest
/// row opposite a city 40 km away, 300 times dimmer than towards it, was twice as wrong; at 1 lights on ridges are.
pub const WEIGHT_EXPONENT: f64 = 0.93;
/// δ over the image's zenith value.
pub(crate) const FLOOR_OVER_ZENITH: f32 = 1e-3;
/// A steeply elevated source leaves low rows in the Earth's shadow: black to a thousandth of the zenith, which no
/// smooth basis is. δ grows by up to this factor, or the fit would sacrifice the whole image to keep them black.
pub(crate) const ELEVATED_FLOOR_FACTOR: f64 = 100.0;
/// Elevation of the source at which half of that factor counts, degrees.
pub(crate) const ELEVATED_DEG: f64 = 6.0;
/// In the first order alone, a far source leaves the haze over a low observer in the Earth's shadow: low rows are
/// black there too, and δ grows by up to this factor. All orders fill them.
pub(crate) const SHADOW_FLOOR_FACTOR: f64 = 9.0;
/// Depth of the observer in the shadow at which half of that factor counts, metres.
pub(crate) const SHADOW_DEPTH_M: f64 = 400.0;
/// δ over the image's mean at the least, for images that are dark overhead.
pub(crate) const FLOOR_OVER_MEAN: f32 = 1e-4;

/// Variance of a coefficient's rounding error relative to its square, about that of half precision
/// ((2⁻¹¹)²/3). Rounding c_k adds Σ_p w_p² B_k(p)² c_k² · variance to the expected squared error: a ridge in
/// proportion to the diagonal of the normal equations.
pub const ROUNDING_VARIANCE: f64 = 1e-7;
/// How much more samples next to the source's azimuth weigh (w, not w²) when functions are sought, and the rows and columns
/// at which that is 1/e: 12° up, above most sources. A whole sky is a sum over many sources: away from them their errors
/// average out, next to one its own stand alone, and that is where the sky is worst.
pub(crate) const NEAR_SOURCE_OF_FUNCTIONS: [f64; 3] = [16.0, 8.5, 6.0];
/// The same when an image's coefficients are sought: the functions being there, less weight next to the source spoils less
/// of the sky away from it.
pub(crate) const NEAR_SOURCE_OF_COEFFICIENTS: [f64; 3] = [4.0, 10.0, 3.0];
/// How much more samples overhead weigh: all sources add up there, and the zenith is the first measure of a sky.
pub(crate) const ZENITH_BOOST: f64 = 3.0;
/// Rows from the zenith at which that is 1/e.
pub(crate) const ZENITH_ROW_COUNT: f64 = 6.0;

/// Highest observer and source of the low part of the training set, metres.
pub(crate) const LOW_ALTITUDE_M: f64 = 1_500.0;
/// Share of its uniform part below the plane where the sky has its kink: the axis has more of its nodes there, for the sake of the
/// line between two of them, and as many training images would take functions from the rest.
pub(crate) const UNIFORM_SHARE_BELOW: f64 = 9.0 / 23.0;
/// Of its elevated part: highest observer, nearest and farthest source [m], steepest source [degrees].
pub(crate) const ELEVATED_TRAINING: [f64; 4] = [2_000.0, 700.0, 25_000.0, 16.0];

/// Under clouds a light nearby, and more so below the observer, leaves low rows dark, to a hundredth or thousandth of the lit cloud
/// overhead. Other lights, farther away, make those rows bright. So δ grows by up to these factors: with the second of a light steeply
/// below, with the first of one nearer than [`NEAR_FLOOR_M`]. Without them the fit sacrificed the cloud to the dark: skies of
/// observers high above a town were up to a third too dark (`docs/notebook/2026-11-29.md`).
pub(crate) const OVERCAST_FLOOR_FACTORS: [f64; 2] = [60.0, 60.0];
/// Distance at which half of the first counts, metres.
pub(crate) const NEAR_FLOOR_M: f64 = 2_000.0;
/// Under clouds, too, functions have next to the source's azimuth the bright spots of lights level with the observer, hundreds of times
/// the mean of their images: where an image is dark there, a rounded coefficient alone is more light than it has. There δ grows by up to
/// this factor more, and the rows and columns at which that is 1/e.
pub(crate) const SPOT_FLOOR: [f64; 3] = [100.0, 3.0, 2.0];
/// Of the part of the training set that packs under clouds have besides, observers above near lights: nearest and farthest
/// source, metres.
pub(crate) const BELOW_TRAINING_M: [f64; 2] = [250.0, 8_000.0];

/// Weight of the `oblique` lobe's images in the fit: sharp edges that take functions from the common lobes.
pub(crate) const OBLIQUE_IMPORTANCE: f64 = 1.6;

/// What decides a fit beside the number of functions, geometries and iterations: stored in manifests, and in the key of
/// checkpoints, so that no run resumes from parts of other constants.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct FitConstants {
    /// Exponent q of the weights.
    pub weight_exponent: f64,
    /// δ over the image's zenith value.
    #[serde(rename = "dim_over_zenith")]
    pub floor_over_zenith: f64,
    /// δ over the image's mean at the least.
    #[serde(rename = "dim_over_mean")]
    pub floor_over_mean: f64,
    /// Largest growth of δ for a steeply elevated source, and the elevation of half of it, degrees.
    #[serde(rename = "raised_dim")]
    pub floor_elevated: [f64; 2],
    /// Largest growth of δ in the Earth's shadow, and the depth of half of it, metres.
    #[serde(rename = "shadow_dim")]
    pub floor_in_shadow: [f64; 2],
    /// Relative variance of a coefficient's rounding.
    pub rounding_variance: f64,
    /// Under clouds, largest growths of δ for a light nearby and for one below the observer; the angle of half of the second is that
    /// of elevated ones.
    #[serde(default)]
    pub floor_overcast: [f64; 2],
    /// Distance of half of the first, metres.
    #[serde(default)]
    pub floor_near_m: f64,
    /// Under clouds, largest growth of δ next to the source's azimuth, and the rows and columns at which it is 1/e.
    #[serde(default)]
    pub floor_at_spot: [f64; 3],
    /// Extra weight next to the source's azimuth, and the rows and columns at which it is 1/e.
    pub near_source: [f64; 3],
    /// The same when coefficients are sought.
    pub near_source_of_coefficients: [f64; 3],
    /// Extra weight overhead, and the rows from the zenith at which it is 1/e.
    pub zenith: [f64; 2],
    /// Share of the uniform part of the training set with a source below the plane where the sky has its kink.
    #[serde(rename = "anywhere_share_below", default)]
    pub uniform_share_below: f64,
    /// Of the elevated part of the training set: highest observer, nearest and farthest source [m], steepest source [degrees].
    #[serde(rename = "raised_training")]
    pub elevated_training: [f64; 4],
    /// Of the part of the training set with lights close below the observer, under clouds: nearest and farthest source, metres.
    #[serde(default)]
    pub below_training_m: [f64; 2],
    /// Weight of the `oblique` lobe's images.
    pub oblique_importance: f64,
    /// Highest observer and source of the low part of the training set, metres.
    #[serde(rename = "everyday_altitude_m")]
    pub low_altitude_m: f64,
}

impl FitConstants {
    /// Those of this program.
    pub fn current() -> Self {
        Self {
            weight_exponent: WEIGHT_EXPONENT,
            floor_over_zenith: f64::from(FLOOR_OVER_ZENITH),
            floor_over_mean: f64::from(FLOOR_OVER_MEAN),
            floor_elevated: [ELEVATED_FLOOR_FACTOR, ELEVATED_DEG],
            floor_overcast: OVERCAST_FLOOR_FACTORS,
            floor_near_m: NEAR_FLOOR_M,
            floor_at_spot: SPOT_FLOOR,
            floor_in_shadow: [SHADOW_FLOOR_FACTOR, SHADOW_DEPTH_M],
            rounding_variance: ROUNDING_VARIANCE,
            near_source: NEAR_SOURCE_OF_FUNCTIONS,
            near_source_of_coefficients: NEAR_SOURCE_OF_COEFFICIENTS,
            zenith: [ZENITH_BOOST, ZENITH_ROW_COUNT],
            uniform_share_below: UNIFORM_SHARE_BELOW,
            elevated_training: ELEVATED_TRAINING,
            below_training_m: BELOW_TRAINING_M,
            oblique_importance: OBLIQUE_IMPORTANCE,
            low_altitude_m: LOW_ALTITUDE_M,
        }
    }
}
