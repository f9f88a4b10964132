//! How bright the sky is at every place of a scene, by default at the zenith: the layer that the public knows from the World Atlas.

use crate::{
    error::ObservatoryError,
    influence::{KernelRange, place_kernel},
    map_measure::MapMeasure,
    observatory::Observatory,
    scene_view::SceneView,
};
use serde::Serialize;
use skyglow_physics::{BAND_COUNT, Emission, GeoPoint, Horizon, Lamp, Response, Turbidity};
use skyglow_render::RenderError;
use skyglow_render::{pack_kind::PackKind, prepare::Prepared, request::RenderRequest};
use skyglow_scene::{
    ChangeId, PatchStore, PlaceKernel, PlaceLattice, PlaceValues, PlaceWindow, PolarGrid, RasterTile, Scene,
    SceneId, SceneMetadata, SumWay,
};
use skyglow_tables::Scattering;
use std::{
    sync::Arc,
    time::{Duration, Instant},
};

/// The observer's eye above the ground, metres.
pub const EYE_HEIGHT_M: f64 = 2.0;
/// Most places of a map: more pixels share one by blocks.
pub const MAX_PLACES: usize = 1_200_000;

/// A request for one map of brightness: under a clear sky, two metres above the ground.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct BrightnessRequest {
    /// The scene.
    pub scene: SceneId,
    /// The scenario or plan that changes its lights; None for the scene as it is.
    pub scenario: Option<ChangeId>,
    /// Turbidity, in the resident range.
    pub turbidity: Turbidity,
    /// Orders of scattering, of which packs are resident.
    pub scattering: Scattering,
    /// The lamp.
    pub lamp: Lamp,
    /// What of the sky.
    pub measure: MapMeasure,
    /// What sees the sky.
    pub response: Response,
    /// Where lamps send their light, and what of them the satellite's radiance says.
    pub emission: Emission,
    /// Whether terrain hides the low light of lamps behind it.
    pub terrain_hides: bool,
    /// Places at most; beyond, pixels share one by blocks.
    pub max_places: usize,
}

impl BrightnessRequest {
    fn kind(&self) -> PackKind {
        PackKind { cloud_base_m: None, scattering: self.scattering }
    }
}

/// What the response of a request sees of artificial light, by the request's measure and in its unit, at places all over a scene.
#[derive(Clone, Debug)]
pub struct BrightnessMap {
    scene: Arc<Scene>,
    places: PlaceValues,
    /// What of the sky.
    pub measure: MapMeasure,
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
        let (measure, response) = (request.measure, request.response.clone());
        Ok(PreparedBrightness { scene, lattice, altitudes_m, kernels, measure, response, steps: clock.steps })
    }

    /// Altitude of an eye over the ground, metres, as the packs reach it; NaN where it is higher.
    pub(crate) fn eye_m(&self, ground_m: f32) -> f32 {
        let [lowest_m, highest_m] = self.engine.info().altitude_range_m;
        let eye_m = ground_m + EYE_HEIGHT_M as f32;
        if eye_m <= highest_m as f32 { eye_m.max(lowest_m as f32) } else { f32::NAN }
    }

    /// What is seen at the places of a lattice; NaN where the altitude is.
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
        self.kernels(scene, request, places, None, step)?.sums(scene, places, store, step)
    }

    /// What the packs say each light does to places of a lattice.
    fn kernels(
        &self,
        scene: &Scene,
        request: &BrightnessRequest,
        (lattice, altitudes_m): (PlaceLattice, &[f32]),
        way: Option<SumWay>,
        step: &mut dyn FnMut(&'static str),
    ) -> Result<Kernels, ObservatoryError> {
        let solver = self.influences.solver(&self.engine);
        let to_render = |turbidity: Turbidity| RenderRequest {
            polar: Arc::new(dark()),
            observer_altitude_m: 0.0,
            turbidity,
            scattering: request.scattering,
            cloud_base_m: None,
            emission: request.emission.mix(),
            flux_per_dnb_flux: [1.0; BAND_COUNT],
            basis: None,
        };
        let set = self.engine.table_set();
        let stencil = Prepared::new(&to_render(request.turbidity), &set)?.turbidity_stencil;
        let observers_m = altitudes_m.iter().filter(|m| !m.is_nan()).fold(None, |range, &altitude_m| {
            let [lowest, highest]: [f32; 2] = range.unwrap_or([altitude_m; 2]);
            Some([lowest.min(altitude_m), highest.max(altitude_m)])
        });
        let hides = request.terrain_hides && self.hides_lights(request.kind());
        let way = way.unwrap_or_else(|| scene.way_to_sum(lattice));
        let (Some(observers_m), Some(lights_m)) = (observers_m, scene.light_altitude_range_m()) else {
            return Ok(Kernels { of_packs: Vec::new(), weights: Vec::new(), hides, way });
        };
        let range =
            KernelRange { observers_m: observers_m.map(f64::from), lights_m: lights_m.map(f64::from) };
        let measure = request.measure.weights(&Horizon::flat());
        let mut of_packs: Vec<Vec<PlaceKernel>> = Vec::new();
        for pack in stencil.nodes() {
            let at_pack =
                to_render(Turbidity::new(set.tables()[pack].turbidity).unwrap_or(request.turbidity));
            let kernel = |fixture: &skyglow_physics::Fixture| {
                let (emission, flux_factor) =
                    request.emission.of_fixture(fixture).map_err(ObservatoryError::Emission)?;
                let flux_per_dnb_flux = [flux_factor; BAND_COUNT];
                let of_fixture = RenderRequest { emission, flux_per_dnb_flux, ..at_pack.clone() };
                let rule = fixture.light(&request.lamp).rule(&request.response);
                place_kernel(solver, &of_fixture, (&measure, &rule), &range, hides)
            };
            let kernels: Result<_, ObservatoryError> = scene.fixtures().iter().map(kernel).collect();
            of_packs.push(kernels?);
            step("kernel");
        }
        Ok(Kernels { of_packs, weights: stencil.weights().to_vec(), hides, way })
    }
}

