//! Areas as people have them: in files of other formats, with a byte order mark, with latitude before longitude.

use super::geojson::{AreaError, BoundaryBody, Polygons, polygons};
use crate::{error::AppError, validation::ValidationCode};
use skyglow_scene::{Boundary, BoundaryError};

/// An area, and how far it reaches.
#[derive(Clone, Debug)]
pub struct BoundedArea {
    /// The area.
    pub boundary: Boundary,
    /// Least longitude and latitude, largest longitude and latitude, degrees, as they came.
    extent_deg: [f64; 4],
}

impl BoundedArea {
    /// The area of GeoJSON.
    ///
    /// # Errors
    /// [`AreaError`].
    pub fn new(body: &BoundaryBody) -> Result<Self, AreaError> {
        Ok(Self::of_polygons(&polygons(body)?)?)
    }

    /// The area of polygons, each of rings, the outer one first.
    ///
    /// # Errors
    /// [`BoundaryError`].
    pub fn of_polygons(polygons: &Polygons) -> Result<Self, BoundaryError> {
        let positions = polygons.iter().flatten().flatten();
        let unbounded = [f64::INFINITY, f64::INFINITY, f64::NEG_INFINITY, f64::NEG_INFINITY];
        let extent_deg = positions.fold(unbounded, |[west, south, east, north], &[longitude, latitude]| {
            [west.min(longitude), south.min(latitude), east.max(longitude), north.max(latitude)]
        });
        Ok(Self { boundary: Boundary::new(polygons)?, extent_deg })
    }

    /// Least longitude and latitude, largest longitude and latitude, degrees, as they came.
    pub fn extent_deg(&self) -> [f64; 4] {
        self.extent_deg
    }

    /// Refuses an area that cannot hold a pixel of a scene: its share would be 0, and nobody would know why.
    ///
    /// * `bounds`: west, south, east, north of the scene, degrees.
    ///
    /// # Errors
    /// [`AppError::Parameters`], with a word on coordinates in the wrong order where that is what is wrong.
    pub fn check_within(&self, bounds: [f64; 4]) -> Result<(), AppError> {
        self.check_within_as("boundary", "GeoJSON", bounds)
    }

    /// The same for a parameter in a format of that name.
    ///
    /// # Errors
    /// As [`Self::check_within`].
    pub fn check_within_as(&self, parameter: &str, format: &str, bounds: [f64; 4]) -> Result<(), AppError> {
        if meet(self.extent_deg, bounds) {
            return Ok(());
        }
        let [west, south, east, north] = bounds;
        let [least_longitude, least_latitude, largest_longitude, largest_latitude] = self.extent_deg;
        let swapped = [least_latitude, least_longitude, largest_latitude, largest_longitude];
        let hint = match meet(swapped, bounds) {
            true => {
                format!(": its positions look like latitude, longitude, and {format} has longitude, latitude")
            }
            false => String::new(),
        };
        Err(AppError::parameter(
            parameter,
            format!("{least_longitude} {least_latitude} to {largest_longitude} {largest_latitude}"),
            format!("an area within west {west} south {south} east {east} north {north}"),
            format!("holds no pixel of this scene{hint}"),
            ValidationCode::NotAllowed,
        ))
    }
}

/// Whether two boxes of west, south, east, north have something in common. West may be beyond east, across the antimeridian.
pub(super) fn meet([west, south, east, north]: [f64; 4], [w, s, e, n]: [f64; 4]) -> bool {
    let last = if w > e { e + 360.0 } else { e };
    let meets_at = |turn: f64| west + turn <= last && east + turn >= w;
    south <= n && north >= s && [-360.0, 0.0, 360.0].into_iter().any(meets_at)
}

/// Bytes without the byte order mark that some programs put before text.
pub fn without_byte_order_mark(bytes: &[u8]) -> &[u8] {
    bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes)
}

/// What a file of areas is that is no GeoJSON, and what to do with it; None where nobody knows.
pub fn other_format(bytes: &[u8]) -> Option<String> {
    let head = &bytes[..bytes.len().min(4096)];
    let text = String::from_utf8_lossy(head).to_lowercase();
    let name = match head {
        _ if head.starts_with(b"SQLite format 3\0") => "a GeoPackage",
        _ if head.starts_with(&[0, 0, 0x27, 0x0a]) => "a shapefile",
        _ if head.starts_with(b"PK\x03\x04") => {
            "a zip archive, as KMZ and zipped shapefiles are; unpack it first. It"
        }
        _ if text.contains("<kml") => "KML",
        _ if text.contains("<gml") || text.contains("<wfs:") => "GML",
        _ if text.contains("<html") => "a page of the web and no file of areas; it",
        _ => return None,
    };
    Some(format!(
        "is {name} and not GeoJSON; `ogr2ogr -f GeoJSON -t_srs EPSG:4326 area.geojson FILE` makes it so"
    ))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn area(ring: &str) -> BoundedArea {
        let text = format!(r#"{{"type": "Polygon", "coordinates": [{ring}]}}"#);
        BoundedArea::new(&serde_json::from_str(&text).unwrap()).unwrap()
    }

    #[test]
    fn an_area_elsewhere_holds_no_pixel() {
        let alps = [5.0, 43.0, 16.0, 48.0];
        let refusal = |ring: &str, bounds| area(ring).check_within(bounds).map_err(|error| error.detail());
        assert_eq!(refusal("[[8,46],[9,46],[9,47],[8,46]]", alps), Ok(()));
        // Counted on beyond 180 degrees.
        assert_eq!(
            refusal("[[181,-18],[181.5,-18],[181.5,-17],[181,-18]]", [176.0, -20.0, -178.0, -15.0]),
            Ok(())
        );
        let swapped = refusal("[[46,8],[46,9],[47,9],[46,8]]", alps).unwrap_err();
        assert!(
            swapped.contains("holds no pixel of this scene: its positions look like latitude"),
            "{swapped}"
        );
        let elsewhere = refusal("[[-70,46],[-69,46],[-69,47],[-70,46]]", alps).unwrap_err();
        assert!(elsewhere.contains("holds no pixel") && !elsewhere.contains("look like"), "{elsewhere}");
        let fiji = [176.0, -20.0, -178.0, -15.0];
        assert_eq!(refusal("[[-179,-18],[-178.5,-18],[-178.5,-17],[-179,-18]]", fiji), Ok(()));
        assert!(refusal("[[0,-18],[1,-18],[1,-17],[0,-18]]", fiji).is_err());
    }

    #[test]
    fn other_formats_are_refused_by_name() {
        for (bytes, name) in [
            (b"SQLite format 3\0...".as_slice(), "GeoPackage"),
            (&[0, 0, 0x27, 0x0a, 0, 0], "shapefile"),
            (b"<?xml version=\"1.0\"?>\n<kml xmlns=\"http://www.opengis.net/kml/2.2\">", "KML"),
            (b"PK\x03\x04doc.kml", "zip"),
            (b"<!DOCTYPE html><html>", "page"),
        ] {
            let reason = other_format(bytes).unwrap();
            assert!(reason.contains(name) && reason.contains("ogr2ogr"), "{reason}");
        }
        assert_eq!((other_format(b"{\"type\": "), other_format(b"")), (None, None));
        assert_eq!(without_byte_order_mark(b"\xef\xbb\xbf{}"), b"{}");
    }
}
