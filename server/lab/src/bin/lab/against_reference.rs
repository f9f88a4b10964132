//! A panorama against `skyglow reference` at the same place.

use crate::arguments::Outcome;
use serde_json::Value;
use skyglow_physics::{
    BAND_COUNT,
    error_metric::{ErrorStatistics, relative_error},
    photometry::{luminance_cd_m2, natural_sky_luminance_cd_m2},
};
use std::{
    error::Error,
    path::{Path, PathBuf},
};

type Bands = [f64; BAND_COUNT];

/// What two answers must agree on to be compared.
const SHARED: [&str; 9] = [
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

/// Radiance of the panorama at a sample.
fn at(panorama: &Value, row: usize, column: usize) -> Result<Bands, Box<dyn Error>> {
    let mut bands = [0.0; BAND_COUNT];
    for (band, value) in bands.iter_mut().enumerate() {
        *value = panorama["radiance"][band][row][column].as_f64().ok_or("the panorama has no radiance")?;
    }
    Ok(bands)
}

fn words(pairs: &[(Bands, Bands)], scale: f64) -> Result<String, Box<dyn Error>> {
    let scaled = |bands: Bands| bands.map(|value| value * scale);
    let errors = pairs.iter().map(|&(fast, reference)| relative_error(scaled(fast), scaled(reference)));
    let of = ErrorStatistics::of(errors).ok_or("terrain hides every direction")?;
    Ok(format!(
        "mean {:.2} %, 99 % {:.1} %, largest {:.1} %",
        100.0 * of.mean,
        100.0 * of.p99,
        100.0 * of.maximum
    ))
}

/// A panorama against the reference at the same place: the error of `docs/model.md#error` over the directions of the reference
/// that terrain does not hide, of artificial light alone. Both with the same parameters, by `skyglow reference … >
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
        let reference: Bands = serde_json::from_value(direction["radiance"].clone())?;
        let number = |name: &str| direction[name].as_u64().ok_or("a direction has no row or column");
        let (row, column) = (number("row")? as usize, number("column")? as usize);
        if reference != [0.0; BAND_COUNT] {
            pairs.push((at(&panorama, row, column)?, reference));
            if row >= highest.0 {
                highest = (row, luminance_cd_m2(reference));
            }
        }
    }
    let sum =
        |of: fn(&(Bands, Bands)) -> Bands| pairs.iter().map(|pair| luminance_cd_m2(of(pair))).sum::<f64>();
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
