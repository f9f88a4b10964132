//! Nothing a client sends yields a 500.

use crate::fake::Fake;
use proptest::prelude::*;
use skyglow_http::{HttpConfig, router};
use std::sync::{Arc, OnceLock};
use tokio::runtime::Runtime;

/// One server for all cases of all tests here.
fn base() -> &'static (Runtime, String) {
    static SERVER: OnceLock<(Runtime, String)> = OnceLock::new();
    SERVER.get_or_init(|| {
        let runtime = Runtime::new().unwrap();
        let listener = runtime.block_on(tokio::net::TcpListener::bind("127.0.0.1:0")).unwrap();
        let base = format!("http://{}", listener.local_addr().unwrap());
        let config = HttpConfig { requests_per_second: 0.0, ..HttpConfig::default() };
        let app = router(Arc::new(Fake::default()), config.clone());
        runtime.spawn(async move {
            skyglow_http::serve(listener, app, &config, std::future::pending()).await.unwrap();
        });
        (runtime, base)
    })
}

/// Status of a path sent as it is, without a client library that would tidy it up.
fn status(path: &str) -> u16 {
    sent(&format!("GET {path} HTTP/1.1\r\nhost: x\r\nconnection: close\r\n\r\n"))
}

/// Status of a body sent to a path.
fn posted(path: &str, body: &str) -> u16 {
    let length = body.len();
    sent(&format!(
        "POST {path} HTTP/1.1\r\nhost: x\r\nconnection: close\r\ncontent-length: {length}\r\n\r\n{body}"
    ))
}

fn sent(request: &str) -> u16 {
    let (runtime, base) = base();
    runtime.block_on(async {
        use tokio::io::{AsyncReadExt, AsyncWriteExt};
        let mut stream = tokio::net::TcpStream::connect(base.trim_start_matches("http://")).await.unwrap();
        stream.write_all(request.as_bytes()).await.unwrap();
        let mut answer = Vec::new();
        stream.read_to_end(&mut answer).await.unwrap();
        String::from_utf8_lossy(&answer[9..12]).parse().unwrap()
    })
}

/// Names of parameters, and some that are none.
fn name() -> impl Strategy<Value = String> {
    prop_oneof![
        4 => prop::sample::select(vec![
            "lat", "lon", "height", "altitude", "turbidity", "scattering", "lamp", "emission", "basis", "clouds",
            "direct_uplight", "ground_reflectance", "emission_keep",
            "terrain", "tolerance", "sky", "scenario", "projection", "azimuth", "elevation", "fov", "style",
            "colormap", "scale", "min", "max", "exposure", "adaptation", "dynamic_range", "width", "height_px", "legend", "measure", "limit", "region",
        ]).prop_map(str::to_owned),
        1 => "[a-z%&=+;\\[\\]]{0,8}",
    ]
}

/// Values near and far from what is allowed.
fn value() -> impl Strategy<Value = String> {
    prop_oneof![
        prop::num::f64::ANY.prop_map(|x| x.to_string()),
        (-500.0f64..500.0).prop_map(|x| format!("{x:.3}")),
        prop::num::i64::ANY.prop_map(|x| x.to_string()),
        prop::sample::select(vec![
            "",
            "NaN",
            "inf",
            "-0",
            "1e400",
            "single",
            "multiple",
            "mixed",
            "fisheye",
            "perspective",
            "realistic",
            "false_colour",
            "total",
            "magnitude",
            "none",
            "on",
            "1,2,3",
            "0,0,0",
            "%FF",
            "%00",
            "%",
            "garstang_1986",
            "nadir_radiance",
            "norm",
            "region",
            "1,2;3,4;5,60",
            "0,90;0,90;0,90",
            ";;;",
        ])
        .prop_map(str::to_owned),
        "[!-~&&[^# ]]{0,20}",
    ]
}

