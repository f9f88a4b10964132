//! The page that a shared link leads to: programs that show previews of links read the place and its picture there (the Open Graph
//! protocol, ogp.me), and browsers go on to the viewer. What a link says of the view stands in its fragment, which no server sees.

use crate::{error::ApiError, trust::PublicAddress};
use axum::{
    Extension,
    body::Body,
    extract::RawQuery,
    http::{HeaderValue, Response, header},
};
use skyglow_physics::GeoPoint;
use skyglow_scene::{Gazetteer, SceneId};

/// Nothing runs there and nothing is loaded.
const POLICY: &str = "default-src 'none'; base-uri 'none'; form-action 'none'; frame-ancestors 'none'";
/// Shape that previews have room for, pixels.
const PICTURE_PX: (u32, u32) = (1200, 630);
/// Directions, from north eastwards.
const COMPASS: [&str; 16] =
    ["N", "NNE", "NE", "ENE", "E", "ESE", "SE", "SSE", "S", "SSW", "SW", "WSW", "W", "WNW", "NW", "NNW"];
/// Longer views are no view.
const MAX_VIEW_BYTES: usize = 4096;

/// The place of a shared view, for previews, and the way to it.
pub async fn get_link(
    Extension(address): Extension<PublicAddress>,
    RawQuery(view): RawQuery,
) -> Result<Response<Body>, ApiError> {
    let view = view.filter(|view| view.len() <= MAX_VIEW_BYTES).unwrap_or_default();
    let mut response = Response::new(Body::from(page(&view, &address.base())));
    let headers = response.headers_mut();
    headers.insert(header::CONTENT_TYPE, HeaderValue::from_static("text/html; charset=utf-8"));
    headers.insert(header::CONTENT_SECURITY_POLICY, HeaderValue::from_static(POLICY));
    headers.insert(header::CACHE_CONTROL, HeaderValue::from_static("public, max-age=600"));
    Ok(response)
}

/// The value of a name in a view, as it stands there.
fn value<'a>(view: &'a str, name: &str) -> Option<&'a str> {
    view.split('&')
        .filter_map(|pair| pair.split_once('='))
        .find(|(key, _)| *key == name)
        .map(|(_, value)| value)
}

/// The address of a picture of the view's place after the server's own; None where it names none.
fn picture_path(view: &str) -> Option<(String, f64, f64)> {
    let scene = SceneId::parse(value(view, "scene")?).ok()?;
    let number = |name: &str, most: f64| {
        let number: f64 = value(view, name)?.parse().ok()?;
        (number.abs() <= most).then_some(number)
    };
    let (lat, lon) = (number("lat", 90.0)?, number("lon", 180.0)?);
    // Where the view looks, else where the link says that it is brightest, else south.
    let gaze = value(view, "look").and_then(|look| look.split('/').next()?.split("%2F").next()?.parse().ok());
    let gaze = gaze.filter(|azimuth_deg: &f64| azimuth_deg.abs() <= 360.0);
    let towards = gaze.or_else(|| number("towards", 360.0)).unwrap_or(180.0);
    let (width_px, height_px) = PICTURE_PX;
    let mut path = format!(
        "/api/v1/scenes/{scene}/panorama.png?lat={lat}&lon={lon}&style=eye&projection=perspective&azimuth={towards}\
         &elevation=24&fov=90&legend=off&width={width_px}&height_px={height_px}"
    );
    // As they stand in links; the picture's address refuses what is none.
    let plain = |text: &&str| text.bytes().all(|byte| byte.is_ascii_alphanumeric() || b":-%".contains(&byte));
    for name in ["time", "scenario"] {
        if let Some(text) = value(view, name).filter(plain) {
            path.push_str(&format!("&{name}={text}"));
        }
    }
    Some((path, lat, lon))
}

fn page(view: &str, base: &str) -> String {
    let viewer = escaped(&format!("./#{view}"));
    let picture = picture_path(view);
    let title = picture.as_ref().map_or_else(
        || "Skyglow".to_owned(),
        |(_, lat, lon)| escaped(&format!("The night sky {} – Skyglow", whereabouts(*lat, *lon))),
    );
    let at =
        picture.as_ref().map_or_else(String::new, |(_, lat, lon)| format!("{}. ", coordinates(*lat, *lon)));
    let shown = picture.filter(|_| !base.is_empty()).map_or_else(String::new, |(path, ..)| {
        let (width_px, height_px) = PICTURE_PX;
        format!(
            "<meta property=\"og:image\" content=\"{}\"><meta property=\"og:image:type\" content=\"image/png\">\n\
             <meta property=\"og:image:width\" content=\"{width_px}\"><meta property=\"og:image:height\" content=\"{height_px}\">\n\
             <meta name=\"twitter:card\" content=\"summary_large_image\">\n",
            escaped(&format!("{base}{path}"))
        )
    });
    format!(
        "<!doctype html>\n<html lang=\"en\"><meta charset=\"utf-8\"><title>{title}</title>\n\
         <meta name=\"robots\" content=\"noindex\"><meta property=\"og:type\" content=\"website\">\
         <meta property=\"og:site_name\" content=\"Skyglow\">\n\
         <meta property=\"og:title\" content=\"{title}\">\n\
         <meta property=\"og:description\" content=\"{at}How dark it is, whose light it is, and what would help.\">\n\
         {shown}<meta http-equiv=\"refresh\" content=\"0; url={viewer}\">\n<p><a href=\"{viewer}\">Skyglow</a></p></html>\n"
    )
}

