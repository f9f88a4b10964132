//! The noise of the solver's resolution over distance and altitude.

use crate::arguments::{Outcome, turbidity};
use skyglow_physics::{
    Atmosphere, Band, Turbidity,
    multiple_scattering::{DEFAULT_GROUND_ALBEDO, Resolution, SourceField, SourceSetting, ViewRow},
};
use std::{error::Error, f64::consts::FRAC_PI_2};

const EYE_M: f64 = 2.0;
const MIDDLE: usize = Band::MIDDLE.index();
const LAMBERT: usize = 0;
const HORIZON: usize = 1;
const LOOKS_DEG: [f64; 4] = [90.0, 30.0, 8.0, 0.7];
const BESIDE_RAD: f64 = 0.3;
const DISTANCES: u32 = 36;

/// What the solver's resolution makes of a sky: over the distance, against a finer one, and over the altitude of the
/// source. Later orders in the middle band, observer 2 m above a ground at 0. First `lambert` of a source on the ground over three
/// times as many zenith angles, higher degrees and rings half as far apart, in %, at the zenith and at three elevations 17°
/// beside the source; then, of `horizon` at the zenith, the largest second difference of the logarithm over the source's
/// altitude in steps of 28 m, in %. Two minutes.
#[derive(Debug, clap::Args)]
pub(crate) struct Arguments {
    /// Turbidity.
    #[arg(value_parser = turbidity)]
    turbidity: Turbidity,
}

pub(crate) fn run(Arguments { turbidity }: &Arguments) -> Outcome {
    let air = Atmosphere::new(*turbidity);
    let field = |source_m: f64, resolution: &Resolution| {
        let setting = SourceSetting::new(air, source_m, 0.0, DEFAULT_GROUND_ALBEDO)?;
        Ok::<_, Box<dyn Error>>(SourceField::solve(setting, resolution))
    };
    let table = Resolution::table();
    let fine = Resolution {
        ring_step: 0.1,
        first_degree: 36,
        later_degree: 20,
        first_polar: 36,
        first_around: 26,
        polar_per_hemisphere: 48,
        azimuths: 28,
        ..table
    };
    let fields = [field(0.0, &table)?, field(0.0, &fine)?];
    println!("     km  over the finer, %, {LOOKS_DEG:?} degrees up; in the mean at the end");
    let rows = LOOKS_DEG
        .into_iter()
        .map(f64::to_radians)
        .map(|elevation| Ok([row(&fields[0], elevation)?, row(&fields[1], elevation)?]))
        .collect::<Result<Vec<_>, Box<dyn Error>>>()?;
    let mut sums = vec![0.0; rows.len()];
    for k in 0..DISTANCES {
        let distance_m = 8_000.0 * (300.0f64 / 8.0).powf(f64::from(k) / f64::from(DISTANCES - 1));
        let over = rows.iter().map(|rows| {
            let seen = |row: &ViewRow<'_>| row.radiance_per_watt(distance_m, BESIDE_RAD)[MIDDLE][LAMBERT];
            100.0 * (seen(&rows[0]) / seen(&rows[1]) - 1.0)
        });
        let over: Vec<f64> = over.collect();
        sums.iter_mut().zip(&over).for_each(|(sum, over)| *sum += over);
        println!("{:7.1}  {}", distance_m / 1e3, in_columns(&over));
    }
    let means: Vec<f64> = sums.iter().map(|sum| sum / f64::from(DISTANCES)).collect();
    println!("         {}", in_columns(&means));
    let raised =
        (0..12).map(|k| field(140.0 + 28.0 * f64::from(k), &table)).collect::<Result<Vec<_>, _>>()?;
    let raised = raised.iter().map(zenith).collect::<Result<Vec<_>, _>>()?;
    println!("     km  largest second difference over the source's altitude, %");
    for distance_m in [40e3, 70e3, 110e3, 160e3, 220e3] {
        let log: Vec<f64> =
            raised.iter().map(|row| row.radiance_per_watt(distance_m, 0.0)[MIDDLE][HORIZON].ln()).collect();
        let curvature = log.windows(3).map(|l| (l[2] - 2.0 * l[1] + l[0]).abs()).fold(0.0, f64::max);
        println!("{:7.1}  {:.2}", distance_m / 1e3, 100.0 * curvature);
    }
    Ok(())
}

fn in_columns(values: &[f64]) -> String {
    values.iter().map(|value| format!("{value:+6.2}")).collect::<Vec<_>>().join("  ")
}

fn zenith(field: &SourceField) -> Result<ViewRow<'_>, Box<dyn Error>> {
    row(field, FRAC_PI_2)
}

fn row(field: &SourceField, elevation_rad: f64) -> Result<ViewRow<'_>, Box<dyn Error>> {
    Ok(ViewRow::new(field, EYE_M, elevation_rad)?)
}
