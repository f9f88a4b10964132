//! `skyglow shares`: whose light it is, by named places or by areas.

use crate::{
    failure::Failure,
    flags::{JsonFlags, ProgramFlags},
    print,
    query::{self, QueryFlags},
    table::aligned,
};
use clap::Args;
use skyglow_app::{
    answers::{Assumptions, PartAnswer},
    facts::SourceFacts,
    parameters::SharesParameters,
    request,
    shares_file::{SharesFormat, SharesOutcome, SharesQuestion},
};
use skyglow_scene::SceneId;
use std::path::PathBuf;

/// Say whose artificial light the sky of a place is, by the scene's named places or by areas with names
#[derive(Debug, Args)]
#[command(
    after_help = "Example:\n  skyglow shares --scene demo --lat 46.53 --lon 8.61\n  skyglow shares --scene demo --lat 46.53 --lon 8.61 --areas municipalities.geojson -o shares.csv"
)]
pub(crate) struct Shares {
    /// The scene's id
    #[arg(long, env = "SKYGLOW_SCENE", value_name = "ID", value_parser = SceneId::parse)]
    scene: SceneId,
    /// GeoJSON file of areas with names, such as municipalities: shares of each of them instead of the scene's named places
    #[arg(long, env = "SKYGLOW_AREAS", value_name = "FILE")]
    areas: Option<PathBuf>,
    /// The property of the areas that holds their names, where it is not a usual one
    #[arg(long, env = "SKYGLOW_NAME_FIELD", value_name = "NAME", requires = "areas")]
    name_field: Option<String>,
    /// File to write instead of a table on the screen: .csv, .parquet, .geojson (areas as they came, with their shares) or .json
    #[arg(short, long, env = "SKYGLOW_OUTPUT", value_name = "FILE", value_parser = output)]
    output: Option<(PathBuf, SharesFormat)>,
    #[command(flatten)]
    query: QueryFlags<SharesParameters>,
    #[command(flatten)]
    program: ProgramFlags,
    #[command(flatten)]
    json: JsonFlags,
}

/// A file by its name, whose ending is that of a format.
fn output(text: &str) -> Result<(PathBuf, SharesFormat), String> {
    let path = PathBuf::from(text);
    match path.extension().and_then(|extension| extension.to_str()) {
        Some("csv") => Ok((path, SharesFormat::Csv)),
        Some("json") => Ok((path, SharesFormat::Json)),
        Some("parquet") => Ok((path, SharesFormat::Parquet)),
        Some("geojson") => Ok((path, SharesFormat::GeoJson)),
        _ => Err("the ending must be .csv, .parquet, .geojson or .json".to_owned()),
    }
}

impl Shares {
    /// Runs the command.
    pub(crate) fn run(self) -> Result<(), Failure> {
        let areas = self.areas.as_ref().map(|path| std::fs::read(path).map_err(|e| Failure::file(path, e)));
        let areas = areas.transpose()?;
        self.question(areas.as_deref(), &self.program.facts())?;
        let source = self.program.source()?;
        let failure = |error| query::failure(&error);
        let question = self.question(areas.as_deref(), source.facts())?;
        let request = match &question {
            SharesQuestion::Places(places) => &places.request,
            SharesQuestion::Areas(areas) => &areas.request,
        };
        let view = source.view(&request.sky.scene, request.sky.scenario.as_ref()).map_err(failure)?;
        if let SharesQuestion::Areas(areas) = &question {
            areas.check_within(view.metadata().bounds).map_err(failure)?;
        }
        let map = source.influence(request, &view, &|_| true).map_err(failure)?;
        let assumptions = Assumptions::of_influences(request, &map, source.facts());
        for warning in &assumptions.warnings {
            tracing::warn!("{warning}");
        }
        let outcome = question.answer(assumptions, &map, &|_| true).map_err(failure)?;
        match &self.output {
            Some((path, format)) => {
                let posted = areas.as_deref().unwrap_or_default();
                let bytes = outcome.encode(*format, posted).map_err(Failure::work)?;
                std::fs::write(path, bytes).map_err(|error| Failure::file(path, error))
            }
            None if self.json.json => print::print_json(&outcome),
            None => print::print_line(aligned(&rows(&outcome)).trim_end()),
        }
    }

    fn question(&self, areas: Option<&[u8]>, facts: &SourceFacts) -> Result<SharesQuestion, Failure> {
        let (query, scene) = (self.query.query(), self.scene.clone());
        let question = match areas {
            None => request::shares(Some(query), scene, facts).map(SharesQuestion::Places),
            Some(areas) => {
                let mut query = form_urlencoded::Serializer::new(query.to_owned());
                if let Some(field) = &self.name_field {
                    query.append_pair("name_field", field);
                }
                request::area_shares(Some(&query.finish()), areas, scene, facts).map(SharesQuestion::Areas)
            }
        };
        question.map_err(|error| query::failure(&error))
    }
}

fn rows(outcome: &SharesOutcome) -> Vec<Vec<String>> {
    let percent = |part: &PartAnswer| format!("{:.2} %", 100.0 * part.share);
    let row = |share: String, name: &str, more: String| vec![share, name.to_owned(), more];
    match outcome {
        SharesOutcome::Places(answer) => {
            let places = answer.places.iter().map(|place| {
                let way =
                    format!("{:.0} km, azimuth {:.0} degrees", place.distance_m / 1e3, place.azimuth_deg);
                row(percent(&place.part), &place.name, way)
            });
            let others = match answer.other_places_count {
                0 => None,
                count => Some(row(percent(&answer.other_places), "other places", count.to_string())),
            };
            let elsewhere = row(percent(&answer.elsewhere), "elsewhere", "near no named place".to_owned());
            places.chain(others).chain([elsewhere]).collect()
        }
        SharesOutcome::Areas(answer) => {
            let areas = answer.areas.iter().map(|area| row(percent(&area.part), &area.name, String::new()));
            areas.chain([row(percent(&answer.outside), "outside", "in none of them".to_owned())]).collect()
        }
    }
}
