//! OGC APIs and STAC: their documents, and what is refused under their names. `end_to_end` has what needs light.

use crate::server::{Server, header};
use serde_json::{Value, json};

/// A link's address by its relation.
fn href<'a>(document: &'a Value, rel: &str) -> &'a str {
    let links = document["links"].as_array().unwrap();
    let found =
        links.iter().find(|link| link["rel"] == rel).unwrap_or_else(|| panic!("no {rel}: {document}"));
    found["href"].as_str().unwrap()
}

/// What an absolute address answers.
async fn at(server: &Server, url: &str) -> Value {
    let path = url.strip_prefix(&server.base).unwrap_or_else(|| panic!("{url} is elsewhere"));
    let (status, document) = server.json(path).await;
    assert_eq!(status, 200, "{url}: {document}");
    document
}

/// From the landing page a client finds its way to collections, tiles and processes.
#[tokio::test]
async fn links_of_the_landing_page_lead_on() {
    let server = Server::start().await;
    let landing = at(&server, &format!("{}/api/ogc", server.base)).await;
    assert_eq!(landing, at(&server, &format!("{}/api/ogc/?f=json", server.base)).await);
    let classes = at(&server, href(&landing, "conformance")).await;
    assert!(classes["conformsTo"].to_string().contains("ogcapi-edr-1/1.1/conf/core"));
    at(&server, href(&landing, "service-desc")).await;
    let collections = at(&server, href(&landing, "data")).await;
    let collection = at(&server, href(&collections["collections"][0], "self")).await;
    assert_eq!(collection, collections["collections"][0]);
    assert_eq!(collection["extent"]["spatial"]["bbox"], json!([[36.0, -2.0, 38.0, 1.0]]));
    let zenith = &collection["parameter_names"]["zenith_luminance_cd_m2"];
    assert_eq!((&zenith["type"], &zenith["unit"]["symbol"]["value"]), (&json!("Parameter"), &json!("cd/m2")));
    let tilesets =
        at(&server, href(&collection, "http://www.opengis.net/def/rel/ogc/1.0/tilesets-map")).await;
    let tileset = at(&server, href(&tilesets["tilesets"][1], "self")).await;
    let matrices = at(&server, href(&tileset, "http://www.opengis.net/def/rel/ogc/1.0/tiling-scheme")).await;
    assert_eq!(matrices["tileMatrices"][3]["matrixWidth"], 8);
    // A template leads to a tile, within the limits of its level.
    let limits = tileset["tileMatrixSetLimits"].as_array().unwrap().last().unwrap();
    let tile = href(&tileset, "item").replace("{tileMatrix}", limits["tileMatrix"].as_str().unwrap());
    let tile = tile.replace("{tileCol}", &limits["minTileCol"].to_string());
    let last_row = limits["maxTileRow"].as_u64().unwrap();
    let at_row = |row: &str| tile.replace("{tileRow}", row);
    let answer = server.client.get(at_row(&last_row.to_string())).send().await.unwrap();
    assert_eq!((answer.status().as_u16(), header(&answer, "content-type")), (200, "image/png"));
    // Beyond the limits there is nothing, as the standard wants, though the layer has blank tiles there.
    for row in [&(last_row + 1).to_string(), "-1", "1@2x", "north"] {
        assert_eq!(server.client.get(at_row(row)).send().await.unwrap().status(), 404, "{row}");
    }
    let processes = at(&server, href(&landing, "http://www.opengis.net/def/rel/ogc/1.0/processes")).await;
    let influence = at(&server, href(&processes["processes"][0], "self")).await;
    assert_eq!(influence["inputs"]["lat"]["schema"]["maximum"], json!(90));
    assert_eq!(influence["inputs"]["lat"]["minOccurs"], 1);
    let (_, first) = server.json("/api/ogc/processes?limit=1").await;
    assert_eq!(first["processes"], json!([processes["processes"][0]]));
    assert_eq!(server.answer("/api/ogc/processes?limit=0").await.status(), 400);
    assert_eq!(server.answer("/api/ogc/collections/demo/map/tiles/influence").await.status(), 404);
    assert_eq!(server.answer("/api/ogc/tileMatrixSets/WorldCRS84Quad").await.status(), 404);
}

