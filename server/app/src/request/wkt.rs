//! Geometries as Well-Known Text (OGC 06-103r4): points, lines and polygons of longitudes and latitudes.

use super::geojson::Polygons;
use thiserror::Error;

/// Positions of a text at most; longer ones are refused before they are read.
const MAX_POSITIONS: usize = 50_000;

/// Why a text is no geometry that is taken.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub(super) enum WktError {
    /// Another geometry.
    #[error("is a {found}, and here a {wanted} is taken")]
    OtherGeometry {
        /// What it is.
        found: String,
        /// What is taken.
        wanted: &'static str,
    },
    /// A geometry with heights or measures that mean nothing here.
    #[error("has {found} numbers in a position, and here {wanted} are taken")]
    OtherDimension {
        /// Numbers of a position.
        found: usize,
        /// Numbers that are taken.
        wanted: &'static str,
    },
    /// No Well-Known Text.
    #[error("is no Well-Known Text: {0}")]
    Malformed(&'static str),
    /// Too much of it.
    #[error("has more than {MAX_POSITIONS} positions")]
    TooLong,
    /// A position that is none.
    #[error("longitude {longitude}, latitude {latitude} is no place{}", if *.swapped { ": latitude comes second" } else { "" })]
    NoPlace {
        /// Longitude as it came.
        longitude: String,
        /// Latitude as it came.
        latitude: String,
        /// Whether it would be a place the other way round.
        swapped: bool,
    },
}

/// Numbers of a position: longitude, latitude, and what else it has.
type Numbers = Vec<f64>;

/// A position with the number that a measured geometry has.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Measured {
    /// Longitude and latitude, degrees.
    pub(super) position: [f64; 2],
    /// The measure M.
    pub(super) measure: Option<f64>,
}

/// Longitude and latitude of a point.
///
/// # Errors
/// [`WktError`].
pub(super) fn point(text: &str) -> Result<[f64; 2], WktError> {
    let (mut rest, _) = tagged(text, &["POINT"], "POINT")?;
    let numbers = list(&mut rest, numbers)?;
    end(rest)?;
    let [numbers] = <[Numbers; 1]>::try_from(numbers).map_err(|_| WktError::Malformed("a point is one"))?;
    plane(&numbers)
}

/// The positions of a line, which may be measured.
///
/// # Errors
/// [`WktError`].
pub(super) fn line(text: &str) -> Result<Vec<Measured>, WktError> {
    let (mut rest, is_measured) = tagged(text, &["LINESTRING"], "LINESTRING")?;
    let all = list(&mut rest, numbers)?;
    end(rest)?;
    all.iter()
        .map(|numbers| match numbers.as_slice() {
            [x, y, measure] if is_measured => {
                Ok(Measured { position: plane(&[*x, *y])?, measure: Some(*measure) })
            }
            other if is_measured => {
                Err(WktError::OtherDimension { found: other.len(), wanted: "longitude, latitude and M" })
            }
            other => Ok(Measured { position: plane(other)?, measure: None }),
        })
        .collect()
}

/// The polygons of one or of several, each of rings, the outer one first.
///
/// # Errors
/// [`WktError`].
pub(super) fn polygons(text: &str) -> Result<Polygons, WktError> {
    let wanted = "POLYGON or MULTIPOLYGON";
    let is_many = name_of(text).starts_with("MULTI");
    let (mut rest, is_measured) = tagged(text, &["POLYGON", "MULTIPOLYGON"], wanted)?;
    if is_measured {
        return Err(WktError::OtherDimension { found: 3, wanted: "longitude and latitude" });
    }
    let ring = |rest: &mut &str| {
        list(rest, numbers)?.iter().map(|numbers| plane(numbers)).collect::<Result<Vec<_>, _>>()
    };
    let polygon = |rest: &mut &str| list(rest, ring);
    let polygons = if is_many { list(&mut rest, polygon)? } else { vec![polygon(&mut rest)?] };
    end(rest)?;
    Ok(polygons)
}

/// The name that a text begins with, in capitals.
fn name_of(text: &str) -> String {
    text.trim_start().chars().take_while(char::is_ascii_alphabetic).collect::<String>().to_ascii_uppercase()
}

/// What follows the name of a geometry, and whether its positions are measured.
fn tagged<'a>(text: &'a str, names: &[&str], wanted: &'static str) -> Result<(&'a str, bool), WktError> {
    if text.matches(',').count() >= MAX_POSITIONS {
        return Err(WktError::TooLong);
    }
    let word = name_of(text);
    let mut rest = text.trim_start().get(word.len()..).unwrap_or_default().trim_start();
    let (mut name, mut dimension) = (word.as_str(), String::new());
    // Both `POINT M` and `POINTM` are about.
    for end in ["ZM", "Z", "M"] {
        if let Some(base) = name.strip_suffix(end).filter(|base| names.contains(base)) {
            (name, dimension) = (base, end.to_owned());
            break;
        }
    }
    if dimension.is_empty() && names.contains(&name) {
        dimension = name_of(rest);
        rest = rest.get(dimension.len()..).unwrap_or_default().trim_start();
    }
    if !names.contains(&name) {
        return Err(match name.is_empty() {
            true => WktError::Malformed("it begins with no name of a geometry"),
            false => WktError::OtherGeometry { found: crate::validation::echo(name), wanted },
        });
    }
    match dimension.as_str() {
        "" => Ok((rest, false)),
        "M" => Ok((rest, true)),
        "Z" => Err(WktError::OtherDimension { found: 3, wanted: "longitude and latitude" }),
        "ZM" => Err(WktError::OtherDimension { found: 4, wanted: "longitude and latitude" }),
        "EMPTY" => Err(WktError::Malformed("it is empty")),
        _ => Err(WktError::Malformed("after the name comes a bracket")),
    }
}

