//! How well a basis serves whole skies, by its size: the classes of places that the fit is judged on, each summed from
//! exact single-source images and from the same images projected on the basis and rounded to half precision. No
//! interpolation takes part, so this is what the compression alone costs.
//!
//! `basis_curve TURBIDITY CACHE|- SIZE,SIZE,… [store=f32|f16|8bit] [train=GEOMETRIES] [split=DISTANCE_M] [altitudes]`: with
//! a cache of `multiple_accuracy` all orders of scattering, with `-` the
//! first. A size is a number of functions, or `MofN`: the first M of a basis fitted with N, as a request for fewer
//! functions has them. For every size and class the mean and 99th percentile of the relative error over all
//! directions, and the errors at the zenith and in horizontal illuminance; "any one source" is the mean over sources that
//! are skies of their own.
//!
//! `store` says how coefficients are rounded (8bit: steps of a 127th of the largest of a node), `train` how many geometries
//! the fit sees, `split` fits one basis for sources nearer than that and one for those farther, `altitudes` one basis for
//! the observer altitudes of the packs around each class's own, instead of one for all.

use rayon::prelude::*;
use skyglow_physics::{
    AZIMUTH_COUNT, Atmosphere, BAND_COUNT, ELEVATION_COUNT, LOBE_COUNT, Turbidity,
    error_metric::{ErrorStatistics, relative_error},
    panorama::{elevation_rad, solid_angle_sr},
    photometry::luminance_cd_m2,
    single_source::SourceGeometry,
};
use skyglow_tables::{
    BasisCount, MultipleTable, PrecomputeOptions, Scattering,
    fit::{dim_factor, sample_weights},
    images::{SourceImages, images_of},
    layout::{HALF_COLUMN_COUNT, PIXEL_COUNT, image_index},
};
use std::{error::Error, path::Path};

#[path = "basis_curve/classes.rs"]
mod classes;
mod kept_fields;
#[path = "basis_curve/trials.rs"]
mod trials;
use classes::{Class, Light};
use kept_fields::kept_table;
use trials::{Bases, Trial};

/// Emission mixes that every class is lit with: `[lambert, horizon, oblique]`.
const MIXES: [(&str, [f64; LOBE_COUNT]); 4] = [
    ("garstang", [0.459_459, 0.540_541, 0.0]),
    ("lambert", [1.0, 0.0, 0.0]),
    ("horizon", [0.0, 1.0, 0.0]),
    ("oblique", [0.0, 0.0, 1.0]),
];
/// Flux in each band per flux of the raster's own: half sodium, half white diodes.
const LAMP: [f64; BAND_COUNT] = [0.408, 0.642, 0.186];
/// Zenith luminance that every scene is scaled to, cd m⁻²: that of the natural sky.
const ZENITH_CD_M2: f64 = 1.7e-4;

/// Exact images of one light, and its place.
struct Lit {
    light: Light,
    images: SourceImages,
    dim_factor: f64,
}

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().collect();
    let [_, turbidity, cache, sizes, trial @ ..] = arguments.as_slice() else {
        return Err(
            "usage: basis_curve TURBIDITY CACHE|- SIZE,SIZE,… [store=…] [train=…] [split=…] [altitudes]"
                .into(),
        );
    };
    let trial = Trial::of(trial)?;
    let turbidity = Turbidity::new(turbidity.parse()?)?;
    let atmosphere = Atmosphere::new(turbidity);
    let mut options = trial.options(PrecomputeOptions::full(turbidity));
    let multiple = if cache == "-" {
        Vec::new()
    } else {
        options.scattering = Scattering::Multiple;
        vec![kept_table(atmosphere, Path::new(cache))?]
    };
    let scenes: Vec<(Class, Vec<Lit>)> = Class::all()
        .into_iter()
        .map(|class| {
            let lit =
                class.lights().into_par_iter().map(|light| lit(&atmosphere, &multiple, &options, light));
            let lit = lit.collect();
            (class, lit)
        })
        .collect();
    println!("# mean, 99 %, zenith, horizontal illuminance, all in %");
    let mut bases: Option<Bases> = None;
    for size in sizes.split(',') {
        let (used, fitted) = size.split_once("of").unwrap_or((size, size));
        let (used, fitted): (usize, usize) = (used.parse()?, fitted.parse()?);
        options.basis_count = BasisCount::same(fitted);
        let bases = match &mut bases {
            Some(bases) if bases.function_count() == fitted => bases,
            bases => bases.insert(Bases::fit(&trial, &options, &multiple)?),
        };
        for (class, lights) in &scenes {
            judge(class, lights, bases, &trial, used, size)?;
        }
    }
    Ok(())
}

fn lit(
    atmosphere: &Atmosphere,
    multiple: &[MultipleTable],
    options: &PrecomputeOptions,
    light: Light,
) -> Lit {
    let geometry: SourceGeometry = light.geometry;
    let images = images_of(&[*atmosphere], multiple, &geometry).swap_remove(0);
    let offset_m = geometry.source_altitude_m - geometry.observer_altitude_m;
    Lit { light, images, dim_factor: dim_factor(options.scattering, offset_m, geometry.distance_m) }
}

