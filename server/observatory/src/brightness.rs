//! How bright the sky is at every place of a scene, by default at the zenith: the layer that the public knows from the World Atlas.

use crate::{
    brightness_request::{BrightnessRequest, EYE_HEIGHT_M, MapLight},
    error::ObservatoryError,
    map_measure::MapMeasure,
    natural_places::NaturalPlaces,
    observatory::Observatory,
    place_sums::Kernels,
    scene_view::SceneView,
    slope_light::SlopeLight,
};
use rayon::prelude::*;
use skyglow_physics::{GeoPoint, Response};
use skyglow_render::RenderError;
use skyglow_scene::{PatchStore, PlaceLattice, PlaceValues, RasterTile, Scene, SceneMetadata, SumWay};
use std::{
    sync::Arc,
    time::{Duration, Instant},
};

/// Most places of a map: more pixels share one by blocks.
pub const MAX_PLACES: usize = 1_200_000;

/// What the response of a request sees of its light, by the request's measure and in its unit, at places all over a scene.
#[derive(Clone, Debug)]
pub struct BrightnessMap {
    scene: Arc<Scene>,
    places: PlaceValues,
    /// What of the sky.
    pub measure: MapMeasure,
    /// Which light.
    pub light: MapLight,
    /// What sees the sky.
    pub response: Response,
    /// How long each step took.
    pub steps: Vec<(&'static str, Duration)>,
}

impl BrightnessMap {
    /// The scene as it was.
    pub fn scene(&self) -> &SceneMetadata {
        self.scene.metadata()
    }

    /// The scene, open.
    pub fn open_scene(&self) -> &Scene {
        &self.scene
    }

    /// What is seen at the places, in the unit of [`Self::unit`]; NaN where the ground is higher than the packs reach.
    pub fn places(&self) -> &PlaceValues {
        &self.places
    }

    /// The unit of its numbers, in ASCII.
    pub fn unit(&self) -> String {
        self.measure.unit(self.response.unit())
    }

    /// Ends of its colours: [`MapMeasure::colour_range`].
    pub fn colour_range(&self) -> (f64, f64) {
        self.measure.colour_range(&self.response)
    }

    /// A map tile.
    ///
    /// # Errors
    /// [`ObservatoryError::Scene`] for a tile that does not exist.
    pub fn tile(&self, (z, x, y): (u8, u32, u32), size_px: u32) -> Result<RasterTile, ObservatoryError> {
        Ok(self.scene.places_tile(&self.places, z, x, y, size_px)?)
    }

    /// The value at any place, the mean over a width in metres; None where there is none.
    pub fn at(&self, place: GeoPoint, width_m: f64) -> Option<f64> {
        self.scene.value_at(&self.places, place, width_m)
    }

    /// Bytes that a cache stores with it, those of a changed scene's own lights among them; the scene itself is stored elsewhere.
    pub fn byte_count(&self) -> usize {
        self.places.byte_count() + self.scene.unshared_bytes()
    }
}

impl Observatory {
    /// [`Self::brightness_in`] of the scene as it is now.
    ///
    /// # Errors
    /// As [`Self::view`] and [`Self::brightness_in`].
    pub fn brightness(
        &self,
        request: &BrightnessRequest,
        store: &dyn PatchStore,
    ) -> Result<BrightnessMap, ObservatoryError> {
        self.brightness_in(&self.view(&request.scene, request.scenario.as_ref())?, request, store)
    }

    /// How bright the sky is at every place of a scene: the sum over its lights of what the packs say each does to it, found
    /// on the processor. Seconds to a minute of all cores. Not for asynchronous threads.
    ///
    /// Of the places' panoramas it differs by what far light taken together and tables between altitudes make of it: 0.1 % in the
    /// median. Between the packs' turbidities the logarithms of the sums are blended.
    ///
    /// * `store`: as in [`Scene::sum_at_places`]; the patches of a pack after the first have numbers of their own.
    ///
    /// # Errors
    /// As [`Self::sky`]; [`RenderError::Ended`] where the store cancelled it.
    pub fn brightness_in(
        &self,
        view: &SceneView,
        request: &BrightnessRequest,
        store: &dyn PatchStore,
    ) -> Result<BrightnessMap, ObservatoryError> {
        self.brightness_by(view, request, None, store)
    }

