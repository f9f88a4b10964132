//! Where longitude and latitude have their seams: the antimeridian, the equator, the poles.

use crate::{
    checks::{Check, Outcome, Report},
    detectors::{Faults, lost_digits},
    geotiff::{Folder, scattered},
    rig::{Bench, Rig, row_maxima, widened},
};
use skyglow_lab::light_raster::LightRaster;
use skyglow_physics::{AZIMUTH_COUNT, GeoPoint};
use skyglow_scene::Scene;
use std::error::Error;

/// VIIRS pixels, degrees.
const STEP: f64 = 1.0 / 240.0;
const FIGURE: &str = "of the row's brightest";

pub(crate) fn run(bench: &Bench, report: &mut Report) -> Outcome {
    let rig = &bench.shipped;
    antimeridian(report, rig)?;
    equator(report, rig)?;
    poles(report, rig)?;
    everywhere(report, rig)
}

fn sky(rig: &Rig, scene: &Scene, latitude_deg: f64, longitude_deg: f64) -> Result<Vec<f32>, Box<dyn Error>> {
    let place = GeoPoint::from_deg(latitude_deg, (longitude_deg + 180.0).rem_euclid(360.0) - 180.0)?;
    let mut request = rig.request(scene.polar_grid(place, false))?;
    request.observer_altitude_m = 0.0;
    Ok(rig.sky(&request)?)
}

fn apart(sky: &[f32], wanted: &[f32]) -> f64 {
    let wanted: Vec<f64> = widened(wanted).collect();
    lost_digits(widened(sky), wanted.iter().copied(), row_maxima(&wanted))
}

/// One degree of scattered lights about a place.
fn about(latitude_deg: f64, longitude_deg: f64) -> LightRaster {
    LightRaster::new((longitude_deg - 0.5, latitude_deg + 0.5), (STEP, STEP), (240, 240), scattered)
}

/// The same lights at other longitudes give the same sky: at the antimeridian, at 0 and at 360°.
fn antimeridian(report: &mut Report, rig: &Rig) -> Outcome {
    let folder = Folder::new()?;
    let places = [(0.0, 0.0), (0.3, -0.2), (-0.2, 0.45), (-1.2, -0.9)];
    for latitude_deg in [0.0, 60.0, -80.0] {
        let here = folder.scene(&about(latitude_deg, 10.0))?;
        let (mut worst, mut planted): (f64, f64) = (0.0, f64::INFINITY);
        let middles = [180.0, -180.0, 179.9, 0.0, 359.5];
        for middle_deg in middles {
            let there = folder.scene(&about(latitude_deg, middle_deg))?;
            for (north_deg, east_deg) in places {
                let wanted = sky(rig, &here, latitude_deg + north_deg, 10.0 + east_deg)?;
                let got = |off_deg: f64| {
                    sky(rig, &there, latitude_deg + north_deg, middle_deg + east_deg + off_deg)
                };
                worst = worst.max(apart(&got(0.0)?, &wanted));
                planted = planted.min(apart(&got(STEP)?, &wanted));
            }
        }
        let name =
            format!("the lights of 10° east at 180, −180, 179.9, 0 and 359.5°, latitude {latitude_deg}°");
        let check = Check::new(name, FIGURE, middles.len() * places.len());
        report.add(check.found(worst, 1e-4, planted).note("planted: a pixel to the east"));
    }
    Ok(())
}

/// A scene and its mirror image across the equator, the equator in its midst and far from it.
fn equator(report: &mut Report, rig: &Rig) -> Outcome {
    let folder = Folder::new()?;
    let (mut worst, mut planted, mut cases): (f64, f64, usize) = (0.0, f64::INFINITY, 0);
    for latitude_deg in [0.0, 0.3, 45.0] {
        let raster = about(latitude_deg, 20.0);
        let (north, south) = (folder.scene(&raster)?, folder.scene(&raster.mirrored())?);
        for (north_deg, east_deg) in [(0.0, 0.0), (0.2, 0.1), (-0.45, 0.3), (0.8, -0.7)] {
            let wanted = mirrored(&sky(rig, &north, latitude_deg + north_deg, 20.0 + east_deg)?);
            let got = |off_deg: f64| sky(rig, &south, -latitude_deg - north_deg + off_deg, 20.0 + east_deg);
            worst = worst.max(apart(&got(0.0)?, &wanted));
            planted = planted.min(apart(&got(STEP)?, &wanted));
            cases += 1;
        }
    }
    let check = Check::new("a scene mirrored across the equator", FIGURE, cases);
    report.add(check.found(worst, 1e-4, planted).note("planted: a pixel to the north"));
    Ok(())
}

/// North and south exchanged: column i is where 128 − i was.
fn mirrored(sky: &[f32]) -> Vec<f32> {
    rearranged(sky, |column| (AZIMUTH_COUNT / 2 + AZIMUTH_COUNT - column) % AZIMUTH_COUNT)
}

/// The sky whose column `to(i)` is column i of the given one.
fn rearranged(sky: &[f32], to: impl Fn(usize) -> usize) -> Vec<f32> {
    let mut moved = vec![0.0; sky.len()];
    for (at, value) in sky.iter().enumerate() {
        moved[at - at % AZIMUTH_COUNT + to(at % AZIMUTH_COUNT)] = *value;
    }
    moved
}

