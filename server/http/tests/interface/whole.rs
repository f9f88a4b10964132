//! The real program behind the interface: the demo scene, the CPU executor, made-up tables.

use crate::server::header;
use serde_json::{Value, json};
use skyglow_engine::{DeviceChoice, Engine, EngineConfig, Observatory, synthetic};
use skyglow_http::{HttpConfig, ObservatorySource, SkySource, router, serve};
use skyglow_scene::{SceneStore, create_demo};
use skyglow_tables::Scattering;
use std::sync::Arc;

/// A server over the demo scene; its folder lives as long as it.
struct Whole {
    source: Arc<ObservatorySource>,
    base: String,
    client: reqwest::Client,
    _folder: tempfile::TempDir,
}

impl Whole {
    async fn start() -> Self {
        let folder = tempfile::tempdir().unwrap();
        let data = folder.path().to_owned();
        let observatory = tokio::task::spawn_blocking(move || {
            create_demo(&SceneStore::new(&data), &mut |_| {}).unwrap();
            let mut tables = synthetic::table_set(&[1.5, 2.5, 4.0, 6.0], 24);
            tables.extend(synthetic::table_set_of(Scattering::Multiple, &[1.5, 2.5, 4.0], 24));
            let config = EngineConfig { device: DeviceChoice::Cpu, tables, ..EngineConfig::default() };
            Observatory::new(Engine::start(config).unwrap(), Vec::new(), &data, 2)
        })
        .await
        .unwrap();
        let source = Arc::new(ObservatorySource::new(Arc::new(observatory)));
        let listener = tokio::net::TcpListener::bind("127.0.0.1:0").await.unwrap();
        let base = format!("http://{}", listener.local_addr().unwrap());
        let app = router(source.clone(), HttpConfig::default());
        tokio::spawn(async move {
            serve(listener, app, &HttpConfig::default(), std::future::pending()).await.unwrap();
        });
        let client = reqwest::Client::builder().no_proxy().build().unwrap();
        Self { source, base, client, _folder: folder }
    }

    async fn get(&self, path: &str) -> reqwest::Response {
        self.client.get(format!("{}{path}", self.base)).send().await.unwrap()
    }

    async fn json(&self, path: &str) -> (u16, Value) {
        let answer = self.get(path).await;
        (answer.status().as_u16(), answer.json().await.unwrap())
    }
}

