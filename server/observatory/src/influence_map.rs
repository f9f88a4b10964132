//! From a place in a scene to what each of its lights does to the sky there.

use crate::{
    error::ObservatoryError,
    influence::{InfluenceSolver, MeasureOfCells, SeenMeasure, Within, influence_of_pixels},
    influence_cache::{LightAround, MIN_ENTRY_BYTES},
    influence_part::Part,
    map_measure::MapMeasure,
    observatory::Observatory,
    scene_view::SceneView,
    sky::{RenderContext, SkyRequest},
    watch::{Watch, note},
};
use rayon::prelude::*;
use serde::Serialize;
use skyglow_physics::{
    CoverSlopes, Gaps, Horizon, LinearMeasure, Panorama, SkyCurve, source_pixel::SPLIT_WITHIN_M,
    spectrum::SpectralRule,
};
use skyglow_render::{RenderError, request::RenderRequest};
use skyglow_scene::{LightShares, LitPixel, NearLight, PixelValues, RasterTile, Scene, SceneMetadata};
use std::{
    sync::{Arc, OnceLock},
    time::{Duration, Instant},
};

/// A measure of the sky that every light has a part in (`docs/model.md#influence`).
#[derive(Clone, Debug, PartialEq, Serialize)]
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

    /// Its unit, in ASCII, where what sees the sky has the unit `of_response`.
    pub fn unit(&self, of_response: &str) -> String {
        match self {
            Measure::Norm => format!("{of_response} sr0.5"),
            Measure::Zenith => MapMeasure::Zenith.unit(of_response),
            Measure::Mean => MapMeasure::Mean.unit(of_response),
            Measure::Horizontal => MapMeasure::Horizontal.unit(of_response),
            Measure::Region(_) => of_response.to_owned(),
        }
    }
}

/// A request for one map of influences.
#[derive(Clone, Debug, PartialEq, Serialize)]
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
    /// What its numbers depend on beside the request.
    pub context: RenderContext,
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

    /// Bytes that a cache stores with it; the scene is stored elsewhere.
    pub fn byte_count(&self) -> usize {
        let of_sums = PixelValues::BYTES_PER_PIXEL * self.pixels.len();
        MIN_ENTRY_BYTES + size_of_val(&*self.pixels) + size_of_val(self.influence.as_slice()) + of_sums
    }
}

impl Observatory {
    /// [`Self::influence_in`] of the scene as it is now.
    ///
    /// # Errors
    /// As [`Self::view`] and [`Self::influence_in`].
    pub fn influence(&self, request: &InfluenceRequest) -> Result<InfluenceMap, ObservatoryError> {
        self.influence_in(&self.view(&request.sky.scene, request.sky.scenario.as_ref())?, request, &|_| true)
    }

