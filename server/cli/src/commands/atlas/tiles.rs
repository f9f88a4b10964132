//! Map tiles in a PMTiles archive.

use super::{Found, Layer};
use crate::{failure::Failure, progress::Stages};
use pmtiles::{PmTilesWriter, TileCoord, TileType};
use skyglow_display::{
    Notes,
    notes::ILLUSTRATIVE,
    tile::{brightness_tile_png, elevation_tile_png, radiance_tile_png},
};
use skyglow_scene::{PlaceValues, Scene};
use std::{
    f64::consts::{PI, TAU},
    fs::File,
    path::Path,
};

/// Pixels a side.
const TILE_PX: u32 = 256;
/// Ground size of a pixel of zoom level 0 on the equator, metres.
const PIXEL_0_M: f64 = TAU * skyglow_physics::EARTH_RADIUS_M / 256.0;

/// The zoom level at which a tile's pixel is no larger than the way between places; 14 at most.
pub(super) fn deepest_zoom(scene: &Scene, places: &PlaceValues) -> u8 {
    let metadata = scene.metadata();
    let [_, south, _, north] = metadata.bounds;
    let shrunk = (0.5 * (south + north)).to_radians().cos().max(0.05);
    let step_m = metadata.pixel_size_m.max(1.0) * f64::from(places.lattice().step);
    (PIXEL_0_M * shrunk / step_m).log2().ceil().clamp(0.0, 14.0) as u8
}

/// Writes the tiles of a layer down to a zoom level; those that show nothing are left out.
pub(super) fn write(
    path: &Path,
    layer: Layer,
    found: &Found,
    deepest: u8,
    stages: &Stages,
) -> Result<(), Failure> {
    let metadata = found.scene.metadata();
    let [west, south, east, north] = metadata.bounds;
    let illustrative = if metadata.illustrative { format!("; {ILLUSTRATIVE}") } else { String::new() };
    let description = format!("{}, {}{illustrative}", found.description, found.unit);
    let document = serde_json::json!({
        "name": format!("{}: {}", metadata.title, found.description),
        "description": description,
        "attribution": metadata.attribution,
        "assumptions": found.assumptions,
    });
    let unfinished = path.with_extension("unfinished");
    let failure = |error: std::io::Error| Failure::file(path, error);
    // Across the antimeridian all longitudes are there.
    let (first_deg, last_deg) = if west > east { (-180.0, 180.0) } else { (west, east) };
    let file = File::create(&unfinished).map_err(failure)?;
    let mut archive = PmTilesWriter::new(TileType::Png)
        .metadata(document.to_string())
        .bounds(first_deg, south, last_deg, north)
        .min_zoom(0)
        .max_zoom(deepest)
        .center(0.5 * (first_deg + last_deg), 0.5 * (south + north))
        .center_zoom(deepest / 2)
        .create(file)
        .map_err(Failure::work)?;
    let mut coordinates = Vec::new();
    for z in 0..=deepest {
        let count = f64::from(z).exp2();
        let last = count as u32 - 1;
        let column = |longitude_deg: f64| (((longitude_deg + 180.0) / 360.0 * count) as u32).min(last);
        let row = |latitude_deg: f64| {
            let mercator = latitude_deg.clamp(-85.05, 85.05).to_radians().tan().asinh();
            (((1.0 - mercator / PI) / 2.0 * count) as u32).min(last)
        };
        for x in column(first_deg)..=column(last_deg) {
            coordinates.extend((row(north)..=row(south)).map(|y| (z, x, y)));
        }
    }
    stages.begin("map tiles", coordinates.len() as u64);
    let notes = Notes::new(&description, "");
    for (z, x, y) in coordinates {
        let tile = found.scene.places_tile(&found.places, z, x, y, TILE_PX).map_err(Failure::work)?;
        stages.advance(1);
        if !tile.has_data.contains(&true) {
            continue;
        }
        let png = match layer {
            Layer::Brightness => brightness_tile_png(&tile.values, &tile.has_data, TILE_PX, &notes),
            Layer::Radiance => radiance_tile_png(&tile.values, &tile.has_data, TILE_PX, &notes),
            Layer::Elevation => {
                let rows = f64::from(z).exp2();
                let pixel_m = PIXEL_0_M / rows / (PI * (1.0 - 2.0 * (f64::from(y) + 0.5) / rows)).cosh();
                elevation_tile_png(&tile.values, &tile.has_data, TILE_PX, pixel_m, &notes)
            }
        };
        let place = TileCoord::new(z, x, y).map_err(Failure::work)?;
        archive.add_tile(place, &png.map_err(Failure::work)?).map_err(Failure::work)?;
    }
    archive.finalize().map_err(Failure::work)?;
    std::fs::rename(&unfinished, path).map_err(failure)
}
