use crate::{
    fake::Mood,
    server::{PLACE, SKY, Server, header},
};
use skyglow_http::HttpConfig;
use std::time::Duration;
use tokio::io::{AsyncReadExt, AsyncWriteExt};

/// More requests than the limit of concurrent ones are refused at once.
#[tokio::test]
async fn requests_over_the_limit_are_refused_at_once() {
    let server = Server::with(HttpConfig { concurrent_requests: 2, ..HttpConfig::default() }).await;
    *server.fake.mood.lock().unwrap() = Mood::Slow(Duration::from_millis(400));
    let ask = |turbidity: f64| {
        let request = server.get(&format!("{SKY}&turbidity={turbidity}"));
        async move { request.send().await.unwrap() }
    };
    let answers = tokio::join!(ask(2.0), ask(2.1), ask(2.2), ask(2.3));
    let statuses = [&answers.0, &answers.1, &answers.2, &answers.3].map(|answer| answer.status().as_u16());
    assert_eq!(statuses.iter().filter(|&&status| status == 200).count(), 2, "{statuses:?}");
    assert_eq!(statuses.iter().filter(|&&status| status == 503).count(), 2, "{statuses:?}");
    // Health and metrics answer however busy the server is.
    let busy = server.get(SKY).send();
    let (_, health) = tokio::join!(busy, server.answer("/healthz"));
    assert_eq!(health.status(), 200);
    let metrics = server.answer("/metrics").await.text().await.unwrap();
    assert!(metrics.contains("skyglow_http_refused_total{reason=\"busy\"} 2"), "{metrics}");
}

#[tokio::test]
async fn an_answer_that_takes_too_long_is_given_up() {
    let server = Server::with(HttpConfig { request_timeout_s: 0.1, ..HttpConfig::default() }).await;
    *server.fake.mood.lock().unwrap() = Mood::Slow(Duration::from_secs(20));
    let answer = server.answer(SKY).await;
    assert_eq!(answer.status(), 503);
    assert!(!header(&answer, "retry-after").is_empty());
    let json: serde_json::Value = answer.json().await.unwrap();
    assert_eq!(json["type"], "/problems/timeout");
}

/// A client that sends too much gets 429 with Retry-After.
#[tokio::test]
async fn the_rate_limit_is_429_with_retry_after() {
    let config = HttpConfig { requests_per_second: 1.0, request_burst: 3, ..HttpConfig::default() };
    let server = Server::with(config).await;
    let mut statuses = Vec::new();
    for _ in 0..5 {
        statuses.push(server.answer("/api/v1/scenes").await.status().as_u16());
    }
    assert_eq!(statuses, [200, 200, 200, 429, 429]);
    let refused = server.answer("/api/v1/scenes").await;
    assert_eq!(header(&refused, "retry-after"), "1");
    assert_eq!(header(&refused, "access-control-allow-origin"), "*");
    assert_eq!(server.answer("/healthz").await.status(), 200);
}

/// What a client stores in a day has a limit of its own.
#[tokio::test]
async fn storage_per_day_has_a_limit_of_its_own() {
    let server = Server::with(HttpConfig { kept_per_day: 10, ..HttpConfig::default() }).await;
    *server.fake.kept.lock().unwrap() = Some(Vec::new());
    let post = async |path: &str, body: String| {
        let answer = server.client.post(format!("{}{path}", server.base)).body(body).send().await.unwrap();
        (answer.status().as_u16(), header(&answer, "retry-after").to_owned())
    };
    let scenarios = "/api/v1/scenes/demo/scenarios";
    let paint = |title: &str| {
        format!(
            "{{\"title\": \"{title}\", \"edits\": [{{\"brush\": {{\"points\": [[36.8, -1.2]], \"radius_m\": 900}}, \"factor\": 0.5}}]}}"
        )
    };
    // Half of the day's share at once; what is refused does not count.
    for _ in 0..20 {
        assert_eq!(post(scenarios, "{}".to_owned()).await.0, 400);
    }
    for number in 0..5 {
        assert_eq!(post(scenarios, paint(&number.to_string())).await.0, 201);
    }
    let (status, wait_s) = post(scenarios, paint("one more")).await;
    assert_eq!(status, 429);
    assert!((17_000..=17_280).contains(&wait_s.parse::<u32>().unwrap()), "{wait_s}");
    assert_eq!(post("/api/v1/scenes/demo/plans", "{}".to_owned()).await.0, 429);
    assert_ne!(post("/api/v1/scenes/demo/plans?keep=off", "{}".to_owned()).await.0, 429);
    // What keeps nothing goes on.
    assert_ne!(post("/api/v1/scenes/demo/influence?lat=46.2&lon=8.8", "{}".to_owned()).await.0, 429);
    assert_eq!(server.answer("/api/v1/scenes").await.status(), 200);
    let metrics = server.answer("/metrics").await.text().await.unwrap();
    assert!(metrics.contains("skyglow_http_refused_total{reason=\"keeping\"} 2"), "{metrics}");
}

