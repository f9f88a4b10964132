//! Nights beside those that astropy 8.0.2 gives, found on its altitudes a minute apart (made as in `ephemeris_tests.rs`).

use super::*;
use proptest::prelude::*;

struct Check {
    date: &'static str,
    /// Latitude and longitude, degrees.
    site: (f64, f64),
    /// For −0.833, −6, −12 and −18°; empty where there is none.
    sun_sets_and_rises: [[&'static str; 2]; 4],
    moon_set_and_rise: [&'static str; 2],
    moon_transit: &'static str,
}

const CHECKS: [Check; 7] = [
    Check {
        date: "2026-08-20",
        site: (41.38, 2.17),
        sun_sets_and_rises: [
            ["2026-08-20T18:43:23Z", "2026-08-21T05:06:22Z"],
            ["2026-08-20T19:12:36Z", "2026-08-21T04:37:07Z"],
            ["2026-08-20T19:47:57Z", "2026-08-21T04:01:46Z"],
            ["2026-08-20T20:25:38Z", "2026-08-21T03:24:04Z"],
        ],
        moon_set_and_rise: ["2026-08-20T22:25:17Z", "2026-08-20T13:34:35Z"],
        moon_transit: "2026-08-20T18:01:55Z",
    },
    Check {
        date: "2026-06-21",
        site: (55.0, -3.0),
        sun_sets_and_rises: [
            ["2026-06-21T20:55:03Z", "2026-06-22T03:32:48Z"],
            ["2026-06-21T21:53:18Z", "2026-06-22T02:34:33Z"],
            ["", ""],
            ["", ""],
        ],
        moon_set_and_rise: ["2026-06-21T23:55:23Z", ""],
        moon_transit: "2026-06-21T18:02:56Z",
    },
    Check {
        date: "2026-05-16",
        site: (69.65, 18.96),
        sun_sets_and_rises: [["2026-05-16T22:02:44Z", "2026-05-16T23:17:26Z"], ["", ""], ["", ""], ["", ""]],
        moon_set_and_rise: ["", ""],
        moon_transit: "",
    },
    Check {
        date: "2026-12-21",
        site: (69.65, 18.96),
        sun_sets_and_rises: [
            ["", ""],
            ["2026-12-21T12:53:07Z", "2026-12-22T08:31:45Z"],
            ["2026-12-21T14:37:40Z", "2026-12-22T06:47:12Z"],
            ["2026-12-21T15:56:03Z", "2026-12-22T05:28:49Z"],
        ],
        moon_set_and_rise: ["", ""],
        moon_transit: "2026-12-21T20:23:33Z",
    },
    Check {
        date: "2026-03-20",
        site: (-77.85, 166.67),
        sun_sets_and_rises: [
            ["2026-03-20T07:18:53Z", "2026-03-20T18:46:06Z"],
            ["2026-03-20T09:01:52Z", "2026-03-20T17:02:26Z"],
            ["2026-03-20T12:29:26Z", "2026-03-20T13:34:23Z"],
            ["", ""],
        ],
        moon_set_and_rise: ["2026-03-20T04:49:29Z", ""],
        moon_transit: "2026-03-20T01:45:14Z",
    },
    Check {
        date: "2026-01-15",
        site: (-33.9, 151.2),
        sun_sets_and_rises: [
            ["2026-01-15T09:09:05Z", "2026-01-15T19:00:24Z"],
            ["2026-01-15T09:37:22Z", "2026-01-15T18:32:06Z"],
            ["2026-01-15T10:11:54Z", "2026-01-15T17:57:35Z"],
            ["2026-01-15T10:49:08Z", "2026-01-15T17:20:20Z"],
        ],
        moon_set_and_rise: ["2026-01-15T06:32:16Z", "2026-01-15T16:06:26Z"],
        moon_transit: "2026-01-15T23:46:05Z",
    },
    Check {
        date: "2026-12-05",
        site: (40.0, -105.0),
        sun_sets_and_rises: [
            ["2026-12-05T23:34:35Z", "2026-12-06T14:07:33Z"],
            ["2026-12-06T00:04:48Z", "2026-12-06T13:37:17Z"],
            ["2026-12-06T00:38:34Z", "2026-12-06T13:03:28Z"],
            ["2026-12-06T01:11:20Z", "2026-12-06T12:30:40Z"],
        ],
        moon_set_and_rise: ["2026-12-05T21:11:57Z", "2026-12-06T12:05:31Z"],
        moon_transit: "2026-12-06T16:57:14Z",
    },
];

fn night(date: &str, latitude_deg: f64, longitude_deg: f64) -> Night {
    let site = Site::new(latitude_deg, longitude_deg, 0.0).unwrap();
    Night::of(site, CalendarDate::parse(date).unwrap())
}

/// Within 5 s, and within 30 s where the body grazes the horizon.
fn assert_near(found: Option<Instant>, expected: &str, what: &str) {
    let expected = (!expected.is_empty()).then(|| Instant::parse(expected).unwrap());
    assert_eq!(found.is_some(), expected.is_some(), "{what}: {found:?}");
    if let (Some(found), Some(expected)) = (found, expected) {
        let off_s = found.unix_s() - expected.unix_s();
        let limit_s = if what.contains("69.65") || what.contains("77.85") { 30.0 } else { 5.0 };
        assert!(off_s.abs() < limit_s, "{what}: {off_s:.1} s");
    }
}

#[test]
fn nights_are_those_of_astropy() {
    for check in &CHECKS {
        let (latitude_deg, longitude_deg) = check.site;
        let night = night(check.date, latitude_deg, longitude_deg);
        let what = format!("{} at {latitude_deg}", check.date);
        let [horizon, twilights @ ..] = check.sun_sets_and_rises;
        assert_near(night.sun.set_utc, horizon[0], &what);
        assert_near(night.sun.rise_utc, horizon[1], &what);
        assert_eq!(night.sun.stays.is_some(), horizon[0].is_empty());
        for (twilight, [end, begin]) in night.twilights.iter().zip(twilights) {
            assert_near(twilight.evening_end_utc, end, &what);
            assert_near(twilight.morning_begin_utc, begin, &what);
            assert_eq!(twilight.sun_stays, end.is_empty().then_some(Stays::Above));
        }
        let [set, rise] = check.moon_set_and_rise;
        assert_near(night.moon.sets_utc.first().copied(), set, &what);
        assert_near(night.moon.rises_utc.first().copied(), rise, &what);
        assert_near(night.moon.transits.first().map(|transit| transit.utc), check.moon_transit, &what);
    }
}

/// Where the Sun or the Moon stays is said.
#[test]
fn high_latitudes_are_said() {
    let polar_night = night("2026-12-21", 69.65, 18.96);
    assert_eq!((polar_night.sun.stays, polar_night.moon.stays), (Some(Stays::Below), Some(Stays::Above)));
    assert!(polar_night.dark_intervals.is_empty() && polar_night.astronomical_night[0].hours > 13.0);
    let midnight_sun = night("2026-06-21", 69.65, 18.96);
    assert_eq!(midnight_sun.sun.stays, Some(Stays::Above));
    assert!(midnight_sun.twilights.iter().all(|twilight| twilight.sun_stays == Some(Stays::Above)));
    assert!(midnight_sun.astronomical_night.is_empty() && midnight_sun.dark_hours == 0.0);
    let pole = night("2026-06-21", -90.0, 0.0);
    assert_eq!(pole.sun.stays, Some(Stays::Below));
    assert!(pole.twilights.iter().all(|twilight| twilight.sun_stays == Some(Stays::Below)));
    assert!((pole.astronomical_night[0].hours - 24.0).abs() < 1e-6);
}

/// Barcelona, 2026-08-20: the Moon sets at 22:25, and it is dark from then to 3:24.
#[test]
fn dark_hours_are_between_moon_and_dawn() {
    let night = night("2026-08-20", 41.38, 2.17);
    assert_eq!(night.dark_intervals.len(), 1);
    assert_near(Some(night.dark_intervals[0].from_utc), "2026-08-20T22:25:17Z", "moonset");
    assert_near(Some(night.dark_intervals[0].until_utc), "2026-08-21T03:24:04Z", "dawn");
    assert!((night.dark_hours - 4.98).abs() < 0.01, "{}", night.dark_hours);
    assert_eq!(night.moon.phase, MoonPhase::FirstQuarter);
    assert_near(Some(night.sun.lowest_utc), "2026-08-20T23:55:16Z", "lowest at 69.65: flat");
    let noon = night.sun.transit_utc.unwrap();
    assert!((noon.hours_until(night.sun.lowest_utc) - 12.0).abs() < 0.01);
    let json = serde_json::to_value(&night).unwrap();
    assert_eq!(json["date"], "2026-08-20");
    assert_eq!(json["sun"]["set_utc"], "2026-08-20T18:43:23Z");
    assert_eq!(json["twilights"][2]["kind"], "astronomical");
    assert_eq!(json["moon"]["stays"], serde_json::Value::Null);
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(40))]

    /// Everything lies in the night, in its order, and dark parts are parts of the astronomical night.
    #[test]
    fn nights_are_in_order(
        day in 0..70_000i32, latitude in -90.0..90.0_f64, longitude in -180.0..180.0_f64,
    ) {
        let site = Site::new(latitude, longitude, 0.0).unwrap();
        let instant = Instant::from_unix_s(-2.1e9 + f64::from(day) * DAY_S).unwrap();
        let night = Night::of(site, CalendarDate::of(instant, longitude).unwrap());
        let inside = |at: &Instant| *at >= night.from_utc && *at <= night.until_utc;
        for twilight in &night.twilights {
            prop_assert_eq!(twilight.sun_stays.is_none(),
                twilight.evening_end_utc.is_some() || twilight.morning_begin_utc.is_some());
        }
        let ends: Vec<Instant> =
            night.twilights.iter().filter_map(|twilight| twilight.evening_end_utc).collect();
        prop_assert!(ends.iter().all(inside));
        let dark: f64 = night.dark_intervals.iter().map(|part| part.hours).sum();
        prop_assert!((dark - night.dark_hours).abs() < 1e-9);
        for part in &night.dark_intervals {
            prop_assert!(inside(&part.from_utc) && inside(&part.until_utc) && part.hours > 0.0);
            let holds =
                |whole: &Interval| whole.from_utc <= part.from_utc && part.until_utc <= whole.until_utc;
            prop_assert!(night.astronomical_night.iter().any(holds));
        }
        let low = night.sun.lowest_altitude_deg;
        prop_assert!(low > -18.0 - 1e-3 || !night.astronomical_night.is_empty());
        let rises = night.moon.rises_utc.len() as i64 - night.moon.sets_utc.len() as i64;
        prop_assert!(rises.abs() <= 1);
        prop_assert_eq!(night.moon.stays.is_some(), night.moon.rises_utc.is_empty() && night.moon.sets_utc.is_empty());
    }
}
