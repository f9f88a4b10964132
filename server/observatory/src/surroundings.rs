//! What a scene says of a place: the light around it by kinds of fixtures, the ground, the horizon.

use crate::{
    error::ObservatoryError,
    lights_under_clouds::LightsUnderClouds,
    night_sky::{NightSky, Overhead, dark_sky},
    scene_view::SceneView,
    sky::{RenderContext, RenderedSky, SkyRequest, responses_of},
};
use skyglow_physics::{
    AZIMUTH_COUNT, Atmosphere, BAND_COUNT, BrokenClouds, ELEVATION_COUNT, Fixture, Gaps, Horizon, Lamp,
    LampPreset, Panorama, PhysicsError, SKY_RESPONSES, SeenLight, SkyPart, Slope, spectrum::Light,
};
use skyglow_render::{
    PassTime,
    celestial::CelestialTables,
    request::{RenderRequest, Rendered},
    truncation::BasisChooser,
};
use skyglow_scene::{Ground, PolarGrid, Scene};
use std::{
    sync::Arc,
    time::{Duration, Instant},
};

/// The light around a place that has one kind of fixture.
pub(crate) type FixtureLight = (Fixture, Arc<PolarGrid>);

/// What of the natural sky is seen.
pub(crate) struct Natural {
    /// That of an instant, and how long it took.
    night: Option<(NightSky, Duration)>,
    /// Between clouds.
    gaps: Option<Gaps>,
}

/// What a scene says of a place.
#[derive(Clone)]
pub(crate) struct Surroundings {
    /// At least one, be there light or not: that of the scene's own fixtures.
    pub(crate) lights: Vec<FixtureLight>,
    pub(crate) ground: Ground,
    /// Metres above sea level, at least 0.
    pub(crate) altitude_m: f64,
    calibration: f64,
    slope: Slope,
    /// None where nothing hides, and nothing is computed for it.
    pub(crate) horizon: Option<(Horizon, Duration)>,
}

impl Surroundings {
    /// * `hides_lights`: whether the packs know skylines; else no light is put behind one.
    ///
    /// # Errors
    /// [`ObservatoryError::OutsideScene`], and as [`SceneView::find_skylines`].
    pub(crate) fn of(
        view: &SceneView,
        request: &SkyRequest,
        hides_lights: bool,
    ) -> Result<Self, ObservatoryError> {
        let ground = view.site(request.place)?.ground;
        view.find_skylines(request.place, request.terrain_hides && hides_lights)?;
        Ok(Self::on_ground(ground, view.scene(), request, hides_lights))
    }

    /// The same of a place whose ground is known.
    pub(crate) fn on_ground(ground: Ground, scene: &Scene, request: &SkyRequest, hides_lights: bool) -> Self {
        let open = Self::under_open_sky(ground, scene, request, hides_lights);
        let place = request.place;
        let horizon = (request.terrain_hides && scene.metadata().terrain).then(|| {
            let start = Instant::now();
            (scene.horizon(place, open.altitude_m), start.elapsed())
        });
        let slope = if horizon.is_some() { scene.slope(place) } else { Slope::default() };
        Self { slope, horizon, ..open }
    }

    /// The same on level ground without its horizon.
    pub(crate) fn under_open_sky(
        ground: Ground,
        scene: &Scene,
        request: &SkyRequest,
        hides_lights: bool,
    ) -> Self {
        let place = request.place;
        let altitude_m = request.observer_height.altitude_m(ground);
        // Below sea level counts as sea level; what is no number stays so and is refused.
        let altitude_m = if altitude_m < 0.0 { 0.0 } else { altitude_m };
        let lights = scene.polar_grids(place, request.terrain_hides && hides_lights);
        let lights = lights.into_iter().map(|(fixture, polar)| (fixture, Arc::new(polar))).collect();
        let calibration = scene.metadata().calibration;
        Self { lights, ground, altitude_m, calibration, slope: Slope::default(), horizon: None }
    }

    /// Lamps that changes replace around here where there are none of them by then, each once.
    fn lamps_not_met(&self, asked: &Lamp) -> Vec<LampPreset> {
        let not_met: Vec<LampPreset> =
            self.lights.iter().flat_map(|(fixture, _)| fixture.lamps_not_met(asked)).collect();
        LampPreset::ALL.into_iter().filter(|lamp| not_met.contains(lamp)).collect()
    }