/// A long scenario counts by its length, and pages of other sites store nothing.
#[tokio::test]
async fn a_long_scenario_counts_by_its_length() {
    let server = Server::with(HttpConfig { kept_per_day: 10, ..HttpConfig::default() }).await;
    *server.fake.kept.lock().unwrap() = Some(Vec::new());
    let post =
        |body: String| server.client.post(format!("{}/api/v1/scenes/demo/scenarios", server.base)).body(body);
    let paint = |factor: f64, spaces: usize| {
        let brush = "{\"points\": [[36.8, -1.2]], \"radius_m\": 900}";
        format!("{{\"edits\": [{{\"brush\": {brush}, \"factor\": {factor}}}]{}}}", " ".repeat(spaces))
    };
    let foreign = post(paint(0.5, 0)).header("origin", "https://evil.example").send().await.unwrap();
    assert_eq!(foreign.status(), 403);
    assert_eq!(foreign.json::<serde_json::Value>().await.unwrap()["type"], "/problems/foreign-origin");
    let own = post(paint(0.5, 0)).header("origin", server.base.clone()).send().await.unwrap();
    assert_eq!(own.status(), 201);
    // The same again is kept already, and counts as nothing however it is written.
    for _ in 0..20 {
        assert_eq!(post(paint(0.5, 50_000)).send().await.unwrap().status(), 201);
    }
    // 16 kB thrice, and a bit: four of the four that are left.
    assert_eq!(post(paint(0.25, 50_000)).send().await.unwrap().status(), 201);
    let refused = post(paint(0.75, 0)).send().await.unwrap();
    assert_eq!(refused.status(), 429);
    assert_eq!(refused.json::<serde_json::Value>().await.unwrap()["type"], "/problems/kept-enough");
}

/// What comes on a connection until its end, which must come in time.
async fn rest_of(stream: &mut tokio::net::TcpStream) -> Vec<u8> {
    let mut rest = Vec::new();
    let read = tokio::io::AsyncReadExt::read_to_end(stream, &mut rest);
    // An end is an end, whichever way it comes.
    let _ended = tokio::time::timeout(Duration::from_secs(10), read).await.unwrap();
    rest
}

/// Clients that send nothing, or half a request, lose their connections.
#[tokio::test]
async fn silent_clients_lose_their_connections() {
    let server = Server::with(HttpConfig { idle_timeout_s: 0.3, ..HttpConfig::default() }).await;
    let address = server.base.trim_start_matches("http://").to_owned();
    for said in ["", "GET /healthz HTTP/1.1\r\nhost: x\r\nx-half: "] {
        let mut stream = tokio::net::TcpStream::connect(&address).await.unwrap();
        stream.write_all(said.as_bytes()).await.unwrap();
        assert!(!rest_of(&mut stream).await.starts_with(b"HTTP/1.1 200"), "{said:?}");
    }
    assert_eq!(server.answer("/api/v1/scenes").await.status(), 200);
}