/// All longitudes around a pole, where a row of 3 600 pixels is one place.
fn poles(report: &mut Report, rig: &Rig) -> Outcome {
    let folder = Folder::new()?;
    let cap = LightRaster::new((-180.0, 90.0), (0.1, 0.05), (3_600, 64), scattered);
    let (north, south) = (folder.scene(&cap)?, folder.scene(&cap.mirrored())?);
    let step_deg = 360.0 / AZIMUTH_COUNT as f64;

    // Turning east by a column at the north pole moves every light to the column after.
    let still = sky(rig, &north, 90.0, 10.0)?;
    let (mut worst, mut planted): (f64, f64) = (0.0, f64::INFINITY);
    for turn in 0..AZIMUTH_COUNT {
        let turned = sky(rig, &north, 90.0, 10.0 + step_deg * turn as f64)?;
        let by = |turn: usize| rearranged(&still, |column| (column + turn) % AZIMUTH_COUNT);
        worst = worst.max(apart(&turned, &by(turn)));
        planted = planted.min(apart(&turned, &by(turn + 1)));
    }
    let check = Check::new("turned about the north pole by each of 256 columns", FIGURE, AZIMUTH_COUNT);
    report.add(check.found(worst, 1e-3, planted).note("planted: one column too many"));

    let (mut worst, mut planted): (f64, f64) = (0.0, f64::INFINITY);
    let latitudes_deg = [90.0, 89.999_999_9, 89.99, 89.3, 87.0, 86.0];
    for latitude_deg in latitudes_deg {
        let wanted = mirrored(&sky(rig, &north, latitude_deg, 33.0)?);
        worst = worst.max(apart(&sky(rig, &south, -latitude_deg, 33.0)?, &wanted));
        planted = planted.min(apart(&sky(rig, &south, -latitude_deg, 34.0)?, &wanted));
    }
    let check = Check::new("the south pole is the north pole mirrored", FIGURE, latitudes_deg.len());
    report.add(check.found(worst, 1e-3, planted).note("planted: a degree to the east"));

    // Over the pole and down the other side: north turns into south, and the sky stays.
    let (mut worst, mut planted): (f64, f64) = (0.0, f64::INFINITY);
    let longitudes = (0..36).map(|i| 10.0 * f64::from(i));
    for longitude_deg in longitudes.clone() {
        let before = sky(rig, &north, 90.0 - 1e-9, longitude_deg)?;
        let behind = sky(rig, &north, 90.0 - 1e-9, longitude_deg + 180.0)?;
        let around = |sky: &[f32], by: usize| rearranged(sky, |column| (column + by) % AZIMUTH_COUNT);
        worst = worst.max(apart(&behind, &around(&before, AZIMUTH_COUNT / 2)));
        planted = planted.min(apart(&behind, &before));
    }
    let check = Check::new("a step over the north pole", FIGURE, longitudes.count());
    report.add(check.found(worst, 1e-3, planted).note("planted: the sky not turned"));
    Ok(())
}

/// Everywhere: no fault, and the flux of the pixels within 300 km.
fn everywhere(report: &mut Report, rig: &Rig) -> Outcome {
    let folder = Folder::new()?;
    let rasters = [
        about(0.0, 180.0),
        about(60.0, 0.0),
        about(-89.5, 100.0),
        LightRaster::new((-180.0, 90.0), (0.1, 0.05), (3_600, 64), scattered),
        LightRaster::new((-180.0, 90.0), (1.0, 1.0), (360, 180), scattered),
    ];
    let (mut faults, mut worst, mut planted, mut cases) = (Faults::default(), 0f64, 0f64, 0);
    let mut planted_faults = 0;
    for raster in &rasters {
        let scene = folder.scene(raster)?;
        let (width, height) = (raster.size.0, raster.size.1);
        // Corners of pixels, centres, the raster's edges and its middle.
        for x in [0.0, 0.5, 1.0, f64::from(width) / 2.0, f64::from(width) / 2.0 + 0.5, f64::from(width)] {
            for y in [0.0, 0.5, 1.0, f64::from(height / 2), f64::from(height)] {
                let latitude_deg = (raster.north_deg - y * raster.step_deg.1).clamp(-90.0, 90.0);
                let longitude_deg =
                    (raster.west_deg + x * raster.step_deg.0 + 180.0).rem_euclid(360.0) - 180.0;
                let place = GeoPoint::from_deg(latitude_deg, longitude_deg)?;
                let grid = scene.polar_grid(place, false);
                let pixels =
                    scene.source_pixels_within(place, skyglow_physics::source_pixel::MAX_SOURCE_DISTANCE_M);
                let exact: f64 = pixels.iter().map(|pixel| pixel.flux_dnb_w).sum();
                let cells: f64 = grid.cells.iter().map(|cell| f64::from(cell.flux_dnb_w)).sum();
                worst = worst.max((cells - exact).abs() / exact.max(f64::MIN_POSITIVE));
                let dimmed = pixels.iter().skip(1).map(|pixel| pixel.flux_dnb_w).sum::<f64>();
                planted = planted.max((cells - dimmed).abs() / exact.max(f64::MIN_POSITIVE));
                let mut sky = rig.sky(&rig.request(grid)?)?;
                faults += Faults::of_f32(&sky);
                sky[0] = f32::NAN;
                planted_faults = Faults::of_f32(&sky).total();
                cases += 1;
            }
        }
    }
    let check =
        Check::new("poles, seams, corners and centres: no fault", "samples NaN, infinite or negative", cases);
    report.add(check.found(faults.total() as f64, 0.0, planted_faults as f64).note(format!("{faults:?}")));
    let check = Check::new("the same: flux of the pixels within 300 km", "share of it", cases);
    report.add(check.found(worst, 1e-5, planted).note("planted: a pixel left out"));
    Ok(())
}