/// A list in brackets.
fn list<T>(rest: &mut &str, one: impl Fn(&mut &str) -> Result<T, WktError>) -> Result<Vec<T>, WktError> {
    *rest = rest.trim_start().strip_prefix('(').ok_or(WktError::Malformed("a bracket is missing"))?;
    let mut all = Vec::new();
    loop {
        all.push(one(rest)?);
        *rest = rest.trim_start();
        if let Some(after) = rest.strip_prefix(',') {
            *rest = after;
        } else {
            *rest = rest.strip_prefix(')').ok_or(WktError::Malformed("a bracket is not closed"))?;
            return Ok(all);
        }
    }
}

/// The numbers of a position.
fn numbers(rest: &mut &str) -> Result<Numbers, WktError> {
    let end = rest.find([',', ')', '(']).unwrap_or(rest.len());
    let (text, after) = rest.split_at(end);
    *rest = after;
    let all: Option<Numbers> = text.split_whitespace().map(|word| word.parse().ok()).collect();
    let all = all.filter(|all| all.len() >= 2 && all.iter().all(|number| number.is_finite()));
    all.ok_or(WktError::Malformed("a position is two numbers, longitude and latitude, with a space between"))
}

/// Longitude and latitude of a position that has nothing else.
fn plane(numbers: &[f64]) -> Result<[f64; 2], WktError> {
    let [longitude, latitude] = <[f64; 2]>::try_from(numbers)
        .map_err(|_| WktError::OtherDimension { found: numbers.len(), wanted: "longitude and latitude" })?;
    let is_place = |longitude: f64, latitude: f64| {
        (-360.0..=360.0).contains(&longitude) && (-90.0..=90.0).contains(&latitude)
    };
    if is_place(longitude, latitude) {
        return Ok([longitude, latitude]);
    }
    let swapped = is_place(latitude, longitude);
    Err(WktError::NoPlace { longitude: longitude.to_string(), latitude: latitude.to_string(), swapped })
}

/// Nothing comes after a geometry.
fn end(rest: &str) -> Result<(), WktError> {
    if rest.trim().is_empty() { Ok(()) } else { Err(WktError::Malformed("something follows its end")) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn points_lines_and_polygons_are_read() {
        for text in ["POINT(8.79 46.17)", " point ( 8.79  46.17 ) ", "Point(8.79 46.17)"] {
            assert_eq!(point(text), Ok([8.79, 46.17]), "{text}");
        }
        let path = line("LINESTRING(8 46,-9.5 4.6e1)").unwrap();
        assert_eq!(path[1], Measured { position: [-9.5, 46.0], measure: None });
        for text in [
            "LINESTRINGM(8 46 1700000000, 9 46 1700000060)",
            "LINESTRING M (8 46 1700000000, 9 46 1700000060)",
        ] {
            assert_eq!(line(text).unwrap()[1].measure, Some(1_700_000_060.0), "{text}");
        }
        let square = "((8 46,9 46,9 47,8 46),(8.1 46.1,8.2 46.1,8.2 46.2,8.1 46.1))";
        let one = polygons(&format!("POLYGON{square}")).unwrap();
        assert_eq!((one.len(), one[0].len(), one[0][1].len()), (1, 2, 4));
        assert_eq!(polygons(&format!("MULTIPOLYGON({square},{square})")).unwrap().len(), 2);
    }

    #[test]
    fn what_is_no_such_geometry_says_why() {
        let why = |refused: Result<[f64; 2], WktError>| refused.unwrap_err().to_string();
        assert!(why(point("POLYGON((1 2,3 4,5 6,1 2))")).contains("is a POLYGON"));
        assert!(why(point("POINT Z(1 2 3)")).contains("3 numbers"));
        assert!(why(point("POINT(1 2 3)")).contains("3 numbers"));
        assert!(why(point("POINT(46.17 188.79)")).contains("latitude comes second"));
        assert!(why(point("POINT(400 50)")).contains("no place"));
        for text in [
            "",
            "POINT",
            "POINT(1,2)",
            "POINT(1 2",
            "POINT(1 2))",
            "POINT(1 2) x",
            "8.79,46.17",
            "POINT(a b)",
            "POINT(NaN 1)",
            "POINT EMPTY",
            "POINT(1 2,3 4)",
        ] {
            assert!(matches!(point(text), Err(WktError::Malformed(_))), "{text}: {:?}", point(text));
        }
        assert!(line("LINESTRING M(8 46,9 46)").is_err());
        assert!(polygons("POLYGON(8 46,9 46,9 47,8 46)").is_err());
        assert_eq!(line(&format!("LINESTRING({}1 2)", "1 2,".repeat(MAX_POSITIONS))), Err(WktError::TooLong));
    }
}