/// A position has the numbers of the sky there, those asked for, and its tag follows from all of it.
#[tokio::test]
async fn a_position_has_the_numbers_of_its_sky() {
    let server = Server::start().await;
    let (_, sky) = server.json("/api/v1/scenes/demo/sky?lat=-1&lon=37&turbidity=3").await;
    let path = "/api/ogc/collections/demo/position?coords=POINT(37%20-1)&turbidity=3";
    let answer = server.answer(path).await;
    assert_eq!(header(&answer, "content-type"), "application/prs.coverage+json");
    let tag = header(&answer, "etag").to_owned();
    let coverage: Value = answer.json().await.unwrap();
    assert_eq!(coverage["domain"]["domainType"], "Point");
    assert_eq!(coverage["domain"]["axes"], json!({"x": {"values": [37.0]}, "y": {"values": [-1.0]}}));
    let ranges = coverage["ranges"].as_object().unwrap();
    assert_eq!(ranges.len(), coverage["parameters"].as_object().unwrap().len());
    for (name, range) in ranges {
        let (seen, wanted) = (range["values"][0].as_f64(), sky["sky"][name.as_str()].as_f64());
        assert_eq!(seen, wanted, "{name}");
    }
    assert_eq!(coverage["skyglow:assumptions"]["turbidity"], 3.0);
    assert_eq!(server.renders(), 1, "the sky was rendered before");
    let again = server.get(path).header("if-none-match", &tag).send().await.unwrap();
    assert_eq!(again.status(), 304);
    let (_, two) = server.json(&format!("{path}&parameter-name=bortle_class,ratio_to_natural")).await;
    assert_eq!(
        two["ranges"].as_object().unwrap().keys().collect::<Vec<_>>(),
        ["bortle_class", "ratio_to_natural"]
    );
}

/// A path without times is points in a row.
#[tokio::test]
async fn a_path_has_a_sky_for_each_point() {
    let server = Server::start().await;
    let path = "/api/ogc/collections/demo/trajectory?coords=LINESTRING(37%20-1,37.5%20-1,37.5%200)";
    let (status, coverage) = server.json(&format!("{path}&parameter-name=zenith_luminance_cd_m2")).await;
    assert_eq!((status, &coverage["domain"]["domainType"]), (200, &json!("MultiPoint")));
    let composite = &coverage["domain"]["axes"]["composite"];
    assert_eq!(composite["coordinates"], json!(["x", "y"]));
    assert_eq!(composite["values"], json!([[37.0, -1.0], [37.5, -1.0], [37.5, 0.0]]));
    let range = &coverage["ranges"]["zenith_luminance_cd_m2"];
    assert_eq!((&range["shape"], &range["axisNames"]), (&json!([3]), &json!(["composite"])));
    // A point outside is refused before anything is rendered.
    let renders = server.renders();
    let outside = "/api/ogc/collections/demo/trajectory?coords=LINESTRING(37.1%20-1,50%20-1)";
    assert_eq!(server.json(outside).await.1["type"], "/problems/outside-scene");
    assert_eq!(server.renders(), renders);
}

/// What is wrong is told by the parameter's name, with what is allowed.
#[tokio::test]
async fn wrong_coordinates_are_refused_by_name() {
    let server = Server::start().await;
    for (query, kind, parameter, word) in [
        ("position", "bad-parameters", "coords", "is required"),
        ("position?coords=POINT(37)", "bad-parameters", "coords", "two numbers"),
        ("position?coords=LINESTRING(37%20-1,38%20-1)", "bad-parameters", "coords", "here a POINT is taken"),
        ("position?coords=POINT(37%20-1)&crs=EPSG:4326", "bad-parameters", "crs", "CRS84"),
        ("position?coords=POINT(37%20-1)&f=netCDF", "bad-parameters", "f", "CoverageJSON"),
        ("position?coords=POINT(37%20-1)&z=10", "unknown-parameter", "z", "height"),
        (
            "position?coords=POINT(37%20-1)&parameter-name=wind",
            "bad-parameters",
            "parameter-name",
            "bortle_class",
        ),
        ("area?coords=POLYGON((37%20-1,37.5%20-1,37.5%200))", "bad-parameters", "coords", "a ring is open"),
        ("area?coords=POLYGON((8%2046,9%2046,9%2047,8%2046))", "bad-parameters", "coords", "holds no pixel"),
        (
            "area?coords=POLYGON((-1%2037,-0.5%2037,-0.5%2037.5,-1%2037))",
            "bad-parameters",
            "coords",
            "look like latitude",
        ),
        ("map?bbox=8,46,9,47", "bad-parameters", "bbox", "nothing of the scene"),
        ("map?f=jpeg", "bad-parameters", "f", "png"),
    ] {
        let (status, problem) = server.json(&format!("/api/ogc/collections/demo/{query}")).await;
        assert_eq!(
            (status, &problem["type"]),
            (400, &json!(format!("/problems/{kind}"))),
            "{query}: {problem}"
        );
        assert_eq!(problem["errors"][0]["parameter"], parameter, "{query}");
        assert!(problem["detail"].as_str().unwrap().contains(word), "{query}: {}", problem["detail"]);
    }
    let (status, problem) = server.json("/api/ogc/collections/demo/position?coords=POINT(8%2046)").await;
    assert_eq!((status, &problem["bounds"]), (404, &json!([36.0, -2.0, 38.0, 1.0])));
    assert_eq!(server.answer("/api/ogc/collections/nowhere").await.status(), 404);
    assert_eq!(server.answer("/api/ogc/collections?f=html").await.status(), 400);
}

