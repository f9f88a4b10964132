//! OGC APIs over light: areas, maps, paths with times, and processes with their jobs.

use super::{EndToEnd, number};
use crate::server::header;
use serde_json::{Value, json};
use std::time::Duration;

const COLLECTION: &str = "/api/ogc/collections/demo";

/// An area's grid has the brightness of the layer, null outside; a map shows the same light.
#[tokio::test]
async fn an_area_has_the_brightness_of_its_map() {
    // Another test counts the maps that are found.
    let server = EndToEnd::alone().await;
    let light = "terrain=off&lamp=100,100,100";
    let coords = "POLYGON((8.5%2046,9%2046,9%2046.5,8.5%2046))";
    let path = format!("{COLLECTION}/area?coords={coords}&{light}");
    let (status, coverage) = server.json(&path).await;
    assert_eq!(status, 200, "{coverage}");
    let domain = &coverage["domain"];
    assert_eq!(domain["domainType"], "Grid");
    let axis = |name: &str| ["start", "stop", "num"].map(|end| number(&domain["axes"][name][end]));
    let ([west, east, columns], [north, south, rows]) = (axis("x"), axis("y"));
    assert!(
        west > 8.4 && east < 9.1 && south > 45.9 && north < 46.6 && columns > 3.0 && rows > 3.0,
        "{domain}"
    );
    let range = &coverage["ranges"]["zenith_luminance_cd_m2"];
    assert_eq!(range["shape"], json!([rows as usize, columns as usize]));
    let values = range["values"].as_array().unwrap();
    // The triangle's north-western half is outside.
    assert!(values[0].is_null() && !values[values.len() - 2].is_null());
    let part = values.iter().filter(|value| !value.is_null()).count() as f64 / values.len() as f64;
    assert!((0.35..0.65).contains(&part), "{part}");
    let magnitudes = coverage["ranges"]["zenith_brightness_mag_arcsec2"]["values"].as_array().unwrap();
    let darkest = |a: &(usize, f64), b: &(usize, f64)| a.1.total_cmp(&b.1);
    let lit = values.iter().enumerate().filter_map(|(at, value)| Some((at, value.as_f64()?)));
    let (at, brightest) = lit.max_by(darkest).unwrap();
    let faintest = magnitudes.iter().filter_map(Value::as_f64).fold(f64::INFINITY, f64::min);
    assert!((number(&magnitudes[at]) - faintest).abs() < 1e-4 && brightest > 0.0);
    // The place's own sky, which the map is within some per cent of.
    let step = |from: f64, to: f64, count: f64| (to - from) / (count - 1.0);
    let longitude = west + (at % columns as usize) as f64 * step(west, east, columns);
    let latitude = north + (at / columns as usize) as f64 * step(north, south, rows);
    let sky = server.sky(&format!("lat={latitude}&lon={longitude}&{light}")).await;
    let ratio = brightest / super::zenith(&sky);
    assert!((0.9..1.1).contains(&ratio), "{ratio} at {latitude} {longitude}");

    let bbox = "8,45.5,9.5,46.5";
    let answer = server.get(&format!("{COLLECTION}/map?bbox={bbox}&width=90&{light}")).await;
    assert_eq!((header(&answer, "content-type"), header(&answer, "content-bbox")), ("image/png", bbox));
    let picture = image::load_from_memory(&answer.bytes().await.unwrap()).unwrap().into_rgba8();
    assert_eq!((picture.width(), picture.height()), (90, 60));
    assert!(picture.pixels().any(|pixel| pixel.0[3] > 0));

    let tiny = "POLYGON((8.5%2046,8.50001%2046,8.50001%2046.00001,8.5%2046))";
    let (status, problem) = server.json(&format!("{COLLECTION}/area?coords={tiny}&{light}")).await;
    assert_eq!(status, 400, "{problem}");
    assert!(problem["detail"].as_str().unwrap().contains("holds no place of the map"), "{problem}");
}

/// A path with times has the natural sky of each.
#[tokio::test]
async fn a_path_with_times_has_their_skies() {
    let server = EndToEnd::shared().await;
    // Midnight and noon of a day in July.
    let coords = "LINESTRING%20M(8.61%2046.53%201784930400,8.79%2046.17%201784973600)";
    let (status, coverage) = server.json(&format!("{COLLECTION}/trajectory?coords={coords}")).await;
    assert_eq!((status, &coverage["domain"]["domainType"]), (200, &json!("Trajectory")), "{coverage}");
    let composite = &coverage["domain"]["axes"]["composite"];
    assert_eq!(composite["coordinates"], json!(["t", "x", "y"]));
    assert_eq!(composite["values"][0], json!(["2026-07-24T22:00:00Z", 8.61, 46.53]));
    let total = &coverage["ranges"]["zenith_total_luminance_cd_m2"]["values"];
    assert!(number(&total[1]) > 1e3 * number(&total[0]), "{total}");
    let (_, point) = server
        .json(&format!("{COLLECTION}/position?coords=POINT(8.61%2046.53)&datetime=2026-07-24T22:00:00Z"))
        .await;
    assert_eq!(point["ranges"]["zenith_total_luminance_cd_m2"]["values"][0], total[0]);
    assert_eq!(point["domain"]["axes"]["t"]["values"], json!(["2026-07-24T22:00:00Z"]));
}

