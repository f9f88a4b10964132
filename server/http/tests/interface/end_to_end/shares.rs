//! Whose light it is, by named places and by areas.

use super::{EndToEnd, number};
use crate::server::header;
use parquet::{
    file::reader::{FileReader, SerializedFileReader},
    record::Row,
};
use serde_json::{Value, json};

/// A dark valley of the demo.
const PLACE: &str = "lat=46.53&lon=8.61";

fn parts<'a>(answer: &'a Value, list: &str, rest: &[&str]) -> Vec<&'a Value> {
    answer[list].as_array().unwrap().iter().chain(rest.iter().map(|name| &answer[*name])).collect()
}

fn sum(parts: &[&Value], of: &str) -> f64 {
    parts.iter().map(|part| number(&part[of])).sum()
}

/// Shares of named places add up to the sky's own light, whatever is listed and measured.
#[tokio::test]
async fn shares_of_places_add_up_to_all() {
    let server = EndToEnd::shared().await;
    for measure in ["zenith", "mean", "horizontal", "region&region=350,5;10,5;10,30;350,30"] {
        for limit in [3, 50] {
            let path = format!("/api/v1/scenes/demo/shares?{PLACE}&measure={measure}&limit={limit}");
            let (status, answer) = server.json(&path).await;
            assert_eq!(status, 200, "{answer}");
            let all = parts(&answer, "places", &["other_places", "elsewhere"]);
            assert!((sum(&all, "share") - 1.0).abs() < 1e-6, "{measure} {}", sum(&all, "share"));
            assert!((sum(&all, "influence") / number(&answer["total"]) - 1.0).abs() < 1e-6);
            let places = answer["places"].as_array().unwrap();
            assert!(places.len() == limit || answer["other_places_count"] == 0, "{answer}");
            assert!(places.windows(2).all(|two| number(&two[0]["share"]) >= number(&two[1]["share"])));
            assert_eq!(places[0]["rank"], 1);
        }
    }
    let (_, sky) = server.json(&format!("/api/v1/scenes/demo/sky?{PLACE}")).await;
    let (_, answer) = server.json(&format!("/api/v1/scenes/demo/shares?{PLACE}")).await;
    let of_sky = number(&sky["sky"]["zenith_luminance_cd_m2"]);
    assert!((number(&answer["total"]) / of_sky - 1.0).abs() < 1e-4);
    // The demo is made of its towns: next to nothing is anybody else's.
    assert!(number(&answer["elsewhere"]["share"]) < 0.05, "{}", answer["elsewhere"]);
    let milano = answer["places"].as_array().unwrap().iter().find(|place| place["name"] == "Milano").unwrap();
    assert!((number(&milano["distance_m"]) - 126_800.0).abs() < 1_000.0, "{milano}");
    assert!((number(&milano["azimuth_deg"]) - 159.0).abs() < 2.0, "{milano}");
}

/// The table has the same numbers, and its last rows are what no listed place has.
#[tokio::test]
async fn shares_come_as_a_table() {
    let server = EndToEnd::shared().await;
    let path = format!("/api/v1/scenes/demo/shares.csv?{PLACE}&limit=4");
    let answer = server.get(&path).await;
    assert_eq!((answer.status().as_u16(), header(&answer, "content-type")), (200, "text/csv"));
    let tag = header(&answer, "etag").to_owned();
    let table = answer.text().await.unwrap();
    let lines: Vec<&str> = table.lines().collect();
    assert_eq!(
        lines[0],
        "rank,name,population,latitude_deg,longitude_deg,distance_m,azimuth_deg,share,influence_cd_m2,flux_dnb_w,pixels"
    );
    assert_eq!(lines.len(), 7);
    assert!(lines[5].starts_with(",other places,,") && lines[6].starts_with(",elsewhere,,"), "{table}");
    let share = |line: &&str| line.split(',').nth(7).unwrap().parse::<f64>().unwrap();
    assert!((lines[1..].iter().map(share).sum::<f64>() - 1.0).abs() < 1e-6);
    assert_eq!(server.get_unless(&path, &tag).await, 304);
}

