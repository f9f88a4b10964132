use crate::{
    fake::{BOUNDS, GROUND_M},
    server::{PLACE, Server, header},
};
use serde_json::{Value, json};
use skyglow_http::HttpConfig;
use skyglow_scene::Ground;
use std::sync::atomic::Ordering;

/// Scenes, places, sites and atmospheres are listed.
#[tokio::test]
async fn scenes_sites_and_atmospheres_are_listed() {
    let server = Server::start().await;
    let (status, scenes) = server.json("/api/v1/scenes").await;
    assert_eq!((status, scenes.as_array().unwrap().len()), (200, 1));
    let (_, scene) = server.json("/api/v1/scenes/demo").await;
    assert_eq!(scene, scenes[0]);
    for (key, value) in [
        ("id", json!("demo")),
        ("bounds", json!(BOUNDS)),
        ("lit_pixels", json!(1234)),
        ("terrain", json!(true)),
        ("illustrative", json!(true)),
        ("version", json!("v1")),
    ] {
        assert_eq!(scene[key], value, "{key}");
    }
    assert_eq!(scene["grid"]["width"], 480);
    assert!(scene["report"]["negative"]["count"].is_u64());
    let (_, places) = server.json("/api/v1/scenes/demo/places").await;
    assert_eq!(places[0]["name"], "Nairobi");
    assert_eq!(places[0]["population"], 4_397_073);
    let (_, site) = server.json(&format!("/api/v1/scenes/demo/site?{PLACE}")).await;
    assert_eq!(site["terrain_altitude_m"], GROUND_M);
    assert_eq!(site["radiance_nw_cm2_sr"], 12.5);
    let (_, atmospheres) = server.json("/api/v1/atmospheres").await;
    assert_eq!(atmospheres[0]["turbidity"], 2.5);
    assert_eq!(atmospheres[0]["checksum"], "abc");
    assert_eq!(server.renders(), 0);
}

/// An answer says when much of the light around is unknown.
#[tokio::test]
async fn unknown_light_around_is_reported() {
    let server = Server::start().await;
    let sky = format!("/api/v1/scenes/demo/sky?{PLACE}");
    let picture = format!("/api/v1/scenes/demo/panorama.png?{PLACE}");
    for (coverage, said) in [(1.0, None), (0.9, None), (0.416, Some("known for 42 % of the 300 km around"))] {
        *server.fake.coverage.lock().unwrap() = coverage;
        *server.fake.version.lock().unwrap() = format!("{coverage}");
        let (_, answer) = server.json(&sky).await;
        assert_eq!(answer["coverage"], coverage);
        let warnings = answer["warnings"].as_array().unwrap();
        assert_eq!(warnings.len(), usize::from(said.is_some()), "{answer}");
        let header = server.answer(&picture).await.headers().get("skyglow-warnings").cloned();
        assert_eq!(header.is_some(), said.is_some(), "{coverage}");
        if let (Some(said), Some(header)) = (said, header) {
            assert!(warnings[0].as_str().unwrap().contains(said), "{answer}");
            assert!(header.to_str().unwrap().contains(said), "{header:?}");
        }
    }
}

