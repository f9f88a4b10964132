//! Scenarios: edits of the scene's lights that every query takes by their id.

use super::{EndToEnd, Town, entry, number, zenith};
use crate::server::header;
use serde_json::{Value, json};

/// Half the light over the town and its surroundings, white lamps next door, and a new village.
fn edits(town: &Town) -> Value {
    let (lat, lon) = (town.latitude_deg, town.longitude_deg);
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

/// The edits as a scenario, the same for whichever test stores it first: its id, and the town with it as parameters.
async fn painted(server: &EndToEnd, town: &Town) -> (String, String) {
    let body = json!({"title": "what if", "edits": edits(town)});
    let (status, painted) = server.post("scenarios", &body).await;
    assert_eq!(status, 201, "{painted}");
    let id = painted["id"].as_str().unwrap().to_owned();
    let query = format!("{}&scenario={id}", town.query);
    (id, query)
}

#[tokio::test]
async fn scenarios_are_stored_and_listed() {
    let server = EndToEnd::shared().await;
    let town = server.town().await;
    let body = json!({"title": "stored", "edits": edits(&town)});
    let (status, painted) = server.post("scenarios", &body).await;
    assert_eq!(status, 201, "{painted}");
    assert!(number(&painted["new_pixels"]) > 0.0 && number(&painted["changed_pixels"]) > 0.0);
    assert!(painted["edits"].as_array().unwrap().iter().all(|edit| number(&edit["lit_pixels"]) >= 0.0));
    let id = painted["id"].as_str().unwrap().to_owned();
    assert_eq!(server.post("scenarios", &body).await.1["id"], painted["id"], "the same is the same");
    let (_, read) = server.json(&format!("/api/v1/scenarios/{id}")).await;
    for name in ["id", "title", "edits", "changed_pixels", "flux_after_dnb_w"] {
        assert_eq!(read[name], painted[name], "{name}");
    }
    let (_, list) = server.json("/api/v1/scenes/demo/scenarios").await;
    assert_eq!(entry(&list, &json!(id)).unwrap()["edit_count"], 3);
}

/// Numbers of the site, of the sky and of influences are those of the changed lights, and say so.
#[tokio::test]
async fn scenarios_change_sites_and_skies() {
    let server = EndToEnd::shared().await;
    let town = server.town().await;
    let (id, place) = painted(&server, &town).await;
    let sky = server.sky(&town.query).await;
    let (_, site) = server.json(&format!("/api/v1/scenes/demo/site?{place}")).await;
    let (_, site_before) = server.json(&format!("/api/v1/scenes/demo/site?{}", town.query)).await;
    let ratio = number(&site["radiance_nw_cm2_sr"]) / number(&site_before["radiance_nw_cm2_sr"]);
    assert!((ratio - 0.5).abs() < 1e-5, "{ratio}");
    let answer = server.get(&format!("/api/v1/scenes/demo/sky?{place}")).await;
    let tag = header(&answer, "etag").to_owned();
    let changed: Value = answer.json().await.unwrap();
    assert_eq!((&changed["scenario"], &sky["scenario"]), (&json!(id), &Value::Null));
    assert!(zenith(&changed) < 0.9 * zenith(&sky), "{} {}", zenith(&changed), zenith(&sky));
    assert_eq!(server.get_unless(&format!("/api/v1/scenes/demo/sky?{place}"), &tag).await, 304);
    for measure in ["zenith", "horizontal"] {
        let path = format!("/api/v1/scenes/demo/influence?{place}&measure={measure}&limit=3");
        let (status, influence) = server.json(&path).await;
        let of_sky = if measure == "zenith" { "zenith_luminance_cd_m2" } else { "horizontal_illuminance_lx" };
        let ratio = number(&influence["total"]) / number(&changed["sky"][of_sky]);
        assert!(status == 200 && (ratio - 1.0).abs() < 1e-4, "{measure} {ratio}");
    }
}

/// Who says that the scene has no sodium is told that none is replaced.
#[tokio::test]
async fn unmet_lamp_replacements_are_reported() {
    let server = EndToEnd::shared().await;
    let town = server.town().await;
    let (_, place) = painted(&server, &town).await;
    let changed = server.sky(&place).await;
    let unmet = |sky: &Value| {
        let warnings = sky["warnings"].as_array().unwrap();
        warnings.iter().filter(|warning| warning.as_str().unwrap().contains("replaces hps lamps")).count()
    };
    let (_, white) = server.json(&format!("/api/v1/scenes/demo/sky?{place}&lamp=led_3000k")).await;
    let (_, influence) =
        server.json(&format!("/api/v1/scenes/demo/influence?{place}&lamp=led_3000k&limit=0")).await;
    assert_eq!((unmet(&changed), unmet(&white), unmet(&influence)), (0, 1, 1), "{white}");
}

#[tokio::test]
async fn scenarios_change_files_and_tiles() {
    let server = EndToEnd::shared().await;
    let town = server.town().await;
    let (id, place) = painted(&server, &town).await;
    for path in ["panorama.png?", "panorama.json?", "influence.tif?", "influence.csv?"] {
        assert_eq!(server.get(&format!("/api/v1/scenes/demo/{path}{place}")).await.status(), 200, "{path}");
    }
    let (status, tilejson) =
        server.json(&format!("/api/v1/scenes/demo/tiles/radiance/tilejson.json?scenario={id}")).await;
    assert_eq!(status, 200);
    let url = tilejson["tiles"][0].as_str().unwrap();
    let url = url.replace("{z}", "9").replace("{x}", "268").replace("{y}", "183");
    assert!(url.contains(&format!("scenario={id}")) && url.contains("v="), "{url}");
    let tile = async |url: String| server.client.get(url).send().await.unwrap().bytes().await.unwrap();
    let plain = url.split('?').next().unwrap().to_owned();
    assert!(!tile(url).await.is_empty() && !tile(plain).await.is_empty());
}

/// A scenario upon another brings back what that dimmed.
#[tokio::test]
async fn a_scenario_builds_on_another() {
    let server = EndToEnd::shared().await;
    let town = server.town().await;
    let (id, _) = painted(&server, &town).await;
    let (_, site_before) = server.json(&format!("/api/v1/scenes/demo/site?{}", town.query)).await;
    let back = json!({"base": id, "edits": [{"polygon": edits(&town)[0]["polygon"], "factor": 2}]});
    let (status, back) = server.post("scenarios", &back).await;
    assert_eq!((status, &back["base"]), (201, &json!(id)));
    let id = back["id"].as_str().unwrap();
    let (_, site) = server.json(&format!("/api/v1/scenes/demo/site?{}&scenario={id}", town.query)).await;
    let ratio = number(&site["radiance_nw_cm2_sr"]) / number(&site_before["radiance_nw_cm2_sr"]);
    assert!((ratio - 1.0).abs() < 1e-5, "{ratio}");
}

/// With the radiance at the nadir kept, skies are brighter by 1/(weight of lambert), and lights that are dark there are refused.
#[tokio::test]
async fn lights_dark_at_the_nadir_are_refused() {
    let server = EndToEnd::shared().await;
    let town = server.town().await;
    let zenith_of = |sky: &Value| number(&sky["sky"]["zenith_luminance_cd_m2"]);
    let path = |more: &str| format!("/api/v1/scenes/demo/sky?{}{more}", town.query);
    let kept = "&emission_keep=nadir_radiance";
    let (flux, (_, nadir)) = (server.sky(&town.query).await, server.json(&path(kept)).await);
    assert_eq!(
        (&flux["emission"]["preset"], &flux["emission"]["keep"]),
        (&json!("modern_city"), &json!("flux"))
    );
    assert!(
        (zenith_of(&nadir) / zenith_of(&flux) / number(&nadir["emission"]["flux_factor"]) - 1.0).abs() < 1e-5
    );
    let (lat, lon) = (town.latitude_deg, town.longitude_deg);
    let edit = json!({"brush": {"points": [[lon, lat]], "radius_m": 2000}, "emission": [0, 1, 0]});
    let (_, painted) = server.post("scenarios", &json!({"edits": [edit]})).await;
    let scenario = format!("&scenario={}", painted["id"].as_str().unwrap());
    assert_eq!(server.json(&path(&scenario)).await.0, 200);
    let (status, problem) = server.json(&path(&format!("{scenario}{kept}"))).await;
    assert_eq!((status, &problem["errors"][0]["parameter"]), (400, &json!("emission_keep")), "{problem}");
    assert_eq!(problem["errors"][0]["code"], "conflict");
}
