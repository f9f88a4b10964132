//! Reduction plans.

use super::{Assumptions, measure_name};
use crate::{
    facts::SourceFacts,
    format::{rfc3339, rounded},
};
use serde::Serialize;
use skyglow_observatory::{Level, PlanMethod, PlanOutcome, PlanRequest, SiteOutcome};
use skyglow_physics::SkyQuantities;
use skyglow_scene::{Listed, Outline, Scene, SceneMetadata, StoredPlan};
use utoipa::ToSchema;

/// What a plan says of a site.
#[derive(Clone, Debug, Serialize, ToSchema)]
pub struct PlannedSite {
    /// What the numbers before depend on.
    #[serde(flatten)]
    pub assumptions: Assumptions,
    /// `norm`, `zenith`, `mean`, `horizontal` or `region`.
    pub measure: String,
    /// Unit of the values: `cd m-2`, `lx`, or `cd m-2 sr0.5` of the norm.
    pub unit: String,
    /// Value of the measure today, artificial light alone; of `norm` that of the whole visible sky.
    pub before: f64,
    /// Value with the plan, by the same forward model as every sky.
    pub after: f64,
    /// 1 − after/before.
    pub reduced_by: f64,
    /// Of a target plan; null for a threshold.
    pub target: Option<TargetAnswer>,
    /// The sky today.
    pub sky_before: SkyQuantities,
    /// The sky with the plan.
    pub sky_after: SkyQuantities,
}

/// What a site wanted of a target plan, and whether it has it.
#[derive(Clone, Debug, Serialize, ToSchema)]
pub struct TargetAnswer {
    /// The wanted value, in `unit`.
    pub wanted: f64,
    /// Whether `after` is at most that, to a part in ten thousand.
    pub is_met: bool,
    /// What would be left with every light cut as far as it may be, in `unit`.
    pub least: f64,
    /// Of that, from lights in protected polygons.
    pub of_protected: f64,
    /// Of that, what `max_cut` leaves of the others.
    pub of_uncut: f64,
    /// Why it is not met, in words; null where it is.
    pub why_not: Option<String>,
}

/// All that is said of a plan but its pixels. It is kept as it was answered first.
#[derive(Clone, Debug, Serialize, ToSchema)]
pub struct PlanFacts {
    /// `threshold` or `target`.
    pub method: String,
    /// The sites, in the order of the request.
    pub sites: Vec<PlannedSite>,
    /// Of a threshold plan: Q_a and Q_b, in the site's `unit`.
    pub thresholds: Option<[f64; 2]>,
    /// The same as they were asked for: values, or percentiles such as `p90`; null in plans made before this was told.
    pub threshold_levels: Option<[String; 2]>,
    /// Of a threshold plan: γ.
    pub gamma: Option<f64>,
    /// Of a target plan: the largest part of a light that may go.
    pub max_cut: Option<f64>,
    /// Pixels dimmed.
    pub dimmed_pixels: u64,
    /// Lit pixels within 300 km of a site.
    pub lit_pixels_within_reach: u64,
    /// Of a target plan with `protect`: of them, those that are left alone.
    pub protected_pixels: Option<u64>,
    /// Upward flux that goes, DNB watts, calibration included.
    pub flux_removed_dnb_w: f64,
    /// Upward flux of all lit pixels within 300 km of a site, DNB watts.
    pub flux_within_reach_dnb_w: f64,
    /// Part of that which goes.
    pub flux_removed_share: f64,
    /// Of a target plan: no plan that brings the measures down as far takes less flux, DNB watts; by linear duality.
    pub least_flux_dnb_w: Option<f64>,
}

/// A plan in a list.
#[derive(Clone, Debug, Serialize, ToSchema)]
pub struct PlanEntry {
    /// Its id, which every query takes as `scenario`.
    pub id: String,
    /// When it was made, RFC 3339 UTC.
    pub created: String,
    /// `threshold` or `target`.
    pub method: String,
    /// Number of its sites.
    pub site_count: usize,
    /// Upward flux that goes, DNB watts.
    pub flux_removed_dnb_w: f64,
    /// Part of the flux within reach.
    pub flux_removed_share: f64,
}

/// A pixel that is dimmed.
#[derive(Clone, Debug, Default, Serialize, ToSchema)]
pub struct DimmedPixelAnswer {
    /// Place in the list, from 1: by `effect`.
    pub rank: usize,
    /// Centre, degrees north.
    pub latitude_deg: f64,
    /// Centre, degrees east.
    pub longitude_deg: f64,
    /// Column on the scene's raster, from 0.
    pub column: u32,
    /// Row, the same way.
    pub row: u32,
    /// Part of its light that goes, 0 to 1.
    pub cut: f64,
    /// Its radiance today, nW cm⁻² sr⁻¹, without the calibration.
    pub radiance_before_nw_cm2_sr: f64,
    /// And with the plan.
    pub radiance_after_nw_cm2_sr: f64,
    /// Its upward flux today, DNB watts, calibration included.
    pub flux_dnb_w: f64,
    /// What of that goes.
    pub flux_removed_dnb_w: f64,
    /// Its part of what the plan takes from the sites' measures, in the mean over the sites.
    pub effect: f64,
    /// Parts of this pixel and all before it in the list.
    pub cumulative_effect: f64,
}

/// A plan. Its facts are those of the time when it was made.
#[derive(Clone, Debug, Serialize, ToSchema)]
pub struct PlanAnswer {
    /// Its id, which every query takes as `scenario`.
    pub id: String,
    /// When it was made, RFC 3339 UTC.
    pub created: String,
    /// What is said of it.
    #[serde(flatten)]
    #[schema(value_type = PlanFacts)]
    pub facts: serde_json::Value,
    /// The pixels that are dimmed, those with the most effect first.
    pub pixels: Vec<DimmedPixelAnswer>,
}

