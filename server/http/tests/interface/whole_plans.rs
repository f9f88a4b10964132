//! Scenarios and plans over the demo scene.

use crate::{server::header, whole::Whole};
use serde_json::{Value, json};

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or_else(|| panic!("{value} is no number"))
}

async fn post(whole: &Whole, path: &str, body: &Value) -> (u16, Value) {
    let request = whole.client.post(format!("{}/api/v1/scenes/demo/{path}", whole.base));
    let answer = request.json(body).send().await.unwrap();
    let location = answer.headers().get("location").map(|value| value.to_str().unwrap().to_owned());
    let status = answer.status().as_u16();
    let answer: Value = answer.json().await.unwrap();
    assert_eq!(location.is_some(), status == 201, "{answer}");
    assert!(location.is_none_or(|location| location.ends_with(answer["id"].as_str().unwrap())));
    (status, answer)
}

/// Half the light over the town and its surroundings, white lamps next door, and a new village.
fn edits((lat, lon): (f64, f64)) -> Value {
    let square = |west: f64, east: f64| {
        json!({"type": "Polygon", "coordinates": [[
            [west, lat - 0.2], [east, lat - 0.2], [east, lat + 0.2], [west, lat + 0.2], [west, lat - 0.2]]]})
    };
    json!([
        {"polygon": square(lon - 0.2, lon + 0.2), "factor": 0.5},
        {"polygon": square(lon + 0.2, lon + 0.6), "lamp": {"from": "hps", "to": "led_4000k"}, "emission": "shielded"},
        {"brush": {"points": [[lon, lat + 0.3], [lon + 0.05, lat + 0.3]], "radius_m": 1500},
         "add_radiance_nw_cm2_sr": 15, "lamp": "led_3000k"},
    ])
}

pub(crate) async fn scenarios_change_every_query(whole: &Whole, (lat, lon): (f64, f64), sky: &Value) {
    let body = json!({"title": "what if", "edits": edits((lat, lon))});
    let (status, painted) = post(whole, "scenarios", &body).await;
    assert_eq!(status, 201, "{painted}");
    assert!(number(&painted["new_pixels"]) > 0.0 && number(&painted["changed_pixels"]) > 0.0);
    assert!(painted["edits"].as_array().unwrap().iter().all(|edit| number(&edit["lit_pixels"]) >= 0.0));
    let id = painted["id"].as_str().unwrap().to_owned();
    assert_eq!(post(whole, "scenarios", &body).await.1["id"], painted["id"], "the same is the same");
    let (_, read) = whole.json(&format!("/api/v1/scenarios/{id}")).await;
    for name in ["id", "title", "edits", "changed_pixels", "flux_after_dnb_w"] {
        assert_eq!(read[name], painted[name], "{name}");
    }
    let (_, list) = whole.json("/api/v1/scenes/demo/scenarios").await;
    assert_eq!((&list[0]["id"], &list[0]["edit_count"]), (&json!(id), &json!(3)));

    // Every query takes the id, and says so.
    let place = format!("lat={lat}&lon={lon}&scenario={id}");
    let (_, site) = whole.json(&format!("/api/v1/scenes/demo/site?{place}")).await;
    let (_, site_before) = whole.json(&format!("/api/v1/scenes/demo/site?lat={lat}&lon={lon}")).await;
    let ratio = number(&site["radiance_nw_cm2_sr"]) / number(&site_before["radiance_nw_cm2_sr"]);
    assert!((ratio - 0.5).abs() < 1e-5, "{ratio}");
    let answer = whole.get(&format!("/api/v1/scenes/demo/sky?{place}")).await;
    let tag = header(&answer, "etag").to_owned();
    let changed: Value = answer.json().await.unwrap();
    assert_eq!((&changed["scenario"], &sky["scenario"]), (&json!(id), &Value::Null));
    let zenith = |sky: &Value| number(&sky["sky"]["zenith_luminance_cd_m2"]);
    assert!(zenith(&changed) < 0.9 * zenith(sky), "{} {}", zenith(&changed), zenith(sky));
    let again = whole.client.get(format!("{}/api/v1/scenes/demo/sky?{place}", whole.base));
    assert_eq!(again.header("if-none-match", tag).send().await.unwrap().status(), 304);
    for measure in ["zenith", "horizontal"] {
        let path = format!("/api/v1/scenes/demo/influence?{place}&measure={measure}&limit=3");
        let (status, influence) = whole.json(&path).await;
        let of_sky = if measure == "zenith" { "zenith_luminance_cd_m2" } else { "horizontal_illuminance_lx" };
        let ratio = number(&influence["total"]) / number(&changed["sky"][of_sky]);
        assert!(status == 200 && (ratio - 1.0).abs() < 1e-4, "{measure} {ratio}");
    }
    // Who says that the scene has no sodium is told that none is replaced.
    let unmet = |sky: &Value| {
        let warnings = sky["warnings"].as_array().unwrap();
        warnings.iter().filter(|warning| warning.as_str().unwrap().contains("replaces hps lamps")).count()
    };
    let (_, white) = whole.json(&format!("/api/v1/scenes/demo/sky?{place}&lamp=led_3000k")).await;
    let (_, influence) =
        whole.json(&format!("/api/v1/scenes/demo/influence?{place}&lamp=led_3000k&limit=0")).await;
    assert_eq!((unmet(&changed), unmet(&white), unmet(&influence)), (0, 1, 1), "{white}");
    for path in ["panorama.png?", "panorama.json?", "influence.tif?", "influence.csv?"] {
        assert_eq!(whole.get(&format!("/api/v1/scenes/demo/{path}{place}")).await.status(), 200, "{path}");
    }
    let (status, tilejson) =
        whole.json(&format!("/api/v1/scenes/demo/tiles/radiance/tilejson.json?scenario={id}")).await;
    assert_eq!(status, 200);
    let url = tilejson["tiles"][0].as_str().unwrap();
    let url = url.replace("{z}", "9").replace("{x}", "268").replace("{y}", "183");
    assert!(url.ends_with(&format!("?scenario={id}")));
    let tile = async |url: String| whole.client.get(url).send().await.unwrap().bytes().await.unwrap();
    let plain = url.split('?').next().unwrap().to_owned();
    assert!(!tile(url).await.is_empty() && !tile(plain).await.is_empty());

    // A scenario upon it brings back what it dimmed.
    let back = json!({"base": id, "edits": [{"polygon": edits((lat, lon))[0]["polygon"], "factor": 2}]});
    let (status, back) = post(whole, "scenarios", &back).await;
    assert_eq!((status, &back["base"]), (201, &json!(id)));
    let id = back["id"].as_str().unwrap();
    let (_, site) = whole.json(&format!("/api/v1/scenes/demo/site?lat={lat}&lon={lon}&scenario={id}")).await;
    let ratio = number(&site["radiance_nw_cm2_sr"]) / number(&site_before["radiance_nw_cm2_sr"]);
    assert!((ratio - 1.0).abs() < 1e-5, "{ratio}");
}

