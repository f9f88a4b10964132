//! What many clients together may take of memory.

use crate::{
    fake::Mood,
    server::{PLACE, SKY, Server, header},
};
use serde_json::Value;
use skyglow_http::HttpConfig;
use std::{net::SocketAddr, sync::atomic::Ordering, time::Duration};
use tokio::{
    io::{AsyncReadExt, AsyncWriteExt},
    net::{TcpSocket, TcpStream},
};

fn address(server: &Server) -> SocketAddr {
    server.base.trim_start_matches("http://").parse().unwrap()
}

/// A connection from an address of its own.
async fn connect_from(server: &Server, last: u8) -> TcpStream {
    let socket = TcpSocket::new_v4().unwrap();
    socket.bind(SocketAddr::from(([127, 0, 1, last], 0))).unwrap();
    socket.connect(address(server)).await.unwrap()
}

/// The value of a metric.
async fn metric(server: &Server, name: &str) -> u64 {
    let text = server.answer("/metrics").await.text().await.unwrap();
    let line = text.lines().find_map(|line| line.strip_prefix(name)?.strip_prefix(' ')).unwrap();
    line.parse().unwrap()
}

/// All that a connection answers until its end.
async fn said(server: &Server, request: &str) -> String {
    let mut stream = TcpStream::connect(address(server)).await.unwrap();
    stream.write_all(request.as_bytes()).await.unwrap();
    let mut answer = String::new();
    let read = stream.read_to_string(&mut answer);
    tokio::time::timeout(Duration::from_secs(10), read).await.unwrap().unwrap();
    answer
}

/// Hundreds of bodies that want a last byte hold no more than their budget, and who asks for something else has it.
#[tokio::test]
async fn slow_bodies_hold_no_more_than_their_budget() {
    const BODY_BYTES: usize = 64 * 1024;
    const BUDGET_BYTES: u64 = 1 << 20;
    let server = Server::with(HttpConfig {
        body_limit_bytes: BODY_BYTES,
        memory_budget_bytes: 16 * BUDGET_BYTES,
        ..HttpConfig::default()
    })
    .await;
    let mut slow = Vec::new();
    for number in 0..500u16 {
        let mut stream = connect_from(&server, 1 + (number % 50) as u8).await;
        let head = format!(
            "POST /api/v1/scenes/demo/influence?lat=46.2&lon=8.8 HTTP/1.1\r\nhost: x\r\ncontent-length: {BODY_BYTES}\r\n\r\n"
        );
        stream.write_all(head.as_bytes()).await.unwrap();
        // Who is refused is cut off.
        let _sent = stream.write_all(&vec![b' '; BODY_BYTES - 1]).await;
        slow.push(stream);
    }
    let mut most = 0;
    for _ in 0..10 {
        most = most.max(metric(&server, "skyglow_http_body_bytes").await);
        tokio::time::sleep(Duration::from_millis(50)).await;
    }
    assert!((BUDGET_BYTES / 2..=BUDGET_BYTES).contains(&most), "{most}");
    assert_eq!(server.answer("/api/v1/scenes").await.status(), 200);
    drop(slow);
    let mut tries = 0;
    while metric(&server, "skyglow_http_body_bytes").await > 0 {
        tries += 1;
        assert!(tries < 100, "what was held is given back");
        tokio::time::sleep(Duration::from_millis(50)).await;
    }
}

/// Where no body is read none is waited for, and the connection ends.
#[tokio::test]
async fn stray_bodies_are_refused_unread() {
    let server = Server::start().await;
    for (method, path, length, status) in [
        ("GET", "/api/v1/scenes", "content-length: 5", 400),
        ("GET", "/", "content-length: 5", 400),
        ("HEAD", "/api/v1/scenes", "transfer-encoding: chunked", 400),
        ("DELETE", "/api/v1/scenes/demo", "content-length: 5", 400),
        ("GET", "/api/v1/scenes", "content-length: 99999999", 413),
    ] {
        let answer = said(&server, &format!("{method} {path} HTTP/1.1\r\nhost: x\r\n{length}\r\n\r\n")).await;
        assert!(answer.starts_with(&format!("HTTP/1.1 {status} ")), "{method} {path}: {answer}");
    }
    let fine =
        said(&server, "GET /healthz HTTP/1.1\r\nhost: x\r\ncontent-length: 0\r\nconnection: close\r\n\r\n");
    assert!(fine.await.starts_with("HTTP/1.1 200 "));
}

