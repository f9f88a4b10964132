//! Darker places near a place.

use super::{EndToEnd, number};
use skyglow_physics::{GeoPoint, geometry::LocalFrame};

fn place(value: &serde_json::Value) -> GeoPoint {
    GeoPoint::from_deg(number(&value["latitude_deg"]), number(&value["longitude_deg"])).unwrap()
}

/// Darker places are within reach, apart from each other, darker as they say, and have the skies that they have by themselves.
#[tokio::test]
async fn darker_places_are_darker_and_apart() {
    let server = EndToEnd::shared().await;
    let query = "lat=46.17&lon=8.79";
    let path = format!("/api/v1/scenes/demo/darker?{query}&within_km=40&limit=5");
    let answer = server.get(&path).await;
    assert_eq!(answer.status(), 200);
    let tag = answer.headers()["etag"].to_str().unwrap().to_owned();
    let answer: serde_json::Value = answer.json().await.unwrap();
    assert_eq!(server.get_unless(&path, &tag).await, 304);
    let here = server.sky(query).await;
    assert_eq!(answer["here"]["zenith_luminance_cd_m2"], here["sky"]["zenith_luminance_cd_m2"]);
    let places = answer["places"].as_array().unwrap();
    assert!((2..=5).contains(&places.len()), "{answer}");
    let frame = LocalFrame::at(place(&answer["here"]));
    for (rank, darker) in places.iter().enumerate() {
        assert_eq!(darker["rank"], rank + 1);
        let bearing = frame.bearing_to(place(darker).unit_vector());
        assert!(
            (number(&darker["distance_m"]) - bearing.distance_m).abs() < 1.0
                && bearing.distance_m <= 40_000.0
        );
        let sky =
            server.sky(&format!("lat={}&lon={}", darker["latitude_deg"], darker["longitude_deg"])).await;
        let artificial = number(&sky["sky"]["zenith_luminance_cd_m2"]);
        assert!((number(&darker["zenith_luminance_cd_m2"]) / artificial - 1.0).abs() < 1e-5);
        let ratio = artificial / number(&here["sky"]["zenith_luminance_cd_m2"]);
        assert!((number(&darker["artificial_ratio"]) / ratio - 1.0).abs() < 1e-5 && ratio < 0.95, "{darker}");
        assert!(number(&darker["gain_mag"]) > 0.0 && darker["nearest_place"]["name"].is_string());
        let low = &darker["low_sky"];
        assert!(number(&low["darkest_luminance_cd_m2"]) <= number(&low["brightest_luminance_cd_m2"]));
        for other in &places[..rank] {
            let apart = LocalFrame::at(place(darker)).bearing_to(place(other).unit_vector());
            assert!(apart.distance_m >= 3_999.0, "{darker} {other}");
        }
    }
    assert!(number(&answer["compared_count"]) > 1_000.0 && number(&answer["step_m"]) < 2_000.0, "{answer}");
}

/// Places outside the scene, and parameters that mean nothing here, are refused.
#[tokio::test]
async fn a_search_elsewhere_is_refused() {
    let server = EndToEnd::shared().await;
    let status =
        async |query: &str| server.get(&format!("/api/v1/scenes/demo/darker?{query}")).await.status();
    assert_eq!(status("lat=-46&lon=8.8").await, 404);
    assert_eq!(status("lat=46.17&lon=8.79&within_km=1000").await, 400);
    assert_eq!(status("lat=46.17&lon=8.79&height=5").await, 400);
}
