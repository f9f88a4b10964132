//! Areas from GeoJSON (RFC 7946).

use serde::Deserialize;
use skyglow_scene::{Boundary, BoundaryError, Position};
use thiserror::Error;

/// GeoJSON as it came.
#[derive(Clone, Debug, Deserialize)]
#[serde(transparent)]
pub struct BoundaryBody(geojson::GeoJson);

/// One feature of GeoJSON, or what stands by itself without properties.
#[derive(Clone, Debug)]
pub struct FeatureBody {
    /// Its properties.
    pub properties: serde_json::Map<String, serde_json::Value>,
    /// What it covers.
    pub area: BoundaryBody,
}

impl BoundaryBody {
    /// Its features, each by itself.
    pub fn into_features(self) -> Vec<FeatureBody> {
        let one = |mut feature: geojson::Feature| FeatureBody {
            properties: feature.properties.take().unwrap_or_default(),
            area: Self(geojson::GeoJson::Feature(feature)),
        };
        match self.0 {
            geojson::GeoJson::FeatureCollection(all) => all.features.into_iter().map(one).collect(),
            geojson::GeoJson::Feature(feature) => vec![one(feature)],
            geometry @ geojson::GeoJson::Geometry(_) => {
                vec![FeatureBody { properties: serde_json::Map::new(), area: Self(geometry) }]
            }
        }
    }
}

impl FeatureBody {
    /// The feature with further properties beside its own. Its outer rings run counter-clockwise (RFC 7946, 3.1.6), however they came.
    pub fn with(self, further: serde_json::Map<String, serde_json::Value>) -> geojson::Feature {
        let (id, mut geometry) = match self.area.0 {
            geojson::GeoJson::Feature(feature) => (feature.id, feature.geometry),
            geojson::GeoJson::Geometry(geometry) => (None, Some(geometry)),
            geojson::GeoJson::FeatureCollection(_) => (None, None),
        };
        if let Some(geometry) = &mut geometry {
            turn(&mut geometry.value);
        }
        let mut properties = self.properties;
        properties.extend(further);
        geojson::Feature { id, geometry, properties: Some(properties), ..geojson::Feature::default() }
    }
}

/// Turns rings that run the wrong way.
fn turn(geometry: &mut geojson::GeometryValue) {
    use geojson::GeometryValue as Value;
    let turn_polygon = |polygon: &mut Vec<Vec<geojson::Position>>| {
        for (number, ring) in polygon.iter_mut().enumerate() {
            if (number == 0) != (twice_area(ring) >= 0.0) {
                ring.reverse();
            }
        }
    };
    match geometry {
        Value::Polygon { coordinates } => turn_polygon(coordinates),
        Value::MultiPolygon { coordinates } => coordinates.iter_mut().for_each(turn_polygon),
        Value::GeometryCollection { geometries } => {
            geometries.iter_mut().for_each(|geometry| turn(&mut geometry.value));
        }
        _ => {}
    }
}

/// Twice the area that a ring bounds, square degrees: positive where it runs counter-clockwise (shoelace formula).
fn twice_area(ring: &[geojson::Position]) -> f64 {
    let side = |two: &[geojson::Position]| match [two[0].as_slice(), two[1].as_slice()] {
        [[x0, y0, ..], [x1, y1, ..]] => (x1 - x0) * (y0 + y1),
        _ => 0.0,
    };
    -ring.windows(2).map(side).sum::<f64>()
}

