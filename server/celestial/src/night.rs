//! What a night holds: rise, set and transit of Sun and Moon, twilights, dark hours (Explanatory Supplement 2013, chapter 12).

use crate::{
    bodies::Moon,
    eclipse::MOON_RADIUS_M,
    ephemeris::{AU_M, Body, Positions},
    path::{Crossing, Path, PathEpochs, crossings, lowest},
    phase::MoonPhase,
    site::Site,
    time::{CalendarDate, DAY_S, Instant},
};
use serde::Serialize;

/// Altitude of the Sun's middle at rise and set, degrees: refraction of 34′ and a radius of 16′.
const SUN_RISES_DEG: f64 = -0.833;
/// Refraction at the horizon, degrees, for the Moon's upper limb.
const HORIZON_REFRACTION_DEG: f64 = 34.0 / 60.0;

/// A body that neither rises nor sets.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
pub enum Stays {
    /// It stays above.
    Above,
    /// It stays below.
    Below,
}

/// How the Sun goes through the night.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
pub struct SunEvents {
    /// Its middle crosses the meridian around the noon that the night begins with.
    pub transit_utc: Option<Instant>,
    /// It sets: its upper limb goes, by standard refraction at a level horizon.
    pub set_utc: Option<Instant>,
    /// It rises.
    pub rise_utc: Option<Instant>,
    /// Where it neither rises nor sets.
    pub stays: Option<Stays>,
    /// It is lowest.
    pub lowest_utc: Instant,
    /// True altitude then, degrees.
    pub lowest_altitude_deg: f64,
}

/// A twilight.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
pub enum TwilightKind {
    /// Until the Sun's middle is 6° below the horizontal plane.
    Civil,
    /// Until 12°.
    Nautical,
    /// Until 18°.
    Astronomical,
}

impl TwilightKind {
    /// All, as evening has them.
    pub const ALL: [TwilightKind; 3] =
        [TwilightKind::Civil, TwilightKind::Nautical, TwilightKind::Astronomical];

    /// True altitude of the Sun's middle at its end, degrees.
    pub const fn sun_altitude_deg(self) -> f64 {
        match self {
            TwilightKind::Civil => -6.0,
            TwilightKind::Nautical => -12.0,
            TwilightKind::Astronomical => -18.0,
        }
    }
}

/// A twilight of a night.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
pub struct Twilight {
    /// Which.
    pub kind: TwilightKind,
    /// It ends in the evening.
    pub evening_end_utc: Option<Instant>,
    /// It begins in the morning.
    pub morning_begin_utc: Option<Instant>,
    /// Where there is neither: the Sun stays above its limit (it never ends) or below (it never begins).
    pub sun_stays: Option<Stays>,
}

/// A body on the meridian.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
pub struct Transit {
    /// When.
    pub utc: Instant,
    /// True altitude, degrees.
    pub altitude_deg: f64,
}

/// How the Moon goes through the night.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
pub struct MoonEvents {
    /// It rises: its upper limb comes, by standard refraction at a level horizon.
    pub rises_utc: Vec<Instant>,
    /// It sets.
    pub sets_utc: Vec<Instant>,
    /// Upper transits.
    pub transits: Vec<Transit>,
    /// Where it neither rises nor sets.
    pub stays: Option<Stays>,
    /// Lit part of its disc when the Sun is lowest, 0..=1.
    pub illuminated_fraction: f64,
    /// Sun–Moon–observer angle then, degrees: 0 at full Moon.
    pub phase_angle_deg: f64,
    /// Its phase then.
    pub phase: MoonPhase,
    /// Whether the lit part grows.
    pub is_waxing: bool,
    /// V outside the air then.
    pub magnitude_v: f64,
}

/// A part of the night.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
pub struct Interval {
    /// It begins.
    pub from_utc: Instant,
    /// It ends.
    pub until_utc: Instant,
    /// Its length, hours.
    pub hours: f64,
}

impl Interval {
    fn new(from_utc: Instant, until_utc: Instant) -> Self {
        Self { from_utc, until_utc, hours: from_utc.hours_until(until_utc) }
    }

    /// Length of all together, hours; 0 of none.
    pub(crate) fn hours_of(intervals: &[Self]) -> f64 {
        intervals.iter().fold(0.0, |sum, interval| sum + interval.hours)
    }
}

/// A night: from noon to noon in local mean solar time.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
pub struct Night {
    /// The date of the evening.
    pub date: CalendarDate,
    /// Where.
    pub site: Site,
    /// The noon that it begins with.
    pub from_utc: Instant,
    /// The noon that it ends with.
    pub until_utc: Instant,
    /// The Sun.
    pub sun: SunEvents,
    /// Civil, nautical and astronomical.
    pub twilights: Vec<Twilight>,
    /// The Moon.
    pub moon: MoonEvents,
    /// The Sun lower than −18°, the Moon there or not.
    pub astronomical_night: Vec<Interval>,
    /// The Sun lower than −18° and the Moon below the horizon.
    pub dark_intervals: Vec<Interval>,
    /// Sum of the dark intervals, hours.
    pub dark_hours: f64,
}

