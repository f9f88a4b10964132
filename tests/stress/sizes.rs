//! From one lit pixel to ten million, from 1e-6 to 1e6 nW cm⁻² sr⁻¹.

use crate::{
    checks::{Check, Outcome, Report},
    detectors::{Faults, lost_digits},
    geotiff::Folder,
    rig::{Bench, Rig, row_maxima, widened},
};
use skyglow_lab::light_raster::LightRaster;
use skyglow_physics::{
    AZIMUTH_COUNT, EARTH_RADIUS_M, GeoPoint, Turbidity,
    error_metric::BAND_FLOOR_W_M2_SR,
    source_pixel::{MAX_SOURCE_DISTANCE_M, W_M2_SR_PER_NW_CM2_SR},
};
use skyglow_scene::PolarGrid;
use std::{error::Error, f64::consts::PI, time::Instant};

/// VIIRS pixels, degrees.
const STEP: f64 = 1.0 / 240.0;

/// Pieces of the observer's own pixel lie on a square lattice (the reference's rule, `docs/model.md#sources`), so that the lowest row
/// sees more of them along the diagonals; the reference itself by 30 %.
const UNEVEN: f64 = 0.15;

pub(crate) fn run(bench: &Bench, report: &mut Report) -> Outcome {
    radiances(report, &bench.shipped)?;
    ten_million(report, &bench.shipped)
}

/// One lit pixel below the observer, 1 km, 20 km and 200 km away: at any radiance the sky is that of the brightest,
/// dimmed. (Dimmed alone: between packs what is below the floor of the logarithm is black.)
fn radiances(report: &mut Report, rig: &Rig) -> Outcome {
    let folder = Folder::new()?;
    for (words, turbidity, floor_w_m2_sr) in
        [("at a pack's turbidity", 2.5, 0.0), ("between packs", 3.0, BAND_FLOOR_W_M2_SR)]
    {
        let skies = |radiance: f32| -> Result<Vec<Vec<f32>>, Box<dyn Error>> {
            let lit = |column, row| if (column, row) == (2, 1) { radiance } else { 0.0 };
            let scene = folder.scene(&LightRaster::new((37.0, -1.0), (STEP, STEP), (5, 3), lit))?;
            let lamp = GeoPoint::from_deg(-1.0 - 1.5 * STEP, 37.0 + 2.5 * STEP)?;
            let from = |distance_m: f64| -> Result<Vec<f32>, Box<dyn Error>> {
                let mut request = rig.request(scene.polar_grid(lamp.destination(2.0, distance_m), false))?;
                request.turbidity = Turbidity::new(turbidity)?;
                Ok(rig.sky(&request)?)
            };
            [0.0, 1e3, 2e4, 2e5].into_iter().map(from).collect()
        };
        let bright = skies(1e6)?;
        let radiances = [1e-6f32, 1e-3, 1.0, 1e3];
        let (mut worst, mut planted, mut faults) = (0f64, 0f64, Faults::default());
        for radiance in radiances {
            for (bright, sky) in bright.iter().zip(skies(radiance)?) {
                faults += Faults::of_f32(&sky);
                let error = |more: f64| {
                    let wanted: Vec<f64> =
                        widened(bright).map(|value| 1e-6 * value * f64::from(radiance) * more).collect();
                    let magnitude = row_maxima(&wanted).into_iter().map(|value| value.max(floor_w_m2_sr));
                    lost_digits(widened(&sky), wanted.iter().copied(), magnitude)
                };
                worst = worst.max(error(1.0));
                planted = planted.max(error(1.001));
            }
        }
        let worst = if faults.total() > 0 { f64::INFINITY } else { worst };
        let name = format!("one lit pixel of 1e-6 to 1e6 nW cm-2 sr-1, {words}");
        let check = Check::new(name, "of the row's brightest", radiances.len() * bright.len());
        report.add(check.found(worst, 1e-4, planted).note("planted: a thousandth more"));
    }
    Ok(())
}

/// Most memory that this process has had, MB; None where the system does not say.
fn peak_mb() -> Option<f64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find(|line| line.starts_with("VmHWM:"))?;
    line.split_whitespace().nth(1)?.parse::<f64>().ok().map(|kb| kb / 1024.0)
}

