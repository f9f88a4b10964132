//! Skies past terrain against first-order light tested against the terrain.

use crate::arguments::{Outcome, SceneArguments, place, turbidity};
use skyglow_lab::setup::{clear_sky, engine_of};
use skyglow_physics::{
    Atmosphere, BAND_COUNT, EmissionMix, GeoPoint, PointSource, Turbidity,
    blocking::blocking_position,
    direct_sum::{grid_direction, stratified_samples},
    error_metric::{ErrorStatistics, relative_error},
    hidden_sum::{SkySum, cut_sum, hidden_sum},
    photometry::{luminance_cd_m2, natural_sky_luminance_cd_m2},
    source_pixel::{MAX_SOURCE_DISTANCE_M, point_sources},
};
use skyglow_render::{DeviceChoice, Engine, resident_tables};
use skyglow_scene::{PolarGrid, Scene};
use skyglow_tables::{Scattering, packs_in};
use std::{error::Error, path::PathBuf, time::Instant};

const MAX_LIGHTS: usize = 400;
const MAX_DISTANCE_M: f64 = 80_000.0;
const DIRECTIONS: usize = 120;

type Bands = [f64; BAND_COUNT];

/// Skies past terrain, first order: the fast path with and without hidden lights, against the sum whose every segment is
/// tested against the terrain. Where a place has more than 400 lights within 80 km, an even choice of 400 stands for them,
/// each with its exact blocking angle; else the scene's own polar grid is taken, skylines as stored. The light is scaled to
/// an open zenith as bright as the natural one.
#[derive(Debug, clap::Args)]
pub(crate) struct Arguments {
    #[command(flatten)]
    scene: SceneArguments,
    /// Folder of packs of single scattering.
    packs: PathBuf,
    /// Turbidity.
    #[arg(value_parser = turbidity)]
    turbidity: Turbidity,
    /// Places, each LATITUDE,LONGITUDE.
    #[arg(value_parser = place, required = true)]
    places: Vec<GeoPoint>,
}

pub(crate) fn run(Arguments { scene, packs, turbidity, places }: &Arguments) -> Outcome {
    let scene = scene.open()?;
    let (tables, _) = resident_tables(&packs_in(packs)?)?;
    if !tables.iter().all(|pack| pack.blocked.is_some()) {
        return Err("these packs know no skylines".into());
    }
    let engine = engine_of(tables, DeviceChoice::Cpu)?;
    places.iter().try_for_each(|place| compare(&scene, &engine, *turbidity, *place))
}

/// Lights and the grid that the fast path takes for them, with and without terrain.
struct Lights {
    sources: Vec<PointSource>,
    hidden: PolarGrid,
    open: PolarGrid,
    angles_rad: Vec<f64>,
}

fn lights(scene: &Scene, place: GeoPoint) -> Lights {
    let pixel_m = scene.metadata().pixel_size_m;
    let angle = |source: &PointSource| {
        let light = place.destination(source.azimuth_rad, source.distance_m);
        scene.blocking_angle_rad(light, source.altitude_m, pixel_m, place)
    };
    let whole = point_sources(place, &scene.source_pixels_within(place, MAX_SOURCE_DISTANCE_M));
    if whole.len() <= MAX_LIGHTS {
        let angles_rad = whole.iter().map(angle).collect();
        return Lights {
            hidden: scene.polar_grid(place, true),
            open: scene.polar_grid(place, false),
            sources: whole,
            angles_rad,
        };
    }
    let near: Vec<PointSource> =
        whole.into_iter().filter(|source| source.distance_m < MAX_DISTANCE_M).collect();
    let sources: Vec<PointSource> = near.iter().copied().step_by(near.len().div_ceil(MAX_LIGHTS)).collect();
    let angles_rad: Vec<f64> = sources.iter().map(angle).collect();
    let behind = |angle_rad: &f64| {
        let (node, weight) = blocking_position(angle_rad.to_degrees());
        node as f64 + weight
    };
    let places = angles_rad.iter().map(behind);
    Lights {
        hidden: PolarGrid::from_sources(place, sources.iter().copied().zip(places)),
        open: PolarGrid::from_sources(place, sources.iter().map(|source| (*source, 0.0))),
        sources,
        angles_rad,
    }
}