pub(crate) async fn plans_are_made_kept_and_handed_out(whole: &Whole, (lat, lon): (f64, f64), sky: &Value) {
    // 20 km north of the town, whose lights make the sky there.
    let site = json!({"lat": lat + 0.18, "lon": lon, "reduce_by": 0.3});
    let body = json!({"method": "target", "sites": [site], "max_cut": 0.9});
    let (status, plan) = post(whole, "plans?limit=7", &body).await;
    assert_eq!(status, 201, "{plan}");
    let told = &plan["sites"][0];
    assert!((number(&told["reduced_by"]) - 0.3).abs() < 3e-4, "{}", told["reduced_by"]);
    assert!(told["target"]["is_met"] == true && told["target"]["why_not"].is_null());
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
    let id = plan["id"].as_str().unwrap().to_owned();

    // Its id brings the sky that it promised; the same request is the same plan.
    let (_, after) =
        whole.json(&format!("/api/v1/scenes/demo/sky?lat={}&lon={lon}&scenario={id}", lat + 0.18)).await;
    assert_eq!(after["sky"], told["sky_after"]);
    assert_eq!(post(whole, "plans?limit=7", &body).await.1, plan);
    let (_, read) = whole.json(&format!("/api/v1/plans/{id}?limit=7")).await;
    assert_eq!(read, plan);
    let (_, list) = whole.json("/api/v1/scenes/demo/plans").await;
    assert_eq!((&list[0]["id"], &list[0]["method"]), (&json!(id), &json!("target")));
    let answer = whole.get(&format!("/api/v1/plans/{id}.tif")).await;
    assert_eq!(header(&answer, "content-type"), "image/tiff");
    let tag = header(&answer, "etag").to_owned();
    let bytes = answer.bytes().await.unwrap();
    let mut raster = tiff::decoder::Decoder::new(std::io::Cursor::new(bytes)).unwrap();
    let (_, scene) = whole.json("/api/v1/scenes/demo").await;
    assert_eq!(json!(raster.dimensions().unwrap().0), scene["grid"]["width"]);
    let again =
        whole.client.get(format!("{}/api/v1/plans/{id}.tif", whole.base)).header("if-none-match", tag);
    assert_eq!(again.send().await.unwrap().status(), 304);
    let table = whole.get(&format!("/api/v1/plans/{id}.csv?limit=4")).await.text().await.unwrap();
    assert!(table.starts_with("rank,latitude_deg,") && table.lines().count() == 5, "{table}");
    let points = whole.client.get(format!("{}/api/v1/plans/{id}", whole.base));
    let points: Value =
        points.header("accept", "application/geo+json").send().await.unwrap().json().await.unwrap();
    assert_eq!((&points["plan"], &points["facts"]["method"]), (&json!(id), &json!("target")));

    // Thresholds, upon the plan.
    let site = json!({"lat": lat + 0.18, "lon": lon});
    let body = json!({"method": "threshold", "site": site, "measure": "norm", "q_a": "p90", "q_b": "p99", "gamma": 0.8});
    let (status, second) = post(whole, &format!("plans?scenario={id}"), &body).await;
    assert_eq!(status, 201, "{second}");
    assert!(number(&second["sites"][0]["after"]) < number(&second["sites"][0]["before"]));
    assert_eq!(second["sites"][0]["scenario"], json!(id));
    assert!(number(&second["thresholds"][0]) < number(&second["thresholds"][1]));
    assert_eq!(second["threshold_levels"], json!(["p90", "p99"]));

    a_plan_can_be_tried_and_kept_later(whole, &json!({"lat": lat + 0.18, "lon": lon})).await;

    // Out of reach is an answer, and says why.
    let site = json!({"lat": lat + 0.18, "lon": lon, "measure": "horizontal", "at_most": 0});
    let (status, dark) =
        post(whole, "plans", &json!({"method": "target", "sites": [site], "max_cut": 0.5})).await;
    let target = &dark["sites"][0]["target"];
    assert_eq!((status, &target["is_met"]), (201, &json!(false)));
    assert!(target["why_not"].as_str().unwrap().contains("max_cut"), "{target}");
    assert!((number(&dark["sites"][0]["reduced_by"]) - 0.5).abs() < 1e-3);

    // A plan whose pixels are damaged is no plan, and the server's fault.
    let file = whole.folder.path().join("plans").join(format!("{}.bin", second["id"].as_str().unwrap()));
    std::fs::write(&file, b"x").unwrap();
    let (status, _) = whole.json(&format!("/api/v1/plans/{}", second["id"].as_str().unwrap())).await;
    assert_eq!(status, 500);
}

