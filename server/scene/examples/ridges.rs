//! How good the definition of hidden light is: each light's lobe cut all around at its blocking angle towards the
//! observer, against first-order light whose every segment is tested against the terrain.
//!
//! `ridges RADIANCE TERRAIN LAT,LON [LAT,LON]...`, where `-` for RADIANCE makes up some lights in the Swiss Alps
//! (tile N46E008). Errors are those of the model over directions of the visible sky, with the light scaled to a zenith
//! as bright as the natural one.
//!
//! `ridges write FILE` writes the made-up lights, for other measurements.
//!
//! `cargo run --release -p skyglow-scene --example ridges -- - N46E008_srtm3.tif 46.66,8.59`

#![expect(clippy::expect_used, reason = "a measuring tool for developers stops at the first error")]

use gdal::DriverManager;
use gdal::raster::Buffer;
use gdal::spatial_ref::SpatialRef;
use skyglow_physics::blocking::blocking_position;
use skyglow_physics::direct_sum::{grid_direction, stratified_samples};
use skyglow_physics::error_metric::{ErrorStatistics, relative_error};
use skyglow_physics::hidden_sum::{SkySum, cut_sum, hidden_sum};
use skyglow_physics::photometry::luminance_cd_m2;
use skyglow_physics::source_pixel::point_sources;
use skyglow_physics::{
    Atmosphere, BAND_COUNT, Direction, EmissionMix, GeoPoint, LampPreset, PointSource, Turbidity,
};
use skyglow_scene::{IngestOptions, Scene, SceneStore, ingest};
use std::path::Path;
use std::time::Instant;

/// Lights summed at most: the test of every segment is slow.
const LIGHTS: usize = 60;
/// Directions looked at.
const DIRECTIONS: usize = 120;
/// Lights farther than this are left out, metres.
const FARTHEST_M: f64 = 80_000.0;
/// The natural sky at the zenith, cd m⁻².
const NATURAL_CD_M2: f64 = 1.7e-4;
/// Made-up towns: latitude, longitude, radius in pixels, nW cm⁻² sr⁻¹.
const TOWNS: [(f64, f64, i32, f64); 10] = [
    (46.195, 8.79, 3, 25.0),  // Locarno
    (46.19, 8.95, 3, 25.0),   // Bellinzona (at the tile's southern rim)
    (46.53, 8.61, 1, 8.0),    // Airolo
    (46.634, 8.594, 1, 10.0), // Andermatt
    (46.665, 8.59, 1, 5.0),   // Göschenen
    (46.88, 8.64, 2, 20.0),   // Altdorf
    (46.90, 8.25, 2, 15.0),   // Sarnen
    (46.70, 8.85, 1, 8.0),    // Disentis
    (46.73, 8.18, 1, 8.0),    // Meiringen
    (46.36, 8.80, 1, 8.0),    // Bignasco and the valley towards it
];

fn write_lights(path: &Path) {
    const SIZE: usize = 240;
    let step = 1.0 / SIZE as f64;
    let mut values = vec![0f32; SIZE * SIZE];
    for (latitude, longitude, radius, radiance) in TOWNS {
        let (column, row) = (((longitude - 8.0) / step) as i32, ((47.0 - latitude) / step) as i32);
        for (r, c) in (-radius..=radius).flat_map(|r| (-radius..=radius).map(move |c| (r, c))) {
            let (column, row) = ((column + c) as usize, (row + r) as usize);
            if column < SIZE && row < SIZE {
                values[row * SIZE + column] = radiance as f32;
            }
        }
    }
    let driver = DriverManager::get_driver_by_name("GTiff").expect("a driver");
    let mut dataset = driver.create_with_band_type::<f32, _>(path, SIZE, SIZE, 1).expect("a raster");
    dataset.set_geo_transform(&[8.0, step, 0.0, 47.0, 0.0, -step]).expect("a place");
    dataset.set_spatial_ref(&SpatialRef::from_epsg(4326).expect("a CRS")).expect("a CRS");
    let mut band = dataset.rasterband(1).expect("a band");
    band.write((0, 0), (SIZE, SIZE), &mut Buffer::new((SIZE, SIZE), values)).expect("lights");
    dataset.close().expect("a file");
}

/// A light and its blocking angle towards the observer, radians.
type Blocked = (PointSource, f64);

/// The errors of a sky over all directions and over those well above the ridges.
fn statistics(
    directions: &[Direction],
    sky: &[[f64; BAND_COUNT]],
    truth: &[[f64; BAND_COUNT]],
    scale: f64,
) -> String {
    let scaled = |bands: &[f64; BAND_COUNT]| bands.map(|value| value * scale);
    let above = |elevation_deg: f64| {
        let pairs = directions.iter().zip(sky.iter().zip(truth));
        let seen = pairs.filter(|(direction, _)| direction.elevation_rad.to_degrees() >= elevation_deg);
        let errors = seen.map(|(_, (sky, truth))| relative_error(scaled(sky), scaled(truth)));
        ErrorStatistics::of(errors).expect("directions")
    };
    let (all, high) = (above(0.0), above(30.0));
    format!(
        "mean {:.4}, 99 % {:.4}; from 30 degrees up {:.4} and {:.4}",
        all.mean, all.p99, high.mean, high.p99
    )
}

