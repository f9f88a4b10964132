//! The linear programme of a target plan (`docs/model.md#plans`): pixels within reach of its sites, and what is wanted of each.

use crate::{
    influence_map::InfluenceMap,
    plan_request::{DimmedPixel, Limit, SitePlan, SkyState, TargetSite},
    reduction::Reduction,
};
use rayon::prelude::*;
use skyglow_scene::{Boundary, Scene};
use std::sync::Arc;

/// A wanted value is met if the sky is not above it by more than this part of it, and what f32 loses.
const MET_WITHIN: f64 = 1e-4;
/// What f32 loses of a sky; where less than that part of it is wanted, so much more is met too.
const LOST_BY_ROUNDING: f64 = 1e-6;
/// A part of a light that is no more than this is not worth the trouble, and f32 would lose it.
const MIN_CUT: f64 = 1e-6;

/// Lit pixels within reach of some sites, each once: lights of several fixtures in a pixel are dimmed together.
pub(crate) struct Reach {
    /// Ascending.
    pub(crate) codes: Vec<u64>,
    pub(crate) flux_dnb_w: Vec<f64>,
    /// `[site][pixel]`.
    pub(crate) influence: Arc<[Vec<f64>]>,
}

impl Reach {
    pub(crate) fn of(maps: &[InfluenceMap]) -> Self {
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
    pub(crate) fn dimmed(&self, cut: &[f64]) -> Vec<DimmedPixel> {
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

/// What a target plan aims at.
pub(crate) struct Target {
    pub(crate) problem: Reduction,
    before: Vec<f64>,
    pub(crate) wanted: Vec<f64>,
    pub(crate) is_protected: Vec<bool>,
}

impl Target {
    pub(crate) fn new(
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
    pub(crate) fn slack(&self, site: usize) -> f64 {
        MET_WITHIN * self.wanted[site] + LOST_BY_ROUNDING * self.before[site]
    }

    pub(crate) fn outcomes(&self, reach: &Reach, after: &[SkyState]) -> Vec<SitePlan> {
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
