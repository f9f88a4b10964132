//! The real program behind the interface: the demo scene, the CPU executor, synthetic tables. One server for all tests, as making
//! its scene takes longer than asking it; each test uses scenarios, plans and scenes of its own.

mod bodies;
mod darker;
mod horizon;
mod influence;
mod kept;
mod layers;
mod night_sky;
mod plans;
mod refusals;
mod replicas;
mod scenarios;
mod shares;
mod skies;
mod sky;
mod standards;
mod uploads;

use serde_json::{Value, json};
use skyglow_app::{ObservatorySource, SkySource};
use skyglow_http::{Access, ApiKey, HttpConfig, access::hash_of, router_with_access, serve};
use skyglow_observatory::{CacheSizes, Observatory};
use skyglow_physics::Turbidity;
use skyglow_render::{DeviceChoice, Engine, EngineConfig, celestial::CelestialTables, synthetic};
use skyglow_scene::{ChangeLimits, ChangeStore, SceneStore, create_demo};
use skyglow_tables::{CelestialTable, Scattering};
use std::{
    path::Path,
    sync::{Arc, LazyLock},
    thread,
    time::Duration,
};
use tokio::sync::{RwLock, RwLockReadGuard, RwLockWriteGuard};

/// The operator's token, the key of a client that may not upload, and that of one whose quota is used up.
const TOKEN: &str = "the-operators-token-of-a-test";
const KEY: &str = "a-citys-key";
const COUNTED_KEY: &str = "the-key-of-a-city-that-asks-much";
/// Requests a day that the counted key may send.
const COUNTED_REQUESTS: u64 = 10;

/// What is started once, on a thread of its own.
struct Running {
    source: Arc<ObservatorySource>,
    base: String,
}

static RUNNING: LazyLock<Running> = LazyLock::new(|| {
    let (send, receive) = std::sync::mpsc::channel();
    thread::spawn(move || {
        let runtime = tokio::runtime::Runtime::new().unwrap();
        runtime.block_on(async {
            let source = tokio::task::spawn_blocking(source).await.unwrap();
            let listener = tokio::net::TcpListener::bind("127.0.0.1:0").await.unwrap();
            let base = format!("http://{}", listener.local_addr().unwrap());
            // Tests run beside each other on machines that have other work too.
            let config = HttpConfig { request_timeout_s: 180.0, ..HttpConfig::default() };
            let app = router_with_access(source.clone(), config.clone(), access());
            while !source.is_ready() {
                tokio::time::sleep(Duration::from_millis(10)).await;
            }
            send.send(Running { source, base }).unwrap();
            serve(listener, app, &config, std::future::pending()).await.unwrap();
        });
    });
    receive.recv().unwrap()
});

/// The server's folder. Nothing is dropped at the end of a process that shares it, so each run empties what the last one left.
fn folder() -> &'static Path {
    Path::new(concat!(env!("CARGO_TARGET_TMPDIR"), "/interface"))
}

fn source() -> Arc<ObservatorySource> {
    if folder().exists() {
        std::fs::remove_dir_all(folder()).unwrap();
    }
    create_demo(&SceneStore::new(folder()), &mut |_| {}).unwrap();
    source_over(folder(), ChangeStore::new(folder(), ChangeLimits::default()))
}

/// The program before the scenes of a folder.
fn source_over(data: &Path, changes: ChangeStore) -> Arc<ObservatorySource> {
    let mut tables = synthetic::table_set(&[1.5, 2.5, 4.0, 6.0], 24);
    tables.extend(synthetic::table_set_of(Scattering::Multiple, &[1.5, 2.5, 4.0], 24));
    let config = EngineConfig { device: DeviceChoice::Cpu, tables, ..EngineConfig::default() };
    let celestial = [1.5, 2.5, 4.0].map(|t| CelestialTable::synthetic(Turbidity::new(t).unwrap()));
    let (engine, sizes) = (Engine::start(config).unwrap(), CacheSizes::of_machine());
    let observatory = Observatory::with_changes(engine, Vec::new(), data, 2, changes, &sizes)
        .with_celestial_tables(CelestialTables::new(celestial.into()).unwrap());
    Arc::new(ObservatorySource::new(Arc::new(observatory)).with_max_places(20_000))
}

fn access() -> Access {
    let key = |name: &str, secret, requests_per_day| ApiKey {
        name: name.into(),
        blake3: hash_of(secret),
        requests_per_second: 100.0,
        request_burst: 100,
        requests_per_day,
    };
    let keys = vec![key("city", KEY, None), key("asks-much", COUNTED_KEY, Some(COUNTED_REQUESTS))];
    Access::new(Some(TOKEN), keys).unwrap()
}

/// Tests hold it together, but for those that count what the program did: they hold it alone.
static TURN: RwLock<()> = RwLock::const_new(());

