//! Dates of radiances (a subset of ISO 8601): a year, a month, a day, an instant in UTC, or an interval of two of these.

/// What is understood, in words.
pub(super) const FORMS: &str =
    "2023, 2023-05, 2023-05-17 and 2023-05-17T01:30:00Z are understood, and two of these with / between them";

/// Whether a text is such a date and in the calendar.
pub(super) fn is_date(text: &str) -> bool {
    match text.split_once('/') {
        Some((first, last)) => is_instant(first) && is_instant(last) && first <= last,
        None => is_instant(text),
    }
}

fn is_instant(text: &str) -> bool {
    let (day, time) = match text.split_once('T') {
        Some((day, time)) => (day, Some(time)),
        None => (text, None),
    };
    let parts: Vec<&str> = day.split('-').collect();
    let is_day = match parts[..] {
        [year] => number(year, 4).is_some(),
        [year, month] => number(year, 4).is_some() && number(month, 2).is_some_and(|m| (1..=12).contains(&m)),
        [year, month, day] => match (number(year, 4), number(month, 2), number(day, 2)) {
            (Some(year), Some(month), Some(day)) => (1..=days_in(year, month)).contains(&day),
            _ => false,
        },
        _ => false,
    };
    is_day && time.is_none_or(|time| parts.len() == 3 && is_time(time))
}

fn days_in(year: u32, month: u32) -> u32 {
    let leap = year.is_multiple_of(4) && (!year.is_multiple_of(100) || year.is_multiple_of(400));
    match month {
        4 | 6 | 9 | 11 => 30,
        2 if leap => 29,
        2 => 28,
        1..=12 => 31,
        _ => 0,
    }
}

/// `hh:mm:ss`, perhaps with a fraction, and Z.
fn is_time(text: &str) -> bool {
    let Some(text) = text.strip_suffix('Z') else { return false };
    let (clock, fraction) = text.split_once('.').map_or((text, None), |(c, f)| (c, Some(f)));
    let parts: Vec<&str> = clock.split(':').collect();
    let [hour, minute, second] = parts[..] else { return false };
    // 60 is a leap second.
    let in_range = |text: &str, max: u32| number(text, 2).is_some_and(|n| n <= max);
    in_range(hour, 23)
        && in_range(minute, 59)
        && in_range(second, 60)
        && fraction.is_none_or(|f| !f.is_empty() && f.bytes().all(|b| b.is_ascii_digit()))
}

/// A number of exactly so many digits.
fn number(text: &str, digits: usize) -> Option<u32> {
    (text.len() == digits && text.bytes().all(|b| b.is_ascii_digit())).then(|| text.parse().ok())?
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Years, months, days, instants and spans are dates, and nothing else is.
    #[test]
    fn only_dates_are_accepted() {
        for date in [
            "2023",
            "2023-05",
            "2024-02-29",
            "2023-05-17T01:30:00Z",
            "2023-05-17T01:30:00.25Z",
            "2023-01/2023-12",
            "2022-12-31/2023-01-31",
        ] {
            assert!(is_date(date), "{date}");
        }
        for text in [
            "",
            "yesterday",
            "23",
            "20233",
            "2023-13",
            "2023-00",
            "2023-02-29",
            "2023-5-1",
            "2023-05-17 01:30",
            "2023-05-17T25:00:00Z",
            "2023-05-17T01:30:00",
            "2023T01:30:00Z",
            "2023/",
            "/2023",
            "2024/2023",
            "2023-05-17T01:30:00.Z",
            "+023",
            "２０２３",
            "2023/2024/2025",
        ] {
            assert!(!is_date(text), "{text}");
        }
    }
}
