//! Plans: which lights to dim for a goal.

use super::{EndToEnd, Town, entry, folder, number};
use crate::server::header;
use serde_json::{Value, json};

/// 20 km north of the town, whose lights make the sky there; `wish` is added.
fn site(town: &Town, wish: &Value) -> Value {
    let mut site = json!({"lat": town.latitude_deg + 0.18, "lon": town.longitude_deg});
    site.as_object_mut().unwrap().extend(wish.as_object().unwrap().clone());
    site
}

/// A sky a third darker, the same plan for whichever test stores it first: the request and the plan.
async fn target_plan(server: &EndToEnd, town: &Town) -> (Value, Value) {
    let body = json!({"method": "target", "sites": [site(town, &json!({"reduce_by": 0.3}))], "max_cut": 0.9});
    let (status, plan) = server.post("plans?limit=7", &body).await;
    assert_eq!(status, 201, "{plan}");
    (body, plan)
}

#[tokio::test]
async fn a_target_plan_meets_its_target() {
    let server = EndToEnd::shared().await;
    let town = server.town().await;
    let (_, plan) = target_plan(&server, &town).await;
    let told = &plan["sites"][0];
    assert!((number(&told["reduced_by"]) - 0.3).abs() < 3e-4, "{}", told["reduced_by"]);
    assert!(told["target"]["is_met"] == true && told["target"]["why_not"].is_null());
    let sky = server.sky(&town.query).await;
    for name in ["lamp", "emission", "calibration", "turbidity", "scattering"] {
        assert_eq!(told[name], sky[name], "{name}");
    }
    assert!(
        (number(&told["sky_before"]["zenith_luminance_cd_m2"]) / number(&told["before"]) - 1.0).abs() < 1e-6
    );
    let pixels = plan["pixels"].as_array().unwrap();
    assert_eq!(pixels.len(), 7);
    assert!(pixels.windows(2).all(|pair| number(&pair[0]["effect"]) >= number(&pair[1]["effect"])));
    assert!(number(&plan["flux_removed_share"]) > 0.0 && number(&plan["flux_removed_share"]) < 1.0);
    assert!(number(&plan["flux_removed_dnb_w"]) <= number(&plan["least_flux_dnb_w"]) * (1.0 + 1e-6));
}

/// A plan's id brings the sky that it promised; the same request is the same plan.
#[tokio::test]
async fn a_plan_brings_the_promised_sky() {
    let server = EndToEnd::shared().await;
    let town = server.town().await;
    let (body, plan) = target_plan(&server, &town).await;
    let id = plan["id"].as_str().unwrap();
    let place = site(&town, &json!({}));
    let after = server.sky(&format!("lat={}&lon={}&scenario={id}", place["lat"], place["lon"])).await;
    assert_eq!(after["sky"], plan["sites"][0]["sky_after"]);
    assert_eq!(server.post("plans?limit=7", &body).await.1, plan);
}

#[tokio::test]
async fn plans_are_listed_and_come_as_files() {
    let server = EndToEnd::shared().await;
    let (_, plan) = target_plan(&server, &server.town().await).await;
    let id = plan["id"].as_str().unwrap();
    let (_, read) = server.json(&format!("/api/v1/plans/{id}?limit=7")).await;
    assert_eq!(read, plan);
    let (_, list) = server.json("/api/v1/scenes/demo/plans").await;
    assert_eq!(entry(&list, &json!(id)).unwrap()["method"], "target");
    let path = format!("/api/v1/plans/{id}.tif");
    let answer = server.get(&path).await;
    assert_eq!(header(&answer, "content-type"), "image/tiff");
    let tag = header(&answer, "etag").to_owned();
    let bytes = answer.bytes().await.unwrap();
    let mut raster = tiff::decoder::Decoder::new(std::io::Cursor::new(bytes)).unwrap();
    let (_, scene) = server.json("/api/v1/scenes/demo").await;
    assert_eq!(json!(raster.dimensions().unwrap().0), scene["grid"]["width"]);
    assert_eq!(server.get_unless(&path, &tag).await, 304);
    let table = server.get(&format!("/api/v1/plans/{id}.csv?limit=4")).await.text().await.unwrap();
    assert!(table.starts_with("rank,latitude_deg,") && table.lines().count() == 5, "{table}");
    let points = server.client.get(format!("{}/api/v1/plans/{id}", server.base));
    let points: Value =
        points.header("accept", "application/geo+json").send().await.unwrap().json().await.unwrap();
    assert_eq!((&points["plan"], &points["facts"]["method"]), (&json!(id), &json!("target")));
}