#[tokio::test]
async fn requests_need_one_host() {
    let server = Server::start().await;
    for (head, status) in [
        ("HTTP/1.1", 400),
        ("HTTP/1.1\r\nhost: a\r\nhost: a", 400),
        ("HTTP/1.1\r\nhost: a", 200),
        ("HTTP/1.0", 200),
    ] {
        let answer = said(&server, &format!("GET /healthz {head}\r\nconnection: close\r\n\r\n")).await;
        assert!(
            answer.starts_with(&format!("HTTP/1.1 {status} ")) || answer.starts_with("HTTP/1.0 200 "),
            "{head}: {answer}"
        );
    }
}

/// A client that goes on reading is not taken for a stalled one, however slow it is: at this rate the system would take nothing
/// more of the server for longer than that, were it given all that it holds. A cut is seen after what it holds alone.
#[tokio::test]
async fn a_slow_reader_keeps_its_connection() {
    let server = Server::with(HttpConfig { idle_timeout_s: 2.0, ..HttpConfig::default() }).await;
    let socket = TcpSocket::new_v4().unwrap();
    socket.set_recv_buffer_size(16 * 1024).unwrap();
    let mut stream = socket.connect(address(&server)).await.unwrap();
    let path = "/api/v1/scenes/demo/panorama.tif?lat=-1.2864&lon=36.8172&width=4096&height_px=2048";
    stream.write_all(format!("GET {path} HTTP/1.1\r\nhost: x\r\n\r\n").as_bytes()).await.unwrap();
    let (mut some, mut got, mut length) = (vec![0; 32 * 1024], 0, None);
    while got < length.unwrap_or(usize::MAX).min(4_500_000) {
        let count = stream.read(&mut some).await.expect("it goes on");
        assert!(count > 0, "cut after {got} of {length:?} bytes");
        let head = String::from_utf8_lossy(&some[..count]);
        let said = head.lines().find_map(|line| line.strip_prefix("content-length: "));
        length = length.or_else(|| said?.parse().ok());
        got += count;
        tokio::time::sleep(Duration::from_secs_f64(count as f64 / 300_000.0)).await;
    }
    assert!(length.is_some());
}

const INFLUENCE: &str = "/api/v1/scenes/demo/influence.json";

/// Asks on a connection of an address of its own, and leaves it open.
async fn ask_from(server: &Server, last: u8, request: &str) -> TcpStream {
    let mut stream = connect_from(server, last).await;
    stream
        .write_all(format!("{request} HTTP/1.1\r\nhost: x\r\nconnection: close\r\n\r\n").as_bytes())
        .await
        .unwrap();
    stream
}

/// Waits until something is so.
async fn until(what: &str, mut is_so: impl AsyncFnMut() -> bool) {
    for _ in 0..200 {
        if is_so().await {
            return;
        }
        tokio::time::sleep(Duration::from_millis(50)).await;
    }
    panic!("{what}");
}

/// Pieces of long work that go on.
fn long_work(server: &Server) -> usize {
    server.fake.long_work.load(Ordering::SeqCst)
}

fn set_mood(server: &Server, mood: Mood) {
    *server.fake.mood.lock().unwrap() = mood;
}

