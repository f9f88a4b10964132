//! Requests for reduction plans.

mod sites;

use super::{
    influence::{DEFAULT_LIMIT, body_of},
    keeping::{Keeping, read_keeping},
    plan_body::PlanBody,
    sky::read_conditions,
};
use crate::{
    error::AppError,
    facts::SourceFacts,
    parameters::{self as p, ParameterSet},
    reader::Reader,
    validation::ValidationCode,
};
use sites::Sites;
use skyglow_observatory::PlanRequest;
use skyglow_scene::{ChangeId, SceneId};

/// A plan that is to be made.
#[derive(Clone, Debug)]
pub struct PlanStoreRequest {
    /// What the engine is asked.
    pub request: PlanRequest,
    /// The scene.
    pub scene: SceneId,
    /// The scenario or plan that is dimmed.
    pub scenario: Option<ChangeId>,
    /// Pixels listed.
    pub limit: usize,
    /// Whether it is stored, or held for some minutes.
    pub store: bool,
    /// How it is kept, if so.
    pub keeping: Keeping,
}

/// Reads the parameters and the body of a plan.
///
/// # Errors
/// [`AppError::Parameters`] with every mistake.
pub fn plan(
    query: Option<&str>,
    body: &[u8],
    scene: SceneId,
    facts: &SourceFacts,
) -> Result<PlanStoreRequest, AppError> {
    let mut reader = Reader::new(query, p::PlanPostParameters::ALL);
    let conditions = read_conditions(&mut reader, facts);
    let limit = read_limit(&mut reader);
    let store = reader.choice(&p::KEEP) != Some("off");
    let keeping = read_keeping(&mut reader);
    let allowed = "a JSON object with `method`, and `site` or `sites`";
    let body: PlanBody = body_of(body, &mut reader, allowed);
    let Some(conditions) = conditions.filter(|_| reader.is_fine()) else {
        reader.finish()?;
        return Err(AppError::internal("a plan was neither read nor refused"));
    };
    let mut of_sites = Sites { reader: &mut reader, conditions: &conditions, scene: &scene, facts };
    let read = match body.method.as_str() {
        "threshold" => of_sites.threshold(&body),
        "target" => of_sites.target(&body),
        _ => {
            reader.fail_part("method", "is not allowed", "threshold, target", ValidationCode::NotAllowed);
            None
        }
    };
    reader.finish()?;
    let method = read.ok_or_else(|| AppError::internal("a plan was neither read nor refused"))?;
    let scenario = conditions.scenario().cloned();
    Ok(PlanStoreRequest { request: PlanRequest { method }, scene, scenario, limit, store, keeping })
}

/// Reads how much of a plan is listed.
///
/// # Errors
/// [`AppError::Parameters`].
pub fn plan_limit(query: Option<&str>) -> Result<usize, AppError> {
    let mut reader = Reader::new(query, p::PlanListParameters::ALL);
    let limit = read_limit(&mut reader);
    reader.finish()?;
    Ok(limit)
}

