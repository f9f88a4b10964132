//! What a scene says of a place: the light around it by kinds of fixtures, the ground, the horizon.

use crate::{
    error::ObservatoryError,
    scene_cache::SceneCache,
    sky::{Observer, ObserverHeight, SkyAnswer, SkyRequest},
};
use skyglow_physics::{Atmosphere, Fixture, GeoPoint, Horizon, Lamp, LampPreset, SkyCover, SkyQuantities};
use skyglow_render::{
    request::{RenderRequest, Rendered},
    truncation::BasisChooser,
};
use skyglow_scene::{ChangeId, PolarGrid, Scene, SceneId};
use std::{
    sync::Arc,
    time::{Duration, Instant},
};

/// The light around a place that has one kind of fixture.
pub(crate) type FixtureLight = (Fixture, Arc<PolarGrid>);

/// What a scene says of a place.
#[derive(Clone)]
pub(crate) struct View {
    pub(crate) scene: Arc<Scene>,
    /// At least one, be there light or not: that of the scene's own fixtures.
    pub(crate) lights: Vec<FixtureLight>,
    pub(crate) observer: Observer,
    /// None where nothing hides, and nothing is computed for it.
    pub(crate) horizon: Option<(Horizon, Duration)>,
}

impl View {
    /// `hides_lights`: whether the packs know skylines; else no light is put behind one.
    pub(crate) fn of(
        shelf: &SceneCache,
        request: &SkyRequest,
        hides_lights: bool,
    ) -> Result<Self, ObservatoryError> {
        let scene = scene_around(shelf, &request.scene, request.scenario.as_ref(), request.place)?;
        Ok(Self::in_scene(scene, request, hides_lights))
    }

    pub(crate) fn in_scene(scene: Arc<Scene>, request: &SkyRequest, hides_lights: bool) -> Self {
        let place = request.place;
        let ground = scene.ground(place);
        let altitude_m = match request.observer_height {
            ObserverHeight::AboveGround(height_m) => ground.altitude_m() + height_m,
            ObserverHeight::AboveSea(altitude_m) => altitude_m,
        };
        let observer = Observer {
            latitude_deg: place.latitude_deg(),
            longitude_deg: place.longitude_deg(),
            // Below sea level counts as sea level; what is no number stays so and is refused.
            altitude_m: if altitude_m < 0.0 { 0.0 } else { altitude_m },
            ground,
        };
        let lights = scene.polar_grids(place, request.terrain_hides && hides_lights);
        let lights = lights.into_iter().map(|(fixture, polar)| (fixture, Arc::new(polar))).collect();
        let horizon = (request.terrain_hides && scene.metadata().terrain).then(|| {
            let start = Instant::now();
            (scene.horizon(place, observer.altitude_m), start.elapsed())
        });
        Self { scene, lights, observer, horizon }
    }

    /// Covered share of the 300 km disc, 0..=1.
    pub(crate) fn coverage(&self) -> f64 {
        self.lights[0].1.coverage
    }

    /// Upward flux within 300 km, DNB watts.
    pub(crate) fn flux_dnb_w(&self) -> f64 {
        self.lights.iter().map(|(_, polar)| polar.flux_dnb_w).sum()
    }

    /// Lamps that changes replace around here where there are none of them by then, each once.
    pub(crate) fn lamps_not_met(&self, asked: &Lamp) -> Vec<LampPreset> {
        let not_met: Vec<LampPreset> =
            self.lights.iter().flat_map(|(fixture, _)| fixture.lamps_not_met(asked)).collect();
        LampPreset::ALL.into_iter().filter(|lamp| not_met.contains(lamp)).collect()
    }

    /// What is to be rendered and added up; with a tolerance, the fewest functions that it allows, and the bound of what they
    /// miss.
    pub(crate) fn render_requests(
        &self,
        request: &SkyRequest,
        basis: &BasisChooser,
    ) -> Result<(Vec<RenderRequest>, Option<f64>), ObservatoryError> {
        let part = |(fixture, polar): &FixtureLight| RenderRequest {
            polar: Arc::clone(polar),
            observer_altitude_m: self.observer.altitude_m,
            turbidity: request.turbidity,
            scattering: request.scattering,
            cloud_base_m: request.cloud_base_m,
            emission: fixture.emission(request.emission),
            flux_per_dnb_flux: fixture.flux_per_dnb_flux(&request.lamp),
            basis: request.basis,
        };
        let mut parts: Vec<RenderRequest> = self.lights.iter().map(part).collect();
        let (None, Some(tolerance)) = (request.basis, request.tolerance) else {
            return Ok((parts, None));
        };
        // Skies are nowhere below 0, so norms of n of them sum to √n times that of their sum at most.
        let together = (parts.len() as f64).sqrt();
        let mut bound = 0f64;
        for part in &mut parts {
            let within = basis.basis_within(part, tolerance / together)?;
            part.basis = Some(within.basis_count);
            bound = bound.max(within.error_bound);
        }
        Ok((parts, Some(together * bound)))
    }

    pub(crate) fn answer(
        self,
        request: &SkyRequest,
        mut rendered: Rendered,
        basis_error_bound: Option<f64>,
    ) -> SkyAnswer {
        let atmosphere = Atmosphere::new(request.turbidity);
        let (coverage, flux_dnb_w) = (self.coverage(), self.flux_dnb_w());
        let lamps_not_met = self.lamps_not_met(&request.lamp);
        let (horizon, horizon_time) = self.horizon.unzip();
        let horizon = horizon.unwrap_or_default();
        horizon.darken(&mut rendered.panorama);
        SkyAnswer {
            scene: self.scene.metadata().clone(),
            observer: self.observer,
            quantities: SkyQuantities::under(
                SkyCover::with_clouds(request.cloud_base_m.is_some()),
                &rendered.panorama,
                &horizon,
            ),
            rendered,
            basis_error_bound,
            lamps_not_met,
            horizon,
            horizon_time,
            coverage,
            calibration: self.scene.metadata().calibration,
            local_optical_depth: atmosphere.vertical_optical_depth(self.observer.altitude_m),
            flux_dnb_w,
            turbidity: request.turbidity,
            scattering: request.scattering,
            lamp: request.lamp,
            emission: request.emission,
        }
    }
}

/// The scene with its changes, if the place lies in it.
pub(crate) fn scene_around(
    shelf: &SceneCache,
    id: &SceneId,
    scenario: Option<&ChangeId>,
    place: GeoPoint,
) -> Result<Arc<Scene>, ObservatoryError> {
    let scene = shelf.changed_scene(id, scenario)?;
    if scene.contains(place) {
        return Ok(scene);
    }
    Err(ObservatoryError::OutsideScene {
        scene: id.to_string(),
        latitude_deg: place.latitude_deg(),
        longitude_deg: place.longitude_deg(),
        bounds: scene.metadata().bounds,
    })
}
