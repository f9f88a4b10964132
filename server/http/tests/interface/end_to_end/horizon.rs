//! Horizons for planetarium and imaging programs.

use super::{EndToEnd, number};
use crate::server::header;
use std::io::Read;

const PLACE: &str = "lat=46.53&lon=8.61";

/// Azimuths and altitudes as N.I.N.A. reads them: comments left out, two numbers with a blank between.
fn points(text: &str) -> Vec<(f64, f64)> {
    let lines = text.lines().filter(|line| !line.starts_with('#'));
    let point = |line: &str| {
        let (azimuth, altitude) = line.split_once(' ').unwrap();
        (azimuth.parse().unwrap(), altitude.parse().unwrap())
    };
    lines.map(point).collect()
}

/// Both formats have the panorama's horizon; N.I.N.A.'s goes on to 360 degrees.
#[tokio::test]
async fn horizons_are_those_of_the_panorama() {
    let server = EndToEnd::shared().await;
    let path = format!("/api/v1/scenes/demo/horizon.txt?{PLACE}");
    let answer = server.get(&path).await;
    assert_eq!(
        (answer.status().as_u16(), header(&answer, "content-type")),
        (200, "text/plain; charset=utf-8")
    );
    let stellarium = answer.text().await.unwrap();
    assert!(stellarium.starts_with("# Horizon at latitude 46.53000, longitude 8.61000"), "{stellarium}");
    let nina = server.get(&format!("{path}&format=nina")).await.text().await.unwrap();
    let (stellarium, nina) = (points(&stellarium), points(&nina));
    assert_eq!((stellarium.len(), nina.len()), (256, 257));
    assert_eq!(nina[..256], stellarium);
    assert_eq!(nina[256], (360.0, nina[0].1));
    let (_, panorama) = server.json(&format!("/api/v1/scenes/demo/panorama.json?{PLACE}")).await;
    let horizon = panorama["horizon_deg"].as_array().unwrap();
    for ((azimuth_deg, altitude_deg), (column, of_panorama)) in
        stellarium.iter().zip(horizon.iter().enumerate())
    {
        assert!((azimuth_deg - 360.0 / 256.0 * column as f64).abs() < 1e-4);
        assert!((altitude_deg - number(of_panorama)).abs() < 1e-3);
    }
    assert!(stellarium.iter().any(|(_, altitude_deg)| *altitude_deg > 5.0));
}

/// The archive has what Stellarium looks for: the horizon, the place, artificial light at the zenith and extinction.
#[tokio::test]
async fn a_landscape_has_its_horizon_and_light() {
    let server = EndToEnd::shared().await;
    let answer = server.get(&format!("/api/v1/scenes/demo/landscape.zip?{PLACE}")).await;
    assert_eq!((answer.status().as_u16(), header(&answer, "content-type")), (200, "application/zip"));
    let bytes = answer.bytes().await.unwrap();
    let mut archive = zip::ZipArchive::new(std::io::Cursor::new(bytes)).unwrap();
    let names: Vec<String> = archive.file_names().map(|name| name.unwrap().into_owned()).collect();
    assert_eq!(names, ["skyglow_46.5300_8.6100/landscape.ini", "skyglow_46.5300_8.6100/horizon.txt"]);
    let mut text = |name: &str| {
        let mut text = String::new();
        archive.by_name(name).unwrap().read_to_string(&mut text).unwrap();
        text
    };
    let ini = text(&names[0]);
    let horizon = text(&names[1]);
    let served = server.get(&format!("/api/v1/scenes/demo/horizon.txt?{PLACE}")).await.text().await.unwrap();
    assert_eq!(horizon, served);
    let value = |key: &str| {
        let line = ini.lines().find_map(|line| line.strip_prefix(&format!("{key} = ")));
        line.unwrap_or_else(|| panic!("no {key} in {ini}")).to_owned()
    };
    assert_eq!(
        (value("type").as_str(), value("polygonal_horizon_list").as_str()),
        ("polygonal", "horizon.txt")
    );
    assert_eq!((value("latitude"), value("longitude")), ("+46d31'48.0\"".into(), "+8d36'36.0\"".into()));
    let sky = server.sky(PLACE).await;
    let light: f64 = value("light_pollution_luminance").parse().unwrap();
    assert!((light / number(&sky["sky"]["zenith_luminance_cd_m2"]) - 1.0).abs() < 1e-3);
    let extinction: f64 = value("atmospheric_extinction_coefficient").parse().unwrap();
    let depths = [1, 2].map(|node| 1.0857 * number(&sky["local_optical_depth"][node]));
    assert!((depths[0]..depths[1]).contains(&extinction), "{extinction} {depths:?}");
}