/// The problems of processes have the standard's names, and explain themselves.
#[tokio::test]
async fn processes_have_problems_of_their_own() {
    let server = Server::start().await;
    let root = "http://www.opengis.net/def/exceptions/ogcapi-processes-1/1.0";
    for (path, name) in [
        ("/api/ogc/processes/tea", "no-such-process"),
        ("/api/ogc/jobs/nothing", "no-such-job"),
        ("/api/ogc/jobs/nothing/results", "no-such-job"),
    ] {
        let (status, problem) = server.json(path).await;
        assert_eq!((status, &problem["type"]), (404, &json!(format!("{root}/{name}"))), "{path}");
        assert_eq!(server.answer(&format!("/problems/{name}")).await.status(), 200);
    }
    let answer =
        server.post("/api/ogc/processes/plan/execution", r#"{"inputs": {"scene": "demo", "tea": 1}}"#).await;
    assert_eq!(answer.status(), 400);
    let problem: Value = answer.json().await.unwrap();
    assert_eq!(
        (&problem["errors"][0]["parameter"], &problem["type"]),
        (&json!("tea"), &json!("/problems/unknown-parameter"))
    );
    // Other sites' pages hold nothing here either.
    let url = format!("{}/api/ogc/processes/plan/execution", server.base);
    let foreign =
        server.client.post(url).header("origin", "https://other.example").body("{}").send().await.unwrap();
    assert_eq!(foreign.status(), 403);
}

/// The catalogue leads to collections and items, whose assets are layers.
#[tokio::test]
async fn the_catalogue_leads_to_layers() {
    let server = Server::start().await;
    let catalogue = at(&server, &format!("{}/api/stac", server.base)).await;
    assert_eq!((&catalogue["type"], &catalogue["stac_version"]), (&json!("Catalog"), &json!("1.1.0")));
    let collection = at(&server, href(&catalogue, "child")).await;
    let interval = json!([["2023-01-01T00:00:00Z", "2023-12-31T23:59:59Z"]]);
    assert_eq!(collection["extent"]["temporal"]["interval"], interval);
    let items: Vec<&Value> =
        collection["links"].as_array().unwrap().iter().filter(|link| link["rel"] == "item").collect();
    assert_eq!(items.len(), 3);
    for link in items {
        let url = link["href"].as_str().unwrap();
        let answer = server.client.get(url).send().await.unwrap();
        assert_eq!(header(&answer, "content-type"), "application/geo+json");
        let item: Value = answer.json().await.unwrap();
        assert_eq!(
            (&item["bbox"], &item["properties"]["datetime"]),
            (&json!([36.0, -2.0, 38.0, 1.0]), &Value::Null)
        );
        assert_eq!(item["properties"]["proj:shape"], json!([720, 480]));
        let transform = json!([1.0 / 240.0, 0.0, 36.0, 0.0, -1.0 / 240.0, 1.0]);
        assert_eq!(item["properties"]["proj:transform"], transform);
        assert_eq!(href(&item, "collection"), href(&collection, "self"));
        let assets = item["assets"].as_object().unwrap();
        assert!(assets.values().any(|asset| asset["href"].as_str().unwrap().ends_with(".tif")), "{item}");
    }
    assert_eq!(server.answer("/api/stac/collections/demo/items/panorama").await.status(), 404);
}