    /// What the numbers of an answer depend on beside the request.
    pub(crate) fn context(
        &self,
        request: &SkyRequest,
        tables: Option<&CelestialTables>,
        basis_count: usize,
        basis_error_bound: Option<f64>,
    ) -> RenderContext {
        RenderContext {
            altitude_m: self.altitude_m,
            ground: self.ground,
            coverage: self.lights[0].1.coverage,
            calibration: self.calibration,
            local_optical_depth: Atmosphere::new(request.turbidity).vertical_optical_depth(self.altitude_m),
            flux_dnb_w: self.lights.iter().map(|(_, polar)| polar.flux_dnb_w).sum(),
            under_clouds: request.cloud_base_m.map(|base_m| {
                let cells = self.lights.iter().flat_map(|(_, polar)| &polar.cells);
                LightsUnderClouds::of(cells, self.altitude_m, f64::from(base_m))
            }),
            basis_count,
            basis_error_bound,
            dark: dark_sky(tables, request.turbidity, self.altitude_m),
            slope: self.slope,
            lamps_not_met: self.lamps_not_met(&request.lamp),
        }
    }

    /// What is to be rendered and added up, under broken clouds first of the clear sky, then of the overcast one; with a tolerance, the fewest functions that it allows, and the bound of what they
    /// miss.
    pub(crate) fn render_requests(
        &self,
        request: &SkyRequest,
        basis: &BasisChooser,
    ) -> Result<(Vec<RenderRequest>, Option<f64>), ObservatoryError> {
        let part = |(fixture, polar): &FixtureLight, cloud_base_m: Option<u32>| {
            let (emission, flux_factor) = request.emission.of_fixture(fixture)?;
            Ok(RenderRequest {
                polar: Arc::clone(polar),
                observer_altitude_m: self.altitude_m,
                turbidity: request.turbidity,
                scattering: request.scattering,
                cloud_base_m,
                emission,
                flux_per_dnb_flux: [flux_factor; BAND_COUNT],
                basis: request.basis,
            })
        };
        let layers: &[Option<u32>] = match request.broken_clouds {
            None => &[request.cloud_base_m],
            Some(_) => &[None, request.cloud_base_m],
        };
        let parts = layers.iter().flat_map(|layer| self.lights.iter().map(|light| part(light, *layer)));
        let parts: Result<Vec<RenderRequest>, PhysicsError> = parts.collect();
        let mut parts = parts.map_err(ObservatoryError::Emission)?;
        let (None, Some(tolerance)) = (request.basis, request.tolerance) else {
            return Ok((parts, None));
        };
        // Skies are nowhere below 0, so norms of n of them sum to √n times that of their sum at most.
        let together = (self.lights.len() as f64).sqrt();
        let mut bound = 0f64;
        for part in &mut parts {
            let within = basis.basis_within(part, tolerance / together)?;
            part.basis = Some(within.basis_count);
            bound = bound.max(within.error_bound);
        }
        Ok((parts, Some(together * bound)))
    }

    /// What of the natural sky is seen.
    ///
    /// # Errors
    /// [`ObservatoryError::NoCelestialTables`].
    pub(crate) fn natural(
        &self,
        request: &SkyRequest,
        cloud_albedo: f64,
        tables: Option<&CelestialTables>,
    ) -> Result<Natural, ObservatoryError> {
        let gaps = self.gaps(request, cloud_albedo);
        let night = self.night_sky(request, gaps.as_ref(), tables)?;
        Ok(Natural { night, gaps })
    }

    /// The gaps between clouds over the eye, none in a closed layer; None under a clear sky.
    pub(crate) fn gaps(&self, request: &SkyRequest, cloud_albedo: f64) -> Option<Gaps> {
        let base_m = f64::from(request.cloud_base_m?);
        let clouds = request.broken_clouds.unwrap_or(BrokenClouds::CLOSED);
        Some(clouds.gaps(base_m - self.altitude_m, 1.0 - cloud_albedo))
    }

