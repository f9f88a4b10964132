use crate::server::{Server, header};
use serde_json::Value;

#[tokio::test]
async fn the_document_is_served_and_is_the_one_agreed() {
    let server = Server::start().await;
    let (status, document) = server.json("/api/v1/openapi.json").await;
    assert_eq!(status, 200);
    assert!(document["openapi"].as_str().unwrap().starts_with("3.1"));
    insta::assert_json_snapshot!("openapi", document);
}

/// A path with things that there are in place of its parameters.
fn real(path: &str, layer: &str) -> String {
    let known = [
        ("{scene}", "demo"),
        ("{layer}", layer),
        ("{z}/{x}/{y}", "0/0/0"),
        ("{tileMatrix}/{tileRow}/{tileCol}", "0/0/0"),
        ("{plan}", "p-00000000000000000000"),
        ("{scenario}", "s-00000000000000000000"),
        ("{kind}", "busy"),
        ("{process}", "influence"),
        ("{tileset}", "brightness"),
        ("{tms}", "WebMercatorQuad"),
        ("{item}", "radiance"),
    ];
    known.iter().fold(path.to_owned(), |path, (name, value)| path.replace(name, value))
}

/// The parameters that a path needs.
fn needed(path: &str, needs_place: bool) -> &'static str {
    match (path, needs_place) {
        ("/api/v1/night" | "/api/v1/scenes/{scene}/night", _) => "lat=-1&lon=37&date=2026-08-20",
        ("/api/v1/nights", _) => "lat=-1&lon=37&month=2026-08",
        ("/api/v1/places", _) => "name=Nairobi",
        (path, _) if path.ends_with("/position") => "coords=POINT(37 -1)",
        (path, _) if path.ends_with("/trajectory") => "coords=LINESTRING(37 -1,37.5 -1)",
        (path, _) if path.ends_with("/area") => "coords=POLYGON((37 -1,37.5 -1,37.5 -0.5,37 -1))",
        (_, true) => "lat=-1&lon=37",
        _ => "",
    }
}

/// Every path of the document answers, and every route is in it.
#[tokio::test]
async fn document_and_routes_are_the_same() {
    let server = Server::start().await;
    let (_, document) = server.json("/api/v1/openapi.json").await;
    let paths: Vec<&String> = document["paths"].as_object().unwrap().keys().collect();
    for path in &paths {
        let real = real(path, "radiance");
        let needs_a_place = document["paths"][path.as_str()]["get"]["parameters"]
            .as_array()
            .is_some_and(|list| list.iter().any(|p| p["name"] == "lat" && p["required"] == true));
        let query = format!("?{}", needed(path, needs_a_place));
        // The made-up program knows no influences, no brightness and has no plans; `end_to_end` asks a real one.
        let status = match path {
            path if path.ends_with("/brightness.qml") => 200,
            path if ["/influence", "/shares", "/darker", "/layers/brightness"]
                .iter()
                .any(|it| path.contains(it)) =>
            {
                503
            }
            path if ["/area", "/map", "/{tileCol}"].iter().any(|end| path.ends_with(end)) => 503,
            // There is no basemap here.
            path if path.starts_with("/api/v1/basemap/") => 404,
            path if ["{plan}", "{scenario}", "{job}"].iter().any(|id| path.contains(id)) => 404,
            // They are only posted to.
            path if ["/skies", "/skies.parquet", "/execution"].iter().any(|end| path.ends_with(end)) => 405,
            _ => 200,
        };
        assert_eq!(server.answer(&format!("{real}{query}")).await.status(), status, "{path}");
    }
    // The routes are written in app.rs: each pattern below /api and each for operation is in the document.
    let source = include_str!("../../src/app.rs");
    let registered = source.matches(".routes(routes!(").count();
    let by_hand: Vec<&str> = source
        .lines()
        .filter_map(|line| line.trim().strip_prefix(".route(\"")?.split('"').next())
        .filter(|path| path.starts_with("/api/v1"))
        .collect();
    assert_eq!(by_hand, ["/api/v1/scenes/{scene}/tiles/{layer}/{z}/{x}/{file}"]);
    // Scenes are read and changed at one path, by routers of their own.
    assert_eq!(paths.len() + 1, registered + by_hand.len());
}