impl PlanEntry {
    /// What a list says of a plan; None where it is none of a plan.
    pub fn of_listed(listed: Listed) -> Option<Self> {
        let Outline::Plan { method, site_count, flux_removed_dnb_w, flux_removed_share } = listed.outline
        else {
            return None;
        };
        let created = rfc3339(listed.created_unix_s);
        let id = listed.id.to_string();
        Some(Self { id, created, method, site_count, flux_removed_dnb_w, flux_removed_share })
    }
}

fn part(of: f64, whole: f64) -> f64 {
    if whole > 0.0 { of / whole } else { 0.0 }
}

/// Why a site does not have what it wants.
fn why_not(wanted: f64, least: f64, of_protected: f64, of_uncut: f64, unit: &str) -> String {
    if least <= wanted {
        return format!(
            "lights were cut as the sums over them want it, and the sky is a little brighter than those say; {wanted:.3e} {unit} \
             is near the least that can be had"
        );
    }
    let mut reasons = Vec::new();
    if of_protected > 0.0 {
        reasons.push(format!("{of_protected:.3e} comes from protected lights"));
    }
    if of_uncut > 0.0 {
        reasons.push(format!("{of_uncut:.3e} is what max_cut leaves of the others"));
    }
    format!(
        "out of reach: with every light cut as far as it may be, {least:.3e} {unit} is left of the {wanted:.3e} wanted: {}",
        reasons.join(", ")
    )
}

fn planned_site(site: &SiteOutcome, scene: &SceneMetadata, facts: &SourceFacts) -> PlannedSite {
    let unit = site.influence.measure.unit(site.influence.sky.response.unit());
    let (before, after) = (site.before.value, site.after.value);
    PlannedSite {
        assumptions: Assumptions::new(&site.influence.sky, scene, &site.before.sky.context, facts),
        measure: measure_name(&site.influence.measure).to_owned(),
        unit: unit.clone(),
        before,
        after,
        reduced_by: 1.0 - if before > 0.0 { after / before } else { 1.0 },
        target: site.target.map(|target| TargetAnswer {
            wanted: target.wanted,
            is_met: target.is_met,
            least: target.least,
            of_protected: target.of_protected,
            of_uncut: target.of_uncut,
            why_not: (!target.is_met)
                .then(|| why_not(target.wanted, target.least, target.of_protected, target.of_uncut, &unit)),
        }),
        sky_before: site.before.sky.quantities.clone(),
        sky_after: site.after.sky.quantities.clone(),
    }
}

/// What is said of a plan.
pub fn plan_facts(request: &PlanRequest, outcome: &PlanOutcome, facts: &SourceFacts) -> PlanFacts {
    let level = |level: &Level| match level {
        Level::Value(value) => format!("{value:e}"),
        Level::Percentile(percent) => format!("p{percent}"),
    };
    let (method, threshold_levels, gamma, max_cut) = match &request.method {
        PlanMethod::Threshold { from, to, gamma, .. } => {
            ("threshold", Some([from, to].map(level)), Some(*gamma), None)
        }
        PlanMethod::Target { max_cut, .. } => ("target", None, None, Some(*max_cut)),
    };
    let site = |site| planned_site(site, outcome.scene.metadata(), facts);
    let flux_removed_dnb_w = outcome.flux_removed_dnb_w();
    PlanFacts {
        method: method.to_owned(),
        sites: outcome.sites.iter().map(site).collect(),
        thresholds: outcome.thresholds,
        threshold_levels,
        gamma,
        max_cut,
        dimmed_pixels: outcome.pixels.len() as u64,
        lit_pixels_within_reach: outcome.pixels_within_reach as u64,
        protected_pixels: outcome.protected_pixels.map(|count| count as u64),
        flux_removed_dnb_w,
        flux_within_reach_dnb_w: outcome.flux_within_reach_dnb_w,
        flux_removed_share: part(flux_removed_dnb_w, outcome.flux_within_reach_dnb_w),
        least_flux_dnb_w: outcome.least_flux_dnb_w,
    }
}

/// The `limit` pixels of a plan with the most effect, the most first.
///
/// * `scene`: as it is before the plan.
pub fn dimmed_pixels(plan: &StoredPlan, scene: &Scene, limit: usize) -> Vec<DimmedPixelAnswer> {
    let mut order: Vec<usize> = (0..plan.effects.len()).collect();
    order.sort_unstable_by(|a, b| plan.effects[*b].total_cmp(&plan.effects[*a]).then(a.cmp(b)));
    order.truncate(limit);
    let mut cumulative = 0.0;
    let one = |(at, position): (usize, usize)| {
        let (column, row) = Scene::column_and_row_of(plan.factors.codes[position]);
        let place = scene.pixel_center(column, row);
        let factor = f64::from(plan.factors.factors[position]);
        let (radiance, flux_dnb_w) = scene.pixel_light(column, row);
        let effect = f64::from(plan.effects[position]);
        cumulative += effect;
        DimmedPixelAnswer {
            rank: at + 1,
            latitude_deg: rounded(place.latitude_deg()),
            longitude_deg: rounded(place.longitude_deg()),
            column,
            row,
            cut: 1.0 - factor,
            radiance_before_nw_cm2_sr: radiance,
            radiance_after_nw_cm2_sr: factor * radiance,
            flux_dnb_w,
            flux_removed_dnb_w: (1.0 - factor) * flux_dnb_w,
            effect,
            cumulative_effect: cumulative,
        }
    };
    order.into_iter().enumerate().map(one).collect()
}
