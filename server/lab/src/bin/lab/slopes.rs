//! A table of slopes under a sky beside the sum over its directions: their illuminance.

use crate::arguments::{Outcome, turbidity};
use skyglow_lab::setup::{observatory, open_sky};
use skyglow_observatory::SkyRequest;
use skyglow_physics::{
    AZIMUTH_COUNT, Response, Slope, Turbidity,
    lit_slopes::LitSlopes,
    panorama::{azimuth_rad, cos_sr, projected_sr},
};
use skyglow_scene::SceneId;
use std::{
    f64::consts::{FRAC_PI_2, TAU},
    path::PathBuf,
};

/// Slopes at each place.
const SLOPES_PER_PLACE: usize = 8;
/// Steps of sequences that fill one, two and two more axes evenly (Roberts 2018).
const STEPS: [f64; 4] = [0.754_877_666, 0.569_840_291, 0.819_172_513, 0.671_043_606];
/// Upper ends of classes of steepness, degrees.
const CLASSES_DEG: [f64; 4] = [15.0, 30.0, 45.0, 90.0];

/// Illuminance of slopes and walls under artificial light by the table that pictures of landscapes take it from, beside the sum over all
/// directions: at places drawn evenly from a scene.
#[derive(Debug, clap::Args)]
pub(crate) struct Arguments {
    /// Folder of scenes.
    data: PathBuf,
    /// Folder of packs.
    packs: PathBuf,
    /// Id of the scene.
    #[arg(value_parser = SceneId::parse)]
    scene: SceneId,
    /// Turbidity.
    #[arg(value_parser = turbidity)]
    turbidity: Turbidity,
    /// Places.
    count: usize,
}

pub(crate) fn run(arguments: &Arguments) -> Outcome {
    let observatory = observatory(&arguments.data, &arguments.packs)?;
    let view = observatory.view(&arguments.scene, None)?;
    let (scene, lattice) = (view.scene(), view.scene().place_lattice(usize::MAX));
    for terrain_hides in [false, true] {
        let mut errors: [Vec<[f64; 2]>; 4] = Default::default();
        for number in 0..arguments.count {
            let spread = |step: f64, length: u32| ((number as f64 * step).fract() * f64::from(length)) as u32;
            let place = scene.lattice_place(
                lattice,
                spread(STEPS[0], lattice.columns),
                spread(STEPS[1], lattice.rows),
            );
            let open = open_sky(arguments.scene.clone(), place, arguments.turbidity);
            let Ok(sky) = observatory.sky_blocking(&SkyRequest { terrain_hides, ..open }) else { continue };
            let plane = sky.seen.seen_by(&Response::Photopic).unwrap_or_default();
            let (table, level) = (LitSlopes::of_planes([plane]), direct(plane, Slope::default()));
            if level <= 0.0 {
                continue;
            }
            for nth in 0..SLOPES_PER_PLACE {
                let at = (number * SLOPES_PER_PLACE + nth) as f64;
                let steepness_rad = FRAC_PI_2 * (at * STEPS[2]).fract();
                let downhill_azimuth_rad = TAU * (at * STEPS[3]).fract();
                let slope = Slope { steepness_rad, downhill_azimuth_rad };
                let (found, wanted) =
                    (table.illuminance(steepness_rad, downhill_azimuth_rad)[0], direct(plane, slope));
                let class = CLASSES_DEG.iter().position(|end| steepness_rad.to_degrees() <= *end);
                errors[class.unwrap_or(CLASSES_DEG.len() - 1)]
                    .push([(found - wanted).abs() / level, (found / wanted.max(1e-3 * level) - 1.0).abs()]);
            }
        }
        println!("terrain {}:", if terrain_hides { "on" } else { "off" });
        for (class, errors) in errors.iter().enumerate() {
            let from_deg = if class == 0 { 0.0 } else { CLASSES_DEG[class - 1] };
            print_class(&format!("{from_deg:.0} to {:.0} degrees", CLASSES_DEG[class]), errors);
        }
        print_class("all", &errors.concat());
    }
    Ok(())
}

fn print_class(name: &str, errors: &[[f64; 2]]) {
    let of = |kind: usize| {
        let mut errors: Vec<f64> = errors.iter().map(|error| 100.0 * error[kind]).collect();
        errors.sort_by(f64::total_cmp);
        let at = |part: f64| errors.get(((errors.len().max(1) - 1) as f64 * part) as usize);
        let mean = errors.iter().sum::<f64>() / errors.len().max(1) as f64;
        let [p99, largest] = [0.99, 1.0].map(|part| at(part).copied().unwrap_or(f64::NAN));
        format!("{mean:.2} % mean, {p99:.2} % 99th, {largest:.2} % largest")
    };
    println!("  {name}, {} slopes: of level ground {}; of their own {}", errors.len(), of(0), of(1));
}

/// The sum over all directions, by the exact means over their cells.
fn direct(plane: &[f32], slope: Slope) -> f64 {
    let normal = slope.normal();
    let of_row = |(row, values): (usize, &[f32])| {
        let (up, along) = (normal.z * projected_sr(row), cos_sr(row));
        let of_column = |(column, value): (usize, &f32)| {
            let (sin, cos) = azimuth_rad(column).sin_cos();
            f64::from(*value) * (up + along * (normal.x * sin + normal.y * cos)).max(0.0)
        };
        values.iter().enumerate().map(of_column).sum::<f64>()
    };
    plane.chunks_exact(AZIMUTH_COUNT).enumerate().map(of_row).sum()
}