    /// The same, summed in a given way; None takes what [`Scene::way_to_sum`] says.
    ///
    /// # Errors
    /// As [`Self::brightness_in`].
    pub fn brightness_by(
        &self,
        view: &SceneView,
        request: &BrightnessRequest,
        way: Option<SumWay>,
        store: &dyn PatchStore,
    ) -> Result<BrightnessMap, ObservatoryError> {
        on_own_threads(|| {
            let prepared = self.prepare(view, request, way)?;
            prepared.find_here(store)
        })
    }

    /// What all parts of a map have in common, for whoever finds them one after the other. Takes seconds of all cores.
    ///
    /// # Errors
    /// As [`Self::brightness_in`].
    pub fn prepare_brightness(
        &self,
        view: &SceneView,
        request: &BrightnessRequest,
    ) -> Result<PreparedBrightness, ObservatoryError> {
        on_own_threads(|| self.prepare(view, request, None))
    }

    fn prepare(
        &self,
        view: &SceneView,
        request: &BrightnessRequest,
        way: Option<SumWay>,
    ) -> Result<PreparedBrightness, ObservatoryError> {
        let mut clock = Clock::new(Vec::new());
        let scene = Arc::clone(view.scene());
        let lattice = scene.place_lattice(request.max_places);
        let altitudes_m: Vec<f32> =
            scene.ground_altitudes_m(lattice).into_iter().map(|ground_m| self.eye_m(ground_m)).collect();
        clock.step("ground");
        let places = (lattice, &altitudes_m[..]);
        let kernels = self.kernels(&scene, request, places, way, &mut |name| clock.step(name))?;
        let slopes = match request.measure {
            MapMeasure::Slope if request.terrain_hides && scene.metadata().terrain => {
                let slopes = SlopeLight::new(self, &scene, request, places)?;
                clock.step("low sky");
                Some(slopes)
            }
            _ => None,
        };
        let natural = NaturalPlaces::new(self, &scene, request, places)?;
        if natural.is_some() {
            clock.step("natural sky");
        }
        Ok(PreparedBrightness {
            scene,
            lattice,
            altitudes_m,
            kernels,
            slopes,
            natural,
            measure: request.measure,
            light: request.light,
            response: request.response.clone(),
            steps: clock.steps,
        })
    }

    /// Altitude of an eye over the ground, metres, as the packs reach it; NaN where it is higher.
    pub(crate) fn eye_m(&self, ground_m: f32) -> f32 {
        let [lowest_m, highest_m] = self.engine.info().altitude_range_m;
        let eye_m = ground_m + EYE_HEIGHT_M as f32;
        if eye_m <= highest_m as f32 { eye_m.max(lowest_m as f32) } else { f32::NAN }
    }

