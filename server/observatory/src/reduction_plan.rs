//! Reduction plans (`docs/model.md#plans`): from what is wanted of the sky to what to dim, with the sky before and after.

use crate::{
    error::ObservatoryError,
    influence::norm_of_values,
    influence_map::{InfluenceMap, InfluenceRequest},
    observatory::Observatory,
    plan_request::{
        DimmedPixel, Level, PlanMethod, PlanOutcome, PlanRequest, SiteOutcome, SkyState, factors,
    },
    plan_target::{Reach, Target},
    reduction::{LeastCut, least_cut, percentile, programme_bytes, threshold_cuts},
    scene_view::SceneView,
    surroundings::Surroundings,
    watch::{Watch, note},
};
use skyglow_render::RenderError;
use skyglow_scene::{ChangeStep, Scene};
use std::sync::Arc;

/// Sites × lit pixels within reach of any of them, at most.
const MAX_INFLUENCES: usize = 40_000_000;
/// Times that a target is aimed at anew after a look at the sky: what lights do is linear but for what between packs is not,
/// and far lights that the sky takes by blocks.
const MAX_LOOKS: usize = 5;
/// About the part of a plan's time that finding influences takes, and that which is over before it is aimed.
const PART_OF_INFLUENCES: f64 = 0.4;
const PART_BEFORE_LOOKS: f64 = 0.5;

impl PlanRequest {
    /// Influences of pixels that are found for it at a time, at most: a plan of several sites with more is refused.
    pub fn max_influences(&self, view: &SceneView) -> u64 {
        let sites = self.sites();
        let around = sites.iter().map(|site| view.max_lit_pixels_around(site.sky.place));
        let (sum, most) =
            around.fold((0_u64, 0), |(sum, most), one| (sum.saturating_add(one), one.max(most)));
        match sites.len() {
            0 | 1 => sum,
            count => sum.min(((MAX_INFLUENCES / count) as u64).saturating_add(most)),
        }
    }

    /// Bytes that choosing among their pixels takes at most, about, beside the influences.
    pub fn programme_bytes(&self, view: &SceneView) -> usize {
        match self.sites().len() {
            0 | 1 => 0,
            count => programme_bytes(usize::try_from(self.max_influences(view)).unwrap_or(usize::MAX), count),
        }
    }
}

impl Observatory {
    /// [`Self::plan_in`] of the scene of the first site as it is now.
    ///
    /// # Errors
    /// As [`Self::view`] and [`Self::plan_in`].
    pub fn plan(&self, request: &PlanRequest) -> Result<PlanOutcome, ObservatoryError> {
        let sites = request.sites();
        let first = sites.first().ok_or_else(no_site)?;
        self.plan_in(&self.view(&first.sky.scene, first.sky.scenario.as_ref())?, request, &|_| true)
    }

