//! Maps that were made beforehand, with a program behind that cannot make any.

use crate::{
    fake::Fake,
    server::{Server, header},
};
use image::{ImageFormat, Rgba, RgbaImage};
use pmtiles::{PmTilesWriter, TileCoord, TileId, TileType};
use serde_json::json;
use skyglow_app::{
    SkySource,
    fingerprint::{ATLAS_EXTENT, ATLAS_KEY, ATLAS_QUERY, ATLAS_STEP, atlas_key},
    request::{brightness, scene_id},
};
use skyglow_http::{Atlas, HttpConfig};
use std::path::Path;

const QUERY: &str = "turbidity=3&measure=horizontal";

fn picture(red: u8) -> Vec<u8> {
    let mut png = Vec::new();
    let tile = RgbaImage::from_fn(256, 256, |x, y| Rgba([red, x as u8, y as u8, 255]));
    tile.write_to(&mut std::io::Cursor::new(&mut png), ImageFormat::Png).unwrap();
    png
}

/// A file of zooms 0 and 1, the south-east of zoom 1 left out; the redness of a tile is its number.
///
/// * `last_zoom`: that of the file before something was cut out of it.
fn written(path: &Path, key: Option<&str>, last_zoom: u8) {
    let mut metadata = json!({"name": "demo: light on the ground", "scene": "demo", "scene_version": "", ATLAS_QUERY: QUERY, ATLAS_STEP: 1,
        ATLAS_EXTENT: [-180.0, -85.0, 180.0, 85.0, 0.0, last_zoom]});
    if let Some(key) = key {
        metadata[ATLAS_KEY] = key.into();
    }
    let file = std::fs::File::create(path).unwrap();
    let writer = PmTilesWriter::new(TileType::Png).metadata(metadata.to_string()).max_zoom(1);
    let mut writer = writer.bounds(-180.0, -85.0, 180.0, 85.0).create(file).unwrap();
    let mut tiles = [(0, 0, 0, 10), (1, 0, 0, 20), (1, 1, 0, 30), (1, 0, 1, 40)]
        .map(|(z, x, y, red)| (TileCoord::new(z, x, y).unwrap(), red));
    tiles.sort_by_key(|(tile, _)| TileId::from(*tile).value());
    for (tile, red) in tiles {
        writer.add_tile(tile, &picture(red)).unwrap();
    }
    writer.finalize().unwrap();
}

fn key() -> String {
    let fake = Fake::default();
    let id = scene_id("demo").unwrap();
    let view = fake.view(&id, None).unwrap();
    let request = brightness(Some(QUERY), id, fake.facts()).unwrap();
    atlas_key(&request, view.version(), fake.facts()).unwrap()
}

/// Tiles come from the file at once, of all sizes and zooms; what the file is not of is computed.
#[tokio::test(flavor = "multi_thread")]
async fn tiles_of_an_atlas_are_shown() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("demo.pmtiles");
    written(&path, Some(&key()), 1);
    for address in [path.display().to_string(), format!("file://{}", path.display())] {
        let config = HttpConfig { atlases: vec![address], ..HttpConfig::default() };
        let server = Server::with(config).await;
        let tiles = "/api/v1/scenes/demo/tiles/brightness";
        let (_, about) = server.json(&format!("{tiles}/tilejson.json?{QUERY}")).await;
        assert_eq!((&about["ready"], &about["maxzoom"]), (&json!(true), &json!(1)), "{about}");
        let of_map = about["tiles"][0].as_str().unwrap();
        let answer = async |tile: &str| {
            let [z, x, y] = tile.split('/').collect::<Vec<_>>()[..] else { panic!("{tile}") };
            let url = of_map.replace("{z}", z).replace("{x}", x).replace("{y}", y);
            let answer = server.client.get(url).send().await.unwrap();
            assert_eq!(
                (answer.status().as_u16(), header(&answer, "content-type")),
                (200, "image/png"),
                "{tile}"
            );
            assert!(header(&answer, "cache-control").contains("immutable"), "{:?}", answer.headers());
            answer.bytes().await.unwrap()
        };
        let decoded = async |tile: &str| image::load_from_memory(&answer(tile).await).unwrap().into_rgba8();
        assert_eq!(answer("1/1/0").await, picture(30), "as the file has it");
        let large = decoded("0/0/0@2x").await;
        assert_eq!(large.dimensions(), (512, 512));
        let pixel = |x: u32, y: u32| large.get_pixel(x, y).0;
        assert_eq!(
            [pixel(7, 9), pixel(263, 9), pixel(7, 265)],
            [[20, 7, 9, 255], [30, 7, 9, 255], [40, 7, 9, 255]]
        );
        assert_eq!(pixel(300, 300), [0; 4]);
        // Beyond the last zoom the part of its tile: a sixteenth a side, from a half on.
        let deep = decoded("5/24/8").await;
        assert_eq!(
            (deep.get_pixel(0, 0).0, deep.get_pixel(255, 255).0),
            ([30, 128, 128, 255], [30, 143, 143, 255])
        );
        assert_eq!(decoded("1/0/0@2x").await.get_pixel(511, 0).0, [20, 255, 0, 255]);
        assert!(decoded("1/1/1").await.pixels().all(|pixel| pixel.0[3] == 0), "nothing is there");
        assert_eq!(server.answer(&format!("{tiles}/1/2/0.png?{QUERY}")).await.status(), 404);
        // Of any other map it says nothing, and this program can make none.
        let other = server.answer(&format!("{tiles}/1/1/0.png?turbidity=4&measure=horizontal")).await;
        assert_eq!(other.status(), 503);
        let (_, about) = server.json(&format!("{tiles}/tilejson.json")).await;
        assert_ne!(about["maxzoom"], json!(1));
    }
}

/// What is no atlas says why, and what is of another scene is not shown.
#[tokio::test(flavor = "multi_thread")]
async fn what_is_no_atlas_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("demo.pmtiles");
    let address = path.display().to_string();
    let refused = || Atlas::open(&address).unwrap_err().to_string();
    assert!(refused().contains("No such file"), "{}", refused());
    written(&path, None, 1);
    assert!(refused().contains("make it anew"), "{}", refused());
    std::fs::write(&path, [0; 300]).unwrap();
    assert!(refused().contains("PMTiles"), "{}", refused());
    written(&path, Some(&key()), 5);
    assert!(refused().contains("part of a map"), "{}", refused());
    written(&path, Some("of another version"), 1);
    let server = Server::with(HttpConfig { atlases: vec![address], ..HttpConfig::default() }).await;
    let tile = server.answer(&format!("/api/v1/scenes/demo/tiles/brightness/1/1/0.png?{QUERY}")).await;
    assert_eq!(tile.status(), 503);
}
