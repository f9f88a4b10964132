//! Sites of plans, with what each wants.

use crate::{
    facts::SourceFacts,
    parameters as p,
    reader::Reader,
    request::{
        geojson::boundary,
        influence::curve,
        plan_body::{LevelBody, PlanBody, SiteBody},
        sky::Conditions,
    },
    validation::ValidationCode,
};
use skyglow_observatory::{
    InfluenceRequest, Level, Limit, Measure, ObserverHeight, PlanMethod, SkyRequest, TargetSite,
};
use skyglow_physics::GeoPoint;
use skyglow_scene::SceneId;

/// Most sites of a plan.
const MAX_SITES: usize = 16;
/// What a level may be.
const LEVELS: &str = "0 or more in the measure's unit, or \"p0\" to \"p100\"";

/// What reading sites needs.
pub(super) struct Sites<'a> {
    pub(super) reader: &'a mut Reader,
    pub(super) conditions: &'a Conditions,
    pub(super) scene: &'a SceneId,
    pub(super) facts: &'a SourceFacts,
}

impl Sites<'_> {
    fn fail(&mut self, name: &str, message: &str, allowed: &str, code: ValidationCode) {
        self.reader.fail_part(name, message, allowed, code);
    }

    pub(super) fn threshold(&mut self, body: &PlanBody) -> Option<PlanMethod> {
        for (name, is_given) in [
            ("sites", body.sites.is_some()),
            ("max_cut", body.max_cut.is_some()),
            ("protect", body.protect.is_some()),
        ] {
            if is_given {
                self.fail(
                    name,
                    "means nothing for a threshold plan",
                    "nothing here",
                    ValidationCode::Conflict,
                );
            }
        }
        let Some(site) = &body.site else {
            self.fail("site", "is required", "an object with `lat` and `lon`", ValidationCode::Missing);
            return None;
        };
        for (name, is_given) in [
            ("site.measure", site.measure.is_some()),
            ("site.region", site.region.is_some()),
            ("site.at_most", site.at_most.is_some()),
            ("site.reduce_by", site.reduce_by.is_some()),
        ] {
            if is_given {
                let allowed = "`measure`, `region`, `q_a` and `q_b` beside the site";
                self.fail(
                    name,
                    "means nothing in the site of a threshold plan",
                    allowed,
                    ValidationCode::Conflict,
                );
            }
        }
        let sky = self.sky("site", site);
        let measure = self.measure("", body.measure.as_deref(), body.region.as_ref(), true);
        let from = match &body.q_a {
            Some(level) => self.level("q_a", level),
            None => {
                self.fail("q_a", "is required", LEVELS, ValidationCode::Missing);
                None
            }
        };
        let to = match &body.q_b {
            Some(level) => self.level("q_b", level),
            None => from,
        };
        let gamma = self.part("gamma", body.gamma.unwrap_or(1.0));
        let (sky, measure, from, to) = (sky?, measure?, from?, to?);
        let is_upside_down = match (from, to) {
            (Level::Value(a), Level::Value(b)) | (Level::Percentile(a), Level::Percentile(b)) => a > b,
            _ => false,
        };
        if is_upside_down {
            self.fail("q_b", "is below q_a", "q_a or more", ValidationCode::Conflict);
            return None;
        }
        let site = InfluenceRequest { sky, measure };
        Some(PlanMethod::Threshold { site: site.into(), from, to, gamma: gamma? })
    }

    pub(super) fn target(&mut self, body: &PlanBody) -> Option<PlanMethod> {
        for (name, is_given) in [
            ("site", body.site.is_some()),
            ("measure", body.measure.is_some()),
            ("region", body.region.is_some()),
            ("q_a", body.q_a.is_some()),
            ("q_b", body.q_b.is_some()),
            ("gamma", body.gamma.is_some()),
        ] {
            if is_given {
                let allowed = "`sites`, each with its measure, `max_cut` and `protect`";
                self.fail(name, "means nothing for a target plan", allowed, ValidationCode::Conflict);
            }
        }
        let sites = body.sites.as_deref().unwrap_or_default();
        if !(1..=MAX_SITES).contains(&sites.len()) {
            let (message, allowed) =
                (format!("there are {}", sites.len()), format!("1 to {MAX_SITES} sites"));
            self.fail("sites", &message, &allowed, ValidationCode::NotAllowed);
            return None;
        }
        let max_cut = self.part("max_cut", body.max_cut.unwrap_or(1.0));
        let protect = body.protect.as_ref().and_then(|body| match boundary(body) {
            Ok(boundary) => Some(boundary),
            Err(error) => {
                let allowed = "a GeoJSON Polygon or MultiPolygon in degrees, closed rings";
                self.reader.fail_body("protect", &error, allowed);
                None
            }
        });
        let mut targets = Vec::new();
        for (number, site) in sites.iter().enumerate() {
            let name = format!("sites[{number}]");
            let sky = self.sky(&name, site);
            let measure =
                self.measure(&format!("{name}."), site.measure.as_deref(), site.region.as_ref(), false);
            let limit = self.limit(&name, site);
            if let (Some(sky), Some(measure), Some(limit)) = (sky, measure, limit) {
                targets.push(TargetSite { influence: InfluenceRequest { sky, measure }, limit });
            }
        }
        Some(PlanMethod::Target { sites: targets, max_cut: max_cut?, protect })
    }

    fn sky(&mut self, name: &str, site: &SiteBody) -> Option<SkyRequest> {
        let maximum_m = self.facts.altitude_range_m.1;
        let place = match GeoPoint::from_deg(site.lat, site.lon) {
            Ok(place) => Some(place),
            Err(error) => {
                let allowed = "lat -90 to 90, lon -180 to 360 degrees";
                self.reader.fail_body(name, &error, allowed);
                None
            }
        };
        let eye = match (site.height, site.altitude) {
            (Some(_), Some(_)) => {
                let name = format!("{name}.altitude");
                self.fail(
                    &name,
                    "excludes `height`, which is given too",
                    "one of the two",
                    ValidationCode::Conflict,
                );
                None
            }
            (None, Some(altitude_m)) if altitude_m <= maximum_m => {
                Some(ObserverHeight::AboveSea(altitude_m.max(0.0)))
            }
            (None, Some(_)) => {
                let allowed = format!("0 to {maximum_m} m above sea level; below 0 counts as 0");
                self.fail(
                    &format!("{name}.altitude"),
                    "is out of range",
                    &allowed,
                    ValidationCode::OutOfRange,
                );
                None
            }
            (height, None) => {
                let height_m = height.unwrap_or(2.0);
                if (0.0..=maximum_m).contains(&height_m) {
                    Some(ObserverHeight::AboveGround(height_m))
                } else {
                    let allowed = format!("0 to {maximum_m} m, less the altitude of the ground");
                    self.fail(
                        &format!("{name}.height"),
                        "is out of range",
                        &allowed,
                        ValidationCode::OutOfRange,
                    );
                    None
                }
            }
        };
        Some(self.conditions.over(self.scene.clone(), place?, eye?))
    }

    fn measure(
        &mut self,
        before: &str,
        name: Option<&str>,
        region: Option<&Vec<[f64; 2]>>,
        with_norm: bool,
    ) -> Option<Measure> {
        let curve = match region.cloned().map(curve).transpose() {
            Ok(curve) => curve,
            Err(error) => {
                self.reader.fail_body(&format!("{before}region"), &error, &p::REGION.allowed());
                return None;
            }
        };
        let (part, allowed) = (format!("{before}measure"), "zenith, mean, horizontal, region");
        match (name, curve) {
            (None | Some("region"), Some(curve)) => Some(Measure::Region(curve)),
            (Some("region"), None) => {
                self.fail(&part, "needs a `region`", allowed, ValidationCode::Missing);
                None
            }
            (Some(_), Some(_)) => {
                let message = "a region is given, and this measure takes none";
                self.fail(&part, message, "region", ValidationCode::Conflict);
                None
            }
            (None | Some("zenith"), None) => Some(Measure::Zenith),
            (Some("mean"), None) => Some(Measure::Mean),
            (Some("horizontal"), None) => Some(Measure::Horizontal),
            (Some("norm"), None) if with_norm => Some(Measure::Norm),
            (Some(_), None) => {
                let allowed = if with_norm { format!("norm, {allowed}") } else { allowed.to_owned() };
                self.fail(&part, "is not allowed", &allowed, ValidationCode::NotAllowed);
                None
            }
        }
    }

    fn limit(&mut self, name: &str, site: &SiteBody) -> Option<Limit> {
        match (site.at_most, site.reduce_by) {
            (Some(most), None) if most >= 0.0 && most.is_finite() => Some(Limit::AtMost(most)),
            (Some(_), None) => {
                let allowed = "0 or more, in the measure's unit";
                self.fail(&format!("{name}.at_most"), "is not allowed", allowed, ValidationCode::NotAllowed);
                None
            }
            (None, Some(part)) => self.part(&format!("{name}.reduce_by"), part).map(Limit::ReduceBy),
            _ => {
                self.fail(
                    name,
                    "wants nothing, or two things",
                    "`at_most` or `reduce_by`",
                    ValidationCode::Missing,
                );
                None
            }
        }
    }

    fn level(&mut self, name: &str, body: &LevelBody) -> Option<Level> {
        let level = match body {
            LevelBody::Value(value) => Some(Level::Value(*value)).filter(|_| *value >= 0.0),
            LevelBody::Percentile(text) => {
                let percent = text.strip_prefix('p').and_then(|digits| digits.parse::<f64>().ok());
                percent.filter(|percent| (0.0..=100.0).contains(percent)).map(Level::Percentile)
            }
        };
        if level.is_none() {
            self.fail(name, "is not allowed", LEVELS, ValidationCode::NotAllowed);
        }
        level
    }

    fn part(&mut self, name: &str, part: f64) -> Option<f64> {
        let is_part = (0.0..=1.0).contains(&part);
        if !is_part {
            self.fail(name, "is not allowed", "0 to 1", ValidationCode::NotAllowed);
        }
        is_part.then_some(part)
    }
}