fn read_limit(reader: &mut Reader) -> usize {
    reader.integer(&p::LIMIT).map_or(DEFAULT_LIMIT, |limit| limit as usize)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::request::tests::facts;
    use skyglow_observatory::{Level, Limit, Measure, ObserverHeight, PlanMethod};

    fn read(body: &str) -> Result<PlanStoreRequest, AppError> {
        plan(Some("turbidity=3&limit=5"), body.as_bytes(), SceneId::parse("demo").unwrap(), &facts())
    }

    fn refused(body: &str) -> Vec<String> {
        match read(body) {
            Err(AppError::Parameters(errors)) => errors.into_iter().map(|error| error.parameter).collect(),
            other => panic!("{body}: {other:?}"),
        }
    }

    #[test]
    fn both_methods_are_read() {
        let asked =
            read(r#"{"method": "threshold", "site": {"lat": 1, "lon": 36}, "q_a": "p90", "q_b": "p99", "gamma": 0.5}"#)
                .unwrap();
        let PlanMethod::Threshold { site, from, to, gamma } = asked.request.method else {
            panic!("no threshold")
        };
        assert_eq!((from, to, gamma), (Level::Percentile(90.0), Level::Percentile(99.0), 0.5));
        assert_eq!((site.measure, site.sky.turbidity.value(), asked.limit), (Measure::Zenith, 3.0, 5));
        let asked = read(
            r#"{"method": "target", "max_cut": 0.8, "sites": [
                {"lat": 1, "lon": 36, "measure": "mean", "at_most": 1e-4},
                {"lat": 1, "lon": 37, "altitude": 2000, "region": [[10, 20], [50, 20], [30, 60]], "reduce_by": 0.3}],
                "protect": {"type": "Polygon", "coordinates": [[[36, 0], [37, 0], [37, 1], [36, 0]]]}}"#,
        )
        .unwrap();
        let PlanMethod::Target { sites, max_cut, protect } = asked.request.method else {
            panic!("no target")
        };
        assert_eq!((sites.len(), max_cut, protect.is_some()), (2, 0.8, true));
        assert_eq!((sites[0].limit, sites[1].limit), (Limit::AtMost(1e-4), Limit::ReduceBy(0.3)));
        assert_eq!(sites[1].influence.sky.observer_height, ObserverHeight::AboveSea(2000.0));
    }

    /// What cannot be meant is refused by the name of its part.
    #[test]
    fn a_wrong_part_is_refused_by_its_name() {
        let threshold =
            |rest: &str| format!(r#"{{"method": "threshold", "site": {{"lat": 1, "lon": 36}}{rest}}}"#);
        let target =
            |site: &str| format!(r#"{{"method": "target", "sites": [{{"lat": 1, "lon": 36{site}}}]}}"#);
        for (body, part) in [
            ("{".to_owned(), "body"),
            ("[]".to_owned(), "body"),
            (r#"{"method": "magic"}"#.to_owned(), "method"),
            (r#"{"method": "threshold", "q_a": 1}"#.to_owned(), "site"),
            (threshold(""), "q_a"),
            (threshold(r#", "q_a": "p101""#), "q_a"),
            (threshold(r#", "q_a": "90""#), "q_a"),
            (threshold(r#", "q_a": -1"#), "q_a"),
            (threshold(r#", "q_a": "p90", "q_b": "p80""#), "q_b"),
            (threshold(r#", "q_a": "p90", "gamma": 1.5"#), "gamma"),
            (threshold(r#", "q_a": "p90", "measure": "beauty""#), "measure"),
            (threshold(r#", "q_a": "p90", "measure": "region""#), "measure"),
            (threshold(r#", "q_a": "p90", "region": [[1, 2], [3, 4]]"#), "region"),
            (threshold(r#", "q_a": "p90", "max_cut": 0.5"#), "max_cut"),
            (threshold(r#", "q_a": "p90", "color": 0.5"#), "body"),
            (r#"{"method": "target", "sites": []}"#.to_owned(), "sites"),
            (r#"{"method": "target"}"#.to_owned(), "sites"),
            (target(""), "sites[0]"),
            (target(r#", "at_most": 1, "reduce_by": 0.5"#), "sites[0]"),
            (target(r#", "at_most": -1"#), "sites[0].at_most"),
            (target(r#", "reduce_by": 2"#), "sites[0].reduce_by"),
            (target(r#", "measure": "norm", "reduce_by": 0.2"#), "sites[0].measure"),
            (target(r#", "height": 1, "altitude": 1, "reduce_by": 0.2"#), "sites[0].altitude"),
            (target(r#", "altitude": 90000, "reduce_by": 0.2"#), "sites[0].altitude"),
            (target(r#", "height": -2, "reduce_by": 0.2"#), "sites[0].height"),
            (r#"{"method": "target", "sites": [{"lat": 99, "lon": 36, "reduce_by": 0.2}]}"#.to_owned(), "sites[0]"),
            (r#"{"method": "target", "sites": [{"lat": 1, "lon": 36, "reduce_by": 0.2}], "protect": {"type": "Polygon", "coordinates": []}}"#.to_owned(), "protect"),
            (r#"{"method": "target", "q_a": 1, "sites": [{"lat": 1, "lon": 36, "reduce_by": 0.2}]}"#.to_owned(), "q_a"),
        ] {
            assert_eq!(refused(&body), [part], "{body}");
        }
    }
}
