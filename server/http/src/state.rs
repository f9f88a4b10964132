//! What every handler shares.

use crate::{
    access::Access, config::HttpConfig, error::ApiError, etag::ETag, metrics::Metrics, progress::Progress,
};
use axum::body::Bytes;
use moka::{future::Cache, policy::EvictionPolicy};
use skyglow_app::{error::AppError, source::SkySource};
use skyglow_observatory::{
    BrightnessMap, BrightnessRequest, InfluenceMap, InfluenceRequest, RenderedSky, SceneView, SkyRequest,
};
use skyglow_physics::Panorama;
use skyglow_scene::{ChangeId, SceneId};
use std::{
    future::Future,
    sync::{Arc, OnceLock},
    time::Duration,
};
use tokio::sync::Semaphore;
use tracing::Instrument;

/// The shared state.
#[derive(Clone)]
pub struct AppState {
    /// The program behind.
    pub source: Arc<dyn SkySource>,
    /// Who may do more than read.
    pub access: Arc<Access>,
    /// Permits for uploads, each of which takes disk, memory and a core for a while.
    pub upload_permits: Arc<Semaphore>,
    /// What the interface was told.
    pub config: Arc<HttpConfig>,
    /// Counters.
    pub metrics: Arc<Metrics>,
    /// Skies rendered lately, by what decides them.
    skies: Cache<String, Arc<RenderedSky>>,
    /// Answers made lately, by their tags.
    answers: Cache<String, Arc<EncodedAnswer>>,
    /// Maps of influences found lately, by what decides them.
    influences: Cache<String, Arc<InfluenceMap>>,
    /// Maps of the zenith's brightness found lately, by what decides them.
    brightnesses: Cache<String, Arc<BrightnessMap>>,
    /// How far those are that are being found.
    brightness_progress: Progress,
    /// The permit for finding one, which takes all cores for seconds.
    brightness_permits: Arc<Semaphore>,
    /// Permits for that and the queue before it: more is not begun.
    brightness_queue_permits: Arc<Semaphore>,
    /// Permits for finding influences, which takes all cores, and memory with the scene's lights.
    influence_permits: Arc<Semaphore>,
    /// Permits for heavy work.
    core_permits: Arc<Semaphore>,
    /// The OpenAPI document, set once when the routes are known.
    pub openapi: Arc<OnceLock<String>>,
}

/// An answer as it is sent.
#[derive(Clone, Debug, Default)]
pub struct EncodedAnswer {
    /// The body.
    pub bytes: Bytes,
    /// What it had to do without.
    pub warnings: Vec<String>,
    /// How long the steps took when it was made.
    pub times: String,
}

impl From<Vec<u8>> for EncodedAnswer {
    fn from(bytes: Vec<u8>) -> Self {
        Self { bytes: bytes.into(), ..Self::default() }
    }
}

/// Bytes that an answer takes in the cache beside its body, about.
const ANSWER_BYTES: usize = 512;

/// How long a map of influences is stored that nobody asks for.
const INFLUENCE_TIME_TO_IDLE: Duration = Duration::from_secs(600);
/// Maps of the zenith's brightness that are found or wait for it: nobody can have more begun, whether they wait for them or not.
const MAX_QUEUED_BRIGHTNESS_MAPS: usize = 4;
/// How long a map of the zenith's brightness is stored that nobody asks for: it holds its scene, which may be gone from disk.
const BRIGHTNESS_TIME_TO_IDLE: Duration = Duration::from_secs(3600);
/// How long an answer is stored at most.
const ANSWER_TIME_TO_LIVE: Duration = Duration::from_secs(600);
/// Part of the longest time for an answer that a map which is being found is waited for.
const PART_WAITED_FOR: f64 = 0.8;
/// Maps of influences that are found at a time; the others wait.
const MAX_INFLUENCE_MAPS_AT_ONCE: usize = 2;
/// Bytes that a cached sky takes, about.
const SKY_BYTES: u64 = 4 * Panorama::LEN as u64 + 2048;