/// What each light does to places, by the packs around the turbidity, and how lights are summed.
#[derive(Debug)]
struct Kernels {
    /// Of each kind of fixture, by pack; without packs there is no light, or no place.
    of_packs: Vec<Vec<PlaceKernel>>,
    weights: Vec<f64>,
    hides: bool,
    way: SumWay,
}

impl Kernels {
    /// As [`Observatory::seen_at`].
    fn sums(
        &self,
        scene: &Scene,
        (lattice, altitudes_m): (PlaceLattice, &[f32]),
        store: &dyn PatchStore,
        step: &mut dyn FnMut(&'static str),
    ) -> Result<Vec<f32>, ObservatoryError> {
        let mut of_packs: Vec<Vec<f32>> = Vec::new();
        for (pack, kernels) in self.of_packs.iter().enumerate() {
            let of_pack = OfPack { store, pack, packs: self.of_packs.len() };
            let sums = scene.sum_at_places(lattice, altitudes_m, kernels, self.hides, self.way, &of_pack);
            of_packs.push(sums.ok_or(RenderError::Ended)?);
            step("sums");
        }
        Ok(match of_packs.len() {
            0 => altitudes_m.iter().map(|altitude_m| altitude_m * 0.0).collect(),
            1 => of_packs.swap_remove(0),
            _ => blended(&of_packs, &self.weights),
        })
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
    measure: MapMeasure,
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
        let values = self.kernels.sums(&self.scene, places, store, &mut |name| clock.step(name))?;
        Ok(BrightnessMap {
            scene: Arc::clone(&self.scene),
            places: PlaceValues::new(self.lattice, values).ok_or(RenderError::Ended)?,
            measure: self.measure,
            response: self.response.clone(),
            steps: clock.steps,
        })
    }
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

/// The patches of one pack among several.
struct OfPack<'a> {
    store: &'a dyn PatchStore,
    pack: usize,
    packs: usize,
}

impl OfPack<'_> {
    fn number(&self, patch: u64) -> u64 {
        (self.pack as u64) << 48 | patch
    }
}

impl PatchStore for OfPack<'_> {
    fn load(&self, patch: u64, count: usize) -> Option<Vec<f32>> {
        self.store.load(self.number(patch), count)
    }

    fn store(&self, patch: u64, sums: &[f32], progress: f64) -> bool {
        self.store.store(self.number(patch), sums, (self.pack as f64 + progress) / self.packs as f64)
    }

    fn wants(&self, places: &PlaceWindow) -> bool {
        self.store.wants(places)
    }
}

/// The logarithms of what the packs say, with their weights; 0 where one says 0.
fn blended(of_packs: &[Vec<f32>], weights: &[f64]) -> Vec<f32> {
    let of_place = |place: usize| {
        let logs = of_packs.iter().zip(weights).map(|(sums, weight)| weight * f64::from(sums[place]).ln());
        let is_dark = of_packs.iter().any(|sums| sums[place] == 0.0);
        if is_dark { 0.0 } else { logs.sum::<f64>().exp() as f32 }
    };
    (0..of_packs[0].len()).map(of_place).collect()
}

/// A grid without light.
fn dark() -> PolarGrid {
    PolarGrid {
        observer: GeoPoint::from_rad_unchecked(0.0, 0.0),
        azimuth_start: vec![0; skyglow_scene::AZIMUTH_COLUMN_COUNT + 1],
        cells: Vec::new(),
        near: Vec::new(),
        flux_dnb_w: 0.0,
        coverage: 0.0,
    }
}
