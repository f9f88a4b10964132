//! Parts of a map of brightness: the places of a window, with the numbers of the whole map there, bit for bit.

use crate::{
    answers::{BrightnessAssumptions, brightness_shows},
    error::AppError,
    facts::SourceFacts,
    fingerprint::brightness_content,
};
use serde::Serialize;
use skyglow_observatory::{BrightnessMap, BrightnessRequest, PreparedBrightness, SceneView};
use skyglow_scene::{PatchStore, PlaceValues, PlaceWindow};

/// Most places of a map.
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
            description: brightness_shows(request.measure, request.light, &request.response),
            colour_range: request.measure.colour_range(&request.response),
            attribution: metadata.attribution.clone(),
            date: metadata.date.clone(),
            assumptions: BrightnessAssumptions::of_scene(request, metadata, lattice.step, facts),
            content: brightness_content(request, view.version(), facts)?,
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

/// Finds a part of a map: the map, in which only places near the window have numbers, and the numbers of the window.
///
/// * `window`: None for all places.
/// * `store`: as in [`SkySource::brightness`](crate::SkySource::brightness).
///
/// # Errors
/// [`AppError::EngineDown`] where the store cancelled it; [`AppError::Internal`] for a window beyond the map.
pub fn brightness_part(
    prepared: &PreparedBrightness,
    window: Option<&PlaceWindow>,
    store: &dyn PatchStore,
) -> Result<(BrightnessMap, PlaceValues), AppError> {
    let map = prepared.find(&OfWindow { store, window })?;
    let part = part_within(map.places(), window)?;
    Ok((map, part))
}

/// The part of a map that is wanted; all of it where no window says which.
///
/// # Errors
/// [`AppError::Internal`] for a window beyond the map.
pub fn part_within(places: &PlaceValues, window: Option<&PlaceWindow>) -> Result<PlaceValues, AppError> {
    let part = window.map_or_else(|| Some(places.clone()), |window| places.part(window));
    part.ok_or_else(|| AppError::internal("a window beyond its map"))
}

/// A store of patches, of which only those with places of a window are found.
struct OfWindow<'a> {
    store: &'a dyn PatchStore,
    window: Option<&'a PlaceWindow>,
}

impl PatchStore for OfWindow<'_> {
    fn load(&self, patch: u64, count: usize) -> Option<Vec<f32>> {
        self.store.load(patch, count)
    }

    fn store(&self, patch: u64, sums: &[f32], progress: f64) -> bool {
        self.store.store(patch, sums, progress)
    }

    fn wants(&self, places: &PlaceWindow) -> bool {
        self.window.is_none_or(|window| window.overlaps(places)) && self.store.wants(places)
    }
}
