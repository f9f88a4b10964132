//! What the polar grid alone costs in the classes of places: every cell of it summed from exact images instead of a pack's,
//! against the same truth as `class_accuracy`.
//!
//! `class_sampling CACHE TRUTH_FILE...`: truths of `class_truth`, all of the one turbidity that CACHE (of
//! `multiple_accuracy`) has fields for. Mean, 99th percentile, zenith and horizontal illuminance in %, for each mix of lobes. A light in
//! the grid stands in the middle of a column; what differs is mostly a row of directions that look past one within a pixel.

use rayon::prelude::*;
use skyglow_bench::{accuracy::zenith_and_horizontal, scenes::grid_under_open_sky};
use skyglow_physics::{
    AZIMUTH_COUNT, Atmosphere, BAND_COUNT, LOBE_COUNT, LampPreset, Turbidity,
    photometry::natural_sky_luminance_cd_m2, single_source::SourceGeometry,
};
use skyglow_scene::{PolarGrid, ring_distance_m};
use skyglow_tables::{
    MultipleTable,
    images::images_of,
    layout::{HALF_COLUMN_COUNT, IMAGE_COUNT, PIXEL_COUNT, image_index},
};
use skyglow_tests::{
    class_scenes::Class,
    lobe_truth::LobeTruth,
    sky_errors::{mixes, sky_errors},
};
use std::{error::Error, path::Path};

#[path = "../../server/tables/examples/kept_fields/mod.rs"]
mod kept_fields;
use kept_fields::kept_table;

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().collect();
    let [_, cache, files @ ..] = arguments.as_slice() else {
        return Err("usage: class_sampling CACHE TRUTH_FILE...".into());
    };
    let mut fields: Option<(f64, Vec<MultipleTable>)> = None;
    for file in files {
        let truth = LobeTruth::read(Path::new(file))?;
        let turbidity = Turbidity::new(truth.turbidity)?;
        let air = Atmosphere::new(turbidity);
        let (of, multiple) = match &mut fields {
            Some(fields) => fields,
            fields => fields.insert((truth.turbidity, vec![kept_table(air, Path::new(cache))?])),
        };
        if *of != truth.turbidity {
            return Err(format!("{file} is of turbidity {}, the fields of {of}", truth.turbidity).into());
        }
        let class = Class::from_name(&truth.name).ok_or("a truth of no known class")?;
        let scenes = class.scenes();
        let same = scenes.iter().find(|scene| scene.observer_altitude_m == truth.observer_altitude_m);
        let grid = grid_under_open_sky(&same.ok_or("a truth of no known observer")?.sources);
        judge(&truth, &sky_of_cells(&truth, &grid, air, multiple))?;
    }
    Ok(())
}

/// Radiance per DNB watt in the truth's directions, `[direction][image]`.
fn sky_of_cells(
    truth: &LobeTruth,
    grid: &PolarGrid,
    air: Atmosphere,
    multiple: &[MultipleTable],
) -> Vec<f64> {
    let cells: Vec<(usize, usize)> = (0..AZIMUTH_COUNT)
        .flat_map(|column| {
            (grid.azimuth_start[column]..grid.azimuth_start[column + 1])
                .map(move |cell| (column, cell as usize))
        })
        .collect();
    let nothing = || vec![0.0f64; truth.samples.len() * IMAGE_COUNT];
    let add = |mut sky: Vec<f64>, &(column, cell): &(usize, usize)| {
        let cell = grid.cells[cell];
        let geometry = SourceGeometry {
            distance_m: ring_distance_m(cell.ring as usize),
            source_altitude_m: f64::from(cell.altitude_m),
            observer_altitude_m: truth.observer_altitude_m,
        };
        let images = images_of(&[air], multiple, &geometry).swap_remove(0);
        for (out, &(row, at)) in sky.chunks_exact_mut(IMAGE_COUNT).zip(&truth.samples) {
            let turned = (at + AZIMUTH_COUNT - column) % AZIMUTH_COUNT;
            let pixel = row * HALF_COLUMN_COUNT + turned.min(AZIMUTH_COUNT - turned);
            for (image, out) in out.iter_mut().enumerate() {
                let shape = f64::from(images.shape[image * PIXEL_COUNT + pixel]);
                *out += f64::from(cell.flux_dnb_w) * images.log_scale[image].exp() * shape;
            }
        }
        sky
    };
    let join = |mut sky: Vec<f64>, more: Vec<f64>| {
        sky.iter_mut().zip(more).for_each(|(sum, value)| *sum += value);
        sky
    };
    cells.par_iter().fold(nothing, add).reduce(nothing, join)
}

fn judge(truth: &LobeTruth, sky: &[f64]) -> Result<(), Box<dyn Error>> {
    let flux_per_dnb_flux = LampPreset::Mixed.lamp().flux_per_dnb_flux;
    for (name, emission) in mixes() {
        let mut exact = truth.mixed_w_m2_sr(emission, flux_per_dnb_flux);
        let scale = natural_sky_luminance_cd_m2() / zenith_and_horizontal(&truth.samples, &exact)[0];
        exact.as_flattened_mut().iter_mut().for_each(|value| *value *= scale);
        let mixed = |images: &[f64], band: usize| -> f64 {
            let lobes = emission.weights().into_iter().enumerate();
            lobes.map(|(lobe, weight)| weight * images[image_index(lobe, band)]).sum()
        };
        let fast: Vec<[f64; BAND_COUNT]> = sky
            .chunks_exact(BAND_COUNT * LOBE_COUNT)
            .map(|images| std::array::from_fn(|band| scale * flux_per_dnb_flux[band] * mixed(images, band)))
            .collect();
        let errors = sky_errors(&truth.samples, &fast, &exact).ok_or("no directions")?;
        let [mean, p99, zenith, horizontal] = errors.map(|error| 100.0 * error);
        let sky = format!("{} {:.0} m T {:.2}", truth.name, truth.observer_altitude_m, truth.turbidity);
        println!("{sky:36} {name:9} {mean:7.3} {p99:8.3} {zenith:+8.3} {horizontal:+8.3}");
    }
    Ok(())
}