fn words(errors: Vec<f64>) -> Result<String, Box<dyn Error>> {
    let of = ErrorStatistics::of(errors).ok_or("no directions")?;
    Ok(format!("mean {:.1} %, 99 % {:.0} %", 100.0 * of.mean, 100.0 * of.p99))
}

fn compare(scene: &Scene, engine: &Engine, turbidity: Turbidity, place: GeoPoint) -> Outcome {
    let eye_m = scene.ground(place).altitude_m() + 2.0;
    let lights = lights(scene, place);
    let horizon = scene.horizon(place, eye_m);
    let samples: Vec<(usize, usize)> = stratified_samples(DIRECTIONS)
        .into_iter()
        .filter(|&(row, column)| !horizon.hides_sample(row, column))
        .collect();
    let directions: Vec<_> = samples.iter().copied().map(grid_direction).collect();
    let sum = SkySum {
        place,
        observer_altitude_m: eye_m,
        sources: &lights.sources,
        emission: EmissionMix::garstang(),
        flux_per_dnb_flux: skyglow_bench::options::REFERENCE_FLUX,
        directions: &directions,
    };
    let atmosphere = Atmosphere::new(turbidity);
    let pixel_m = scene.metadata().pixel_size_m;
    let start = Instant::now();
    let reference =
        hidden_sum(&atmosphere, &sum, &|light_m, point_m| scene.blocks(light_m, point_m, pixel_m));
    let seconds = start.elapsed().as_secs_f64();
    let cut = cut_sum(&atmosphere, &sum, &lights.angles_rad);
    let render = |grid: &PolarGrid| -> Result<Vec<Bands>, Box<dyn Error>> {
        let sky = engine.render_blocking(clear_sky(grid.clone(), eye_m, turbidity, Scattering::Single))?;
        let at = |&(row, column): &(usize, usize)| {
            std::array::from_fn(|b| sky.panorama.radiance_w_m2_sr(b, row, column))
        };
        Ok(samples.iter().map(at).collect())
    };
    let (hidden, open) = (render(&lights.hidden)?, render(&lights.open)?);
    let zenith = directions.iter().position(|d| d.elevation_rad > 1.5).ok_or("the zenith is hidden")?;
    let scale = natural_sky_luminance_cd_m2() / luminance_cd_m2(open[zenith]);
    let errors = |sky: &[Bands], against: &[Bands]| -> Vec<f64> {
        let scaled = |bands: &Bands| bands.map(|value| value * scale);
        sky.iter()
            .zip(against)
            .map(|(sky, reference)| relative_error(scaled(sky), scaled(reference)))
            .collect()
    };
    let mean =
        |sky: &[Bands]| sky.iter().map(|bands| luminance_cd_m2(*bands)).sum::<f64>() / sky.len() as f64;
    let part = |sky: &[Bands]| {
        format!(
            "{:.3} (zenith {:.3})",
            mean(sky) / mean(&open),
            luminance_cd_m2(sky[zenith]) / luminance_cd_m2(open[zenith])
        )
    };
    println!(
        "{:.4} {:.4} at {eye_m:.0} m: {} lights, {} behind ridges; {} directions; reference in {seconds:.0} s",
        place.latitude_deg(),
        place.longitude_deg(),
        lights.sources.len(),
        lights.angles_rad.iter().filter(|angle| **angle > 0.0).count(),
        directions.len(),
    );
    println!("  left of the light without terrain: reference {}, fast {}", part(&reference), part(&hidden));
    println!("  fast with hidden lights against the reference: {}", words(errors(&hidden, &reference))?);
    println!("  fast against lobes cut at the same angles: {}", words(errors(&hidden, &cut))?);
    println!("  fast without hidden lights against the reference: {}", words(errors(&open, &reference))?);
    Ok(())
}