    /// What is seen under an open sky at the places of a lattice; NaN where the altitude is.
    ///
    /// * `places`: a lattice, and the altitude of the eye at each of its places, metres.
    ///
    /// # Errors
    /// As [`Self::brightness_in`].
    pub(crate) fn seen_at(
        &self,
        scene: &Scene,
        request: &BrightnessRequest,
        places: (PlaceLattice, &[f32]),
        store: &dyn PatchStore,
        step: &mut dyn FnMut(&'static str),
    ) -> Result<Vec<f32>, ObservatoryError> {
        let sums = self.kernels(scene, request, places, None, step)?.sums(scene, places, store, step)?;
        Ok(under_open_sky(request.measure, &sums))
    }
}

/// A map of which any part can be found: what the parts have in common.
#[derive(Debug)]
pub struct PreparedBrightness {
    scene: Arc<Scene>,
    lattice: PlaceLattice,
    /// Of the eye at every place, metres.
    altitudes_m: Vec<f32>,
    kernels: Kernels,
    /// Of maps of sloping ground where there is terrain.
    slopes: Option<SlopeLight>,
    natural: Option<NaturalPlaces>,
    measure: MapMeasure,
    light: MapLight,
    response: Response,
    steps: Vec<(&'static str, Duration)>,
}

impl PreparedBrightness {
    /// The map, as far as `store` wants it; as [`Observatory::brightness_in`].
    ///
    /// # Errors
    /// [`RenderError::Ended`] where the store cancelled it.
    pub fn find(&self, store: &dyn PatchStore) -> Result<BrightnessMap, ObservatoryError> {
        on_own_threads(|| self.find_here(store))
    }

    /// Its places.
    pub fn lattice(&self) -> PlaceLattice {
        self.lattice
    }

    fn find_here(&self, store: &dyn PatchStore) -> Result<BrightnessMap, ObservatoryError> {
        let mut clock = Clock::new(self.steps.clone());
        let places = (self.lattice, &self.altitudes_m[..]);
        let mut sums = self.kernels.sums(&self.scene, places, store, &mut |name| clock.step(name))?;
        let values = match &self.slopes {
            None => {
                self.add_natural(&mut sums);
                under_open_sky(self.measure, &sums)
            }
            Some(slopes) => {
                let values = slopes.values(&self.scene, places, &sums, self.natural.as_ref());
                clock.step("horizons");
                values
            }
        };
        Ok(BrightnessMap {
            scene: Arc::clone(&self.scene),
            places: PlaceValues::new(self.lattice, values).ok_or(RenderError::Ended)?,
            measure: self.measure,
            light: self.light,
            response: self.response.clone(),
            steps: clock.steps,
        })
    }

    /// Adds the natural sky to sums under an open sky.
    fn add_natural(&self, sums: &mut [Vec<f32>]) {
        let Some(natural) = &self.natural else { return };
        let columns = self.lattice.columns as usize;
        let at = |index: usize| [(index % columns) as u32, (index / columns) as u32];
        let of_places: Vec<Vec<f64>> = (self.altitudes_m.par_iter().enumerate())
            .map(|(index, eye_m)| natural.sums_at(at(index), f64::from(*eye_m)))
            .collect();
        for (number, sums) in sums.iter_mut().enumerate() {
            for (sum, of_place) in sums.iter_mut().zip(&of_places) {
                *sum += of_place.get(number).copied().unwrap_or_default() as f32;
            }
        }
    }
}

/// The values of a measure from its sums at places.
fn under_open_sky(measure: MapMeasure, sums: &[Vec<f32>]) -> Vec<f32> {
    let count = sums.first().map_or(0, Vec::len);
    let of_place = |place: usize| {
        let of_place: Vec<f32> = sums.iter().map(|sums| sums[place]).collect();
        measure.of_sums(&of_place)
    };
    (0..count).into_par_iter().map(of_place).collect()
}

/// How long each step takes.
struct Clock {
    steps: Vec<(&'static str, Duration)>,
    begun: Instant,
}

impl Clock {
    fn new(steps: Vec<(&'static str, Duration)>) -> Self {
        Self { steps, begun: Instant::now() }
    }

    fn step(&mut self, name: &'static str) {
        self.steps.push((name, self.begun.elapsed()));
        self.begun = Instant::now();
    }
}

/// Does work in threads of its own: in those that skies are rendered by, skies would wait until a map is found.
fn on_own_threads<T: Send>(work: impl FnOnce() -> T + Send) -> T {
    let cores = std::thread::available_parallelism().map_or(1, std::num::NonZero::get);
    match rayon::ThreadPoolBuilder::new().num_threads(cores).build() {
        Ok(threads) => threads.install(work),
        Err(_) => work(),
    }
}
