//! Two servers over one store of what is kept.

use super::{EndToEnd, TOKEN, access, folder, source_over};
use serde_json::{Value, json};
use skyglow_app::{ObservatorySource, SkySource};
use skyglow_http::{HttpConfig, KeptStore, router_with_access, serve};
use skyglow_scene::{ChangeLimits, ChangeStore};
use std::{path::Path, sync::Arc, time::Duration};
use tempfile::TempDir;

/// A server with a data folder of its own, in which the scenes are those of all.
struct Replica {
    base: String,
    client: reqwest::Client,
    source: Arc<ObservatorySource>,
    _data: TempDir,
}

impl Replica {
    async fn start(store: &Path) -> Self {
        let data = tempfile::tempdir().unwrap();
        std::os::unix::fs::symlink(folder().join("scenes"), data.path().join("scenes")).unwrap();
        let (path, address) = (data.path().to_owned(), format!("file://{}", store.display()));
        let open = move || {
            let store = Arc::new(KeptStore::open(&address, &[]).unwrap());
            source_over(&path, ChangeStore::in_store(&path, ChangeLimits::default(), store).unwrap())
        };
        let source = tokio::task::spawn_blocking(open).await.unwrap();
        let listener = tokio::net::TcpListener::bind("127.0.0.1:0").await.unwrap();
        let base = format!("http://{}", listener.local_addr().unwrap());
        let config = HttpConfig { request_timeout_s: 180.0, ..HttpConfig::default() };
        let app = router_with_access(source.clone(), config.clone(), access());
        tokio::spawn(async move { serve(listener, app, &config, std::future::pending()).await });
        let client = reqwest::Client::builder().no_proxy().build().unwrap();
        Self { base, client, source, _data: data }
    }

    async fn get(&self, path: &str) -> (u16, Value) {
        let answer = self.client.get(format!("{}/api/v1/{path}", self.base)).send().await.unwrap();
        (answer.status().as_u16(), answer.json().await.unwrap())
    }

    async fn post(&self, path: &str, body: &Value) -> (u16, Option<String>, Value) {
        let request = self.client.post(format!("{}/api/v1/scenes/demo/{path}", self.base));
        let answer = request.json(body).send().await.unwrap();
        let secret = answer.headers().get("skyglow-owner").map(|value| value.to_str().unwrap().to_owned());
        (answer.status().as_u16(), secret, answer.json().await.unwrap())
    }

    async fn delete(&self, path: &str, name: &'static str, value: &str) -> u16 {
        let request = self.client.delete(format!("{}/api/v1/{path}", self.base)).header(name, value);
        request.send().await.unwrap().status().as_u16()
    }

    async fn refresh(&self) {
        let source = self.source.clone();
        tokio::task::spawn_blocking(move || source.refresh_kept().unwrap()).await.unwrap();
    }
}

/// What one server keeps, the other reads, lists, builds on and removes; a store that is away is no "not found".
#[tokio::test]
async fn two_servers_share_what_is_kept() {
    // Makes the scenes.
    let town = EndToEnd::shared().await.town().await;
    let store = tempfile::tempdir().unwrap();
    let (a, b) = (Replica::start(store.path()).await, Replica::start(store.path()).await);
    let brush = json!({"points": [[town.longitude_deg, town.latitude_deg]], "radius_m": 3000});
    let paint = json!({"title": "shared", "edits": [{"brush": brush, "factor": 0.5}]});
    let (status, secret, painted) = a.post("scenarios", &paint).await;
    assert_eq!(status, 201, "{painted}");
    let scenario = format!("scenarios/{}", painted["id"].as_str().unwrap());
    assert_eq!(b.get(&scenario).await, a.get(&scenario).await);
    let sky = format!("scenes/demo/sky?{}&scenario={}", town.query, painted["id"].as_str().unwrap());
    assert_eq!(b.get(&sky).await, a.get(&sky).await);

    let site = json!({"lat": town.latitude_deg + 0.18, "lon": town.longitude_deg, "reduce_by": 0.2});
    let wish = json!({"method": "target", "sites": [site], "max_cut": 0.9});
    let (status, _, found) = b.post("plans?limit=3", &wish).await;
    assert_eq!(status, 201, "{found}");
    let plan = format!("plans/{}", found["id"].as_str().unwrap());
    assert_eq!(a.get(&format!("{plan}?limit=3")).await, (200, found.clone()));
    let (status, secret_again, again) = a.post("plans?limit=3", &wish).await;
    assert_eq!((status, secret_again, again), (201, None, found));

    tokio::time::sleep(Duration::from_millis(1100)).await;
    let (_, listed) = b.get("scenes/demo/scenarios").await;
    assert_eq!(listed[0]["id"], painted["id"]);
    assert_eq!(b.delete(&scenario, "skyglow-owner", &"0".repeat(32)).await, 403);
    assert_eq!(b.delete(&scenario, "skyglow-owner", &secret.unwrap()).await, 204);
    a.refresh().await;
    assert_eq!((a.get(&scenario).await.0, a.get(&sky).await.0), (404, 404));
    assert_eq!(a.delete(&plan, "authorization", &format!("Bearer {TOKEN}")).await, 204);
    b.refresh().await;
    assert_eq!(b.get(&plan).await.0, 404);

    // A folder that is not mounted any more.
    let elsewhere = store.path().with_extension("away");
    std::fs::rename(store.path(), &elsewhere).unwrap();
    let (status, problem) = a.get("scenarios/s-0123456789abcdef0123").await;
    assert_eq!((status, problem["type"].as_str()), (503, Some("/problems/store-away")));
    assert_eq!(a.post("scenarios", &paint).await.0, 503);
    std::fs::rename(&elsewhere, store.path()).unwrap();
    assert_eq!(a.get("scenarios/s-0123456789abcdef0123").await.0, 404);
    assert_eq!(a.post("scenarios", &paint).await.0, 201);
}
