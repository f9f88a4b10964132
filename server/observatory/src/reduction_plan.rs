//! From wishes for the sky to what to dim, with the sky before and after.

use crate::{
    error::ObservatoryError,
    influence::luminance_norm,
    influence_map::{InfluenceMap, InfluenceRequest},
    observatory::Observatory,
    reduction::{LeastCut, Reduction, least_cut, percentile, threshold_cuts},
    scene_view::View,
    sky::{SkyAnswer, SkyRequest},
};
use rayon::prelude::*;
use skyglow_scene::{Boundary, ChangeStep, PixelFactors, Scene};
use std::sync::Arc;

/// A wanted value is met if the sky is not above it by more than this part of it, and what f32 loses.
const MET_WITHIN: f64 = 1e-4;
/// What f32 loses of a sky; where less than that part of it is wanted, so much more is met too.
const LOST_BY_ROUNDING: f64 = 1e-6;
/// A part of a light that is no more than this is not worth the trouble, and f32 would lose it.
const MIN_CUT: f64 = 1e-6;
/// Sites × lit pixels within reach of any of them, at most.
const MAX_INFLUENCES: usize = 40_000_000;
/// Times that a target is aimed at anew after a look at the sky: what lights do is linear but for what between packs is not,
/// and far lights that the sky takes by blocks.
const MAX_LOOKS: usize = 5;

/// A value of an influence.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Level {
    /// In the measure's unit.
    Value(f64),
    /// The value below which so many percent of the lit pixels within reach lie, 0..=100.
    Percentile(f64),
}

/// What a site wants of a linear measure.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Limit {
    /// At most this, in the measure's unit, of artificial light.
    AtMost(f64),
    /// Less by this part of today's value, 0..=1.
    ReduceBy(f64),
}

/// A site of a target plan.
#[derive(Clone, Debug, PartialEq)]
pub struct TargetSite {
    /// The sky and the measure, which must be linear.
    pub influence: InfluenceRequest,
    /// What is wanted.
    pub limit: Limit,
}

