//! What files say about themselves: assumptions, and whether their light was measured.

use crate::server::{PLACE, Server};
use std::sync::atomic::Ordering;

async fn bytes(server: &Server, path: &str) -> Vec<u8> {
    let answer = server.answer(path).await;
    assert_eq!(answer.status(), 200, "{path}");
    answer.bytes().await.unwrap().to_vec()
}

fn says(bytes: &[u8], words: &str) -> bool {
    bytes.windows(words.len()).any(|window| window == words.as_bytes())
}

/// Every picture and raster of synthetic light says so, and no other does.
#[tokio::test]
async fn synthetic_light_is_marked_in_every_file() {
    let server = Server::start().await;
    for illustrative in [true, false] {
        server.fake.illustrative.store(illustrative, Ordering::SeqCst);
        for format in ["png", "webp", "exr", "tif"] {
            let file = bytes(&server, &format!("/api/v1/scenes/demo/panorama.{format}?{PLACE}")).await;
            assert_eq!(says(&file, "illustrative: made-up light, not measured"), illustrative, "{format}");
            assert!(says(&file, &format!("\"illustrative\":{illustrative}")), "{format}");
        }
        for layer in ["radiance", "elevation"] {
            let tile = bytes(&server, &format!("/api/v1/scenes/demo/tiles/{layer}/6/38/32.png")).await;
            assert_eq!(says(&tile, "illustrative: made-up light"), illustrative, "{layer}");
            let (_, document) =
                server.json(&format!("/api/v1/scenes/demo/tiles/{layer}/tilejson.json")).await;
            let description = document["description"].as_str().unwrap();
            assert_eq!(description.contains("illustrative"), illustrative, "{description}");
        }
    }
}

#[tokio::test]
async fn the_legend_of_made_up_light_is_a_line_higher() {
    let server = Server::start().await;
    let mut heights = [0, 0];
    for (height, illustrative) in heights.iter_mut().zip([true, false]) {
        server.fake.illustrative.store(illustrative, Ordering::SeqCst);
        let png = bytes(&server, &format!("/api/v1/scenes/demo/panorama.png?{PLACE}")).await;
        *height = image::load_from_memory(&png).unwrap().height();
    }
    assert!(heights[0] >= heights[1] + 18, "{heights:?}");
}

/// Every picture and raster carries the assumptions of its numbers.
#[tokio::test]
async fn every_file_carries_its_assumptions() {
    let server = Server::start().await;
    for format in ["png", "webp", "exr", "tif"] {
        let query = format!("{PLACE}&turbidity=3.25&lamp=hps&emission=shielded&scattering=single");
        let file = bytes(&server, &format!("/api/v1/scenes/demo/panorama.{format}?{query}")).await;
        for words in [
            "\"turbidity\":3.25",
            "\"scattering\":\"single\"",
            "\"preset\":\"hps\"",
            "\"lambert\":1.0",
            "\"coverage\":",
            "\"local_optical_depth\":[",
            "\"calibration\":1.0",
            "artificial light alone; scene demo, turbidity 3.25, scattering single, lamp hps, emission full_cutoff",
        ] {
            assert!(says(&file, words), "{format}: {words}");
        }
        let total = bytes(&server, &format!("/api/v1/scenes/demo/panorama.{format}?{PLACE}&sky=total")).await;
        assert!(says(&total, "artificial light with the natural sky"), "{format}");
    }
}

#[tokio::test]
async fn a_picture_has_a_largest_number_of_pixels() {
    let server = Server::start().await;
    let base = format!("/api/v1/scenes/demo/panorama.png?{PLACE}");
    for (query, parameter) in [
        ("&width=4096&height_px=4096", "height_px"),
        ("&projection=fisheye&width=4096&height_px=2049", "height_px"),
    ] {
        let (status, problem) = server.json(&format!("{base}{query}")).await;
        assert_eq!(status, 400, "{query}");
        assert_eq!(problem["errors"][0]["parameter"], parameter);
        assert_eq!(problem["errors"][0]["allowed"], "at most 8388608 pixels in all");
    }
    bytes(&server, &format!("{base}&width=4096&height_px=16")).await;
}