/// Thresholds, upon another plan. A plan whose pixels are damaged is no plan, and the server's fault.
#[tokio::test]
async fn a_threshold_plan_builds_on_a_plan() {
    let server = EndToEnd::shared().await;
    let town = server.town().await;
    let (_, first) = target_plan(&server, &town).await;
    let id = first["id"].as_str().unwrap();
    let site = site(&town, &json!({}));
    let body = json!({"method": "threshold", "site": site, "measure": "norm", "q_a": "p90", "q_b": "p99", "gamma": 0.8});
    let (status, second) = server.post(&format!("plans?scenario={id}"), &body).await;
    assert_eq!(status, 201, "{second}");
    assert!(number(&second["sites"][0]["after"]) < number(&second["sites"][0]["before"]));
    assert_eq!(second["sites"][0]["scenario"], json!(id));
    assert!(number(&second["thresholds"][0]) < number(&second["thresholds"][1]));
    assert_eq!(second["threshold_levels"], json!(["p90", "p99"]));

    let id = second["id"].as_str().unwrap();
    std::fs::write(folder().join(format!("plans/{id}.bin")), b"x").unwrap();
    assert_eq!(server.json(&format!("/api/v1/plans/{id}")).await.0, 500);
}

#[tokio::test]
async fn a_draft_can_be_stored_later() {
    let server = EndToEnd::shared().await;
    let site = site(&server.town().await, &json!({}));
    let body = json!({"method": "threshold", "site": site, "q_a": "p95", "q_b": "p95", "gamma": 0.5});
    let (status, draft) = server.post("plans?keep=off", &body).await;
    assert_eq!(status, 201, "{draft}");
    let id = draft["id"].as_str().unwrap();
    let is_listed = async || entry(&server.json("/api/v1/scenes/demo/plans").await.1, &draft["id"]).is_some();
    let files = || {
        let names = std::fs::read_dir(folder().join("plans")).into_iter().flatten();
        names.filter(|name| name.as_ref().unwrap().file_name().to_str().unwrap().starts_with(id)).count()
    };
    assert_eq!((is_listed().await, files()), (false, 0), "a draft is in no list and on no disk");
    let sky = server.sky(&format!("lat={}&lon={}&scenario={id}", site["lat"], site["lon"])).await;
    assert_eq!(sky["sky"], draft["sites"][0]["sky_after"]);
    let edit = json!({"brush": {"points": [[site["lon"], site["lat"]]], "radius_m": 900}, "factor": 0.5});
    let (status, problem) = server.post("scenarios", &json!({"base": id, "edits": [edit]})).await;
    assert_eq!((status, &problem["type"]), (409, &json!("/problems/draft-plan")), "{problem}");

    let (status, stored) = server.post("plans", &body).await;
    assert_eq!((status, &stored["id"]), (201, &draft["id"]));
    assert_eq!((is_listed().await, files()), (true, 2));
    assert_eq!(server.post("plans?keep=off", &body).await.0, 201);
    assert_eq!(server.post("scenarios", &json!({"base": id, "edits": [edit]})).await.0, 201);
}

/// Out of reach is an answer.
#[tokio::test]
async fn an_unreachable_target_says_why() {
    let server = EndToEnd::shared().await;
    let site = site(&server.town().await, &json!({"measure": "horizontal", "at_most": 0}));
    let body = json!({"method": "target", "sites": [site], "max_cut": 0.5});
    let (status, dark) = server.post("plans", &body).await;
    let target = &dark["sites"][0]["target"];
    assert_eq!((status, &target["is_met"]), (201, &json!(false)));
    assert!(target["why_not"].as_str().unwrap().contains("max_cut"), "{target}");
    assert!((number(&dark["sites"][0]["reduced_by"]) - 0.5).abs() < 1e-3);
}

