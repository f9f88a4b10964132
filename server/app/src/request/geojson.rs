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
