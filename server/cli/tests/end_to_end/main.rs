//! The built program as a server: the demo scene, packs made here, lavapipe, HTTP on a port of its own.
#![allow(clippy::unwrap_used, clippy::expect_used, reason = "what cannot be set up fails the test")]

mod commands;
#[path = "../common/mod.rs"]
mod common;

use common::{
    server::{Answer, Server},
    skyglow, text,
};
use serde_json::Value;
use skyglow_physics::Turbidity;
use skyglow_tables::{NoProgress, PrecomputeOptions, precompute};
use std::{
    path::PathBuf,
    sync::{Arc, Mutex, OnceLock, PoisonError, Weak},
};

/// Locarno, in the demo scene.
const PLACE: &str = "lat=46.17&lon=8.79";

/// Packs of no accuracy, for turbidities 2 and 3, and a data folder with the demo: made once for all tests here.
struct Ground {
    folder: PathBuf,
}

impl Ground {
    fn get() -> &'static Self {
        static GROUND: OnceLock<Ground> = OnceLock::new();
        GROUND.get_or_init(|| {
            let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join("end-to-end");
            let _ = std::fs::remove_dir_all(&folder);
            for turbidity in [2.0, 3.0] {
                let options = PrecomputeOptions::coarse(Turbidity::new(turbidity).unwrap());
                precompute(&options, &folder.join("packs"), &NoProgress).unwrap();
            }
            Ground { folder }
        })
    }

    fn data(&self) -> PathBuf {
        self.folder.join("data")
    }

    fn packs(&self) -> PathBuf {
        self.folder.join("packs")
    }

    fn server(&self) -> Server {
        Server::start(&self.data(), &["--packs", text(&self.packs()), "--device", "lavapipe"])
    }
}

/// One server for the tests that only ask, while any of them runs; the last one ends it.
fn server() -> Arc<Server> {
    static SERVER: Mutex<Weak<Server>> = Mutex::new(Weak::new());
    let mut shared = SERVER.lock().unwrap_or_else(PoisonError::into_inner);
    shared.upgrade().unwrap_or_else(|| {
        let server = Arc::new(Ground::get().server());
        *shared = Arc::downgrade(&server);
        server
    })
}

fn number(value: &Value, name: &str) -> f64 {
    value[name].as_f64().unwrap_or_else(|| panic!("no number {name} in {value}"))
}

#[test]
fn a_clicked_place_shows_its_sky() {
    let server = server();
    assert_eq!(server.get("/healthz").status, 200);
    let scenes = server.get("/api/v1/scenes").json();
    assert_eq!((&scenes[0]["id"], &scenes[0]["illustrative"]), (&"demo".into(), &true.into()));

    let site = server.get(&format!("/api/v1/scenes/demo/site?{PLACE}")).json();
    assert!(number(&site, "terrain_altitude_m") >= 0.0, "{site}");

    let sky = server.get(&format!("/api/v1/scenes/demo/sky?{PLACE}")).json();
    assert!(number(&sky["sky"], "ratio_to_natural") > 0.0, "{sky}");
    assert_eq!(sky["lamp"]["preset"], "mixed");
    assert!((0.0..=1.0).contains(&number(&sky, "coverage")));

    let viewer = server.get("/");
    assert_eq!(viewer.status, 200);
    assert!(viewer.text().contains("<script"), "no viewer is built in");
}

/// The picture is a PNG of the requested size with more than one colour.
#[test]
fn the_picture_is_a_png_of_the_requested_size() {
    let server = server();
    let answer = server.get(&format!(
        "/api/v1/scenes/demo/panorama.png?{PLACE}&width=512&height_px=128&legend=off&style=false_colour"
    ));
    assert_eq!((answer.status, answer.header("content-type")), (200, "image/png"));
    let mut reader = png::Decoder::new(std::io::Cursor::new(&answer.body)).read_info().unwrap();
    let mut pixels = vec![0; reader.output_buffer_size().unwrap()];
    let frame = reader.next_frame(&mut pixels).unwrap();
    assert_eq!((frame.width, frame.height), (512, 128));
    let step = frame.buffer_size() / (512 * 128);
    let colours: std::collections::BTreeSet<&[u8]> = pixels.chunks_exact(step).collect();
    assert!(colours.len() > 16, "{} colours", colours.len());
}

