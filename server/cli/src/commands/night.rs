//! `skyglow night`: when a night is dark.

use crate::{
    failure::Failure,
    flags::JsonFlags,
    print,
    query::{self, QueryFlags},
    table::aligned,
};
use clap::Args;
use skyglow_app::{parameters::NightParameters, request};
use skyglow_celestial::{Instant, Night as FoundNight, night::Twilight};

/// Say when the Sun sets and rises, how twilight goes, what the Moon does, and when the night is dark
#[derive(Debug, Args)]
#[command(after_help = "Example:\n  skyglow night --lat 46.17 --lon 8.79 --date 2026-08-12")]
pub(crate) struct Night {
    #[command(flatten)]
    query: QueryFlags<NightParameters>,
    #[command(flatten)]
    json: JsonFlags,
}

impl Night {
    /// Runs the command.
    pub(crate) fn run(self) -> Result<(), Failure> {
        let night = request::night(Some(self.query.query())).map_err(|error| query::failure(&error))?;
        if self.json.json {
            return print::print_json(&night);
        }
        print::print_line(aligned(&rows(&night)).trim_end())
    }
}

fn rows(night: &FoundNight) -> Vec<Vec<String>> {
    let row = |name: &str, value: String| vec![name.to_owned(), value];
    let time = |instant: Option<Instant>| instant.map_or_else(|| "not".to_owned(), Instant::to_rfc3339);
    let all = |instants: &[Instant]| match instants {
        [] => "not".to_owned(),
        some => some.iter().map(|instant| instant.to_rfc3339()).collect::<Vec<_>>().join(", "),
    };
    let twilight = |twilight: &Twilight| {
        let name = format!("{:?} twilight", twilight.kind).to_lowercase();
        let (end, begin) = (time(twilight.evening_end_utc), time(twilight.morning_begin_utc));
        row(&name, format!("ends {end}, begins {begin}"))
    };
    let mut rows = vec![
        row("Sun sets", time(night.sun.set_utc)),
        row("Sun rises", time(night.sun.rise_utc)),
        row(
            "Sun lowest",
            format!("{}, {:.1} degrees", night.sun.lowest_utc.to_rfc3339(), night.sun.lowest_altitude_deg),
        ),
    ];
    rows.extend(night.twilights.iter().map(twilight));
    rows.extend([
        row("Moon rises", all(&night.moon.rises_utc)),
        row("Moon sets", all(&night.moon.sets_utc)),
        row("Moon", format!("{:.0} % lit", 100.0 * night.moon.illuminated_fraction)),
        row("dark", format!("{:.2} h", night.dark_hours)),
    ]);
    rows.extend(night.dark_intervals.iter().map(|interval| {
        row("", format!("{} to {}", interval.from_utc.to_rfc3339(), interval.until_utc.to_rfc3339()))
    }));
    rows
}
