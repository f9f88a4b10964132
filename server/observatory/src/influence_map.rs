//! From a place in a scene to what each of its lights does to the sky there.

use crate::{
    error::ObservatoryError,
    influence::{InfluenceSolver, MeasureOfCells, influence_of_pixels},
    influence_summary::Part,
    observatory::Observatory,
    scene_view::{View, scene_around},
    sky::{Observer, ObserverHeight, SkyRequest},
};
use moka::sync::Cache;
use rayon::prelude::*;
use skyglow_physics::{
    Atmosphere, BAND_COUNT, Horizon, LampPreset, LinearMeasure, SkyCurve, source_pixel::SPLIT_WITHIN_M,
};
use skyglow_render::{engine::Engine, request::RenderRequest};
use skyglow_scene::{LightShares, LitPixel, NearLight, PixelValues, RasterTile, Scene, SceneMetadata};
use std::{
    sync::{Arc, OnceLock},
    time::{Duration, Instant},
};

/// Bytes of light by cells and pixels that are kept for the next map from the same place.
const KEPT_LIGHT_BYTES: u64 = 256 << 20;

/// How long light around an eye is kept that nobody asks for.
const KEPT_WHILE_IDLE: Duration = Duration::from_secs(600);
/// Bytes that what is kept takes where there is no light: nothing weighs nothing.
const BYTES_AT_LEAST: usize = 8 << 10;

/// A measure of the sky that every light has a part in (`docs/model.md#influence`).
#[derive(Clone, Debug, PartialEq)]
pub enum Measure {
    /// ‖luminance image of the light alone‖ over the open upper hemisphere, cd m⁻² sr^½. Parts do not add up to that of the sky.
    Norm,
    /// Mean luminance within 5° of the zenith, cd m⁻².
    Zenith,
    /// Mean luminance of the visible sky, cd m⁻².
    Mean,
    /// Horizontal illuminance, lx.
    Horizontal,
    /// Mean luminance of the visible sky inside a closed curve, cd m⁻².
    Region(SkyCurve),
}

impl Measure {
    /// The weights of the directions; None for the norm, which is not linear.
    pub(crate) fn weights(&self, horizon: &Horizon) -> Option<LinearMeasure> {
        Some(match self {
            Measure::Norm => return None,
            Measure::Zenith => LinearMeasure::zenith(horizon),
            Measure::Mean => LinearMeasure::mean(horizon),
            Measure::Horizontal => LinearMeasure::horizontal(horizon),
            Measure::Region(curve) => LinearMeasure::region(curve, horizon),
        })
    }

    /// Its unit, in ASCII.
    pub const fn unit(&self) -> &'static str {
        match self {
            Measure::Norm => "cd m-2 sr0.5",
            Measure::Zenith | Measure::Mean | Measure::Region(_) => "cd m-2",
            Measure::Horizontal => "lx",
        }
    }
}

/// One map of influences asked for.
#[derive(Clone, Debug, PartialEq)]
pub struct InfluenceRequest {
    /// The sky that lights are to have their part in.
    pub sky: SkyRequest,
    /// What of it.
    pub measure: Measure,
}

