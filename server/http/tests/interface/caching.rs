use crate::server::{PLACE, SKY, Server, header};

/// A client that has the answer gets 304, and nothing is rendered.
#[tokio::test]
async fn a_known_etag_gets_304_without_rendering() {
    let server = Server::start().await;
    for path in [SKY.to_owned(), format!("/api/v1/scenes/demo/panorama.png?{PLACE}&turbidity=3")] {
        let first = server.answer(&path).await;
        assert_eq!(first.status(), 200);
        let tag = header(&first, "etag").to_owned();
        assert!(tag.starts_with('"') && tag.ends_with('"'), "{tag}");
        assert_eq!(header(&first, "cache-control"), "public, max-age=300");
        assert!(header(&first, "vary").contains("accept-encoding"));

        // Another server has an empty cache, so an answer from it would have to be rendered.
        let other = Server::start().await;
        let second = other.get(&path).header("if-none-match", &tag).send().await.unwrap();
        assert_eq!(second.status(), 304);
        assert_eq!(header(&second, "etag"), tag);
        assert!(second.bytes().await.unwrap().is_empty());
        assert_eq!(other.renders(), 0, "{path}");
    }
}

/// What changes the answer changes its tag, and nothing else does.
#[tokio::test]
async fn the_etag_changes_with_the_answer() {
    let server = Server::start().await;
    let tag = async |query: &str| {
        header(&server.answer(&format!("/api/v1/scenes/demo/panorama.png?{PLACE}{query}")).await, "etag")
            .to_owned()
    };
    let plain = tag("").await;
    for same in ["&turbidity=2.5", "&lamp=mixed", "&projection=equirectangular", "&terrain=on", "&height=2.0"]
    {
        assert_eq!(tag(same).await, plain, "{same}");
    }
    for other in [
        "&turbidity=2.6",
        "&lamp=hps",
        "&projection=fisheye",
        "&width=500",
        "&sky=total",
        "&basis=32",
        "&tolerance=0.1",
        "&terrain=off",
    ] {
        assert_ne!(tag(other).await, plain, "{other}");
    }
    *server.fake.version.lock().unwrap() = "v2".into();
    assert_ne!(tag("").await, plain);
}

/// Identical requests get identical bytes and are rendered once.
#[tokio::test]
async fn identical_requests_are_rendered_once() {
    let server = Server::start().await;
    *server.fake.mood.lock().unwrap() = crate::fake::Mood::Slow(std::time::Duration::from_millis(100));
    let ask = || async { server.answer(SKY).await.bytes().await.unwrap() };
    let (a, b, c) = tokio::join!(ask(), ask(), ask());
    assert!(a == b && b == c && !a.is_empty());
    assert_eq!(server.renders(), 1);
    // The panorama of the same sky needs no second rendering either.
    let json = server.answer(&format!("/api/v1/scenes/demo/panorama.json?{PLACE}")).await;
    assert_eq!(json.status(), 200);
    assert_eq!(server.renders(), 1);
}

/// Numbers and pictures of one sky, requested at once, are rendered once.
#[tokio::test]
async fn formats_of_one_sky_are_rendered_once() {
    let server = Server::start().await;
    *server.fake.mood.lock().unwrap() = crate::fake::Mood::Slow(std::time::Duration::from_millis(300));
    let path = |name: &str, query: &str| format!("/api/v1/scenes/demo/{name}?{PLACE}{query}");
    let (numbers, picture, fisheye, raster) = (
        path("sky", ""),
        path("panorama.png", ""),
        path("panorama.png", "&projection=fisheye"),
        path("panorama.tif", ""),
    );
    let answers = tokio::join!(
        server.answer(&numbers),
        server.answer(&picture),
        server.answer(&fisheye),
        server.answer(&raster)
    );
    assert!([answers.0, answers.1, answers.2, answers.3].iter().all(|answer| answer.status() == 200));
    assert_eq!(server.renders(), 1);
    // Another sky is another rendering.
    let other = path("sky", "&turbidity=3");
    tokio::join!(server.answer(&numbers), server.answer(&other));
    assert_eq!(server.renders(), 2);
}

/// JSON is compressed as negotiated, each encoding with a strong tag of its own.
#[tokio::test]
async fn each_encoding_has_its_own_strong_etag() {
    let server = Server::start().await;
    let path = format!("/api/v1/scenes/demo/panorama.json?{PLACE}");
    let plain = server.get(&path).send().await.unwrap();
    let plain_tag = header(&plain, "etag").to_owned();
    let plain_bytes = plain.bytes().await.unwrap();
    let mut tags = vec![plain_tag];
    for encoding in ["gzip", "br", "zstd"] {
        let answer = server.get(&path).header("accept-encoding", encoding).send().await.unwrap();
        assert_eq!(header(&answer, "content-encoding"), encoding);
        assert!(header(&answer, "vary").contains("accept-encoding"));
        let tag = header(&answer, "etag").to_owned();
        assert!(!tags.contains(&tag) && !tag.starts_with("W/"), "{tag}");
        assert!(answer.bytes().await.unwrap().len() < plain_bytes.len() / 2);
        let again = server
            .get(&path)
            .header("accept-encoding", encoding)
            .header("if-none-match", &tag)
            .send()
            .await
            .unwrap();
        assert_eq!((again.status().as_u16(), header(&again, "etag")), (304, tag.as_str()));
        tags.push(tag);
    }
    let picture = server
        .get(&format!("/api/v1/scenes/demo/panorama.png?{PLACE}"))
        .header("accept-encoding", "gzip")
        .send()
        .await
        .unwrap();
    assert_eq!(header(&picture, "content-encoding"), "");
}

#[tokio::test]
async fn head_has_the_headers_of_get_and_no_body() {
    let server = Server::start().await;
    for path in [SKY, "/api/v1/scenes", "/healthz", "/"] {
        let get = server.answer(path).await;
        let head = server.client.head(format!("{}{path}", server.base)).send().await.unwrap();
        assert_eq!(head.status(), get.status(), "{path}");
        for name in ["etag", "content-type", "cache-control"] {
            assert_eq!(header(&head, name), header(&get, name), "{path} {name}");
        }
        assert!(head.bytes().await.unwrap().is_empty());
    }
}

#[tokio::test]
async fn any_origin_may_read_and_ask_first() {
    let server = Server::start().await;
    let answer = server.get(SKY).header("origin", "https://elsewhere.example").send().await.unwrap();
    assert_eq!(header(&answer, "access-control-allow-origin"), "*");
    assert!(header(&answer, "access-control-expose-headers").contains("etag"));
    let preflight = server
        .client
        .request(reqwest::Method::OPTIONS, format!("{}{SKY}", server.base))
        .header("origin", "https://elsewhere.example")
        .header("access-control-request-method", "GET")
        .send()
        .await
        .unwrap();
    assert_eq!(preflight.status(), 200);
    assert!(header(&preflight, "access-control-allow-methods").contains("GET"));
}
