//! The table of multiply scattered light against fields of the very source.

use crate::arguments::{Outcome, turbidity};
use skyglow_lab::field_cache::stored_table;
use skyglow_physics::{
    Atmosphere, BAND_COUNT, LOBE_COUNT, Turbidity,
    multiple_scattering::{DEFAULT_GROUND_ALBEDO, Resolution, SourceField, SourceSetting},
    panorama::{azimuth_rad, elevation_rad},
    single_source::{SourceGeometry, radiance_per_watt_of},
};
use skyglow_tables::layout::image_index;
use std::{error::Error, path::PathBuf, time::Instant};

/// Rows and columns tried of each source.
const ROWS: [usize; 5] = [0, 3, 9, 25, 63];
const COLUMNS: [usize; 5] = [0, 5, 28, 70, 120];

/// Source `i` of an even spread over distance, observer altitude and offset.
fn geometry(i: usize) -> SourceGeometry {
    let spread = |ratio: f64| (i as f64 * ratio).fract();
    let distance_m = 250.0 * 1_200f64.powf(spread(0.819_172_5));
    let observer_altitude_m = 4_000.0 * spread(0.671_043_6).powi(2);
    let highest_m = (0.4 * distance_m).min(4_000.0 - observer_altitude_m);
    let offset_m = -observer_altitude_m + (observer_altitude_m + highest_m) * spread(0.549_700_5);
    SourceGeometry { distance_m, source_altitude_m: observer_altitude_m + offset_m, observer_altitude_m }
}

/// The sources asked for.
fn sources(text: &str) -> Result<Vec<SourceGeometry>, Box<dyn Error>> {
    if let Ok(count) = text.parse() {
        return Ok((1..=count).map(geometry).collect());
    }
    text.split(',')
        .map(|part| {
            let numbers: Vec<f64> = part.split(':').map(str::parse).collect::<Result<_, _>>()?;
            match numbers[..] {
                [distance_m, source_altitude_m, observer_altitude_m] => {
                    Ok(SourceGeometry { distance_m, source_altitude_m, observer_altitude_m })
                }
                _ => Err(format!("{part}: expected distance_m:source_m:observer_m").into()),
            }
        })
        .collect()
}

/// What interpolation costs: the table of multiply scattered light against fields solved for the very source. Errors are
/// relative to the whole radiance, first order included.
#[derive(Debug, clap::Args)]
pub(crate) struct Arguments {
    /// Turbidity.
    #[arg(value_parser = turbidity)]
    turbidity: Turbidity,
    /// How many sources of an even spread, or a list of `distance_m:source_m:observer_m`.
    sources: String,
    /// Folder where parts of the table are stored, of this turbidity alone.
    cache: PathBuf,
}

pub(crate) fn run(Arguments { turbidity, sources: asked, cache }: &Arguments) -> Outcome {
    let atmosphere = Atmosphere::new(*turbidity);
    let started = Instant::now();
    let table = stored_table(atmosphere, cache)?;
    println!("# table after {:.1} s", started.elapsed().as_secs_f64());
    let mut all = Vec::new();
    for geometry in sources(asked)? {
        let setting = SourceSetting::for_observer(
            atmosphere,
            geometry.source_altitude_m,
            geometry.observer_altitude_m,
            DEFAULT_GROUND_ALBEDO,
        )?;
        let field = SourceField::solve(setting, &Resolution::table());
        let mut errors = Vec::new();
        let mut signed = 0.0;
        for row in ROWS {
            for column in COLUMNS {
                let (azimuth, elevation) = (azimuth_rad(column), elevation_rad(row));
                let own = field.radiance_per_watt(&geometry, azimuth, elevation)?;
                let first = radiance_per_watt_of(&atmosphere, &geometry, azimuth, elevation, 1e-5);
                let got = table.radiance_per_watt(&geometry, row, column);
                for band in 0..BAND_COUNT {
                    for lobe in 0..LOBE_COUNT {
                        let own = own[band][lobe];
                        let error =
                            (got[image_index(lobe, band)] - own) / (own + first[band][lobe]).max(1e-30);
                        signed += error;
                        errors.push(error.abs());
                    }
                }
            }
        }
        let (mean, p99) = figures(&mut errors);
        println!(
            "{:9.0} m, source at {:5.0} m, observer at {:5.0} m: mean {:6.2} %, 99 % {:6.2} %, bias {:+6.2} %",
            geometry.distance_m,
            geometry.source_altitude_m,
            geometry.observer_altitude_m,
            100.0 * mean,
            100.0 * p99,
            100.0 * signed / errors.len() as f64
        );
        all.extend(errors);
    }
    let (mean, p99) = figures(&mut all);
    println!("all: mean {:.2} %, 99 % {:.2} %", 100.0 * mean, 100.0 * p99);
    Ok(())
}

fn figures(errors: &mut [f64]) -> (f64, f64) {
    errors.sort_by(f64::total_cmp);
    (errors.iter().sum::<f64>() / errors.len() as f64, errors[errors.len() * 99 / 100])
}