/// What every lit pixel within 300 km does to a measure of the sky at a place.
#[derive(Clone, Debug)]
pub struct InfluenceMap {
    scene: Arc<Scene>,
    pixels: Arc<[LitPixel]>,
    influence: Vec<f32>,
    /// Made when the first map tile is asked for.
    sums: OnceLock<PixelValues>,
    /// What all of them do, and the influence shown brightest: both are asked for again and again.
    pub(crate) total: Part,
    pub(crate) brightest: OnceLock<f64>,
    /// Where.
    pub observer: Observer,
    /// Covered share of the 300 km disc, 0..=1.
    pub coverage: f64,
    /// Upward flux within 300 km, DNB watts, calibration included.
    pub flux_dnb_w: f64,
    /// Vertical optical depth above the observer in R, G, B.
    pub local_optical_depth: [f64; BAND_COUNT],
    /// Basis functions used.
    pub basis_count: usize,
    /// Where a tolerance was given, the bound of the difference to the sky of all functions.
    pub basis_error_bound: Option<f64>,
    /// Lamps that changes replace around here where there are none of them by then.
    pub lamps_not_met: Vec<LampPreset>,
    /// Solid angle of the grid's directions that a region holds, visible ones, sr; None for other measures.
    pub region_sr: Option<f64>,
    /// What influences were multiplied by to add up to the sky's own value: 1 but for what far light taken by blocks and cells
    /// at mean altitudes make of it.
    pub scale: f64,
    /// How long each step took.
    pub steps: Vec<(&'static str, Duration)>,
}

impl InfluenceMap {
    /// The scene as it was.
    pub fn scene(&self) -> &SceneMetadata {
        self.scene.metadata()
    }

    /// The scene, open.
    pub fn open_scene(&self) -> &Scene {
        &self.scene
    }

    pub(crate) fn shared_scene(&self) -> Arc<Scene> {
        Arc::clone(&self.scene)
    }

    /// The lit pixels within 300 km, ascending by their number. In a changed scene a pixel is there once for every kind of
    /// fixture in it.
    pub fn pixels(&self) -> &[LitPixel] {
        &self.pixels
    }

    /// What each of [`Self::pixels`] does, in the measure's unit. Where a dark direction hangs on rounding one may be below 0.
    pub fn influence(&self) -> &[f32] {
        &self.influence
    }

    /// A map tile of the mean influence of the pixels under a tile's pixel, dark ones counting 0.
    ///
    /// # Errors
    /// [`ObservatoryError::Scene`] for a tile that does not exist.
    pub fn tile(&self, (z, x, y): (u8, u32, u32), size_px: u32) -> Result<RasterTile, ObservatoryError> {
        let numbers = || self.pixels.iter().zip(&self.influence).map(|(pixel, value)| (pixel.number, *value));
        let sums = self.sums.get_or_init(|| PixelValues::new(numbers()));
        Ok(self.scene.pixels_tile(sums, z, x, y, size_px)?)
    }

    /// Bytes that a cache keeps with it; the scene is kept elsewhere.
    pub fn byte_count(&self) -> usize {
        let of_sums = PixelValues::BYTES_PER_PIXEL * self.pixels.len();
        BYTES_AT_LEAST + size_of_val(&*self.pixels) + size_of_val(self.influence.as_slice()) + of_sums
    }
}

/// What decides the light around an eye: scene and version, place, eye, and what hides it.
type SeenKey = (String, [u64; 3], [bool; 3]);

/// The light around an eye, the same for every measure, lamp and air.
#[derive(Clone)]
struct Seen {
    view: View,
    /// Beside the view's lights, each with every pixel by itself.
    shares: Arc<[LightShares]>,
}

/// What finding influences needs beside the engine.
pub(crate) struct InfluenceCache {
    solver: OnceLock<InfluenceSolver>,
    seen: Cache<SeenKey, Seen>,
}

impl std::fmt::Debug for InfluenceCache {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("InfluenceCache").field("seen", &self.seen.entry_count()).finish_non_exhaustive()
    }
}

impl InfluenceCache {
    pub(crate) fn new() -> Self {
        let weigh = |_: &SeenKey, seen: &Seen| {
            let of_grids = seen.view.lights.iter().map(|(_, polar)| polar.byte_count());
            let of_shares = seen.shares.iter().map(LightShares::byte_count);
            let bytes = BYTES_AT_LEAST + of_grids.chain(of_shares).sum::<usize>();
            u32::try_from(bytes).unwrap_or(u32::MAX)
        };
        Self {
            solver: OnceLock::new(),
            seen: Cache::builder()
                .max_capacity(KEPT_LIGHT_BYTES)
                .weigher(weigh)
                .time_to_idle(KEPT_WHILE_IDLE)
                .build(),
        }
    }

