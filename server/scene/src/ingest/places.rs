//! Named places, from GeoJSON or CSV as people have them: names of fields in any order and case, separators of any locale,
//! populations as text. What cannot be read is counted and said; it does not cost the rest.

use crate::error::SceneError;
use crate::metadata::{NamedPlace, is_within};
use serde_json::Value;
use std::path::Path;

/// Names of fields, in lower case, the first that a file has counts. OpenStreetMap has the kind of a place in `place`, beside `name`.
const NAME: [&str; 12] = [
    "name",
    "name_en",
    "name:en",
    "nameascii",
    "name_ascii",
    "asciiname",
    "city",
    "town",
    "city_name",
    "label",
    "title",
    "place",
];
const LATITUDE: [&str; 6] = ["latitude", "lat", "lat_deg", "ylat", "y", "ycoord"];
const LONGITUDE: [&str; 8] = ["longitude", "lon", "lng", "long", "lon_deg", "xlon", "x", "xcoord"];
const POPULATION: [&str; 9] = [
    "population",
    "pop",
    "pop_max",
    "pop_est",
    "pop_total",
    "population_total",
    "inhabitants",
    "einwohner",
    "pop_min",
];

/// Bytes of a file of places at most: all of it is read, and JSON takes many times as much.
const MAX_BYTES: u64 = 32 << 20;
/// Separators of tables, the most usual first.
const SEPARATORS: [u8; 4] = *b",;\t|";
/// Places that are left out are named up to so many.
const MAX_NAMED: usize = 3;

/// The places of a file, and what is to be said of it.
#[derive(Debug, Default)]
pub(super) struct Places {
    pub(super) places: Vec<NamedPlace>,
    pub(super) warnings: Vec<String>,
}

/// What was read so far.
#[derive(Debug, Default, PartialEq)]
struct Reading {
    places: Vec<NamedPlace>,
    /// Why places were left out, one for each.
    skipped: Vec<String>,
    /// Populations that are no number.
    bad_populations: u64,
}

/// Reads a file of places, the most populous first.
///
/// # Errors
/// Files of another kind, and those without a single place.
pub(super) fn read(path: &Path) -> Result<Places, SceneError> {
    let refuse = |reason: String| SceneError::Refused { path: path.to_owned(), reason };
    let length = std::fs::metadata(path).map_err(SceneError::io(path))?.len();
    if length > MAX_BYTES {
        return Err(refuse(format!("it has {length} bytes; places may have {MAX_BYTES}")));
    }
    let bytes = std::fs::read(path).map_err(SceneError::io(path))?;
    let text = text_of(&bytes).map_err(refuse)?;
    let is_json = text.trim_start().starts_with(['{', '[']);
    let reading = if is_json { from_geojson(&text) } else { from_table(&text) }.map_err(refuse)?;
    let Reading { mut places, skipped, bad_populations } = reading;
    if places.is_empty() {
        let why = skipped.first().map_or(String::new(), |why| format!(": {why}"));
        return Err(refuse(format!("it holds no places{why}")));
    }
    places.sort_by(|a, b| b.population.cmp(&a.population).then_with(|| a.name.cmp(&b.name)));
    let mut warnings = Vec::new();
    if !skipped.is_empty() {
        let more = if skipped.len() > MAX_NAMED { ", …" } else { "" };
        let count = skipped.len();
        let named = skipped[..count.min(MAX_NAMED)].join(", ");
        warnings.push(format!("{count} of {} places were left out: {named}{more}", count + places.len()));
    }
    if bad_populations > 0 {
        warnings.push(format!("{bad_populations} populations are no numbers and are not known"));
    }
    Ok(Places { places, warnings })
}

/// What is to be said of places that lie outside the raster's bounds.
///
/// # Errors
/// If all do, and would lie within them with latitude and longitude exchanged.
pub(super) fn check_inside(places: &[NamedPlace], bounds: [f64; 4]) -> Result<Option<String>, String> {
    let is_inside = |place: &&NamedPlace| is_within(bounds, place.latitude_deg, place.longitude_deg);
    let is_exchanged =
        |place: &&NamedPlace| !is_inside(place) && is_within(bounds, place.longitude_deg, place.latitude_deg);
    let inside = places.iter().filter(is_inside).count();
    let exchanged: Vec<&NamedPlace> = places.iter().filter(is_exchanged).collect();
    let names =
        exchanged.iter().take(MAX_NAMED).map(|place| place.name.as_str()).collect::<Vec<_>>().join(", ");
    if !exchanged.is_empty() && inside == 0 {
        return Err(format!(
            "no place of it lies in the raster, but with latitude and longitude exchanged {} of {} do ({names}): name its columns \
             the other way round",
            exchanged.len(),
            places.len()
        ));
    }
    if !exchanged.is_empty() {
        let count = exchanged.len();
        return Ok(Some(format!(
            "{count} of {} places lie outside the raster, and within it with latitude and longitude exchanged: {names}",
            places.len()
        )));
    }
    Ok((inside == 0).then(|| format!("none of the {} places lies in the raster", places.len())))
}

