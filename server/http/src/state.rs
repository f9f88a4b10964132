//! What every handler shares.

use crate::{
    access::Access,
    asker::{self, Asker},
    atlases::{Atlases, READS},
    basemap::{Basemap, BasemapError},
    budget::Budget,
    config::HttpConfig,
    error::ApiError,
    etag::ETag,
    jobs::Jobs,
    metrics::Metrics,
    progress::Progress,
    shared::{is_of_asker, shared},
    work_places::{Lane, PART_FOR_CACHED_ANSWERS, WorkPlaces},
};
use axum::body::Bytes;
use moka::{future::Cache, policy::EvictionPolicy};
use skyglow_app::{error::AppError, source::SkySource};
use skyglow_observatory::{
    BrightnessMap, BrightnessRequest, InfluenceMap, InfluenceRequest, RenderedSky, SceneView, SkyRequest,
};
use skyglow_scene::{ChangeId, SceneId};
use std::{
    future::Future,
    ops::Deref,
    sync::{Arc, OnceLock},
    time::Duration,
};
use tokio::sync::Semaphore;
use tracing::Instrument;

/// The shared state: a handle, for every middleware and handler of every request has its own.
#[derive(Clone)]
pub struct AppState(Arc<SharedState>);

impl Deref for AppState {
    type Target = SharedState;

    fn deref(&self) -> &SharedState {
        &self.0
    }
}

/// What all handles share.
pub struct SharedState {
    /// The program behind.
    pub source: Arc<dyn SkySource>,
    /// Who may do more than read.
    pub access: Arc<Access>,
    /// Permits for uploads, each of which takes disk, memory and a core for a while.
    pub upload_permits: Arc<Semaphore>,
    /// What the interface was told.
    pub config: Arc<HttpConfig>,
    /// Bytes of bodies of requests.
    pub(crate) bodies: Arc<Budget>,
    /// Bytes of answers that are sent: of those that count in the memory of work, and of others.
    pub(crate) sending: [Arc<Budget>; 2],
    /// Where work is done.
    pub(crate) work: Arc<WorkPlaces>,
    /// Work that clients ask about later.
    pub(crate) jobs: Arc<Jobs>,
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
    /// The operator's basemap; None without one, or where it cannot be read.
    pub(crate) basemap: Option<Arc<Basemap>>,
    /// Maps that were made beforehand.
    pub(crate) atlases: Arc<Atlases>,
    /// Permits to read their tiles.
    pub(crate) atlas_reads: Arc<Semaphore>,
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

impl From<Bytes> for EncodedAnswer {
    fn from(bytes: Bytes) -> Self {
        Self { bytes, ..Self::default() }
    }
}

/// Bytes that an answer takes in the cache beside its body, about.
const ANSWER_BYTES: usize = 512;

/// How long a map of influences is stored that nobody asks for.
const INFLUENCE_TIME_TO_IDLE: Duration = Duration::from_secs(600);
/// How long a map of the zenith's brightness is stored that nobody asks for: it holds its scene, which may be gone from disk.
const BRIGHTNESS_TIME_TO_IDLE: Duration = Duration::from_secs(3600);
/// How long an answer is stored at most.
const ANSWER_TIME_TO_LIVE: Duration = Duration::from_secs(600);
/// Part of the longest time for an answer that a map which is being found is waited for.
const PART_WAITED_FOR: f64 = 0.8;
/// Bytes that finding a map of the zenith's brightness takes, about.
const BRIGHTNESS_BYTES: usize = 32 << 20;
/// Bytes that finding influences takes for each lit pixel within reach, about.
const BYTES_PER_INFLUENCE: usize = 64;
/// Part of the memory for work that answers may take while they are sent which were not counted when they were made.
pub(crate) const SHARE_OF_SENDING: u64 = 4;
/// Part of a budget of bytes that one party may hold.
const SHARE_OF_A_PARTY: u64 = 8;
/// Bytes that a cached sky takes beside its samples, about.
const SKY_BYTES: usize = 4096;

/// Bytes that finding so many influences takes, about.
pub(crate) fn influence_bytes(count: u64) -> usize {
    usize::try_from(count).unwrap_or(usize::MAX).saturating_mul(BYTES_PER_INFLUENCE)
}

impl AppState {
    /// The state over a source.
    pub fn new(source: Arc<dyn SkySource>, config: HttpConfig, access: Access) -> Self {
        let weigh = |_: &String, sky: &Arc<RenderedSky>| {
            u32::try_from(sky.byte_count() + SKY_BYTES).unwrap_or(u32::MAX)
        };
        let skies = Cache::builder().max_capacity(config.cache_bytes).weigher(weigh).build();
        let weigh = |_: &String, answer: &Arc<EncodedAnswer>| {
            u32::try_from(answer.bytes.len() + ANSWER_BYTES).unwrap_or(u32::MAX)
        };
        let answers = Cache::builder()
            .max_capacity(config.answer_cache_bytes.min(config.memory_budget() / PART_FOR_CACHED_ANSWERS))
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
        let share = (config.body_budget() / SHARE_OF_A_PARTY).max(config.body_limit_bytes as u64);
        let bodies = Budget::new(config.body_budget(), share, metrics.body_bytes.clone());
        let share = config.memory_budget() / SHARE_OF_A_PARTY;
        // Those of the first kind are counted where they were made.
        let sending = [u64::MAX, config.memory_budget() / SHARE_OF_SENDING]
            .map(|bytes| Budget::new(bytes, share, metrics.sending_bytes.clone()));
        let basemap = config.basemap.as_ref().and_then(|path| {
            let opened = Basemap::open(path);
            let told = |reason: &BasemapError| tracing::error!(%reason, path = %path.display(), "no basemap");
            opened.inspect_err(told).ok().map(Arc::new)
        });
        let atlases = Atlases::watched(&config.atlases, &source);
        let work = Arc::new(WorkPlaces::new(source.clone(), metrics.clone(), &config));
        Self(Arc::new(SharedState {
            source,
            access: Arc::new(access),
            upload_permits: Arc::new(Semaphore::new(1)),
            bodies,
            sending,
            work,
            jobs: Arc::default(),
            config: Arc::new(config),
            metrics,
            skies,
            answers,
            influences,
            brightnesses,
            brightness_progress: Progress::default(),
            basemap,
            atlases,
            atlas_reads: Arc::new(Semaphore::new(READS)),
            openapi: Arc::default(),
        }))
    }

