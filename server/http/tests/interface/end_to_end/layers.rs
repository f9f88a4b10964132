//! Map layers: tiles, the zenith's brightness at every place, and layers as rasters.

use super::{EndToEnd, number, zenith};
use crate::server::header;
use serde_json::json;
use std::io::Cursor;
use tiff::decoder::{Decoder, DecodingResult};

/// Values and width of a raster of one band.
fn raster(bytes: &[u8]) -> (Vec<f32>, usize) {
    let mut decoder = Decoder::new(Cursor::new(bytes)).unwrap();
    let (width, _) = decoder.dimensions().unwrap();
    let DecodingResult::F32(values) = decoder.read_image().unwrap() else { panic!("not float32") };
    (values, width as usize)
}

#[tokio::test]
async fn tiles_show_radiance_and_elevation() {
    let server = EndToEnd::shared().await;
    let town = server.town().await;
    for layer in ["radiance", "elevation"] {
        let (_, tilejson) = server.json(&format!("/api/v1/scenes/demo/tiles/{layer}/tilejson.json")).await;
        let tile = server.tile_over(&town, &tilejson, 7, "").await;
        assert!(tile.pixels().any(|pixel| pixel.0[3] > 0), "{layer} shows something");
    }
}

/// No other test asks for brightness, so its counter is this test's own.
#[tokio::test]
async fn brightness_is_that_of_the_skies() {
    let server = EndToEnd::shared().await;
    let town = server.town().await;
    let maps_found = async || server.counted("skyglow_brightness_maps_total").await;
    // Lamps as bright as the made-up tables are dim.
    let query = "terrain=off&lamp=100,100,100";
    // To describe the layer begins its map and waits for nothing.
    let described = format!("/api/v1/scenes/demo/tiles/brightness/tilejson.json?{query}");
    assert_eq!(server.json(&described).await.1["ready"], json!(false));
    let mut tries = 0;
    while server.json(&described).await.1["ready"] != json!(true) {
        tries += 1;
        assert!(tries < 600, "the map is not found after a minute");
        tokio::time::sleep(std::time::Duration::from_millis(100)).await;
    }
    let found = maps_found().await;
    let path = format!("/api/v1/scenes/demo/layers/brightness.tif?{query}");
    let answer = server.get(&path).await;
    assert_eq!(maps_found().await, found, "what was begun is what is answered");
    assert_eq!((answer.status().as_u16(), header(&answer, "content-type")), (200, "image/tiff"));
    let tag = header(&answer, "etag").to_owned();
    let (values, width) = raster(&answer.bytes().await.unwrap());
    assert_eq!(server.get_unless(&path, &tag).await, 304);
    let (_, scene) = server.json("/api/v1/scenes/demo").await;
    let (columns, rows) = (number(&scene["grid"]["width"]), number(&scene["grid"]["height"]));
    // The scene has more pixels than places are allowed: the raster is linear between the middles of blocks.
    assert_eq!((width as f64, values.len() as f64), (columns, columns * rows));
    let mut step = 1.0;
    while (columns / step).floor() * (rows / step).floor() > 20_000.0 {
        step *= 2.0;
    }
    assert!(step >= 4.0 && values.iter().all(|value| *value >= 0.0));
    let (places_across, places_down) = ((columns / step) as usize, (rows / step) as usize);
    // The middle of a block lies on the corner of four pixels: its number by those on the way there.
    let number_at = |column: usize, row: usize| {
        let (x, y) = ((step * (column as f64 + 0.5)) as usize, (step * (row as f64 + 0.5)) as usize);
        let in_row = |y: usize| {
            1.5 * f64::from(values[y * width + x - 1]) - 0.5 * f64::from(values[y * width + x - 2])
        };
        1.5 * in_row(y - 1) - 0.5 * in_row(y - 2)
    };
    let [west, south, east, north] = [0, 1, 2, 3].map(|side| number(&scene["bounds"][side]));
    let middle = |column: usize, row: usize| {
        let part = |at: usize, count: f64| step * (at as f64 + 0.5) / count;
        (north + part(row, rows) * (south - north), west + part(column, columns) * (east - west))
    };
    let mut compared = 0;
    for at in (0..places_across * places_down).step_by(1_501) {
        let (column, row) = (at % places_across, at / places_across);
        let ((lat, lon), value) = (middle(column, row), number_at(column, row));
        let (status, sky) =
            server.json(&format!("/api/v1/scenes/demo/sky?lat={lat}&lon={lon}&{query}")).await;
        // Ground above what made-up tables reach has no number.
        assert_eq!(status == 200, !value.is_nan(), "{sky}");
        let wanted = zenith(&sky);
        assert!((value / wanted - 1.0).abs() < 0.02, "{lat} {lon}: {value} {wanted}");
        compared += 1;
    }
    assert!(compared > 8, "{compared}");

    let (_, tilejson) = server.json(&described).await;
    let (lowest, natural) = (number(&tilejson["range"][0]), number(&tilejson["natural"]));
    let dark = skyglow_observatory::night_sky::dark_outside().luminance_cd_m2();
    assert!((natural / dark - 1.0).abs() < 1e-9 && (2.1e-4..2.4e-4).contains(&natural), "{natural}");
    assert!(tilejson["unit"] == "cd m-2" && (lowest / (0.01 * natural) - 1.0).abs() < 1e-9, "{lowest}");
    let before = maps_found().await;
    for (suffix, size) in [("", 256), ("@2x", 512)] {
        let tile = server.tile_over(&town, &tilejson, 7, suffix).await;
        assert_eq!(tile.dimensions(), (size, size));
        assert!(tile.pixels().any(|pixel| pixel.0[3] > 0), "it shows something");
    }
    assert_eq!(maps_found().await, before, "tiles and raster of one map are cut from one computation");
    // A style needs no map.
    let style = server.get("/api/v1/scenes/demo/layers/brightness.qml?measure=horizontal").await;
    assert_eq!(header(&style, "content-type"), "text/xml; charset=utf-8");
    let darkest = format!("value=\"{:?}\"", 0.01 * std::f64::consts::PI * dark);
    let style = style.text().await.unwrap();
    assert!(style.contains(&darkest[..14]), "{darkest}: {style}");
    for (path, status) in [
        ("layers/brightness.qml?turbidity=5", 422),
        ("tiles/brightness/7/200/0.png?lat=3", 400),
        ("tiles/brightness/3/9/0.png", 404),
        ("tiles/brightness/30/0/0.png", 404),
        ("tiles/brightness/tilejson.json?scenario=s-0123456789abcdef0123", 404),
        ("layers/brightness.tif?turbidity=5", 422),
        ("layers/brightness.tif?clouds=1500", 422),
        ("layers/brightness.tif?cloud_cover=0.5", 400),
        ("layers/elevation.tif?scenario=s-0123456789abcdef0123", 400),
        ("layers/influence.tif", 404),
    ] {
        assert_eq!(server.get(&format!("/api/v1/scenes/demo/{path}")).await.status(), status, "{path}");
    }
    assert_eq!(maps_found().await, before, "nothing is found for what is refused");
}

#[tokio::test]
async fn layers_come_as_rasters() {
    let server = EndToEnd::shared().await;
    let town = server.town().await;
    let (_, scene) = server.json("/api/v1/scenes/demo").await;
    let [west, south, east, north] = [0, 1, 2, 3].map(|side| number(&scene["bounds"][side]));
    let (_, site) = server.json(&format!("/api/v1/scenes/demo/site?{}", town.query)).await;
    for (layer, name, within) in
        [("radiance", "radiance_nw_cm2_sr", 1e-3), ("elevation", "terrain_altitude_m", 150.0)]
    {
        let answer = server.get(&format!("/api/v1/scenes/demo/layers/{layer}.tif")).await;
        assert_eq!(answer.status(), 200);
        let (values, width) = raster(&answer.bytes().await.unwrap());
        let height = values.len() / width;
        assert_eq!(number(&scene["grid"]["width"]), width as f64);
        let column = ((town.longitude_deg - west) / (east - west) * width as f64) as usize;
        let row = ((north - town.latitude_deg) / (north - south) * height as f64) as usize;
        let (got, wanted) = (f64::from(values[row * width + column]), number(&site[name]));
        assert!((got - wanted).abs() <= within, "{layer} {got} {wanted}");
    }
}