/// The text of a file: UTF-8 or UTF-16 with or without a byte order mark, else Latin-1.
fn text_of(bytes: &[u8]) -> Result<String, String> {
    let wide = |bytes: &[u8], from: fn([u8; 2]) -> u16| {
        let units: Vec<u16> = bytes.chunks_exact(2).map(|pair| from([pair[0], pair[1]])).collect();
        String::from_utf16(&units).map_err(|_| "it is no text".to_owned())
    };
    match bytes {
        [0xff, 0xfe, rest @ ..] => wide(rest, u16::from_le_bytes),
        [0xfe, 0xff, rest @ ..] => wide(rest, u16::from_be_bytes),
        [0xef, 0xbb, 0xbf, rest @ ..] => {
            String::from_utf8(rest.to_vec()).map_err(|_| "it is no text".to_owned())
        }
        _ if bytes.contains(&0) => Err("it is no text, so neither GeoJSON nor a table".to_owned()),
        _ => Ok(String::from_utf8(bytes.to_vec())
            .unwrap_or_else(|_| bytes.iter().map(|&b| char::from(b)).collect())),
    }
}

impl Reading {
    /// Takes a place where it has a name and lies on the world; `what` says where it stands in the file.
    fn take(
        &mut self,
        what: &str,
        name: Option<&str>,
        axes: (Option<f64>, Option<f64>),
        population: Option<Result<u64, ()>>,
    ) {
        let Some(name) = name.map(str::trim).filter(|name| !name.is_empty()) else {
            self.skipped.push(format!("{what} has no name"));
            return;
        };
        let (Some(latitude_deg), Some(longitude)) = axes else {
            self.skipped.push(format!("{what} (\"{name}\") has no place"));
            return;
        };
        if !(-90.0..=90.0).contains(&latitude_deg) || !(-180.0..=360.0).contains(&longitude) {
            self.skipped.push(format!(
                "{what} (\"{name}\") lies at latitude {latitude_deg}, longitude {longitude}, off the world"
            ));
            return;
        }
        let longitude_deg = if longitude >= 180.0 { longitude - 360.0 } else { longitude };
        self.bad_populations += u64::from(population == Some(Err(())));
        let population = population.and_then(Result::ok);
        self.places.push(NamedPlace { name: name.to_owned(), latitude_deg, longitude_deg, population });
    }
}

/// A population as people write it: 4397073, "4 397 073", "4,397,073", 4397073.0; None where there is none.
fn population(text: &str) -> Option<Result<u64, ()>> {
    let text = text.trim();
    if text.is_empty() || text == "-" || text.eq_ignore_ascii_case("null") || text.eq_ignore_ascii_case("nan")
    {
        return None;
    }
    let plain: String =
        text.chars().filter(|c| !c.is_whitespace() && !"'’_\u{a0}\u{202f}".contains(*c)).collect();
    if let Ok(number) = plain.parse::<f64>()
        && !is_grouped(&plain)
    {
        // Tables of the world write -99 where they do not know.
        return (number >= 0.0 && number.is_finite()).then_some(Ok(number as u64));
    }
    if is_grouped(&plain) {
        let digits: String = plain.chars().filter(char::is_ascii_digit).collect();
        return Some(digits.parse().map_err(|_| ()));
    }
    Some(Err(()))
}

/// Whether a number is written with groups of three digits: 4,397,073 or 4.397.073, but not 12.5.
fn is_grouped(text: &str) -> bool {
    [',', '.'].iter().any(|&separator| {
        let parts: Vec<&str> = text.split(separator).collect();
        let is_digits = |part: &&str| !part.is_empty() && part.bytes().all(|b| b.is_ascii_digit());
        let enough = if separator == ',' { 2 } else { 3 };
        parts.len() >= enough
            && parts.iter().all(is_digits)
            && parts[0].len() <= 3
            && parts[1..].iter().all(|part| part.len() == 3)
    })
}