impl Night {
    /// The night that begins on the evening of a date, at a level horizon. The horizon's dip for observers high above it is left out.
    pub fn of(site: Site, date: CalendarDate) -> Self {
        let from = date.midnight_utc().plus_s(DAY_S * (0.5 - site.longitude_deg() / 360.0));
        let until = from.plus_s(DAY_S);
        // An hour more on either side holds true noon.
        let epochs = PathEpochs::new(from.plus_s(-3_600.0));
        let [sun, moon] = [Body::Sun, Body::Moon].map(|body| epochs.path(site, body));
        let sun_above = |limit_deg: f64| {
            let sun = &sun;
            move |at: Instant| sun.at(at).true_altitude_deg() - limit_deg
        };
        let moon_above = |at: Instant| moon_above_horizon_deg(&moon, at);

        let sun_events = sun_events(&sun, from, &crossings(from, until, sun_above(SUN_RISES_DEG)));
        let twilights = TwilightKind::ALL.map(|kind| {
            let limit_deg = kind.sun_altitude_deg();
            let found = crossings(from, until, sun_above(limit_deg));
            Twilight {
                kind,
                evening_end_utc: first(&found, false),
                morning_begin_utc: first(&found, true),
                sun_stays: stays(&found, sun_above(limit_deg)(from)),
            }
        });
        let astronomical = TwilightKind::Astronomical.sun_altitude_deg();
        let sun_crossings = crossings(from, until, sun_above(astronomical));
        let moon_crossings = crossings(from, until, moon_above);
        let is_night = |at: Instant| sun_above(astronomical)(at) < 0.0;
        let dark_intervals = intervals(from, until, &[&sun_crossings, &moon_crossings], |at| {
            is_night(at) && moon_above(at) < 0.0
        });
        Self {
            date,
            site,
            from_utc: from,
            until_utc: until,
            moon: moon_events(site, &moon, from, until, &moon_crossings, sun_events.lowest_utc),
            sun: sun_events,
            twilights: twilights.to_vec(),
            astronomical_night: intervals(from, until, &[&sun_crossings], is_night),
            dark_hours: Interval::hours_of(&dark_intervals),
            dark_intervals,
        }
    }
}

/// Degrees from the horizon to the Moon's upper limb as it appears.
fn moon_above_horizon_deg(moon: &Path, at: Instant) -> f64 {
    let place = moon.at(at);
    let radius_deg = (MOON_RADIUS_M / (place.distance_au() * AU_M)).asin().to_degrees();
    place.true_altitude_deg() + HORIZON_REFRACTION_DEG + radius_deg
}

fn sun_events(sun: &Path, from: Instant, found: &[Crossing]) -> SunEvents {
    let altitude_deg = |at: Instant| sun.at(at).true_altitude_deg();
    let middle = from.plus_s(0.5 * DAY_S);
    // The equation of time is 16 minutes at most; below a pole the altitude hardly changes.
    let lowest_utc = lowest(middle.plus_s(-7_200.0), middle.plus_s(7_200.0), altitude_deg);
    let half_hour_s = 1_800.0;
    SunEvents {
        transit_utc: transits(sun, from.plus_s(-half_hour_s), from.plus_s(half_hour_s)).first().copied(),
        set_utc: first(found, false),
        rise_utc: first(found, true),
        stays: stays(found, altitude_deg(middle) - SUN_RISES_DEG),
        lowest_utc,
        lowest_altitude_deg: altitude_deg(lowest_utc),
    }
}

fn moon_events(
    site: Site,
    moon: &Path,
    from: Instant,
    until: Instant,
    found: &[Crossing],
    lowest_sun: Instant,
) -> MoonEvents {
    let seen = Moon::of(&Positions::new(site, lowest_sun));
    let all = |is_rising: bool| {
        found.iter().filter(|crossing| crossing.is_rising == is_rising).map(|crossing| crossing.at).collect()
    };
    let transit = |utc: Instant| Transit { utc, altitude_deg: moon.at(utc).true_altitude_deg() };
    MoonEvents {
        rises_utc: all(true),
        sets_utc: all(false),
        transits: transits(moon, from, until).into_iter().map(transit).collect(),
        stays: stays(found, moon_above_horizon_deg(moon, from)),
        illuminated_fraction: seen.illuminated_fraction,
        phase_angle_deg: seen.phase_angle_rad.to_degrees(),
        phase: MoonPhase::of(lowest_sun),
        is_waxing: seen.is_waxing,
        magnitude_v: seen.magnitude_v,
    }
}

/// Upper transits: there a body passes from east to west, at lower ones from west to east.
fn transits(path: &Path, from: Instant, until: Instant) -> Vec<Instant> {
    crossings(from, until, |at| path.at(at).enu_au.normalize().x)
        .into_iter()
        .filter(|crossing| !crossing.is_rising)
        .map(|crossing| crossing.at)
        .collect()
}

fn first(found: &[Crossing], is_rising: bool) -> Option<Instant> {
    found.iter().find(|crossing| crossing.is_rising == is_rising).map(|crossing| crossing.at)
}

fn stays(found: &[Crossing], value: f64) -> Option<Stays> {
    found.is_empty().then_some(if value > 0.0 { Stays::Above } else { Stays::Below })
}

/// Where something holds that changes at crossings alone.
fn intervals(
    from: Instant,
    until: Instant,
    found: &[&[Crossing]],
    holds: impl Fn(Instant) -> bool,
) -> Vec<Interval> {
    let mut ends = vec![from, until];
    ends.extend(found.iter().flat_map(|crossings| crossings.iter().map(|crossing| crossing.at)));
    ends.sort_by(|a, b| a.unix_s().total_cmp(&b.unix_s()));
    let mut parts: Vec<Interval> = Vec::new();
    for pair in ends.windows(2) {
        let middle = pair[0].plus_s(0.5 * (pair[1].unix_s() - pair[0].unix_s()));
        if pair[0] == pair[1] || !holds(middle) {
            continue;
        }
        match parts.last_mut() {
            Some(last) if last.until_utc == pair[0] => *last = Interval::new(last.from_utc, pair[1]),
            _ => parts.push(Interval::new(pair[0], pair[1])),
        }
    }
    parts
}

#[cfg(test)]
#[path = "night_tests.rs"]
mod tests;
