//! Times of the sky: UTC to TT and UT1 by the leap seconds of IAU SOFA (`dat`), RFC 3339 in and out.

use crate::error::CelestialError;
use serde::{Serialize, Serializer};
use time::{Date, Duration, Month, OffsetDateTime, UtcOffset, format_description::well_known::Rfc3339};

/// The years, and in words what they allow: nights run into the next day, and start in the one before.
macro_rules! years {
    ($first:literal to $last:literal) => {
        /// First and last year that positions hold for: a hundred Julian years around J2000 (`epv00`).
        pub const YEARS: std::ops::RangeInclusive<i32> = $first..=$last;
        /// What [`Instant::parse`] takes.
        pub const TIMES: &str = concat!(
            "a time from ",
            $first,
            "-01-01 to ",
            $last,
            "-12-31 as RFC 3339 has it, with its offset from UTC or Z, such as \
             2026-08-20T23:16:00Z or 2026-08-21T01:16:00+02:00"
        );
        /// The same where an interval could be meant.
        pub const INSTANTS: &str = concat!(
            "an instant from ",
            $first,
            "-01-01 to ",
            $last,
            "-12-31 as RFC 3339 has it, such as 2026-08-20T23:16:00Z; no interval"
        );
        /// What [`CalendarDate::parse`] takes.
        pub const DATES: &str =
            concat!("a date from ", $first, "-01-03 to ", $last, "-12-28, such as 2026-08-20");
        /// What [`CalendarDate::month`] takes.
        pub const MONTHS: &str = concat!("a month from ", $first, "-02 to ", $last, "-11, such as 2026-08");
    };
}
years!(1900 to 2099);

/// Seconds of a day.
pub const DAY_S: f64 = 86_400.0;
/// Julian date of the beginning of 1970, days.
const UNIX_EPOCH_JD: f64 = 2_440_587.5;
/// TT − TAI, seconds.
const TT_MINUS_TAI_S: f64 = 32.184;

/// An instant of UTC, to some microseconds, in the years 1900 to 2099.
#[derive(Clone, Copy, Debug, PartialEq, PartialOrd)]
pub struct Instant {
    /// Seconds since the beginning of 1970, without leap seconds.
    unix_s: f64,
}

/// Bytes of a time as far as its minutes: `2026-08-20T23:16`.
const MINUTE_BYTES: usize = 16;

impl Instant {
    /// From RFC 3339, with any offset: `2026-08-20T23:16:00Z`; without seconds it is the minute's beginning.
    ///
    /// # Errors
    /// [`CelestialError::NoTime`], [`CelestialError::OutsideYears`].
    pub fn parse(text: &str) -> Result<Self, CelestialError> {
        // A plus in a query is a space unless it is escaped.
        let mut spaced = text.trim().replace(' ', "+");
        if matches!(spaced.as_bytes().get(MINUTE_BYTES), Some(b'Z' | b'z' | b'+' | b'-')) {
            spaced.insert_str(MINUTE_BYTES, ":00");
        }
        let time = OffsetDateTime::parse(&spaced, &Rfc3339)
            .map_err(|_| CelestialError::NoTime(text.to_owned()))?
            .to_offset(UtcOffset::UTC);
        Self::from_unix_s(time.unix_timestamp() as f64 + f64::from(time.nanosecond()) * 1e-9)
    }

    /// From seconds since the beginning of 1970.
    ///
    /// # Errors
    /// [`CelestialError::OutsideYears`].
    pub fn from_unix_s(unix_s: f64) -> Result<Self, CelestialError> {
        let far = unix_s.clamp(-1e11, 1e11) as i64;
        let year = OffsetDateTime::from_unix_timestamp(far).map_or(i32::MAX, OffsetDateTime::year);
        match unix_s.is_finite() && YEARS.contains(&year) {
            true => Ok(Self { unix_s }),
            false => Err(CelestialError::OutsideYears(year)),
        }
    }

    /// Seconds since the beginning of 1970, without leap seconds.
    pub fn unix_s(self) -> f64 {
        self.unix_s
    }

    /// Later by so many seconds; times after the last year are taken as they are.
    pub fn plus_s(self, seconds: f64) -> Self {
        Self { unix_s: self.unix_s + seconds }
    }

    /// Hours until another instant.
    pub fn hours_until(self, later: Self) -> f64 {
        (later.unix_s - self.unix_s) / 3_600.0
    }

    /// Julian date in UTC, days, in two parts that lose no digits.
    pub fn julian_utc(self) -> (f64, f64) {
        let days = self.unix_s / DAY_S;
        (UNIX_EPOCH_JD + days.floor(), days - days.floor())
    }

    /// Julian date in UT1, days. UT1 − UTC is taken as 0: it is kept below 0.9 s, 0.004° of the Earth's turn.
    pub fn julian_ut1(self) -> (f64, f64) {
        self.julian_utc()
    }

