//! A target plan beside its reference solution.

use crate::arguments::{Outcome, PlaceArguments};
use skyglow_lab::setup::{later_orders, observatory, open_sky};
use skyglow_observatory::{InfluenceRequest, Limit, Measure, PlanMethod, PlanRequest, TargetSite};
use skyglow_physics::{
    AZIMUTH_COUNT, BAND_COUNT, Direction, ELEVATION_COUNT, GeoPoint, Lamp, LampPreset, PointSource, Response,
    direct_sum::{direct_sum, grid_direction},
    multiple_scattering::MultipleSum,
    panorama::{elevation_rad, solid_angle_sr},
    source_pixel::{MAX_SOURCE_DISTANCE_M, point_sources},
};
use skyglow_scene::Scene;
use std::{collections::HashMap, error::Error, time::Instant};

/// Grid samples whose mean stands for the zenith.
fn samples() -> Vec<(usize, usize)> {
    let rows = (0..ELEVATION_COUNT).filter(|&row| elevation_rad(row) >= 85f64.to_radians());
    rows.flat_map(|row| (0..AZIMUTH_COUNT).step_by(8).map(move |column| (row, column))).collect()
}

/// Mean over the samples, weighted by solid angle.
fn mean(luminance: impl Iterator<Item = f64>) -> f64 {
    let weights: Vec<f64> = samples().into_iter().map(|(row, _)| solid_angle_sr(row)).collect();
    let sum: f64 = luminance.zip(&weights).map(|(luminance, weight)| luminance * weight).sum();
    sum / weights.iter().sum::<f64>()
}

fn zenith(luminance_cd_m2: &[f32]) -> f64 {
    let at = |(row, column): (usize, usize)| f64::from(luminance_cd_m2[row * AZIMUTH_COUNT + column]);
    mean(samples().into_iter().map(at))
}

/// The zenith by the sum over all sources, all orders.
fn reference(sum: &MultipleSum, lamp: &Lamp, sources: &[PointSource]) -> Result<f64, Box<dyn Error>> {
    let directions: Vec<Direction> = samples().into_iter().map(grid_direction).collect();
    let flux = [1.0; BAND_COUNT];
    let first = direct_sum::<BAND_COUNT>(
        &[sum.atmosphere],
        sources,
        sum.observer_altitude_m,
        sum.emission,
        flux,
        &directions,
        &|| (),
    );
    let later = sum.radiance(sources, flux, &directions)?;
    let rule = lamp.light().rule(&Response::Photopic);
    let luminance = first
        .iter()
        .zip(&later)
        .map(|(first, later)| rule.value(std::array::from_fn(|band| first[band] + later[band])));
    Ok(mean(luminance))
}

/// A target plan beside the reference solution: the zenith by the direct sum over the raster as it is and over the raster
/// dimmed, all orders. The zenith is the mean over every eighth azimuth within 5° of it. Lights are under an open sky on
/// both sides. Minutes: a field of later orders for every 300 m of source altitude.
#[derive(Debug, clap::Args)]
pub(crate) struct Arguments {
    #[command(flatten)]
    place: PlaceArguments,
    /// By how much the zenith is to darken, a share such as 0.3.
    reduce_by: f64,
}

pub(crate) fn run(Arguments { place: asked, reduce_by }: &Arguments) -> Outcome {
    let (id, place, turbidity) = (asked.scene.clone(), asked.place()?, asked.turbidity);
    let observatory = observatory(&asked.data, &asked.packs)?;
    let lamp = LampPreset::Mixed.lamp();
    let sky = open_sky(id, place, turbidity);
    let influence = InfluenceRequest { sky, measure: Measure::Zenith };
    let site = TargetSite { influence, limit: Limit::ReduceBy(*reduce_by) };
    let method = PlanMethod::Target { sites: vec![site], max_cut: 1.0, protect: None };
    let start = Instant::now();
    let plan = observatory.plan(&PlanRequest { method })?;
    let seconds = start.elapsed().as_secs_f64();
    let site = &plan.sites[0];
    println!(
        "plan in {seconds:.2} s: {} of {} pixels, {:.2} % of the flux, zenith {:.4e} -> {:.4e} cd/m2 ({:+.3} %)",
        plan.pixels.len(),
        plan.pixels_within_reach,
        100.0 * plan.flux_removed_dnb_w() / plan.flux_within_reach_dnb_w,
        site.before.value,
        site.after.value,
        100.0 * (site.after.value / site.before.value - 1.0)
    );
    // The raster's own pixels, dimmed here and not by the program.
    let left: HashMap<u64, f64> = plan.pixels.iter().map(|pixel| (pixel.code, 1.0 - pixel.cut)).collect();
    let scene = asked.open()?;
    let sum = later_orders(turbidity, site.before.sky.context.altitude_m);
    let mut values = Vec::new();
    for is_dimmed in [false, true] {
        let start = Instant::now();
        let mut pixels = scene.source_pixels_within(place, MAX_SOURCE_DISTANCE_M);
        for pixel in pixels.iter_mut().filter(|_| is_dimmed) {
            let (column, row) = scene
                .column_and_row_at(GeoPoint::from_vector(pixel.center()))
                .ok_or("a pixel off the raster")?;
            pixel.flux_dnb_w *= left.get(&Scene::pixel_code(column, row)).copied().unwrap_or(1.0);
        }
        let flux_dnb_w: f64 = pixels.iter().map(|pixel| pixel.flux_dnb_w).sum();
        let value = reference(&sum, &lamp, &point_sources(place, &pixels))?;
        let state = if is_dimmed { &site.after } else { &site.before };
        let found = zenith(state.sky.values());
        println!(
            "{}: reference {value:.4e} cd/m2, the program's {found:.4e} ({:+.2} %), flux {flux_dnb_w:.4e} W; {:.0} s",
            if is_dimmed { "dimmed" } else { "as it is" },
            100.0 * (found / value - 1.0),
            start.elapsed().as_secs_f64()
        );
        values.push(value);
    }
    println!("by the direct sum the zenith changes by {:+.3} %", 100.0 * (values[1] / values[0] - 1.0));
    Ok(())
}