impl AppState {
    /// The state over a source.
    pub fn new(source: Arc<dyn SkySource>, config: HttpConfig, access: Access) -> Self {
        let skies = Cache::builder().max_capacity(config.cache_bytes / SKY_BYTES).build();
        let weigh = |_: &String, answer: &Arc<EncodedAnswer>| {
            u32::try_from(answer.bytes.len() + ANSWER_BYTES).unwrap_or(u32::MAX)
        };
        let answers = Cache::builder()
            .max_capacity(config.answer_cache_bytes)
            .weigher(weigh)
            .time_to_live(ANSWER_TIME_TO_LIVE)
            .build();
        let weigh = |_: &String, map: &Arc<InfluenceMap>| u32::try_from(map.byte_count()).unwrap_or(u32::MAX);
        let influences = Cache::builder()
            .max_capacity(config.influence_cache_bytes)
            .weigher(weigh)
            .eviction_policy(EvictionPolicy::lru())
            // A map holds its scene, which may be gone from disk.
            .time_to_idle(INFLUENCE_TIME_TO_IDLE)
            .build();
        let weigh =
            |_: &String, map: &Arc<BrightnessMap>| u32::try_from(map.byte_count()).unwrap_or(u32::MAX);
        let brightnesses = Cache::builder()
            .max_capacity(config.brightness_cache_bytes)
            .weigher(weigh)
            .eviction_policy(EvictionPolicy::lru())
            .time_to_idle(BRIGHTNESS_TIME_TO_IDLE)
            .build();
        let metrics = Arc::new(Metrics::new(source.clone()));
        let cores = std::thread::available_parallelism().map_or(2, |cores| cores.get());
        Self {
            source,
            access: Arc::new(access),
            upload_permits: Arc::new(Semaphore::new(1)),
            config: Arc::new(config),
            metrics,
            skies,
            answers,
            influences,
            brightnesses,
            brightness_progress: Progress::default(),
            brightness_permits: Arc::new(Semaphore::new(1)),
            brightness_queue_permits: Arc::new(Semaphore::new(MAX_QUEUED_BRIGHTNESS_MAPS)),
            influence_permits: Arc::new(Semaphore::new(MAX_INFLUENCE_MAPS_AT_ONCE)),
            core_permits: Arc::new(Semaphore::new(2 * cores)),
            openapi: Arc::default(),
        }
    }

