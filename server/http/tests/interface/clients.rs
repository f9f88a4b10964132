//! What other programs do: ask for parts of files, come through proxies, and from pages of other sites.

use crate::{
    fake::Mood,
    server::{PLACE, Server, header},
};
use skyglow_http::HttpConfig;
use std::time::Duration;

fn raster() -> String {
    format!("/api/v1/scenes/demo/panorama.tif?{PLACE}")
}

/// The way of `/vsicurl/`: the head, then parts of the file, which together are the file.
#[tokio::test]
async fn files_come_in_parts() {
    let server = Server::start().await;
    let whole = server.answer(&raster()).await;
    assert_eq!((header(&whole, "accept-ranges"), header(&whole, "content-encoding")), ("bytes", ""));
    let tag = header(&whole, "etag").to_owned();
    let whole = whole.bytes().await.unwrap();
    let head = server.client.head(format!("{}{}", server.base, raster())).header("range", "bytes=0-9");
    let head = head.send().await.unwrap();
    assert_eq!((head.status().as_u16(), header(&head, "accept-ranges")), (200, "bytes"));
    assert_eq!(header(&head, "content-length"), whole.len().to_string());
    let mut together = Vec::new();
    let (third, half) = (whole.len() / 3, whole.len() / 2);
    for (first, last) in [(0, third), (third + 1, half), (half + 1, whole.len() + 7)] {
        let part = server.get(&raster()).header("range", format!("bytes={first}-{last}"));
        let part = part.header("if-range", &tag).header("accept-encoding", "gzip").send().await.unwrap();
        assert_eq!(part.status(), 206);
        let end = last.min(whole.len() - 1);
        assert_eq!(header(&part, "content-range"), format!("bytes {first}-{end}/{}", whole.len()));
        assert_eq!(header(&part, "etag"), tag);
        together.extend(part.bytes().await.unwrap());
    }
    assert_eq!(together, whole);
    let end = server.get(&raster()).header("range", "bytes=-5").send().await.unwrap();
    assert_eq!(end.bytes().await.unwrap(), whole[whole.len() - 5..]);
    assert_eq!(server.renders(), 1, "the parts are those of one picture");
}

#[tokio::test]
async fn ranges_that_cannot_be_had() {
    let server = Server::start().await;
    let asked = |name: &'static str, value: &'static str| {
        server.get(&raster()).header("range", "bytes=0-3").header(name, value).send()
    };
    // Another file than the one known comes as a whole.
    assert_eq!(asked("if-range", "\"other\"").await.unwrap().status(), 200);
    assert_eq!(asked("if-range", "Sat, 29 Oct 1994 19:43:31 GMT").await.unwrap().status(), 200);
    let length = server.answer(&raster()).await.bytes().await.unwrap().len();
    let beyond = server.get(&raster()).header("range", format!("bytes={length}-")).send().await.unwrap();
    assert_eq!((beyond.status().as_u16(), header(&beyond, "cache-control")), (416, "no-store"));
    assert_eq!(header(&beyond, "content-range"), format!("bytes */{length}"));
    let problem: serde_json::Value = beyond.json().await.unwrap();
    assert_eq!(problem["type"], "/problems/range-not-satisfiable");
    let several = server.get(&raster()).header("range", "bytes=0-3,8-9").send().await.unwrap();
    assert_eq!((several.status().as_u16(), several.bytes().await.unwrap().len()), (200, length));
    // What is refused has no parts, and what is known already needs none.
    let refused = server.get("/api/v1/scenes/none/sky").header("range", "bytes=0-3").send().await.unwrap();
    assert_eq!((refused.status().as_u16(), header(&refused, "accept-ranges")), (400, ""));
    let tag = header(&server.answer(&raster()).await, "etag").to_owned();
    let known = server.get(&raster()).header("range", "bytes=0-3").header("if-none-match", tag);
    assert_eq!(known.send().await.unwrap().status(), 304);
}

