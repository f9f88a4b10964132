//! A server with packs of first-order light and of all orders.

use crate::{
    fake::Fake,
    server::{PLACE, SKY, Server, header},
};
use serde_json::{Value, json};
use skyglow_http::HttpConfig;

async fn both() -> Server {
    Server::over(Fake::with_both_kinds(), HttpConfig::default()).await
}

/// The sky has all orders of scattering unless the first alone is requested.
#[tokio::test]
async fn the_sky_has_all_orders_by_default() {
    let server = both().await;
    let zenith = |sky: &Value| sky["sky"]["zenith_luminance_cd_m2"].as_f64().unwrap();
    let (_, default) = server.json(SKY).await;
    let (_, multiple) = server.json(&format!("{SKY}&scattering=multiple")).await;
    let (_, single) = server.json(&format!("{SKY}&scattering=single")).await;
    assert_eq!(default, multiple);
    assert_eq!((&default["scattering"], &default["ground_albedo"]), (&json!("multiple"), &json!(0.15)));
    assert_eq!((&single["scattering"], &single["ground_albedo"]), (&json!("single"), &Value::Null));
    assert!((zenith(&default) / zenith(&single) - 2.0).abs() < 1e-6);
    let (_, panorama) =
        server.json(&format!("/api/v1/scenes/demo/panorama.json?{PLACE}&scattering=single")).await;
    assert_eq!((&panorama["scattering"], &panorama["sky"]), (&json!("single"), &single["sky"]));
    // Three ways to ask for one of two skies.
    assert_eq!(server.renders(), 2);
}

#[tokio::test]
async fn each_scattering_has_a_tag_of_its_own() {
    let server = both().await;
    for path in ["sky", "panorama.png", "panorama.tif", "panorama.json"] {
        let tag = async |query: &str| {
            let answer = server.answer(&format!("/api/v1/scenes/demo/{path}?{PLACE}{query}")).await;
            assert_eq!(answer.status(), 200, "{path}{query}");
            header(&answer, "etag").to_owned()
        };
        assert_eq!(tag("").await, tag("&scattering=multiple").await, "{path}");
        assert_ne!(tag("").await, tag("&scattering=single").await, "{path}");
    }
}

/// The packs are listed with their scattering and their ground.
#[tokio::test]
async fn packs_are_listed_with_their_scattering() {
    let (_, packs) = both().await.json("/api/v1/atmospheres").await;
    let told: Vec<_> =
        packs.as_array().unwrap().iter().map(|p| (&p["scattering"], &p["ground_albedo"])).collect();
    assert_eq!(told, [(&json!("single"), &Value::Null), (&json!("multiple"), &json!(0.15))]);
}

#[tokio::test]
async fn what_is_not_resident_is_refused_with_what_is() {
    let server = Server::start().await;
    let (status, problem) = server.json(&format!("{SKY}&scattering=multiple")).await;
    assert_eq!((status, &problem["type"]), (422, &json!("/problems/not-resident")));
    let error = &problem["errors"][0];
    assert_eq!((&error["parameter"], &error["allowed"]), (&json!("scattering"), &json!("single")));

    // Turbidity 5.5 is resident for first-order light alone.
    let server = both().await;
    let (status, problem) = server.json(&format!("{SKY}&turbidity=5.5")).await;
    assert_eq!((status, &problem["type"]), (422, &json!("/problems/out-of-range")));
    assert_eq!(problem["errors"][0]["allowed"], "2 to 5 with multiple scattering");
    let (status, _) = server.json(&format!("{SKY}&turbidity=5.5&scattering=single")).await;
    assert_eq!(status, 200);
}

#[tokio::test]
async fn a_sky_says_whether_lights_behind_ridges_count() {
    let server = both().await;
    let told = async |query: &str| {
        let (_, sky) = server.json(&format!("{SKY}{query}")).await;
        let words = sky["warnings"].as_array().unwrap().iter().filter_map(Value::as_str);
        let warned = words.filter(|words| words.contains("behind ridges")).count();
        (sky["terrain_occlusion"] == true, sky["hidden_lights"] == true, warned)
    };
    // The packs of the first order know skylines here, those of all orders do not.
    assert_eq!(told("&scattering=single").await, (true, true, 0));
    assert_eq!(told("&scattering=multiple").await, (true, false, 1));
    assert_eq!(told("&scattering=multiple&terrain=off").await, (false, false, 0));
    assert_eq!(told("&scattering=single&terrain=off").await, (false, false, 0));
}
