//! `skyglow nights`: a month of nights.

use crate::{
    failure::Failure,
    flags::JsonFlags,
    print,
    query::{self, QueryFlags},
    table::aligned,
};
use clap::Args;
use skyglow_app::{parameters::NightsParameters, request};
use skyglow_celestial::Calendar;

/// Say for every night of a month how long and when it is dark
#[derive(Debug, Args)]
#[command(after_help = "Example:\n  skyglow nights --lat 46.17 --lon 8.79 --month 2026-08")]
pub(crate) struct Nights {
    #[command(flatten)]
    query: QueryFlags<NightsParameters>,
    #[command(flatten)]
    json: JsonFlags,
}

impl Nights {
    /// Runs the command.
    pub(crate) fn run(self) -> Result<(), Failure> {
        let month = request::nights(Some(self.query.query())).map_err(|error| query::failure(&error))?;
        if self.json.json {
            return print::print_json(&month);
        }
        print::print_line(aligned(&rows(&month)).trim_end())
    }
}

fn rows(month: &Calendar) -> Vec<Vec<String>> {
    let titles = ["evening of", "dark, h", "Sun below -18, h", "Moon lit, %", "dark from", "until"];
    let mut rows = vec![titles.map(str::to_owned).to_vec()];
    for night in &month.nights {
        let at = |interval: Option<&skyglow_celestial::night::Interval>| {
            interval.map_or_else(Default::default, |i| [i.from_utc.to_rfc3339(), i.until_utc.to_rfc3339()])
        };
        let [from, until] = at(night.dark_intervals.first());
        rows.push(vec![
            night.date.to_string(),
            format!("{:.2}", night.dark_hours),
            format!("{:.2}", night.astronomical_night_hours),
            format!("{:.0}", 100.0 * night.moon_illuminated_fraction),
            from,
            until,
        ]);
        for interval in night.dark_intervals.iter().skip(1) {
            let [from, until] = at(Some(interval));
            rows.push([[const { String::new() }; 4].as_slice(), &[from, until]].concat());
        }
    }
    rows.push(vec!["together".to_owned(), format!("{:.2}", month.dark_hours)]);
    rows
}
