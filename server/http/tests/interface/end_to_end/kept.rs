//! Whose scenarios and plans are, who sees them in lists, and who removes them.

use super::{EndToEnd, KEY, TOKEN, Town, entry};
use crate::server::header;
use reqwest::{Method, Response};
use serde_json::{Value, json};

const LIST: &str = "/api/v1/scenes/demo/scenarios";

/// A brush stroke over the town.
fn stroke(town: &Town, title: &str) -> Value {
    let brush = json!({"points": [[town.longitude_deg, town.latitude_deg]], "radius_m": 900});
    json!({"title": title, "edits": [{"brush": brush, "factor": 0.5}]})
}

impl EndToEnd {
    /// Sends a request with one header, and a body where it is a POST.
    async fn send(&self, method: Method, path: &str, (name, value): (&str, &str), body: &Value) -> Response {
        let request = self.client.request(method.clone(), format!("{}{path}", self.base));
        let request = if name.is_empty() { request } else { request.header(name, value) };
        let request = if method == Method::POST { request.json(body) } else { request };
        request.send().await.unwrap()
    }

    async fn remove(&self, path: &str, header: (&str, &str)) -> (u16, String) {
        let answer = self.send(Method::DELETE, path, header, &Value::Null).await;
        let status = answer.status().as_u16();
        let problem: Value = answer.json().await.unwrap_or_default();
        (status, problem["type"].as_str().unwrap_or_default().to_owned())
    }

    async fn is_listed(&self, header: (&str, &str), id: &Value) -> bool {
        let list = self.send(Method::GET, LIST, header, &Value::Null).await;
        entry(&list.json().await.unwrap(), id).is_some()
    }
}

/// What is not listed is seen and removed by whoever has the secret that was handed out.
#[tokio::test]
async fn a_secret_lists_and_removes() {
    let server = EndToEnd::shared().await;
    let body = stroke(&server.town().await, "not listed");
    let path = format!("{LIST}?listed=off");
    let answer = server.send(Method::POST, &path, ("", ""), &body).await;
    assert_eq!(answer.status(), 201);
    let secret = header(&answer, "skyglow-owner").to_owned();
    assert!(secret.len() == 32 && secret.bytes().all(|byte| byte.is_ascii_hexdigit()), "{secret}");
    let mine = ("skyglow-owner", secret.as_str());
    let id = answer.json::<Value>().await.unwrap()["id"].clone();
    let own = format!("/api/v1/scenarios/{}", id.as_str().unwrap());

    // The same of the same owner is the same; of nobody it is another's.
    let again = server.send(Method::POST, &path, mine, &body).await;
    assert!(again.headers().get("skyglow-owner").is_none());
    assert_eq!(again.json::<Value>().await.unwrap()["id"], id);
    let other = server.send(Method::POST, &path, ("", ""), &body).await;
    let other_secret = header(&other, "skyglow-owner").to_owned();
    assert_ne!(other.json::<Value>().await.unwrap()["id"], id);

    let yours = ("skyglow-owner", other_secret.as_str());
    for (header, sees) in [(("", ""), false), (yours, false), (mine, true), (("x-api-key", TOKEN), true)] {
        assert_eq!(server.is_listed(header, &id).await, sees, "{header:?}");
    }
    let list = server.send(Method::GET, LIST, mine, &Value::Null).await;
    assert_eq!(header(&list, "cache-control"), "private, no-cache");
    assert_eq!(server.get(&own).await.status(), 200, "who knows the id reads it");

    for (header, refused, problem) in [
        (("", ""), 401, "/problems/unauthorized"),
        (("skyglow-owner", "guess"), 400, "/problems/bad-parameters"),
        (yours, 403, "/problems/not-owner"),
        (("x-api-key", KEY), 403, "/problems/not-owner"),
    ] {
        assert_eq!(server.remove(&own, header).await, (refused, problem.to_owned()), "{header:?}");
    }
    let as_plan = own.replace("scenarios/s-", "plans/s-");
    assert_eq!(server.remove(&as_plan, mine).await.0, 404);
    assert_eq!(server.remove(&own, mine).await, (204, String::new()));
    assert_eq!((server.get(&own).await.status().as_u16(), server.remove(&own, mine).await.0), (404, 404));
    assert!(!server.is_listed(mine, &id).await);
}

/// Keys own what they have kept and may pin it; the operator removes what he likes.
#[tokio::test]
async fn keys_pin_and_the_operator_removes() {
    let server = EndToEnd::shared().await;
    let body = stroke(&server.town().await, "pinned");
    let path = format!("{LIST}?pinned=on");
    let key = ("x-api-key", KEY);
    let refused = server.send(Method::POST, &path, ("", ""), &body).await;
    assert_eq!((refused.status().as_u16(), header(&refused, "location")), (403, ""));
    assert_eq!(refused.json::<Value>().await.unwrap()["type"], "/problems/keys-only");
    let pinned = server.send(Method::POST, &path, key, &body).await;
    assert_eq!((pinned.status().as_u16(), header(&pinned, "skyglow-owner")), (201, ""));
    let own = header(&pinned, "location").to_owned();
    // Keeping the same again makes nobody else its owner.
    let again = server.send(Method::POST, LIST, ("", ""), &body).await;
    assert_eq!((header(&again, "location"), header(&again, "skyglow-owner")), (own.as_str(), ""));
    assert_eq!(server.remove(&own, key).await.0, 204);

    let other = server.send(Method::POST, LIST, ("", ""), &stroke(&server.town().await, "nobody's")).await;
    assert_eq!(server.remove(header(&other, "location"), ("x-api-key", TOKEN)).await.0, 204);
}

/// A list comes in parts, each with the address of the next.
#[tokio::test]
async fn lists_come_in_parts() {
    let server = EndToEnd::shared().await;
    let town = server.town().await;
    let mut wanted = Vec::new();
    for number in 0..5 {
        let (_, scenario) = server.post("scenarios", &stroke(&town, &format!("part {number}"))).await;
        wanted.insert(0, scenario["id"].clone());
    }
    let (mut found, mut next) = (Vec::new(), format!("{}{LIST}?limit=2", server.base));
    loop {
        let answer = server.client.get(&next).send().await.unwrap();
        let link = header(&answer, "link").to_owned();
        let part: Vec<Value> = answer.json().await.unwrap();
        assert!(part.len() == 2 || link.is_empty() && part.len() < 2, "{link}");
        found.extend(part.into_iter().map(|entry| entry["id"].clone()).filter(|id| wanted.contains(id)));
        match link.strip_prefix('<').and_then(|link| link.strip_suffix(">; rel=\"next\"")) {
            Some(address) => next = address.to_owned(),
            None => break,
        }
    }
    assert_eq!(found, wanted);
    assert_eq!(server.get(&format!("{LIST}?after=x")).await.status(), 400);
    assert_eq!(server.get(&format!("{LIST}?limit=1000")).await.headers().get("link"), None);
}
