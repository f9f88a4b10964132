//! f32 against f64, pass by pass, in both executors: each on a pack in which the other passes have nothing to round.

use crate::{
    checks::{Check, Outcome, Report},
    detectors::{Faults, lost_digits},
    plain::{self, fill_scale, fill_shape, make_needle, make_uniform},
    rig::{Bench, Lamp, Rig, grid_of, row_maxima, widened},
};
use skyglow_physics::{AZIMUTH_COUNT, ELEVATION_COUNT, EmissionMix, Turbidity};
use skyglow_render::{RenderRequest, synthetic::Noise};
use skyglow_scene::RING_COUNT;
use skyglow_tables::ResidentTables;
use std::{error::Error, sync::Arc};

/// What a change of a tenth of a per mille makes of every figure here: more than any limit.
const PLANTED: f32 = 1.000_1;

pub(crate) fn run(_: &Bench, report: &mut Report) -> Outcome {
    mix_scale(report)?;
    cell_weights(report)?;
    mix_shape(report)?;
    coefficients(report)?;
    transforms(report)?;
    basis_sum(report)?;
    blend(report)
}

/// Renders a request by every executor and in f64; `magnitude` is what the samples were summed from, given them in f64.
fn compare(
    report: &mut Report,
    name: &str,
    rig: &Rig,
    request: &RenderRequest,
    limit: f64,
    magnitude: impl Fn(&[f64]) -> Vec<f64>,
) -> Result<(), Box<dyn Error>> {
    let exact = rig.exact(request)?;
    let magnitude = magnitude(&exact);
    let mut changed = request.clone();
    for flux in &mut changed.flux_per_dnb_flux {
        *flux *= f64::from(PLANTED);
    }
    for ((executor, sky), (_, wrong)) in rig.skies(request)?.into_iter().zip(rig.skies(&changed)?) {
        let error = |sky: &[f32]| lost_digits(widened(sky), exact.clone(), magnitude.clone());
        let faults = Faults::of_f32(&sky).total();
        let worst = if faults > 0 { f64::INFINITY } else { error(&sky) };
        let check = Check::new(format!("{name}, {executor}"), "f32 − f64 over what was summed", sky.len());
        report.add(check.found(worst, limit, error(&wrong)));
    }
    Ok(())
}

fn rig(tables: impl IntoIterator<Item = ResidentTables>) -> Result<Rig, Box<dyn Error>> {
    Ok(Rig::of(tables.into_iter().map(Arc::new).collect())?)
}

/// A lamp in every fourth column on another ring, its altitude spread over the offset axis.
fn scattered_lamps(flux_dnb_w: impl Fn(usize) -> f32) -> Vec<Lamp> {
    (0..AZIMUTH_COUNT)
        .step_by(4)
        .map(|column| {
            Lamp::open(column, (column * 3 % RING_COUNT) as u32, flux_dnb_w(column), 7.0 * column as f32)
        })
        .collect()
}

fn itself(exact: &[f64]) -> Vec<f64> {
    exact.to_vec()
}

/// Logarithms from −70 to −10 between observer altitudes and lobes; the rest exact: needles of shape 1.
fn mix_scale(report: &mut Report) -> Outcome {
    let mut tables = plain::tables(2.0, 4);
    fill_scale(&mut tables, 1, -40.0, -12.0);
    fill_shape(&mut tables, |_, k| f64::from(u8::from(k == 0)));
    make_uniform(&mut tables, 0, |_| 1.0);
    let rig = rig([tables])?;
    let mut request = rig.request(grid_of(&[Lamp::open(0, 60, 1e6, 900.0)]))?;
    request.emission = EmissionMix::new([0.5, 0.3, 0.2])?;
    request.observer_altitude_m = 1_140.0;
    compare(report, "mix_scale: lobes and altitudes of scales e^-40 to e^-12", &rig, &request, 3e-5, itself)
}

/// One altitude and one lobe, so that scales are the tables'; fluxes from 1e-6 to 1e12 W between offsets.
fn cell_weights(report: &mut Report) -> Outcome {
    let mut tables = plain::tables(2.0, 4);
    fill_scale(&mut tables, 2, -40.0, -12.0);
    fill_shape(&mut tables, |_, k| f64::from(u8::from(k == 0)));
    make_needle(&mut tables, 0);
    let rig = rig([tables])?;
    // Every sample of a row but the lamp's own is 0: each is measured against itself where it is lit.
    for exponent in [-6, 3, 12] {
        let lamp = Lamp::open(17, 90, 10f32.powi(exponent), 512.0);
        let mut request = rig.request(grid_of(&[lamp]))?;
        request.emission = EmissionMix::lambert();
        request.observer_altitude_m = 700.0;
        let name = format!("cell_weights: between offsets, 1e{exponent} W");
        compare(report, &name, &rig, &request, 3e-5, row_maxima)?;
    }
    Ok(())
}

/// Shapes of 64 functions between altitudes and offsets; function k is seen in row k alone. Halfway between two altitudes, where every
/// executor mixes all that it sums; how kept shapes lie between such steps is a question of the tables, not of digits.
fn mix_shape(report: &mut Report) -> Outcome {
    let mut tables = plain::tables(2.0, ELEVATION_COUNT);
    let mut noise = Noise::new(3);
    fill_shape(&mut tables, |_, _| 0.5 + noise.unit());
    (0..ELEVATION_COUNT).for_each(|k| make_uniform(&mut tables, k, |row| f64::from(u8::from(row == k))));
    let altitude_m = 0.5 * (tables.observer_altitude_m[1] + tables.observer_altitude_m[2]);
    let rig = rig([tables])?;
    let mut request = rig.request(grid_of(&[Lamp::open(0, 60, 1.0, 900.0)]))?;
    request.emission = EmissionMix::new([0.5, 0.3, 0.2])?;
    request.observer_altitude_m = altitude_m;
    compare(report, "mix_shape: 64 functions, four altitudes, three lobes", &rig, &request, 2e-6, itself)
}