/// Text is compressed where it is sent whole, and in parts it is not.
#[tokio::test]
async fn parts_are_not_compressed() {
    let server = Server::start().await;
    let path = "/api/v1/openapi.json";
    let zipped = server.get(path).header("accept-encoding", "gzip").send().await.unwrap();
    assert_eq!((header(&zipped, "content-encoding"), header(&zipped, "accept-ranges")), ("gzip", ""));
    let whole = server.answer(path).await.bytes().await.unwrap();
    let part = server.get(path).header("accept-encoding", "gzip").header("range", "bytes=5-2004");
    let part = part.send().await.unwrap();
    assert_eq!((part.status().as_u16(), header(&part, "content-encoding")), (206, ""));
    assert_eq!(part.bytes().await.unwrap(), whole[5..2005]);
}

const PROXIED: [(&str, &str); 4] = [
    ("x-forwarded-for", "203.0.113.7"),
    ("x-forwarded-proto", "https"),
    ("x-forwarded-host", "sky.example.org"),
    ("x-forwarded-prefix", "/skyglow"),
];

/// A request as a proxy hands it on.
fn proxied(request: reqwest::RequestBuilder) -> reqwest::RequestBuilder {
    PROXIED.iter().fold(request, |request, (name, value)| request.header(*name, *value))
}

fn behind_a_proxy() -> HttpConfig {
    HttpConfig { trusted_proxies: vec!["127.0.0.0/8".parse().unwrap()], ..HttpConfig::default() }
}

#[tokio::test]
async fn links_lead_through_trusted_proxies() {
    let tilejson = "/api/v1/scenes/demo/tiles/radiance/tilejson.json";
    for (config, base, servers) in [
        (behind_a_proxy(), "https://sky.example.org/skyglow", "https://sky.example.org/skyglow/"),
        (HttpConfig::default(), "", "/"),
    ] {
        let server = Server::with(config).await;
        let description = proxied(server.get(tilejson)).send().await.unwrap();
        let description: serde_json::Value = description.json().await.unwrap();
        let base = if base.is_empty() { &server.base } else { base };
        let tiles = description["tiles"][0].as_str().unwrap();
        assert!(tiles.starts_with(&format!("{base}/api/v1/scenes/demo/tiles/radiance/{{z}}")), "{tiles}");
        let document = proxied(server.get("/api/v1/openapi.json")).send().await.unwrap();
        let document: serde_json::Value = document.json().await.unwrap();
        assert_eq!(document["servers"], serde_json::json!([{"url": servers}]));
    }
}

#[tokio::test]
async fn locations_lead_through_trusted_proxies() {
    let server = Server::with(behind_a_proxy()).await;
    *server.fake.kept.lock().unwrap() = Some(Vec::new());
    let path = "/api/v1/scenes/demo/scenarios";
    let body = r#"{"edits": [{"brush": {"points": [[36.8, -1.3]], "radius_m": 5000}, "factor": 0.5}]}"#;
    let request = proxied(server.client.post(format!("{}{path}", server.base)));
    // The page that the proxy serves is this server's own.
    let answer = request.header("origin", "https://sky.example.org").body(body).send().await.unwrap();
    assert_eq!(answer.status(), 201);
    assert!(header(&answer, "location").starts_with("/skyglow/api/v1/scenarios/s-"));
}

async fn preflight(server: &Server, path: &str, origin: &str, method: &str) -> (u16, String) {
    let request = server.client.request(reqwest::Method::OPTIONS, format!("{}{path}", server.base));
    let request = request.header("origin", origin).header("access-control-request-method", method);
    let answer = request.header("access-control-request-headers", "content-type").send().await.unwrap();
    assert_eq!(header(&answer, "access-control-allow-origin"), "*");
    assert!(header(&answer, "access-control-allow-headers").contains("content-type"));
    (answer.status().as_u16(), header(&answer, "access-control-allow-methods").to_owned())
}