    /// Made when it is first asked for.
    pub(crate) fn solver(&self, engine: &Engine) -> &InfluenceSolver {
        self.solver.get_or_init(|| InfluenceSolver::new(engine.table_set()))
    }

    fn seen(&self, scene: &Arc<Scene>, request: &SkyRequest, hides_lights: bool) -> Seen {
        let place = request.place;
        let (is_above_sea, eye_m) = match request.observer_height {
            ObserverHeight::AboveGround(height_m) => (false, height_m),
            ObserverHeight::AboveSea(altitude_m) => (true, altitude_m),
        };
        let key = (
            scene.metadata().version.clone(),
            [place.latitude_rad().to_bits(), place.longitude_rad().to_bits(), eye_m.to_bits()],
            [is_above_sea, request.terrain_hides, hides_lights],
        );
        self.seen.get_with(key, || {
            let view = View::in_scene(Arc::clone(scene), request, hides_lights);
            let shares = scene.light_shares(place, request.terrain_hides && hides_lights);
            Seen { view, shares: shares.into_iter().map(|(_, shares)| shares).collect() }
        })
    }
}

impl Observatory {
    /// What every lit pixel does to a measure of a sky: found on the processor, without the engine's queue. Takes
    /// milliseconds to a second; reads files. Not for asynchronous threads.
    ///
    /// # Errors
    /// As [`Self::sky`], and [`ObservatoryError::EmptyRegion`].
    pub fn influence(&self, request: &InfluenceRequest) -> Result<InfluenceMap, ObservatoryError> {
        let sky = &request.sky;
        let mut steps = Vec::new();
        let mut clock = Instant::now();
        let mut step = |name: &'static str| {
            steps.push((name, clock.elapsed()));
            clock = Instant::now();
        };
        let scene = scene_around(&self.shelf, &sky.scene, sky.scenario.as_ref(), sky.place)?;
        let Seen { view, shares } = self.influences.seen(&scene, sky, self.hides_lights(sky.kind()));
        step("light");
        let (of_sky, basis_error_bound) = view.render_requests(sky, &self.engine.basis_chooser())?;
        let open = Horizon::default();
        let weights = request.measure.weights(view.horizon.as_ref().map_or(&open, |(horizon, _)| horizon));
        let is_region = matches!(request.measure, Measure::Region(_));
        if is_region && weights.as_ref().is_some_and(LinearMeasure::is_empty) {
            return Err(ObservatoryError::EmptyRegion);
        }
        let solver = self.influences.solver(&self.engine);
        let mut basis_count = 0;
        for part in &of_sky {
            basis_count = basis_count.max(solver.basis_count(part)?);
        }
        let of_cells = weights.as_ref().map_or(MeasureOfCells::Norm, MeasureOfCells::Linear);
        let mut parts = Vec::new();
        let (mut before_scaling, mut after_scaling) = (0.0, 0.0);
        for (of_sky, lights) in of_sky.iter().zip(shares.iter()) {
            // The sky takes far light by blocks; here every pixel is by itself, so that those of a cell are what it was made of.
            let of_pixels = RenderRequest { polar: Arc::clone(&lights.polar), ..of_sky.clone() };
            let found = solver.cells_in_sky(&of_pixels, of_sky, of_cells)?;
            step("cells");
            let (mut influence, scale) = influence_of_pixels(lights, &found.cells, found.of_sky);
            step("pixels");
            if request.measure == Measure::Norm {
                near_norms(solver, of_sky, lights, &mut influence)?;
                step("near pixels");
            }
            let value = found.of_sky.unwrap_or(0.0);
            (before_scaling, after_scaling) = (before_scaling + value / scale, after_scaling + value);
            if let Some(measure) = &weights {
                add_near_lights(solver, &of_pixels, of_sky, measure, lights, &mut influence)?;
                step("near lights");
            }
            parts.push((lights.shared_pixels(), influence));
        }
        let (pixels, influence) = together(parts);
        let total = Part::of_all(&pixels, &influence);
        step("total");
        Ok(InfluenceMap {
            observer: view.observer,
            coverage: view.coverage(),
            flux_dnb_w: view.flux_dnb_w(),
            local_optical_depth: Atmosphere::new(sky.turbidity)
                .vertical_optical_depth(view.observer.altitude_m),
            basis_count,
            basis_error_bound,
            lamps_not_met: view.lamps_not_met(&sky.lamp),
            region_sr: weights.filter(|_| is_region).map(|weights| weights.solid_angle_sr()),
            scene: Arc::clone(&view.scene),
            total,
            brightest: OnceLock::new(),
            pixels,
            influence,
            scale: if before_scaling > 0.0 { after_scaling / before_scaling } else { 1.0 },
            sums: OnceLock::new(),
            steps,
        })
    }
}