/// Why GeoJSON names no area.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum AreaError {
    /// Points, lines and the like.
    #[error("a {0} bounds no area")]
    NoArea(&'static str),
    /// A feature without a geometry.
    #[error("a feature has no geometry")]
    NoGeometry,
    /// A position of one number.
    #[error("a position is a longitude and a latitude")]
    NoPosition,
    /// Polygons that bound none.
    #[error(transparent)]
    Boundary(#[from] BoundaryError),
}

/// The area of a polygon, or of several together.
///
/// # Errors
/// [`AreaError`].
pub fn boundary(body: &BoundaryBody) -> Result<Boundary, AreaError> {
    Ok(Boundary::new(&polygons(body)?)?)
}

/// Its polygons as rings of longitude and latitude.
///
/// # Errors
/// [`AreaError`] where it is made of something else.
pub fn polygons(body: &BoundaryBody) -> Result<Polygons, AreaError> {
    let mut polygons = Vec::new();
    match &body.0 {
        geojson::GeoJson::Geometry(geometry) => add(geometry, &mut polygons)?,
        geojson::GeoJson::Feature(feature) => add_feature(feature, &mut polygons)?,
        geojson::GeoJson::FeatureCollection(features) => {
            features.features.iter().try_for_each(|feature| add_feature(feature, &mut polygons))?;
        }
    }
    Ok(polygons)
}

/// Polygons, each of rings, the outer one first.
pub type Polygons = Vec<Vec<Vec<Position>>>;

fn add_feature(feature: &geojson::Feature, polygons: &mut Polygons) -> Result<(), AreaError> {
    add(feature.geometry.as_ref().ok_or(AreaError::NoGeometry)?, polygons)
}

fn add(geometry: &geojson::Geometry, polygons: &mut Polygons) -> Result<(), AreaError> {
    use geojson::GeometryValue as Value;
    match &geometry.value {
        Value::Polygon { coordinates } => polygons.push(rings(coordinates)?),
        Value::MultiPolygon { coordinates } => {
            for polygon in coordinates {
                polygons.push(rings(polygon)?);
            }
        }
        Value::GeometryCollection { geometries } => {
            geometries.iter().try_for_each(|geometry| add(geometry, polygons))?;
        }
        other => return Err(AreaError::NoArea(other.type_name())),
    }
    Ok(())
}

/// Rings of longitude and latitude; altitudes are left out.
fn rings(polygon: &[Vec<geojson::Position>]) -> Result<Vec<Vec<Position>>, AreaError> {
    let position = |position: &geojson::Position| match position.as_slice() {
        [longitude_deg, latitude_deg, ..] => Ok([*longitude_deg, *latitude_deg]),
        _ => Err(AreaError::NoPosition),
    };
    polygon.iter().map(|ring| ring.iter().map(position).collect()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    /// Features keep their own properties and ids, and their rings run as the standard wants, holes the other way.
    #[test]
    fn features_come_back_right_handed() {
        let outer = json!([[8.0, 46.0], [9.0, 46.0], [9.0, 47.0], [8.0, 47.0], [8.0, 46.0]]);
        let clockwise = json!([[8.0, 46.0], [8.0, 47.0], [9.0, 47.0], [9.0, 46.0], [8.0, 46.0]]);
        let hole = json!([[8.4, 46.4], [8.4, 46.6], [8.6, 46.6], [8.4, 46.4]]);
        let turned_hole = json!([[8.4, 46.4], [8.6, 46.6], [8.4, 46.6], [8.4, 46.4]]);
        for rings in [json!([outer, hole]), json!([clockwise, hole]), json!([clockwise, turned_hole])] {
            let feature = json!({"type": "Feature", "id": 7, "properties": {"code": 5113, "name": "a"},
                                 "geometry": {"type": "MultiPolygon", "coordinates": [rings]}});
            let body: BoundaryBody = serde_json::from_value(feature).unwrap();
            let further = json!({"name": "b", "share": 0.25}).as_object().unwrap().clone();
            let feature = body.into_features().remove(0).with(further);
            let expected = json!({"type": "Feature", "id": 7,
                                  "properties": {"code": 5113, "name": "b", "share": 0.25},
                                  "geometry": {"type": "MultiPolygon", "coordinates": [[outer, hole]]}});
            assert_eq!(serde_json::to_value(feature).unwrap(), expected);
        }
    }
}