/// Skies of every mix `[band][row][column]`, exact and by the first `used` functions of the basis: a line each.
fn judge(
    class: &Class,
    lights: &[Lit],
    bases: &Bases,
    trial: &Trial,
    used: usize,
    size: &str,
) -> Result<(), Box<dyn Error>> {
    // [light][image][sample]
    let fitted: Vec<Vec<f32>> = lights
        .par_iter()
        .map(|lit| {
            let mut samples = vec![0.0f32; lit.images.shape.len()];
            let (basis, projector) = bases.of(&lit.light.geometry);
            for lobe in 0..LOBE_COUNT {
                let shape = |band| &lit.images.shape[image_index(lobe, band) * PIXEL_COUNT..][..PIXEL_COUNT];
                let shapes: [&[f32]; BAND_COUNT] = std::array::from_fn(shape);
                let rows = projector
                    .project(&sample_weights(shapes[1], lit.dim_factor), &shapes)
                    .map_err(|error| error.to_string())?;
                for (band, row) in rows.iter().enumerate() {
                    let out = &mut samples[image_index(lobe, band) * PIXEL_COUNT..][..PIXEL_COUNT];
                    for (k, c) in trial.stored(row).into_iter().take(used).enumerate() {
                        let function = &basis.functions[k * PIXEL_COUNT..][..PIXEL_COUNT];
                        out.iter_mut().zip(function).for_each(|(out, b)| *out += c * b);
                    }
                }
            }
            Ok(samples)
        })
        .collect::<Result<_, String>>()?;
    for (name, mix) in MIXES {
        let judged: Vec<SkyError> = if class.one_by_one() {
            let alone = |light: usize| {
                let one = std::slice::from_ref(&lights[light]);
                let truth = sky(one, mix, |_| &lights[light].images.shape);
                SkyError::of(&sky(one, mix, |_| &fitted[light]), &truth)
            };
            (0..lights.len()).into_par_iter().map(alone).collect()
        } else {
            let truth = sky(lights, mix, |light| &lights[light].images.shape);
            vec![SkyError::of(&sky(lights, mix, |light| &fitted[light]), &truth)]
        };
        let directions = judged.iter().flat_map(|error| error.directions.iter().copied());
        let statistics = ErrorStatistics::of(directions).ok_or("an empty sky")?;
        let mean = |of: fn(&SkyError) -> f64| judged.iter().map(of).sum::<f64>() / judged.len() as f64;
        println!(
            "{size:7} {:28} {name:9} {:7.3} {:8.3} {:8.3} {:8.3}",
            class.name(),
            100.0 * statistics.mean,
            100.0 * statistics.p99,
            100.0 * mean(|error| error.zenith),
            100.0 * mean(|error| error.horizontal),
        );
    }
    Ok(())
}

/// Relative errors of one sky.
struct SkyError {
    /// In every direction.
    directions: Vec<f64>,
    /// Of the zenith's luminance.
    zenith: f64,
    /// Of horizontal illuminance.
    horizontal: f64,
}

impl SkyError {
    /// Of skies `[band][row][column]`.
    fn of(fast: &[f64], truth: &[f64]) -> Self {
        let to_scale = ZENITH_CD_M2 / luminance_cd_m2(zenith(truth)).max(f64::MIN_POSITIVE);
        let at = |sky: &[f64], p: usize| -> [f64; BAND_COUNT] {
            std::array::from_fn(|band| to_scale * sky[band * ELEVATION_COUNT * AZIMUTH_COUNT + p].max(0.0))
        };
        let horizontal = |sky: &[f64]| -> f64 {
            (0..ELEVATION_COUNT * AZIMUTH_COUNT)
                .map(|p| {
                    let row = p / AZIMUTH_COUNT;
                    luminance_cd_m2(at(sky, p)) * solid_angle_sr(row) * elevation_rad(row).sin()
                })
                .sum()
        };
        let part = |value: f64, truth: f64| (value / truth.max(f64::MIN_POSITIVE) - 1.0).abs();
        Self {
            directions: (0..ELEVATION_COUNT * AZIMUTH_COUNT)
                .map(|p| relative_error(at(fast, p), at(truth, p)))
                .collect(),
            zenith: part(luminance_cd_m2(zenith(fast)), luminance_cd_m2(zenith(truth))),
            horizontal: part(horizontal(fast), horizontal(truth)),
        }
    }
}

/// Mean of the highest row, `[band]`.
fn zenith(sky: &[f64]) -> [f64; BAND_COUNT] {
    std::array::from_fn(|band| {
        let start = (band * ELEVATION_COUNT + ELEVATION_COUNT - 1) * AZIMUTH_COUNT;
        sky[start..start + AZIMUTH_COUNT].iter().sum::<f64>() / AZIMUTH_COUNT as f64
    })
}

/// The sum of all lights, `[band][row][column]`.
fn sky<'a>(lights: &'a [Lit], mix: [f64; LOBE_COUNT], shape: impl Fn(usize) -> &'a Vec<f32>) -> Vec<f64> {
    let mut sky = vec![0.0f64; BAND_COUNT * ELEVATION_COUNT * AZIMUTH_COUNT];
    for (index, lit) in lights.iter().enumerate() {
        let shape = shape(index);
        for band in 0..BAND_COUNT {
            for (lobe, share) in mix.into_iter().enumerate().filter(|(_, share)| *share > 0.0) {
                let image = image_index(lobe, band);
                let factor = share * LAMP[band] * lit.light.flux * lit.images.log_scale[image].exp();
                for row in 0..ELEVATION_COUNT {
                    let samples =
                        &shape[image * PIXEL_COUNT + row * HALF_COLUMN_COUNT..][..HALF_COLUMN_COUNT];
                    let out = &mut sky[(band * ELEVATION_COUNT + row) * AZIMUTH_COUNT..][..AZIMUTH_COUNT];
                    for (column, out) in out.iter_mut().enumerate() {
                        let turned = (column + AZIMUTH_COUNT - lit.light.column) % AZIMUTH_COUNT;
                        *out += factor * f64::from(samples[turned.min(AZIMUTH_COUNT - turned)]);
                    }
                }
            }
        }
    }
    sky
}
