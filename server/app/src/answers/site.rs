//! What is at a place, and how its ground is known.

use super::SceneReference;
use crate::format::rounded;
use serde::Serialize;
use skyglow_observatory::Site;
use skyglow_physics::GeoPoint;
use skyglow_scene::{Ground, SceneMetadata};
use utoipa::ToSchema;

/// Says where the altitude of the ground comes from if not from the terrain there.
pub(super) fn ground_warning(scene: &SceneMetadata, ground: Ground) -> Option<String> {
    match ground {
        Ground::Here { .. } => None,
        Ground::Nearest { distance_m, .. } => Some(format!(
            "the terrain has no data at this place: the ground is taken from the nearest terrain, {:.1} km away",
            distance_m / 1e3
        )),
        Ground::Unknown if scene.terrain => Some(
            "the terrain has no data within 5 km of this place: the ground is taken at sea level".to_owned(),
        ),
        Ground::Unknown => Some("the scene has no terrain: the ground is taken at sea level".to_owned()),
    }
}

/// What is at a place.
#[derive(Clone, Debug, Serialize, ToSchema)]
pub struct SiteAnswer {
    /// The scene.
    pub scene: SceneReference,
    /// Degrees north.
    pub latitude_deg: f64,
    /// Degrees east.
    pub longitude_deg: f64,
    /// Altitude of the ground, metres, at least 0: where the terrain has a gap, that of the nearest terrain
    /// within 5 km; null where there is none, then 0 counts.
    pub terrain_altitude_m: Option<f64>,
    /// Radiance of the raster's pixel there, nW cm⁻² sr⁻¹; 0 where dark, null without data.
    pub radiance_nw_cm2_sr: Option<f64>,
    /// Factor on the raster's radiances (not in `radiance_nw_cm2_sr`).
    pub calibration: f64,
    /// West, south, east, north of the scene, degrees.
    pub bounds: [f64; 4],
    /// What is not as it should be there, one sentence each: ground that the terrain does not have.
    pub warnings: Vec<String>,
}

impl SiteAnswer {
    /// The answer for a place.
    pub fn new(place: GeoPoint, scene: &SceneMetadata, site: Site) -> Self {
        Self {
            scene: scene.into(),
            latitude_deg: rounded(place.latitude_deg()),
            longitude_deg: rounded(place.longitude_deg()),
            terrain_altitude_m: site.ground.known_altitude_m(),
            radiance_nw_cm2_sr: site.radiance_nw_cm2_sr,
            calibration: scene.calibration,
            bounds: scene.bounds,
            warnings: ground_warning(scene, site.ground).into_iter().collect(),
        }
    }
}
