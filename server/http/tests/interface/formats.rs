use crate::{
    fake::bands_of,
    server::{PLACE, Server, header},
};
use serde_json::Value;
use skyglow_physics::{AZIMUTH_COUNT, Horizon, photometry, spectrum::RGB_BANDS};
use std::io::Cursor;

async fn body(server: &Server, path: &str) -> (String, Vec<u8>) {
    let answer = server.answer(path).await;
    assert_eq!(answer.status(), 200, "{path}");
    let media_type = header(&answer, "content-type").to_owned();
    (media_type, answer.bytes().await.unwrap().to_vec())
}

/// PNG and WebP show the same sky with a legend below it.
#[tokio::test]
async fn png_and_webp_show_the_same_sky() {
    let server = Server::start().await;
    let base = "/api/v1/scenes/demo/panorama";
    let (png_type, png) = body(&server, &format!("{base}.png?{PLACE}")).await;
    let (webp_type, webp) = body(&server, &format!("{base}.webp?{PLACE}")).await;
    assert_eq!((png_type.as_str(), webp_type.as_str()), ("image/png", "image/webp"));
    let png = image::load_from_memory_with_format(&png, image::ImageFormat::Png).unwrap().into_rgb8();
    let webp = image::load_from_memory_with_format(&webp, image::ImageFormat::WebP).unwrap().into_rgb8();
    assert_eq!(png, webp);
    assert_eq!(png.width(), 1024);
    assert!(png.height() > 256);
    // The glow is low in the east: a quarter along the bottom of the sky, above the letters.
    let sum = |x: u32, y: u32| png.get_pixel(x, y).0.iter().map(|&c| u32::from(c)).sum::<u32>();
    assert!(sum(256, 220) > sum(768, 220) + 100);
    let (_, bare) = body(&server, &format!("{base}.png?{PLACE}&legend=off&width=300&height_px=100")).await;
    let bare = image::load_from_memory(&bare).unwrap();
    assert_eq!((bare.width(), bare.height()), (300, 100));
}

/// Tiff and json hold the radiance that was rendered.
#[tokio::test]
async fn tiff_and_json_hold_the_rendered_radiance() {
    let server = Server::start().await;
    let sky = bands_of(3.0);
    let (media_type, tif) =
        body(&server, &format!("/api/v1/scenes/demo/panorama.tif?{PLACE}&turbidity=3")).await;
    assert_eq!(media_type, "image/tiff");
    let mut decoder = tiff::decoder::Decoder::new(Cursor::new(tif)).unwrap();
    assert_eq!(decoder.dimensions().unwrap(), (256, 64));
    let tiff::decoder::DecodingResult::F32(values) = decoder.read_image().unwrap() else {
        panic!("not float32")
    };
    // Zenith at the top in the raster, row 0 lowest in the grid.
    assert_eq!(values[(63 * 256 + 64) * 3 + 1], sky.plane(1)[64]);
    assert_eq!(values[2], sky.plane(2)[63 * 256]);

    let (media_type, json) =
        body(&server, &format!("/api/v1/scenes/demo/panorama.json?{PLACE}&turbidity=3")).await;
    assert_eq!(media_type, "application/json");
    let json: Value = serde_json::from_slice(&json).unwrap();
    for (band, row, column) in [(0, 0, 0), (1, 3, 64), (2, 63, 255)] {
        let value = json["radiance"][band][row][column].as_f64().unwrap() as f32;
        assert_eq!(value, sky.plane(band)[256 * row + column]);
    }
    assert_eq!(json["grid"]["azimuth_count"], 256);
    assert_eq!(json["grid"]["elevation_first_deg"], 0.703125);
    assert_eq!(json["bands_nm"], serde_json::json!([[600.0, 700.0], [500.0, 600.0], [400.0, 500.0]]));
    assert_eq!(json["unit"], "W m-2 sr-1");
    assert_eq!(json["horizon_deg"].as_array().unwrap().len(), 256);
    assert_eq!(json["coverage"], 0.95);
    assert_eq!(json["observer"]["altitude_m"], 1702.0);
    assert!(json["sky"]["zenith_luminance_cd_m2"].as_f64().unwrap() > 0.0);
}

/// OpenEXR starts with its magic number and names its channels.
#[tokio::test]
async fn openexr_has_its_magic_and_its_channels() {
    let server = Server::start().await;
    let (media_type, exr) = body(&server, &format!("/api/v1/scenes/demo/panorama.exr?{PLACE}")).await;
    assert_eq!(media_type, "image/x-exr");
    assert_eq!(exr[..4], [0x76, 0x2f, 0x31, 0x01]);
    let head = String::from_utf8_lossy(&exr[..4_000]).into_owned();
    assert!(head.contains("channels") && head.contains("chlist"), "{head}");
}