/// A body that comes byte by byte takes nobody's place.
#[tokio::test]
async fn a_slow_body_takes_no_permit() {
    let server = Server::with(HttpConfig { concurrent_requests: 1, ..HttpConfig::default() }).await;
    let address = server.base.trim_start_matches("http://").to_owned();
    let mut slow = Vec::new();
    for _ in 0..5 {
        let mut stream = tokio::net::TcpStream::connect(&address).await.unwrap();
        let head = "POST /api/v1/scenes/demo/influence?lat=46.2&lon=8.8 HTTP/1.1\r\nhost: x\r\ncontent-length: 1000\r\n\r\n{";
        stream.write_all(head.as_bytes()).await.unwrap();
        slow.push(stream);
    }
    tokio::time::sleep(Duration::from_millis(300)).await;
    assert_eq!(server.answer("/api/v1/scenes").await.status(), 200);
    drop(slow);
}

/// One address holds no more than a fourth of all connections.
#[tokio::test]
async fn one_address_holds_a_fourth_of_connections() {
    let server = Server::with(HttpConfig { connections: 8, ..HttpConfig::default() }).await;
    let address = server.base.trim_start_matches("http://").to_owned();
    let ask = "GET /healthz HTTP/1.1\r\nhost: x\r\n\r\n";
    let mut held = Vec::new();
    for _ in 0..2 {
        let mut stream = tokio::net::TcpStream::connect(&address).await.unwrap();
        stream.write_all(ask.as_bytes()).await.unwrap();
        let mut first = [0; 12];
        tokio::io::AsyncReadExt::read_exact(&mut stream, &mut first).await.unwrap();
        assert_eq!(&first, b"HTTP/1.1 200");
        held.push(stream);
    }
    let mut third = tokio::net::TcpStream::connect(&address).await.unwrap();
    let _closed_maybe = third.write_all(ask.as_bytes()).await;
    assert!(rest_of(&mut third).await.is_empty());
    drop(held);
    // What is let go is had again.
    let mut tries = 0;
    while server.get("/healthz").send().await.is_err() {
        tries += 1;
        assert!(tries < 100);
        tokio::time::sleep(Duration::from_millis(50)).await;
    }
}

#[tokio::test]
async fn a_body_that_is_too_long_is_413() {
    let server = Server::with(HttpConfig { body_limit_bytes: 1000, ..HttpConfig::default() }).await;
    let answer = server.get(SKY).body(vec![0u8; 5000]).send().await.unwrap();
    assert_eq!(answer.status(), 413);
    let json: serde_json::Value = answer.json().await.unwrap();
    assert_eq!(json["type"], "/problems/body-too-long");
}

/// What the HTTP library refuses by itself is a problem document too.
#[tokio::test]
async fn refusals_of_the_http_library_are_problems() {
    let server = Server::start().await;
    let address = server.base.trim_start_matches("http://").to_owned();
    let many_headers: String = (0..200).map(|i| format!("x-{i}: {i}\r\n")).collect();
    for (request, status, word) in [
        (format!("GET /{} HTTP/1.1\r\nhost: x\r\n\r\n", "a".repeat(70_000)), 414, "address"),
        (format!("GET /healthz HTTP/1.1\r\nhost: x\r\n{many_headers}\r\n"), 431, "headers"),
        ("nonsense\r\n\r\n".to_owned(), 400, "cannot be read"),
    ] {
        let mut stream = tokio::net::TcpStream::connect(&address).await.unwrap();
        stream.write_all(request.as_bytes()).await.unwrap();
        let mut answer = Vec::new();
        stream.read_to_end(&mut answer).await.unwrap();
        let answer = String::from_utf8(answer).unwrap();
        let (head, body) = answer.split_once("\r\n\r\n").unwrap();
        assert!(head.starts_with(&format!("HTTP/1.1 {status} ")), "{answer}");
        assert!(head.contains("content-type: application/problem+json"), "{answer}");
        let problem: serde_json::Value = serde_json::from_str(body).unwrap();
        assert_eq!((&problem["status"], &problem["type"]), (&status.into(), &"/problems/unreadable".into()));
        assert!(problem["detail"].as_str().unwrap().contains(word), "{problem}");
    }
}

