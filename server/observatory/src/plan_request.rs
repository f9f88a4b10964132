//! A request for a reduction plan, and the plan that answers it.

use crate::{influence_map::InfluenceRequest, sky::RenderedSky};
use serde::Serialize;
use skyglow_scene::{Boundary, PixelFactors, Scene};
use std::sync::Arc;

/// A value of an influence.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub enum Level {
    /// In the measure's unit.
    Value(f64),
    /// The value below which so many percent of the lit pixels within reach lie, 0..=100.
    Percentile(f64),
}

/// What a site wants of a linear measure.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub enum Limit {
    /// At most this, in the measure's unit, of artificial light.
    AtMost(f64),
    /// Less by this part of today's value, 0..=1.
    ReduceBy(f64),
}

/// A site of a target plan.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct TargetSite {
    /// The sky and the measure, which must be linear.
    pub influence: InfluenceRequest,
    /// What is wanted.
    pub limit: Limit,
}

/// How lights are chosen.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub enum PlanMethod {
    /// By their influence on one site (paper Eq. 12).
    Threshold {
        /// The site, and Q.
        site: Box<InfluenceRequest>,
        /// Q_a.
        from: Level,
        /// Q_b, not below Q_a.
        to: Level,
        /// γ_usr, 0..=1.
        gamma: f64,
    },
    /// The least flux such that sites meet limits.
    Target {
        /// The sites, in one scene and scenario.
        sites: Vec<TargetSite>,
        /// The largest part of a light that may go, 0..=1.
        max_cut: f64,
        /// Lights in here may not be dimmed.
        protect: Option<Boundary>,
    },
}

/// A request for a plan.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct PlanRequest {
    /// How lights are chosen.
    pub method: PlanMethod,
}

/// A pixel that a plan dims.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DimmedPixel {
    /// Its code ([`Scene::pixel_code`]).
    pub code: u64,
    /// γ: the part of its light that goes, 0..=1.
    pub cut: f64,
    /// Its upward flux before, DNB watts, calibration included.
    pub flux_dnb_w: f64,
    /// Its part of what the plan takes from the sites' measures, in the mean over the sites; those of all sum to 1.
    pub effect: f64,
}

/// The sky of a site before or after.
#[derive(Clone, Debug)]
pub struct SkyState {
    /// Value of the site's measure; of `norm` that of the whole visible sky.
    pub value: f64,
    /// The sky.
    pub sky: RenderedSky,
}

/// What a plan does for a site.
#[derive(Clone, Debug)]
pub struct SiteOutcome {
    /// What was asked of it.
    pub influence: InfluenceRequest,
    /// As it is.
    pub before: SkyState,
    /// With the plan, by the forward model.
    pub after: SkyState,
    /// Of a target plan.
    pub target: Option<SitePlan>,
}

/// What a target plan says of a site; values in the measure's unit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SitePlan {
    /// The wanted value.
    pub wanted: f64,
    /// Whether it is met, to a part in 10⁴.
    pub is_met: bool,
    /// What would be left with every light cut as far as it may be.
    pub least: f64,
    /// Of that, what comes from protected lights.
    pub of_protected: f64,
    /// And what `max_cut` leaves of the others.
    pub of_uncut: f64,
}

/// A plan.
#[derive(Clone, Debug)]
pub struct PlanOutcome {
    /// The scene that is dimmed, changes of its scenario included.
    pub scene: Arc<Scene>,
    /// The sites, in the order of the request.
    pub sites: Vec<SiteOutcome>,
    /// Pixels that are dimmed, ascending by code.
    pub pixels: Vec<DimmedPixel>,
    /// Upward flux of all lit pixels within 300 km of any site, DNB watts.
    pub flux_within_reach_dnb_w: f64,
    /// Lit pixels within 300 km of any site.
    pub pixels_within_reach: usize,
    /// Of them, those that a target plan leaves alone; None where nothing is protected.
    pub protected_pixels: Option<usize>,
    /// Q_a and Q_b of a threshold plan, in the measure's unit.
    pub thresholds: Option<[f64; 2]>,
    /// Of a target plan: no plan that brings the measures down as far takes less flux, DNB watts (by linear duality).
    pub least_flux_dnb_w: Option<f64>,
}

impl PlanOutcome {
    /// Upward flux that goes, DNB watts.
    pub fn flux_removed_dnb_w(&self) -> f64 {
        self.pixels.iter().fold(0.0, |sum, pixel| sum + pixel.cut * pixel.flux_dnb_w)
    }

    /// What is left of each of [`Self::pixels`].
    pub fn factors(&self) -> PixelFactors {
        factors(&self.pixels)
    }
}

impl PlanRequest {
    /// What is asked of each site.
    pub fn sites(&self) -> Vec<&InfluenceRequest> {
        match &self.method {
            PlanMethod::Threshold { site, .. } => vec![site],
            PlanMethod::Target { sites, .. } => sites.iter().map(|site| &site.influence).collect(),
        }
    }
}

/// What is left of dimmed pixels.
pub(crate) fn factors(pixels: &[DimmedPixel]) -> PixelFactors {
    PixelFactors {
        codes: pixels.iter().map(|pixel| pixel.code).collect(),
        factors: pixels.iter().map(|pixel| (1.0 - pixel.cut).clamp(0.0, 1.0) as f32).collect(),
    }
}
