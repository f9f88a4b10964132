//! A month of nights: how long each is dark.

use crate::{
    error::CelestialError,
    night::{Interval, Night},
    phase::{MoonPhase, PhaseEvent, phases},
    site::Site,
    time::{CalendarDate, DAY_S},
};
use serde::Serialize;

/// A night of a calendar.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
pub struct CalendarNight {
    /// The date of the evening.
    pub date: CalendarDate,
    /// The Sun lower than −18° and the Moon below the horizon, hours.
    pub dark_hours: f64,
    /// The Sun lower than −18°, the Moon there or not, hours.
    pub astronomical_night_hours: f64,
    /// When it is dark.
    pub dark_intervals: Vec<Interval>,
    /// Lit part of the Moon when the Sun is lowest, 0..=1.
    pub moon_illuminated_fraction: f64,
    /// Its phase then.
    pub moon_phase: MoonPhase,
}

/// The nights of a month.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
pub struct Calendar {
    /// As `2026-08`.
    pub month: String,
    /// Where.
    pub site: Site,
    /// By date.
    pub nights: Vec<CalendarNight>,
    /// New Moons, quarters and full Moons between the month's first and last noon.
    pub moon_phases: Vec<PhaseEvent>,
    /// Sum of the dark hours.
    pub dark_hours: f64,
    /// Dates from the most dark hours to the fewest; the earlier first where they are equal.
    pub darkest: Vec<CalendarDate>,
}

impl Calendar {
    /// Of a month, `2026-08`.
    ///
    /// # Errors
    /// [`CelestialError::NoMonth`], [`CelestialError::OutsideYears`].
    pub fn of(site: Site, month: &str) -> Result<Self, CelestialError> {
        let dates = CalendarDate::month(month)?;
        let nights: Vec<CalendarNight> = dates.iter().map(|date| CalendarNight::of(site, *date)).collect();
        let noon = |date: &CalendarDate, days: f64| {
            date.midnight_utc().plus_s(DAY_S * (days + 0.5 - site.longitude_deg() / 360.0))
        };
        let moon_phases = match (dates.first(), dates.last()) {
            (Some(first), Some(last)) => phases(noon(first, 0.0), noon(last, 1.0)),
            _ => Vec::new(),
        };
        let mut order: Vec<&CalendarNight> = nights.iter().collect();
        order.sort_by(|a, b| b.dark_hours.total_cmp(&a.dark_hours));
        Ok(Self {
            month: month.trim().to_owned(),
            site,
            moon_phases,
            dark_hours: nights.iter().fold(0.0, |sum, night| sum + night.dark_hours),
            darkest: order.into_iter().map(|night| night.date).collect(),
            nights,
        })
    }
}

impl CalendarNight {
    /// Of the evening of a date.
    pub fn of(site: Site, date: CalendarDate) -> Self {
        let night = Night::of(site, date);
        Self {
            date,
            dark_hours: night.dark_hours,
            astronomical_night_hours: Interval::hours_of(&night.astronomical_night),
            dark_intervals: night.dark_intervals,
            moon_illuminated_fraction: night.moon.illuminated_fraction,
            moon_phase: night.moon.phase,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The nights around new Moon are the darkest; a summer far north has none.
    #[test]
    fn nights_around_new_moon_are_darkest() {
        let site = Site::new(46.17, 8.79, 200.0).unwrap();
        let calendar = Calendar::of(site, "2026-08").unwrap();
        assert_eq!(calendar.nights.len(), 31);
        // New Moon on 12 August 2026 at 17:37 UTC, with an eclipse of the Sun.
        let new_moon = calendar.moon_phases.iter().find(|event| event.phase == MoonPhase::NewMoon).unwrap();
        assert!(new_moon.utc.to_rfc3339().starts_with("2026-08-12T17:3"), "{}", new_moon.utc.to_rfc3339());
        let day = |date: &CalendarDate| date.to_string()[8..].parse::<i32>().unwrap();
        assert!(calendar.darkest[..5].iter().all(|date| (9..=20).contains(&day(date))));
        let night = &calendar.nights[27];
        assert!(night.moon_illuminated_fraction > 0.98 && night.dark_hours < 0.2);
        assert!(
            calendar.nights.iter().all(|night| night.dark_hours <= night.astronomical_night_hours + 1e-9)
        );
        let far_north = Calendar::of(Site::new(62.0, 25.0, 0.0).unwrap(), "2026-06").unwrap();
        // Nothing is 0, not the −0 that a sum of nothing is.
        let zero = |hours: f64| hours.to_bits() == 0;
        assert!(zero(far_north.dark_hours), "{}", far_north.dark_hours);
        let hours = |night: &CalendarNight| [night.dark_hours, night.astronomical_night_hours];
        assert!(far_north.nights.iter().flat_map(hours).all(zero));
        assert!(matches!(Calendar::of(site, "2026-8"), Err(CelestialError::NoMonth(_))));
        assert!(Calendar::of(site, "1899-12").is_err());
    }
}
