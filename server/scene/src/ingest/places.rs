//! Named places from GeoJSON or CSV.

use crate::error::SceneError;
use crate::metadata::NamedPlace;
use serde_json::Value;
use std::path::Path;

/// Keys and column heads taken for each field, in lower case.
const NAME: [&str; 2] = ["name", "place"];
const LATITUDE: [&str; 3] = ["latitude", "lat", "y"];
const LONGITUDE: [&str; 5] = ["longitude", "lon", "lng", "long", "x"];
const POPULATION: [&str; 3] = ["population", "pop", "inhabitants"];

/// Bytes of a file of places at most: all of it is read, and JSON takes many times as much.
const MAX_BYTES: u64 = 32 << 20;

/// Reads a file of places, the most populous first.
pub(super) fn read(path: &Path) -> Result<Vec<NamedPlace>, SceneError> {
    let refuse = |reason: String| SceneError::Refused { path: path.to_owned(), reason };
    let length = std::fs::metadata(path).map_err(SceneError::io(path))?.len();
    if length > MAX_BYTES {
        return Err(refuse(format!("it has {length} bytes; places may have {MAX_BYTES}")));
    }
    let bytes = std::fs::read(path).map_err(SceneError::io(path))?;
    let first = bytes.iter().find(|byte| !byte.is_ascii_whitespace());
    let mut places =
        if first == Some(&b'{') { from_geojson(&bytes) } else { from_csv(&bytes) }.map_err(refuse)?;
    if places.is_empty() {
        return Err(refuse("it holds no places".to_owned()));
    }
    places.sort_by(|a, b| b.population.cmp(&a.population).then_with(|| a.name.cmp(&b.name)));
    Ok(places)
}

/// A place, checked; `what` names its position in the file.
fn place(
    what: &str,
    name: &str,
    latitude: f64,
    longitude: f64,
    population: Option<f64>,
) -> Result<NamedPlace, String> {
    if !(-90.0..=90.0).contains(&latitude) || !(-180.0..=360.0).contains(&longitude) {
        return Err(format!(
            "{what} (\"{name}\") lies at latitude {latitude}, longitude {longitude}, off the world"
        ));
    }
    let longitude_deg = if longitude >= 180.0 { longitude - 360.0 } else { longitude };
    let population = population.filter(|p| p.is_finite() && *p >= 0.0).map(|p| p as u64);
    Ok(NamedPlace { name: name.trim().to_owned(), latitude_deg: latitude, longitude_deg, population })
}

fn from_geojson(bytes: &[u8]) -> Result<Vec<NamedPlace>, String> {
    let document: Value = serde_json::from_slice(bytes).map_err(|e| format!("it is no JSON ({e})"))?;
    let features = document.get("features").and_then(Value::as_array);
    let features = features.ok_or("it is no GeoJSON FeatureCollection")?;
    let mut places = Vec::new();
    for (index, feature) in features.iter().enumerate() {
        let what = format!("feature {}", index + 1);
        let field = |keys: &[&str]| {
            let properties = feature.get("properties")?.as_object()?;
            properties
                .iter()
                .find(|(key, _)| keys.contains(&key.to_lowercase().as_str()))
                .map(|(_, value)| value)
        };
        let name = field(&NAME).and_then(Value::as_str).ok_or_else(|| format!("{what} has no name"))?;
        let point =
            feature.get("geometry").filter(|g| g.get("type").and_then(Value::as_str) == Some("Point"));
        let axis = |i: usize| point?.get("coordinates")?.get(i)?.as_f64();
        let (Some(longitude), Some(latitude)) = (axis(0), axis(1)) else {
            return Err(format!("{what} (\"{name}\") is not a point"));
        };
        places.push(place(&what, name, latitude, longitude, field(&POPULATION).and_then(Value::as_f64))?);
    }
    Ok(places)
}

fn from_csv(bytes: &[u8]) -> Result<Vec<NamedPlace>, String> {
    let mut reader = csv::ReaderBuilder::new().trim(csv::Trim::All).from_reader(bytes);
    let heads = reader.headers().map_err(|e| format!("it is no CSV ({e})"))?.clone();
    let column = |keys: &[&str]| {
        heads
            .iter()
            .position(|head| keys.contains(&head.trim_start_matches('\u{feff}').to_lowercase().as_str()))
    };
    let (Some(name), Some(latitude), Some(longitude)) =
        (column(&NAME), column(&LATITUDE), column(&LONGITUDE))
    else {
        return Err("it is neither GeoJSON nor a CSV with the columns name, latitude, longitude".to_owned());
    };
    let population = column(&POPULATION);
    let mut places = Vec::new();
    for (index, record) in reader.records().enumerate() {
        let what = format!("line {}", index + 2);
        let record = record.map_err(|e| format!("{what} is broken ({e})"))?;
        let number = |at: usize| record.get(at).and_then(|text| text.parse::<f64>().ok());
        let (Some(name), Some(latitude), Some(longitude)) =
            (record.get(name), number(latitude), number(longitude))
        else {
            return Err(format!("{what} has no name, latitude or longitude"));
        };
        places.push(place(&what, name, latitude, longitude, population.and_then(number))?);
    }
    Ok(places)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn csv_and_geojson_give_the_same_places() {
        let csv = "Name,lat,lon,population\nNairobi,-1.2864,36.8172,4397073\n\"Voi, town\",-3.396,38.556,\n";
        let json = r#"{"type": "FeatureCollection", "features": [
            {"type": "Feature", "properties": {"name": "Nairobi", "population": 4397073},
             "geometry": {"type": "Point", "coordinates": [36.8172, -1.2864]}},
            {"type": "Feature", "properties": {"name": "Voi, town"},
             "geometry": {"type": "Point", "coordinates": [38.556, -3.396]}}]}"#;
        let places = from_csv(csv.as_bytes()).unwrap();
        assert_eq!(places, from_geojson(json.as_bytes()).unwrap());
        assert_eq!(places[0].population, Some(4_397_073));
        assert_eq!(places[1].population, None);
    }

    #[test]
    fn broken_files_are_refused_with_their_line() {
        let message = from_csv(b"name,lat,lon\nA,1,2\nB,95,2\n").unwrap_err();
        assert!(message.contains("line 3") && message.contains("95"), "{message}");
        assert!(from_csv(b"hello").unwrap_err().contains("name, latitude, longitude"));
        assert!(from_geojson(b"{}").is_err());
    }
}