    /// Runs something that may read files or compute for long, off the async threads.
    ///
    /// # Errors
    /// Its own, and [`AppError::Internal`] where it panics.
    pub async fn blocking<T: Send + 'static>(
        &self,
        work: impl FnOnce(&dyn SkySource) -> Result<T, ApiError> + Send + 'static,
    ) -> Result<T, ApiError> {
        let source = self.source.clone();
        let span = tracing::info_span!("work");
        match tokio::task::spawn_blocking(move || span.in_scope(|| work(source.as_ref()))).await {
            Ok(result) => result,
            Err(error) => Err(ApiError::internal(format!("a worker failed: {error}"))),
        }
    }

    /// The same for work that takes a core and much memory for a while, such as drawing: at most two pieces a
    /// core at a time, the others wait.
    ///
    /// # Errors
    /// As [`Self::blocking`].
    pub async fn heavy<T: Send + 'static>(
        &self,
        work: impl FnOnce(&dyn SkySource) -> Result<T, ApiError> + Send + 'static,
    ) -> Result<T, ApiError> {
        let waiting =
            self.core_permits.clone().acquire_owned().instrument(tracing::info_span!("wait for a core"));
        let permit = waiting.await.map_err(ApiError::internal)?;
        self.blocking(move |source| {
            let result = work(source);
            drop(permit);
            result
        })
        .await
    }

    /// A scene as it is now, with the changes of a scenario or plan.
    ///
    /// # Errors
    /// As [`SkySource::view`].
    pub async fn view(&self, id: &SceneId, scenario: Option<&ChangeId>) -> Result<SceneView, ApiError> {
        let (id, scenario) = (id.clone(), scenario.cloned());
        self.blocking(move |source| Ok(source.view(&id, scenario.as_ref())?)).await
    }

    /// The sky of a request, rendered once for all who ask at the same time, stored for a while.
    ///
    /// # Errors
    /// As [`SkySource::sky`].
    pub async fn sky(
        &self,
        key: &str,
        request: Arc<SkyRequest>,
        view: SceneView,
    ) -> Result<Arc<RenderedSky>, AppError> {
        let source = self.source.clone();
        let entry = self.skies.entry_by_ref(key);
        let render = async move { source.sky(request, view).await.map(Arc::new) };
        let found = entry.or_try_insert_with(render.instrument(tracing::info_span!("sky"))).await;
        self.metrics.count_cache("sky", found.as_ref().is_ok_and(|entry| !entry.is_fresh()));
        found.map(moka::Entry::into_value).map_err(|error| AppError::clone(&error))
    }

    /// The answer of a tag, made once for all who ask at the same time, stored for a while.
    ///
    /// # Errors
    /// Those of `make`.
    pub async fn answer(
        &self,
        etag: &ETag,
        make: impl Future<Output = Result<EncodedAnswer, ApiError>>,
    ) -> Result<Arc<EncodedAnswer>, ApiError> {
        let make = async move { make.await.map(Arc::new) };
        let found = self.answers.entry(etag.header()).or_try_insert_with(make).await;
        self.metrics.count_cache("answer", found.as_ref().is_ok_and(|entry| !entry.is_fresh()));
        found.map(moka::Entry::into_value).map_err(|error| ApiError::clone(&error))
    }

    /// Runs something that finds influences: few at a time, the others wait.
    ///
    /// # Errors
    /// As [`Self::blocking`].
    pub async fn with_influence_permit<T: Send + 'static>(
        &self,
        work: impl FnOnce(&dyn SkySource) -> Result<T, ApiError> + Send + 'static,
    ) -> Result<T, ApiError> {
        let permit = self.influence_permits.clone().acquire_owned().await.map_err(ApiError::internal)?;
        self.blocking(move |source| {
            let found = work(source);
            drop(permit);
            found
        })
        .await
    }

    /// Whether a map of the zenith's brightness is found.
    pub fn has_brightness(&self, key: &str) -> bool {
        self.brightnesses.contains_key(key)
    }

    /// The zenith's brightness at every place, found once for all who ask at the same time, one map at a time, stored for a while.
    /// Who asked may have gone before it is found: the next finds it.
    ///
    /// # Errors
    /// As [`SkySource::brightness`].
    pub async fn brightness(
        &self,
        key: &str,
        request: Arc<BrightnessRequest>,
        view: SceneView,
    ) -> Result<Arc<BrightnessMap>, ApiError> {
        if let Some(map) = self.brightnesses.get(key).await {
            self.metrics.count_cache("brightness", true);
            return Ok(map);
        }
        self.metrics.count_cache("brightness", false);
        let (state, key) = (self.clone(), key.to_owned());
        let asked_by = key.clone();
        let find = async move {
            let (inner, found_by) = (state.clone(), key.clone());
            let find = async move {
                let Ok(_in_queue) = inner.brightness_queue_permits.clone().try_acquire_owned() else {
                    inner.metrics.count_refused("busy");
                    return Err(ApiError::App(AppError::Busy { retry_after_s: 20 }));
                };
                let waiting = inner.brightness_permits.clone().acquire_owned();
                let waiting = waiting.instrument(tracing::info_span!("wait for another map"));
                let permit = waiting.await.map_err(ApiError::internal)?;
                let metrics = inner.metrics.clone();
                let work = inner.brightness_progress.begin(&found_by);
                let map = inner.blocking(move |source| {
                    metrics.count_brightness_map();
                    let note = |done: f64| {
                        work.set(done);
                        true
                    };
                    Ok(Arc::new(source.brightness(&request, &view, &note)?))
                });
                let map = map.await;
                drop(permit);
                map
            };
            state.brightnesses.try_get_with(key, find).await
        };
        // An answer says that it goes on before it is cut off.
        let patience = self.config.request_timeout().mul_f64(PART_WAITED_FOR);
        match tokio::time::timeout(patience, tokio::spawn(find.in_current_span())).await {
            Ok(Ok(found)) => found.map_err(|error| ApiError::clone(&error)),
            Ok(Err(error)) => Err(ApiError::internal(format!("a worker failed: {error}"))),
            Err(_) => {
                let (progress, retry_after_s) = self.brightness_progress(&asked_by).unwrap_or((0.0, 10));
                Err(ApiError::BeingMade { progress, retry_after_s })
            }
        }
    }

    /// How far a map of the zenith's brightness is that is being found, 0 to 1, and the seconds until it is worth asking again.
    pub(crate) fn brightness_progress(&self, key: &str) -> Option<(f64, u64)> {
        self.brightness_progress.of(key)
    }

    /// The influences of a request, found once for all who ask at the same time, stored for a while.
    ///
    /// # Errors
    /// As [`SkySource::influence`].
    pub async fn influence(
        &self,
        key: &str,
        request: Arc<InfluenceRequest>,
        view: SceneView,
    ) -> Result<Arc<InfluenceMap>, ApiError> {
        let find = async move {
            let metrics = self.metrics.clone();
            self.with_influence_permit(move |source| {
                metrics.count_influences();
                Ok(Arc::new(source.influence(&request, &view)?))
            })
            .await
        };
        let found = self.influences.entry_by_ref(key).or_try_insert_with(find).await;
        self.metrics.count_cache("influence", found.as_ref().is_ok_and(|entry| !entry.is_fresh()));
        found.map(moka::Entry::into_value).map_err(|error| ApiError::clone(&error))
    }
}