#[tokio::test]
async fn metrics_count_by_route_never_by_url() {
    let server = Server::start().await;
    server.answer(SKY).await;
    server.answer(&format!("/api/v1/scenes/nowhere/sky?{PLACE}")).await;
    server.answer("/some/random/url").await;
    server.answer("/api/v1/scenes/demo/tiles/radiance/1/0/0.png").await;
    let answer = server.answer("/metrics").await;
    assert!(header(&answer, "content-type").starts_with("application/openmetrics-text"));
    let text = answer.text().await.unwrap();
    for line in [
        "skyglow_http_requests_total{method=\"GET\",path=\"/api/v1/scenes/{scene}/sky\",status=\"200\"} 1",
        "skyglow_http_requests_total{method=\"GET\",path=\"/api/v1/scenes/{scene}/sky\",status=\"404\"} 1",
        "skyglow_http_requests_total{method=\"GET\",path=\"other\",status=\"404\"} 1",
        "skyglow_http_request_duration_seconds_count{path=\"/api/v1/scenes/{scene}/sky\"} 2",
        "skyglow_engine_queue_length 3",
        "skyglow_engine_device_losses_total 1",
        "skyglow_engine_pass_seconds_total{pass=\"coefficients\"} 0.0015",
        "skyglow_scenes_open 1",
    ] {
        assert!(text.contains(line), "{line}\n{text}");
    }
    assert!(!text.contains("random") && !text.contains("nowhere") && !text.contains("-1.28"));
    assert!(text.ends_with("# EOF\n"));
}

/// Every answer carries a request id, the client's own if that is plain.
#[tokio::test]
async fn every_answer_carries_a_request_id() {
    let server = Server::start().await;
    let own = server.get("/healthz").header("x-request-id", "abc-1.2_3").send().await.unwrap();
    assert_eq!(header(&own, "x-request-id"), "abc-1.2_3");
    let strange = server.get("/healthz").header("x-request-id", "a b;c").send().await.unwrap();
    assert_ne!(header(&strange, "x-request-id"), "a b;c");
    let (a, b) = (server.answer("/healthz").await, server.answer("/nothing").await);
    assert_ne!(header(&a, "x-request-id"), header(&b, "x-request-id"));
    assert_eq!(header(&b, "x-content-type-options"), "nosniff");
}

/// A half-sent request does not hold the server when it is told to end.
#[tokio::test]
async fn a_half_sent_request_does_not_delay_the_end() {
    let listener = tokio::net::TcpListener::bind("127.0.0.1:0").await.unwrap();
    let address = listener.local_addr().unwrap();
    let config = HttpConfig { drain_timeout_s: 0.3, ..HttpConfig::default() };
    let app = skyglow_http::router(std::sync::Arc::new(crate::fake::Fake::default()), config.clone());
    let (stop, stopped) = tokio::sync::oneshot::channel::<()>();
    let server = tokio::spawn(async move {
        skyglow_http::serve(listener, app, &config, async move { drop(stopped.await) }).await
    });
    let mut half = tokio::net::TcpStream::connect(address).await.unwrap();
    half.write_all(b"GET / HTTP/1.1\r\nhost: x\r\n").await.unwrap();
    let mut whole = tokio::net::TcpStream::connect(address).await.unwrap();
    whole.write_all(b"GET /healthz HTTP/1.1\r\nhost: x\r\nconnection: close\r\n\r\n").await.unwrap();
    let mut answer = String::new();
    whole.read_to_string(&mut answer).await.unwrap();
    assert!(answer.starts_with("HTTP/1.1 200"));
    stop.send(()).unwrap();
    let ended = tokio::time::timeout(Duration::from_secs(3), server).await;
    assert!(ended.expect("the server must end").unwrap().is_ok());
}
