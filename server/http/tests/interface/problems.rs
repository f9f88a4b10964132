use crate::{
    fake::{BOUNDS, Mood},
    server::{PLACE, SKY, Server, header},
};
use skyglow_app::AppError;

/// Status and kind of a problem, checked to be a problem document.
async fn problem(server: &Server, path: &str) -> (u16, String, serde_json::Value) {
    let answer = server.answer(path).await;
    let status = answer.status().as_u16();
    assert_eq!(header(&answer, "content-type"), "application/problem+json", "{path}");
    assert_eq!(header(&answer, "cache-control"), "no-store");
    let json: serde_json::Value = answer.json().await.unwrap();
    assert_eq!(json["status"], status);
    assert!(!json["detail"].as_str().unwrap().is_empty() && !json["title"].as_str().unwrap().is_empty());
    (status, json["type"].as_str().unwrap().to_owned(), json)
}

/// Every bad parameter is named with its value and what is allowed.
#[tokio::test]
async fn every_bad_parameter_is_named() {
    let server = Server::start().await;
    let (status, kind, json) =
        problem(&server, "/api/v1/scenes/demo/panorama.png?lat=99&turbidity=fog&colour=red&lamp=candle")
            .await;
    assert_eq!((status, kind.as_str()), (400, "/problems/bad-parameters"));
    let errors = json["errors"].as_array().unwrap();
    let of = |name: &str| errors.iter().find(|error| error["parameter"] == name).unwrap();
    assert_eq!(errors.len(), 5);
    assert_eq!(
        (of("lat")["value"].as_str(), of("lat")["allowed"].as_str()),
        (Some("99"), Some("-90 to 90 degrees"))
    );
    assert_eq!(of("lon")["code"], "missing");
    assert_eq!(of("turbidity")["value"], "fog");
    assert_eq!(of("colour")["code"], "unknown_parameter");
    assert!(of("lamp")["allowed"].as_str().unwrap().contains("led_3000k"));
    assert!(json["detail"].as_str().unwrap().contains("lat=99"));
    assert_eq!(server.renders(), 0);
}

#[tokio::test]
async fn unknown_parameters_are_errors_everywhere() {
    let server = Server::start().await;
    for path in [
        "/api/v1/scenes?x=1".to_owned(),
        "/api/v1/scenes/demo?x=1".to_owned(),
        "/api/v1/scenes/demo/places?x=1".to_owned(),
        format!("/api/v1/scenes/demo/site?{PLACE}&x=1"),
        format!("{SKY}&projection=fisheye"),
        "/api/v1/scenes/demo/tiles/radiance/1/0/0.png?x=1".to_owned(),
        "/api/v1/scenes/demo/tiles/radiance/tilejson.json?x=1".to_owned(),
        "/api/v1/atmospheres?x=1".to_owned(),
        "/api/v1/openapi.json?x=1".to_owned(),
        "/api/docs?x=1".to_owned(),
        "/healthz?x=1".to_owned(),
        "/readyz?x=1".to_owned(),
        "/metrics?x=1".to_owned(),
    ] {
        let (status, kind, _) = problem(&server, &path).await;
        assert_eq!((status, kind.as_str()), (400, "/problems/unknown-parameter"), "{path}");
    }
}

/// A place outside the scene is 404 with the scene's bounds.
#[tokio::test]
async fn a_place_outside_is_404_with_the_bounds() {
    let server = Server::start().await;
    for path in ["site", "sky", "panorama.png", "panorama.json"] {
        let (status, kind, json) =
            problem(&server, &format!("/api/v1/scenes/demo/{path}?lat=52.5&lon=13.4")).await;
        assert_eq!((status, kind.as_str()), (404, "/problems/outside-scene"));
        assert_eq!(json["bounds"], serde_json::json!(BOUNDS));
        assert!(
            json["detail"].as_str().unwrap().contains("latitude 52.5, longitude 13.4"),
            "{}",
            json["detail"]
        );
    }
}

/// Altitude and turbidity out of range are 422 with the range.
#[tokio::test]
async fn values_out_of_range_are_422_with_the_range() {
    let server = Server::start().await;
    for (query, parameter, range) in [
        ("turbidity=0", "turbidity", "1.5 to 6"),
        ("turbidity=100", "turbidity", "1.5 to 6"),
        ("altitude=9000", "altitude", "0 to 6000 m"),
        ("height=5000", "height", "0 to 4300 m above this ground, which lies at 1700 m"),
        ("height=200000", "height", "0 to 6000 m"),
    ] {
        let (status, kind, json) = problem(&server, &format!("{SKY}&{query}")).await;
        assert_eq!((status, kind.as_str()), (422, "/problems/out-of-range"), "{query}");
        assert_eq!(json["errors"][0]["parameter"], parameter);
        assert!(json["errors"][0]["allowed"].as_str().unwrap().starts_with(range), "{json}");
    }
}

#[tokio::test]
async fn what_is_not_resident_is_422_and_says_so() {
    let server = Server::start().await;
    for (query, kind) in [
        ("scattering=multiple", "/problems/not-resident"),
        ("basis=65", "/problems/not-resident"),
        ("clouds=1200", "/problems/not-resident"),
    ] {
        let (status, got, _) = problem(&server, &format!("{SKY}&{query}")).await;
        assert_eq!((status, got.as_str()), (422, kind), "{query}");
    }
}