/// A column with light in every ring, brightest and dimmest 1e18 apart, brightest last and first.
fn coefficients(report: &mut Report) -> Outcome {
    let mut tables = plain::tables(2.0, 4);
    fill_shape(&mut tables, |offset, k| if k == 0 { 1.0 + offset as f64 / 8.0 } else { 0.0 });
    make_uniform(&mut tables, 0, |_| 1.0);
    let rig = rig([tables])?;
    for (name, rising) in [("brightest last", 1.0f32), ("brightest first", -1.0)] {
        let lamps: Vec<Lamp> = (0..RING_COUNT as u32)
            .map(|ring| {
                let flux_w = 10f32.powf(3.0 + rising * 9.0 * (ring as f32 / 95.5 - 1.0));
                Lamp::open(5, ring, flux_w, 640.0 + 11.0 * ring as f32)
            })
            .collect();
        let request = rig.request(grid_of(&lamps))?;
        compare(
            report,
            &format!("coefficients: 192 cells, 1e18 in flux, {name}"),
            &rig,
            &request,
            1e-5,
            itself,
        )?;
    }
    // As many as a column can have, all alike: rounding that drifts one way would add up.
    let lamps: Vec<Lamp> = (0..RING_COUNT as u32).map(|ring| Lamp::open(5, ring, 1.1, 640.0)).collect();
    let request = rig.request(grid_of(&lamps))?;
    compare(report, "coefficients: 192 cells alike", &rig, &request, 1e-5, itself)
}

/// Forward and back: every column lit, by up to 1e12 more than its neighbour; needles give each column itself.
fn transforms(report: &mut Report) -> Outcome {
    let mut tables = plain::tables(2.0, 4);
    fill_shape(&mut tables, |_, k| f64::from(u8::from(k == 0)));
    make_needle(&mut tables, 0);
    let rig = rig([tables])?;
    let mut noise = Noise::new(4);
    let columns: Vec<f32> = (0..AZIMUTH_COUNT).map(|_| 10f64.powf(12.0 * noise.unit()) as f32).collect();
    let every: Vec<Lamp> = (0..AZIMUTH_COUNT).map(|c| Lamp::open(c, 60, columns[c], 640.0)).collect();
    for (name, lamps) in [("all 256 columns lit", every), ("every fourth", scattered_lamps(|c| columns[c]))] {
        let request = rig.request(grid_of(&lamps))?;
        let name = format!("azimuth_fft and inverse_fft: {name}, 1e12 in flux");
        compare(report, &name, &rig, &request, 1e-5, row_maxima)?;
    }
    Ok(())
}

/// 256 functions that nearly cancel: seen against the sum of their sizes.
fn basis_sum(report: &mut Report) -> Outcome {
    const COUNT: usize = 256;
    let make = |sign: f64| {
        let mut tables = plain::tables(2.0, COUNT);
        fill_shape(&mut tables, |_, _| 1.0);
        for k in 0..COUNT {
            let sign = if k % 2 == 0 { 1.0 } else { sign };
            make_uniform(&mut tables, k, |row| sign * (2.0 + ((k / 2 * (row + 3)) as f64).sin()) + 1e-3);
        }
        tables
    };
    let (rig, sizes) = (rig([make(-1.0)])?, rig([make(1.0)])?);
    let request = rig.request(grid_of(&[Lamp::open(0, 60, 1.0, 640.0)]))?;
    let magnitude = sizes.exact(&request)?;
    // A planted change moves the sum by its own size, a fortieth of that of the terms.
    compare(report, "basis_sum: 256 functions that cancel to a thousandth", &rig, &request, 3e-8, |exact| {
        let share = exact.iter().zip(&magnitude).map(|(e, m)| e / m).fold(0.0, f64::max);
        assert!(share > 0.0, "nothing is left to measure");
        magnitude.clone()
    })
}

/// Four packs that differ by up to 1e6, rows from far below the floor to brighter than any sky.
fn blend(report: &mut Report) -> Outcome {
    let turbidities = [1.5, 2.5, 3.5, 4.75];
    let mut noise = Noise::new(5);
    let packs: Vec<ResidentTables> = turbidities
        .map(|turbidity| {
            let mut tables = plain::tables(turbidity, 4);
            fill_shape(&mut tables, |_, k| f64::from(u8::from(k == 0)));
            let factors: Vec<f64> = (0..ELEVATION_COUNT).map(|_| 10f64.powf(2.0 * noise.unit())).collect();
            make_uniform(&mut tables, 0, |row| 10f64.powf(-12.0 + 0.25 * row as f64) * factors[row]);
            tables
        })
        .into();
    let rig = rig(packs)?;
    for turbidity in [2.0, 2.5 + 1e-6, 3.0, 4.749_999] {
        let mut request = rig.request(grid_of(&[Lamp::open(0, 60, 1.0, 640.0)]))?;
        request.turbidity = Turbidity::new(turbidity)?;
        let name = format!("blend: 1e-12 to 1e6 W m-2 sr-1 at turbidity {turbidity}");
        compare(report, &name, &rig, &request, 2e-5, itself)?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_pass_of_both_executors_keeps_its_digits() {
        let mut report = Report::new();
        let set_up = [mix_scale, cell_weights, mix_shape, coefficients, transforms, basis_sum, blend];
        report.run("passes", |report| set_up.iter().try_for_each(|check| check(report)));
        assert_eq!(report.failed(), 0);
    }
}