/// The raw grid is lit, finite, and brightest where the numbers say.
#[test]
fn the_raw_grid_fits_the_reported_numbers() {
    let server = server();
    let panorama = server.get(&format!("/api/v1/scenes/demo/panorama.json?{PLACE}")).json();
    let rows = panorama["radiance"][1].as_array().unwrap();
    assert_eq!(rows.len(), 64);
    let (mut brightest, mut at) = (0.0, (0, 0));
    for (row, values) in rows.iter().enumerate() {
        let values = values.as_array().unwrap();
        assert_eq!(values.len(), 256);
        for (column, value) in values.iter().enumerate() {
            let bands: Vec<f64> =
                (0..3).map(|band| panorama["radiance"][band][row][column].as_f64().unwrap()).collect();
            assert!(bands.iter().all(|value| value.is_finite() && *value >= 0.0), "{value}");
            let luminance_cd_m2 = panorama["values"][row][column].as_f64().unwrap();
            if luminance_cd_m2 > brightest {
                (brightest, at) = (luminance_cd_m2, (row, column));
            }
        }
    }
    let sky = &panorama["sky"];
    assert!((brightest / number(sky, "brightest_luminance_cd_m2") - 1.0).abs() < 1e-5);
    assert!((number(sky, "brightest_azimuth_deg") - at.1 as f64 * 360.0 / 256.0).abs() < 1e-6);
    assert!((number(sky, "brightest_elevation_deg") - (at.0 as f64 + 0.5) * 90.0 / 64.0).abs() < 1e-6);
}

/// Every kind of bad request is told what is wrong.
#[test]
fn bad_requests_are_told_what_is_wrong() {
    let server = server();
    let sky = "/api/v1/scenes/demo/sky";
    let cases = [
        ("place outside", format!("{sky}?lat=-1.3&lon=36.8"), 404, "outside", None),
        ("altitude 9 000 m", format!("{sky}?{PLACE}&altitude=9000"), 422, "6000", Some("altitude")),
        ("turbidity 0", format!("{sky}?{PLACE}&turbidity=0"), 422, "2 to 3", Some("turbidity")),
        ("turbidity 100", format!("{sky}?{PLACE}&turbidity=100"), 422, "2 to 3", Some("turbidity")),
        ("unknown parameter", format!("{sky}?{PLACE}&hight=2"), 400, "hight", Some("hight")),
        ("no place", format!("{sky}?lat=46"), 400, "lon", Some("lon")),
        ("latitude 91", format!("{sky}?lat=91&lon=8"), 400, "-90 to 90", Some("lat")),
        ("clouds", format!("{sky}?{PLACE}&clouds=1500"), 422, "clouds", Some("clouds")),
        ("unknown scene", format!("/api/v1/scenes/atlantis/sky?{PLACE}"), 404, "atlantis", None),
        ("no such path", "/api/v1/sky".to_owned(), 404, "", None),
    ];
    for (name, path, status, word, parameter) in cases {
        let answer = server.get(&path);
        println!("{name}: {} {}", answer.status, answer.text());
        assert_eq!(answer.status, status, "{name}: {}", answer.text());
        assert!(answer.header("content-type").starts_with("application/problem+json"), "{name}");
        let problem = answer.json();
        assert!(problem.to_string().contains(word), "{name}: {problem}");
        assert!(problem["type"].as_str().is_some_and(|kind| kind.starts_with("/problems/")), "{name}");
        if let Some(parameter) = parameter {
            assert_eq!(problem["errors"][0]["parameter"], parameter, "{name}: {problem}");
        }
    }
    let outside = server.get(&format!("{sky}?lat=-1.3&lon=36.8")).json();
    assert_eq!(outside["bounds"].as_array().map(Vec::len), Some(4), "{outside}");
}

#[test]
fn a_client_that_has_the_picture_gets_304() {
    let server = server();
    let path = format!("/api/v1/scenes/demo/panorama.webp?{PLACE}&turbidity=2");
    let first = server.get(&path);
    assert_eq!(first.status, 200);
    let again: Answer = server.get_with(&path, &[("If-None-Match", first.header("etag"))]);
    assert_eq!((again.status, again.body.len()), (304, 0));
}

#[test]
fn the_server_ends_with_0_when_told_to() {
    let server = Ground::get().server();
    assert_eq!(server.get("/readyz").status, 200);
    assert_eq!(server.terminate(), 0);
}

