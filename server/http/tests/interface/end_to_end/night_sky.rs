//! The natural sky of a time.

use super::{EndToEnd, number};
use serde_json::Value;

/// A moonless night, and one with the full Moon up, over the demo scene.
const NEW_MOON: &str = "2026-08-12T23:00:00Z";
const FULL_MOON: &str = "2026-08-28T00:00:00Z";

fn names(sky: &Value) -> Vec<&str> {
    let components = sky["night_sky"]["components"].as_array().unwrap().iter();
    components.map(|component| component["component"].as_str().unwrap()).collect()
}

/// Without a time nothing is said of it; with one totals have its sky, artificial light stays what it was.
#[tokio::test]
async fn a_time_replaces_the_natural_sky() {
    let server = EndToEnd::shared().await;
    let town = server.town().await;
    let plain = server.sky(&town.query).await;
    assert!(plain.get("night_sky").is_none() && plain.get("time").is_none());
    let dark = server.sky(&format!("{}&time={NEW_MOON}", town.query)).await;
    let moonlit = server.sky(&format!("{}&time=2026-08-28T02:00:00%2B02:00", town.query)).await;
    assert_eq!((&dark["time"], &moonlit["time"]), (&NEW_MOON.into(), &FULL_MOON.into()));
    assert_eq!(names(&dark), ["planets", "stars", "starlight", "zodiacal_light", "airglow"]);
    assert_eq!(names(&moonlit)[0], "moon");
    let value = |sky: &Value, name: &str| number(&sky["sky"][name]);
    for name in ["zenith_luminance_cd_m2", "mean_luminance_cd_m2", "horizontal_illuminance_lx"] {
        assert_eq!(value(&dark, name), value(&plain, name), "{name}");
    }
    let natural =
        |sky: &Value| value(sky, "zenith_total_luminance_cd_m2") - value(sky, "zenith_luminance_cd_m2");
    let parts: f64 = dark["night_sky"]["components"]
        .as_array()
        .unwrap()
        .iter()
        .map(|component| number(&component["zenith_luminance_cd_m2"]))
        .sum();
    assert!((natural(&dark) / parts - 1.0).abs() < 1e-3, "{} {parts}", natural(&dark));
    assert!(natural(&moonlit) > natural(&dark) && natural(&plain) != natural(&dark));
    let ratio = value(&dark, "zenith_luminance_cd_m2") / value(&dark, "ratio_to_natural");
    assert!((ratio / natural(&dark) - 1.0).abs() < 1e-3);
    let stars = |sky: &Value| number(&sky["night_sky"]["stars"]["visible"]);
    assert!(stars(&dark) > stars(&moonlit));
    assert!((number(&moonlit["night_sky"]["moon"]["illuminated_fraction"]) - 1.0).abs() < 0.01);
    assert_eq!(dark["night_sky"]["limits"].as_array().unwrap().len(), 25);
    assert_eq!(dark["night_sky"]["sun"]["daylight"], "night");
}

/// Times and fluxes that mean nothing are refused by name.
#[tokio::test]
async fn what_is_no_time_is_refused() {
    let server = EndToEnd::shared().await;
    let town = server.town().await;
    for (query, parameter, status) in [
        ("time=2026-08-12", "time", 400),
        ("time=2026-08-12T23:00:00", "time", 400),
        ("time=now", "time", 400),
        ("time=2200-01-01T00:00:00Z", "time", 400),
        ("solar_flux=120", "solar_flux", 400),
        ("time=2026-08-12T23:00:00Z&solar_flux=5", "solar_flux", 400),
        ("time=2026-08-12T23:00:00Z&turbidity=5&scattering=single", "time", 422),
    ] {
        let (got, problem) = server.json(&format!("/api/v1/scenes/demo/sky?{}&{query}", town.query)).await;
        assert_eq!((got, &problem["errors"][0]["parameter"]), (status, &parameter.into()), "{query}");
    }
}