    /// Runs something that may read files or compute for long, off the async threads.
    ///
    /// # Errors
    /// Its own, and [`AppError::Internal`] where it panics.
    pub async fn blocking<T: Send + 'static>(
        &self,
        work: impl FnOnce(&dyn SkySource) -> Result<T, ApiError> + Send + 'static,
    ) -> Result<T, ApiError> {
        self.work.blocking(work).await
    }

    /// The same for work that takes a core and some memory for a while, such as making a document: the request has a place, and
    /// waits for both.
    ///
    /// # Errors
    /// As [`Self::blocking`], and [`AppError::Busy`].
    pub async fn heavy<T: Send + 'static>(
        &self,
        work: impl FnOnce(&dyn SkySource) -> Result<T, ApiError> + Send + 'static,
    ) -> Result<T, ApiError> {
        self.work.heavy(work).await
    }

    /// Lets go of the maps of a scene that was removed or replaced, which hold it.
    pub async fn forget(&self, id: &SceneId) {
        let influences: Vec<_> = self.influences.iter().filter(|(_, map)| map.scene().id == *id).collect();
        for (key, _) in influences {
            self.influences.invalidate(&*key).await;
        }
        let maps: Vec<_> = self.brightnesses.iter().filter(|(_, map)| map.scene().id == *id).collect();
        for (key, _) in maps {
            self.brightnesses.invalidate(&*key).await;
        }
        self.influences.run_pending_tasks().await;
        self.brightnesses.run_pending_tasks().await;
    }

    /// A scene as it is now, with the changes of a scenario or plan.
    ///
    /// # Errors
    /// As [`SkySource::view`].
    pub async fn view(&self, id: &SceneId, scenario: Option<&ChangeId>) -> Result<SceneView, ApiError> {
        let (id, scenario) = (id.clone(), scenario.cloned());
        self.work.resolve(scenario.is_some(), move |source| Ok(source.view(&id, scenario.as_ref())?)).await
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
        let (source, work) = (self.source.clone(), self.work.clone());
        let render = async move {
            work.place().await?;
            source.sky(request, view).await.map(Arc::new)
        };
        let render = render.instrument(tracing::info_span!("sky"));
        let is_of_asker = |error: &AppError| matches!(error, AppError::Busy { .. });
        let found = shared(&self.skies, key, render, is_of_asker).await;
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
        let found = shared(&self.answers, &etag.header(), make, is_of_asker).await;
        self.metrics.count_cache("answer", found.as_ref().is_ok_and(|entry| !entry.is_fresh()));
        found.map(moka::Entry::into_value).map_err(|error| ApiError::clone(&error))
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
                let metrics = inner.metrics.clone();
                let all = inner.brightness_progress.clone();
                let map = inner.work.long(Lane::Map, BRIGHTNESS_BYTES, move |source, _| {
                    metrics.count_brightness_map();
                    let work = all.begin(&found_by);
                    let note = |done: f64| {
                        work.set(done);
                        true
                    };
                    Ok(Arc::new(source.brightness(&request, &view, &note)?))
                });
                map.await.map(|(map, _)| map)
            };
            shared(&state.brightnesses, &key, find, is_of_asker).await.map(moka::Entry::into_value)
        };
        // It goes on when its client has gone.
        let detached = Asker::new(asker::party(), Arc::default());
        // An answer says that it goes on before it is cut off.
        let patience = self.config.request_timeout().mul_f64(PART_WAITED_FOR);
        match tokio::time::timeout(patience, tokio::spawn(detached.scope(find.in_current_span()))).await {
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
            let bytes = influence_bytes(view.max_lit_pixels_around(request.sky.place));
            let found = self.work.long(Lane::Influence, bytes, move |source, work| {
                metrics.count_influences();
                Ok(Arc::new(source.influence(&request, &view, &|done| work.note(done))?))
            });
            found.await.map(|(map, _)| map)
        };
        let found = shared(&self.influences, key, find, is_of_asker).await;
        self.metrics.count_cache("influence", found.as_ref().is_ok_and(|entry| !entry.is_fresh()));
        found.map(moka::Entry::into_value).map_err(|error| ApiError::clone(&error))
    }
}