fn from_geojson(text: &str) -> Result<Reading, String> {
    let document: Value = serde_json::from_str(text).map_err(|e| format!("it is no JSON ({e})"))?;
    let features = match &document {
        Value::Object(object) if object.get("type").and_then(Value::as_str) == Some("Feature") => {
            std::slice::from_ref(&document)
        }
        Value::Object(object) => object
            .get("features")
            .and_then(Value::as_array)
            .ok_or("it is no GeoJSON FeatureCollection")?
            .as_slice(),
        _ => return Err("it is no GeoJSON FeatureCollection".to_owned()),
    };
    let mut reading = Reading::default();
    for (index, feature) in features.iter().enumerate() {
        let what = format!("feature {}", index + 1);
        let properties = feature.get("properties").and_then(Value::as_object);
        let field = |keys: &[&str]| {
            let properties = properties?;
            keys.iter().find_map(|key| {
                let value = properties.iter().find(|(own, _)| own.to_lowercase() == *key)?.1;
                (!value.is_null()).then_some(value)
            })
        };
        // The kind of a place is no name: OpenStreetMap has it in `place` where `name` is missing.
        let has_name_field = properties.is_some_and(|p| p.keys().any(|key| key.to_lowercase() == "name"));
        let names = if has_name_field { &NAME[..NAME.len() - 1] } else { &NAME[..] };
        let name = field(names).and_then(Value::as_str);
        let geometry = feature.get("geometry");
        let kind = geometry.and_then(|g| g.get("type")).and_then(Value::as_str);
        let coordinates = geometry.and_then(|g| g.get("coordinates"));
        let point = match kind {
            Some("Point") => coordinates,
            Some("MultiPoint") => coordinates.and_then(|c| c.get(0)),
            _ => None,
        };
        if name.is_some() && point.is_none() {
            reading.skipped.push(format!("{what} (\"{}\") is not a point", name.unwrap_or_default()));
            continue;
        }
        let axis = |i: usize| point?.get(i)?.as_f64();
        let inhabitants = field(&POPULATION).and_then(|value| match value {
            Value::Number(number) => number.as_f64().filter(|n| *n >= 0.0).map(|n| Ok(n as u64)),
            Value::String(text) => population(text),
            _ => Some(Err(())),
        });
        reading.take(&what, name, (axis(1), axis(0)), inhabitants);
    }
    Ok(reading)
}

