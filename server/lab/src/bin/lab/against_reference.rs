//! A panorama against `skyglow reference` at the same place.

use crate::arguments::Outcome;
use serde_json::Value;
use skyglow_physics::{
    error_metric::{ErrorStatistics, LUMINANCE_FLOOR_CD_M2},
    photometry::natural_sky_luminance_cd_m2,
};
use std::{
    error::Error,
    path::{Path, PathBuf},
};

/// What two answers must agree on to be compared.
const SHARED: [&str; 10] = [
    "response",
    "scattering",
    "turbidity",
    "ground_albedo",
    "lamp",
    "emission",
    "light",
    "terrain_occlusion",
    "hidden_lights",
    "calibration",
];

fn read(path: &Path) -> Result<Value, Box<dyn Error>> {
    Ok(serde_json::from_slice(&std::fs::read(path)?)?)
}

/// (fast, reference) luminances of directions [cd m⁻²], `scale` times as bright, as words.
fn words(pairs: &[(f64, f64)], scale: f64) -> Result<String, Box<dyn Error>> {
    let error = |&(fast, reference): &(f64, f64)| {
        scale * (fast - reference).abs() / (scale * reference).max(LUMINANCE_FLOOR_CD_M2)
    };
    let of = ErrorStatistics::of(pairs.iter().map(error)).ok_or("terrain hides every direction")?;
    Ok(format!(
        "mean {:.2} %, 99 % {:.1} %, largest {:.1} %",
        100.0 * of.mean,
        100.0 * of.p99,
        100.0 * of.maximum
    ))
}

/// A panorama against the reference at the same place: the error of luminance (`docs/model.md#error`) over the directions of the
/// reference that terrain does not hide, of artificial light alone. Both with the same parameters, by `skyglow reference … >
/// REFERENCE.json` and `skyglow panorama … -o PANORAMA.json`. The floor of the error is an absolute one, so a second line
/// has both skies scaled to a zenith as bright as the natural one.
#[derive(Debug, clap::Args)]
pub(crate) struct Arguments {
    /// Answer of `skyglow reference`.
    reference: PathBuf,
    /// Answer of `skyglow panorama`.
    panorama: PathBuf,
}

pub(crate) fn run(Arguments { reference, panorama }: &Arguments) -> Outcome {
    let (reference, panorama) = (read(reference)?, read(panorama)?);
    for name in SHARED {
        if reference[name] != panorama[name] {
            return Err(format!("{name} is {} and {}", reference[name], panorama[name]).into());
        }
    }
    let mut pairs = Vec::new();
    let mut highest = (0, 0.0);
    for direction in reference["directions"].as_array().ok_or("the reference has no directions")? {
        let number = |name: &str| direction[name].as_u64().ok_or("a direction has no row or column");
        let (row, column) = (number("row")? as usize, number("column")? as usize);
        let reference = direction["value"].as_f64().ok_or("a direction has no value")?;
        let fast = panorama["values"][row][column].as_f64().ok_or("the panorama has no values")?;
        if reference > 0.0 {
            pairs.push((fast, reference));
            if row >= highest.0 {
                highest = (row, reference);
            }
        }
    }
    let sum = |of: fn(&(f64, f64)) -> f64| pairs.iter().map(of).sum::<f64>();
    println!(
        "{} directions; mean luminance over them {:+.2} %",
        pairs.len(),
        100.0 * (sum(|pair| pair.0) / sum(|pair| pair.1) - 1.0)
    );
    println!("  as they are: {}", words(&pairs, 1.0)?);
    let scale = natural_sky_luminance_cd_m2() / highest.1;
    println!("  with {scale:.3} times the light: {}", words(&pairs, scale)?);
    Ok(())
}
