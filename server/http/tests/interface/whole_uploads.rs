//! Scenes that the operator puts and deletes over HTTP.

use crate::{server::header, whole::Whole};
use serde_json::{Value, json};

/// The operator's token, and a known client's key, of the servers that `whole.rs` starts.
pub(crate) const TOKEN: &str = "the-operators-token-of-a-test";
pub(crate) const KEY: &str = "a-citys-key";

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

async fn put(whole: &Whole, scene: &str, secret: Option<&str>, body: Vec<u8>) -> (u16, Value) {
    let mut request = whole.client.put(format!("{}/api/v1/scenes/{scene}", whole.base)).body(body);
    request = request.header("content-type", "multipart/form-data; boundary=edge");
    if let Some(secret) = secret {
        request = request.header("authorization", format!("Bearer {secret}"));
    }
    let answer = request.send().await.unwrap();
    (answer.status().as_u16(), answer.json().await.unwrap())
}

async fn delete(whole: &Whole, scene: &str, secret: &str) -> reqwest::Response {
    let request = whole.client.delete(format!("{}/api/v1/scenes/{scene}", whole.base));
    request.header("authorization", format!("Bearer {secret}")).send().await.unwrap()
}

pub(crate) async fn scenes_are_put_and_deleted_by_the_operator(whole: &Whole, place: &str) {
    let layer = async |name: &str| {
        let raster = whole.get(&format!("/api/v1/scenes/demo/layers/{name}.tif")).await;
        raster.bytes().await.unwrap().to_vec()
    };
    let (radiance, terrain) = (layer("radiance").await, layer("elevation").await);
    let whole_form = form(&[
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
        let (got, problem) = put(whole, "copy", secret, form(&[("title", None, b"small")])).await;
        assert_eq!((got, &problem["type"]), (status, &json!(format!("/problems/{kind}"))));
    }
    assert_eq!(whole.get("/api/v1/scenes/copy").await.status(), 404);

    let (status, scene) = put(whole, "copy", Some(TOKEN), whole_form.clone()).await;
    assert_eq!((status, &scene["title"]), (201, &json!("A copy")), "{scene}");
    let (_, demo) = whole.json("/api/v1/scenes/demo").await;
    assert_eq!((&scene["lit_pixels"], &scene["terrain"]), (&demo["lit_pixels"], &json!(true)));
    let zenith = async |scene: &str| {
        let (_, sky) = whole.json(&format!("/api/v1/scenes/{scene}/sky?{place}&terrain=off")).await;
        sky["sky"]["zenith_luminance_cd_m2"].as_f64().unwrap()
    };
    // Twice the light by its calibration; its terrain is coarser.
    let ratio = zenith("copy").await / zenith("demo").await;
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
        (form(&[("radiance", None, &radiance), ("radiance", None, &radiance)]), 400, "radiance"),
        (form(&[("title", None, b"no raster")]), 400, "radiance"),
        (form(&[("password", None, b"x")]), 400, "password"),
        (form(&[("title", None, &[b'a'; 5000])]), 400, "title"),
        (b"--edge\r\nnothing".to_vec(), 400, "body"),
    ] {
        let (got, problem) = put(whole, "copy", Some(TOKEN), fields).await;
        let detail = problem["detail"].as_str().unwrap();
        assert!(got == status && detail.contains(name), "{name}: {got} {detail}");
        let folder = whole.folder.path().to_str().unwrap();
        assert!(!detail.contains(folder), "folders are nobody's business: {detail}");
    }
    let (_, same) = whole.json("/api/v1/scenes/copy").await;
    assert_eq!(same["version"], scene["version"]);
    let (status, _) = put(whole, "Bad_Id", Some(TOKEN), form(&[("title", None, b"small")])).await;
    assert_eq!(status, 404);
    let (status, again) = put(whole, "copy", Some(TOKEN), form(&[("radiance", None, &radiance)])).await;
    assert_eq!((status, &again["terrain"]), (200, &json!(false)));
    assert_ne!(again["version"], scene["version"]);
    let left = std::fs::read_dir(whole.folder.path().join("scenes")).unwrap();
    let left: Vec<String> = left.map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
    assert!(left.iter().all(|name| name == "demo" || name == "copy"), "{left:?}");

    assert_eq!(delete(whole, "copy", KEY).await.status(), 403);
    assert_eq!(delete(whole, "copy", TOKEN).await.status(), 204);
    let gone = delete(whole, "copy", TOKEN).await;
    assert_eq!((gone.status().as_u16(), header(&gone, "content-type")), (404, "application/problem+json"));
    assert_eq!(whole.get(&format!("/api/v1/scenes/copy/sky?{place}")).await.status(), 404);
}

/// A known client has a rate and a quota of its own, and a key that nobody has is refused.
pub(crate) async fn keys_are_counted(whole: &Whole) {
    let ask = async |name: &str, value: &str| {
        let request = whole.client.get(format!("{}/api/v1/scenes", whole.base)).header(name, value);
        request.send().await.unwrap()
    };
    let unknown = ask("x-api-key", "nobodys").await;
    assert_eq!((unknown.status().as_u16(), header(&unknown, "www-authenticate")), (401, "Bearer"));
    // One was used by each refused upload and deletion above; some are left of 10.
    let mut statuses = Vec::new();
    for _ in 0..10 {
        statuses.push(ask("x-api-key", KEY).await.status().as_u16());
    }
    assert!(statuses[0] == 200 && statuses.contains(&429), "{statuses:?}");
    let used: Value = ask("x-api-key", KEY).await.json().await.unwrap();
    assert_eq!(used["type"], "/problems/quota-used");
    // Others are not touched by that.
    assert_eq!(whole.get("/api/v1/scenes").await.status(), 200);
}