/// Tiles and skies that were made before, and what clients have already, are answered by a server that works on all it can.
#[tokio::test]
async fn what_is_there_needs_no_place() {
    let server = Server::with(HttpConfig { concurrent_requests: 1, ..HttpConfig::default() }).await;
    let tile = "/api/v1/scenes/demo/tiles/radiance/1/0/0.png";
    let (made, sky) = (server.answer(tile).await, server.answer(SKY).await);
    assert_eq!((made.status().as_u16(), sky.status().as_u16()), (200, 200));
    set_mood(&server, Mood::Slow(Duration::from_secs(5)));
    let busy = ask_from(&server, 1, &format!("GET {SKY}&turbidity=3")).await;
    // This look at the metrics is a request too.
    until("it is asked", async || metric(&server, "skyglow_http_in_flight").await == 2).await;
    tokio::time::sleep(Duration::from_millis(300)).await;
    assert_eq!(server.answer(&format!("{SKY}&turbidity=4")).await.status(), 503, "its only place is taken");
    for path in [tile, SKY, "/api/v1/scenes", "/"] {
        assert_eq!(server.answer(path).await.status(), 200, "{path}");
    }
    let again = server.get(tile).header("if-none-match", header(&made, "etag")).send().await.unwrap();
    assert_eq!(again.status(), 304);
    let new = server.answer("/api/v1/scenes/demo/tiles/radiance/2/1/1.png").await;
    assert_eq!(new.status(), 503, "what must be drawn needs a place");
    drop(busy);
}

/// Long work ends when its client goes.
#[tokio::test]
async fn work_ends_when_its_client_goes() {
    let server = Server::start().await;
    set_mood(&server, Mood::Slow(Duration::from_secs(60)));
    let asked = ask_from(&server, 1, &format!("GET {INFLUENCE}?{PLACE}")).await;
    until("it begins", async || long_work(&server) == 1).await;
    drop(asked);
    until("it ends", async || long_work(&server) == 0).await;
}

/// Whatever one client asks for, another's influence is found next to it.
#[tokio::test]
async fn one_client_does_not_take_all_turns() {
    let server = Server::start().await;
    set_mood(&server, Mood::Slow(Duration::from_secs(60)));
    let mut asked = Vec::new();
    for number in 0..20 {
        asked.push(ask_from(&server, 1, &format!("GET {INFLUENCE}?{PLACE}&turbidity=2.{number:02}")).await);
    }
    until("they begin", async || long_work(&server) > 0).await;
    tokio::time::sleep(Duration::from_millis(200)).await;
    assert_eq!(long_work(&server), 1, "one place is left to others");
    set_mood(&server, Mood::Well);
    let mut other = ask_from(&server, 2, &format!("GET {INFLUENCE}?{PLACE}&turbidity=5")).await;
    let mut answer = String::new();
    let read = other.read_to_string(&mut answer);
    tokio::time::timeout(Duration::from_secs(10), read).await.expect("it is its turn").unwrap();
    // The made-up program finds none.
    assert!(answer.contains("/problems/engine-down"), "{answer}");
    drop(asked);
}

/// Who had more than its time of long work waits, and has all else.
#[tokio::test]
async fn long_work_has_a_share_of_time() {
    let config = HttpConfig { work_per_minute_s: 0.6, work_burst_s: 1.0, ..HttpConfig::default() };
    let server = Server::with(config).await;
    let first = server.answer("/api/v1/scenes").await;
    assert_eq!(header(&first, "ratelimit-policy"), "\"requests\";q=1000;w=10, \"work-seconds\";q=1;w=100");
    assert!(header(&first, "ratelimit").contains("\"work-seconds\";r=1;t=0"), "{first:?}");
    set_mood(&server, Mood::Slow(Duration::from_millis(1200)));
    assert_eq!(server.answer(&format!("{INFLUENCE}?{PLACE}")).await.status(), 503);
    let refused = server.answer(&format!("{INFLUENCE}?{PLACE}&turbidity=3")).await;
    assert_eq!(refused.status(), 429);
    assert!(header(&refused, "ratelimit").contains("\"work-seconds\";r=0;"), "{refused:?}");
    assert!(header(&refused, "retry-after").parse::<u64>().unwrap() > 60);
    set_mood(&server, Mood::Well);
    assert_eq!(server.answer(SKY).await.status(), 200);
}

