//! `skyglow night`: when a night is dark, and in a scene how bright it is hour by hour.

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
    answers::{NightHourAnswer, NightHoursAnswer},
    parameters::SceneNightParameters,
    request,
};
use skyglow_celestial::{
    Instant, Night as FoundNight,
    night::{Stays, Twilight},
};
use skyglow_scene::SceneId;

/// Say when the Sun sets and rises, how twilight goes, what the Moon does, and when the night is dark
///
/// With a scene it also says how bright zenith and horizon are hour by hour, with all light, and which hour is the darkest. Flags beside
/// place and date mean something in a scene alone.
#[derive(Debug, Args)]
#[command(
    after_help = "Examples:\n  skyglow night --lat 46.17 --lon 8.79 --date 2026-08-12\n  skyglow night --scene demo --lat 46.17 --lon 8.79 --date 2026-08-12"
)]
pub(crate) struct Night {
    /// The scene's id, for the sky hour by hour
    #[arg(long, env = "SKYGLOW_SCENE", value_name = "ID", value_parser = SceneId::parse)]
    scene: Option<SceneId>,
    #[command(flatten)]
    query: QueryFlags<SceneNightParameters>,
    #[command(flatten)]
    program: ProgramFlags,
    #[command(flatten)]
    json: JsonFlags,
}

impl Night {
    /// Runs the command.
    pub(crate) fn run(self) -> Result<(), Failure> {
        if let Some(scene) = &self.scene {
            let answer = self.hours(scene)?;
            if self.json.json {
                return print::print_json(&answer);
            }
            print::print_line(aligned(&rows(&answer.night)).trim_end())?;
            return print::print_line(aligned(&hour_rows(&answer)).trim_end());
        }
        let night = request::night(Some(self.query.query())).map_err(|error| query::failure(&error))?;
        if self.json.json {
            return print::print_json(&night);
        }
        print::print_line(aligned(&rows(&night)).trim_end())
    }
}

impl Night {
    fn hours(&self, scene: &SceneId) -> Result<NightHoursAnswer, Failure> {
        let read = |facts: &_| {
            request::scene_night(Some(self.query.query()), scene.clone(), facts)
                .map_err(|error| query::failure(&error))
        };
        read(&self.program.facts())?;
        let source = self.program.source()?;
        let asked = read(source.facts())?;
        let (assumptions, sky) = render::rendered(source.as_ref(), asked.sky.clone())?;
        let skies = source.sky_at_times(&asked.sky, &sky, &asked.hours());
        let skies = skies.map_err(|error| query::failure(&error))?;
        Ok(NightHoursAnswer::new(assumptions, asked.night, asked.solar_flux_sfu, &skies))
    }
}

fn hour_rows(answer: &NightHoursAnswer) -> Vec<Vec<String>> {
    let titles = ["time", "Sun, deg", "Moon, deg", "zenith, mag/arcsec2", "SQM", "horizon, mag/arcsec2", ""];
    let magnitude = |value: Option<f64>| value.map_or_else(|| "-".to_owned(), |m| format!("{m:.2}"));
    let hour = |hour: &NightHourAnswer| {
        let is_best = answer.best_hour == Some(hour.time);
        vec![
            hour.time.to_rfc3339(),
            format!("{:.1}", hour.sun_altitude_deg),
            format!("{:.1}", hour.moon_altitude_deg),
            magnitude(hour.zenith_total_brightness_mag_arcsec2),
            magnitude(hour.sqm_total_brightness_mag_arcsec2),
            magnitude(hour.horizon_total_brightness_mag_arcsec2),
            if is_best { "darkest" } else { "" }.to_owned(),
        ]
    };
    [titles.map(str::to_owned).to_vec()].into_iter().chain(answer.hours.iter().map(hour)).collect()
}

fn rows(night: &FoundNight) -> Vec<Vec<String>> {
    let row = |name: &str, value: String| vec![name.to_owned(), value];
    let time = |instant: Option<Instant>| instant.map_or_else(|| "not".to_owned(), Instant::to_rfc3339);
    let stays = |which: Option<Stays>| match which {
        Some(Stays::Above) => "not: it stays up".to_owned(),
        Some(Stays::Below) => "not: it stays down".to_owned(),
        None => "not".to_owned(),
    };
    let sun = |instant: Option<Instant>| instant.map_or_else(|| stays(night.sun.stays), Instant::to_rfc3339);
    let moon = |instants: &[Instant]| match instants {
        [] => stays(night.moon.stays),
        some => some.iter().map(|instant| instant.to_rfc3339()).collect::<Vec<_>>().join(", "),
    };
    let twilight = |twilight: &Twilight| {
        let name = format!("{:?} twilight", twilight.kind).to_lowercase();
        let (end, begin) = (time(twilight.evening_end_utc), time(twilight.morning_begin_utc));
        row(&name, format!("ends {end}, begins {begin}"))
    };
    let mut rows = vec![
        row("Sun sets", sun(night.sun.set_utc)),
        row("Sun rises", sun(night.sun.rise_utc)),
        row(
            "Sun lowest",
            format!("{}, {:.1} degrees", night.sun.lowest_utc.to_rfc3339(), night.sun.lowest_altitude_deg),
        ),
    ];
    rows.extend(night.twilights.iter().map(twilight));
    rows.extend([
        row("Moon rises", moon(&night.moon.rises_utc)),
        row("Moon sets", moon(&night.moon.sets_utc)),
        row("Moon", format!("{:.0} % lit", 100.0 * night.moon.illuminated_fraction)),
        row("dark", format!("{:.2} h", night.dark_hours)),
    ]);
    rows.extend(night.dark_intervals.iter().map(|interval| {
        row("", format!("{} to {}", interval.from_utc.to_rfc3339(), interval.until_utc.to_rfc3339()))
    }));
    rows
}
