//! Scenes, sites, skies and panoramas.

use super::{EndToEnd, demo, number, zenith};
use crate::server::header;
use serde_json::{Value, json};
use skyglow_app::SkySource;

#[tokio::test]
async fn the_demo_scene_is_listed() {
    let server = EndToEnd::shared().await;
    assert_eq!(server.get("/readyz").await.status(), 200);
    let scene = demo(&server).await;
    assert_eq!(scene["illustrative"], true);
    assert_eq!(scene["bounds"], server.json("/api/v1/scenes/demo").await.1["bounds"]);
    assert_eq!(server.json("/api/v1/scenes/none/sky?lat=0&lon=0").await.0, 404);
}

/// A lit place has a lit sky, over the ground that its site reports.
#[tokio::test]
async fn a_town_has_a_sky() {
    let server = EndToEnd::shared().await;
    let town = server.town().await;
    let (status, site) = server.json(&format!("/api/v1/scenes/demo/site?{}", town.query)).await;
    assert_eq!(status, 200);
    assert!(number(&site["radiance_nw_cm2_sr"]) > 0.0, "{site}");

    let answer = server.get(&format!("/api/v1/scenes/demo/sky?{}", town.query)).await;
    assert_eq!(answer.status(), 200);
    assert!(!header(&answer, "server-timing").is_empty());
    let sky: Value = answer.json().await.unwrap();
    assert!(zenith(&sky) > 0.0);
    // Two fluxes, two names: that around the place, and in the scene's report that of all its lights.
    let scene = demo(&server).await;
    let (around, all) = (&sky["flux_within_300_km_dnb_w"], &scene["report"]["flux_dnb_w"]);
    assert!(number(around) > 0.0 && number(around) <= 1.000_001 * number(all));
    assert!(sky.get("flux_dnb_w").is_none());
    assert_eq!(sky["observer"]["terrain_altitude_m"], site["terrain_altitude_m"]);
    assert_eq!(sky["executor"], "cpu");
}

/// By the engine's own counter: 304 renders nothing, and the panorama of the same sky comes from the cache.
#[tokio::test]
async fn one_sky_is_rendered_once() {
    let server = EndToEnd::alone().await;
    let town = server.town().await;
    let rendered = || server.source.stats().rendered;
    let before = rendered();
    let path = format!("/api/v1/scenes/demo/sky?{}&turbidity=3.05", town.query);
    let answer = server.get(&path).await;
    let tag = header(&answer, "etag").to_owned();
    let sky: Value = answer.json().await.unwrap();
    assert_eq!(rendered(), before + 1);
    assert_eq!(server.get_unless(&path, &tag).await, 304);
    let (_, panorama) = server.json(&path.replace("/sky?", "/panorama.json?")).await;
    assert_eq!(panorama["sky"], sky["sky"]);
    assert_eq!(rendered(), before + 1);
    let png = server.get(&format!("/api/v1/scenes/demo/panorama.png?{}&turbidity=3.1", town.query)).await;
    assert_eq!(png.status(), 200);
    assert_eq!(rendered(), before + 2);
}

/// Fewer functions are used, and the sky is as near to that of all as the answer says; a tighter tolerance takes more.
#[tokio::test]
async fn a_tolerance_is_kept() {
    let server = EndToEnd::shared().await;
    let town = server.town().await;
    let samples = |panorama: &Value| -> Vec<f64> {
        let bands = panorama["radiance"].as_array().unwrap().iter();
        let rows = bands.flat_map(|band| band.as_array().unwrap()).flat_map(|row| row.as_array().unwrap());
        rows.map(number).collect()
    };
    let path = format!("/api/v1/scenes/demo/panorama.json?{}&terrain=off", town.query);
    let (_, all) = server.json(&path).await;
    let exact = samples(&all);
    assert_eq!((&all["basis_count"], &all["basis_error_bound"]), (&json!(24), &Value::Null));
    let mut counts = Vec::new();
    for tolerance in [0.5, 0.05, 0.0001] {
        let (status, sky) = server.json(&format!("{path}&tolerance={tolerance}")).await;
        let bound = number(&sky["basis_error_bound"]);
        assert!(status == 200 && bound <= tolerance, "{bound} {tolerance}");
        let difference = samples(&sky).iter().zip(&exact).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        counts.push((sky["basis_count"].as_u64().unwrap(), difference > 0.0));
    }
    assert_eq!((counts[0], counts[2]), ((8, true), (24, false)), "{counts:?}");
    assert!(counts[1].0 >= counts[0].0, "{counts:?}");
}

#[tokio::test]
async fn skies_out_of_range_are_refused() {
    let server = EndToEnd::shared().await;
    let town = server.town().await;
    let (status, problem) = server.json("/api/v1/scenes/demo/sky?lat=80&lon=0").await;
    assert_eq!((status, &problem["bounds"]), (404, &demo(&server).await["bounds"]));
    let sky = format!("/api/v1/scenes/demo/sky?{}", town.query);
    let (status, problem) = server.json(&format!("{sky}&turbidity=5")).await;
    assert_eq!(
        (status, &problem["errors"][0]["allowed"]),
        (422, &json!("1.5 to 4 with multiple scattering"))
    );
    let (status, single) = server.json(&format!("{sky}&turbidity=5&scattering=single")).await;
    assert_eq!((status, &single["scattering"]), (200, &json!("single")));
    assert_eq!(server.json(&format!("{sky}&height=99000")).await.0, 422);
}

#[tokio::test]
async fn multiple_scattering_is_brighter() {
    let server = EndToEnd::shared().await;
    let town = server.town().await;
    let all = server.sky(&town.query).await;
    let single = server.sky(&format!("{}&scattering=single", town.query)).await;
    assert_eq!((&all["scattering"], &single["scattering"]), (&json!("multiple"), &json!("single")));
    assert!(zenith(&all) > 1.001 * zenith(&single), "{} {}", zenith(&all), zenith(&single));
}

/// Ground in light is brighter than a silhouette where it is, brighter under snow, and leaves the sky above it as it was.
#[tokio::test]
async fn ground_is_seen_in_its_light() {
    let server = EndToEnd::shared().await;
    let drawn = async |ground: &str| {
        // Where no lamps are, and starlit ground is all but black.
        let look =
            "lat=46.53&lon=8.61&height=20&projection=perspective&elevation=0&style=eye&exposure=2&legend=off";
        let size = "width=128&height_px=96";
        let path = format!("/api/v1/scenes/demo/panorama.png?{look}&{size}&ground={ground}");
        let answer = server.get(&path).await;
        assert_eq!(answer.status(), 200, "{ground}");
        image::load_from_memory(&answer.bytes().await.unwrap()).unwrap().into_rgb8()
    };
    let [dark, lit, snow] = [drawn("dark").await, drawn("lit").await, drawn("snow").await];
    let sum = |image: &image::RgbImage, rows: std::ops::Range<u32>| {
        let pixels = rows.flat_map(|y| (0..image.width()).map(move |x| (x, y)));
        pixels.map(|(x, y)| u32::from(image.get_pixel(x, y).0[1])).sum::<u32>()
    };
    let [silhouette, bare, white] = [&dark, &lit, &snow].map(|image| sum(image, 72..96));
    assert!(bare > silhouette + 5_000 && white > bare + 10_000, "{silhouette} {bare} {white}");
    assert_eq!(sum(&lit, 0..12), sum(&dark, 0..12));
}
