//! Counters for Prometheus (OpenMetrics text). Paths are the routes' patterns, never a client's URL.

use prometheus_client::{
    collector::Collector,
    encoding::{DescriptorEncoder, EncodeMetric, text::encode},
    metrics::{
        counter::{ConstCounter, Counter},
        family::Family,
        gauge::{ConstGauge, Gauge},
        histogram::Histogram,
    },
    registry::{Registry, Unit},
};
use skyglow_app::source::SkySource;
use std::{sync::Arc, time::Duration};

/// Names and values of labels.
type Labels = Vec<(&'static str, String)>;

/// The counters of the interface, and over them those of the engine.
#[derive(Debug)]
pub struct Metrics {
    registry: Registry,
    requests: Family<Labels, Counter>,
    durations: Family<Labels, Histogram>,
    refused: Family<Labels, Counter>,
    panics: Counter,
    influences: Counter,
    brightness_maps: Counter,
    cache: Family<Labels, Counter>,
    in_flight: Gauge,
    /// Bytes of request bodies in memory.
    pub(crate) body_bytes: Gauge,
    /// Bytes taken for work under way and its answers, cached ones included.
    pub(crate) work_bytes: Gauge,
    /// Whether Valkey does not answer.
    pub(crate) valkey_away: Gauge,
    /// Bytes of answers that are being sent.
    pub(crate) sending_bytes: Gauge,
}

/// Why requests are turned away. Each is counted from 0 on: a sum over what is not there is nothing, and no alert.
pub const REFUSAL_REASONS: [&str; 10] =
    ["busy", "timeout", "rate", "quota", "secret", "body", "keeping", "work", "sending", "jobs"];
/// The caches in memory.
const CACHES: [&str; 4] = ["sky", "answer", "influence", "brightness"];

/// Upper ends of the duration buckets, seconds.
const BUCKETS_S: [f64; 13] = [0.001, 0.0025, 0.005, 0.01, 0.025, 0.05, 0.1, 0.25, 0.5, 1.0, 2.5, 5.0, 10.0];

impl Metrics {
    /// Counters at zero, with the engine's read from `source` at each scrape.
    pub fn new(source: Arc<dyn SkySource>) -> Self {
        let mut registry = Registry::with_prefix("skyglow");
        let requests = Family::<Labels, Counter>::default();
        let durations =
            Family::<Labels, Histogram>::new_with_constructor(|| Histogram::new(BUCKETS_S.iter().copied()));
        let refused = Family::<Labels, Counter>::default();
        let (panics, influences, in_flight) = (Counter::default(), Counter::default(), Gauge::default());
        let (brightness_maps, cache) = (Counter::default(), Family::<Labels, Counter>::default());
        registry.register(
            "brightness_maps",
            "Maps of the zenith's brightness found; tiles were cut from those",
            brightness_maps.clone(),
        );
        registry.register(
            "cache_lookups",
            "Look-ups in the caches in memory, by cache and result",
            cache.clone(),
        );
        registry.register(
            "influence_maps",
            "Maps of influences found; other answers and tiles were cut from those",
            influences.clone(),
        );
        registry.register("http_requests", "Requests answered, by route and status", requests.clone());
        registry.register_with_unit(
            "http_request_duration",
            "Time from request to answer, by route",
            Unit::Seconds,
            durations.clone(),
        );
        registry.register("http_refused", "Requests turned away: busy, rate limit, timeout", refused.clone());
        registry.register("http_panics", "Requests that ran into a defect", panics.clone());
        registry.register("http_in_flight", "Requests under way", in_flight.clone());
        let [body_bytes, work_bytes, sending_bytes] = std::array::from_fn(|_| Gauge::default());
        for (name, words, gauge) in [
            ("http_body", "Bodies of requests in memory", &body_bytes),
            ("http_work", "Memory for work under way and its answers, cached ones included", &work_bytes),
            ("http_sending", "Answers that are being sent", &sending_bytes),
        ] {
            registry.register_with_unit(name, words, Unit::Bytes, Gauge::clone(gauge));
        }
        let valkey_away = Gauge::default();
        registry.register(
            "valkey_away",
            "1 while Valkey does not answer: limits and drafts are then this server's own",
            valkey_away.clone(),
        );
        registry.register_collector(Box::new(SourceCollector(source)));
        for reason in REFUSAL_REASONS {
            drop(refused.get_or_create(&vec![("reason", reason.to_owned())]));
        }
        for (cache_name, result) in CACHES.into_iter().flat_map(|name| [(name, "hit"), (name, "miss")]) {
            drop(cache.get_or_create(&vec![("cache", cache_name.to_owned()), ("result", result.to_owned())]));
        }
        Self {
            registry,
            requests,
            durations,
            refused,
            panics,
            influences,
            brightness_maps,
            cache,
            in_flight,
            body_bytes,
            work_bytes,
            valkey_away,
            sending_bytes,
        }
    }

    /// Counts an answered request.
    pub fn count(&self, method: &str, route: &str, status: u16, duration: Duration) {
        self.requests
            .get_or_create(&vec![
                ("method", method.to_owned()),
                ("path", route.to_owned()),
                ("status", status.to_string()),
            ])
            .inc();
        self.durations.get_or_create(&vec![("path", route.to_owned())]).observe(duration.as_secs_f64());
    }

    /// Counts a request that was turned away.
    ///
    /// * `reason`: of [`REFUSAL_REASONS`].
    pub fn count_refused(&self, reason: &'static str) {
        self.refused.get_or_create(&vec![("reason", reason.to_owned())]).inc();
    }

    /// Counts a map of influences that was found.
    pub fn count_influences(&self) {
        self.influences.inc();
    }

    /// Counts a map of the zenith's brightness that was found.
    pub fn count_brightness_map(&self) {
        self.brightness_maps.inc();
    }

    /// Counts a look-up in a cache.
    pub fn count_cache(&self, cache: &'static str, was_there: bool) {
        let result = if was_there { "hit" } else { "miss" };
        self.cache.get_or_create(&vec![("cache", cache.to_owned()), ("result", result.to_owned())]).inc();
    }

    /// Counts a panic.
    pub fn count_panic(&self) {
        self.panics.inc();
    }

    /// Counts a request as under way until the guard is dropped.
    pub fn under_way(self: &Arc<Self>) -> InFlight {
        self.in_flight.inc();
        InFlight(self.clone())
    }

    /// The text of a scrape.
    ///
    /// # Errors
    /// What the encoder says.
    pub fn text(&self) -> Result<String, std::fmt::Error> {
        let mut text = String::new();
        encode(&mut text, &self.registry)?;
        Ok(text)
    }
}

/// A request under way.
#[derive(Debug)]
pub struct InFlight(Arc<Metrics>);

impl Drop for InFlight {
    fn drop(&mut self) {
        self.0.in_flight.dec();
    }
}

/// Reads the engine's counters.
struct SourceCollector(Arc<dyn SkySource>);

impl std::fmt::Debug for SourceCollector {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str("SourceCollector")
    }
}

