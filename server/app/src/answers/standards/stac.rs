//! The scenes as a SpatioTemporal Asset Catalog (STAC 1.1.0): a collection each, with an item for each layer that is a file.

use super::base::{Base, GEO_JSON, JSON, PNG, description, link};
use serde_json::{Value, json};
use skyglow_celestial::Instant;
use skyglow_scene::{PlaceLattice, SceneMetadata};

/// Pixels of a layer as a file, which is more than a tile of Black Marble has by far; beyond, pixels of the scene share one by
/// blocks, and the band's description says so.
pub const MAX_LAYER_PIXELS: usize = 32_000_000;

const VERSION: &str = "1.1.0";
const COG: &str = "image/tiff; application=geotiff; profile=cloud-optimized";
const PROJECTION: &str = "https://stac-extensions.github.io/projection/v2.0.0/schema.json";
const RASTER: &str = "https://stac-extensions.github.io/raster/v2.0.0/schema.json";

/// A layer that is a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum StacItem {
    /// The raster of radiances.
    Radiance,
    /// The terrain.
    Elevation,
    /// The brightness of the zenith.
    Brightness,
}

impl StacItem {
    const ALL: [Self; 3] = [Self::Radiance, Self::Elevation, Self::Brightness];

    /// The layer of an id that a scene has.
    pub fn of_id(id: &str, scene: &SceneMetadata) -> Option<Self> {
        Self::of(scene).find(|item| item.id() == id)
    }

    fn of(scene: &SceneMetadata) -> impl Iterator<Item = Self> + use<> {
        let terrain = scene.terrain;
        Self::ALL.into_iter().filter(move |item| terrain || *item != Self::Elevation)
    }

    fn id(self) -> &'static str {
        match self {
            Self::Radiance => "radiance",
            Self::Elevation => "elevation",
            Self::Brightness => "brightness",
        }
    }

    /// What it is, in words, and its unit.
    fn words(self) -> (&'static str, &'static str) {
        match self {
            Self::Radiance => ("Upward radiance", "nW cm-2 sr-1"),
            Self::Elevation => ("Terrain elevation", "m"),
            Self::Brightness => ("Artificial luminance at the zenith", "cd m-2"),
        }
    }
}

/// The catalogue.
pub fn stac_catalog(base: &Base, scenes: &[SceneMetadata]) -> Value {
    let root = base.stac("");
    let child = |scene: &SceneMetadata| {
        link(&base.stac(&format!("/collections/{}", scene.id)), "child", JSON, &scene.title)
    };
    let links = [link(&root, "self", JSON, "Skyglow"), link(&root, "root", JSON, "Skyglow")];
    json!({
        "type": "Catalog", "stac_version": VERSION, "id": "skyglow", "title": "Skyglow",
        "description": "Scenes of light pollution with their layers as files.",
        "links": links.into_iter().chain(scenes.iter().map(child)).collect::<Vec<_>>(),
    })
}

/// A scene as a collection.
///
/// * `stored_unix_s`: when the scene was stored, for what has no date of its own.
pub fn stac_collection(base: &Base, scene: &SceneMetadata, stored_unix_s: Option<u64>) -> Value {
    let path = base.stac(&format!("/collections/{}", scene.id));
    let interval = match (interval(scene), stored_unix_s.and_then(instant)) {
        (Some([first, last]), _) => [Some(first), Some(last)],
        (None, Some(stored)) => [Some(stored.clone()), Some(stored)],
        (None, None) => [None, None],
    };
    let item =
        |item: StacItem| link(&format!("{path}/items/{}", item.id()), "item", GEO_JSON, item.words().0);
    let root = base.stac("");
    let links = [
        link(&path, "self", JSON, &scene.title),
        link(&root, "root", JSON, "Skyglow"),
        link(&root, "parent", JSON, "Skyglow"),
        link(
            &base.ogc(&format!("/collections/{}", scene.id)),
            "alternate",
            JSON,
            "The same scene for OGC APIs",
        ),
    ];
    let mut collection = json!({
        "type": "Collection", "stac_version": VERSION, "id": scene.id.as_str(), "title": scene.title,
        "description": description(scene), "license": "other", "keywords": ["light pollution", "night lights"],
        "extent": {"spatial": {"bbox": [scene.bounds]}, "temporal": {"interval": [interval]}},
        "links": links.into_iter().chain(StacItem::of(scene).map(item)).collect::<Vec<_>>(),
    });
    if let Some(whom) = &scene.attribution {
        collection["providers"] = json!([{"name": whom, "roles": ["producer"]}]);
    }
    collection
}

