//! Bodies of influence requests: boundaries, curves on the sky, and what is odd, wrong or huge.

use super::{EndToEnd, zenith};
use serde_json::{Value, json};

/// Posts to the influence of a place, at the path that ends with `end`.
async fn post(server: &EndToEnd, end: &str, place: &str, body: String) -> (u16, Value) {
    let request = server.client.post(format!("{}/api/v1/scenes/demo/influence{end}?{place}", server.base));
    let answer = request.header("content-type", "application/json").body(body).send().await.unwrap();
    (answer.status().as_u16(), answer.json().await.unwrap())
}

fn vertices(count: usize) -> String {
    (0..count).map(|k| format!("[{}, 45]", k % 90)).collect::<Vec<_>>().join(",")
}

fn boundary(ring: &str) -> String {
    format!(r#"{{"boundary": {{"type": "Polygon", "coordinates": [[{ring}]]}}}}"#)
}

#[tokio::test]
async fn boundaries_and_regions_are_answered() {
    let server = EndToEnd::shared().await;
    let place = server.town().await.query;
    let world = json!({"type": "Polygon", "coordinates": [[[-180, -90], [180, -90], [180, 90], [-180, 90], [-180, -90]]]});
    let feature = json!({"type": "Feature", "properties": {}, "geometry": world});
    // Some programs put a byte order mark before text.
    for (mark, boundary) in [("", world), ("\u{feff}", feature)] {
        let body = format!("{mark}{}", json!({ "boundary": boundary }));
        let (status, answer) = post(&server, "", &place, body).await;
        assert_eq!(status, 200, "{answer}");
        assert!((answer["boundary"]["share"].as_f64().unwrap() - 1.0).abs() < 1e-6, "{}", answer["boundary"]);
        assert_eq!(answer["boundary"]["pixels"], answer["lit_pixels"]);
        assert!(!answer["warnings"].to_string().contains("boundary"), "{}", answer["warnings"]);
    }
    // Metres wide, between the centres of pixels.
    let narrow =
        boundary("[8.80001, 46.17001], [8.80002, 46.17001], [8.80002, 46.17002], [8.80001, 46.17001]");
    let (_, answer) = post(&server, "", &place, narrow).await;
    assert!(answer["warnings"].to_string().contains("no lit pixel"), "{}", answer["warnings"]);
    // A cap around the zenith as wide as that of the measure: the same directions.
    let cap: Vec<[f64; 2]> = (0..60).map(|k| [6.0 * f64::from(k), 85.0]).collect();
    let (status, answer) = post(&server, ".json", &place, json!({ "region": cap }).to_string()).await;
    assert_eq!((status, &answer["measure"]), (200, &json!("region")), "{answer}");
    let sky = server.sky(&place).await;
    assert!((answer["total"].as_f64().unwrap() / zenith(&sky) - 1.0).abs() < 0.02);
    assert!(answer["region_sr"].as_f64().unwrap() > 0.02);
}

#[tokio::test]
async fn bad_influence_bodies_are_refused() {
    let server = EndToEnd::shared().await;
    let place = server.town().await.query;
    for (name, end, body, parameter) in [
        ("no JSON", "", "{".to_owned(), "body"),
        ("NaN", "", r#"{"region": [[NaN, 1], [2, 3], [4, 5]]}"#.to_owned(), "body"),
        ("two corners", "", r#"{"region": [[1, 1], [2, 3]]}"#.to_owned(), "region"),
        ("a sliver", "", r#"{"region": [[10, 45.1], [11, 45.1], [10.5, 45.2]]}"#.to_owned(), "region"),
        ("an open ring", "", boundary("[7, 46], [8, 46], [8, 47]"), "boundary"),
        ("an empty polygon", "", boundary(""), "boundary"),
        ("60 000 corners", "", boundary(&vertices(60_000)), "boundary"),
        ("a point", "", r#"{"boundary": {"type": "Point", "coordinates": [7, 46]}}"#.to_owned(), "boundary"),
        ("a boundary for a raster", ".tif", boundary("[7, 46], [8, 46], [8, 47], [7, 46]"), "boundary"),
    ] {
        let (status, problem) = post(&server, end, &place, body).await;
        let named = &problem["errors"][0]["parameter"];
        assert_eq!((status, named), (400, &json!(parameter)), "{name}: {problem}");
    }
}

/// Whatever is odd and allowed is answered.
#[tokio::test]
async fn odd_influences_are_answered() {
    let server = EndToEnd::shared().await;
    let place = server.town().await.query;
    for (query, statuses) in [
        ("region=0,0;120,0;240,0", [200, 400]),
        ("region=0,90;0,0;1000000,45", [200, 400]),
        ("region=-1000000000,89;90,89;200,89;300,0", [200, 400]),
        ("limit=0", [200, 200]),
        ("limit=10000&measure=norm&turbidity=3.9", [200, 200]),
        ("measure=norm&lamp=0,0,1", [200, 200]),
        ("emission=0,1,0&altitude=5900&measure=mean", [200, 200]),
        ("tolerance=0.3&terrain=off&scattering=single", [200, 200]),
    ] {
        let (status, answer) = server.json(&format!("/api/v1/scenes/demo/influence?{place}&{query}")).await;
        assert!(statuses.contains(&status), "{query}: {answer}");
        let is_finite = answer["total"].as_f64().is_some_and(|total| total.is_finite() && total > 0.0);
        assert!(status != 200 || is_finite, "{query}: {}", answer["total"]);
    }
}

#[tokio::test]
async fn huge_bodies_are_413() {
    let server = EndToEnd::shared().await;
    let place = server.town().await.query;
    for (name, body) in [("10^6 corners", boundary(&vertices(1_000_000))), ("100 MB", " ".repeat(100 << 20))]
    {
        let request = server.client.post(format!("{}/api/v1/scenes/demo/influence?{place}", server.base));
        // The server may stop reading and close before all is sent.
        match request.body(body).send().await {
            Ok(answer) => assert_eq!(answer.status(), 413, "{name}"),
            Err(error) => assert!(error.is_request() || error.is_body(), "{name}: {error}"),
        }
        assert_eq!(server.get("/healthz").await.status(), 200);
    }
}