/// How lights are chosen.
#[derive(Clone, Debug, PartialEq)]
pub enum PlanMethod {
    /// By their influence on one site (paper Eq. 12).
    Threshold {
        /// The site, and Q.
        site: InfluenceRequest,
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

/// A plan asked for.
#[derive(Clone, Debug, PartialEq)]
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
    pub sky: SkyAnswer,
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

/// Lit pixels within reach of some sites, each once: lights of several fixtures in a pixel are dimmed together.
struct Reach {
    /// Ascending.
    codes: Vec<u64>,
    flux_dnb_w: Vec<f64>,
    /// `[site][pixel]`.
    influence: Arc<[Vec<f64>]>,
}

impl Reach {
    fn of(maps: &[InfluenceMap]) -> Self {
        let scene = |map: &InfluenceMap, number: u32| map.open_scene().code(number);
        let mut codes: Vec<u64> =
            maps.iter().flat_map(|map| map.pixels().iter().map(|pixel| scene(map, pixel.number))).collect();
        codes.sort_unstable();
        codes.dedup();
        let mut flux_dnb_w = vec![0.0; codes.len()];
        let influence = maps.iter().map(|map| {
            let mut influence = vec![0.0; codes.len()];
            let mut flux = vec![0.0; codes.len()];
            for (pixel, value) in map.pixels().iter().zip(map.influence()) {
                let code = scene(map, pixel.number);
                let at = codes.partition_point(|known| *known < code);
                influence[at] += f64::from(*value);
                flux[at] += f64::from(pixel.flux_dnb_w);
            }
            // A pixel has the same flux for every site that sees it.
            flux_dnb_w
                .iter_mut()
                .zip(flux)
                .for_each(|(known, flux): (&mut f64, f64)| *known = known.max(flux));
            influence
        });
        let influence: Arc<[Vec<f64>]> = influence.collect();
        Self { codes, flux_dnb_w, influence }
    }

    /// Pixels that are dimmed.
    fn dimmed(&self, cut: &[f64]) -> Vec<DimmedPixel> {
        let falls: Vec<f64> = self
            .influence
            .iter()
            .map(|influence| influence.iter().zip(cut).map(|(influence, cut)| influence * cut).sum())
            .collect();
        let sites = falls.iter().filter(|fall| **fall > 0.0).count().max(1) as f64;
        let effect = |pixel: usize| -> f64 {
            let of_site = |(influence, fall): (&Vec<f64>, &f64)| {
                if *fall > 0.0 { cut[pixel] * influence[pixel] / fall } else { 0.0 }
            };
            self.influence.iter().zip(&falls).map(of_site).sum::<f64>() / sites
        };
        let is_dimmed = |pixel: &usize| cut[*pixel] > MIN_CUT;
        (0..cut.len())
            .filter(is_dimmed)
            .map(|pixel| DimmedPixel {
                code: self.codes[pixel],
                cut: cut[pixel],
                flux_dnb_w: self.flux_dnb_w[pixel],
                effect: effect(pixel),
            })
            .collect()
    }
}

/// What is left of dimmed pixels.
fn factors(pixels: &[DimmedPixel]) -> PixelFactors {
    PixelFactors {
        codes: pixels.iter().map(|pixel| pixel.code).collect(),
        factors: pixels.iter().map(|pixel| (1.0 - pixel.cut).clamp(0.0, 1.0) as f32).collect(),
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

impl Observatory {
    /// Makes a plan: influences of every site, cuts, and the sky before and after by the forward model. Takes a second a site and
    /// more; not for asynchronous threads.
    ///
    /// # Errors
    /// As [`Self::influence`] of any site.
    pub fn plan(&self, request: &PlanRequest) -> Result<PlanOutcome, ObservatoryError> {
        let asked = request.sites();
        let maps: Vec<InfluenceMap> =
            asked.iter().map(|site| self.influence(site)).collect::<Result<_, _>>()?;
        let Some(first) = maps.first() else {
            return Err(ObservatoryError::BadPlan { reason: "it has no site".to_owned() });
        };
        let scene = first.shared_scene();
        if maps.iter().any(|map| map.scene().version != scene.metadata().version) {
            return Err(ObservatoryError::BadPlan { reason: "its sites are in different scenes".to_owned() });
        }
        // Pixels that several sites see count for each here: the true number may be less.
        let influences = maps.len() * maps.iter().map(|map| map.pixels().len()).sum::<usize>();
        if maps.len() > 1 && influences > MAX_INFLUENCES {
            let reason = format!(
                "{} sites with {influences} influences of pixels together are more than {MAX_INFLUENCES}: take fewer sites",
                maps.len()
            );
            return Err(ObservatoryError::BadPlan { reason });
        }
        let before: Vec<SkyState> =
            asked.iter().map(|site| self.state(&scene, site)).collect::<Result<_, _>>()?;
        let reach = Reach::of(&maps);
        drop(maps);
        let mut outcome = PlanOutcome {
            flux_within_reach_dnb_w: reach.flux_dnb_w.iter().fold(0.0, |sum, flux| sum + flux),
            pixels_within_reach: reach.codes.len(),
            sites: Vec::new(),
            pixels: Vec::new(),
            protected_pixels: None,
            thresholds: None,
            least_flux_dnb_w: None,
            scene,
        };
        let (after, targets) = match &request.method {
            PlanMethod::Threshold { from, to, gamma, .. } => {
                let influence = &reach.influence[0];
                let value = |level: &Level| match level {
                    Level::Value(value) => *value,
                    Level::Percentile(percent) => percentile(influence, *percent),
                };
                let [from, to] = [from, to].map(value);
                if from > to {
                    let reason = format!("q_a, {from:e}, is above q_b, {to:e}");
                    return Err(ObservatoryError::BadPlan { reason });
                }
                outcome.thresholds = Some([from, to]);
                outcome.pixels = reach.dimmed(&threshold_cuts(influence, from, to, *gamma));
                (self.states(&asked, &outcome.pixels)?, vec![None])
            }
            PlanMethod::Target { sites, max_cut, protect } => {
                let aim = Aim::new(&outcome.scene, &reach, sites, &before, *max_cut, protect.as_ref());
                let (least, after) = self.reach_target(&asked, &reach, &aim)?;
                outcome.pixels = reach.dimmed(&least.cut);
                outcome.protected_pixels =
                    protect.as_ref().map(|_| aim.is_protected.iter().filter(|is| **is).count());
                outcome.least_flux_dnb_w = Some(least.least_flux);
                let targets = aim.outcomes(&reach, &after);
                (after, targets.into_iter().map(Some).collect())
            }
        };
        let of_sites = asked.into_iter().zip(before).zip(after).zip(targets);
        outcome.sites = of_sites
            .map(|(((influence, before), after), target)| SiteOutcome {
                influence: influence.clone(),
                before,
                after,
                target,
            })
            .collect();
        Ok(outcome)
    }

    /// Cuts that bring the sky itself to the wanted values, or as near as they can be brought.
    fn reach_target(
        &self,
        asked: &[&InfluenceRequest],
        reach: &Reach,
        aim: &Aim,
    ) -> Result<(LeastCut, Vec<SkyState>), ObservatoryError> {
        let mut problem = aim.problem.clone();
        let mut looks = 0;
        loop {
            looks += 1;
            let least = least_cut(&problem);
            let after = self.states(asked, &reach.dimmed(&least.cut))?;
            let excess: Vec<f64> =
                after.iter().zip(&aim.wanted).map(|(after, wanted)| after.value - wanted).collect();
            // Half of what counts as met.
            let slack = |site: usize| 0.5 * aim.slack(site);
            // A site that asks for all that is in reach cannot be helped any more.
            let can_fall = |site: usize| problem.need[site] < problem.reach(site) * (1.0 - 1e-9);
            let is_off = |site: usize| {
                // One site may also have gone too far; of several one can be dark for another's sake.
                let too_far =
                    excess.len() == 1 && excess[site] < -2.0 * slack(site) && problem.need[site] > 0.0;
                excess[site] > slack(site) && can_fall(site) || too_far
            };
            let off: Vec<usize> = (0..excess.len()).filter(|&site| is_off(site)).collect();
            if looks == MAX_LOOKS || off.is_empty() {
                return Ok((least, after));
            }
            off.into_iter().for_each(|site| problem.need[site] += excess[site]);
        }
    }

    /// The skies of sites in the scene with pixels dimmed.
    fn states(
        &self,
        asked: &[&InfluenceRequest],
        pixels: &[DimmedPixel],
    ) -> Result<Vec<SkyState>, ObservatoryError> {
        let Some(first) = asked.first() else { return Ok(Vec::new()) };
        let step = ChangeStep::Dimmed(factors(pixels));
        let sky = &first.sky;
        let dimmed = self.shelf.with_step(&sky.scene, sky.scenario.as_ref(), step, "plan")?;
        asked.iter().map(|site| self.state(&dimmed, site)).collect()
    }

    fn state(&self, scene: &Arc<Scene>, site: &InfluenceRequest) -> Result<SkyState, ObservatoryError> {
        let sky: &SkyRequest = &site.sky;
        let view = View::in_scene(Arc::clone(scene), sky, self.hides_lights(sky.kind()));
        let horizon = view.horizon.as_ref().map(|(horizon, _)| horizon.clone());
        let sky = self.render_view(view, sky)?;
        let weights = site.measure.weights(&horizon.unwrap_or_default());
        let panorama = &sky.rendered.panorama;
        let value = weights.map_or_else(|| luminance_norm(panorama), |weights| weights.of(panorama));
        Ok(SkyState { value, sky })
    }
}

/// What a target plan aims at.
struct Aim {
    problem: Reduction,
    before: Vec<f64>,
    wanted: Vec<f64>,
    is_protected: Vec<bool>,
}

impl Aim {
    fn new(
        scene: &Scene,
        reach: &Reach,
        sites: &[TargetSite],
        before: &[SkyState],
        max_cut: f64,
        protect: Option<&Boundary>,
    ) -> Self {
        let is_inside = |code: &u64, area: &Boundary| {
            let (column, row) = Scene::column_and_row_of(*code);
            area.contains(scene.pixel_center(column, row))
        };
        let is_protected: Vec<bool> =
            reach.codes.par_iter().map(|code| protect.is_some_and(|area| is_inside(code, area))).collect();
        let before: Vec<f64> = before.iter().map(|before| before.value).collect();
        let wanted: Vec<f64> = sites
            .iter()
            .zip(&before)
            .map(|(site, before)| match site.limit {
                Limit::AtMost(most) => most,
                Limit::ReduceBy(part) => (1.0 - part) * before,
            })
            .collect();
        let problem = Reduction {
            flux: reach.flux_dnb_w.clone(),
            most_cut: is_protected.iter().map(|is| if *is { 0.0 } else { max_cut }).collect(),
            gain: Arc::clone(&reach.influence),
            need: before.iter().zip(&wanted).map(|(before, wanted)| before - wanted).collect(),
        };
        Self { problem, before, wanted, is_protected }
    }

    /// By how much a site's value may be above the wanted one.
    fn slack(&self, site: usize) -> f64 {
        MET_WITHIN * self.wanted[site] + LOST_BY_ROUNDING * self.before[site]
    }

    fn outcomes(&self, reach: &Reach, after: &[SkyState]) -> Vec<SitePlan> {
        let site = |site: usize| {
            let protected = reach.influence[site].iter().zip(&self.is_protected).filter(|(_, is)| **is);
            let of_protected = protected.fold(0.0, |sum, (influence, _)| sum + influence);
            let least = (self.before[site] - self.problem.reach(site)).max(0.0);
            let wanted = self.wanted[site];
            SitePlan {
                wanted,
                is_met: after[site].value <= wanted + self.slack(site),
                least,
                of_protected,
                of_uncut: (least - of_protected).max(0.0),
            }
        };
        (0..after.len()).map(site).collect()
    }
}