/// A layer as an item; None where nothing says when it is of.
///
/// * `stored_unix_s`: as in [`stac_collection`].
pub fn stac_item(
    base: &Base,
    scene: &SceneMetadata,
    item: StacItem,
    stored_unix_s: Option<u64>,
) -> Option<Value> {
    let collection = base.stac(&format!("/collections/{}", scene.id));
    let (title, unit) = item.words();
    let pixels = PlaceLattice::within(scene.grid.width, scene.grid.height, MAX_LAYER_PIXELS);
    let step = f64::from(pixels.step);
    let [x, x_column, x_row, y, y_column, y_row] = scene.grid.geotransform;
    let mut properties = json!({
        "title": format!("{}: {title}", scene.title), "description": description(scene),
        "proj:code": epsg(&scene.grid.crs_wkt).map(|code| format!("EPSG:{code}")),
        "proj:shape": [pixels.rows, pixels.columns],
        "proj:transform": [x_column * step, x_row * step, x, y_column * step, y_row * step, y],
    });
    match (interval(scene), stored_unix_s.and_then(instant)) {
        (Some([first, last]), _) if first == last => properties["datetime"] = json!(first),
        (Some([first, last]), _) => {
            properties["datetime"] = Value::Null;
            properties["start_datetime"] = json!(first);
            properties["end_datetime"] = json!(last);
        }
        (None, Some(stored)) => {
            properties["datetime"] = json!(stored);
            let words = format!(
                "{} The light has no date: the time is when the scene was stored.",
                description(scene)
            );
            properties["description"] = json!(words);
        }
        (None, None) => return None,
    }
    let asset = json!({
        "href": base.api(&format!("/v1/scenes/{}/layers/{}.tif", scene.id, item.id())), "type": COG, "title": title,
        "roles": ["data"], "data_type": "float32", "nodata": "nan", "unit": unit,
        "raster:spatial_resolution": scene.pixel_size_m * step, "raster:sampling": "area",
    });
    let mut assets = json!({ item.id(): asset });
    if item == StacItem::Brightness {
        let map = base.ogc(&format!("/collections/{}/map?width=512", scene.id));
        assets["thumbnail"] = json!({"href": map, "type": PNG, "title": "A map", "roles": ["thumbnail"]});
    }
    let path = format!("{collection}/items/{}", item.id());
    Some(json!({
        "type": "Feature", "stac_version": VERSION, "stac_extensions": [PROJECTION, RASTER],
        "id": format!("{}-{}", scene.id, item.id()), "collection": scene.id.as_str(),
        "geometry": geometry(scene.bounds), "bbox": scene.bounds, "properties": properties, "assets": assets,
        "links": [
            link(&path, "self", GEO_JSON, title),
            link(&base.stac(""), "root", JSON, "Skyglow"),
            link(&collection, "parent", JSON, &scene.title),
            link(&collection, "collection", JSON, &scene.title),
        ],
    }))
}

/// A box as GeoJSON, cut at the antimeridian (RFC 7946, 3.1.9).
fn geometry([west, south, east, north]: [f64; 4]) -> Value {
    let ring = |west: f64, east: f64| {
        json!([[[west, south], [east, south], [east, north], [west, north], [west, south]]])
    };
    match west > east {
        false => json!({"type": "Polygon", "coordinates": ring(west, east)}),
        true => json!({"type": "MultiPolygon", "coordinates": [ring(west, 180.0), ring(-180.0, east)]}),
    }
}

