//! The real program behind the interface: the demo scene, the CPU executor, made-up tables.

use crate::{server::header, whole_layers, whole_plans, whole_refusals, whole_uploads};
use serde_json::{Value, json};
use skyglow_app::{ObservatorySource, SkySource};
use skyglow_http::{Access, ApiKey, HttpConfig, access::hash_of, router_with_access, serve};
use skyglow_observatory::Observatory;
use skyglow_render::{DeviceChoice, Engine, EngineConfig, synthetic};
use skyglow_scene::{SceneStore, create_demo};
use skyglow_tables::Scattering;
use std::sync::Arc;

/// A server over the demo scene; its folder lives as long as it.
pub(crate) struct Whole {
    source: Arc<ObservatorySource>,
    pub(crate) base: String,
    pub(crate) client: reqwest::Client,
    pub(crate) folder: tempfile::TempDir,
}

fn access() -> Access {
    let key = ApiKey {
        name: "city".into(),
        blake3: hash_of(whole_uploads::KEY),
        requests_per_second: 100.0,
        request_burst: 100,
        requests_per_day: Some(10),
    };
    Access::new(Some(whole_uploads::TOKEN), vec![key]).unwrap()
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
        let source = ObservatorySource::new(Arc::new(observatory)).with_max_places(20_000);
        let source = Arc::new(source);
        let listener = tokio::net::TcpListener::bind("127.0.0.1:0").await.unwrap();
        let base = format!("http://{}", listener.local_addr().unwrap());
        let app = router_with_access(source.clone(), HttpConfig::default(), access());
        tokio::spawn(async move {
            serve(listener, app, &HttpConfig::default(), std::future::pending()).await.unwrap();
        });
        let client = reqwest::Client::builder().no_proxy().build().unwrap();
        Self { source, base, client, folder }
    }

    pub(crate) async fn get(&self, path: &str) -> reqwest::Response {
        self.client.get(format!("{}{path}", self.base)).send().await.unwrap()
    }

    pub(crate) async fn json(&self, path: &str) -> (u16, Value) {
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
    influences_are_those_of_the_sky(&whole, &place, &sky).await;
    influences_come_as_files_and_tiles(&whole, &place, (lat, lon)).await;
    bodies_are_answered_or_refused(&whole, &place, &sky).await;
    whole_plans::scenarios_change_every_query(&whole, (lat, lon), &sky).await;
    whole_plans::plans_are_made_kept_and_handed_out(&whole, (lat, lon), &sky).await;
    whole_plans::bodies_that_cannot_be_meant_are_refused(&whole, (lat, lon)).await;
    whole_refusals::bad_bodies_get_what_the_table_says(&whole).await;

    whole_layers::brightness_is_that_of_the_skies(&whole, (lat, lon)).await;
    whole_layers::layers_come_as_rasters(&whole, (lat, lon)).await;

    whole_uploads::scenes_are_put_and_deleted_by_the_operator(&whole, &place).await;
    whole_uploads::keys_are_counted(&whole).await;

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

async fn influences_are_those_of_the_sky(whole: &Whole, place: &str, sky: &Value) {
    let number = |value: &Value| value.as_f64().unwrap();
    for (measure, of_sky) in [
        ("zenith", "zenith_luminance_cd_m2"),
        ("mean", "mean_luminance_cd_m2"),
        ("horizontal", "horizontal_illuminance_lx"),
    ] {
        let path = format!("/api/v1/scenes/demo/influence.json?{place}&measure={measure}&limit=5");
        let (status, answer) = whole.json(&path).await;
        assert_eq!((status, &answer["measure"]), (200, &json!(measure)), "{answer}");
        let total = number(&answer["total"]);
        assert!((total / number(&sky["sky"][of_sky]) - 1.0).abs() < 1e-4, "{measure}");
        for parts in ["rings", "sectors"] {
            let shares = answer[parts].as_array().unwrap().iter().map(|part| number(&part["share"]));
            assert!((shares.sum::<f64>() - 1.0).abs() < 1e-6, "{measure} {parts}");
        }
        let pixels = answer["pixels"].as_array().unwrap();
        assert_eq!(pixels.len(), 5);
        assert!(pixels.windows(2).all(|pair| number(&pair[0]["influence"]) >= number(&pair[1]["influence"])));
        let last = number(&pixels[4]["cumulative_share"]);
        let sum: f64 = pixels.iter().map(|pixel| number(&pixel["share"])).sum();
        assert!((last - sum).abs() < 1e-12 && last > 0.0 && last <= 1.0);
        // Every number comes with what it depends on.
        for name in ["observer", "lamp", "emission", "calibration", "coverage", "local_optical_depth"] {
            assert_eq!(answer[name], sky[name], "{name}");
        }
    }
    let (_, one) = whole.json(&format!("/api/v1/scenes/demo/influence?{place}&limit=1")).await;
    let pixel = &one["pixels"][0];
    let at = format!("lat={}&lon={}", pixel["latitude_deg"], pixel["longitude_deg"]);
    let (_, site) = whole.json(&format!("/api/v1/scenes/demo/site?{at}")).await;
    assert_eq!(site["radiance_nw_cm2_sr"], pixel["radiance_nw_cm2_sr"]);
    assert_eq!((&one["measure"], &one["unit"]), (&json!("zenith"), &json!("cd m-2")));
}

async fn influences_come_as_files_and_tiles(whole: &Whole, place: &str, (lat, lon): (f64, f64)) {
    let path = format!("/api/v1/scenes/demo/influence.tif?{place}");
    let answer = whole.get(&path).await;
    assert_eq!((answer.status().as_u16(), header(&answer, "content-type")), (200, "image/tiff"));
    assert!(header(&answer, "server-timing").contains("cells;dur="));
    let tag = header(&answer, "etag").to_owned();
    let bytes = answer.bytes().await.unwrap();
    let mut raster = tiff::decoder::Decoder::new(std::io::Cursor::new(bytes)).unwrap();
    let (_, scene) = whole.json("/api/v1/scenes/demo").await;
    let size = (scene["grid"]["width"].as_u64().unwrap(), scene["grid"]["height"].as_u64().unwrap());
    assert_eq!(raster.dimensions().map(|(w, h)| (u64::from(w), u64::from(h))).unwrap(), size);
    let again = whole.client.get(format!("{}{path}", whole.base)).header("if-none-match", tag);
    assert_eq!(again.send().await.unwrap().status(), 304);

    let list =
        whole.get(&format!("/api/v1/scenes/demo/influence.csv?{place}&limit=3")).await.text().await.unwrap();
    let lines: Vec<&str> = list.lines().collect();
    assert_eq!(lines.len(), 4);
    assert!(
        lines[0].starts_with("rank,latitude_deg,") && lines[0].contains(",influence_cd_m2,"),
        "{}",
        lines[0]
    );
    assert!(lines.iter().all(|line| line.split(',').count() == 12));
    let accepting = whole.client.get(format!("{}/api/v1/scenes/demo/influence?{place}", whole.base));
    let points = accepting.header("accept", "application/geo+json").send().await.unwrap();
    assert_eq!(
        (header(&points, "vary"), header(&points, "content-type")),
        ("accept, accept-encoding", "application/geo+json")
    );
    let points: Value = points.json().await.unwrap();
    assert_eq!(
        (&points["type"], points["features"].as_array().unwrap().len()),
        (&json!("FeatureCollection"), 100)
    );
    let first = &points["features"][0];
    assert_eq!(first["geometry"]["coordinates"][0], first["properties"]["longitude_deg"]);

    let query = format!("{place}&measure=region&region=350,10;10,10;0,50");
    let (status, tilejson) =
        whole.json(&format!("/api/v1/scenes/demo/tiles/influence/tilejson.json?{query}")).await;
    assert_eq!(status, 200, "{tilejson}");
    let n = 256.0;
    let x = ((lon + 180.0) / 360.0 * n).floor();
    let y = ((1.0 - lat.to_radians().tan().asinh() / std::f64::consts::PI) / 2.0 * n).floor();
    let url = tilejson["tiles"][0].as_str().unwrap();
    assert!(url.ends_with(&query));
    let url = url.replace("{z}", "8").replace("{x}", &x.to_string()).replace("{y}", &y.to_string());
    let answer = whole.client.get(url).send().await.unwrap();
    assert_eq!(answer.status(), 200);
    let tile = image::load_from_memory(&answer.bytes().await.unwrap()).unwrap().into_rgba8();
    let shown = tile.pixels().filter(|pixel| pixel.0[3] > 0).count();
    assert!(shown > 0 && shown < tile.pixels().count(), "{shown}");
    assert!(tilejson["range"][1].as_f64().unwrap() > 0.0 && tilejson["unit"] == "cd m-2");
    let found = async || {
        let metrics = whole.get("/metrics").await.text().await.unwrap();
        let line = metrics.lines().find(|line| line.starts_with("skyglow_influence_maps_total ")).unwrap();
        line.split(' ').nth(1).unwrap().parse::<u32>().unwrap()
    };
    let before = found().await;
    for (zoom, x, y) in [(7, 66, 45), (8, 133, 91), (9, 267, 182), (2, 2, 1)] {
        let path = format!("/api/v1/scenes/demo/tiles/influence/{zoom}/{x}/{y}.png?{query}");
        assert_eq!(whole.get(&path).await.status(), 200);
    }
    assert_eq!(found().await, before, "tiles of one map are cut from one computation");
    assert_eq!(
        whole.get(&format!("/api/v1/scenes/demo/influence.csv?{query}&turbidity=2.7")).await.status(),
        200
    );
    assert_eq!(found().await, before + 1);
    let (status, problem) = whole.json("/api/v1/scenes/demo/tiles/influence/tilejson.json").await;
    assert_eq!((status, &problem["errors"][0]["parameter"]), (400, &json!("lat")));
    let (status, _) = whole.json(&format!("/api/v1/scenes/demo/tiles/radiance/tilejson.json?{place}")).await;
    assert_eq!(status, 400);
}

async fn bodies_are_answered_or_refused(whole: &Whole, place: &str, sky: &Value) {
    let post = async |end: &str, body: String| -> (u16, Value) {
        let request = whole.client.post(format!("{}/api/v1/scenes/demo/influence{end}{place}", whole.base));
        let answer = request.header("content-type", "application/json").body(body).send().await.unwrap();
        (answer.status().as_u16(), answer.json().await.unwrap())
    };
    let world = json!({"type": "Polygon", "coordinates": [[[-180, -90], [180, -90], [180, 90], [-180, 90], [-180, -90]]]});
    let feature = json!({"type": "Feature", "properties": {}, "geometry": world});
    for boundary in [world, feature] {
        let (status, answer) = post("?", json!({"boundary": boundary}).to_string()).await;
        assert_eq!(status, 200, "{answer}");
        assert!((answer["boundary"]["share"].as_f64().unwrap() - 1.0).abs() < 1e-6, "{}", answer["boundary"]);
        assert_eq!(answer["boundary"]["pixels"], answer["lit_pixels"]);
    }
    // A cap around the zenith as wide as that of the measure: the same directions.
    let cap: Vec<[f64; 2]> = (0..60).map(|k| [6.0 * f64::from(k), 85.0]).collect();
    let (status, answer) = post(".json?", json!({ "region": cap }).to_string()).await;
    assert_eq!((status, &answer["measure"]), (200, &json!("region")), "{answer}");
    let zenith = sky["sky"]["zenith_luminance_cd_m2"].as_f64().unwrap();
    assert!((answer["total"].as_f64().unwrap() / zenith - 1.0).abs() < 0.02);
    assert!(answer["region_sr"].as_f64().unwrap() > 0.02);

    let vertices =
        |count: usize| (0..count).map(|k| format!("[{}, 45]", k % 90)).collect::<Vec<_>>().join(",");
    let ring = |ring: &str| format!(r#"{{"boundary": {{"type": "Polygon", "coordinates": [[{ring}]]}}}}"#);
    for (name, end, body, status, parameter) in [
        ("no JSON", "?", "{".to_owned(), 400, "body"),
        ("NaN", "?", r#"{"region": [[NaN, 1], [2, 3], [4, 5]]}"#.to_owned(), 400, "body"),
        ("two corners", "?", r#"{"region": [[1, 1], [2, 3]]}"#.to_owned(), 400, "region"),
        ("a sliver", "?", r#"{"region": [[10, 45.1], [11, 45.1], [10.5, 45.2]]}"#.to_owned(), 400, "region"),
        ("an open ring", "?", ring("[7, 46], [8, 46], [8, 47]"), 400, "boundary"),
        ("an empty polygon", "?", ring(""), 400, "boundary"),
        ("60 000 corners", "?", ring(&vertices(60_000)), 400, "boundary"),
        (
            "a point",
            "?",
            r#"{"boundary": {"type": "Point", "coordinates": [7, 46]}}"#.to_owned(),
            400,
            "boundary",
        ),
        ("a boundary for a raster", ".tif?", ring("[7, 46], [8, 46], [8, 47], [7, 46]"), 400, "boundary"),
    ] {
        let (got, problem) = post(end, body).await;
        assert_eq!(
            (got, &problem["errors"][0]["parameter"]),
            (status, &json!(parameter)),
            "{name}: {problem}"
        );
    }
    // Whatever is odd and allowed is answered.
    let corners = |corners: &[(f64, f64)]| {
        let text: Vec<String> =
            corners.iter().map(|(azimuth, elevation)| format!("{azimuth},{elevation}")).collect();
        text.join(";")
    };
    for (query, statuses) in [
        (format!("region={}", corners(&[(0.0, 0.0), (120.0, 0.0), (240.0, 0.0)])), [200, 400]),
        (format!("region={}", corners(&[(0.0, 90.0), (0.0, 0.0), (1e6, 45.0)])), [200, 400]),
        (
            format!("region={}", corners(&[(-1e9, 89.0), (90.0, 89.0), (200.0, 89.0), (300.0, 0.0)])),
            [200, 400],
        ),
        ("limit=0".to_owned(), [200, 200]),
        ("limit=10000&measure=norm&turbidity=3.9".to_owned(), [200, 200]),
        ("measure=norm&lamp=0,0,1".to_owned(), [200, 200]),
        ("emission=0,1,0&altitude=5900&measure=mean".to_owned(), [200, 200]),
        ("tolerance=0.3&terrain=off&scattering=single".to_owned(), [200, 200]),
    ] {
        let (status, answer) = whole.json(&format!("/api/v1/scenes/demo/influence?{place}&{query}")).await;
        assert!(statuses.contains(&status), "{query}: {answer}");
        let is_whole = answer["total"].as_f64().is_some_and(|total| total.is_finite() && total > 0.0);
        assert!(status != 200 || is_whole, "{query}: {}", answer["total"]);
    }
    for (name, body) in [("10^6 corners", ring(&vertices(1_000_000))), ("100 MB", " ".repeat(100 << 20))] {
        let request = whole.client.post(format!("{}/api/v1/scenes/demo/influence?{place}", whole.base));
        // The server may stop reading and close before all is sent.
        match request.body(body).send().await {
            Ok(answer) => assert_eq!(answer.status(), 413, "{name}"),
            Err(error) => assert!(error.is_request() || error.is_body(), "{name}: {error}"),
        }
        assert_eq!(whole.get("/healthz").await.status(), 200);
    }
}