#[tokio::test]
async fn bad_scenarios_and_plans_are_refused() {
    let server = EndToEnd::shared().await;
    let town = server.town().await;
    let (lat, lon) = (town.latitude_deg, town.longitude_deg);
    let brush = |lon: f64| json!({"points": [[lon, lat]], "radius_m": 500});
    let target = |site: Value| json!({"method": "target", "sites": [site]});
    for (name, path, body, status, parameter) in [
        ("no edits", "scenarios", json!({"edits": []}), 400, "edits"),
        ("outside", "scenarios", json!({"edits": [{"brush": brush(100.0), "factor": 0.5}]}), 400, "edits[0]"),
        (
            "too bright",
            "scenarios",
            json!({"edits": [{"brush": brush(lon), "add_radiance_nw_cm2_sr": 1e6}, {"brush": brush(lon), "factor": 1000}]}),
            400,
            "edits[1]",
        ),
        (
            "no such base",
            "scenarios",
            json!({"base": "x", "edits": [{"brush": brush(lon), "factor": 1}]}),
            400,
            "base",
        ),
        ("no method", "plans", json!({}), 400, "body"),
        ("no wish", "plans", target(json!({"lat": lat, "lon": lon})), 400, "sites[0]"),
        (
            "too high",
            "plans",
            target(json!({"lat": lat, "lon": lon, "height": 99_000, "reduce_by": 0.1})),
            422,
            "sites[0].height",
        ),
        (
            "a bad lamp",
            "plans?lamp=candle",
            target(json!({"lat": lat, "lon": lon, "reduce_by": 0.1})),
            400,
            "lamp",
        ),
        (
            "a place in the query",
            "plans?lat=1",
            target(json!({"lat": lat, "lon": lon, "reduce_by": 0.1})),
            400,
            "lat",
        ),
        (
            "a curve without directions",
            "plans",
            target(
                json!({"lat": lat, "lon": lon, "region": [[10, 45.1], [11, 45.1], [10.5, 45.2]], "reduce_by": 0.1}),
            ),
            400,
            "region",
        ),
    ] {
        let (got, problem) = server.post(path, &body).await;
        assert_eq!(
            (got, &problem["errors"][0]["parameter"]),
            (status, &json!(parameter)),
            "{name}: {problem}"
        );
    }
    let (status, problem) =
        server.post("plans", &target(json!({"lat": 80, "lon": 0, "reduce_by": 0.1}))).await;
    assert_eq!((status, problem["bounds"].is_array()), (404, true));
    let base = "p-00000000000000000000";
    let (status, _) =
        server.post("scenarios", &json!({"base": base, "edits": [{"brush": brush(lon), "factor": 1}]})).await;
    assert_eq!(status, 404);
    let (status, _) = server
        .post(&format!("plans?scenario={base}"), &target(json!({"lat": lat, "lon": lon, "reduce_by": 0.1})))
        .await;
    assert_eq!(status, 404);
}

/// A plan that is made as a job is the plan that the job names.
#[tokio::test]
async fn a_plan_can_be_a_job() {
    let server = EndToEnd::shared().await;
    let town = server.town().await;
    let body =
        json!({ "method": "target", "sites": [site(&town, &json!({ "reduce_by": 0.07 }))], "max_cut": 1.0 });
    let posted = server.client.post(format!("{}/api/v1/scenes/demo/plans", server.base));
    let posted = posted.header("prefer", "respond-async").body(body.to_string()).send().await.unwrap();
    assert_eq!(posted.status(), 202);
    let job = posted.headers()["location"].to_str().unwrap().to_owned();
    let mut standing = Value::Null;
    for _ in 0..2000 {
        standing =
            server.client.get(format!("{}{job}", server.base)).send().await.unwrap().json().await.unwrap();
        if standing["state"] != "queued" && standing["state"] != "running" {
            break;
        }
        tokio::time::sleep(std::time::Duration::from_millis(50)).await;
    }
    assert_eq!(
        (&standing["state"], &standing["progress"], &standing["status"]),
        (&"done".into(), &1.0.into(), &201.into())
    );
    let plan = server.client.get(format!("{}{}", server.base, standing["result"].as_str().unwrap()));
    let plan: Value = plan.header("accept", "application/json").send().await.unwrap().json().await.unwrap();
    let result = server.client.get(format!("{}{job}/result", server.base)).send().await.unwrap();
    assert_eq!(result.status(), 201);
    assert_eq!(result.json::<Value>().await.unwrap()["id"], plan["id"]);
}