    /// Makes a plan: influences of every site, cuts, and the sky before and after by the forward model. Takes a second a site and
    /// more; not for asynchronous threads.
    ///
    /// # Errors
    /// As [`Self::influence_in`] of any site.
    pub fn plan_in(
        &self,
        view: &SceneView,
        request: &PlanRequest,
        watch: &Watch<'_>,
    ) -> Result<PlanOutcome, ObservatoryError> {
        let asked = request.sites();
        let first = asked.first().ok_or_else(no_site)?;
        let scene_of = |site: &InfluenceRequest| (site.sky.scene.clone(), site.sky.scenario.clone());
        if asked.iter().any(|site| scene_of(site) != scene_of(first)) {
            return Err(ObservatoryError::BadPlan { reason: "its sites are in different scenes".to_owned() });
        }
        let part = |site: usize| PART_OF_INFLUENCES * site as f64 / asked.len() as f64;
        let mut maps: Vec<InfluenceMap> = Vec::with_capacity(asked.len());
        for (number, site) in asked.iter().copied().enumerate() {
            maps.push(self.influence_in(view, site, &|_| watch(part(number)))?);
            // Pixels that several sites see count for each here: the true number may be less.
            let influences = asked.len() * maps.iter().map(|map| map.pixels().len()).sum::<usize>();
            if asked.len() > 1 && influences > MAX_INFLUENCES {
                let reason = format!(
                    "{} sites with {influences} influences of pixels and more are above {MAX_INFLUENCES}: take fewer sites",
                    asked.len()
                );
                return Err(ObservatoryError::BadPlan { reason });
            }
        }
        let scene = Arc::clone(view.scene());
        let before = self.states_in(&scene, &asked, &|| watch(PART_OF_INFLUENCES))?;
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
                (self.states(view, &asked, &outcome.pixels, &|| watch(PART_BEFORE_LOOKS))?, vec![None])
            }
            PlanMethod::Target { sites, max_cut, protect } => {
                let target = Target::new(&outcome.scene, &reach, sites, &before, *max_cut, protect.as_ref());
                let (least, after) = self.reach_target(view, &asked, &reach, &target, watch)?;
                outcome.pixels = reach.dimmed(&least.cut);
                outcome.protected_pixels =
                    protect.as_ref().map(|_| target.is_protected.iter().filter(|is| **is).count());
                outcome.least_flux_dnb_w = Some(least.least_flux);
                let targets = target.outcomes(&reach, &after);
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
        view: &SceneView,
        asked: &[&InfluenceRequest],
        reach: &Reach,
        target: &Target,
        watch: &Watch<'_>,
    ) -> Result<(LeastCut, Vec<SkyState>), ObservatoryError> {
        let mut problem = target.problem.clone();
        let mut looks = 0;
        loop {
            let done = PART_BEFORE_LOOKS + (1.0 - PART_BEFORE_LOOKS) * looks as f64 / MAX_LOOKS as f64;
            note(watch, done)?;
            looks += 1;
            let least = least_cut(&problem);
            let after = self.states(view, asked, &reach.dimmed(&least.cut), &|| watch(done))?;
            let excess: Vec<f64> =
                after.iter().zip(&target.wanted).map(|(after, wanted)| after.value - wanted).collect();
            // Half of what counts as met.
            let slack = |site: usize| 0.5 * target.slack(site);
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
        view: &SceneView,
        asked: &[&InfluenceRequest],
        pixels: &[DimmedPixel],
        goes_on: &dyn Fn() -> bool,
    ) -> Result<Vec<SkyState>, ObservatoryError> {
        let Some(first) = asked.first() else { return Ok(Vec::new()) };
        let step = ChangeStep::Dimmed(factors(pixels));
        let dimmed = self.scenes.with_step(view.base(), first.sky.scenario.as_ref(), step, "plan")?;
        self.states_in(&dimmed, asked, goes_on)
    }

    /// The skies of sites in a scene, as long as somebody waits for them.
    fn states_in(
        &self,
        scene: &Scene,
        asked: &[&InfluenceRequest],
        goes_on: &dyn Fn() -> bool,
    ) -> Result<Vec<SkyState>, ObservatoryError> {
        let state = |site: &&InfluenceRequest| {
            if goes_on() { self.state(scene, site) } else { Err(RenderError::Ended.into()) }
        };
        asked.iter().map(state).collect()
    }

    fn state(&self, scene: &Scene, site: &InfluenceRequest) -> Result<SkyState, ObservatoryError> {
        let sky = &site.sky;
        let hides_lights = self.hides_lights_of(sky);
        let surroundings = Surroundings::on_ground(scene.ground(sky.place), scene, sky, hides_lights);
        let sky = self.render(surroundings, sky)?;
        let weights = site.measure.weights(&sky.horizon);
        let value = weights.map_or_else(|| norm_of_values(sky.values()), |weights| weights.of(sky.values()));
        Ok(SkyState { value, sky })
    }
}

fn no_site() -> ObservatoryError {
    ObservatoryError::BadPlan { reason: "it has no site".to_owned() }
}