/// A compact panorama has a header that lists its planes and two bytes for each of their samples.
#[tokio::test]
async fn a_compact_panorama_has_header_and_planes() {
    let server = Server::start().await;
    let path = format!("/api/v1/scenes/demo/panorama.sky?{PLACE}&turbidity=3");
    for (more, responses) in [
        ("", vec!["cie_x", "photopic", "cie_z", "scotopic"]),
        ("&response=sqm", vec!["cie_x", "photopic", "cie_z", "scotopic", "sqm"]),
    ] {
        let (media_type, file) = body(&server, &format!("{path}{more}")).await;
        assert_eq!(media_type, "application/vnd.skyglow.sky");
        assert_eq!(&file[..8], b"SKYGLOW\x01");
        let length = u32::from_le_bytes(file[8..12].try_into().unwrap()) as usize;
        let header: Value = serde_json::from_slice(&file[12..12 + length]).unwrap();
        let planes = header["planes"].as_array().unwrap();
        let found: Vec<&str> = planes.iter().map(|plane| plane["response"].as_str().unwrap()).collect();
        assert_eq!(found, responses);
        assert!(
            planes.iter().all(|plane| plane["light"] == "artificial" && plane["lowest"].as_f64() > Some(0.0))
        );
        assert_eq!(file.len(), 12 + length + responses.len() * 2 * 256 * 64);
        assert_eq!((&header["turbidity"], &header["points"]["count"]), (&3.0.into(), &0.into()));
        assert_eq!(header["horizon_deg"].as_array().unwrap().len(), 256);
    }
    // It holds both lights where there are two: none is chosen.
    let (status, problem) = server.json(&format!("{path}&sky=total")).await;
    assert_eq!((status, &problem["errors"][0]["parameter"]), (400, &"sky".into()));
}

/// The Accept header chooses the format of the bare resource.
#[tokio::test]
async fn the_accept_header_chooses_the_format() {
    let server = Server::start().await;
    let path = format!("/api/v1/scenes/demo/panorama?{PLACE}");
    for (accept, media_type) in [
        ("*/*", "image/png"),
        ("application/json", "application/json"),
        ("image/webp, image/png;q=0.5", "image/webp"),
        ("image/tiff", "image/tiff"),
        ("image/x-exr", "image/x-exr"),
        ("application/vnd.skyglow.sky", "application/vnd.skyglow.sky"),
    ] {
        let answer = server.get(&path).header("accept", accept).send().await.unwrap();
        assert_eq!((answer.status().as_u16(), header(&answer, "content-type")), (200, media_type));
        assert!(header(&answer, "vary").contains("accept,"), "{}", header(&answer, "vary"));
    }
    let refused = server.get(&path).header("accept", "video/mp4").send().await.unwrap();
    assert_eq!(refused.status(), 406);
}

#[tokio::test]
async fn every_projection_and_style_is_drawn() {
    let server = Server::start().await;
    for query in [
        "projection=fisheye",
        "projection=perspective&azimuth=90&elevation=15&fov=60",
        "projection=fisheye&style=realistic&exposure=-1",
        "colormap=viridis&scale=magnitude&min=16&max=24",
        "sky=total&style=realistic",
    ] {
        let (_, png) = body(&server, &format!("/api/v1/scenes/demo/panorama.png?{PLACE}&{query}")).await;
        let picture = image::load_from_memory(&png).unwrap().into_rgb8();
        let colours: std::collections::HashSet<_> = picture.pixels().collect();
        assert!(colours.len() > 50, "{query}: {} colours", colours.len());
    }
}