    /// What every lit pixel does to a measure of a sky: found on the processor, without the engine's queue. Takes
    /// milliseconds to a second. Not for asynchronous threads.
    ///
    /// # Errors
    /// As [`Self::sky`], [`ObservatoryError::EmptyRegion`], [`ObservatoryError::NormBetweenClouds`], and [`skyglow_render::RenderError::Ended`] where `watch` ended it.
    pub fn influence_in(
        &self,
        view: &SceneView,
        request: &InfluenceRequest,
        watch: &Watch<'_>,
    ) -> Result<InfluenceMap, ObservatoryError> {
        note(watch, 0.0)?;
        let sky = &request.sky;
        let mut steps = Vec::new();
        let mut clock = Instant::now();
        let mut step = |name: &'static str| {
            steps.push((name, clock.elapsed()));
            clock = Instant::now();
        };
        let LightAround { surroundings, shares } =
            self.influences.light_around(view, sky, self.hides_lights_of(sky))?;
        step("light");
        let (of_sky, basis_error_bound) = surroundings.render_requests(sky, &self.engine.basis_chooser())?;
        let open = Horizon::default();
        let weights =
            request.measure.weights(surroundings.horizon.as_ref().map_or(&open, |(horizon, _)| horizon));
        let is_region = matches!(request.measure, Measure::Region(_));
        if is_region && weights.as_ref().is_some_and(LinearMeasure::is_empty) {
            return Err(ObservatoryError::EmptyRegion);
        }
        let solver = self.influences.solver(&self.engine);
        if sky.broken_clouds.is_some() && request.measure == Measure::Norm {
            return Err(ObservatoryError::NormBetweenClouds);
        }
        let of_sky_count = of_sky.len() as f64;
        let mut basis_count = 0;
        for part in &of_sky {
            basis_count = basis_count.max(solver.basis_count(part)?);
        }
        let (light_count, gaps) =
            (surroundings.lights.len(), surroundings.gaps(sky, self.cloud_albedo(sky.kind())));
        let (mut parts, mut done) = (Vec::with_capacity(light_count), 0.0);
        let (mut before_scaling, mut after_scaling) = (0.0, 0.0);
        for (number, (lights, (fixture, _))) in shares.iter().zip(&surroundings.lights).enumerate() {
            let rule = &*fixture.light(&sky.lamp).rule(&sky.response);
            // Between clouds the same light twice: under a clear sky and under a closed layer.
            let layers: Vec<&RenderRequest> = of_sky.iter().skip(number).step_by(light_count).collect();
            // The sky takes far light by blocks; here every pixel is by itself, so that those of a cell are what it was made of.
            let of_pixels =
                |of_sky: &RenderRequest| RenderRequest { polar: Arc::clone(&lights.polar), ..of_sky.clone() };
            let covered = match (&gaps, layers.as_slice()) {
                (Some(gaps), &[clear, overcast]) => {
                    let sky_of = |layer| solver.sky(&of_pixels(layer), layer);
                    Some(CoveredSky::new(gaps, sky_of(clear)?, &sky_of(overcast)?))
                }
                _ => None,
            };
            let mut of_light = vec![0f32; lights.len()];
            for (layer, of_sky) in layers.iter().enumerate() {
                note(watch, done)?;
                let within = covered.as_ref().map(|covered| covered.within(layer));
                let seen = weights.as_ref().map(|measure| SeenMeasure { measure, rule, within });
                let of_cells = seen.map_or(MeasureOfCells::Norm(rule), MeasureOfCells::Linear);
                let of_pixels = of_pixels(of_sky);
                let found = solver.cells_in_sky(&of_pixels, of_sky, of_cells)?;
                step("cells");
                let (mut influence, scale) = influence_of_pixels(lights, &found.cells, found.of_sky);
                step("pixels");
                if request.measure == Measure::Norm {
                    near_norms(solver, (of_sky, rule), lights, &mut influence, &|| watch(done))?;
                    step("near pixels");
                }
                let value = found.of_sky.unwrap_or(0.0);
                (before_scaling, after_scaling) = (before_scaling + value / scale, after_scaling + value);
                if let Some(measure) = seen {
                    add_near_lights(solver, &of_pixels, of_sky, measure, lights, &mut influence)?;
                    step("near lights");
                }
                of_light.iter_mut().zip(&influence).for_each(|(sum, influence)| *sum += influence);
                done += 1.0 / of_sky_count;
            }
            parts.push((lights.shared_pixels(), of_light));
        }
        let (pixels, influence) = together(parts);
        let total = Part::of_all(&pixels, &influence);
        step("total");
        Ok(InfluenceMap {
            context: surroundings.context(sky, self.celestial_tables(), basis_count, basis_error_bound),
            region_sr: weights.filter(|_| is_region).map(|weights| weights.solid_angle_sr()),
            scene: Arc::clone(view.scene()),
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

/// A sky of broken clouds, and what those that it is made of do to it.
struct CoveredSky {
    sky: Panorama,
    slopes: CoverSlopes,
}

impl CoveredSky {
    fn new(gaps: &Gaps, clear: Panorama, overcast: &Panorama) -> Self {
        let slopes = gaps.slopes(&clear, overcast);
        let mut sky = clear;
        gaps.cover(&mut sky, overcast);
        Self { sky, slopes }
    }

    /// * `layer`: 0 for the clear sky.
    fn within(&self, layer: usize) -> Within<'_> {
        let CoverSlopes { by_clear, by_overcast } = &self.slopes;
        Within { sky: &self.sky, slopes: if layer == 0 { by_clear } else { by_overcast } }
    }
}

/// Adds what near lights do beyond what their cells have of them.
fn add_near_lights(
    solver: &InfluenceSolver,
    of_pixels: &RenderRequest,
    of_sky: &RenderRequest,
    measure: SeenMeasure<'_>,
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
    (sky, rule): (&RenderRequest, &SpectralRule),
    lights: &LightShares,
    influence: &mut [f32],
    goes_on: &(dyn Fn() -> bool + Sync),
) -> Result<(), ObservatoryError> {
    let near: Vec<usize> = (lights.pixels().iter().enumerate())
        .filter(|(_, pixel)| f64::from(pixel.distance_m) <= SPLIT_WITHIN_M)
        .map(|(position, _)| position)
        .collect();
    let norm = |&position: &usize| {
        if !goes_on() {
            return Err(RenderError::Ended.into());
        }
        solver.norm(&RenderRequest { polar: Arc::new(lights.alone(position)), ..sky.clone() }, rule)
    };
    let norms: Vec<f64> = near.par_iter().map(norm).collect::<Result<_, _>>()?;
    for (position, norm) in near.into_iter().zip(norms) {
        influence[position] = norm as f32;
    }
    Ok(())
}