/// The code of a system of coordinates in EPSG's register, where its Well-Known Text ends with one.
fn epsg(wkt: &str) -> Option<u32> {
    let end = wkt.trim_end().strip_suffix("]]")?;
    let (_, code) = end.rsplit_once("\"EPSG\",")?;
    code.trim_matches('"').parse().ok()
}

/// The first and the last instant of the scene's date.
fn interval(scene: &SceneMetadata) -> Option<[String; 2]> {
    let date = scene.date.as_deref()?;
    let (first, last) = date.split_once('/').unwrap_or((date, date));
    Some([edge(first, false)?, edge(last, true)?])
}

/// The first or the last second of a year, a month, a day or an instant.
fn edge(text: &str, is_end: bool) -> Option<String> {
    if text.contains('T') {
        return Instant::parse(text).ok().map(Instant::to_rfc3339);
    }
    let numbers: Option<Vec<i32>> = text.split('-').map(|part| part.parse().ok()).collect();
    let numbers = numbers?;
    let (year, month, day) = (*numbers.first()?, numbers.get(1).copied(), numbers.get(2).copied());
    let start = |year: i32, month: i32| format!("{year:04}-{month:02}-01T00:00:00Z");
    if !is_end {
        let text = format!("{year:04}-{:02}-{:02}T00:00:00Z", month.unwrap_or(1), day.unwrap_or(1));
        return Instant::parse(&text).ok().map(Instant::to_rfc3339);
    }
    let (next, seconds) = match (month, day) {
        (Some(month), Some(day)) => (format!("{year:04}-{month:02}-{day:02}T00:00:00Z"), 86_399.0),
        (Some(12) | None, _) => (start(year + 1, 1), -1.0),
        (Some(month), None) => (start(year, month + 1), -1.0),
    };
    let instant = Instant::parse(&next).ok()?;
    Some(instant.plus_s(seconds).to_rfc3339())
}

fn instant(unix_s: u64) -> Option<String> {
    Instant::from_unix_s(unix_s as f64).ok().map(Instant::to_rfc3339)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn dates_are_spans_of_time() {
        for (text, first, last) in [
            ("2023", "2023-01-01T00:00:00Z", "2023-12-31T23:59:59Z"),
            ("2024-02", "2024-02-01T00:00:00Z", "2024-02-29T23:59:59Z"),
            ("2023-12", "2023-12-01T00:00:00Z", "2023-12-31T23:59:59Z"),
            ("2023-05-17", "2023-05-17T00:00:00Z", "2023-05-17T23:59:59Z"),
            ("2023-05-17T01:30:00Z", "2023-05-17T01:30:00Z", "2023-05-17T01:30:00Z"),
        ] {
            assert_eq!(
                (edge(text, false).as_deref(), edge(text, true).as_deref()),
                (Some(first), Some(last)),
                "{text}"
            );
        }
        assert_eq!(edge("unknown", false), None);
    }

    #[test]
    fn the_code_is_that_at_the_end() {
        assert_eq!(
            epsg(
                "GEOGCS[\"WGS 84\",UNIT[\"degree\",0.017,AUTHORITY[\"EPSG\",\"9122\"]],AUTHORITY[\"EPSG\",\"4326\"]]"
            ),
            Some(4326)
        );
        assert_eq!(epsg("PROJCRS[\"x\",ID[\"EPSG\",32632]]"), Some(32632));
        assert_eq!(epsg("GEOGCS[\"WGS 84\"]"), None);
    }

    #[test]
    fn a_box_is_cut_at_the_antimeridian() {
        let cut = geometry([176.0, -20.0, -178.0, -15.0]);
        assert_eq!((&cut["type"], cut["coordinates"].as_array().unwrap().len()), (&json!("MultiPolygon"), 2));
        assert_eq!(cut["coordinates"][0][0][1][0], json!(180.0));
    }
}