    /// Julian date in TT, days. Before 1960 there is no UTC, and TT − UT1 is taken as 32.184 s, within 35 s of what it was; after
    /// the last known leap second there are no others.
    pub fn julian_tt(self) -> (f64, f64) {
        let (day, fraction) = self.julian_utc();
        (day, fraction + (self.tai_minus_utc_s() + TT_MINUS_TAI_S) / DAY_S)
    }

    /// TAI − UTC, seconds.
    pub fn tai_minus_utc_s(self) -> f64 {
        let (day, fraction) = self.julian_utc();
        // Neither fails within our years.
        sofars::cal::jd2cal(day, fraction)
            .and_then(|(year, month, day, fraction)| sofars::ts::dat(year, month, day, fraction))
            .unwrap_or(0.0)
    }

    /// Days of TT since 2000-01-01T12:00.
    pub fn days_since_j2000(self) -> f64 {
        let (day, fraction) = self.julian_tt();
        (day - sofars::consts::DJ00) + fraction
    }

    /// As RFC 3339 in UTC, to the second.
    pub fn to_rfc3339(self) -> String {
        let second = (self.unix_s + 0.5).floor() as i64;
        OffsetDateTime::from_unix_timestamp(second)
            .ok()
            .and_then(|time| time.format(&Rfc3339).ok())
            .unwrap_or_default()
    }
}

impl Serialize for Instant {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_str(&self.to_rfc3339())
    }
}

/// A date of the calendar, 1900 to 2099.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct CalendarDate(Date);

impl CalendarDate {
    /// From `2026-08-20`.
    ///
    /// # Errors
    /// [`CelestialError::NoDate`], [`CelestialError::OutsideYears`].
    pub fn parse(text: &str) -> Result<Self, CelestialError> {
        let refuse = || CelestialError::NoDate(text.to_owned());
        let parts: Vec<&str> = text.trim().split('-').collect();
        let [year, month, day] = parts[..] else { return Err(refuse()) };
        let (year, month) = year_and_month(year, month).ok_or_else(refuse)?;
        let day = day.parse().ok().filter(|_| day.len() == 2).ok_or_else(refuse)?;
        let date = Date::from_calendar_date(year, month, day).map_err(|_| refuse())?;
        Self::within_years(date)
    }

    /// The days of a month, `2026-08`, in their order.
    ///
    /// # Errors
    /// [`CelestialError::NoMonth`], [`CelestialError::OutsideYears`].
    pub fn month(text: &str) -> Result<Vec<Self>, CelestialError> {
        let (year, month) = text
            .trim()
            .split_once('-')
            .and_then(|(year, month)| year_and_month(year, month))
            .ok_or_else(|| CelestialError::NoMonth(text.to_owned()))?;
        (1..=month.length(year))
            .filter_map(|day| Date::from_calendar_date(year, month, day).ok())
            .map(Self::within_years)
            .collect()
    }

    /// Nights run into the next day, so the last date ends before the last year does.
    fn within_years(date: Date) -> Result<Self, CelestialError> {
        let (first, last) = (*YEARS.start(), *YEARS.end());
        let is_inside = [Duration::days(-2), Duration::days(3)]
            .into_iter()
            .all(|near| date.checked_add(near).is_some_and(|date| (first..=last).contains(&date.year())));
        if is_inside { Ok(Self(date)) } else { Err(CelestialError::OutsideYears(date.year())) }
    }

    /// The date that an instant has at a longitude, degrees, in local mean solar time.
    ///
    /// # Errors
    /// [`CelestialError::OutsideYears`].
    pub fn of(instant: Instant, longitude_deg: f64) -> Result<Self, CelestialError> {
        let local_s = instant.unix_s() + longitude_deg / 360.0 * DAY_S;
        let time = OffsetDateTime::from_unix_timestamp(local_s.floor() as i64)
            .map_err(|_| CelestialError::OutsideYears(i32::MAX))?;
        Self::within_years(time.date())
    }

    /// Its first instant in UTC.
    pub fn midnight_utc(self) -> Instant {
        Instant { unix_s: self.0.midnight().assume_utc().unix_timestamp() as f64 }
    }
}

impl std::fmt::Display for CalendarDate {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{:04}-{:02}-{:02}", self.0.year(), u8::from(self.0.month()), self.0.day())
    }
}

impl Serialize for CalendarDate {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_str(self)
    }
}

