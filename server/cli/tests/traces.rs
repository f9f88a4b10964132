//! Spans of requests, at a collector of OpenTelemetry.

#![expect(clippy::unwrap_used, clippy::expect_used, reason = "a test stops at the first error")]

mod common;

use common::server::Server;
use std::{
    io::{BufRead, BufReader, Read, Write},
    net::{TcpListener, TcpStream},
    sync::mpsc::{Sender, channel},
};

/// What a collector was sent: the first line, and the body (protobuf, in which texts and ids lie as they are).
type Sent = (String, Vec<u8>);

fn collect(stream: &TcpStream, sent: &Sender<Sent>) {
    let mut reader = BufReader::new(stream);
    loop {
        let mut first = String::new();
        if reader.read_line(&mut first).unwrap_or(0) == 0 {
            return;
        }
        let mut length = 0;
        loop {
            let mut line = String::new();
            reader.read_line(&mut line).unwrap();
            let line = line.trim().to_ascii_lowercase();
            if let Some(value) = line.strip_prefix("content-length:") {
                length = value.trim().parse().unwrap();
            }
            if line.is_empty() {
                break;
            }
        }
        let mut body = vec![0; length];
        reader.read_exact(&mut body).unwrap();
        sent.send((first.trim().to_owned(), body)).unwrap();
        let mut stream = stream;
        stream.write_all(b"HTTP/1.1 200 OK\r\ncontent-length: 0\r\n\r\n").unwrap();
    }
}

/// Requests are traced to a collector, and continue the trace of their client.
#[test]
fn requests_are_traced_to_a_collector() {
    let listener = TcpListener::bind("127.0.0.1:0").unwrap();
    let collector = format!("http://{}", listener.local_addr().unwrap());
    let (sender, sent) = channel();
    std::thread::spawn(move || {
        for stream in listener.incoming().flatten() {
            let sender = sender.clone();
            std::thread::spawn(move || collect(&stream, &sender));
        }
    });
    let data = tempfile::tempdir().unwrap();
    let server = Server::start(data.path(), &["--device", "cpu", "--no-demo", "--otlp-endpoint", &collector]);
    let trace = "4bf92f3577b34da6a3ce929d0e0e4736";
    let parent = format!("00-{trace}-00f067aa0ba902b7-01");
    let answer = server.get_with("/api/v1/scenes", &[("traceparent", &parent), ("x-request-id", "seen-7")]);
    assert_eq!(answer.status, 200);
    assert_eq!(server.get("/api/v1/scenes/none").status, 404);
    assert_eq!(server.terminate(), 0);

    let sent: Vec<Sent> = sent.try_iter().collect();
    assert!(!sent.is_empty(), "the collector was sent nothing");
    assert!(sent.iter().all(|(first, _)| first == "POST /v1/traces HTTP/1.1"), "{:?}", sent[0].0);
    let all = sent.iter().flat_map(|(_, body)| body.iter().copied()).collect::<Vec<u8>>();
    let holds = |part: &[u8]| all.windows(part.len()).any(|window| window == part);
    for text in [
        "service.name",
        "skyglow",
        "GET /api/v1/scenes",
        "GET /api/v1/scenes/{scene}",
        "http.response.status_code",
        "seen-7",
        "work",
    ] {
        assert!(holds(text.as_bytes()), "no {text:?} among the spans");
    }
    let bytes = |hex: &str| {
        (0..hex.len() / 2)
            .map(|i| u8::from_str_radix(&hex[2 * i..2 * i + 2], 16).unwrap())
            .collect::<Vec<u8>>()
    };
    assert!(
        holds(&bytes(trace)) && holds(&bytes("00f067aa0ba902b7")),
        "the client's trace is not gone on with"
    );
}

/// A collector that is not there keeps nothing from being answered.
#[test]
fn requests_are_answered_without_a_collector() {
    let data = tempfile::tempdir().unwrap();
    // A port that was free a moment ago.
    let port = TcpListener::bind("127.0.0.1:0").unwrap().local_addr().unwrap().port();
    let collector = format!("http://127.0.0.1:{port}");
    let server = Server::start(data.path(), &["--device", "cpu", "--no-demo", "--otlp-endpoint", &collector]);
    assert_eq!(server.get("/api/v1/scenes").status, 200);
    assert_eq!(server.terminate(), 0);
}

/// A collector's address that is none is refused by its name.
#[test]
fn a_bad_collector_address_is_refused_by_name() {
    let finished = common::skyglow(&["serve", "--otlp-endpoint", "https://collector:4318"]).expect_status(1);
    assert!(finished.stderr.contains("otlp_endpoint must be"), "{}", finished.stderr);
}