/// One test: making the scene takes longer than asking it.
#[tokio::test(flavor = "multi_thread")]
async fn a_place_in_the_demo_scene_shows_its_sky() {
    let whole = Whole::start().await;
    while !whole.source.is_ready() {
        tokio::time::sleep(std::time::Duration::from_millis(10)).await;
    }
    assert_eq!(whole.get("/readyz").await.status(), 200);
    let (_, scenes) = whole.json("/api/v1/scenes").await;
    let scene = &scenes[0];
    assert_eq!(scene["id"], "demo");
    assert_eq!(scene["illustrative"], true);
    let (_, places) = whole.json("/api/v1/scenes/demo/places").await;
    let (lat, lon) =
        (places[0]["latitude_deg"].as_f64().unwrap(), places[0]["longitude_deg"].as_f64().unwrap());
    let place = format!("lat={lat}&lon={lon}");

    let (status, site) = whole.json(&format!("/api/v1/scenes/demo/site?{place}")).await;
    assert_eq!(status, 200);
    assert!(site["radiance_nw_cm2_sr"].as_f64().unwrap() > 0.0, "{site}");

    let answer = whole.get(&format!("/api/v1/scenes/demo/sky?{place}")).await;
    assert_eq!(answer.status(), 200);
    assert!(!header(&answer, "server-timing").is_empty());
    let tag = header(&answer, "etag").to_owned();
    let sky: Value = answer.json().await.unwrap();
    assert!(sky["sky"]["zenith_luminance_cd_m2"].as_f64().unwrap() > 0.0);
    // Two fluxes, two names: that around the place, and in the scene's report that of all its lights.
    let (around, all) = (&sky["flux_within_300_km_dnb_w"], &scene["report"]["flux_dnb_w"]);
    assert!(around.as_f64().unwrap() > 0.0 && around.as_f64().unwrap() <= 1.000_001 * all.as_f64().unwrap());
    assert!(sky.get("flux_dnb_w").is_none());
    assert_eq!(sky["observer"]["terrain_altitude_m"], site["terrain_altitude_m"]);
    assert_eq!(sky["executor"], "cpu");

    // The engine's own counter: 304 renders nothing, and the panorama of the same sky comes from the cache.
    let rendered = whole.source.stats().rendered;
    assert_eq!(rendered, 1);
    let again = whole.client.get(format!("{}/api/v1/scenes/demo/sky?{place}", whole.base));
    assert_eq!(again.header("if-none-match", tag).send().await.unwrap().status(), 304);
    let (_, panorama) = whole.json(&format!("/api/v1/scenes/demo/panorama.json?{place}")).await;
    assert_eq!(panorama["sky"], sky["sky"]);
    assert_eq!(whole.source.stats().rendered, rendered);
    let png = whole.get(&format!("/api/v1/scenes/demo/panorama.png?{place}&turbidity=3.1")).await;
    assert_eq!(png.status(), 200);
    assert_eq!(whole.source.stats().rendered, rendered + 1);

    let (_, open) = whole.json(&format!("/api/v1/scenes/demo/panorama.json?{place}&terrain=off")).await;
    a_tolerance_is_kept(&whole, &place, &open).await;

    let (status, problem) = whole.json("/api/v1/scenes/demo/sky?lat=80&lon=0").await;
    assert_eq!((status, &problem["bounds"]), (404, &scene["bounds"]));
    let (status, problem) = whole.json(&format!("/api/v1/scenes/demo/sky?{place}&turbidity=5")).await;
    assert_eq!(
        (status, &problem["errors"][0]["allowed"]),
        (422, &json!("1.5 to 4 with multiple scattering"))
    );
    let (status, single) =
        whole.json(&format!("/api/v1/scenes/demo/sky?{place}&turbidity=5&scattering=single")).await;
    assert_eq!((status, &single["scattering"]), (200, &json!("single")));
    let (_, single) = whole.json(&format!("/api/v1/scenes/demo/sky?{place}&scattering=single")).await;
    assert_eq!(sky["scattering"], "multiple");
    let zenith = |sky: &Value| sky["sky"]["zenith_luminance_cd_m2"].as_f64().unwrap();
    assert!(zenith(&sky) > 1.001 * zenith(&single), "{} {}", zenith(&sky), zenith(&single));
    let (status, _) = whole.json(&format!("/api/v1/scenes/demo/sky?{place}&height=99000")).await;
    assert_eq!(status, 422);
    let (status, _) = whole.json("/api/v1/scenes/none/sky?lat=0&lon=0").await;
    assert_eq!(status, 404);

    for layer in ["radiance", "elevation"] {
        let (_, tilejson) = whole.json(&format!("/api/v1/scenes/demo/tiles/{layer}/tilejson.json")).await;
        let (z, n) = (7.0f64, 128.0);
        let x = ((lon + 180.0) / 360.0 * n).floor();
        let y = ((1.0 - lat.to_radians().tan().asinh() / std::f64::consts::PI) / 2.0 * n).floor();
        let url = tilejson["tiles"][0].as_str().unwrap();
        let url =
            url.replace("{z}", &z.to_string()).replace("{x}", &x.to_string()).replace("{y}", &y.to_string());
        let answer = whole.client.get(url).send().await.unwrap();
        assert_eq!(answer.status(), 200);
        let tile = image::load_from_memory(&answer.bytes().await.unwrap()).unwrap().into_rgba8();
        assert!(tile.pixels().any(|pixel| pixel.0[3] > 0), "{layer} shows something");
    }
}

/// Fewer functions are used, and the sky is as near to that of all as the answer says; a tighter tolerance takes more.
async fn a_tolerance_is_kept(whole: &Whole, place: &str, all: &Value) {
    let samples = |panorama: &Value| -> Vec<f64> {
        let bands = panorama["radiance"].as_array().unwrap().iter();
        let rows = bands.flat_map(|band| band.as_array().unwrap()).flat_map(|row| row.as_array().unwrap());
        rows.map(|value| value.as_f64().unwrap()).collect()
    };
    let whole_sky = samples(all);
    assert_eq!((&all["basis_count"], &all["basis_error_bound"]), (&json!(24), &Value::Null));
    let mut counts = Vec::new();
    for tolerance in [0.5, 0.05, 0.0001] {
        let path = format!("/api/v1/scenes/demo/panorama.json?{place}&terrain=off&tolerance={tolerance}");
        let (status, sky) = whole.json(&path).await;
        let bound = sky["basis_error_bound"].as_f64().unwrap();
        assert!(status == 200 && bound <= tolerance, "{bound} {tolerance}");
        let difference = samples(&sky).iter().zip(&whole_sky).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        counts.push((sky["basis_count"].as_u64().unwrap(), difference > 0.0));
    }
    assert_eq!((counts[0], counts[2]), ((8, true), (24, false)), "{counts:?}");
    assert!(counts[1].0 >= counts[0].0, "{counts:?}");
}