fn from_table(text: &str) -> Result<Reading, String> {
    let head = text.lines().find(|line| !line.trim().is_empty()).unwrap_or_default();
    // Where a spreadsheet says its separator, that is the one.
    let (text, said) = match head.trim().strip_prefix("sep=") {
        Some(separator) => (text.split_once('\n').map_or("", |(_, rest)| rest), separator.bytes().next()),
        None => (text, None),
    };
    let head = text.lines().find(|line| !line.trim().is_empty()).unwrap_or_default();
    let most = SEPARATORS.iter().copied().max_by_key(|separator| {
        let count = head.bytes().filter(|byte| byte == separator).count();
        // Of separators that occur as often the first in the list.
        (count, std::cmp::Reverse(SEPARATORS.iter().position(|s| s == separator)))
    });
    let separator = said.or(most).unwrap_or(b',');
    let mut reader = csv::ReaderBuilder::new()
        .trim(csv::Trim::All)
        .delimiter(separator)
        .flexible(true)
        .from_reader(text.as_bytes());
    let heads = reader.headers().map_err(|e| format!("it is no CSV ({e})"))?.clone();
    let column =
        |keys: &[&str]| keys.iter().find_map(|key| heads.iter().position(|head| head.to_lowercase() == *key));
    let (Some(name), Some(latitude), Some(longitude)) =
        (column(&NAME), column(&LATITUDE), column(&LONGITUDE))
    else {
        return Err(format!(
            "it is neither GeoJSON nor a table with the columns name, latitude, longitude; its columns are {}",
            heads.iter().take(12).collect::<Vec<_>>().join(", ")
        ));
    };
    let inhabitants = column(&POPULATION);
    let mut reading = Reading::default();
    for (index, record) in reader.records().enumerate() {
        let what = format!("line {}", index + 2);
        let record = match record {
            Ok(record) => record,
            Err(error) => {
                reading.skipped.push(format!("{what} is broken ({error})"));
                continue;
            }
        };
        if record.iter().all(str::is_empty) {
            continue;
        }
        // Where the comma does not separate, it may be the decimal one.
        let number = |at: usize| {
            let text = record.get(at)?;
            text.parse().ok().or_else(|| (separator != b',').then(|| text.replace(',', ".").parse().ok())?)
        };
        let population = inhabitants.and_then(|at| population(record.get(at)?));
        reading.take(&what, record.get(name), (number(latitude), number(longitude)), population);
    }
    Ok(reading)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn csv_and_geojson_give_the_same_places() {
        let csv = "Name,lat,lon,population\nNairobi,-1.2864,36.8172,4397073\n\"Voi, town\",-3.396,38.556,\n";
        let json = r#"{"type": "FeatureCollection", "features": [
            {"type": "Feature", "properties": {"name": "Nairobi", "population": "4,397,073"},
             "geometry": {"type": "Point", "coordinates": [36.8172, -1.2864]}},
            {"type": "Feature", "properties": {"name": "Voi, town"},
             "geometry": {"type": "Point", "coordinates": [38.556, -3.396]}}]}"#;
        let reading = from_table(csv).unwrap();
        assert_eq!(reading, from_geojson(json).unwrap());
        assert_eq!(reading.places[0].population, Some(4_397_073));
        assert_eq!((reading.places[1].population, reading.skipped.len()), (None, 0));
    }

    /// Columns in any order, case and separator give the same place.
    #[test]
    fn tables_are_read_as_people_have_them() {
        for table in [
            "place,name,latitude,longitude,population\ncity,Nairobi,-1.2864,36.8172,4397073\n",
            "name;latitude;longitude;population\r\nNairobi;-1.2864;36.8172;4397073\r\n",
            "name;lat;lon;POP_MAX\nNairobi;-1,2864;36,8172;4.397.073\n",
            "city\tlat\tlng\tpop\nNairobi\t-1.2864\t36.8172\t4 397 073\n",
            "sep=;\nCity;Lat;Long;Einwohner\nNairobi;-1.2864;36.8172;4'397'073\n",
            "Y|X|NAME|POP_EST\n-1.2864|36.8172|Nairobi|4397073.0\n",
        ] {
            let reading = from_table(table).unwrap();
            let place = &reading.places[0];
            assert_eq!(
                (place.name.as_str(), place.latitude_deg, place.longitude_deg, place.population),
                ("Nairobi", -1.2864, 36.8172, Some(4_397_073)),
                "{table}"
            );
            assert_eq!((reading.skipped.len(), reading.bad_populations), (0, 0), "{table}");
        }
    }

    /// What cannot be read is counted, and the rest is there.
    #[test]
    fn a_bad_place_does_not_cost_the_others() {
        let reading = from_table("name,lat,lon,population\nA,1,2,many\nB,95,2\n,3,4\nC,x,y\n").unwrap();
        assert_eq!((reading.places.len(), reading.bad_populations), (1, 1));
        assert_eq!(reading.skipped.len(), 3);
        assert!(reading.skipped[0].contains("line 3") && reading.skipped[0].contains("95"), "{reading:?}");
        let json = r#"{"type": "FeatureCollection", "features": [
            {"type": "Feature", "properties": {"name": "A"}, "geometry": {"type": "Point", "coordinates": [2, 1]}},
            {"type": "Feature", "properties": {"place": "hamlet", "name": null},
             "geometry": {"type": "Point", "coordinates": [2, 1]}},
            {"type": "Feature", "properties": {"name": "B"}, "geometry": null}]}"#;
        let reading = from_geojson(json).unwrap();
        assert_eq!((reading.places.len(), reading.skipped.len()), (1, 2), "{reading:?}");
        assert!(from_table("hello").unwrap_err().contains("name, latitude, longitude"));
        assert!(from_geojson("{}").is_err());
    }

    /// Latitude and longitude exchanged are found out by the raster's bounds.
    #[test]
    fn exchanged_axes_are_found_out() {
        let place = |name: &str, latitude_deg: f64, longitude_deg: f64| NamedPlace {
            name: name.to_owned(),
            latitude_deg,
            longitude_deg,
            population: None,
        };
        let kenya = [33.9, -4.7, 41.9, 5.0];
        let (nairobi, exchanged) = (place("Nairobi", -1.29, 36.82), place("Voi", 38.56, -3.4));
        assert_eq!(check_inside(std::slice::from_ref(&nairobi), kenya), Ok(None));
        let refused = check_inside(std::slice::from_ref(&exchanged), kenya).unwrap_err();
        assert!(refused.contains("exchanged") && refused.contains("Voi"), "{refused}");
        let said = check_inside(&[nairobi, exchanged], kenya).unwrap().unwrap();
        assert!(said.starts_with("1 of 2") && said.contains("Voi"), "{said}");
        assert!(
            check_inside(&[place("Oslo", 59.9, 10.7)], kenya).unwrap().unwrap().contains("none of the 1")
        );
    }

    #[test]
    fn populations_are_read_in_all_spellings() {
        for (text, expected) in [
            ("4397073", Some(Ok(4_397_073))),
            ("4 397 073", Some(Ok(4_397_073))),
            ("4.397.073", Some(Ok(4_397_073))),
            ("12,345", Some(Ok(12_345))),
            ("1234.0", Some(Ok(1_234))),
            ("-99", None),
            ("", None),
            ("about ten", Some(Err(()))),
        ] {
            assert_eq!(population(text), expected, "{text}");
        }
    }

    #[test]
    fn text_is_read_in_its_encodings() {
        assert_eq!(text_of(b"\xef\xbb\xbfname").unwrap(), "name");
        assert_eq!(text_of(b"\xff\xfen\0a\0").unwrap(), "na");
        assert_eq!(text_of(b"Z\xfcrich").unwrap(), "Zürich");
        assert!(text_of(b"PK\x03\x04\0\0").is_err());
    }
}