/// An answer over a gap in the terrain says which ground was taken.
#[tokio::test]
async fn the_ground_over_a_terrain_gap_is_reported() {
    let server = Server::start().await;
    let sky = format!("/api/v1/scenes/demo/sky?{PLACE}");
    let site = format!("/api/v1/scenes/demo/site?{PLACE}");
    let picture = format!("/api/v1/scenes/demo/panorama.png?{PLACE}&turbidity=3");
    for path in [&sky, &site] {
        assert_eq!(server.json(path).await.1["warnings"], json!([]), "{path}");
    }
    assert!(!server.answer(&picture).await.headers().contains_key("skyglow-warnings"));
    let nearest = Ground::Nearest { elevation_m: 1650.0, distance_m: 3210.0 };
    for (ground, known, altitude_m, said) in [
        (nearest, json!(1650.0), 1652.0, "nearest terrain, 3.2 km away"),
        (
            Ground::Unknown,
            Value::Null,
            2.0,
            "no data within 5 km of this place: the ground is taken at sea level",
        ),
    ] {
        *server.fake.ground.lock().unwrap() = ground;
        *server.fake.version.lock().unwrap() = format!("{ground:?}");
        for path in [&sky, &site] {
            let (_, answer) = server.json(path).await;
            let terrain = answer.pointer("/observer/terrain_altitude_m").or(answer.get("terrain_altitude_m"));
            assert_eq!(terrain, Some(&known), "{path}");
            assert_eq!(answer["warnings"].as_array().map(Vec::len), Some(1), "{path}");
            assert!(answer["warnings"][0].as_str().unwrap().contains(said), "{answer}");
        }
        assert_eq!(server.json(&sky).await.1["observer"]["altitude_m"], altitude_m);
        assert!(header(&server.answer(&picture).await, "skyglow-warnings").contains(said));
        // An eye above sea level does not ask for the ground.
        let (_, above_sea) = server.json(&format!("{sky}&altitude=4500")).await;
        assert_eq!(above_sea["warnings"], json!([]));
        // The natural sky does not get darker above its tables.
        let (_, high) = server.json(&format!("{sky}&altitude=4501")).await;
        let said = "the natural sky is that of 4500 m above the sea: its tables end there";
        assert_eq!(high["warnings"], json!([said]));
        // It may be in it.
        let (_, buried) = server.json(&format!("{sky}&altitude=1")).await;
        let is_buried = known.as_f64().is_some_and(|ground_m| ground_m > 2.0);
        let said = buried["warnings"].to_string().contains("m below the ground");
        assert_eq!(said, is_buried, "{buried}");
    }
}

/// Health is always good, and readiness waits for the engine.
#[tokio::test]
async fn readiness_waits_for_the_engine() {
    let server = Server::start().await;
    assert_eq!(server.json("/healthz").await, (200, json!({"status": "ok"})));
    assert_eq!(server.json("/readyz").await, (200, json!({"status": "ok", "executor": "cpu"})));
    server.fake.ready.store(false, Ordering::SeqCst);
    let answer = server.answer("/readyz").await;
    assert_eq!(answer.status(), 503);
    assert!(!header(&answer, "retry-after").is_empty());
    assert_eq!(server.answer("/healthz").await.status(), 200);
}

/// Tiles are PNGs of 256 pixels, and TileJSON leads to them.
#[tokio::test]
async fn tilejson_leads_to_pngs_of_256_pixels() {
    let server = Server::start().await;
    for layer in ["radiance", "elevation"] {
        let (status, tilejson) =
            server.json(&format!("/api/v1/scenes/demo/tiles/{layer}/tilejson.json")).await;
        assert_eq!(status, 200);
        assert_eq!(tilejson["tilejson"], "3.0.0");
        assert_eq!(tilejson["bounds"], json!(BOUNDS));
        assert_eq!(tilejson["scheme"], "xyz");
        let template = tilejson["tiles"][0].as_str().unwrap();
        assert!(template.starts_with(&server.base), "{template}");
        let url = template.replace("{z}", "6").replace("{x}", "38").replace("{y}", "32");
        let answer = server.client.get(url).send().await.unwrap();
        assert_eq!((answer.status().as_u16(), header(&answer, "content-type")), (200, "image/png"));
        let tag = header(&answer, "etag").to_owned();
        let tile = image::load_from_memory(&answer.bytes().await.unwrap()).unwrap();
        assert_eq!((tile.width(), tile.height()), (256, 256));
        let again = server
            .get(&format!("/api/v1/scenes/demo/tiles/{layer}/6/38/32.png"))
            .header("if-none-match", tag)
            .send()
            .await
            .unwrap();
        assert_eq!(again.status(), 304);
    }
}