/// So has the table in Parquet, a row for each of the CSV's, the unit in its notes.
#[tokio::test]
async fn shares_come_as_parquet() {
    let server = EndToEnd::shared().await;
    let answer = server.get(&format!("/api/v1/scenes/demo/shares.parquet?{PLACE}&limit=4")).await;
    assert_eq!(
        (answer.status().as_u16(), header(&answer, "content-type")),
        (200, "application/vnd.apache.parquet")
    );
    let table = SerializedFileReader::new(answer.bytes().await.unwrap()).unwrap();
    let rows: Vec<_> = table.get_row_iter(None).unwrap().map(Result::unwrap).collect();
    let names: Vec<&str> = rows[0].get_column_iter().take(3).map(|(name, _)| name.as_str()).collect();
    assert_eq!((rows.len(), names), (6, vec!["rank", "name", "share"]));
    let share = |row: &Row| row.get_column_iter().find(|(name, _)| *name == "share").unwrap().1.clone();
    let total: f64 = rows.iter().map(|row| share(row).to_string().parse::<f64>().unwrap()).sum();
    assert!((total - 1.0).abs() < 1e-6, "{total}");
    let notes = table.metadata().file_metadata().key_value_metadata().unwrap();
    assert!(
        notes.iter().any(|note| note.key == "influence_unit" && note.value.as_deref() == Some("cd m-2")),
        "{notes:?}"
    );
}

fn square(name: &str, west: f64, south: f64, side: f64) -> Value {
    let (east, north) = (west + side, south + side);
    let ring = [[west, south], [east, south], [east, north], [west, north], [west, south]];
    json!({"type": "Feature", "properties": {"GEN": name},
           "geometry": {"type": "Polygon", "coordinates": [ring]}})
}

async fn post(server: &EndToEnd, end: &str, features: &[Value]) -> reqwest::Response {
    let body = json!({"type": "FeatureCollection", "features": features});
    let url = format!("{}/api/v1/scenes/demo/shares{end}", server.base);
    server.client.post(url).json(&body).send().await.unwrap()
}

/// Areas keep their names and order by share; each is what a boundary by itself has of the influence.
#[tokio::test]
async fn shares_of_areas_keep_their_names() {
    let server = EndToEnd::shared().await;
    let areas = [
        square("west", 8.0, 45.0, 0.7),
        square("Milano, province", 8.7, 45.0, 1.0),
        square("Bodensee", 9.0, 47.4, 0.5),
    ];
    let answer = post(&server, &format!("?{PLACE}&name_field=GEN"), &areas).await;
    assert_eq!(answer.status(), 200);
    let answer: Value = answer.json().await.unwrap();
    let all = parts(&answer, "areas", &["outside"]);
    assert!((sum(&all, "share") - 1.0).abs() < 1e-6, "{}", sum(&all, "share"));
    assert_eq!(
        (&answer["areas"][0]["name"], &answer["areas"][0]["feature"]),
        (&json!("Milano, province"), &json!(2))
    );
    for (feature, area) in areas.iter().enumerate() {
        let (_, one) = {
            let url = format!("{}/api/v1/scenes/demo/influence?{PLACE}", server.base);
            let answer =
                server.client.post(url).json(&json!({"boundary": area["geometry"]})).send().await.unwrap();
            (answer.status(), answer.json::<Value>().await.unwrap())
        };
        let areas = answer["areas"].as_array().unwrap();
        let found = areas.iter().find(|found| found["feature"] == feature + 1).unwrap();
        assert!((number(&found["share"]) - number(&one["boundary"]["share"])).abs() < 1e-9);
        assert_eq!(found["pixels"], one["boundary"]["pixels"]);
    }
    let table = post(&server, &format!(".csv?{PLACE}&name_field=GEN"), &areas).await.text().await.unwrap();
    let lines: Vec<&str> = table.lines().collect();
    assert_eq!((lines.len(), lines[0]), (5, "rank,feature,name,share,influence_cd_m2,flux_dnb_w,pixels"));
    assert!(
        lines[1].starts_with("1,2,\"Milano, province\",") && lines[4].starts_with(",,outside,"),
        "{table}"
    );
}

