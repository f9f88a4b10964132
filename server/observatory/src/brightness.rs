//! How bright the sky is at every place of a scene, by default at the zenith: the layer that the public knows from the World Atlas.

use crate::{
    brightness_request::{BrightnessRequest, EYE_HEIGHT_M, MapLight},
    coarse_places::MAX_WHOLE_PLACES,
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
use skyglow_scene::{
    Observers, PatchStore, PlaceLattice, PlaceValues, PlaceWindow, RasterTile, Scene, SceneMetadata, SumWay,
};
use skyglow_tables::clouds::ceiling_m;
use std::{
    sync::Arc,
    time::{Duration, Instant},
};

/// Most places of a map: more pixels share one by blocks.
pub const MAX_PLACES: usize = 1_200_000;

/// What the response of a request sees of its light, by the request's measure and in its unit, at places all over a scene or in a part
/// of it.
#[derive(Clone, Debug)]
pub struct BrightnessMap {
    scene: Arc<Scene>,
    places: PlaceValues,
    /// What of the sky.
    pub measure: MapMeasure,
    /// Which light.
    pub light: MapLight,
    /// Base of the clouds, metres above sea level; None under a clear sky.
    pub cloud_base_m: Option<u32>,
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

    /// The same without the map.
    pub fn into_places(self) -> PlaceValues {
        self.places
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
            prepared.find_here(self, None, store)
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
        let observers_m = self.eye_range_m(&scene, request, lattice);
        clock.step("ground");
        let kernels =
            self.kernels(&scene, request, (lattice, observers_m), way, &mut |name| clock.step(name))?;
        Ok(PreparedBrightness {
            scene,
            lattice,
            observers_m,
            kernels,
            request: request.clone(),
            steps: clock.steps,
        })
    }

    /// Lowest and highest altitude of an eye over the places of a lattice, metres; None where nobody can be. Of a lattice too large to
    /// be looked at as a whole those that there can be, so that no part of a map depends on which part it is.
    fn eye_range_m(
        &self,
        scene: &Scene,
        request: &BrightnessRequest,
        lattice: PlaceLattice,
    ) -> Option<[f32; 2]> {
        if lattice.len() <= MAX_WHOLE_PLACES {
            return self.observers(scene, request, lattice, lattice.whole()).altitude_range_m();
        }
        let lowest_m = self.eye_m(request, 0.0);
        let [_, highest_m] = self.eye_limits_m(request);
        let highest_m = if scene.metadata().terrain { highest_m } else { lowest_m };
        lowest_m.is_finite().then_some([lowest_m, highest_m])
    }

    /// Eyes at the places of a window.
    fn observers(
        &self,
        scene: &Scene,
        request: &BrightnessRequest,
        lattice: PlaceLattice,
        window: PlaceWindow,
    ) -> Observers {
        let ground_m = scene.ground_altitudes_m(lattice.part(&window));
        let altitudes_m = ground_m.into_iter().map(|ground_m| self.eye_m(request, ground_m)).collect();
        Observers { lattice, window, altitudes_m }
    }

    /// Altitude of an eye at a place of a lattice, metres; NaN where nobody can be.
    pub(crate) fn eye_at(
        &self,
        scene: &Scene,
        request: &BrightnessRequest,
        lattice: PlaceLattice,
        [column, row]: [u32; 2],
    ) -> f32 {
        let place = PlaceWindow { columns: column..column + 1, rows: row..row + 1 };
        self.observers(scene, request, lattice, place).altitudes_m.first().copied().unwrap_or(f32::NAN)
    }

    /// Lowest and highest altitude of an eye, metres, that the packs reach: under clouds a hundred metres below their base.
    fn eye_limits_m(&self, request: &BrightnessRequest) -> [f32; 2] {
        let [lowest_m, highest_m] = self.engine.info().altitude_range_m;
        let below_clouds_m =
            request.cloud_base_m.map_or(f64::INFINITY, |base_m| ceiling_m(f64::from(base_m)));
        [lowest_m, highest_m.min(below_clouds_m)].map(|limit_m| limit_m as f32)
    }

    /// Altitude of an eye over the ground, metres, as the packs reach it; NaN where it is higher.
    pub(crate) fn eye_m(&self, request: &BrightnessRequest, ground_m: f32) -> f32 {
        let [lowest_m, highest_m] = self.eye_limits_m(request);
        let eye_m = ground_m + EYE_HEIGHT_M as f32;
        if eye_m <= highest_m { eye_m.max(lowest_m) } else { f32::NAN }
    }

    /// What is seen under an open sky at the places of a lattice; NaN where the altitude is.
    ///
    /// * `observers`: at all of its places.
    ///
    /// # Errors
    /// As [`Self::brightness_in`].
    pub(crate) fn seen_at(
        &self,
        scene: &Scene,
        request: &BrightnessRequest,
        observers: &Observers,
        store: &dyn PatchStore,
        step: &mut dyn FnMut(&'static str),
    ) -> Result<Vec<f32>, ObservatoryError> {
        let range = (observers.lattice, observers.altitude_range_m());
        let sums = self.kernels(scene, request, range, None, step)?.sums(scene, observers, store, step)?;
        Ok(under_open_sky(request.measure, &sums))
    }
}

/// A map of which any part can be found: what the parts have in common. It takes as little memory for a planet as for a town.
#[derive(Debug)]
pub struct PreparedBrightness {
    scene: Arc<Scene>,
    lattice: PlaceLattice,
    /// Lowest and highest altitude of the eye over all of the lattice, metres; None where nobody can be.
    observers_m: Option<[f32; 2]>,
    kernels: Kernels,
    request: BrightnessRequest,
    steps: Vec<(&'static str, Duration)>,
}

impl PreparedBrightness {
    /// A part of the map; as [`Observatory::brightness_in`].
    ///
    /// * `observatory`: that prepared it.
    /// * `window`: which places, of its lattice; None for all.
    ///
    /// # Errors
    /// As [`Observatory::brightness_in`].
    pub fn find(
        &self,
        observatory: &Observatory,
        window: Option<&PlaceWindow>,
        store: &dyn PatchStore,
    ) -> Result<BrightnessMap, ObservatoryError> {
        on_own_threads(|| self.find_here(observatory, window, store))
    }

    /// The places of the whole map.
    pub fn lattice(&self) -> PlaceLattice {
        self.lattice
    }

    fn find_here(
        &self,
        observatory: &Observatory,
        window: Option<&PlaceWindow>,
        store: &dyn PatchStore,
    ) -> Result<BrightnessMap, ObservatoryError> {
        let mut clock = Clock::new(self.steps.clone());
        let window = window.cloned().unwrap_or_else(|| self.lattice.whole());
        let found: Result<Vec<Vec<f32>>, ObservatoryError> = (window.pieces(self.lattice).into_iter())
            .map(|piece| self.values(observatory, piece, store, &mut clock))
            .collect();
        let values = side_by_side(found?, window.rows.len());
        let places = PlaceValues::new(self.lattice.part(&window), values).ok_or(RenderError::Ended)?;
        Ok(BrightnessMap {
            scene: Arc::clone(&self.scene),
            places,
            measure: self.request.measure,
            light: self.request.light,
            cloud_base_m: self.request.cloud_base_m,
            response: self.request.response.clone(),
            steps: clock.steps,
        })
    }

    /// The values at the places of a window without columns beyond the last.
    fn values(
        &self,
        observatory: &Observatory,
        window: PlaceWindow,
        store: &dyn PatchStore,
        clock: &mut Clock,
    ) -> Result<Vec<f32>, ObservatoryError> {
        let Self { scene, lattice, request, .. } = self;
        let summed = scene.summed_window(*lattice, &window, self.kernels.way());
        let observers = observatory.observers(scene, request, *lattice, summed);
        clock.step("ground");
        let wanted = OfWindow { store, window: &window };
        let sums = self.kernels.sums(scene, &observers, &wanted, &mut |name| clock.step(name))?;
        let mut sums: Vec<Vec<f32>> =
            sums.into_iter().map(|sums| window.cut(sums, &observers.window)).collect();
        let altitudes_m = window.cut(observers.altitudes_m, &observers.window);
        let observers = Observers { lattice: *lattice, window, altitudes_m };
        let places = (*lattice, &observers.window);
        let natural = NaturalPlaces::new(observatory, scene, request, places, self.observers_m)?;
        if natural.is_some() {
            clock.step("natural sky");
        }
        Ok(match request.measure {
            MapMeasure::Slope if request.terrain_hides && scene.metadata().terrain => {
                let slopes = SlopeLight::new(observatory, scene, request, places)?;
                clock.step("low sky");
                let values = slopes.values(scene, &observers, &sums, natural.as_ref());
                clock.step("horizons");
                values
            }
            measure => {
                if let Some(natural) = &natural {
                    add_natural(natural, &observers, &mut sums);
                }
                under_open_sky(measure, &sums)
            }
        })
    }
}

/// Rows of values of windows that lie side by side, as those of one.
fn side_by_side(mut pieces: Vec<Vec<f32>>, rows: usize) -> Vec<f32> {
    match pieces.len() {
        1 => pieces.swap_remove(0),
        _ => {
            let row = |piece: &Vec<f32>, row: usize| {
                let across = piece.len() / rows;
                piece[row * across..(row + 1) * across].to_vec()
            };
            (0..rows)
                .flat_map(|at| pieces.iter().flat_map(move |piece| row(piece, at)).collect::<Vec<f32>>())
                .collect()
        }
    }
}

/// Adds the natural sky to sums under an open sky.
fn add_natural(natural: &NaturalPlaces, observers: &Observers, sums: &mut [Vec<f32>]) {
    let of_places: Vec<Vec<f64>> = (observers.altitudes_m.par_iter().enumerate())
        .map(|(index, eye_m)| natural.sums_at(observers.window.place(index), f64::from(*eye_m)))
        .collect();
    for (number, sums) in sums.iter_mut().enumerate() {
        for (sum, of_place) in sums.iter_mut().zip(&of_places) {
            *sum += of_place.get(number).copied().unwrap_or_default() as f32;
        }
    }
}

/// A store of patches, of which only those with places of a window are found.
struct OfWindow<'a> {
    store: &'a dyn PatchStore,
    window: &'a PlaceWindow,
}

impl PatchStore for OfWindow<'_> {
    fn load(&self, patch: u64, count: usize) -> Option<Vec<f32>> {
        self.store.load(patch, count)
    }

    fn store(&self, patch: u64, sums: &[f32], progress: f64) -> bool {
        self.store.store(patch, sums, progress)
    }

    fn wants(&self, places: &PlaceWindow) -> bool {
        self.window.overlaps(places) && self.store.wants(places)
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
