//! A walk through the demo scene, from a town into the mountains: light in blocks against every pixel by itself.

use crate::{
    checks::{Check, Outcome, Report},
    detectors::{Faults, jump},
    geotiff::Folder,
    rig::{Bench, Rig},
    walks::LOOKS,
};
use skyglow_physics::{GeoPoint, Panorama, error_metric::LUMINANCE_FLOOR_CD_M2};
use skyglow_scene::{FAR_BLOCK_RATIO, Scene, create_demo};
use std::error::Error;

/// Steps of the walk.
const STEPS: usize = 150;
/// Length of a step, metres.
const STEP_M: f64 = 40.0;

pub(crate) fn run(bench: &Bench, report: &mut Report) -> Outcome {
    let rig = &bench.shipped;
    let folder = Folder::new()?;
    let metadata = create_demo(folder.store(), &mut |_| ())?;
    let scene = folder.store().open(&metadata.id)?;
    let start = GeoPoint::from_deg(46.17, 8.79)?;
    for terrain_hides in [false, true] {
        let (mut blocks, mut pixels, mut faults) = (Vec::new(), Vec::new(), Faults::default());
        for step in 0..STEPS {
            let place = start.destination(0.3, STEP_M * step as f64);
            let by_blocks = looks_cd_m2(rig, &scene, place, terrain_hides, FAR_BLOCK_RATIO)?;
            faults += Faults::of(by_blocks.iter().copied());
            blocks.push(by_blocks);
            pixels.push(looks_cd_m2(rig, &scene, place, terrain_hides, 0.0)?);
        }
        let (mut worst, mut planted) = (0f64, Vec::new());
        for look in 0..LOOKS.len() {
            let of = |walk: &[Vec<f64>]| -> Vec<f64> { walk.iter().map(|sky| sky[look]).collect() };
            let (mut blocks, pixels) = (of(&blocks), of(&pixels));
            worst = worst.max(jump(&blocks, &pixels, LUMINANCE_FLOOR_CD_M2).0);
            // Every step may be that large by itself: the planted one comes at the quietest place, where it can be seen.
            if blocks.iter().all(|value| *value > LUMINANCE_FLOOR_CD_M2) {
                let quiet = quietest(&blocks);
                blocks[quiet + 1..].iter_mut().for_each(|value| *value *= 1.2);
                planted.push(jump(&blocks, &pixels, LUMINANCE_FLOOR_CD_M2).0);
            }
        }
        let planted = planted.into_iter().reduce(f64::min).unwrap_or(0.0);
        let worst = if faults.total() > 0 { f64::INFINITY } else { worst };
        let terrain = if terrain_hides { "behind terrain" } else { "open" };
        let check = Check::new(
            format!("6 km through the demo, {terrain}: blocks of light as they change"),
            "step beyond that of all pixels",
            STEPS * LOOKS.len(),
        );
        report.add(check.found(worst, 0.01, planted).note("planted: a fifth more behind the quietest step"));
    }
    Ok(())
}

/// The step around which least changes, from the one before it to the one behind.
fn quietest(values: &[f64]) -> usize {
    let change = |at: usize| (values[at] - values[at + 1]).abs() / values[at].max(f64::MIN_POSITIVE);
    let around = |at: usize| change(at - 1).max(change(at)).max(change(at + 1));
    (1..values.len() - 2).min_by(|a, b| around(*a).total_cmp(&around(*b))).unwrap_or(0)
}

fn looks_cd_m2(
    rig: &Rig,
    scene: &Scene,
    place: GeoPoint,
    terrain_hides: bool,
    far_block_ratio: f64,
) -> Result<Vec<f64>, Box<dyn Error>> {
    let mut request = rig.request(scene.polar_grid_with_ratio(place, terrain_hides, far_block_ratio))?;
    request.observer_altitude_m = scene.ground(place).altitude_m() + 1.5;
    let sky = Panorama::from_samples(rig.sky(&request)?).ok_or("a sky of another size")?;
    Ok(LOOKS.iter().map(|&(row, column)| sky.luminance_cd_m2(row, column)).collect())
}
