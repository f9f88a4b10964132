//! A server on a free port of the loopback.

use crate::fake::Fake;
use reqwest::{Client, RequestBuilder, Response};
use serde_json::Value;
use skyglow_http::{HttpConfig, router, serve};
use std::sync::Arc;
use tokio::sync::oneshot;

/// A running server and a client for it.
pub(crate) struct Server {
    pub(crate) fake: Arc<Fake>,
    pub(crate) base: String,
    pub(crate) client: Client,
    _stop: oneshot::Sender<()>,
}

/// The sky of the tests.
pub(crate) const SKY: &str = "/api/v1/scenes/demo/sky?lat=-1.2864&lon=36.8172";
/// A place, to put behind a path.
pub(crate) const PLACE: &str = "lat=-1.2864&lon=36.8172";

impl Server {
    pub(crate) async fn start() -> Self {
        Self::with(HttpConfig::default()).await
    }

    pub(crate) async fn with(config: HttpConfig) -> Self {
        Self::over(Fake::default(), config).await
    }

    pub(crate) async fn over(fake: Fake, config: HttpConfig) -> Self {
        let fake = Arc::new(fake);
        let listener = tokio::net::TcpListener::bind("127.0.0.1:0").await.unwrap();
        let base = format!("http://{}", listener.local_addr().unwrap());
        let (stop, stopped) = oneshot::channel::<()>();
        let app = router(fake.clone(), config.clone());
        tokio::spawn(async move {
            serve(listener, app, &config, async move { drop(stopped.await) }).await.unwrap();
        });
        let client = Client::builder().no_proxy().build().unwrap();
        Self { fake, base, client, _stop: stop }
    }

    pub(crate) fn get(&self, path: &str) -> RequestBuilder {
        self.client.get(format!("{}{path}", self.base))
    }

    pub(crate) async fn answer(&self, path: &str) -> Response {
        self.get(path).send().await.unwrap()
    }

    pub(crate) async fn post(&self, path: &str, body: &'static str) -> Response {
        self.client.post(format!("{}{path}", self.base)).body(body).send().await.unwrap()
    }

    /// Status and JSON of an answer.
    pub(crate) async fn json(&self, path: &str) -> (u16, Value) {
        let answer = self.answer(path).await;
        (answer.status().as_u16(), answer.json().await.unwrap())
    }

    pub(crate) fn renders(&self) -> usize {
        self.fake.rendered.load(std::sync::atomic::Ordering::SeqCst)
    }
}

/// A header as text.
pub(crate) fn header<'a>(answer: &'a Response, name: &str) -> &'a str {
    answer.headers().get(name).map_or("", |value| value.to_str().unwrap())
}