async fn a_plan_can_be_tried_and_kept_later(whole: &Whole, site: &Value) {
    let plans = async || whole.json("/api/v1/scenes/demo/plans").await.1.as_array().unwrap().len();
    let files = || std::fs::read_dir(whole.folder.path().join("plans")).unwrap().count();
    let before = (plans().await, files());
    let body = json!({"method": "threshold", "site": site, "q_a": "p95", "q_b": "p95", "gamma": 0.5});
    let (status, draft) = post(whole, "plans?keep=off", &body).await;
    assert_eq!(status, 201, "{draft}");
    assert_eq!((plans().await, files()), before, "a draft is in no list and on no disk");
    let id = draft["id"].as_str().unwrap();
    let sky = format!("/api/v1/scenes/demo/sky?lat={}&lon={}&scenario={id}", site["lat"], site["lon"]);
    assert_eq!(whole.json(&sky).await.1["sky"], draft["sites"][0]["sky_after"]);
    let edit = json!({"brush": {"points": [[site["lon"], site["lat"]]], "radius_m": 900}, "factor": 0.5});
    let (status, problem) = post(whole, "scenarios", &json!({"base": id, "edits": [edit]})).await;
    assert_eq!((status, &problem["type"]), (409, &json!("/problems/draft-plan")), "{problem}");

    let (status, kept) = post(whole, "plans", &body).await;
    assert_eq!((status, &kept["id"]), (201, &draft["id"]));
    assert_eq!((plans().await, files()), (before.0 + 1, before.1 + 2));
    assert_eq!(post(whole, "plans?keep=off", &body).await.0, 201);
    assert_eq!(post(whole, "scenarios", &json!({"base": id, "edits": [edit]})).await.0, 201);
}

pub(crate) async fn bodies_that_cannot_be_meant_are_refused(whole: &Whole, (lat, lon): (f64, f64)) {
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
        let (got, problem) = post(whole, path, &body).await;
        assert_eq!(
            (got, &problem["errors"][0]["parameter"]),
            (status, &json!(parameter)),
            "{name}: {problem}"
        );
    }
    let (status, problem) =
        post(whole, "plans", &target(json!({"lat": 80, "lon": 0, "reduce_by": 0.1}))).await;
    assert_eq!((status, problem["bounds"].is_array()), (404, true));
    let base = "p-00000000000000000000";
    let (status, _) =
        post(whole, "scenarios", &json!({"base": base, "edits": [{"brush": brush(lon), "factor": 1}]})).await;
    assert_eq!(status, 404);
    let (status, _) = post(
        whole,
        &format!("plans?scenario={base}"),
        &target(json!({"lat": lat, "lon": lon, "reduce_by": 0.1})),
    )
    .await;
    assert_eq!(status, 404);
}