#[tokio::test]
async fn pages_of_other_sites_may_read() {
    let config = HttpConfig { cors_origins: vec!["https://maps.example".into()], ..HttpConfig::default() };
    let server = Server::with(config).await;
    *server.fake.kept.lock().unwrap() = Some(Vec::new());
    let influence = format!("/api/v1/scenes/demo/influence.json?{PLACE}");
    let scenarios = "/api/v1/scenes/demo/scenarios";
    let (stranger, friend) = ("https://other.example", "https://maps.example");
    let (status, methods) = preflight(&server, &influence, stranger, "POST").await;
    assert_eq!((status, methods.as_str()), (200, "GET, HEAD, POST"));
    assert_eq!(preflight(&server, scenarios, stranger, "POST").await.1, "GET, HEAD");
    assert!(preflight(&server, scenarios, friend, "POST").await.1.contains("POST"));
    let body = r#"{"edits": [{"brush": {"points": [[36.8, -1.3]], "radius_m": 5000}, "factor": 0.5}]}"#;
    for (origin, status) in [(stranger, 403), (friend, 201)] {
        let post = server.client.post(format!("{}{scenarios}", server.base)).header("origin", origin);
        let answer = post.header("content-type", "application/json").body(body).send().await.unwrap();
        assert_eq!(answer.status(), status);
        assert_eq!(header(&answer, "access-control-allow-origin"), "*", "the page may see why");
        let exposed = header(&answer, "access-control-expose-headers");
        for name in ["etag", "location", "ratelimit", "content-range"] {
            assert!(exposed.contains(name), "{name}");
        }
    }
    // What the router itself refuses, too.
    let refused = server.client.delete(format!("{}{influence}", server.base)).send().await.unwrap();
    assert_eq!((refused.status().as_u16(), header(&refused, "access-control-allow-origin")), (405, "*"));
}

/// The address of a tile names what it shows: a scene that is replaced has others, and nothing stale is kept.
#[tokio::test]
async fn tiles_of_a_version_are_kept_for_ever() {
    let server = Server::start().await;
    let template = async || {
        let (_, tilejson) = server.json("/api/v1/scenes/demo/tiles/radiance/tilejson.json").await;
        assert_eq!((&tilejson["tileSize"], &tilejson["ready"]), (&256.into(), &true.into()));
        tilejson["tiles"][0].as_str().unwrap().to_owned()
    };
    let tile = async |template: &str| {
        let url = template.replace("{z}", "6").replace("{x}", "38").replace("{y}", "32");
        let answer = server.client.get(url).send().await.unwrap();
        assert_eq!(answer.status(), 200);
        (header(&answer, "cache-control").to_owned(), header(&answer, "etag").to_owned())
    };
    let before = template().await;
    let (kept, tag) = tile(&before).await;
    assert_eq!(kept, "public, max-age=31536000, immutable");
    assert_eq!(
        tile(before.split('?').next().unwrap()).await,
        ("public, max-age=300".to_owned(), tag.clone())
    );
    *server.fake.version.lock().unwrap() = "v2".to_owned();
    let after = template().await;
    assert_ne!(before, after);
    let (kept, other) = tile(&before).await;
    assert_eq!(kept, "public, no-cache", "it shows another version than its address says");
    assert_eq!(tile(&after).await, ("public, max-age=31536000, immutable".to_owned(), other.clone()));
    assert_ne!(tag, other);
}

/// What takes longer than an answer may says how far it is, and goes on.
#[tokio::test]
async fn what_is_being_made_says_so() {
    let server = Server::with(HttpConfig { request_timeout_s: 1.0, ..HttpConfig::default() }).await;
    *server.fake.mood.lock().unwrap() = Mood::Slow(Duration::from_secs(6));
    for path in ["tiles/brightness/6/38/32.png", "layers/brightness.tif"] {
        let answer = server.answer(&format!("/api/v1/scenes/demo/{path}")).await;
        let wait_s: u32 = header(&answer, "retry-after").parse().unwrap();
        assert!((1..=30).contains(&wait_s), "{wait_s}");
        let problem: serde_json::Value = answer.json().await.unwrap();
        assert_eq!((&problem["status"], &problem["type"]), (&503.into(), &"/problems/being-made".into()));
        assert_eq!(problem["progress"], 0.25);
    }
    let (_, tilejson) = server.json("/api/v1/scenes/demo/tiles/brightness/tilejson.json").await;
    assert_eq!((&tilejson["ready"], &tilejson["progress"]), (&false.into(), &0.25.into()));
}
