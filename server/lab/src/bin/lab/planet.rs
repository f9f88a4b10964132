//! A planet of made-up light and terrain, so that anyone can measure a scene of millions of lit pixels.

mod geotiff;
mod relief;
mod towns;

use crate::arguments::Outcome;
use geotiff::GlobalGrid;
use relief::Relief;
use skyglow_physics::GeoPoint;
use std::path::{Path, PathBuf};
use towns::{REGION_RADIUS_KM, TownMap, region_middle};

/// Radiances of rows that no satellite of this kind measures.
const NO_DATA_NW_CM2_SR: f32 = -999.0;
/// Rows are measured between these latitudes, degrees.
const MEASURED_DEG: [f64; 2] = [-65.0, 75.0];
/// Places are within this of the region's middle, so that all lights within 300 km of them are the region's, km.
const PLACES_WITHIN_KM: f64 = 80.0;
/// The golden angle, radians.
const GOLDEN_ANGLE_RAD: f64 = 2.399_963_229_728_653;

/// Writes a planet: GeoTIFFs of lights in towns and of terrain, and prints places in a region that is the same in every size.
#[derive(Debug, clap::Args)]
pub(crate) struct Arguments {
    /// File to write the lights to, nW cm⁻² sr⁻¹.
    #[arg(long)]
    lights: Option<PathBuf>,
    /// File to write the terrain to, metres.
    #[arg(long)]
    terrain: Option<PathBuf>,
    /// About how many pixels are lit.
    #[arg(long, default_value_t = 1_000_000)]
    lit: u64,
    /// How many of them are in the region of 400 km around 46° N 8° E that is the same in every size.
    #[arg(long, default_value_t = 80_000)]
    region_lit: u64,
    /// Side of a pixel of the lights, arc seconds.
    #[arg(long, default_value_t = 15)]
    lights_arcsec: u32,
    /// Side of a sample of the terrain, arc seconds.
    #[arg(long, default_value_t = 30)]
    terrain_arcsec: u32,
    /// Another seed makes other towns outside the region.
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// How many places of the region are printed.
    #[arg(long, default_value_t = 40)]
    places: u32,
}

pub(crate) fn run(arguments: &Arguments) -> Outcome {
    let relief = Relief::new();
    let mut summary = serde_json::Map::new();
    if let Some(path) = &arguments.terrain {
        let grid = GlobalGrid::new(arguments.terrain_arcsec)?;
        let land = write_terrain(path, grid, &relief)?;
        summary.insert("land_part".into(), land.into());
    }
    if let Some(path) = &arguments.lights {
        let grid = GlobalGrid::new(arguments.lights_arcsec)?;
        let towns = TownMap::new(grid, &relief, arguments.lit, arguments.region_lit, arguments.seed)?;
        summary.insert("towns".into(), towns.len().into());
        summary.insert("lit_pixels".into(), write_lights(path, grid, &towns)?.into());
    }
    let places: Vec<[f64; 2]> = (0..arguments.places).map(|index| place(index, arguments.places)).collect();
    summary.insert("region_radius_km".into(), REGION_RADIUS_KM.into());
    summary.insert("places".into(), serde_json::to_value(places)?);
    println!("{}", serde_json::Value::Object(summary));
    Ok(())
}

/// Latitude and longitude of a place of the region, degrees: they lie on a spiral that fills a disc evenly.
fn place(index: u32, count: u32) -> [f64; 2] {
    let part = (f64::from(index) + 0.5) / f64::from(count.max(1));
    let distance_m = 1e3 * PLACES_WITHIN_KM * part.sqrt();
    let place: GeoPoint = region_middle().destination(f64::from(index) * GOLDEN_ANGLE_RAD, distance_m);
    [place.latitude_deg(), place.longitude_deg()].map(|angle_deg| (1e4 * angle_deg).round() / 1e4)
}

/// Writes altitudes, whole metres as such products have them, and says which part of the samples is land.
fn write_terrain(path: &Path, grid: GlobalGrid, relief: &Relief) -> Result<f64, Box<dyn std::error::Error>> {
    let land = geotiff::write(path, grid, None, &|first_row, altitudes_m: &mut [i16]| {
        let mut land = 0;
        for (offset, line) in altitudes_m.chunks_exact_mut(grid.width as usize).enumerate() {
            let latitude_deg = grid.latitude_deg(first_row + offset as u32);
            for (column, altitude_m) in (0..).zip(line) {
                *altitude_m = relief.altitude_m(latitude_deg, grid.longitude_deg(column)).round() as i16;
                land += u64::from(*altitude_m > 0);
            }
        }
        land
    })?;
    Ok(land as f64 / (f64::from(grid.width) * f64::from(grid.height)))
}