impl Collector for SourceCollector {
    fn encode(&self, mut encoder: DescriptorEncoder) -> Result<(), std::fmt::Error> {
        let stats = self.0.stats();
        let left_out = self.0.left_out();
        for (name, help, value) in [
            ("engine_queue_length", "Requests that wait for the engine", stats.queue_length as i64),
            ("engine_queue_capacity", "Requests that may wait", stats.queue_capacity as i64),
            ("engine_largest_batch", "Requests in the largest batch so far", stats.largest_batch as i64),
            ("engine_ready", "Whether the engine answers", i64::from(self.0.is_ready())),
            ("scenes_open", "Scenes in memory", self.0.open_scenes() as i64),
            ("packs_left_out", "Table packs left out because they are damaged", left_out.packs.len() as i64),
            ("scenes_left_out", "Scenes left out because they are damaged", left_out.scenes.len() as i64),
        ] {
            let gauge = ConstGauge::new(value);
            gauge.encode(encoder.encode_descriptor(name, help, None, gauge.metric_type())?)?;
        }
        for (name, help, value) in [
            ("engine_rendered", "Skies rendered", stats.rendered),
            (
                "engine_dark_requests",
                "Skies answered without rendering, for want of light",
                stats.dark_requests,
            ),
            ("engine_refused", "Requests refused because the queue was full", stats.refused),
            ("engine_failed", "Requests that a device fault failed", stats.failed),
            ("engine_batches", "Batches submitted", stats.batches),
            ("engine_device_losses", "Times the device was lost and made anew", stats.device_losses),
        ] {
            let counter = ConstCounter::new(value);
            counter.encode(encoder.encode_descriptor(name, help, None, counter.metric_type())?)?;
        }
        for (name, help, label, names) in [
            ("pack_left_out", "1 for each table pack that is left out", "pack", &left_out.packs),
            ("scene_left_out", "1 for each scene that is left out", "scene", &left_out.scenes),
        ] {
            let gauge = ConstGauge::new(1i64);
            let mut family = encoder.encode_descriptor(name, help, None, gauge.metric_type())?;
            for name in names {
                gauge.encode(family.encode_family(&[(label, name.as_str())])?)?;
            }
        }
        let passes = ConstCounter::new(0.0f64);
        let mut family = encoder.encode_descriptor(
            "engine_pass",
            "Time spent in each pass",
            Some(&Unit::Seconds),
            passes.metric_type(),
        )?;
        for pass in stats.passes {
            let labels = [("pass", pass.name)];
            ConstCounter::new(pass.microseconds * 1e-6).encode(family.encode_family(&labels)?)?;
        }
        Ok(())
    }
}