/// No defect: an answer, a refusal of the request, or a busy server.
fn is_fine(status: u16) -> bool {
    (200..500).contains(&status) || status == 503
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 400, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn no_query_yields_a_500(
        resource in prop::sample::select(vec!["sky", "site", "panorama.json", "panorama", "places", "influence", "influence.tif"]),
        pairs in prop::collection::vec((name(), value()), 0..6),
        with_place in any::<bool>(),
    ) {
        let mut query: Vec<String> = pairs.iter().map(|(name, value)| format!("{name}={value}")).collect();
        if with_place {
            query.insert(0, "lat=-1.2&lon=36.8".to_owned());
        }
        // A large picture takes its time; its size is bounded by the parameters' ranges.
        let path = format!("/api/v1/scenes/demo/{resource}?{}", query.join("&"));
        let status = status(&path);
        prop_assert!(is_fine(status), "{status} for {path}");
    }

    #[test]
    fn no_body_yields_a_500(
        body in prop_oneof![
            "\\PC{0,60}",
            prop::collection::vec((prop::num::f64::ANY, -10.0f64..100.0), 0..6)
                .prop_map(|corners| format!("{{\"region\": {:?}}}", corners.iter().map(|c| [c.0, c.1]).collect::<Vec<_>>())),
            prop::collection::vec((-400.0f64..400.0, -100.0f64..100.0), 0..6).prop_map(|corners| format!(
                "{{\"boundary\": {{\"type\": \"Polygon\", \"coordinates\": [{:?}]}}}}",
                corners.iter().map(|c| [c.0, c.1]).collect::<Vec<_>>()
            )),
            (prop::num::f64::ANY, prop::num::f64::ANY, prop::num::f64::ANY, value()).prop_map(|(lon, lat, x, text)| format!(
                "{{\"edits\": [{{\"brush\": {{\"points\": [[{lon:?}, {lat:?}]], \"radius_m\": {x:?}}}, \"factor\": {x:?}, \"lamp\": {text:?}}}]}}"
            )),
            (-100.0f64..100.0, -400.0f64..400.0, prop::num::f64::ANY, value()).prop_map(|(lat, lon, x, text)| format!(
                "{{\"method\": \"threshold\", \"site\": {{\"lat\": {lat:?}, \"lon\": {lon:?}}}, \"q_a\": {text:?}, \"q_b\": {x:?}}}"
            )),
            (-100.0f64..100.0, -400.0f64..400.0, prop::num::f64::ANY).prop_map(|(lat, lon, x)| format!(
                "{{\"method\": \"target\", \"sites\": [{{\"lat\": {lat:?}, \"lon\": {lon:?}, \"reduce_by\": {x:?}}}], \"max_cut\": {x:?}}}"
            )),
        ],
    ) {
        for path in ["influence?lat=-1.2&lon=36.8", "scenarios", "plans"] {
            let status = posted(&format!("/api/v1/scenes/demo/{path}"), &body);
            prop_assert!(is_fine(status), "{status} for {path}: {body}");
        }
    }

    #[test]
    fn no_geometry_yields_a_500(
        kind in prop::sample::select(vec!["POINT", "LINESTRING", "LINESTRING M", "POLYGON", "MULTIPOLYGON"]),
        inside in prop_oneof!["[(), .a-zA-Z0-9-]{0,40}", "\\PC{0,20}"],
        query in prop::sample::select(vec!["position", "trajectory", "area"]),
    ) {
        let coords: String = format!("{kind}({inside})").bytes().map(|byte| format!("%{byte:02x}")).collect();
        let path = format!("/api/ogc/collections/demo/{query}?coords={coords}");
        let status = status(&path);
        prop_assert!(is_fine(status), "{status} for {path}");
    }

    #[test]
    fn no_path_yields_a_500(path in "(/api/v1/scenes/demo/tiles|/api/ogc|/api/stac)?(/[a-z0-9%.]{0,8}){0,6}") {
        let path = if path.is_empty() { "/".to_owned() } else { path };
        let status = status(&path);
        prop_assert!(is_fine(status), "{status} for {path}");
    }
}

#[test]
fn any_view_of_the_sky_is_drawn_or_refused() {
    for width in [16, 17, 320, 640] {
        for height in [16, 33] {
            for projection in ["equirectangular", "fisheye", "perspective&azimuth=-350&elevation=-90&fov=150"]
            {
                for style in ["false_colour", "realistic&exposure=12", "false_colour&min=1e-9&max=1e6"] {
                    let path = format!(
                        "/api/v1/scenes/demo/panorama.png?lat=-1&lon=37&width={width}&height_px={height}&projection={projection}&style={style}"
                    );
                    assert_eq!(status(&path), 200, "{path}");
                }
            }
        }
    }
}