fn compare(scene: &Scene, what: &str, place: GeoPoint, eye_m: f64, lights: &[Blocked]) {
    let sources: Vec<PointSource> = lights.iter().map(|light| light.0).collect();
    let angles_rad: Vec<f64> = lights.iter().map(|light| light.1).collect();
    let horizon = scene.horizon(place, eye_m);
    let directions: Vec<Direction> = stratified_samples(DIRECTIONS)
        .into_iter()
        .map(grid_direction)
        .filter(|direction| !horizon.hides(*direction))
        .collect();
    let sum = SkySum {
        place,
        observer_altitude_m: eye_m,
        sources: &sources,
        emission: EmissionMix::garstang(),
        flux_per_dnb_flux: LampPreset::Mixed.lamp().flux_per_dnb_flux,
        directions: &directions,
    };
    let atmosphere = Atmosphere::new(Turbidity::default());
    let pixel_size_m = scene.metadata().pixel_size_m;
    let start = Instant::now();
    let truth =
        hidden_sum(&atmosphere, &sum, &|light_m, point_m| scene.blocks(light_m, point_m, pixel_size_m));
    let seconds = start.elapsed().as_secs_f64();
    let cut = cut_sum(&atmosphere, &sum, &angles_rad);
    let open = cut_sum(&atmosphere, &sum, &vec![0.0; sources.len()]);
    let mean = |sky: &[[f64; BAND_COUNT]]| {
        sky.iter().map(|bands| luminance_cd_m2(*bands)).sum::<f64>() / sky.len() as f64
    };
    let zenith = directions.iter().position(|d| d.elevation_rad > 1.5).expect("the zenith is seen");
    let scale = NATURAL_CD_M2 / luminance_cd_m2(open[zenith]);
    let behind = angles_rad.iter().filter(|angle| **angle > 0.0).count();
    let place_sum: f64 =
        angles_rad.iter().map(|a| blocking_position(a.to_degrees())).map(|p| p.0 as f64 + p.1).sum();
    println!(
        "  {what}: {} lights, {behind} behind ridges, mean place {:.2}; {} directions; truth in {seconds:.0} s\n    \
         of the light without terrain {:.3} is left, by cut lobes {:.3} (zenith {:.3} and {:.3})\n    \
         error with blocking: {}\n    error without: {}",
        sources.len(),
        place_sum / lights.len() as f64,
        directions.len(),
        mean(&truth) / mean(&open),
        mean(&cut) / mean(&open),
        luminance_cd_m2(truth[zenith]) / luminance_cd_m2(open[zenith]),
        luminance_cd_m2(cut[zenith]) / luminance_cd_m2(open[zenith]),
        statistics(&directions, &cut, &truth, scale),
        statistics(&directions, &open, &truth, scale),
    );
}

fn look_from(scene: &Scene, place: GeoPoint) {
    let eye_m = scene.ground(place).altitude_m() + 2.0;
    println!("{:.4} {:.4}, eye at {eye_m:.0} m", place.latitude_deg(), place.longitude_deg());
    let size_m = scene.metadata().pixel_size_m;
    let mut lights: Vec<Blocked> = point_sources(place, &scene.source_pixels_within(place, FARTHEST_M))
        .into_iter()
        .map(|source| {
            let light = place.destination(source.azimuth_rad, source.distance_m);
            (source, scene.blocking_angle_rad(light, source.altitude_m, size_m, place))
        })
        .collect();
    let weight = |light: &Blocked| light.0.flux_dnb_w / light.0.distance_m.powi(2);
    lights.sort_by(|a, b| weight(b).total_cmp(&weight(a)));
    // Lights that come after each other lie side by side: take some of many that stand for all.
    let some = |lights: &[Blocked]| {
        let step = lights.len().div_ceil(LIGHTS).max(1);
        lights.iter().copied().step_by(step).collect::<Vec<_>>()
    };
    let behind: Vec<Blocked> = lights.iter().copied().filter(|light| light.1.to_degrees() >= 0.5).collect();
    compare(scene, "all lights", place, eye_m, &some(&lights));
    if !behind.is_empty() && behind.len() < lights.len() {
        compare(scene, "lights behind ridges of half a degree or more", place, eye_m, &some(&behind));
    }
}

fn main() {
    let arguments: Vec<String> = std::env::args().collect();
    if let [_, write, file] = arguments.as_slice()
        && write == "write"
    {
        write_lights(Path::new(file));
        return;
    }
    assert!(arguments.len() >= 4, "usage: ridges RADIANCE|- TERRAIN LAT,LON...");
    let dir = tempfile::tempdir().expect("a folder");
    let made_up = dir.path().join("lights.tif");
    let radiance = if arguments[1] == "-" {
        write_lights(&made_up);
        made_up.as_path()
    } else {
        Path::new(&arguments[1])
    };
    let mut options = IngestOptions::new(radiance);
    options.terrain = vec![arguments[2].clone().into()];
    let store = SceneStore::new(dir.path().join("data"));
    let start = Instant::now();
    let metadata = ingest(&store, &options, &mut |_| {}).expect("an ingest");
    println!("{} lights ingested in {:.1} s", metadata.lit_pixels, start.elapsed().as_secs_f64());
    let scene = store.open(&metadata.id).expect("a scene");
    for text in &arguments[3..] {
        let (latitude, longitude) = text.split_once(',').expect("LAT,LON");
        let degrees = |text: &str| text.parse::<f64>().expect("degrees");
        look_from(&scene, GeoPoint::from_deg(degrees(latitude), degrees(longitude)).expect("a place"));
    }
}