/// 3 163 × 3 163 pixels, every one lit alike, about a place on the equator: a sky that is the same all around.
fn ten_million(report: &mut Report, rig: &Rig) -> Outcome {
    const SIDE: u32 = 3_163;
    const RADIANCE_NW_CM2_SR: f32 = 2.0;
    let half_deg = 0.5 * STEP * f64::from(SIDE);
    let folder = Folder::new()?;
    let raster =
        LightRaster::new((30.0 - half_deg, half_deg), (STEP, STEP), (SIDE, SIDE), |_, _| RADIANCE_NW_CM2_SR);
    let options = folder.write(&raster)?;
    drop(raster);
    let before_mb = peak_mb();
    let seconds = |start: Instant| start.elapsed().as_secs_f64();
    let start = Instant::now();
    let metadata = folder.ingest(&options)?;
    let (ingest_s, start) = (seconds(start), Instant::now());
    let scene = folder.store().open(&metadata.id)?;
    let (open_s, start) = (seconds(start), Instant::now());
    let place = GeoPoint::from_deg(0.0, 30.0)?;
    // The reference knows the passes alone.
    let grid = PolarGrid { near: Vec::new(), ..scene.polar_grid(place, false) };
    let (grid_s, flux_dnb_w) = (seconds(start), grid.flux_dnb_w);
    let mut request = rig.request(grid)?;
    request.observer_altitude_m = 0.0;
    let start = Instant::now();
    let sky = rig.sky(&request)?;
    let render_s = seconds(start);
    let peak = |mb: Option<f64>| mb.map_or("unknown".to_owned(), |mb| format!("{mb:.0} MB"));
    let lit = metadata.lit_pixels as usize;
    let taken = format!(
        "ingest {ingest_s:.1} s, open {open_s:.2} s, polar grid {:.0} ms, sky {:.0} ms; peak memory of the process {} \
         before, {} after",
        1e3 * grid_s,
        1e3 * render_s,
        peak(before_mb),
        peak(peak_mb())
    );

    let disc_m2 = 2.0 * PI * EARTH_RADIUS_M.powi(2) * (1.0 - (MAX_SOURCE_DISTANCE_M / EARTH_RADIUS_M).cos());
    let exact_w = PI * f64::from(RADIANCE_NW_CM2_SR) * W_M2_SR_PER_NW_CM2_SR * disc_m2;
    let check = Check::new("ten million lit pixels: flux of the disc in closed form", "share of it", lit);
    let planted = (flux_dnb_w / (1.01 * exact_w) - 1.0).abs();
    report.add(check.found((flux_dnb_w / exact_w - 1.0).abs(), 1e-3, planted).note(taken));

    let exact = rig.exact(&request)?;
    let error = |sky: &[f32]| lost_digits(widened(sky), exact.iter().copied(), row_maxima(&exact));
    let faults = Faults::of_f32(&sky).total();
    let worst = if faults > 0 { f64::INFINITY } else { error(&sky) };
    let wrong: Vec<f32> = sky.iter().map(|value| value * 1.000_1).collect();
    let check = Check::new("the same: f32 against f64", "of the row's brightest", sky.len());
    report.add(
        check.found(worst, 2e-5, error(&wrong)).note(format!("{} lit cells", request.polar.cells.len())),
    );

    let check = Check::new(
        "the same: the sky is alike all around",
        "(brightest − dimmest) / mean of a row",
        sky.len(),
    );
    let mut seam = sky.clone();
    seam.chunks_exact_mut(AZIMUTH_COUNT).for_each(|row| row[0] *= 1.2);
    report.add(
        check
            .found(unevenness(&sky), UNEVEN, unevenness(&seam))
            .note("planted: a fifth more in the column of north"),
    );
    Ok(())
}

/// The largest (brightest − dimmest) / mean over the rows.
fn unevenness(sky: &[f32]) -> f64 {
    let of_row = |row: &[f32]| {
        let (low, high) = widened(row)
            .fold((f64::INFINITY, 0.0), |(low, high): (f64, f64), value| (low.min(value), high.max(value)));
        (high - low) / (widened(row).sum::<f64>() / row.len() as f64)
    };
    sky.chunks_exact(AZIMUTH_COUNT).map(of_row).fold(0.0, f64::max)
}
