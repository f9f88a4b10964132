//! Times of maps of influences, plans and scenarios.

use crate::arguments::Outcome;
use skyglow_lab::{
    light_raster::LightRaster,
    setup::{observatory, open_sky},
};
use skyglow_observatory::{
    InfluenceRequest, Level, Limit, Measure, Observatory, PlanMethod, PlanRequest, SkyRequest, TargetSite,
};
use skyglow_physics::{Direction, GeoPoint, SkyCurve, Turbidity};
use skyglow_scene::{Area, Change, ChangeStep, Edit, IngestOptions, SceneError, SceneId, SceneStore, ingest};
use std::{error::Error, path::PathBuf, time::Instant};

/// Times of maps of influences, step by step, on the processor: a made-up square of lights of 463 m, all of them lit, the
/// place in the middle. The first map finds the light, the others have it. Then plans and scenarios.
#[derive(Debug, clap::Args)]
pub(crate) struct Arguments {
    /// Folder of packs.
    packs: PathBuf,
    /// Pixels a side of the square.
    #[arg(default_value_t = 1000)]
    side: u32,
    /// Rounds of each map.
    #[arg(default_value_t = 20)]
    rounds: usize,
}

pub(crate) fn run(Arguments { packs, side, rounds }: &Arguments) -> Outcome {
    let (side, rounds) = (*side, *rounds);
    let folder = tempfile::tempdir()?;
    let step_deg = 463.0 / 111_195.0;
    let corner_deg = (37.0 - 0.5 * f64::from(side) * step_deg, 0.5 * f64::from(side) * step_deg);
    // Hills, and light that falls off from some towns.
    let ground_m = |column: u32, row: u32| {
        600.0 + 300.0 * (0.013 * row as f32).sin() + 200.0 * (0.017 * column as f32).cos()
    };
    let light = |column: u32, row: u32| {
        0.3 + 40.0 * ((0.05 * row as f32).sin() * (0.06 * column as f32).sin()).max(0.0).powi(8)
    };
    let write = |name: &str, value: &dyn Fn(u32, u32) -> f32| -> Result<PathBuf, Box<dyn Error>> {
        let path = folder.path().join(name);
        let raster = LightRaster::new(corner_deg, (step_deg, step_deg), (side, side), value);
        std::fs::write(&path, raster.to_geotiff()?)?;
        Ok(path)
    };
    let options = IngestOptions {
        terrain: vec![write("terrain.tif", &ground_m)?],
        id: Some(square()?),
        ..IngestOptions::new(write("lights.tif", &light)?)
    };
    ingest(&SceneStore::new(folder.path()), &options, &mut |_| {})?;
    let observatory = observatory(folder.path(), packs)?;
    let corner = |azimuth_deg: f64, elevation_deg: f64| Direction {
        azimuth_rad: azimuth_deg.to_radians(),
        elevation_rad: elevation_deg.to_radians(),
    };
    let region = SkyCurve::new(vec![corner(350.0, 10.0), corner(20.0, 10.0), corner(5.0, 50.0)])?;
    let measures = [Measure::Zenith, Measure::Mean, Measure::Region(region), Measure::Norm];
    println!("milliseconds: first map, then fastest and median of {rounds}, with the steps of the median");
    for turbidity in [2.5, 3.5] {
        for measure in &measures {
            let mut place = 0.0;
            let mut map = |is_new: bool| -> Result<_, Box<dyn Error>> {
                // Another place has no light found yet.
                place += if is_new { 1e-4 } else { 0.0 };
                let sky = sky(turbidity, 0.003 + place + 0.01 * turbidity, 37.002)?;
                let request = InfluenceRequest { sky, measure: measure.clone() };
                let start = Instant::now();
                let map = observatory.influence(&request)?;
                Ok((1e3 * start.elapsed().as_secs_f64(), map))
            };
            let (first_ms, _) = map(true)?;
            let mut times = (0..rounds).map(|_| map(false)).collect::<Result<Vec<_>, _>>()?;
            times.sort_by(|a, b| a.0.total_cmp(&b.0));
            let (median_ms, median) = &times[rounds / 2];
            let steps: Vec<String> = median
                .steps
                .iter()
                .map(|(name, time)| format!("{name} {:.1}", 1e3 * time.as_secs_f64()))
                .collect();
            println!(
                "T {turbidity} {:<28} {} pixels: {first_ms:.0}; {:.1}, {median_ms:.1} ({})",
                format!("{measure:?}").chars().take(20).collect::<String>(),
                median.pixels().len(),
                times[0].0,
                steps.join(", ")
            );
        }
    }
    changes(&observatory)
}