async fn execute(server: &EndToEnd, process: &str, body: &Value, prefer: Option<&str>) -> reqwest::Response {
    let url = format!("{}/api/ogc/processes/{process}/execution", server.base);
    let request = server.client.post(url).json(body);
    let request = prefer.into_iter().fold(request, |request, prefer| request.header("prefer", prefer));
    request.send().await.unwrap()
}

/// Influences are those of the other interface, by themselves or in a document.
#[tokio::test]
async fn influences_are_executed() {
    let server = EndToEnd::shared().await;
    let town = server.town().await;
    let mut inputs =
        json!({"scene": "demo", "lat": town.latitude_deg, "lon": town.longitude_deg, "limit": 3});
    let answer = execute(&server, "influence", &json!({ "inputs": inputs }), None).await;
    assert_eq!((answer.status().as_u16(), header(&answer, "content-type")), (200, "application/json"));
    let raw: Value = answer.json().await.unwrap();
    let (_, wanted) =
        server.json(&format!("/api/v1/scenes/demo/influence.json?{}&limit=3", town.query)).await;
    assert_eq!(raw, wanted);
    let body = json!({"inputs": inputs, "response": "document", "outputs": {"influences": {}}});
    let document: Value = execute(&server, "influence", &body, None).await.json().await.unwrap();
    assert_eq!(document["influences"]["value"], wanted);
    inputs["lat"] = json!(99);
    let answer = execute(&server, "influence", &json!({ "inputs": inputs }), None).await;
    assert_eq!(answer.status(), 400);
    assert_eq!(answer.json::<Value>().await.unwrap()["errors"][0]["parameter"], "lat");
    inputs = json!({"scene": "nowhere", "lat": 46, "lon": 8});
    assert_eq!(execute(&server, "influence", &json!({ "inputs": inputs }), None).await.status(), 404);
}

/// A plan is executed as a job, whose result is a plan that is held and not kept.
#[tokio::test]
async fn a_plan_is_executed_as_a_job() {
    let server = EndToEnd::shared().await;
    let town = server.town().await;
    let site = json!({"lat": town.latitude_deg, "lon": town.longitude_deg, "reduce_by": 0.21});
    let body = json!({"inputs": {"scene": "demo", "method": "target", "sites": [site]}});
    let answer = execute(&server, "plan", &body, Some("respond-async")).await;
    assert_eq!((answer.status().as_u16(), header(&answer, "preference-applied")), (201, "respond-async"));
    let job = header(&answer, "location").to_owned();
    assert!(job.starts_with("/api/ogc/jobs/"), "{job}");
    let accepted: Value = answer.json().await.unwrap();
    assert_eq!((&accepted["type"], &accepted["status"]), (&json!("process"), &json!("accepted")));
    let mut status = accepted;
    for _ in 0..1200 {
        status = server.json(&job).await.1;
        if !["accepted", "running"].iter().any(|on| status["status"] == *on) {
            break;
        }
        let early = server.json(&format!("{job}/results")).await;
        assert!(
            early.0 == 200 || early.1["type"].as_str().unwrap().ends_with("result-not-ready"),
            "{}",
            early.1
        );
        tokio::time::sleep(Duration::from_millis(50)).await;
    }
    assert_eq!((&status["status"], &status["progress"]), (&json!("successful"), &json!(100)), "{status}");
    let (code, plan) = server.json(&format!("{job}/results")).await;
    assert_eq!(code, 200, "{plan}");
    let id = plan["id"].as_str().unwrap();
    assert_eq!(server.json(&format!("/api/v1/plans/{id}")).await.0, 200);
    let (_, listed) = server.json("/api/v1/scenes/demo/plans").await;
    assert!(super::entry(&listed, &plan["id"]).is_none(), "it is held, not kept");
    let dismissed = server.client.delete(format!("{}{job}", server.base)).send().await.unwrap();
    assert_eq!(
        (dismissed.status().as_u16(), &dismissed.json::<Value>().await.unwrap()["status"]),
        (200, &json!("dismissed"))
    );
    assert_eq!(server.json(&job).await.0, 404);
}