/// Answers on their way to one client have a share of the memory.
#[tokio::test]
async fn answers_on_their_way_have_a_share() {
    let raster = |turbidity: u8| {
        format!("/api/v1/scenes/demo/panorama.tif?{PLACE}&width=2048&height_px=1024&turbidity={turbidity}")
    };
    let length_bytes = Server::start().await.answer(&raster(2)).await.bytes().await.unwrap().len() as u64;
    // More than systems take from the server at once, and more than an eighth of the memory.
    assert!(length_bytes > 1 << 20, "{length_bytes}");
    let config = HttpConfig { memory_budget_bytes: 6 * length_bytes, ..HttpConfig::default() };
    let server = Server::with(config).await;
    let mut slow = ask_from(&server, 1, &format!("GET {}", raster(2))).await;
    let mut head = [0; 12];
    slow.read_exact(&mut head).await.unwrap();
    assert_eq!(&head, b"HTTP/1.1 200");
    let mut more = ask_from(&server, 1, &format!("GET {}", raster(3))).await;
    more.read_exact(&mut head).await.unwrap();
    assert_eq!(&head, b"HTTP/1.1 429");
    assert_eq!(server.answer(&raster(2)).await.status(), 200, "another client has its own");
    assert!(metric(&server, "skyglow_http_sending_bytes").await > 0);
    drop(slow);
    until("what is not sent any more is given back", async || {
        metric(&server, "skyglow_http_sending_bytes").await == 0
    })
    .await;
}

/// A job is followed to its end, and what came of it is the answer that a wait would have given.
#[tokio::test]
async fn long_work_can_be_a_job() {
    let server = Server::start().await;
    let begin = async |turbidity: u8| {
        let path = format!("{}{INFLUENCE}?{PLACE}&turbidity={turbidity}", server.base);
        let answer =
            server.client.post(path).header("prefer", "respond-async").body("{}").send().await.unwrap();
        assert_eq!((answer.status().as_u16(), header(&answer, "preference-applied")), (202, "respond-async"));
        header(&answer, "location").to_owned()
    };
    set_mood(&server, Mood::Slow(Duration::from_millis(500)));
    let job = begin(2).await;
    let (status, result): (u16, Value) = server.json(&format!("{job}/result")).await;
    assert_eq!((status, &result["type"]), (503, &"/problems/being-made".into()));
    until("it is worked on", async || server.json(&job).await.1["state"] == "running").await;
    until("it ends", async || server.json(&job).await.1["state"] == "failed").await;
    let (_, ended) = server.json(&job).await;
    assert_eq!((&ended["status"], &ended["result"]), (&503.into(), &format!("{job}/result").into()));
    let (status, result) = server.json(&format!("{job}/result")).await;
    assert_eq!((status, &result["type"]), (503, &"/problems/engine-down".into()));

    set_mood(&server, Mood::Slow(Duration::from_secs(60)));
    let job = begin(3).await;
    until("it begins", async || long_work(&server) == 1).await;
    let cancel =
        async || server.client.delete(format!("{}{job}", server.base)).send().await.unwrap().status();
    assert_eq!(cancel().await, 204);
    until("it is given up", async || long_work(&server) == 0).await;
    assert_eq!((cancel().await.as_u16(), server.answer(&job).await.status().as_u16()), (404, 404));
}

/// What takes more memory than there is for all requests is refused before it begins, and says so.
#[tokio::test]
async fn more_than_all_memory_is_refused() {
    let server = Server::with(HttpConfig { memory_budget_bytes: 32, ..HttpConfig::default() }).await;
    let answer = server.answer(&format!("{INFLUENCE}?{PLACE}")).await;
    assert_eq!(answer.status(), 503);
    let problem: serde_json::Value = answer.json().await.unwrap();
    assert_eq!(problem["type"], "/problems/scene-too-large");
    assert_eq!(server.fake.long_work.load(Ordering::SeqCst), 0);
    // With the memory of this machine it begins.
    let answer = Server::start().await.answer(&format!("{INFLUENCE}?{PLACE}")).await;
    let problem: serde_json::Value = answer.json().await.unwrap();
    assert_ne!(problem["type"], "/problems/scene-too-large");
}