#[tokio::test]
async fn every_number_comes_with_what_it_depends_on() {
    let server = Server::start().await;
    let (status, sky) =
        server.json(&format!("/api/v1/scenes/demo/sky?{PLACE}&lamp=hps&emission=shielded")).await;
    assert_eq!(status, 200);
    assert_eq!(sky["lamp"]["preset"], "hps");
    let emission = serde_json::json!({
        "preset": "full_cutoff", "direct_uplight": 0.0, "ground_reflectance": 0.15,
        "lambert": 1.0, "horizon": 0.0, "oblique": 0.0, "keep": "flux", "flux_factor": 1.0,
    });
    assert_eq!(sky["emission"], emission);
    assert_eq!(sky["turbidity"], 2.5);
    assert_eq!(sky["calibration"], 1.0);
    assert_eq!(sky["terrain_occlusion"], true);
    assert_eq!((&sky["scattering"], &sky["ground_albedo"]), (&"single".into(), &Value::Null));
    assert_eq!(sky["clouds"], "none");
    assert_eq!(sky["local_optical_depth"].as_array().unwrap().len(), skyglow_physics::BAND_COUNT);
    assert_eq!(sky["scene"]["illustrative"], true);
    let luminance = sky["sky"]["zenith_luminance_cd_m2"].as_f64().unwrap();
    let magnitude = sky["sky"]["zenith_brightness_mag_arcsec2"].as_f64().unwrap();
    assert!((photometry::brightness_mag_arcsec2(luminance).unwrap() - magnitude).abs() < 1e-9);
}

/// The total sky adds the natural one to the samples.
#[tokio::test]
async fn the_total_sky_adds_the_natural_one() {
    let server = Server::start().await;
    let sample = async |light: &str| {
        let path = format!("/api/v1/scenes/demo/panorama.json?{PLACE}&sky={light}");
        let (_, json) = server.json(&path).await;
        assert_eq!(json["light"], light);
        let bands = [0, 1, 2].map(|b| json["radiance"][b][40][7].as_f64().unwrap());
        (bands, json["values"][40][7].as_f64().unwrap())
    };
    let ((total, seen_total), (artificial, seen)) = (sample("total").await, sample("artificial").await);
    let dark = skyglow_observatory::night_sky::dark_outside();
    let added = (seen_total - seen) / dark.luminance_cd_m2();
    assert!((added - 1.0).abs() < 1e-4, "{added}");
    for (band, (total, artificial)) in RGB_BANDS.iter().zip(total.into_iter().zip(artificial)) {
        let added = (total - artificial) / dark.value(band);
        assert!((added - 1.0).abs() < 1e-4, "{added}");
    }
}

/// Terrain hides the sky in every format, and `terrain=off` shows all of it.
#[tokio::test]
async fn terrain_hides_the_sky_in_every_format() {
    let server = Server::start().await;
    let horizon = Horizon::new(vec![20f64.to_radians(); AZIMUTH_COUNT]).unwrap();
    *server.fake.horizon.lock().unwrap() = horizon.clone();
    for light in ["artificial", "total"] {
        let path = format!("/api/v1/scenes/demo/panorama.json?{PLACE}&sky={light}");
        let (_, on) = server.json(&path).await;
        let (_, off) = server.json(&format!("{path}&terrain=off")).await;
        assert_eq!(
            (&on["terrain_occlusion"], &off["terrain_occlusion"]),
            (&Value::Bool(true), &Value::Bool(false))
        );
        assert!((on["horizon_deg"][7].as_f64().unwrap() - 20.0).abs() < 1e-9);
        assert!(off["horizon_deg"].as_array().unwrap().iter().all(|elevation| *elevation == 0.0));
        for row in 0..64 {
            let (masked, open) = (&on["radiance"][1][row][64], &off["radiance"][1][row][64]);
            if horizon.hides_sample(row, 64) {
                assert_eq!(masked, 0.0, "{row}");
            } else {
                assert_eq!(masked, open, "{row}");
            }
        }
        let lux = |answer: &Value| answer["sky"]["horizontal_total_illuminance_lx"].as_f64().unwrap();
        assert!(lux(&on) < 0.95 * lux(&off));
    }
    let (_, sky) = server.json(&format!("/api/v1/scenes/demo/sky?{PLACE}")).await;
    let (_, open) = server.json(&format!("/api/v1/scenes/demo/sky?{PLACE}&terrain=off")).await;
    assert!(sky["sky"]["brightest_elevation_deg"].as_f64().unwrap() > 20.0);
    assert!(open["sky"]["brightest_elevation_deg"].as_f64().unwrap() < 20.0);
    let (_, png) = body(&server, &format!("/api/v1/scenes/demo/panorama.png?{PLACE}")).await;
    let png = image::load_from_memory(&png).unwrap().into_rgb8();
    // 256 rows of pixels are 90°: 20° end 57 rows above the bottom.
    assert_eq!(png.get_pixel(300, 205).0, skyglow_display::ground::TERRAIN_RGB);
    assert_eq!(png.get_pixel(300, 199).0, skyglow_display::ground::SKYLINE_RGB);
    assert!(png.get_pixel(300, 190).0 != skyglow_display::ground::TERRAIN_RGB);
}
