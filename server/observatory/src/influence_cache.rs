//! Light around an eye that is stored for the next map of influences from the same place.

use crate::{
    cache_sizes::CacheSizes,
    error::ObservatoryError,
    influence::InfluenceSolver,
    scene_view::SceneView,
    sky::{ObserverHeight, SkyRequest},
    surroundings::Surroundings,
};
use moka::sync::Cache;
use skyglow_render::engine::Engine;
use skyglow_scene::LightShares;
use std::{
    sync::{Arc, OnceLock},
    time::Duration,
};

/// How long light around an eye is stored that nobody asks for.
const TIME_TO_IDLE: Duration = Duration::from_secs(600);
/// Bytes that an entry takes where there is no light: nothing weighs nothing.
pub(crate) const MIN_ENTRY_BYTES: usize = 8 << 10;

/// What decides the light around an eye: scene and version, place, eye, and what hides it.
type LightKey = (String, [u64; 3], [bool; 3]);

/// The light around an eye, the same for every measure, lamp and air.
#[derive(Clone)]
pub(crate) struct LightAround {
    pub(crate) surroundings: Surroundings,
    /// Beside the surroundings' lights, each with every pixel by itself.
    pub(crate) shares: Arc<[LightShares]>,
}

/// What finding influences needs beside the engine.
pub(crate) struct InfluenceCache {
    solver: OnceLock<InfluenceSolver>,
    ready_bytes: u64,
    lights: Cache<LightKey, LightAround>,
}

impl std::fmt::Debug for InfluenceCache {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("InfluenceCache").field("lights", &self.lights.entry_count()).finish_non_exhaustive()
    }
}

impl InfluenceCache {
    pub(crate) fn new(sizes: &CacheSizes) -> Self {
        let weigh = |_: &LightKey, light: &LightAround| {
            let of_grids = light.surroundings.lights.iter().map(|(_, polar)| polar.byte_count());
            let of_shares = light.shares.iter().map(LightShares::byte_count);
            let bytes = MIN_ENTRY_BYTES + of_grids.chain(of_shares).sum::<usize>();
            u32::try_from(bytes).unwrap_or(u32::MAX)
        };
        let lights = Cache::builder()
            .max_capacity(sizes.light_bytes)
            .weigher(weigh)
            .time_to_idle(TIME_TO_IDLE)
            .build();
        Self { solver: OnceLock::new(), ready_bytes: sizes.ready_requests_bytes, lights }
    }

    /// Made when it is first asked for.
    pub(crate) fn solver(&self, engine: &Engine) -> &InfluenceSolver {
        self.solver.get_or_init(|| InfluenceSolver::keeping(engine.table_set(), self.ready_bytes))
    }

    /// The light around the eye of a request.
    ///
    /// # Errors
    /// [`ObservatoryError::OutsideScene`], and as [`SceneView::find_skylines`].
    pub(crate) fn light_around(
        &self,
        view: &SceneView,
        request: &SkyRequest,
        hides_lights: bool,
    ) -> Result<LightAround, ObservatoryError> {
        let place = request.place;
        let ground = view.site(place)?.ground;
        let (is_above_sea, eye_m) = match request.observer_height {
            ObserverHeight::AboveGround(height_m) => (false, height_m),
            ObserverHeight::AboveSea(altitude_m) => (true, altitude_m),
        };
        let key = (
            view.version().to_owned(),
            [place.latitude_rad().to_bits(), place.longitude_rad().to_bits(), eye_m.to_bits()],
            [is_above_sea, request.terrain_hides, hides_lights],
        );
        if !self.lights.contains_key(&key) {
            view.find_skylines(place, request.terrain_hides && hides_lights)?;
        }
        Ok(self.lights.get_with(key, || {
            let scene = view.scene();
            let shares = scene.light_shares(place, request.terrain_hides && hides_lights);
            LightAround {
                surroundings: Surroundings::on_ground(ground, scene, request, hides_lights),
                shares: shares.into_iter().map(|(_, shares)| shares).collect(),
            }
        }))
    }
}
