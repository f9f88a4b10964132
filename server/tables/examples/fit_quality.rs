//! How well a basis serves single sources that the training set does not hold: projection and half precision
//! alone, no interpolation.
//!
//! `fit_quality TURBIDITY [CACHE_DIR]`: with a cache of `multiple_accuracy` all orders of scattering, else the first. For each of some sources the mean and signed error (lambert, green) over the lowest
//! row, rows 1–7, 8–31, 32–62 and the zenith, relative to max(image, a thousandth of its zenith).

use half::f16;
use skyglow_physics::{Atmosphere, ELEVATION_COUNT, Turbidity, single_source::SourceGeometry};
use skyglow_tables::{
    PrecomputeOptions, Scattering,
    fit::{Projector, dim_factor, sample_weights},
    images::images_of,
    layout::{HALF_COLUMN_COUNT, PIXEL_COUNT, image_index},
    precompute::basis_alone,
};
use std::{error::Error, path::Path};

mod kept_fields;
use kept_fields::kept_table;

/// (distance, source altitude, observer altitude), metres.
const SOURCES: [(f64, f64, f64); 18] = [
    (300.0, 2.0, 2.0),
    (1_000.0, 50.0, 20.0),
    (5_000.0, 10.0, 10.0),
    (20_000.0, 10.0, 10.0),
    (40_000.0, 2.0, 2.0),
    (80_000.0, 2.0, 2.0),
    (100_000.0, 300.0, 2.0),
    (150_000.0, 2.0, 2.0),
    (220_000.0, 2.0, 2.0),
    (60_000.0, 700.0, 300.0),
    (120_000.0, 1_200.0, 2.0),
    (90_000.0, 100.0, 700.0),
    (3_000.0, 1_700.0, 1_650.0),
    (30_000.0, 1_600.0, 1_700.0),
    (100_000.0, 1_700.0, 1_800.0),
    (20_000.0, 500.0, 2_500.0),
    (60_000.0, 200.0, 4_000.0),
    (4_000.0, 900.0, 400.0),
];
const ROWS: [(usize, usize); 5] = [(0, 1), (1, 8), (8, 32), (32, 63), (63, 64)];

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().collect();
    let (turbidity, cache) = match arguments.as_slice() {
        [_, turbidity] => (turbidity, None),
        [_, turbidity, cache] => (turbidity, Some(Path::new(cache))),
        _ => return Err("usage: fit_quality TURBIDITY [CACHE_DIR]".into()),
    };
    let turbidity = Turbidity::new(turbidity.parse()?)?;
    let atmosphere = Atmosphere::new(turbidity);
    let mut options = PrecomputeOptions::full(turbidity);
    options.scattering = if cache.is_some() { Scattering::Multiple } else { Scattering::Single };
    let multiple = match cache {
        Some(cache) => vec![kept_table(atmosphere, cache)?],
        None => Vec::new(),
    };
    let basis = basis_alone(&options, &multiple)?;
    let projector = Projector::new(&basis);
    println!("# mean (signed) error in %: lowest row, rows 1-7, 8-31, 32-62, zenith");
    for (distance_m, source_altitude_m, observer_altitude_m) in SOURCES {
        let geometry = SourceGeometry { distance_m, source_altitude_m, observer_altitude_m };
        let images = images_of(&[atmosphere], &multiple, &geometry).swap_remove(0);
        let shape = &images.shape[image_index(0, 1) * PIXEL_COUNT..][..PIXEL_COUNT];
        let factor = dim_factor(options.scattering, source_altitude_m - observer_altitude_m, distance_m);
        let coefficients = projector.project(&sample_weights(shape, factor), &[shape])?.swap_remove(0);
        let rounded: Vec<f64> = coefficients.iter().map(|&c| f16::from_f64(c).to_f64()).collect();
        let floor = 1e-3 * f64::from(shape[(ELEVATION_COUNT - 1) * HALF_COLUMN_COUNT]);
        print!("{distance_m:7} m {source_altitude_m:5} {observer_altitude_m:5}:");
        for (low, high) in ROWS {
            let (mut mean, mut signed, mut count) = (0.0, 0.0, 0);
            let rows = low * HALF_COLUMN_COUNT..high * HALF_COLUMN_COUNT;
            for (p, &exact) in rows.clone().zip(&shape[rows]) {
                let value: f64 = (0..basis.count)
                    .map(|k| rounded[k] * f64::from(basis.functions[k * PIXEL_COUNT + p]))
                    .sum();
                let exact = f64::from(exact);
                let error = (value.max(0.0) - exact) / exact.max(floor);
                mean += error.abs();
                signed += error;
                count += 1;
            }
            let percent = 100.0 / f64::from(count);
            print!("  {:6.2} ({:+6.2})", mean * percent, signed * percent);
        }
        println!();
    }
    Ok(())
}
