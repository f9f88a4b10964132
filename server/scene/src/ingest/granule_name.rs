//! What the names of products say: when the radiances were taken, and whose they are.

/// What a file's name says.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Product {
    /// Its name for people.
    pub(super) name: &'static str,
    /// When, in the forms of the option `--date`.
    pub(super) date: Option<String>,
}

/// The product of a file, by the patterns of NASA (`VNP46A4.A2023001.h21v08.…`) and of the Earth Observation Group
/// (`VNL_v2_npp_2020_global_…`, `SVDNB_npp_20230101-20230131_75N060W_…`).
pub(super) fn product(file_name: &str) -> Option<Product> {
    let nasa = ["VNP46", "VJ146", "VJ246"];
    if let Some(at) = nasa.iter().find_map(|start| file_name.find(start)) {
        let name = &file_name[at..];
        let level = name.get(5..7)?;
        let date = name.split(['.', '_']).find_map(|part| {
            let digits = part.strip_prefix('A')?;
            (digits.len() == 7).then(|| day_of_year(digits, level)).flatten()
        });
        // Translated by hand, names keep the product and a year.
        let date = date.or_else(|| name.split(['.', '_']).find(|part| is_year(part)).map(str::to_owned));
        return Some(Product { name: "NASA Black Marble", date });
    }
    if file_name.starts_with("VNL_")
        || file_name.contains("vcmslcfg")
        || file_name.contains("vcmcfg")
        || file_name.starts_with("SVDNB_")
    {
        let date = file_name.split('_').find_map(|part| match part.split_once('-') {
            Some((first, last)) => month_of(first, last),
            None => (is_year(part) || (part.len() == 6 && is_year(&part[..4]))).then(|| {
                if part.len() == 4 { part.to_owned() } else { format!("{}-{}", &part[..4], &part[4..]) }
            }),
        });
        return Some(Product { name: "Earth Observation Group VIIRS", date });
    }
    None
}

/// One span for all files, where each says when: from the first of their days to the last.
pub(super) fn span(dates: &[Option<String>]) -> Option<String> {
    let all: Vec<&String> = dates.iter().map(Option::as_ref).collect::<Option<_>>()?;
    let first = all.iter().map(|date| date.split('/').next().unwrap_or(date)).min()?;
    let last =
        all.iter().map(|date| date.rsplit('/').next().unwrap_or(date)).max_by_key(|date| last_day(date))?;
    Some(if first == last { first.to_owned() } else { format!("{first}/{last}") })
}

/// The last day of a date or span, to compare with others: every month counts as one of 31 days.
pub(super) fn last_day(date: &str) -> String {
    let end = date.rsplit('/').next().unwrap_or(date);
    match end.len() {
        4 => format!("{end}-12-31"),
        7 => format!("{end}-31"),
        _ => end.to_owned(),
    }
}

fn is_year(text: &str) -> bool {
    text.len() == 4 && text.parse().is_ok_and(|year: u32| (2011..2100).contains(&year))
}

/// `2023001` of a daily product is a day, of a monthly one a month, of a yearly one a year.
fn day_of_year(digits: &str, level: &str) -> Option<String> {
    let (year, day): (u32, u32) = (digits[..4].parse().ok()?, digits[4..].parse().ok()?);
    if !is_year(&digits[..4]) || !(1..=366).contains(&day) {
        return None;
    }
    let leap = year.is_multiple_of(4) && (!year.is_multiple_of(100) || year.is_multiple_of(400));
    let lengths = [31, if leap { 29 } else { 28 }, 31, 30, 31, 30, 31, 31, 30, 31, 30, 31];
    let (mut month, mut left) = (0usize, day);
    while left > *lengths.get(month)? {
        left -= lengths[month];
        month += 1;
    }
    Some(match level {
        "A4" => format!("{year}"),
        "A3" => format!("{year}-{:02}", month + 1),
        _ => format!("{year}-{:02}-{left:02}", month + 1),
    })
}

/// `20230101`, `20230131` is a month or a span.
fn month_of(first: &str, last: &str) -> Option<String> {
    let is_month =
        |text: &str| text.len() == 6 && text.bytes().all(|b| b.is_ascii_digit()) && is_year(&text[..4]);
    if is_month(first) && is_month(last) {
        let month = |text: &str| format!("{}-{}", &text[..4], &text[4..]);
        return Some(format!("{}/{}", month(first), month(last)));
    }
    let plain =
        |text: &str| text.len() == 8 && text.bytes().all(|b| b.is_ascii_digit()) && is_year(&text[..4]);
    if !plain(first) || !plain(last) {
        return None;
    }
    let day = |text: &str| format!("{}-{}-{}", &text[..4], &text[4..6], &text[6..]);
    let is_month =
        first[..6] == last[..6] && first.ends_with("01") && last[6..].parse().is_ok_and(|d: u32| d >= 28);
    Some(if is_month {
        format!("{}-{}", &first[..4], &first[4..6])
    } else {
        format!("{}/{}", day(first), day(last))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Names of products give their dates; others give none.
    #[test]
    fn names_of_products_give_dates() {
        for (name, date) in [
            ("VNP46A4.A2023001.h21v08.002.2024012345678.h5", Some("2023")),
            ("VNP46A3.A2023032.h21v09.002.2025190000000.h5", Some("2023-02")),
            ("VNP46A2.A2024060.h21v09.002.2025190000000.h5", Some("2024-02-29")),
            ("VJ146A2.A2023182.h21v09.002.h5", Some("2023-07-01")),
            ("VNP46A4_kenya_2023.tif", Some("2023")),
            ("VNL_v2_npp_2020_global_vcmslcfg_c202101211500.average_masked.tif", Some("2020")),
            ("SVDNB_npp_20230101-20230131_75N060W_vcmslcfg_v10.avg_rade9h.tif", Some("2023-01")),
            ("VNL_v21_npp_201204-201303_global_vcmcfg.tif", Some("2012-04/2013-03")),
        ] {
            assert_eq!(product(name).unwrap().date.as_deref(), date, "{name}");
        }
        assert_eq!(product("lights_2023.tif"), None);
    }

    #[test]
    fn granules_of_one_year_have_its_date() {
        let some = |text: &str| Some(text.to_owned());
        assert_eq!(span(&[some("2023"), some("2023")]), some("2023"));
        assert_eq!(span(&[some("2023-02"), some("2023-01")]), some("2023-01/2023-02"));
        assert_eq!(span(&[some("2023"), None]), None);
        assert_eq!(span(&[]), None);
    }
}
