//! What bodies get that cannot be meant: `docs/refused-bodies.md`, which is written by this test and held to it.

use super::EndToEnd;
use serde_json::{Value, json};
use std::{
    fmt::Write as _,
    io::{Read, Write},
    net::TcpStream,
    path::PathBuf,
};

/// A body and where it goes.
struct Bad {
    what: &'static str,
    path: &'static str,
    body: String,
}

/// The table's file.
fn table_file() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../../docs/refused-bodies.md")
}

const INFLUENCE: &str = "influence?lat=46.17&lon=8.79";

fn boundary(ring: &str) -> String {
    format!(r#"{{"boundary": {{"type": "Polygon", "coordinates": [[{ring}]]}}}}"#)
}

const SHARES: &str = "shares?lat=46.17&lon=8.79";

/// A collection of one area, or of what is none.
fn area(kind: &str, coordinates: &str) -> String {
    format!(
        r#"{{"type": "FeatureCollection", "features": [{{"type": "Feature", "properties": {{"name": "Locarno"}}, "geometry": {{"type": "{kind}", "coordinates": {coordinates}}}}}]}}"#
    )
}

fn painted(area: &str) -> String {
    format!(r#"{{"edits": [{{{area}, "factor": 0.5}}]}}"#)
}

fn polygon(ring: &str) -> String {
    painted(&format!(r#""polygon": {{"type": "Polygon", "coordinates": [[{ring}]]}}"#))
}

fn brush(rest: &str) -> String {
    format!(r#"{{"edits": [{{"brush": {{"points": [[8.79, 46.17]], "radius_m": 2000}}, {rest}}}]}}"#)
}

fn target(rest: &str) -> String {
    format!(r#"{{"method": "target", "sites": [{{"lat": 46.53, "lon": 8.61, {rest}}}]}}"#)
}

fn corners(count: usize) -> String {
    let corners: Vec<String> = (0..count).map(|k| format!("[{}.{:03},46]", 5 + k % 9, k % 1000)).collect();
    corners.join(",")
}

fn bad_bodies() -> Vec<Bad> {
    let bad = |what, path, body: String| Bad { what, path, body };
    let influence = |what, body: &str| bad(what, INFLUENCE, body.to_owned());
    let shares = |what, body: &str| bad(what, SHARES, body.to_owned());
    let scenario = |what, body: String| bad(what, "scenarios", body);
    let plan = |what, body: String| bad(what, "plans", body);
    vec![
        influence("no JSON", r#"{"region": "#),
        influence("NaN", r#"{"region": [[NaN, 20], [50, 20], [30, 60]]}"#),
        influence("a number too large for one", r#"{"region": [[1e999, 20], [50, 20], [30, 60]]}"#),
        influence("a curve of two points", r#"{"region": [[10, 20], [50, 20]]}"#),
        influence("a curve below the horizon", r#"{"region": [[10, -20], [50, 20], [30, 60]]}"#),
        influence("a curve around no direction", r#"{"region": [[10, 45.1], [11, 45.1], [10.5, 45.2]]}"#),
        influence("a name that is none", r#"{"regoin": [[10, 20], [50, 20], [30, 60]]}"#),
        influence("an open ring", &boundary("[8.6, 46], [9.1, 46], [9.1, 46.3]")),
        influence("an empty polygon", &boundary("")),
        influence("a polygon around no point", &boundary("[8, 46], [8.5, 46], [9, 46], [8, 46]")),
        influence("a latitude of 95°", &boundary("[8.6, 46], [9.1, 95], [9.1, 46.3], [8.6, 46]")),
        influence("a point", r#"{"boundary": {"type": "Point", "coordinates": [8.79, 46.17]}}"#),
        influence("latitude before longitude", &boundary("[46, 8.6], [46, 9.1], [46.3, 9.1], [46, 8.6]")),
        influence("an area elsewhere", &boundary("[98, 46], [99, 46], [99, 47], [98, 46]")),
        influence("KML", r#"<?xml version="1.0"?><kml xmlns="http://www.opengis.net/kml/2.2"></kml>"#),
        influence("60 000 corners", &boundary(&corners(60_000))),
        influence("10⁶ corners", &boundary(&corners(1_000_000))),
        influence("100 MB", &" ".repeat(100_000_000)),
        shares("no features", r#"{"type": "FeatureCollection", "features": []}"#),
        shares("a point among the areas", &area("Point", "[8.79, 46.17]")),
        shares("an open ring", &area("Polygon", "[[[8.6, 46], [9.1, 46], [9.1, 46.3]]]")),
        shares("an area elsewhere", &area("Polygon", "[[[98, 46], [99, 46], [99, 47], [98, 46]]]")),
        shares("JSON that is no GeoJSON", r#"{"areas": []}"#),
        scenario("no edits", r#"{"edits": []}"#.to_owned()),
        scenario("101 edits", format!(r#"{{"edits": [{}]}}"#, vec![r#"{"factor": 0.5}"#; 101].join(","))),
        scenario("an open ring", polygon("[8.6, 46], [9.1, 46], [9.1, 46.3]")),
        scenario("an empty polygon", polygon("")),
        scenario("a polygon outside the scene", polygon("[98, 46], [99, 46], [99, 47], [98, 46]")),
        scenario("a stroke without points", painted(r#""brush": {"points": [], "radius_m": 500}"#)),
        scenario("a brush of no width", painted(r#""brush": {"points": [[8.79, 46.17]], "radius_m": 0}"#)),
        scenario("a negative factor", brush(r#""factor": -1"#)),
        scenario("NaN", brush(r#""factor": NaN"#)),
        scenario("negative radiance", brush(r#""add_radiance_nw_cm2_sr": -5"#)),
        scenario("two changes that exclude each other", brush(r#""factor": 0.5, "add_radiance_nw_cm2_sr": 5"#)),
        scenario("nothing changed", brush(r#""emission": null"#)),
        scenario("an unknown lamp", brush(r#""lamp": {"from": "hps", "to": "candle"}"#)),
        scenario("emission that adds up to nothing", brush(r#""emission": [0, 0, 0]"#)),
        scenario("10⁶ corners", polygon(&corners(1_000_000))),
        scenario("100 MB", " ".repeat(100_000_000)),
        plan("no method", "{}".to_owned()),
        plan("an unknown method", r#"{"method": "magic", "sites": []}"#.to_owned()),
        plan("no sites", r#"{"method": "target", "sites": []}"#.to_owned()),
        plan("a site that wants nothing", target(r#""measure": "zenith""#)),
        plan("a site that wants more than all", target(r#""reduce_by": 1.5"#)),
        plan("NaN", target(r#""reduce_by": NaN"#)),
        plan("an unknown measure", target(r#""measure": "beauty", "reduce_by": 0.3"#)),
        plan("a site outside the scene", r#"{"method": "target", "sites": [{"lat": 80, "lon": 0, "reduce_by": 0.1}]}"#.to_owned()),
        plan("an eye 99 km up", target(r#""height": 99000, "reduce_by": 0.1"#)),
        plan("a largest cut above 1", r#"{"method": "target", "max_cut": 1.5, "sites": [{"lat": 46.53, "lon": 8.61, "reduce_by": 0.3}]}"#.to_owned()),
        plan("an open ring protected", r#"{"method": "target", "protect": {"type": "Polygon", "coordinates": [[[8.6, 46], [9.1, 46], [9.1, 46.3]]]}, "sites": [{"lat": 46.53, "lon": 8.61, "reduce_by": 0.3}]}"#.to_owned()),
        plan("10⁶ corners protected", format!(r#"{{"method": "target", "protect": {{"type": "Polygon", "coordinates": [[{}]]}}, "sites": []}}"#, corners(1_000_000))),
        plan("a name that is none", r#"{"method": "target", "protected": 1, "sites": []}"#.to_owned()),
        plan("100 MB", " ".repeat(100_000_000)),
        bad("a scenario that there is none of", "plans?scenario=s-00000000000000000000", target(r#""reduce_by": 0.3"#)),
    ]
}

/// The status and the problem of a body.
async fn answer_of(server: &EndToEnd, bad: &Bad) -> (u16, Value) {
    let url = format!("{}/api/v1/scenes/demo/{}", server.base, bad.path);
    if bad.body.len() > 2 << 20 {
        return answer_of_long(server, bad);
    }
    let request = server.client.post(url).header("content-type", "application/json");
    let answer = request.body(bad.body.clone()).send().await.unwrap();
    (answer.status().as_u16(), answer.json().await.unwrap())
}

/// The same for what is refused by its length: the server answers before it has read the body, and closes. A client that
/// still sends then may lose the answer, so no more than the head is sent here.
fn answer_of_long(server: &EndToEnd, bad: &Bad) -> (u16, Value) {
    let host = server.base.trim_start_matches("http://");
    let mut stream = TcpStream::connect(host).unwrap();
    let length = bad.body.len();
    write!(
        stream,
        "POST /api/v1/scenes/demo/{} HTTP/1.1\r\nhost: {host}\r\ncontent-type: application/json\r\nconnection: close\r\n\
         content-length: {length}\r\n\r\n",
        bad.path
    )
    .unwrap();
    let mut answer = String::new();
    stream.read_to_string(&mut answer).unwrap();
    let status = answer.split(' ').nth(1).unwrap().parse().unwrap();
    let body = answer.split_once("\r\n\r\n").unwrap().1;
    (status, serde_json::from_str(&body[body.find('{').unwrap()..=body.rfind('}').unwrap()]).unwrap())
}

/// How much of a body the table shows, characters.
const SHOWN: usize = 110;

fn shown(body: &str) -> String {
    let body = body.trim_start();
    match body.chars().count() {
        0 => "spaces".to_owned(),
        count if count <= SHOWN => format!("`{body}`"),
        _ => format!("`{}` …", body.chars().take(SHOWN).collect::<String>()),
    }
}

#[tokio::test]
async fn bad_bodies_get_what_the_table_says() {
    let server = EndToEnd::shared().await;
    let mut table = String::from(
        "# What bodies get that cannot be meant\n\n\
         Posted to `/api/v1/scenes/demo/…`, each with its answer: the status, the part of the body that is named, and what is said of\n\
         it. Nothing is kept of any of them. A test posts every row to a server and holds this page to what comes back\n\
         (`UPDATE_REFUSED_BODIES=1 cargo test -p skyglow-http --test interface` writes it anew).\n\n\
         Curves on the sky are closed by themselves, and may pass north, hold the zenith and cross themselves: whatever they wind\n\
         around is inside, both loops of an eight too. Rings of polygons on the ground must be closed, as GeoJSON has it.\n\n\
         | to | what | body | status | named | said |\n|---|---|---|---|---|---|\n",
    );
    for bad in bad_bodies() {
        let (status, problem) = answer_of(&server, &bad).await;
        assert!((400..500).contains(&status), "{}: {status}, {problem}", bad.what);
        assert_eq!(problem["status"], json!(status), "{}: {problem}", bad.what);
        let error = &problem["errors"][0];
        let named = error["parameter"].as_str().map_or_else(|| "–".to_owned(), |name| format!("`{name}`"));
        let said =
            error["detail"].as_str().or(problem["detail"].as_str()).unwrap_or_default().replace('|', "\\|");
        assert!(!said.is_empty(), "{}: {problem}", bad.what);
        writeln!(
            table,
            "| `{}` | {} | {} | {status} | {named} | {said} |",
            bad.path.split('?').next().unwrap_or_default(),
            bad.what,
            shown(&bad.body).replace('|', "\\|"),
        )
        .unwrap();
    }
    assert_eq!(server.get("/healthz").await.status(), 200);
    if std::env::var_os("UPDATE_REFUSED_BODIES").is_some() {
        std::fs::write(table_file(), &table).unwrap();
    }
    let kept = std::fs::read_to_string(table_file()).unwrap();
    for (line, (kept, now)) in kept.lines().zip(table.lines()).enumerate() {
        assert_eq!(kept, now, "line {} of docs/refused-bodies.md", line + 1);
    }
    assert_eq!(kept.lines().count(), table.lines().count());
}