/// Clients that were generated from the document send every default.
#[tokio::test]
async fn every_default_can_be_sent() {
    let server = Server::start().await;
    let (_, document) = server.json("/api/v1/openapi.json").await;
    for (path, item) in document["paths"].as_object().unwrap() {
        let parameters = item["get"]["parameters"].as_array().cloned().unwrap_or_default();
        for layer in ["radiance", "elevation", "brightness", "influence"] {
            let real = real(path, layer);
            let needs_place = parameters.iter().any(|p| p["name"] == "lat" && p["required"] == true);
            let needs_place = needs_place || path.contains("{layer}") && layer == "influence";
            let query = needed(path, needs_place);
            let defaults = parameters.iter().filter(|p| !p["schema"]["default"].is_null());
            let sent: String = defaults
                .map(|p| format!("&{}={}", p["name"], p["schema"]["default"]).replace('"', ""))
                .collect();
            let bare = server.answer(&format!("{real}?{query}")).await.status();
            assert_ne!(bare, 400, "{real}");
            assert_eq!(server.answer(&format!("{real}?{query}{sent}")).await.status(), bare, "{real} {sent}");
            if !path.contains("{layer}") {
                break;
            }
        }
    }
}

/// Names of operations become names of functions, and bytes are bytes.
#[tokio::test]
async fn the_document_is_fit_for_generators() {
    let server = Server::start().await;
    let (_, document) = server.json("/api/v1/openapi.json").await;
    assert_eq!(document["servers"], serde_json::json!([{"url": "/"}]));
    let mut names = std::collections::HashSet::new();
    for (path, item) in document["paths"].as_object().unwrap() {
        for operation in item.as_object().unwrap().values() {
            let name = operation["operationId"].as_str().unwrap();
            assert!(name.bytes().all(|byte| byte.is_ascii_lowercase() || byte == b'_'), "{name}");
            assert!(names.insert(name.to_owned()), "{name} twice");
            for (status, response) in operation["responses"].as_object().unwrap() {
                let content = response["content"].as_object().cloned().unwrap_or_default();
                for (media_type, body) in content.iter().filter(|(name, _)| name.starts_with("image/")) {
                    let bytes = serde_json::json!({"type": "string", "format": "binary"});
                    assert_eq!(body["schema"], bytes, "{path} {status} {media_type}");
                }
            }
        }
    }
}

/// Every parameter of the interface is described with what is allowed.
#[tokio::test]
async fn every_parameter_is_described() {
    let server = Server::start().await;
    let (_, document) = server.json("/api/v1/openapi.json").await;
    let list =
        document["paths"]["/api/v1/scenes/{scene}/panorama.png"]["get"]["parameters"].as_array().unwrap();
    let find = |name: &str| list.iter().find(|p| p["name"] == name).unwrap();
    assert_eq!(find("lat")["required"], true);
    assert_eq!(find("turbidity")["schema"]["default"], 2.5);
    assert_eq!(find("projection")["schema"]["enum"].as_array().unwrap().len(), 3);
    for name in [
        "height",
        "altitude",
        "scattering",
        "lamp",
        "emission",
        "direct_uplight",
        "ground_reflectance",
        "emission_keep",
        "basis",
        "clouds",
        "terrain",
        "tolerance",
        "sky",
        "time",
        "solar_flux",
        "scenario",
        "style",
        "colormap",
        "scale",
        "min",
        "max",
        "exposure",
        "adaptation",
        "dynamic_range",
        "width",
        "height_px",
    ] {
        assert!(find(name)["description"].as_str().unwrap().contains("Allowed: "), "{name}");
    }
    let schemas = document["components"]["schemas"].as_object().unwrap();
    for name in ["Problem", "SkyAnswer", "PanoramaAnswer", "SceneAnswer", "TileJson", "QuantitiesAnswer"] {
        assert!(schemas.contains_key(name), "{name}");
    }
}

#[tokio::test]
async fn the_page_needs_no_other_host() {
    let server = Server::start().await;
    for path in ["/api/docs", "/api/docs/page.js", "/api/docs/page.css"] {
        let answer = server.answer(path).await;
        assert_eq!(answer.status(), 200);
        let policy = header(&answer, "content-security-policy").to_owned();
        assert!(policy.contains("default-src 'none'") && !policy.contains("unsafe"), "{policy}");
        let text = answer.text().await.unwrap();
        assert!(!text.contains("http://") && !text.contains("https://") && !text.contains("\"//"), "{path}");
    }
}

#[tokio::test]
async fn answers_fit_their_schemas() {
    let server = Server::start().await;
    let (_, document) = server.json("/api/v1/openapi.json").await;
    for (path, schema) in [
        ("/api/v1/scenes/demo", "SceneAnswer"),
        ("/api/v1/scenes/demo/site?lat=-1&lon=37", "SiteAnswer"),
        ("/api/v1/scenes/demo/tiles/radiance/tilejson.json", "TileJson"),
    ] {
        let (_, answer) = server.json(path).await;
        let properties = document["components"]["schemas"][schema]["properties"].as_object().unwrap();
        let required = document["components"]["schemas"][schema]["required"].as_array().unwrap();
        for key in answer.as_object().unwrap().keys() {
            assert!(properties.contains_key(key), "{schema} has no {key}");
        }
        for key in required.iter().filter_map(Value::as_str) {
            assert!(answer.get(key).is_some(), "{schema} lacks {key}");
        }
    }
}
