//! What every handler shares.

use crate::{access::Access, config::HttpConfig, error::ApiError, etag::ETag, metrics::Metrics};
use axum::body::Bytes;
use moka::{future::Cache, policy::EvictionPolicy};
use skyglow_app::error::AppError;
use skyglow_app::source::{InfluenceQuery, RenderedSky, SkyQuery, SkySource, SourceError};
use skyglow_observatory::{BrightnessMap, BrightnessRequest, InfluenceMap};
use skyglow_physics::Panorama;
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
    /// Places for uploads, each of which takes disk, memory and a core for a while.
    pub uploads: Arc<Semaphore>,
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
    /// The place for finding one, which takes all cores for seconds.
    mapping: Arc<Semaphore>,
    /// Places for that and before it: more is not begun.
    mapping_line: Arc<Semaphore>,
    /// Places for finding influences, which takes all cores, and memory with the scene's lights.
    finding: Arc<Semaphore>,
    /// Places for heavy work.
    cores: Arc<Semaphore>,
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

/// How long a map of influences is kept that nobody asks for.
const INFLUENCES_KEPT_WHILE_IDLE: Duration = Duration::from_secs(600);
/// Maps of the zenith's brightness that are found or wait for it: nobody can have more begun, whether they wait for them or not.
const MAPS_IN_LINE: usize = 4;
/// How long a map of the zenith's brightness is kept that nobody asks for: it holds its scene, which may be gone from disk.
const BRIGHTNESS_KEPT_WHILE_IDLE: Duration = Duration::from_secs(3600);
/// How long an answer is kept at most: a scene that is replaced while it is made may leave it under the tag of the one before.
const ANSWERS_KEPT: Duration = Duration::from_secs(600);
/// Maps of influences that are found at a time; the others wait.
const MAPS_AT_ONCE: usize = 2;
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
            .time_to_live(ANSWERS_KEPT)
            .build();
        let weigh = |_: &String, map: &Arc<InfluenceMap>| u32::try_from(map.byte_count()).unwrap_or(u32::MAX);
        let influences = Cache::builder()
            .max_capacity(config.influence_cache_bytes)
            .weigher(weigh)
            .eviction_policy(EvictionPolicy::lru())
            // A map holds its scene, which may be gone from disk.
            .time_to_idle(INFLUENCES_KEPT_WHILE_IDLE)
            .build();
        let weigh =
            |_: &String, map: &Arc<BrightnessMap>| u32::try_from(map.byte_count()).unwrap_or(u32::MAX);
        let brightnesses = Cache::builder()
            .max_capacity(config.brightness_cache_bytes)
            .weigher(weigh)
            .eviction_policy(EvictionPolicy::lru())
            .time_to_idle(BRIGHTNESS_KEPT_WHILE_IDLE)
            .build();
        let metrics = Arc::new(Metrics::new(source.clone()));
        let cores = std::thread::available_parallelism().map_or(2, |cores| cores.get());
        Self {
            source,
            access: Arc::new(access),
            uploads: Arc::new(Semaphore::new(1)),
            config: Arc::new(config),
            metrics,
            skies,
            answers,
            influences,
            brightnesses,
            mapping: Arc::new(Semaphore::new(1)),
            mapping_line: Arc::new(Semaphore::new(MAPS_IN_LINE)),
            finding: Arc::new(Semaphore::new(MAPS_AT_ONCE)),
            cores: Arc::new(Semaphore::new(2 * cores)),
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
        let waiting = self.cores.clone().acquire_owned().instrument(tracing::info_span!("wait for a core"));
        let place = waiting.await.map_err(ApiError::internal)?;
        self.blocking(move |source| {
            let result = work(source);
            drop(place);
            result
        })
        .await
    }

    /// What decides a sky: the request, the scene's version, the packs, the executor and what it runs on.
    pub fn sky_key(&self, query: &SkyQuery, scene_version: &str) -> String {
        let facts = self.source.facts();
        let request = format!("{query:?}");
        ETag::of(&[&request, scene_version, &facts.pack_checksums, &facts.executor, &facts.adapter]).header()
    }

    /// The sky of a query, rendered once for all who ask at the same time, kept for a while.
    ///
    /// # Errors
    /// [`SourceError`].
    pub async fn sky(&self, key: &str, query: Arc<SkyQuery>) -> Result<Arc<RenderedSky>, SourceError> {
        let source = self.source.clone();
        let entry = self.skies.entry_by_ref(key);
        let render =
            async move { source.sky(query).await.map(Arc::new) }.instrument(tracing::info_span!("sky"));
        let found = entry.or_try_insert_with(render).await;
        self.metrics.count_cache("sky", found.as_ref().is_ok_and(|entry| !entry.is_fresh()));
        found.map(moka::Entry::into_value).map_err(|error| SourceError::clone(&error))
    }

    /// The answer of a tag, made once for all who ask at the same time, kept for a while.
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

    /// Forgets influences that were found in another version of a scene than the one they were asked of.
    pub async fn forget_influence(&self, key: &str) {
        self.influences.invalidate(key).await;
    }

    /// Runs something that finds influences: few at a time, the others wait.
    ///
    /// # Errors
    /// As [`Self::blocking`].
    pub async fn find<T: Send + 'static>(
        &self,
        work: impl FnOnce(&dyn SkySource) -> Result<T, ApiError> + Send + 'static,
    ) -> Result<T, ApiError> {
        let place = self.finding.clone().acquire_owned().await.map_err(ApiError::internal)?;
        self.blocking(move |source| {
            let found = work(source);
            drop(place);
            found
        })
        .await
    }

    /// Whether a map of the zenith's brightness is found.
    pub fn has_brightness(&self, key: &str) -> bool {
        self.brightnesses.contains_key(key)
    }

    /// Forgets a map of the zenith's brightness of another version of a scene than the one it was asked of.
    pub async fn forget_brightness(&self, key: &str) {
        self.brightnesses.invalidate(key).await;
    }

    /// The zenith's brightness at every place, found once for all who ask at the same time, one map at a time, kept for a while.
    /// Who asked may have gone before it is found: the next finds it.
    ///
    /// # Errors
    /// As [`SkySource::brightness`].
    pub async fn brightness(
        &self,
        key: &str,
        query: Arc<BrightnessRequest>,
    ) -> Result<Arc<BrightnessMap>, ApiError> {
        if let Some(map) = self.brightnesses.get(key).await {
            self.metrics.count_cache("brightness", true);
            return Ok(map);
        }
        self.metrics.count_cache("brightness", false);
        let (state, key) = (self.clone(), key.to_owned());
        let find = async move {
            let inner = state.clone();
            let find = async move {
                let Ok(_in_line) = inner.mapping_line.clone().try_acquire_owned() else {
                    inner.metrics.count_refused("busy");
                    return Err(ApiError::App(AppError::Busy { retry_after_s: 20 }));
                };
                let waiting = inner.mapping.clone().acquire_owned();
                let waiting = waiting.instrument(tracing::info_span!("wait for another map"));
                let place = waiting.await.map_err(ApiError::internal)?;
                let metrics = inner.metrics.clone();
                let map = inner.blocking(move |source| {
                    metrics.count_brightness_map();
                    Ok(Arc::new(source.brightness(&query, &|_: f64| true)?))
                });
                let map = map.await;
                drop(place);
                map
            };
            state.brightnesses.try_get_with(key, find).await
        };
        match tokio::spawn(find.in_current_span()).await {
            Ok(found) => found.map_err(|error| ApiError::clone(&error)),
            Err(error) => Err(ApiError::internal(format!("a worker failed: {error}"))),
        }
    }

    /// The influences of a query, found once for all who ask at the same time, kept for a while.
    ///
    /// # Errors
    /// As [`SkySource::influence`].
    pub async fn influence(
        &self,
        key: &str,
        query: Arc<InfluenceQuery>,
    ) -> Result<Arc<InfluenceMap>, ApiError> {
        let find = async move {
            let metrics = self.metrics.clone();
            self.find(move |source| {
                metrics.count_influences();
                source.influence(&query).map(Arc::new).map_err(|error| error.of_sky(&query.sky).into())
            })
            .await
        };
        let found = self.influences.entry_by_ref(key).or_try_insert_with(find).await;
        self.metrics.count_cache("influence", found.as_ref().is_ok_and(|entry| !entry.is_fresh()));
        found.map(moka::Entry::into_value).map_err(|error| ApiError::clone(&error))
    }
}
