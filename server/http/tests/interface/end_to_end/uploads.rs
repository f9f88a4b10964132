//! Scenes that the operator puts and deletes over HTTP.

use super::{COUNTED_KEY, COUNTED_REQUESTS, EndToEnd, KEY, TOKEN, folder, zenith};
use crate::server::header;
use serde_json::{Value, json};

/// A form of fields: name, file name, content.
fn form(fields: &[(&str, Option<&str>, &[u8])]) -> Vec<u8> {
    let mut body = Vec::new();
    for (name, file, content) in fields {
        let file = file.map_or_else(String::new, |file| format!("; filename=\"{file}\""));
        let head = format!("--edge\r\ncontent-disposition: form-data; name=\"{name}\"{file}\r\n\r\n");
        body.extend(head.as_bytes());
        body.extend(*content);
        body.extend(b"\r\n");
    }
    body.extend(b"--edge--\r\n");
    body
}

async fn put(server: &EndToEnd, scene: &str, secret: Option<&str>, body: Vec<u8>) -> (u16, Value) {
    let mut request = server.client.put(format!("{}/api/v1/scenes/{scene}", server.base)).body(body);
    request = request.header("content-type", "multipart/form-data; boundary=edge");
    if let Some(secret) = secret {
        request = request.header("authorization", format!("Bearer {secret}"));
    }
    let answer = request.send().await.unwrap();
    (answer.status().as_u16(), answer.json().await.unwrap())
}

async fn delete(server: &EndToEnd, scene: &str, secret: &str) -> reqwest::Response {
    let request = server.client.delete(format!("{}/api/v1/scenes/{scene}", server.base));
    request.header("authorization", format!("Bearer {secret}")).send().await.unwrap()
}

