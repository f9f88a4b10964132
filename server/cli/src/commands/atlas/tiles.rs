//! Map tiles in a PMTiles archive.

use super::found::{Found, MapLayer};
use crate::{failure::Failure, progress::Stages};
use pmtiles::{PmTilesWriter, TileCoord, TileId, TileType};
use skyglow_app::fingerprint::{ATLAS_EXTENT, ATLAS_KEY, ATLAS_QUERY, ATLAS_STEP};
use skyglow_display::{
    Notes, notes,
    tile::{brightness_tile_png, elevation_tile_png, radiance_tile_png},
};
use skyglow_scene::{PlaceValues, Scene, tile_column, tile_pixel_m, tile_row, zoom_0_pixel_m};
use std::{fs::File, path::Path};

/// Pixels a side.
const TILE_PX: u32 = 256;

/// The zoom level at which a tile's pixel is no larger than the way between places; 14 at most.
pub(super) fn deepest_zoom(scene: &Scene, places: &PlaceValues) -> u8 {
    let metadata = scene.metadata();
    let [_, south, _, north] = metadata.bounds;
    let shrunk = (0.5 * (south + north)).to_radians().cos().max(0.05);
    let step_m = metadata.pixel_size_m.max(1.0) * f64::from(places.lattice().step);
    (zoom_0_pixel_m() * shrunk / step_m).log2().ceil().clamp(0.0, 14.0) as u8
}

/// Writes the tiles of a layer down to a zoom level; those that show nothing are left out.
pub(super) fn write(
    path: &Path,
    layer: MapLayer,
    found: &Found,
    deepest: u8,
    stages: &Stages,
) -> Result<(), Failure> {
    let metadata = found.scene.metadata();
    let [west, south, east, north] = metadata.bounds;
    let description =
        notes::description(format!("{}, {}", found.description, found.unit), metadata.illustrative);
    // Across the antimeridian all longitudes are there.
    let (first_deg, last_deg) = if west > east { (-180.0, 180.0) } else { (west, east) };
    let mut document = serde_json::json!({
        "name": format!("{}: {}", metadata.title, found.description),
        "description": description,
        "attribution": metadata.attribution,
        "assumptions": found.assumptions,
        "scene": metadata.id,
        "scene_version": metadata.version,
    });
    // Without its last zooms a server would show it coarser than it is.
    let whole = deepest_zoom(&found.scene, &found.places);
    match &found.asked {
        Some([key, query]) if deepest >= whole => {
            document[ATLAS_KEY] = key.as_str().into();
            document[ATLAS_QUERY] = query.as_str().into();
            document[ATLAS_STEP] = found.places.lattice().step.into();
            let zooms = [0.0, f64::from(deepest)];
            document[ATLAS_EXTENT] = [[first_deg, south, last_deg, north].as_slice(), &zooms].concat().into();
        }
        Some(_) => {
            tracing::warn!("servers do not show it in place of their own: its places want zoom {whole}")
        }
        None => {}
    }
    let unfinished = path.with_extension("unfinished");
    let failure = |error: std::io::Error| Failure::file(path, error);
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
        for x in tile_column(first_deg, z)..=tile_column(last_deg, z) {
            let rows = tile_row(north, z)..=tile_row(south, z);
            let in_column: Result<Vec<TileCoord>, _> = rows.map(|y| TileCoord::new(z, x, y)).collect();
            coordinates.extend(in_column.map_err(Failure::work)?);
        }
    }
    // Along the Hilbert curve of each zoom level: only archives in this order (clustered) can be extracted from.
    coordinates.sort_by_key(|&place| TileId::from(place).value());
    stages.begin("map tiles", coordinates.len() as u64);
    let notes = Notes::new(&description, "");
    for place in coordinates {
        let (z, x, y) = (place.z(), place.x(), place.y());
        let tile = found.scene.places_tile(&found.places, z, x, y, TILE_PX).map_err(Failure::work)?;
        stages.advance(1);
        if !tile.has_data.contains(&true) {
            continue;
        }
        let png = match layer {
            MapLayer::Brightness => {
                brightness_tile_png(&tile.values, &tile.has_data, TILE_PX, found.colour_range, &notes)
            }
            MapLayer::Radiance => radiance_tile_png(&tile.values, &tile.has_data, TILE_PX, &notes),
            MapLayer::Elevation => {
                let pixel_m = tile_pixel_m(z, y, TILE_PX);
                elevation_tile_png(&tile.values, &tile.has_data, TILE_PX, pixel_m, &notes)
            }
        };
        archive.add_tile(place, &png.map_err(Failure::work)?).map_err(Failure::work)?;
    }
    archive.finalize().map_err(Failure::work)?;
    std::fs::rename(&unfinished, path).map_err(failure)
}