/// Writes radiances, and says how many pixels are lit.
fn write_lights(path: &Path, grid: GlobalGrid, towns: &TownMap) -> Result<u64, Box<dyn std::error::Error>> {
    let no_data = Some(f64::from(NO_DATA_NW_CM2_SR));
    geotiff::write(path, grid, no_data, &|first_row, radiances: &mut [f32]| {
        radiances.fill(0.0);
        towns.paint(first_row, radiances);
        for (offset, line) in radiances.chunks_exact_mut(grid.width as usize).enumerate() {
            let latitude_deg = grid.latitude_deg(first_row + offset as u32);
            if !(MEASURED_DEG[0]..=MEASURED_DEG[1]).contains(&latitude_deg) {
                line.fill(NO_DATA_NW_CM2_SR);
            }
        }
        radiances.iter().filter(|radiance| **radiance > 0.0).count() as u64
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// All that is within 300 km of a place is the region's.
    #[test]
    fn places_see_the_region_alone() {
        for index in 0..40 {
            let [latitude_deg, longitude_deg] = place(index, 40);
            let place = GeoPoint::from_deg(latitude_deg, longitude_deg).unwrap();
            let distance_m = place.unit_vector().angle_between(region_middle().unit_vector()) * 6_371_000.0;
            assert!(distance_m < 1e3 * (REGION_RADIUS_KM - 300.0), "{distance_m}");
        }
    }

    /// Two planets of different size are the same in the region, and what is said to be lit is lit.
    #[test]
    fn the_region_is_the_same_in_every_size() {
        let grid = GlobalGrid::new(120).unwrap();
        let relief = Relief::new();
        let of = |lit| {
            let towns = TownMap::new(grid, &relief, lit, 2_000, 1).unwrap();
            let mut radiances = vec![0f32; (grid.width * 300) as usize];
            let first_row = grid.row_of(51.0);
            towns.paint(first_row, &mut radiances);
            radiances
        };
        let (small, large) = (of(3_000), of(40_000));
        let columns = grid.column_of(4.5) as usize..grid.column_of(11.5) as usize;
        let mut lit = 0;
        for row in 0..300 {
            let line = row * grid.width as usize;
            let part = line + columns.start..line + columns.end;
            assert_eq!(small[part.clone()], large[part.clone()]);
            lit += small[part].iter().filter(|radiance| **radiance > 0.0).count();
        }
        assert!(lit > 1_000, "{lit}");
        let count = |radiances: &[f32]| radiances.iter().filter(|radiance| **radiance > 0.0).count();
        // The rest of the strip, a sixteenth of the Earth, has its part of the others.
        let [few, many] = [&small, &large].map(|radiances| count(radiances));
        assert!(10 * many > 13 * few, "{few} {many}");
    }

    /// A file in strips is the raster that was painted.
    #[test]
    fn files_hold_what_was_painted() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("lights.tif");
        let grid = GlobalGrid::new(900).unwrap();
        let towns = TownMap::new(grid, &Relief::new(), 4_000, 500, 1).unwrap();
        let lit = write_lights(&path, grid, &towns).unwrap();
        let mut decoder = tiff::decoder::Decoder::new(std::fs::File::open(&path).unwrap()).unwrap();
        assert_eq!(decoder.dimensions().unwrap(), (grid.width, grid.height));
        let tiff::decoder::DecodingResult::F32(values) = decoder.read_image().unwrap() else {
            panic!("no float32");
        };
        assert_eq!(values.iter().filter(|value| **value > 0.0).count() as u64, lit);
        assert!(lit > 1_000 && values[0] == NO_DATA_NW_CM2_SR);
        let mut painted = vec![0f32; values.len()];
        towns.paint(0, &mut painted);
        let measured = values.iter().zip(&painted).filter(|(value, _)| **value >= 0.0);
        assert!(measured.into_iter().all(|(value, painted)| value == painted));
    }

    /// A part of the samples is land, with mountains and plains, and the antimeridian is sea.
    #[test]
    fn the_planet_has_land_and_sea() {
        let relief = Relief::new();
        let of = |latitude_deg, longitude_deg| relief.altitude_m(latitude_deg, longitude_deg);
        let all: Vec<f64> = (-80..80)
            .flat_map(|latitude| {
                (-180..180).map(move |longitude| (f64::from(latitude), f64::from(longitude)))
            })
            .map(|(latitude_deg, longitude_deg)| of(latitude_deg + 0.3, longitude_deg + 0.4))
            .collect();
        let part =
            |is: &dyn Fn(f64) -> bool| all.iter().filter(|h| is(**h)).count() as f64 / all.len() as f64;
        assert!((0.2..0.5).contains(&part(&|h| h > 0.0)), "{}", part(&|h| h > 0.0));
        assert!((0.01..0.15).contains(&part(&|h| h > 1500.0)), "{}", part(&|h| h > 1500.0));
        assert!(all.iter().all(|h| (0.0..9_000.0).contains(h)));
        assert!((-80..80).all(|latitude| of(f64::from(latitude), -180.0) == 0.0));
        assert!(of(46.0, 8.0) > 0.0);
    }
}