/// Adds what near lights do beyond what their cells have of them.
fn add_near_lights(
    solver: &InfluenceSolver,
    of_pixels: &RenderRequest,
    of_sky: &RenderRequest,
    measure: &LinearMeasure,
    lights: &LightShares,
    influence: &mut [f32],
) -> Result<(), ObservatoryError> {
    for (index, value) in solver.near_lights(of_pixels, of_sky, measure)? {
        // A block's is shared among its pixels as their flux is.
        let NearLight { number, pixel_count, .. } = of_sky.polar.near[index];
        let first = lights.pixels().partition_point(|pixel| pixel.number < number);
        let pixels = &lights.pixels()[first..];
        let pixels = &pixels[..pixels.partition_point(|pixel| pixel.number - number < pixel_count)];
        let flux_dnb_w: f32 = pixels.iter().map(|pixel| pixel.flux_dnb_w).sum();
        for (influence, pixel) in influence[first..].iter_mut().zip(pixels) {
            *influence += value as f32 * pixel.flux_dnb_w / flux_dnb_w;
        }
    }
    Ok(())
}

/// Lights of several kinds of fixtures as one list, ascending by number.
fn together(mut parts: Vec<(Arc<[LitPixel]>, Vec<f32>)>) -> (Arc<[LitPixel]>, Vec<f32>) {
    if parts.len() == 1
        && let Some(part) = parts.pop()
    {
        return part;
    }
    let lights =
        parts.iter().flat_map(|(pixels, influence)| pixels.iter().copied().zip(influence.iter().copied()));
    let mut lights: Vec<(LitPixel, f32)> = lights.collect();
    lights.sort_unstable_by_key(|(pixel, _)| pixel.number);
    let (pixels, influence): (Vec<LitPixel>, Vec<f32>) = lights.into_iter().unzip();
    (pixels.into(), influence)
}

/// Norms of the pixels that are wider than a point: those of their parts would add up to too much, for parts that shine on
/// different directions do not make each other brighter. Each is rendered alone.
fn near_norms(
    solver: &InfluenceSolver,
    sky: &RenderRequest,
    lights: &LightShares,
    influence: &mut [f32],
) -> Result<(), ObservatoryError> {
    let near: Vec<usize> = (lights.pixels().iter().enumerate())
        .filter(|(_, pixel)| f64::from(pixel.distance_m) <= SPLIT_WITHIN_M)
        .map(|(position, _)| position)
        .collect();
    let norm = |&position: &usize| {
        solver.norm(&RenderRequest { polar: Arc::new(lights.alone(position)), ..sky.clone() })
    };
    let norms: Vec<f64> = near.par_iter().map(norm).collect::<Result<_, _>>()?;
    for (position, norm) in near.into_iter().zip(norms) {
        influence[position] = norm as f32;
    }
    Ok(())
}