/// TileJSON of a hostile Host header leads to the address that was reached.
#[tokio::test]
async fn tilejson_ignores_a_hostile_host_header() {
    let server = Server::start().await;
    let ask =
        server.get("/api/v1/scenes/demo/tiles/radiance/tilejson.json").header("host", "evil\"/><script>");
    let tilejson: Value = ask.send().await.unwrap().json().await.unwrap();
    let template = tilejson["tiles"][0].as_str().unwrap();
    assert!(template.starts_with(&format!("{}/api/v1/scenes/demo/tiles/", server.base)), "{template}");
}

/// Other sites may show the view that is made for it in a frame, and nothing else.
#[tokio::test]
async fn only_the_embed_may_be_framed_by_others() {
    let server = Server::start().await;
    let mut framed = Vec::new();
    for path in ["/", "/index.html", "/embed", "/at?scene=demo&lat=46&lon=8", "/api/docs"] {
        let page = server.answer(path).await;
        assert_eq!(page.status(), 200, "{path}");
        let policy = header(&page, "content-security-policy").to_owned();
        assert!(
            policy.contains("default-src 'none'") && policy.contains("base-uri 'none'"),
            "{path}: {policy}"
        );
        let ancestors = policy.split(';').find_map(|part| part.trim().strip_prefix("frame-ancestors "));
        match ancestors.unwrap_or_else(|| panic!("{path}: {policy}")) {
            "*" => framed.push(path),
            "'self'" | "'none'" => {}
            other => panic!("{path}: {other}"),
        }
    }
    assert_eq!(framed, ["/embed"]);
    // It is served under its own name alone: its file would come without the policy.
    assert_eq!(server.answer("/embed.html").await.status(), 404);
}

/// What makes the viewer installable lies beside the page, under names that stay; browsers ask each time whether it is new.
#[tokio::test]
async fn the_viewer_can_be_installed() {
    let server = Server::start().await;
    for (path, media_type) in [
        ("/manifest.webmanifest", "application/manifest+json"),
        ("/offline.js", "text/javascript; charset=utf-8"),
        ("/icon.png", "image/png"),
    ] {
        let answer = server.answer(path).await;
        assert_eq!((answer.status().as_u16(), header(&answer, "content-type")), (200, media_type), "{path}");
        assert_eq!(header(&answer, "cache-control"), "public, no-cache", "{path}");
    }
    let manifest: Value = server.answer("/manifest.webmanifest").await.json().await.unwrap();
    assert_eq!(manifest["start_url"], "./");
    assert_eq!(manifest["icons"][0]["src"], "icon.png");
}