/// The server as one test uses it, with a client of the test's own runtime.
pub(crate) struct EndToEnd {
    source: &'static ObservatorySource,
    pub(crate) base: &'static str,
    pub(crate) client: reqwest::Client,
    _turn: (Option<RwLockReadGuard<'static, ()>>, Option<RwLockWriteGuard<'static, ()>>),
}

/// A lit place of the demo scene.
struct Town {
    latitude_deg: f64,
    longitude_deg: f64,
    /// Both as the parameters of a request.
    query: String,
}

impl EndToEnd {
    /// Beside other tests.
    pub(crate) async fn shared() -> Self {
        Self::with((Some(TURN.read().await), None))
    }

    /// While no other test runs.
    async fn alone() -> Self {
        Self::with((None, Some(TURN.write().await)))
    }

    fn with(turn: (Option<RwLockReadGuard<'static, ()>>, Option<RwLockWriteGuard<'static, ()>>)) -> Self {
        let client = reqwest::Client::builder().no_proxy().build().unwrap();
        Self { source: &RUNNING.source, base: &RUNNING.base, client, _turn: turn }
    }

    pub(crate) async fn get(&self, path: &str) -> reqwest::Response {
        self.client.get(format!("{}{path}", self.base)).send().await.unwrap()
    }

    /// The answer to who has that of `tag`.
    async fn get_unless(&self, path: &str, tag: &str) -> u16 {
        let request = self.client.get(format!("{}{path}", self.base)).header("if-none-match", tag);
        request.send().await.unwrap().status().as_u16()
    }

    pub(crate) async fn json(&self, path: &str) -> (u16, Value) {
        let answer = self.get(path).await;
        (answer.status().as_u16(), answer.json().await.unwrap())
    }

    /// The first place that the scene names.
    async fn town(&self) -> Town {
        let (_, places) = self.json("/api/v1/scenes/demo/places").await;
        let (latitude_deg, longitude_deg) =
            (number(&places[0]["latitude_deg"]), number(&places[0]["longitude_deg"]));
        let query = format!("lat={latitude_deg}&lon={longitude_deg}");
        Town { latitude_deg, longitude_deg, query }
    }

    async fn sky(&self, query: &str) -> Value {
        let (status, sky) = self.json(&format!("/api/v1/scenes/demo/sky?{query}")).await;
        assert_eq!(status, 200, "{query}: {sky}");
        sky
    }

    /// A counter of the metrics.
    async fn counted(&self, name: &str) -> u32 {
        let metrics = self.get("/metrics").await.text().await.unwrap();
        let line = metrics.lines().find_map(|line| line.strip_prefix(&format!("{name} ")));
        line.unwrap().parse().unwrap()
    }

    /// A map tile over the town, from the address that a layer's TileJSON gives. `suffix` follows the row's number.
    async fn tile_over(&self, town: &Town, tilejson: &Value, zoom: u32, suffix: &str) -> image::RgbaImage {
        let n = f64::from(zoom).exp2();
        let x = ((town.longitude_deg + 180.0) / 360.0 * n).floor();
        let y = (1.0 - town.latitude_deg.to_radians().tan().asinh() / std::f64::consts::PI) / 2.0 * n;
        let url = tilejson["tiles"][0].as_str().unwrap();
        let url = url.replace("{z}", &zoom.to_string()).replace("{x}", &x.to_string());
        let url = url.replace("{y}", &format!("{}{suffix}", y.floor()));
        let answer = self.client.get(url).send().await.unwrap();
        assert_eq!(answer.status(), 200);
        image::load_from_memory(&answer.bytes().await.unwrap()).unwrap().into_rgba8()
    }

    /// Posts JSON that makes a scenario or a plan: status and answer, and 201 alone comes with the address of what was made.
    async fn post(&self, path: &str, body: &Value) -> (u16, Value) {
        let request = self.client.post(format!("{}/api/v1/scenes/demo/{path}", self.base));
        let answer = request.json(body).send().await.unwrap();
        let location = answer.headers().get("location").map(|value| value.to_str().unwrap().to_owned());
        let status = answer.status().as_u16();
        let answer: Value = answer.json().await.unwrap();
        assert_eq!(location.is_some(), status == 201, "{answer}");
        assert!(location.is_none_or(|location| location.ends_with(answer["id"].as_str().unwrap())));
        (status, answer)
    }
}

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or_else(|| panic!("{value} is no number"))
}

fn zenith(sky: &Value) -> f64 {
    number(&sky["sky"]["zenith_luminance_cd_m2"])
}

/// The entry of a list that has this id.
fn entry<'a>(list: &'a Value, id: &Value) -> Option<&'a Value> {
    list.as_array().unwrap().iter().find(|entry| entry["id"] == *id)
}

/// The demo scene among all.
async fn demo(server: &EndToEnd) -> Value {
    let (_, scenes) = server.json("/api/v1/scenes").await;
    entry(&scenes, &json!("demo")).unwrap().clone()
}
