//! Parts of a map of brightness as numbers: what a worker needs that makes its share of a map.

use crate::answers::{Answers, problem};
use serde::Serialize;
use skyglow_app::{
    AppError,
    fingerprint::brightness_content,
    map_part::{MapFrame, check_part, window_within},
    problem::LineError,
    request::{self, scene_id},
    validation::ValidationCode,
};
use skyglow_observatory::{BrightnessRequest, PreparedBrightness, SceneView, Watch};
use skyglow_scene::PlaceWindow;
use std::{
    ops::Range,
    sync::{Arc, PoisonError},
};

/// Which map.
#[derive(Clone, Copy, Debug)]
pub struct MapQuestion<'a> {
    /// The scene's id.
    pub scene: &'a str,
    /// The parameters of `layers/brightness.tif`, percent-encoded.
    pub query: &'a str,
    /// Places at most: where the scene has more pixels, blocks of them share one.
    pub places: u32,
}

/// What a map will be, and its places within bounds.
#[derive(Clone, Debug, Serialize)]
struct BoundedFrame {
    #[serde(flatten)]
    frame: MapFrame,
    /// None where bounds were asked for and no place lies there.
    window: Option<Window>,
}

/// First and one beyond the last.
#[derive(Clone, Debug, Serialize)]
struct Window {
    columns: [u32; 2],
    rows: [u32; 2],
}

impl From<PlaceWindow> for Window {
    fn from(window: PlaceWindow) -> Self {
        let ends = |range: Range<u32>| [range.start, range.end];
        Self { columns: ends(window.columns), rows: ends(window.rows) }
    }
}

impl Answers {
    /// What a map will be, as JSON; nothing of it is found.
    ///
    /// * `bounds`: west, south, east, north, degrees: which places are named as its window; None for all.
    ///
    /// # Errors
    /// Why there is none.
    pub fn map_frame(
        &self,
        question: &MapQuestion<'_>,
        bounds: Option<[f64; 4]>,
    ) -> Result<String, Box<LineError>> {
        let frame = || {
            let (request, view) = self.map(question)?;
            let frame = MapFrame::new(&request, &view, self.source.facts())?;
            let all = PlaceWindow { columns: 0..frame.columns, rows: 0..frame.rows };
            let window = bounds.map_or(Some(all), |bounds| window_within(&request, &view, bounds));
            let window = window.map(Window::from);
            serde_json::to_string(&BoundedFrame { frame, window }).map_err(AppError::internal)
        };
        frame().map_err(|error: AppError| Box::new(problem(&error)))
    }

    /// The numbers of a part of a map, row by row from the north; NaN where there is none.
    ///
    /// * `watch`: is told how far it is, and may end it.
    ///
    /// # Errors
    /// Why there are none.
    pub fn map_part(
        &self,
        question: &MapQuestion<'_>,
        window: &PlaceWindow,
        watch: &Watch<'_>,
    ) -> Result<Vec<f32>, Box<LineError>> {
        let part = || {
            let (request, view) = self.map(question)?;
            let prepared = self.prepared(&request, &view)?;
            let lattice = prepared.lattice();
            if !window.pieces(lattice).iter().all(|piece| piece.is_within(lattice)) {
                return Err(AppError::parameter(
                    "window",
                    format!("columns {:?}, rows {:?}", window.columns, window.rows),
                    format!("within {} columns and {} rows", lattice.columns, lattice.rows),
                    "the map has no such places".to_owned(),
                    ValidationCode::OutOfRange,
                ));
            }
            check_part(window.count())?;
            let part = self.source.brightness_part(&prepared, Some(window), &|done| watch(done))?;
            Ok(part.places().values().to_vec())
        };
        part().map_err(|error: AppError| Box::new(problem(&error)))
    }

    /// What the parts of a map have in common: that of the last map is kept, for they are asked for one after the other.
    fn prepared(
        &self,
        request: &BrightnessRequest,
        view: &SceneView,
    ) -> Result<Arc<PreparedBrightness>, AppError> {
        let content = brightness_content(request, view.version(), self.source.facts())?;
        let mut kept = self.last_map.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some((of, prepared)) = &*kept
            && *of == content
        {
            return Ok(Arc::clone(prepared));
        }
        // Two at a time would take twice the memory.
        *kept = None;
        let prepared = Arc::new(self.source.prepare_brightness(request, view)?);
        *kept = Some((content, Arc::clone(&prepared)));
        Ok(prepared)
    }

    fn map(&self, question: &MapQuestion<'_>) -> Result<(BrightnessRequest, SceneView), AppError> {
        let MapQuestion { scene, query, places } = *question;
        if places == 0 {
            return Err(AppError::parameter(
                "places",
                places.to_string(),
                format!("1 to {}", u32::MAX),
                "a map has no such number of places".to_owned(),
                ValidationCode::OutOfRange,
            ));
        }
        let request = request::brightness(Some(query), scene_id(scene)?, self.source.facts())?;
        let request = BrightnessRequest { max_places: places as usize, ..request };
        let view = self.source.view(&request.scene, request.scenario.as_ref())?;
        Ok((request, view))
    }
}