/// The viewer comes with a strict policy, and its hashed files are cached for ever.
#[tokio::test]
async fn the_viewer_has_a_strict_policy() {
    let server = Server::start().await;
    let page = server.answer("/").await;
    assert_eq!((page.status().as_u16(), header(&page, "content-type")), (200, "text/html; charset=utf-8"));
    let policy = header(&page, "content-security-policy").to_owned();
    assert!(policy.contains("default-src 'none'") && !policy.contains("unsafe"), "{policy}");
    assert!(!header(&page, "etag").is_empty());
    assert_eq!(header(&page, "cache-control"), "public, no-cache");
    let short = server.get("/").header("accept-encoding", "br").send().await.unwrap();
    assert_eq!(header(&short, "content-encoding"), "br");
    assert_eq!(header(&short, "content-security-policy"), policy);
    let text = page.text().await.unwrap();
    assert!(text.contains("Skyglow") && 2 * short.bytes().await.unwrap().len() < text.len());
    // The built viewer lies in the repository; a page without assets is the one that says it is missing.
    let assets: Vec<&str> = text.split('"').filter_map(|piece| piece.strip_prefix("./assets/")).collect();
    assert!(!assets.is_empty() || text.contains("was built without the viewer"));
    for asset in assets {
        let answer = server.answer(&format!("/assets/{asset}")).await;
        assert_eq!(answer.status(), 200, "{asset}");
        assert_eq!(header(&answer, "cache-control"), "public, max-age=31536000, immutable");
        let tag = header(&answer, "etag").to_owned();
        let again =
            server.get(&format!("/assets/{asset}")).header("if-none-match", tag).send().await.unwrap();
        assert_eq!(again.status(), 304);
        // Compressed well for who takes it, under a tag of its own.
        let get = || server.get(&format!("/assets/{asset}")).header("accept-encoding", "gzip, br");
        let short = get().send().await.unwrap();
        let own = header(&short, "etag").to_owned();
        assert_eq!(header(&short, "vary"), "accept-encoding");
        if !asset.ends_with("svg") {
            assert_eq!(header(&short, "content-encoding"), "br", "{asset}");
            assert_ne!(own, header(&answer, "etag"));
            let lengths = (short.bytes().await.unwrap().len(), answer.bytes().await.unwrap().len());
            // A small one has little to save.
            let most = if lengths.1 < 4096 { lengths.1 } else { lengths.1 / 2 };
            assert!(lengths.0 < most, "{asset}: {lengths:?}");
        }
        assert_eq!(get().header("if-none-match", own).send().await.unwrap().status(), 304, "{asset}");
    }
    for path in ["/assets/..%2f..%2fCargo.toml", "/assets/..%2findex.html", "/Cargo.toml", "/SHA256SUMS"] {
        assert_eq!(server.answer(path).await.status(), 404, "{path}");
    }
}

/// The operator's basemap is described and served tile by tile, compressed as its file has them; without one there is none.
#[tokio::test]
async fn an_operators_basemap_is_served() {
    use pmtiles::{PmTilesWriter, TileCoord, TileType};
    let server = Server::start().await;
    let (status, none) = server.json("/api/v1/basemap").await;
    assert_eq!((status, none["tiles"].as_array().unwrap().len()), (200, 0));
    assert_eq!(server.answer("/api/v1/basemap/0/0/0").await.status(), 404);
    let file = tempfile::NamedTempFile::new().unwrap();
    let mut writer = PmTilesWriter::new(TileType::Mvt)
        .metadata(r#"{"attribution":"Somebody","vector_layers":[{"id":"roads"}]}"#)
        .max_zoom(1)
        .create(file.reopen().unwrap())
        .unwrap();
    writer.add_tile(TileCoord::new(0, 0, 0).unwrap(), b"the whole world").unwrap();
    writer.finalize().unwrap();
    let config = HttpConfig { basemap: Some(file.path().to_owned()), ..HttpConfig::default() };
    let server = Server::with(config).await;
    let (_, map) = server.json("/api/v1/basemap").await;
    assert_eq!((&map["attribution"], &map["layers"][0]), (&"Somebody".into(), &"roads".into()));
    let template = map["tiles"][0].as_str().unwrap();
    assert_eq!(template, format!("{}/api/v1/basemap/{{z}}/{{x}}/{{y}}", server.base));
    let tile = server.get("/api/v1/basemap/0/0/0").header("accept-encoding", "gzip").send().await.unwrap();
    assert_eq!(header(&tile, "content-type"), "application/vnd.mapbox-vector-tile");
    assert_eq!(header(&tile, "content-encoding"), "gzip");
    let bytes = tile.bytes().await.unwrap();
    assert!(bytes.starts_with(&[0x1f, 0x8b]), "{bytes:?}");
    assert_eq!(server.answer("/api/v1/basemap/1/0/0").await.status(), 204);
    for path in ["/api/v1/basemap/40/0/0", "/api/v1/basemap/1/9/0"] {
        assert_eq!(server.answer(path).await.status(), 204, "{path}");
    }
    assert_eq!(server.answer("/api/v1/basemap/x/0/0").await.status(), 400);
}