/// A damaged pack and a damaged scene are left out, and the server serves the others.
#[test]
fn what_is_damaged_is_left_out_of_service() {
    let ground = Ground::get();
    let folder = tempfile::tempdir().unwrap();
    let (packs, data) = (folder.path().join("packs"), folder.path().join("data"));
    std::fs::create_dir(&packs).unwrap();
    for entry in std::fs::read_dir(ground.packs()).unwrap() {
        let file = entry.unwrap();
        if file.file_type().unwrap().is_file() {
            std::fs::copy(file.path(), packs.join(file.file_name())).unwrap();
        }
    }
    let raster = folder.path().join("light.tif");
    std::fs::write(&raster, include_bytes!("../../../../tests/fuzz/seeds/raster/smallest")).unwrap();
    for id in ["sound", "broken"] {
        skyglow(&["ingest", text(&raster), "--id", id, "--data", text(&data)]).expect_status(0);
    }
    let flip = |path: &std::path::Path| {
        let mut bytes = std::fs::read(path).unwrap();
        let middle = bytes.len() / 2;
        bytes[middle] ^= 1;
        std::fs::write(path, bytes).unwrap();
    };
    flip(&packs.join("turbidity-3.00-single.skyglow"));
    let ours = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../../precomputed");
    for name in ["turbidity-2.00-celestial.skyglow", "turbidity-2.00-celestial.json"] {
        std::fs::copy(ours.join(name), packs.join(name)).unwrap();
    }
    flip(&packs.join("turbidity-2.00-celestial.skyglow"));
    flip(&data.join("scenes/broken/light.bin"));
    let arguments =
        ["--packs", text(&packs), "--device", "cpu", "--no-demo", "--log-client-address", "truncated"];
    let server = Server::start(&data, &arguments);
    let started = std::time::Instant::now();
    let ready = loop {
        let ready = server.get("/readyz").json();
        if ready["scenes_left_out"].is_array() || started.elapsed().as_secs() > 20 {
            break ready;
        }
        std::thread::sleep(std::time::Duration::from_millis(20));
    };
    let left_out = ["turbidity-3.00-single.skyglow", "turbidity-2.00-celestial.skyglow"];
    assert_eq!(ready["packs_left_out"], serde_json::json!(left_out), "{ready}");
    assert_eq!(ready["scenes_left_out"], serde_json::json!(["broken"]), "{ready}");
    let scenes = server.get("/api/v1/scenes").json();
    let ids: Vec<&Value> = scenes.as_array().unwrap().iter().map(|scene| &scene["id"]).collect();
    assert_eq!(ids, ["sound"]);
    let bounds = &scenes[0]["bounds"];
    let centre = |a: usize, b: usize| (bounds[a].as_f64().unwrap() + bounds[b].as_f64().unwrap()) / 2.0;
    let place = format!("lat={}&lon={}", centre(1, 3), centre(0, 2));
    let sky = |scene: &str, turbidity: f64| {
        let answer = server.get(&format!("/api/v1/scenes/{scene}/sky?{place}&turbidity={turbidity}"));
        (answer.status, answer.text())
    };
    assert_eq!(sky("sound", 2.0).0, 200);
    let (status, problem) = sky("sound", 3.0);
    assert!(status == 422 && problem.contains("allowed: 2 to 2"), "{status} {problem}");
    let (status, problem) = sky("broken", 2.0);
    assert!(status == 503 && problem.contains("/problems/damaged-scene"), "{status} {problem}");
    let log = server.log();
    for words in ["turbidity-3.00-single.skyglow", "light.bin", "address=\"127.0.0.0/24\""] {
        assert!(log.contains(words), "{words} in {log}");
    }
    assert!(log.lines().any(|line| line.contains("WARN") && line.contains("turbidity-3.00")), "{log}");
}

/// A taken port and missing packs are reported at once.
#[test]
fn a_taken_port_and_missing_packs_end_the_start() {
    let taken = std::net::TcpListener::bind("127.0.0.1:0").unwrap();
    let address = taken.local_addr().unwrap().to_string();
    let folder = tempfile::tempdir().unwrap();
    let data = text(folder.path());
    let refused = skyglow(&["serve", "--listen", &address, "--data", data]).expect_status(1);
    assert!(refused.stderr.contains(&address), "{}", refused.stderr);
    let refused =
        skyglow(&["serve", "--listen", "127.0.0.1:0", "--data", data, "--no-demo", "--packs", data]);
    assert!(refused.expect_status(1).stderr.contains("no table packs"), "packs");
    // The message says what to do, before a demo is made.
    let none = folder.path().join("none");
    let address = "127.0.0.1:0";
    let refused =
        skyglow(&["serve", "--listen", address, "--data", data, "--packs", text(&none)]).expect_status(1);
    for words in [text(&none), "share/skyglow", "SKYGLOW_PACKS"] {
        assert!(refused.stderr.contains(words), "{words} in {}", refused.stderr);
    }
    assert!(!folder.path().join("scenes").exists(), "a demo");
}