/// Scenario ids that are none, or that nothing is stored under, are refused.
#[tokio::test]
async fn unknown_scenarios_are_refused() {
    let server = Server::start().await;
    for (query, status, kind) in [
        ("scenario=7", 400, "/problems/bad-parameters"),
        ("scenario=s-0123456789abcdef0123", 404, "/problems/unknown-scenario"),
        ("scenario=p-0123456789abcdef0123", 404, "/problems/unknown-scenario"),
    ] {
        let (got, of, _) = problem(&server, &format!("{SKY}&{query}")).await;
        assert_eq!((got, of.as_str()), (status, kind), "{query}");
    }
    for path in
        ["plans/p-0123456789abcdef0123.tif", "plans/p-0123456789abcdef0123.exe", "plans/x", "scenarios/x"]
    {
        let (status, kind, _) = problem(&server, &format!("/api/v1/{path}")).await;
        assert_eq!((status, kind.as_str()), (404, "/problems/unknown-scenario"), "{path}");
    }
}

/// Where nothing can be stored the answer is 503: not the client's fault.
#[tokio::test]
async fn a_server_without_storage_is_503() {
    let server = Server::start().await;
    let body = r#"{"edits": [{"brush": {"points": [[36.8, -1.3]], "radius_m": 500}, "factor": 0.5}]}"#;
    let answer = server.post("/api/v1/scenes/demo/scenarios", body).await;
    assert_eq!((answer.status().as_u16(), header(&answer, "retry-after")), (503, "60"));
    let json: serde_json::Value = answer.json().await.unwrap();
    assert_eq!(json["type"], "/problems/storage");
    assert!(!json["detail"].as_str().unwrap().contains("made-up"), "reasons stay in the log");
}

/// Unknown scenes, paths and methods are problem documents too.
#[tokio::test]
async fn unknown_paths_and_methods_are_problems() {
    let server = Server::start().await;
    for path in ["/api/v1/scenes/nowhere", "/api/v1/scenes/..%2Fx", "/api/v1/scenes/nowhere/site?lat=0&lon=0"]
    {
        let (status, kind, _) = problem(&server, path).await;
        assert_eq!((status, kind.as_str()), (404, "/problems/unknown-scene"), "{path}");
    }
    for path in ["/api/v1/nothing", "/api/v1/scenes/demo/influences", "/wp-login.php", "/assets/none.js"] {
        let (status, kind, _) = problem(&server, path).await;
        assert_eq!((status, kind.as_str()), (404, "/problems/not-found"), "{path}");
    }
    let (status, kind, _) = problem(&server, "/api/v1/scenes/%FF%FE").await;
    assert_eq!((status, kind.as_str()), (400, "/problems/unreadable"));
    let deleted = server.client.delete(format!("{}{SKY}", server.base)).send().await.unwrap();
    assert_eq!((deleted.status().as_u16(), header(&deleted, "allow")), (405, "GET,HEAD"));
    let json: serde_json::Value = deleted.json().await.unwrap();
    assert_eq!(json["type"], "/problems/method-not-allowed");
}

#[tokio::test]
async fn tiles_that_do_not_exist_are_404() {
    let server = Server::start().await;
    for tail in [
        "radiance/1/2/0.png",
        "radiance/99/0/0.png",
        "radiance/1/0/0.jpg",
        "radiance/a/0/0.png",
        "moon/1/0/0.png",
    ] {
        let path = format!("/api/v1/scenes/demo/tiles/{tail}");
        let (status, kind, _) = problem(&server, &path).await;
        assert_eq!((status, kind.as_str()), (404, "/problems/unknown-tile"), "{tail}");
        let starred = server.get(&path).header("if-none-match", "*").send().await.unwrap();
        assert_eq!(starred.status(), 404);
    }
}

/// A full queue is 503 with Retry-After, and a lost engine too.
#[tokio::test]
async fn a_full_queue_is_503_with_retry_after() {
    let server = Server::start().await;
    for (error, kind) in [
        (AppError::Busy { retry_after_s: 1 }, "/problems/busy"),
        (AppError::EngineDown, "/problems/engine-down"),
    ] {
        *server.fake.mood.lock().unwrap() = Mood::Fails(error);
        let answer = server.answer(SKY).await;
        assert_eq!(answer.status(), 503);
        assert!(header(&answer, "retry-after").parse::<u64>().unwrap() >= 1);
        let json: serde_json::Value = answer.json().await.unwrap();
        assert_eq!(json["type"], kind);
    }
    // A failure is not kept: the next request is rendered.
    *server.fake.mood.lock().unwrap() = Mood::Well;
    assert_eq!(server.answer(SKY).await.status(), 200);
}

/// A defect is 500 without a word about the inside, and the server lives on.
#[tokio::test]
async fn a_defect_is_500_without_internals() {
    let server = Server::start().await;
    for mood in [Mood::Panics, Mood::Fails(AppError::internal("the secret of /etc/passwd"))] {
        *server.fake.mood.lock().unwrap() = mood;
        let answer = server.answer(SKY).await;
        assert_eq!(answer.status(), 500);
        let text = answer.text().await.unwrap();
        assert!(text.contains("/problems/internal") && !text.contains("secret"), "{text}");
    }
    *server.fake.mood.lock().unwrap() = Mood::Well;
    assert_eq!(server.answer(SKY).await.status(), 200);
    let metrics = server.answer("/metrics").await.text().await.unwrap();
    assert!(metrics.contains("skyglow_http_panics_total 1"), "{metrics}");
}

/// Every kind of problem is explained at its type's address.
#[tokio::test]
async fn every_problem_is_explained_at_its_type() {
    let server = Server::start().await;
    for (kind, _) in skyglow_http::routes::problems::KINDS {
        let answer = server.answer(&format!("/problems/{kind}")).await;
        assert_eq!(answer.status(), 200);
        assert!(answer.text().await.unwrap().starts_with(kind));
    }
    assert_eq!(problem(&server, "/problems/none").await.0, 404);
}
