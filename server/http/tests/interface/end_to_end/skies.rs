//! Many skies at once.

use super::EndToEnd;
use crate::server::header;
use parquet::{
    file::reader::{FileReader, SerializedFileReader},
    record::Field,
};
use serde_json::{Value, json};

async fn post(server: &EndToEnd, query: &str, body: &Value) -> reqwest::Response {
    let url = format!("{}/api/v1/scenes/demo/skies{query}", server.base);
    server.client.post(url).json(body).send().await.unwrap()
}

async fn lines(answer: reqwest::Response) -> Vec<Value> {
    assert_eq!((answer.status().as_u16(), header(&answer, "content-type")), (200, "application/x-ndjson"));
    let text = answer.text().await.unwrap();
    assert!(text.ends_with('\n'));
    text.lines().map(|line| serde_json::from_str(line).unwrap()).collect()
}

/// Every line is the answer of a single request, in the order of the places; those that fail say why.
#[tokio::test]
async fn many_skies_are_those_of_single_requests() {
    let server = EndToEnd::shared().await;
    let places = json!([
        {"lat": 46.53, "lon": 8.61, "name": "valley"},
        {"lat": 99, "lon": 8.61, "name": "nowhere"},
        {"lat": 46.17, "lon": 8.79, "turbidity": 3.5},
        {"lat": -46.17, "lon": 8.79},
        {"lat": 46.17, "lon": 8.79, "colour": "red"},
    ]);
    let answer = post(&server, "?lamp=hps", &json!({"places": places})).await;
    let lines = lines(answer).await;
    assert_eq!(lines.len(), 5);
    assert!(lines.iter().enumerate().all(|(at, line)| line["place"] == at));
    for (at, query) in [(0, "lat=46.53&lon=8.61&lamp=hps"), (2, "lat=46.17&lon=8.79&lamp=hps&turbidity=3.5")]
    {
        let mut line = lines[at].as_object().unwrap().clone();
        line.remove("place");
        line.remove("name");
        assert_eq!(Value::from(line), server.sky(query).await, "{query}");
    }
    assert_eq!((&lines[0]["name"], &lines[2]["name"]), (&json!("valley"), &Value::Null));
    assert_eq!(lines[1]["error"]["errors"][0]["parameter"], "lat");
    assert!(lines[3]["error"]["detail"].as_str().unwrap().contains("outside the scene"), "{}", lines[3]);
    assert!(lines[4]["error"]["detail"].as_str().unwrap().contains("colour=red"), "{}", lines[4]);
    assert!(lines[1]["sky"].is_null() && lines[0]["error"].is_null());
}

/// Every place at every time, with the natural sky of each.
#[tokio::test]
async fn many_skies_have_their_times() {
    let server = EndToEnd::shared().await;
    let times = ["2026-08-12T22:00:00Z", "2026-08-28T22:00:00Z"];
    let body = json!({"places": [{"lat": 46.53, "lon": 8.61}, {"lat": 46.17, "lon": 8.79}], "times": times});
    let lines = lines(post(&server, "", &body).await).await;
    let seen: Vec<(&Value, &Value)> = lines.iter().map(|line| (&line["place"], &line["time"])).collect();
    let wanted = [(0, times[0]), (0, times[1]), (1, times[0]), (1, times[1])];
    assert_eq!(seen.len(), 4);
    for ((place, time), wanted) in seen.into_iter().zip(wanted) {
        assert_eq!((place, time), (&json!(wanted.0), &json!(wanted.1)));
    }
    let natural = |at: usize| lines[at]["night_sky"]["components"].clone();
    assert_ne!(natural(0), natural(1));
}

/// What is wrong with all of them is refused before a line is sent, and too many are.
#[tokio::test]
async fn bad_batches_get_a_problem() {
    let server = EndToEnd::shared().await;
    let many = json!({"places": vec![json!({"lat": 46, "lon": 8}); 1001]});
    let one = json!({"places": [{"lat": 46, "lon": 8}]});
    for (query, body) in [("", &many), ("?turbidity=99", &one), ("", &json!({"places": []}))] {
        let answer = post(&server, query, body).await;
        assert!([400, 422].contains(&answer.status().as_u16()), "{query}");
        assert_eq!(header(&answer, "content-type"), "application/problem+json");
    }
}

/// The table has the numbers of the lines, and errors where a place has no sky.
#[tokio::test]
async fn many_skies_come_as_a_table() {
    let server = EndToEnd::shared().await;
    let body = json!({"places": [{"lat": 46.53, "lon": 8.61, "name": "Brè"}, {"lat": -46.17, "lon": 8.79}]});
    let url = format!("{}/api/v1/scenes/demo/skies.parquet?turbidity=3", server.base);
    let answer = server.client.post(url).json(&body).send().await.unwrap();
    assert_eq!(
        (answer.status().as_u16(), header(&answer, "content-type")),
        (200, "application/vnd.apache.parquet")
    );
    let table = SerializedFileReader::new(answer.bytes().await.unwrap()).unwrap();
    let rows: Vec<_> = table.get_row_iter(None).unwrap().map(Result::unwrap).collect();
    let field = |row: usize, name: &str| {
        rows[row].get_column_iter().find(|(column, _)| *column == name).map(|(_, field)| field.clone())
    };
    assert_eq!(rows.len(), 2);
    let lines = lines(post(&server, "?turbidity=3", &body).await).await;
    let zenith = lines[0]["sky"]["zenith_luminance_cd_m2"].as_f64().unwrap();
    assert_eq!(field(0, "sky.zenith_luminance_cd_m2"), Some(Field::Double(zenith)));
    assert_eq!(field(0, "name"), Some(Field::Str("Brè".to_owned())));
    assert_eq!(field(1, "sky.zenith_luminance_cd_m2"), Some(Field::Null));
    let why = field(1, "error.detail").unwrap().to_string();
    assert!(why.contains("outside the scene"), "{why}");
    assert_eq!((field(0, "place"), field(1, "place")), (Some(Field::Long(0)), Some(Field::Long(1))));
}