/// As GeoJSON areas come back with their own properties, shapes and shares, and places as points; both say the rest beside them.
#[tokio::test]
async fn shares_come_as_geojson() {
    let server = EndToEnd::shared().await;
    let mut areas = [square("west", 8.0, 45.0, 0.7), square("Milano, province", 8.7, 45.0, 1.0)];
    areas[1]["properties"]["BFS"] = json!(5113);
    let plain: Value = post(&server, &format!("?{PLACE}&name_field=GEN"), &areas).await.json().await.unwrap();
    let answer = post(&server, &format!(".geojson?{PLACE}&name_field=GEN"), &areas).await;
    assert_eq!((answer.status().as_u16(), header(&answer, "content-type")), (200, "application/geo+json"));
    let collection: Value = answer.json().await.unwrap();
    assert_eq!((&collection["type"], &collection["areas"]), (&json!("FeatureCollection"), &Value::Null));
    for fact in ["measure", "unit", "total", "outside", "shared_pixels", "observer", "warnings"] {
        assert_eq!(collection[fact], plain[fact], "{fact}");
    }
    let features = collection["features"].as_array().unwrap();
    assert_eq!(features.len(), 2);
    for (feature, area) in features.iter().zip(plain["areas"].as_array().unwrap()) {
        let posted = &areas[area["feature"].as_u64().unwrap() as usize - 1];
        let mut properties = posted["properties"].as_object().unwrap().clone();
        properties.extend(area.as_object().unwrap().clone());
        assert_eq!(feature["properties"], Value::Object(properties));
        assert_eq!(feature["geometry"], posted["geometry"]);
    }
    assert_eq!(
        (&features[0]["properties"]["BFS"], &features[0]["properties"]["rank"]),
        (&json!(5113), &json!(1))
    );

    let path = format!("?{PLACE}&limit=4");
    let (_, plain) = server.json(&format!("/api/v1/scenes/demo/shares{path}")).await;
    let (_, collection) = server.json(&format!("/api/v1/scenes/demo/shares.geojson{path}")).await;
    let features = collection["features"].as_array().unwrap();
    let places: Vec<Value> = features.iter().map(|feature| feature["properties"].clone()).collect();
    assert_eq!((json!(places), &collection["elsewhere"]), (plain["places"].clone(), &plain["elsewhere"]));
    let at = &features[0]["geometry"]["coordinates"];
    assert_eq!(at, &json!([places[0]["longitude_deg"], places[0]["latitude_deg"]]));
}

/// Areas that overlap count common lights each, and areas beyond the scene are said.
#[tokio::test]
async fn overlapping_and_far_areas_are_said() {
    let server = EndToEnd::shared().await;
    let areas = [square("a", 8.7, 45.0, 1.0), square("b", 8.7, 45.0, 1.0), square("far", 30.0, 10.0, 1.0)];
    let answer: Value = post(&server, &format!("?{PLACE}"), &areas).await.json().await.unwrap();
    assert_eq!(answer["areas"][0]["influence"], answer["areas"][1]["influence"]);
    assert_eq!(answer["shared_pixels"], answer["areas"][0]["pixels"]);
    let warnings = answer["warnings"].to_string();
    assert!(warnings.contains("1 of 3 areas lie outside") && warnings.contains("overlap"), "{warnings}");
    assert_eq!((&answer["areas"][2]["name"], number(&answer["areas"][2]["share"])), (&json!("area 3"), 0.0));
    let refused = post(&server, &format!("?{PLACE}"), &areas[2..]).await;
    assert_eq!(refused.status(), 400);
    let async_post = server.client.post(format!("{}/api/v1/scenes/demo/shares?{PLACE}", server.base));
    let accepted = async_post.header("prefer", "respond-async").json(&areas[0]).send().await.unwrap();
    assert_eq!(accepted.status(), 202);
}