/// The id of the square.
fn square() -> Result<SceneId, SceneError> {
    SceneId::parse("square")
}

/// All orders, lights past terrain.
fn sky(turbidity: f64, latitude_deg: f64, longitude_deg: f64) -> Result<SkyRequest, Box<dyn Error>> {
    let place = GeoPoint::from_deg(latitude_deg, longitude_deg)?;
    Ok(SkyRequest { terrain_hides: true, ..open_sky(square()?, place, Turbidity::new(turbidity)?) })
}

/// Plans and scenarios in the same scene, from the request to what is answered; influences of the sites are known before.
fn changes(observatory: &Observatory) -> Outcome {
    println!("milliseconds, fastest of three: plans and scenarios");
    let site = |latitude_deg: f64, longitude_deg: f64, part: f64| -> Result<TargetSite, Box<dyn Error>> {
        let sky = sky(2.5, latitude_deg, longitude_deg)?;
        let influence = InfluenceRequest { sky, measure: Measure::Zenith };
        Ok(TargetSite { influence, limit: Limit::ReduceBy(part) })
    };
    let sites =
        [site(0.003, 37.002, 0.3)?, site(1.0, 36.3, 0.2)?, site(-1.1, 37.7, 0.25)?, site(-0.6, 36.1, 0.1)?];
    let fastest =
        |work: &dyn Fn() -> Result<String, Box<dyn Error>>| -> Result<(f64, String), Box<dyn Error>> {
            let mut best = (f64::INFINITY, String::new());
            for _ in 0..3 {
                let start = Instant::now();
                let told = work()?;
                best = (best.0.min(1e3 * start.elapsed().as_secs_f64()), told);
            }
            Ok(best)
        };
    for count in [1, 4] {
        let method = PlanMethod::Target { sites: sites[..count].to_vec(), max_cut: 0.8, protect: None };
        let request = PlanRequest { method };
        let (ms, told) = fastest(&|| {
            let plan = observatory.plan(&request)?;
            let (removed, least) = (plan.flux_removed_dnb_w(), plan.least_flux_dnb_w.unwrap_or(0.0));
            let of = plan.pixels_within_reach;
            Ok(format!(
                "{} of {of} pixels, {:.1e} above the least flux",
                plan.pixels.len(),
                removed / least - 1.0
            ))
        })?;
        println!("target plan of {count} site(s): {ms:.0} ({told})");
    }
    let (from, to) = (Level::Percentile(90.0), Level::Percentile(99.0));
    let method = PlanMethod::Threshold { site: sites[0].influence.clone().into(), from, to, gamma: 0.8 };
    let request = PlanRequest { method };
    let (ms, told) = fastest(&|| Ok(format!("{} pixels", observatory.plan(&request)?.pixels.len())))?;
    println!("threshold plan: {ms:.0} ({told})");
    let view = observatory.view(&square()?, None)?;
    let scene = view.scene();
    for radius_m in [1_000.0, 10_000.0, 40_000.0] {
        let area = Area::Brush { points: vec![[37.3, 0.3]], radius_m };
        let change = Change::Alter { factor: 0.5, lamp: None, emission: None };
        let steps = [ChangeStep::Painted(vec![Edit { area, change }])];
        let (ms, told) =
            fastest(&|| Ok(format!("{} pixels", scene.changed(&steps, "time")?.1.changed_pixels)))?;
        println!("scene painted within {radius_m} m: {ms:.1} ({told})");
    }
    Ok(())
}