/// Pictures and rasters show the sky of the time, tags tell times apart, and the same time written otherwise is the same.
#[tokio::test]
async fn pictures_show_the_time() {
    let server = EndToEnd::shared().await;
    let town = server.town().await;
    let path =
        |format: &str, more: &str| format!("/api/v1/scenes/demo/panorama.{format}?{}{more}", town.query);
    let (_, plain) = server.json(&path("json", "&sky=total")).await;
    let (_, timed) = server.json(&path("json", &format!("&time={NEW_MOON}"))).await;
    let (_, artificial) = server.json(&path("json", &format!("&time={NEW_MOON}&sky=artificial"))).await;
    assert_eq!((&timed["light"], &artificial["light"]), (&"total".into(), &"artificial".into()));
    let zenith = |answer: &Value| number(&answer["values"][63][0]);
    let total = number(&timed["sky"]["zenith_total_luminance_cd_m2"]);
    assert!((zenith(&timed) / total - 1.0).abs() < 0.1, "{} {total}", zenith(&timed));
    assert!(zenith(&artificial) < zenith(&timed) && zenith(&plain) != zenith(&timed));
    let mut tags = std::collections::HashSet::new();
    for time in
        ["", "&time=2026-08-12T23:00:00Z", "&time=2026-08-13T01:00:00%2B02:00", "&time=2026-08-12T23:00:01Z"]
    {
        let answer = server.get(&path("png", &format!("&sky=total&width=64&height_px=16{time}"))).await;
        assert_eq!(answer.status(), 200);
        tags.insert(crate::server::header(&answer, "etag").to_owned());
    }
    assert_eq!(tags.len(), 3);
    let answer = server.get(&path("tif", &format!("&time={NEW_MOON}"))).await;
    assert_eq!(answer.status(), 200);
}

/// By day the Sun alone is looked for, and no star is seen.
#[tokio::test]
async fn a_time_by_day_is_brighter() {
    let server = EndToEnd::shared().await;
    let town = server.town().await;
    let noon = server.sky(&format!("{}&time=2026-08-12T11:30:00Z", town.query)).await;
    assert_eq!(names(&noon), ["sun"]);
    assert_eq!(noon["night_sky"]["stars"]["visible"], 0);
    assert!(number(&noon["sky"]["zenith_total_luminance_cd_m2"]) > 1.0);
    assert!(noon["night_sky"]["milky_way"].is_null());
}

/// A night and its month agree, and need no scene.
#[tokio::test]
async fn nights_are_dark_around_new_moon() {
    let server = EndToEnd::shared().await;
    let (status, night) = server.json("/api/v1/night?lat=46.17&lon=8.79&date=2026-08-12").await;
    assert_eq!((status, &night["date"]), (200, &"2026-08-12".into()));
    let (status, month) = server.json("/api/v1/nights?lat=46.17&lon=8.79&month=2026-08").await;
    assert_eq!((status, &month["nights"][11]["dark_hours"]), (200, &night["dark_hours"]));
    assert!(number(&night["dark_hours"]) > 4.0 && number(&month["nights"][27]["dark_hours"]) < 1.0);
    let (status, problem) = server.json("/api/v1/night?lat=46.17&lon=8.79&date=today").await;
    assert_eq!((status, &problem["errors"][0]["parameter"]), (400, &"date".into()));
}

/// Hours of a night have the numbers that the sky has at that time; the best one is in the dark, and the Moon brightens its own.
#[tokio::test]
async fn hours_of_a_night_are_skies_of_its_times() {
    let server = EndToEnd::shared().await;
    let town = server.town().await;
    let path = |date: &str| format!("/api/v1/scenes/demo/night?{}&date={date}", town.query);
    let (status, night) = server.json(&path("2026-08-12")).await;
    assert_eq!(
        (status, &night["night"]["date"], &night["clouds"]),
        (200, &"2026-08-12".into(), &"none".into())
    );
    let hours = night["hours"].as_array().unwrap();
    assert!((24..=25).contains(&hours.len()));
    let hour = hours.iter().find(|hour| hour["time"] == NEW_MOON).unwrap();
    let sky = server.sky(&format!("{}&time={NEW_MOON}", town.query)).await;
    for name in ["zenith_total_luminance_cd_m2", "sqm_total_brightness_mag_arcsec2", "naked_eye_limit_mag"] {
        assert_eq!(hour[name], sky["sky"][name], "{name}");
    }
    assert_eq!(hour["sun_altitude_deg"], sky["night_sky"]["sun"]["true_altitude_deg"]);
    let luminance = |hour: &Value| number(&hour["zenith_total_luminance_cd_m2"]);
    let best = hours.iter().find(|hour| hour["time"] == night["best_hour"]).unwrap();
    assert!(best["daylight"] == "night" && hours.iter().all(|hour| luminance(hour) >= luminance(best)));
    assert!(number(&hour["horizon_total_luminance_cd_m2"]) > luminance(hour));
    let (_, moonlit) = server.json(&path("2026-08-27")).await;
    let best_by_moon =
        &moonlit["hours"].as_array().unwrap().iter().map(luminance).fold(f64::INFINITY, f64::min);
    assert!(*best_by_moon > luminance(best));
    for (query, parameter) in [
        ("date=today", "date"),
        ("date=2026-08-12&clouds=1500", "clouds"),
        ("date=2026-08-12&solar_flux=5", "solar_flux"),
    ] {
        let (got, problem) = server.json(&format!("/api/v1/scenes/demo/night?{}&{query}", town.query)).await;
        assert_eq!((got, &problem["errors"][0]["parameter"]), (400, &parameter.into()), "{query}");
    }
}
