//! Parameters and bodies of requests.

use skyglow_app::{
    accept::{Format, InfluenceFormat},
    facts::{KindFacts, SourceFacts},
    request::{self, geojson},
};
use skyglow_http::error::ApiError;
use skyglow_observatory::SkyRequest;
use skyglow_physics::GeoPoint;
use skyglow_scene::SceneId;
use skyglow_tables::Scattering;

fn facts() -> SourceFacts {
    let kind = |scattering, ground_albedo| KindFacts {
        unserved: Vec::new(),
        clouds: None,
        scattering,
        turbidity_range: (1.5, 6.0),
        basis_count: 64,
        ground_albedo,
        why_open: None,
        checksums: String::new(),
    };
    SourceFacts {
        executor: "cpu".to_owned(),
        adapter: "none".to_owned(),
        max_places: 1000,
        kinds: vec![kind(Scattering::Single, None), kind(Scattering::Multiple, Some(0.15))],
        any_cloud_albedo: None,
        altitude_range_m: (0.0, 6000.0),
        celestial_turbidity_range: Some((1.5, 6.0)),
        celestial_highest_m: Some(4500.0),
        pack_checksums: "none".to_owned(),
    }
}

#[expect(clippy::panic, reason = "a rule that is broken ends the fuzzer")]
fn scene() -> SceneId {
    SceneId::parse("demo").unwrap_or_else(|error| panic!("{error}"))
}

/// A refusal is the client's fault, names it, and can be written.
#[expect(clippy::panic, reason = "a rule that is broken ends the fuzzer")]
fn check_refusal(error: &ApiError) {
    let problem = error.problem();
    assert!((400..500).contains(&problem.status), "{error} is answered {}", problem.status);
    let text = serde_json::to_string(&problem).unwrap_or_else(|error| panic!("{error}"));
    assert!(text.len() < 100_000, "a refusal of {} bytes", text.len());
}

fn check_place(place: GeoPoint) {
    assert!(place.latitude_deg().abs() <= 90.0 && place.longitude_deg().abs() <= 180.0, "{place:?}");
}

fn check_sky(request: &SkyRequest) {
    check_place(request.place);
    assert!((1.5..=6.0).contains(&request.turbidity.value()), "{request:?}");
    assert!(request.basis.is_none_or(|count| (1..=64).contains(&count)), "{request:?}");
    assert!(
        request.tolerance.is_none_or(|tolerance| tolerance > 0.0 && tolerance.is_finite()),
        "{request:?}"
    );
    assert!(request.observer_height.altitude_m(skyglow_scene::Ground::Unknown).is_finite(), "{request:?}");
    assert!(
        request.lamp.flux_per_dnb_flux().iter().all(|flux| flux.is_finite() && *flux >= 0.0),
        "{request:?}"
    );
}

/// Query strings: the first byte says of which request.
pub fn parameters(bytes: &[u8]) {
    let Some((which, text)) = bytes.split_first() else { return };
    let text = String::from_utf8_lossy(text);
    let (query, facts) = (Some(&*text), facts());
    let checked = match which % 10 {
        0 => request::sky(query, scene(), &facts).map(|request| check_sky(&request)),
        1 => request::panorama(query, scene(), &facts, Format::Png).map(|(request, picture)| {
            check_sky(&request);
            let options = picture.options;
            assert!(options.width_px.max(options.height_px) <= 4096, "{options:?}");
        }),
        2 => request::panorama(query, scene(), &facts, Format::Json).map(|(request, _)| check_sky(&request)),
        3 => request::influence(query, None, scene(), &facts, InfluenceFormat::Json)
            .map(|asked| check_sky(&asked.request.sky)),
        4 => request::influence(query, None, scene(), &facts, InfluenceFormat::Tiff)
            .map(|asked| check_sky(&asked.request.sky)),
        5 => request::brightness(query, scene(), &facts).map(|request| {
            assert!((1.5..=6.0).contains(&request.turbidity.value()), "{request:?}");
        }),
        6 => request::darker(query, scene(), &facts).map(|asked| check_sky(&asked.here)),
        7 => request::horizon(query, &facts).map(|asked| check_place(asked.place)),
        8 => request::place(query).map(|(place, _)| check_place(place)),
        _ => request::scene_id(&text).map(|id| {
            let id = id.as_str();
            assert!(!id.is_empty() && !id.contains(['/', '\\', '.', '\0']), "{id}");
        }),
    };
    if let Err(error) = checked {
        check_refusal(&ApiError::from(error.clone()));
    }
}

/// JSON bodies: the first byte says of which request.
pub fn body(bytes: &[u8]) {
    let Some((which, body)) = bytes.split_first() else { return };
    let facts = facts();
    let place = Some("lat=46.17&lon=8.79");
    let checked = match which % 5 {
        0 => request::scenario(None, body, scene()).map(|(scenario, _)| {
            // What is kept can be written and read again.
            let text = serde_json::to_vec(&scenario).unwrap_or_default();
            let again = serde_json::from_slice::<skyglow_scene::Scenario>(&text);
            assert!(again.is_ok_and(|again| again == scenario), "{scenario:?}");
        }),
        1 => request::plan(None, body, scene(), &facts).map(|asked| {
            let sites = asked.request.sites();
            assert!(!sites.is_empty() && sites.len() <= 64);
            sites.iter().for_each(|site| check_sky(&site.sky));
        }),
        3 => request::skies(None, body, scene(), &facts).map(|asked| {
            assert!((1..=request::MAX_SKIES).contains(&asked.skies.len()));
            asked
                .skies
                .iter()
                .filter_map(|sky| sky.read(scene(), &facts).ok())
                .for_each(|sky| check_sky(&sky));
        }),
        2 => request::area_shares(place, body, scene(), &facts).map(|asked| {
            assert!(!asked.areas.is_empty() && asked.areas.iter().all(|area| !area.name.is_empty()));
        }),
        _ => request::influence(place, Some(body), scene(), &facts, InfluenceFormat::Json)
            .map(|asked| check_sky(&asked.request.sky)),
    };
    if let Err(error) = checked {
        check_refusal(&ApiError::from(error.clone()));
    }
}

/// GeoJSON of areas.
pub fn boundary(bytes: &[u8]) {
    let Ok(body) = serde_json::from_slice::<geojson::BoundaryBody>(bytes) else { return };
    if let Err(error) = geojson::polygons(&body) {
        assert!(!error.to_string().is_empty());
    }
    if let Ok(boundary) = geojson::boundary(&body) {
        for (latitude_deg, longitude_deg) in [(46.17, 8.79), (-90.0, 0.0), (0.0, 180.0)] {
            if let Ok(place) = GeoPoint::from_deg(latitude_deg, longitude_deg) {
                let _inside_or_not = boundary.contains(place);
            }
        }
    }
}
