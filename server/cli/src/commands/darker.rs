//! `skyglow darker`: darker places near a place.

use crate::{
    failure::Failure,
    flags::{JsonFlags, ProgramFlags},
    print,
    query::{self, QueryFlags},
    render,
    table::aligned,
};
use clap::Args;
use skyglow_app::{
    answers::{DarkerAnswer, DarkerPlaceAnswer, LowSkyAnswer},
    parameters::DarkerParameters,
    request,
};
use skyglow_scene::SceneId;

/// Find darker places near a place, what they gain, and in which directions their low sky is clean
#[derive(Debug, Args)]
#[command(after_help = "Example:\n  skyglow darker --scene demo --lat 46.17 --lon 8.79 --within-km 40")]
pub(crate) struct Darker {
    /// The scene's id
    #[arg(long, env = "SKYGLOW_SCENE", value_name = "ID", value_parser = SceneId::parse)]
    scene: SceneId,
    #[command(flatten)]
    query: QueryFlags<DarkerParameters>,
    #[command(flatten)]
    program: ProgramFlags,
    #[command(flatten)]
    json: JsonFlags,
}

impl Darker {
    /// Runs the command.
    pub(crate) fn run(self) -> Result<(), Failure> {
        let failure = |error| query::failure(&error);
        let read =
            |facts: &_| request::darker(Some(self.query.query()), self.scene.clone(), facts).map_err(failure);
        read(&self.program.facts())?;
        let source = self.program.source()?;
        let question = read(source.facts())?;
        let view = source.view(&question.here.scene, question.here.scenario.as_ref()).map_err(failure)?;
        let found = source.darker(&question.search, &view, &|_| true).map_err(failure)?;
        let (assumptions, here) = render::rendered(source.as_ref(), question.here.clone())?;
        let sky =
            |place| render::rendered(source.as_ref(), question.sky_at(place)).map(|(_, sky)| Box::new(sky));
        let skies = found.places.iter().map(|it| sky(it.place)).collect::<Result<Vec<_>, _>>()?;
        let at = (question.here.place, &here);
        let named = source.places(&view);
        let answer = DarkerAnswer::new(assumptions, at, question.search.within_m, &found, &skies, &named);
        if self.json.json {
            return print::print_json(&answer);
        }
        for warning in &answer.assumptions.warnings {
            tracing::warn!("{warning}");
        }
        print::print_line(aligned(&rows(&answer)).trim_end())
    }
}

fn rows(answer: &DarkerAnswer) -> Vec<Vec<String>> {
    let head = ["zenith", "gain", "distance", "azimuth", "position", "altitude", "clean directions", "near"];
    let here = &answer.here;
    let total = |value: Option<f64>| value.map_or_else(|| "-".to_owned(), |mag| format!("{mag:.2}"));
    let first = [
        total(here.zenith_total_brightness_mag_arcsec2),
        "here".to_owned(),
        String::new(),
        String::new(),
        position(here.latitude_deg, here.longitude_deg),
        altitude(here.terrain_altitude_m),
        clean(here.low_sky.as_ref()),
        String::new(),
    ];
    let row = |place: &DarkerPlaceAnswer| {
        let sky = &place.sky;
        let near = place.nearest_place.as_ref();
        vec![
            total(sky.zenith_total_brightness_mag_arcsec2),
            place.gain_mag.map_or_else(String::new, |gain| format!("{gain:+.2}")),
            format!("{:.1} km", place.distance_m / 1e3),
            format!("{:.0}", place.azimuth_deg),
            position(sky.latitude_deg, sky.longitude_deg),
            altitude(sky.terrain_altitude_m),
            clean(sky.low_sky.as_ref()),
            near.map_or_else(String::new, |it| {
                format!("{:.0} km at {:.0} degrees from {}", it.distance_m / 1e3, it.azimuth_deg, it.name)
            }),
        ]
    };
    let places = answer.places.iter().map(row);
    [head.map(str::to_owned).to_vec(), first.to_vec()].into_iter().chain(places).collect()
}

fn position(latitude_deg: f64, longitude_deg: f64) -> String {
    format!("{latitude_deg:.4}, {longitude_deg:.4}")
}

fn altitude(terrain_m: Option<f64>) -> String {
    terrain_m.map_or_else(|| "unknown".to_owned(), |altitude_m| format!("{altitude_m:.0} m"))
}

fn clean(low: Option<&LowSkyAnswer>) -> String {
    let ranges = low.map(|low| low.clean_directions_deg.as_slice()).unwrap_or_default();
    match ranges {
        [] => "none".to_owned(),
        some => {
            some.iter().map(|[first, last]| format!("{first:.0}-{last:.0}")).collect::<Vec<_>>().join(", ")
        }
    }
}