/// The place in words: its name, how far it is from a named one, or its coordinates.
fn whereabouts(lat: f64, lon: f64) -> String {
    const SAME_M: f64 = 1_500.0;
    let named = GeoPoint::from_deg(lat, lon).ok().and_then(|at| Gazetteer::world().nearest(at));
    match named {
        None => format!("at {}", coordinates(lat, lon)),
        Some((place, bearing)) if bearing.distance_m < SAME_M => format!("over {}", place.name),
        Some((place, bearing)) => {
            let [km, towards] = [1e-3 * bearing.distance_m, bearing.azimuth_rad.to_degrees() / 22.5];
            format!("{km:.0} km {} of {}", COMPASS[towards.round() as usize % 16], place.name)
        }
    }
}

/// Degrees with their side of the equator and of Greenwich.
fn coordinates(lat: f64, lon: f64) -> String {
    let side = |degrees: f64, [positive, negative]: [&str; 2]| {
        format!("{:.4}° {}", degrees.abs(), if degrees < 0.0 { negative } else { positive })
    };
    format!("{}, {}", side(lat, ["N", "S"]), side(lon, ["E", "W"]))
}

fn escaped(text: &str) -> String {
    let mut safe = String::with_capacity(text.len());
    for sign in text.chars() {
        match sign {
            '&' => safe.push_str("&amp;"),
            '<' => safe.push_str("&lt;"),
            '>' => safe.push_str("&gt;"),
            '"' => safe.push_str("&quot;"),
            '\'' => safe.push_str("&#39;"),
            _ => safe.push(sign),
        }
    }
    safe
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The preview's picture is of the view's place, time and lights, by an address that stands alone.
    #[test]
    fn a_link_names_place_and_picture() {
        let view = "scene=demo&lat=46.17&lon=-8.79&time=2026-08-12T22%3A30Z&scenario=s-0123456789abcdef0123&towards=210";
        let page = super::page(view, "https://sky.example.org/glow");
        assert!(page.contains("The night sky at 46.1700° N, 8.7900° W – Skyglow"), "{page}");
        for (place, words) in
            [("lat=-1.2833&lon=36.8167", "over Nairobi"), ("lat=46.1785&lon=8.7", "km WSW of Verscio")]
        {
            let page = super::page(&format!("scene=x&{place}"), "https://sky.example.org");
            let title = page.split("og:title").nth(1).unwrap();
            assert!(title.split("og:").next().unwrap().contains(words), "{page}");
        }
        let image = "content=\"https://sky.example.org/glow/api/v1/scenes/demo/panorama.png?lat=46.17&amp;lon=-8.79&amp;";
        assert!(page.contains(image), "{page}");
        for part in ["azimuth=210", "time=2026-08-12T22%3A30Z", "scenario=s-0123456789abcdef0123"] {
            assert!(page.split("og:image").nth(1).unwrap().contains(part), "{part}: {page}");
        }
        assert!(page.contains("url=./#scene=demo&amp;lat=46.17"), "{page}");
        for look in ["30.5/22/58", "30.5%2F22%2F58"] {
            let (path, ..) = picture_path(&format!("{view}&look={look}")).unwrap();
            assert!(path.contains("&azimuth=30.5&"), "{path}");
        }
    }

    /// What is no place has no picture, and nothing of a link is read as a page.
    #[test]
    fn a_hostile_link_is_only_text() {
        for view in [
            "",
            "scene=demo",
            "scene=../x&lat=1&lon=2",
            "scene=demo&lat=91&lon=2",
            "scene=demo&lat=nan&lon=2",
        ] {
            assert!(!page(view, "http://h").contains("og:image"), "{view}");
        }
        let page = super::page("scene=demo&lat=1&lon=2&time=\"><script>&scenario='x", "http://h");
        assert!(!page.contains("<script>") && !page.contains("'x") && page.contains("og:image"), "{page}");
    }
}
