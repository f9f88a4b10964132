//! Times of ingest, opening, polar grids and tiles of a raster.

use crate::arguments::Outcome;
use skyglow_physics::GeoPoint;
use skyglow_scene::{IngestOptions, SceneStore, TileLayer, ingest};
use std::{path::PathBuf, time::Instant};

/// Measures ingest, opening, polar grids and tiles of a raster.
#[derive(Debug, clap::Args)]
pub(crate) struct Arguments {
    /// Raster of radiances.
    radiance: PathBuf,
    /// Degrees north.
    latitude_deg: f64,
    /// Degrees east.
    longitude_deg: f64,
    /// Rasters of altitudes.
    terrain: Vec<PathBuf>,
}

pub(crate) fn run(Arguments { radiance, latitude_deg, longitude_deg, terrain }: &Arguments) -> Outcome {
    let place = GeoPoint::from_deg(*latitude_deg, *longitude_deg)?;
    let dir = tempfile::tempdir()?;
    let store = SceneStore::new(dir.path());
    let options = IngestOptions { terrain: terrain.clone(), ..IngestOptions::new(radiance) };
    let start = Instant::now();
    let mut stage = (None, start);
    let metadata = ingest(&store, &options, &mut |progress| {
        if stage.0 != Some(progress.stage) {
            println!("  {:?} after {:.2} s", stage.0, stage.1.elapsed().as_secs_f64());
            stage = (Some(progress.stage), Instant::now());
        }
    })?;
    println!("ingest {:.3} s", start.elapsed().as_secs_f64());
    println!("{}", serde_json::to_string_pretty(&metadata)?);
    for entry in std::fs::read_dir(store.scenes_dir().join(metadata.id.as_str()))? {
        let entry = entry?;
        println!("  {:?} {} bytes", entry.file_name(), entry.metadata()?.len());
    }
    let start = Instant::now();
    let scene = store.open(&metadata.id)?;
    println!("open {:.1} ms, {} lit pixels", 1e3 * start.elapsed().as_secs_f64(), metadata.lit_pixels);
    for (terrain_hides, ratio) in [
        (false, skyglow_scene::FAR_BLOCK_RATIO),
        (true, skyglow_scene::FAR_BLOCK_RATIO),
        (false, 0.0),
        (true, 0.0),
    ] {
        let times_ms: Vec<f64> = (0..150)
            .map(|_| {
                let start = Instant::now();
                std::hint::black_box(scene.polar_grid_with_ratio(place, terrain_hides, ratio));
                1e3 * start.elapsed().as_secs_f64()
            })
            .collect();
        let grid = scene.polar_grid_with_ratio(place, terrain_hides, ratio);
        let is_blocked = |blocking: u32| if blocking > 0 { 1.0 } else { 0.0 };
        let blocked: f64 = grid.cells.iter().map(|c| is_blocked(c.blocking) * f64::from(c.flux_dnb_w)).sum();
        println!(
            "polar grid at ratio {ratio:.4}, terrain hides {terrain_hides}: fastest {:.2} ms, mean {:.2} ms; {} cells, {:.1} % \
             of the flux behind skylines",
            times_ms.iter().copied().fold(f64::INFINITY, f64::min),
            times_ms.iter().sum::<f64>() / times_ms.len() as f64,
            grid.cells.len(),
            100.0 * blocked / grid.flux_dnb_w
        );
    }
    let start = Instant::now();
    let coverage = scene.coverage(place);
    println!("coverage {coverage:.4}: {:.2} ms", 1e3 * start.elapsed().as_secs_f64());
    let pixels = scene.source_pixels_within(place, 300_000.0);
    let sum: f64 = pixels.iter().map(|p| p.flux_dnb_w).sum();
    let grid = scene.polar_grid(place, false);
    let cells: f64 = grid.cells.iter().map(|c| f64::from(c.flux_dnb_w)).sum();
    println!(
        "{} pixels within 300 km, {} cells, flux {sum:.6e} W, error {:.1e}, of the cells {:.1e}",
        pixels.len(),
        grid.cells.len(),
        grid.flux_dnb_w / sum - 1.0,
        cells / sum - 1.0
    );
    for (layer, z) in [
        (TileLayer::Radiance, 6u8),
        (TileLayer::Radiance, 11),
        (TileLayer::Elevation, 6),
        (TileLayer::Elevation, 11),
    ] {
        let world = f64::from(1u32 << z);
        let x = world * (place.longitude_deg() / 360.0 + 0.5);
        let y = world * (0.5 - place.latitude_rad().tan().asinh() / std::f64::consts::TAU);
        let start = Instant::now();
        let tile = scene.tile(layer, z, x as u32, y as u32, 256)?;
        let valid = tile.has_data.iter().filter(|v| **v).count();
        println!("tile {layer:?} {z}: {:.1} ms, {valid} with data", 1e3 * start.elapsed().as_secs_f64());
    }
    Ok(())
}
