//! Influences of the lights: numbers, files and map tiles.

use super::{EndToEnd, number};
use crate::server::header;
use serde_json::{Value, json};

/// They add up to the sky's own numbers, by rings, by sectors and by pixels.
#[tokio::test]
async fn influences_are_those_of_the_sky() {
    let server = EndToEnd::shared().await;
    let place = server.town().await.query;
    let sky = server.sky(&place).await;
    for (measure, of_sky) in [
        ("zenith", "zenith_luminance_cd_m2"),
        ("mean", "mean_luminance_cd_m2"),
        ("horizontal", "horizontal_illuminance_lx"),
    ] {
        let path = format!("/api/v1/scenes/demo/influence.json?{place}&measure={measure}&limit=5");
        let (status, answer) = server.json(&path).await;
        assert_eq!((status, &answer["measure"]), (200, &json!(measure)), "{answer}");
        let total = number(&answer["total"]);
        assert!((total / number(&sky["sky"][of_sky]) - 1.0).abs() < 1e-4, "{measure}");
        for parts in ["rings", "sectors"] {
            let shares = answer[parts].as_array().unwrap().iter().map(|part| number(&part["share"]));
            assert!((shares.sum::<f64>() - 1.0).abs() < 1e-6, "{measure} {parts}");
        }
        let pixels = answer["pixels"].as_array().unwrap();
        assert_eq!(pixels.len(), 5);
        assert!(pixels.windows(2).all(|pair| number(&pair[0]["influence"]) >= number(&pair[1]["influence"])));
        let last = number(&pixels[4]["cumulative_share"]);
        let sum: f64 = pixels.iter().map(|pixel| number(&pixel["share"])).sum();
        assert!((last - sum).abs() < 1e-12 && last > 0.0 && last <= 1.0);
        // Every number comes with what it depends on.
        for name in ["observer", "lamp", "emission", "calibration", "coverage", "local_optical_depth"] {
            assert_eq!(answer[name], sky[name], "{name}");
        }
    }
    let (_, one) = server.json(&format!("/api/v1/scenes/demo/influence?{place}&limit=1")).await;
    let pixel = &one["pixels"][0];
    let at = format!("lat={}&lon={}", pixel["latitude_deg"], pixel["longitude_deg"]);
    let (_, site) = server.json(&format!("/api/v1/scenes/demo/site?{at}")).await;
    assert_eq!(site["radiance_nw_cm2_sr"], pixel["radiance_nw_cm2_sr"]);
    assert_eq!((&one["measure"], &one["unit"]), (&json!("zenith"), &json!("cd m-2")));
}

#[tokio::test]
async fn influence_comes_as_a_raster() {
    // Alone, so that the map is computed for this request: with the time that each step took.
    let server = EndToEnd::alone().await;
    let path = format!("/api/v1/scenes/demo/influence.tif?{}&turbidity=2.9", server.town().await.query);
    let answer = server.get(&path).await;
    assert_eq!((answer.status().as_u16(), header(&answer, "content-type")), (200, "image/tiff"));
    assert!(header(&answer, "server-timing").contains("cells;dur="));
    let tag = header(&answer, "etag").to_owned();
    let bytes = answer.bytes().await.unwrap();
    let mut raster = tiff::decoder::Decoder::new(std::io::Cursor::new(bytes)).unwrap();
    let (_, scene) = server.json("/api/v1/scenes/demo").await;
    let size = (scene["grid"]["width"].as_u64().unwrap(), scene["grid"]["height"].as_u64().unwrap());
    assert_eq!(raster.dimensions().map(|(w, h)| (u64::from(w), u64::from(h))).unwrap(), size);
    assert_eq!(server.get_unless(&path, &tag).await, 304);
    // Its style for QGIS: the last class but one ends at a hundredth of the whole.
    let style = server.get(&path.replace(".tif", ".qml")).await.text().await.unwrap();
    let (_, whole) = server.json(&path.replace(".tif", ".json")).await;
    let classes = style.split("<item ").skip(1).filter_map(|item| item.split("value=\"").nth(1));
    let limits = classes.filter_map(|limit| limit.split('"').next()?.parse().ok());
    let most = limits.filter(|limit: &f64| limit.is_finite()).fold(0.0, f64::max);
    assert!((most / (0.01 * whole["total"].as_f64().unwrap()) - 1.0).abs() < 1e-6, "{most}");
}

#[tokio::test]
async fn influence_comes_as_a_list_and_points() {
    let server = EndToEnd::shared().await;
    let place = server.town().await.query;
    let list =
        server.get(&format!("/api/v1/scenes/demo/influence.csv?{place}&limit=3")).await.text().await.unwrap();
    let lines: Vec<&str> = list.lines().collect();
    assert_eq!(lines.len(), 4);
    assert!(
        lines[0].starts_with("rank,latitude_deg,") && lines[0].contains(",influence_cd_m2,"),
        "{}",
        lines[0]
    );
    assert!(lines.iter().all(|line| line.split(',').count() == 12));
    let accepting = server.client.get(format!("{}/api/v1/scenes/demo/influence?{place}", server.base));
    let points = accepting.header("accept", "application/geo+json").send().await.unwrap();
    assert_eq!(
        (header(&points, "vary"), header(&points, "content-type")),
        ("accept, accept-encoding", "application/geo+json")
    );
    let points: Value = points.json().await.unwrap();
    assert_eq!(
        (&points["type"], points["features"].as_array().unwrap().len()),
        (&json!("FeatureCollection"), 100)
    );
    let first = &points["features"][0];
    assert_eq!(first["geometry"]["coordinates"][0], first["properties"]["longitude_deg"]);
}

/// Tiles of one map are cut from one computation.
#[tokio::test]
async fn influence_tiles_share_one_map() {
    let server = EndToEnd::alone().await;
    let town = server.town().await;
    let query = format!("{}&measure=region&region=350,10;10,10;0,50", town.query);
    let (status, tilejson) =
        server.json(&format!("/api/v1/scenes/demo/tiles/influence/tilejson.json?{query}")).await;
    assert_eq!(status, 200, "{tilejson}");
    assert!(tilejson["tiles"][0].as_str().unwrap().ends_with(&query));
    let tile = server.tile_over(&town, &tilejson, 8, "").await;
    let shown = tile.pixels().filter(|pixel| pixel.0[3] > 0).count();
    assert!(shown > 0 && shown < tile.pixels().count(), "{shown}");
    assert!(number(&tilejson["range"][1]) > 0.0 && tilejson["unit"] == "cd m-2");
    let found = async || server.counted("skyglow_influence_maps_total").await;
    let before = found().await;
    for (zoom, x, y) in [(7, 66, 45), (8, 133, 91), (9, 267, 182), (2, 2, 1)] {
        let path = format!("/api/v1/scenes/demo/tiles/influence/{zoom}/{x}/{y}.png?{query}");
        assert_eq!(server.get(&path).await.status(), 200);
    }
    assert_eq!(found().await, before);
    let list = server.get(&format!("/api/v1/scenes/demo/influence.csv?{query}&turbidity=2.7")).await;
    assert_eq!(list.status(), 200);
    assert_eq!(found().await, before + 1);
    let (status, problem) = server.json("/api/v1/scenes/demo/tiles/influence/tilejson.json").await;
    assert_eq!((status, &problem["errors"][0]["parameter"]), (400, &json!("lat")));
    let path = format!("/api/v1/scenes/demo/tiles/radiance/tilejson.json?{}", town.query);
    assert_eq!(server.json(&path).await.0, 400);
}