/// A year of four digits and a month of two.
fn year_and_month(year: &str, month: &str) -> Option<(i32, Month)> {
    let has_digits =
        |text: &str, count| text.len() == count && text.bytes().all(|byte| byte.is_ascii_digit());
    let numbers = (has_digits(year, 4) && has_digits(month, 2)).then_some((year, month))?;
    Some((numbers.0.parse().ok()?, Month::try_from(numbers.1.parse::<u8>().ok()?).ok()?))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Julian dates in TT as astropy 8.0.2 has them.
    #[test]
    fn julian_dates_are_those_of_astropy() {
        for (text, utc, tt) in [
            ("1987-04-10T19:21:00Z", 2_446_896.306_25, 2_446_896.306_888_70),
            ("2010-06-22T00:00:00+02:00", 2_455_369.416_666_67, 2_455_369.417_432_69),
            ("2026-08-20T23:16:00Z", 2_461_273.469_444_44, 2_461_273.470_245_19),
        ] {
            let instant = Instant::parse(text).unwrap();
            let sum = |(day, fraction): (f64, f64)| day + fraction;
            assert!((sum(instant.julian_utc()) - utc).abs() < 2e-8, "{text}");
            assert!((sum(instant.julian_tt()) - tt).abs() < 2e-8, "{text}");
        }
        assert_eq!(Instant::parse("1999-01-01T00:00:00Z").unwrap().tai_minus_utc_s(), 32.0);
        assert_eq!(Instant::parse("1998-12-31T23:59:59Z").unwrap().tai_minus_utc_s(), 31.0);
    }

    #[test]
    fn times_are_read_and_written() {
        for (text, back) in [
            ("2026-08-20T23:16:00Z", "2026-08-20T23:16:00Z"),
            ("2026-08-21T01:16:00+02:00", "2026-08-20T23:16:00Z"),
            ("2026-08-21T01:16:00 02:00", "2026-08-20T23:16:00Z"),
            ("1969-12-31T23:59:59.6Z", "1970-01-01T00:00:00Z"),
            ("2016-12-31T23:59:60Z", "2017-01-01T00:00:00Z"),
            ("2026-08-20T23:16Z", "2026-08-20T23:16:00Z"),
            ("2026-08-21T01:16+02:00", "2026-08-20T23:16:00Z"),
        ] {
            assert_eq!(Instant::parse(text).unwrap().to_rfc3339(), back, "{text}");
        }
        for text in [
            "2026-08-20T23:16",
            "2026-08-20T2316Z",
            "",
            "2026-08-20",
            "2026-08-20T23:16:00",
            "2026-02-30T00:00:00Z",
            "now",
        ] {
            assert!(matches!(Instant::parse(text), Err(CelestialError::NoTime(_))), "{text}");
        }
        for text in ["1899-12-31T23:59:59Z", "2100-01-01T00:00:00Z", "9999-01-01T00:00:00Z"] {
            assert!(matches!(Instant::parse(text), Err(CelestialError::OutsideYears(_))), "{text}");
        }
        for unix_s in [f64::NAN, f64::INFINITY, -1e300] {
            assert!(Instant::from_unix_s(unix_s).is_err());
        }
    }

    /// The ends that are named are taken, and what lies beyond them is not.
    #[test]
    fn named_ends_are_taken() {
        let ends = |words: &str| -> [String; 2] {
            let words: Vec<&str> = words.split([' ', ',']).collect();
            ["from", "to"]
                .map(|word| words[words.iter().position(|other| *other == word).unwrap() + 1].to_owned())
        };
        let is_time = |day: &str, time: &str| Instant::parse(&format!("{day}T{time}Z")).is_ok();
        for words in [TIMES, INSTANTS] {
            let [first, last] = ends(words);
            assert!(is_time(&first, "00:00:00") && is_time(&last, "23:59:59"), "{words}");
        }
        assert!(!is_time("1899-12-31", "23:59:59") && !is_time("2100-01-01", "00:00:00"));
        assert!(ends(DATES).iter().all(|date| CalendarDate::parse(date).is_ok()), "{DATES}");
        assert!(["1900-01-02", "2099-12-29"].iter().all(|date| CalendarDate::parse(date).is_err()));
        assert!(ends(MONTHS).iter().all(|month| CalendarDate::month(month).is_ok()), "{MONTHS}");
        assert!(["1900-01", "2099-12"].iter().all(|month| CalendarDate::month(month).is_err()));
    }

    #[test]
    fn dates_and_months_are_read() {
        assert_eq!(CalendarDate::parse("2024-02-29").unwrap().to_string(), "2024-02-29");
        assert_eq!(CalendarDate::month("2024-02").unwrap().len(), 29);
        for text in ["2023-02-29", "2023-2-03", "2023-02-3", "20230203", "2023-13-01", "+023-01-01", ""] {
            assert!(matches!(CalendarDate::parse(text), Err(CelestialError::NoDate(_))), "{text}");
        }
        assert!(matches!(CalendarDate::month("2023-00"), Err(CelestialError::NoMonth(_))));
        assert!(matches!(CalendarDate::parse("1899-06-01"), Err(CelestialError::OutsideYears(1899))));
        assert!(CalendarDate::parse("2099-12-31").is_err() && CalendarDate::parse("1900-01-03").is_ok());
        let evening = Instant::parse("2026-08-20T23:16:00Z").unwrap();
        assert_eq!(CalendarDate::of(evening, 179.0).unwrap().to_string(), "2026-08-21");
        assert_eq!(CalendarDate::of(evening, -179.0).unwrap().to_string(), "2026-08-20");
    }
}