    /// The natural sky of the instant that is asked for; None where none is.
    ///
    /// # Errors
    /// [`ObservatoryError::NoCelestialTables`].
    fn night_sky(
        &self,
        request: &SkyRequest,
        gaps: Option<&Gaps>,
        tables: Option<&CelestialTables>,
    ) -> Result<Option<(NightSky, Duration)>, ObservatoryError> {
        let Some(time) = request.time else { return Ok(None) };
        let start = Instant::now();
        let tables = tables.ok_or(ObservatoryError::NoCelestialTables)?;
        let open = Horizon::flat();
        let horizon = self.horizon.as_ref().map_or(&open, |(horizon, _)| horizon);
        let over = Overhead {
            place: request.place,
            altitude_m: self.altitude_m,
            horizon,
            turbidity: request.turbidity,
            gaps,
        };
        let night = NightSky::new(tables, &over, time, &responses_of(request))?;
        Ok(Some((night, start.elapsed())))
    }

    /// The sky with what it depends on, dark below the horizon; `rendered` is what [`Self::render_requests`] asked for.
    pub(crate) fn finish(
        self,
        request: &SkyRequest,
        mut rendered: Vec<Rendered>,
        basis_error_bound: Option<f64>,
        natural: Natural,
        tables: Option<&CelestialTables>,
    ) -> RenderedSky {
        let Natural { night, gaps } = natural;
        let basis_count = rendered.iter().map(|rendered| rendered.basis_count).max().unwrap_or_default();
        let context = self.context(request, tables, basis_count, basis_error_bound);
        let lights: Vec<_> = self.lights.iter().map(|(fixture, _)| fixture.light(&request.lamp)).collect();
        let (horizon, time) = self.horizon.unzip();
        let (night, night_time) = night.unzip();
        let timed = |name, time: Option<Duration>| {
            time.map(|time| PassTime { name, microseconds: 1e6 * time.as_secs_f64() })
        };
        let before = [timed("horizon", time), timed("night sky", night_time)].into_iter().flatten();
        let passes = before.chain(times_together(&rendered)).collect();
        let horizon = horizon.unwrap_or_default();
        let mut air_before_ground = None;
        if let Some(gaps) = gaps.as_ref().filter(|_| request.broken_clouds.is_some()) {
            let overcast = rendered.split_off(lights.len());
            air_before_ground = Some(air_under_clouds(gaps, &lights, [&rendered, &overcast], &horizon));
            for (clear, overcast) in rendered.iter_mut().zip(&overcast) {
                gaps.cover(&mut clear.panorama, &overcast.panorama);
            }
        }
        let parts = lights.into_iter().zip(rendered);
        let parts = parts.map(|(light, rendered)| SkyPart { light, kernel: rendered.panorama }).collect();
        let sky = RenderedSky::with_natural(request, parts, horizon, context, (night, gaps));
        RenderedSky { passes, air_before_ground, ..sky }
    }
}

/// [`RenderedSky::air_before_ground`] of skies without clouds and under a closed layer.
fn air_under_clouds(
    gaps: &Gaps,
    lights: &[Arc<Light>],
    [clear, overcast]: [&[Rendered]; 2],
    horizon: &Horizon,
) -> Vec<SeenLight> {
    let rules: Vec<_> = lights.iter().map(|light| SKY_RESPONSES.map(|of| light.rule(&of))).collect();
    let of_column = |column: usize| {
        let row = horizon.first_visible_row(column).min(ELEVATION_COUNT - 1);
        let mut sum = SeenLight::default();
        for ((rules, clear), overcast) in rules.iter().zip(clear).zip(overcast) {
            let kernel = std::array::from_fn(|band| {
                let [clear, overcast] =
                    [clear, overcast].map(|sky| sky.panorama.samples()[Panorama::index(band, row, column)]);
                f64::from(gaps.of_air(clear, overcast, row))
            });
            sum.iter_mut().zip(rules).for_each(|(sum, rule)| *sum += rule.value(kernel));
        }
        sum
    };
    (0..AZIMUTH_COUNT).map(of_column).collect()
}

/// Times of passes of all parts together: parts of one batch have its times.
fn times_together(rendered: &[Rendered]) -> Vec<PassTime> {
    let mut passes: Vec<PassTime> = Vec::new();
    for part in rendered {
        for pass in &part.passes {
            match passes.iter_mut().find(|known| known.name == pass.name) {
                Some(known) if part.batch_size > 1 => {
                    known.microseconds = known.microseconds.max(pass.microseconds);
                }
                Some(known) => known.microseconds += pass.microseconds,
                None => passes.push(*pass),
            }
        }
    }
    passes
}