#[tokio::test]
async fn the_operator_puts_and_deletes_scenes() {
    let server = &EndToEnd::shared().await;
    let place = server.town().await.query;
    let layer = async |name: &str| {
        let raster = server.get(&format!("/api/v1/scenes/demo/layers/{name}.tif")).await;
        raster.bytes().await.unwrap().to_vec()
    };
    let (radiance, terrain) = (layer("radiance").await, layer("elevation").await);
    let complete_form = form(&[
        ("title", None, b"A copy"),
        ("calibration", None, b"2"),
        ("radiance", Some("light.tif"), &radiance),
        ("terrain", Some("../../ground.tif"), &terrain),
    ]);
    // Nobody else may.
    for (secret, status, kind) in [
        (None, 401, "unauthorized"),
        (Some("the-operators-token-of-a-tesT"), 401, "unauthorized"),
        (Some(KEY), 403, "operator-only"),
    ] {
        let (got, problem) = put(server, "copy", secret, form(&[("title", None, b"small")])).await;
        assert_eq!((got, &problem["type"]), (status, &json!(format!("/problems/{kind}"))));
    }
    let (status, problem) = put(server, "BadId", Some(TOKEN), form(&[("title", None, b"small")])).await;
    assert_eq!((status, &problem["errors"][0]["parameter"]), (400, &json!("scene")));
    assert!(problem["errors"][0]["allowed"].as_str().unwrap().contains("a-z, 0-9 and -"), "{problem}");
    assert_eq!(server.get("/api/v1/scenes/copy").await.status(), 404);

    let (status, scene) = put(server, "copy", Some(TOKEN), complete_form.clone()).await;
    assert_eq!((status, &scene["title"]), (201, &json!("A copy")), "{scene}");
    let (_, demo) = server.json("/api/v1/scenes/demo").await;
    assert_eq!((&scene["lit_pixels"], &scene["terrain"]), (&demo["lit_pixels"], &json!(true)));
    let zenith_in = async |scene: &str| {
        zenith(&server.json(&format!("/api/v1/scenes/{scene}/sky?{place}&terrain=off")).await.1)
    };
    // Twice the light by its calibration; its terrain is coarser.
    let ratio = zenith_in("copy").await / zenith_in("demo").await;
    assert!((ratio / 2.0 - 1.0).abs() < 0.05, "{ratio}");

    // What cannot be meant is refused, and the scene that is there stays.
    for (fields, status, name) in [
        (form(&[("radiance", Some("light.tif"), b"no raster")]), 422, "radiance"),
        (form(&[("radiance", Some("light.tif"), &radiance[..radiance.len() / 2])]), 422, "radiance"),
        (form(&[("radiance", None, &radiance), ("terrain", Some("a.tif"), b"no raster")]), 422, "terrain"),
        (form(&[("radiance", None, &radiance), ("date", None, b"yesterday")]), 422, "date"),
        (form(&[("radiance", None, &radiance), ("places", None, b"{")]), 422, "places"),
        (form(&[("radiance", None, &radiance), ("scale", None, b"many")]), 400, "scale"),
        (form(&[("radiance", None, &radiance), ("units", None, b"lux")]), 400, "units"),
        (form(&[("places", None, b"name"), ("places", None, b"name")]), 400, "places"),
        (form(&[("title", None, b"no raster")]), 400, "radiance"),
        (form(&[("password", None, b"x")]), 400, "password"),
        (form(&[("title", None, &[b'a'; 5000])]), 400, "title"),
        (b"--edge\r\nnothing".to_vec(), 400, "body"),
    ] {
        let (got, problem) = put(server, "copy", Some(TOKEN), fields).await;
        let detail = problem["detail"].as_str().unwrap();
        assert!(got == status && detail.contains(name), "{name}: {got} {detail}");
        let folder = folder().to_str().unwrap();
        assert!(!detail.contains(folder), "folders are nobody's business: {detail}");
    }
    let (_, same) = server.json("/api/v1/scenes/copy").await;
    assert_eq!(same["version"], scene["version"]);
    let (status, _) = put(server, "Bad_Id", Some(TOKEN), form(&[("title", None, b"small")])).await;
    assert_eq!(status, 400);
    let (status, again) = put(server, "copy", Some(TOKEN), form(&[("radiance", None, &radiance)])).await;
    assert_eq!((status, &again["terrain"]), (200, &json!(false)));
    assert_ne!(again["version"], scene["version"]);
    let left = std::fs::read_dir(folder().join("scenes")).unwrap();
    let left: Vec<String> = left.map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
    assert!(left.iter().all(|name| name == "demo" || name == "copy"), "{left:?}");

    assert_eq!(delete(server, "copy", KEY).await.status(), 403);
    assert_eq!(delete(server, "copy", TOKEN).await.status(), 204);
    let gone = delete(server, "copy", TOKEN).await;
    assert_eq!((gone.status().as_u16(), header(&gone, "content-type")), (404, "application/problem+json"));
    assert_eq!(server.get(&format!("/api/v1/scenes/copy/sky?{place}")).await.status(), 404);
}

/// A known client has a rate and a quota of its own, and a key that nobody has is refused.
#[tokio::test]
async fn keys_are_counted() {
    let server = EndToEnd::shared().await;
    let ask = async |name: &str, value: &str| {
        let request = server.client.get(format!("{}/api/v1/scenes", server.base)).header(name, value);
        request.send().await.unwrap()
    };
    let unknown = ask("x-api-key", "nobodys").await;
    assert_eq!((unknown.status().as_u16(), header(&unknown, "www-authenticate")), (401, "Bearer"));
    for _ in 0..COUNTED_REQUESTS {
        assert_eq!(ask("x-api-key", COUNTED_KEY).await.status(), 200);
    }
    let used = ask("x-api-key", COUNTED_KEY).await;
    assert_eq!(used.status(), 429);
    assert_eq!(used.json::<Value>().await.unwrap()["type"], "/problems/quota-used");
    // Others are not touched by that.
    assert_eq!(server.get("/api/v1/scenes").await.status(), 200);
}
