//! Parts of a map of brightness: the places of a window, with the numbers of the whole map there, bit for bit.

use crate::{
    answers::{BrightnessAssumptions, brightness_shows},
    error::AppError,
    facts::SourceFacts,
    fingerprint::{atlas_key, brightness_content},
    validation::ValidationCode,
};
use serde::Serialize;
use skyglow_observatory::{BrightnessRequest, SceneView};
use skyglow_scene::PlaceWindow;

/// Most places that are found at a time, of a map or a part of one. A map as a whole may have more.
pub const MAX_MAP_PLACES: u32 = 400_000_000;

/// What a map of brightness will be, before any of it is found.
#[derive(Clone, Debug, Serialize)]
pub struct MapFrame {
    /// Places from west to east.
    pub columns: u32,
    /// Places from north to south.
    pub rows: u32,
    /// Columns and rows that are found together: parts that are made of whole ones cost no more than their share of the map.
    pub patch: [u32; 2],
    /// Of a raster with a pixel for each place: x = g0 + column·g1 + row·g2, y = g3 + column·g4 + row·g5.
    pub geotransform: [f64; 6],
    /// Its CRS as WKT.
    pub crs_wkt: String,
    /// West, south, east and north of the scene, degrees; west > east across the antimeridian.
    pub bounds: [f64; 4],
    /// The unit of its numbers.
    pub unit: String,
    /// What its numbers are, in words.
    pub description: String,
    /// Ends of the colours of its pictures.
    pub colour_range: (f64, f64),
    /// Whom to credit for the scene.
    pub attribution: Option<String>,
    /// When the scene's light was seen.
    pub date: Option<String>,
    /// What its numbers depend on.
    pub assumptions: BrightnessAssumptions,
    /// A hash of the request, the scene and the packs, but not of the program.
    pub content: String,
    /// The same whatever the number of places: a server shows tiles with this key where it would compute the map.
    pub atlas_key: String,
}

impl MapFrame {
    /// That of a request.
    ///
    /// # Errors
    /// [`AppError::Internal`], only by a defect.
    pub fn new(request: &BrightnessRequest, view: &SceneView, facts: &SourceFacts) -> Result<Self, AppError> {
        let scene = view.scene();
        let metadata = scene.metadata();
        let lattice = scene.place_lattice(request.max_places);
        Ok(Self {
            columns: lattice.columns,
            rows: lattice.rows,
            patch: scene.patch_size(lattice),
            geotransform: scene.lattice_geotransform(lattice),
            crs_wkt: metadata.grid.crs_wkt.clone(),
            bounds: metadata.bounds,
            unit: request.measure.unit(request.response.unit()),
            description: brightness_shows(
                request.measure,
                request.light,
                request.cloud_base_m,
                &request.response,
            ),
            colour_range: request.measure.colour_range(&request.response),
            attribution: metadata.attribution.clone(),
            date: metadata.date.clone(),
            assumptions: BrightnessAssumptions::of_scene(request, metadata, lattice.step, facts),
            content: brightness_content(request, view.version(), facts)?,
            atlas_key: atlas_key(request, view.version(), facts)?,
        })
    }
}

/// The places of a request's map within bounds; None where there are none.
///
/// * `bounds`: west, south, east, north, degrees; west of east beyond the antimeridian.
pub fn window_within(request: &BrightnessRequest, view: &SceneView, bounds: [f64; 4]) -> Option<PlaceWindow> {
    let scene = view.scene();
    scene.places_within(scene.place_lattice(request.max_places), bounds)
}

/// Whether so many places may be found at a time.
///
/// # Errors
/// [`AppError::Parameters`] where there are more than [`MAX_MAP_PLACES`].
pub fn check_part(places: usize) -> Result<(), AppError> {
    if places <= MAX_MAP_PLACES as usize {
        return Ok(());
    }
    Err(AppError::parameter(
        "bounds",
        format!("{places} places"),
        format!("{MAX_MAP_PLACES} places at most"),
        "that is too much for one time: make the map part by part, or of fewer places".to_owned(),
        ValidationCode::OutOfRange,
    ))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What is too much for one time is refused, and the words say what to do.
    #[test]
    fn a_part_has_an_end() {
        check_part(MAX_MAP_PLACES as usize).unwrap();
        let refused = check_part(86_400 * 33_600).unwrap_err().detail();
        assert!(
            refused.contains("bounds=2903040000 places") && refused.contains("part by part"),
            "{refused}"
        );
    }
}
