//! Map layers of the real program: the zenith's brightness at every place, and layers as rasters.

use crate::{server::header, whole::Whole};
use serde_json::json;
use std::{f64::consts::PI, io::Cursor};
use tiff::decoder::{Decoder, DecodingResult};

/// Values and width of a raster of one band.
fn raster(bytes: &[u8]) -> (Vec<f32>, usize) {
    let mut decoder = Decoder::new(Cursor::new(bytes)).unwrap();
    let (width, _) = decoder.dimensions().unwrap();
    let DecodingResult::F32(values) = decoder.read_image().unwrap() else { panic!("not float32") };
    (values, width as usize)
}

/// How many maps of brightness were found so far.
async fn maps_found(whole: &Whole) -> u32 {
    let metrics = whole.get("/metrics").await.text().await.unwrap();
    let line = metrics.lines().find(|line| line.starts_with("skyglow_brightness_maps_total ")).unwrap();
    line.split(' ').nth(1).unwrap().parse().unwrap()
}

pub(crate) async fn brightness_is_that_of_the_skies(whole: &Whole, (lat, lon): (f64, f64)) {
    // Lamps as bright as the made-up tables are dim.
    let query = "terrain=off&lamp=100,100,100";
    // To describe the layer begins its map and waits for nothing.
    let described = format!("/api/v1/scenes/demo/tiles/brightness/tilejson.json?{query}");
    assert_eq!(whole.json(&described).await.1["ready"], json!(false));
    let mut tries = 0;
    while whole.json(&described).await.1["ready"] != json!(true) {
        tries += 1;
        assert!(tries < 600, "the map is not found after a minute");
        tokio::time::sleep(std::time::Duration::from_millis(100)).await;
    }
    let found = maps_found(whole).await;
    let path = format!("/api/v1/scenes/demo/layers/brightness.tif?{query}");
    let answer = whole.get(&path).await;
    assert_eq!(maps_found(whole).await, found, "what was begun is what is answered");
    assert_eq!((answer.status().as_u16(), header(&answer, "content-type")), (200, "image/tiff"));
    let tag = header(&answer, "etag").to_owned();
    let (values, width) = raster(&answer.bytes().await.unwrap());
    let again = whole.client.get(format!("{}{path}", whole.base)).header("if-none-match", tag);
    assert_eq!(again.send().await.unwrap().status(), 304);
    let (_, scene) = whole.json("/api/v1/scenes/demo").await;
    let number = |value: &serde_json::Value| value.as_f64().unwrap();
    let (columns, rows) = (number(&scene["grid"]["width"]), number(&scene["grid"]["height"]));
    // The scene has more pixels than places are allowed: blocks share one.
    let step = (columns / width as f64).floor();
    assert!(step >= 4.0 && values.len() <= 20_000 && values.iter().all(|value| *value >= 0.0));
    let [west, south, east, north] = [0, 1, 2, 3].map(|side| number(&scene["bounds"][side]));
    let middle = |column: usize, row: usize| {
        let part = |at: usize, count: f64| step * (at as f64 + 0.5) / count;
        (north + part(row, rows) * (south - north), west + part(column, columns) * (east - west))
    };
    let mut compared = 0;
    for at in (0..values.len()).step_by(1_501) {
        let (lat, lon) = middle(at % width, at / width);
        let (status, sky) = whole.json(&format!("/api/v1/scenes/demo/sky?lat={lat}&lon={lon}&{query}")).await;
        // Ground above what made-up tables reach has no number.
        assert_eq!(status == 200, !values[at].is_nan(), "{sky}");
        let wanted = number(&sky["sky"]["zenith_luminance_cd_m2"]);
        assert!((f64::from(values[at]) / wanted - 1.0).abs() < 0.02, "{lat} {lon}: {} {wanted}", values[at]);
        compared += 1;
    }
    assert!(compared > 8, "{compared}");

    let (_, tilejson) = whole.json(&described).await;
    assert_eq!((&tilejson["unit"], &tilejson["range"][0]), (&json!("cd m-2"), &json!(1.71e-6)));
    let before = maps_found(whole).await;
    let n = 128.0;
    let x = ((lon + 180.0) / 360.0 * n).floor();
    let y = ((1.0 - lat.to_radians().tan().asinh() / PI) / 2.0 * n).floor();
    let url = tilejson["tiles"][0].as_str().unwrap();
    let url = url.replace("{z}", "7").replace("{x}", &x.to_string());
    for (name, size) in [(y.to_string(), 256), (format!("{y}@2x"), 512)] {
        let answer = whole.client.get(url.replace("{y}", &name)).send().await.unwrap();
        assert_eq!(answer.status(), 200);
        let tile = image::load_from_memory(&answer.bytes().await.unwrap()).unwrap().into_rgba8();
        assert_eq!(tile.dimensions(), (size, size));
        assert!(tile.pixels().any(|pixel| pixel.0[3] > 0), "it shows something");
    }
    assert_eq!(maps_found(whole).await, before, "tiles and raster of one map are cut from one computation");
    for (path, status) in [
        ("tiles/brightness/7/200/0.png?lat=3", 400),
        ("tiles/brightness/3/9/0.png", 404),
        ("tiles/brightness/30/0/0.png", 404),
        ("tiles/brightness/tilejson.json?scenario=s-0123456789abcdef0123", 404),
        ("layers/brightness.tif?turbidity=5", 422),
        ("layers/brightness.tif?clouds=none", 400),
        ("layers/elevation.tif?scenario=s-0123456789abcdef0123", 400),
        ("layers/influence.tif", 404),
    ] {
        assert_eq!(whole.get(&format!("/api/v1/scenes/demo/{path}")).await.status(), status, "{path}");
    }
    assert_eq!(maps_found(whole).await, before, "nothing is found for what is refused");
}

pub(crate) async fn layers_come_as_rasters(whole: &Whole, (lat, lon): (f64, f64)) {
    let (_, scene) = whole.json("/api/v1/scenes/demo").await;
    let number = |value: &serde_json::Value| value.as_f64().unwrap();
    let [west, south, east, north] = [0, 1, 2, 3].map(|side| number(&scene["bounds"][side]));
    let (_, site) = whole.json(&format!("/api/v1/scenes/demo/site?lat={lat}&lon={lon}")).await;
    for (layer, name, within) in
        [("radiance", "radiance_nw_cm2_sr", 1e-3), ("elevation", "terrain_altitude_m", 150.0)]
    {
        let answer = whole.get(&format!("/api/v1/scenes/demo/layers/{layer}.tif")).await;
        assert_eq!(answer.status(), 200);
        let (values, width) = raster(&answer.bytes().await.unwrap());
        let height = values.len() / width;
        assert_eq!(number(&scene["grid"]["width"]), width as f64);
        let column = ((lon - west) / (east - west) * width as f64) as usize;
        let row = ((north - lat) / (north - south) * height as f64) as usize;
        let (got, wanted) = (f64::from(values[row * width + column]), number(&site[name]));
        assert!((got - wanted).abs() <= within, "{layer} {got} {wanted}");
    }
}
