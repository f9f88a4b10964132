//! Sources behind skylines as a pack has them, against fields of their own.

use crate::arguments::Outcome;
use skyglow_lab::pack_source::{basis_sample, coefficients_at};
use skyglow_physics::{
    Atmosphere, BAND_COUNT, ELEVATION_COUNT, EmissionMix, LOBE_COUNT, Turbidity,
    blocking::{BLOCKING_ANGLES_DEG, blocking_position},
    error_metric::{ErrorStatistics, relative_error},
    multiple_scattering::{Resolution, SourceField, SourceSetting},
    panorama::{azimuth_rad, elevation_rad},
    photometry::luminance_cd_m2,
    single_source::{SourceGeometry, cut_radiance_per_watt_of},
};
use skyglow_tables::{Pack, layout::HALF_COLUMN_COUNT};
use std::{error::Error, path::PathBuf};

/// Luminance of the natural sky, cd m⁻².
const NATURAL_CD_M2: f64 = 1.7e-4;
/// Largest upward flux of a city, W.
const MAX_FLUX_W: f64 = 1e8;
const DIRECTION_COUNT: usize = 40;

/// One radiance a band, W m⁻² sr⁻¹ per watt.
type Bands = [f64; BAND_COUNT];

/// What a pack makes of sources behind skylines, between all its nodes, against what is computed for the very source and
/// skyline: the first order by the adaptive rule, later orders from a field of its own. Everyday sources: 1–150 km away,
/// 0–2 000 m high, seen from 0–3 000 m, skylines of 0.3–25°, `garstang` lobes; the flux gives the open zenith the natural
/// sky's luminance, but is 100 MW at most. Errors are those of section 9 of the model over 40 directions a source.
#[derive(Debug, clap::Args)]
pub(crate) struct Arguments {
    /// Pack.
    pack: PathBuf,
    /// How many sources.
    sources: u32,
    /// Skylines are those of the tables, so that what interpolation over the angle costs is left out.
    #[arg(long)]
    nodes: bool,
}

pub(crate) fn run(Arguments { pack, sources, nodes }: &Arguments) -> Outcome {
    let pack = Pack::open(pack)?;
    let atmosphere = Atmosphere::new(Turbidity::new(pack.manifest().turbidity)?);
    let lobes = EmissionMix::garstang().weights();
    let Some(axes) = &pack.manifest().blocked else { return Err("the pack holds the open sky alone".into()) };
    // A pack made for trying may hold less.
    let nearest_m = (1.5 * axes.distance_m[0]).max(1_000.0);
    let farthest_m = (axes.distance_m[axes.distance_m.len() - 1] / 1.5).min(150_000.0);
    let highest_m = axes.observer_altitude_m[axes.observer_altitude_m.len() - 1].min(3_000.0);
    let (mut all, mut all_open, mut all_dark) = (Vec::new(), Vec::new(), Vec::new());
    let mut cells: Vec<(f64, f64, f64)> = Vec::new();
    for i in 1..=*sources {
        let spread = |ratio: f64| (f64::from(i) * ratio + 0.17).fract();
        let distance_m = nearest_m * (farthest_m / nearest_m).powf(spread(0.856_674_9));
        let source_altitude_m = 2_000.0 * spread(0.733_891_9).powi(2);
        let observer_altitude_m = highest_m * spread(0.628_706_7).powi(2);
        let mut angle_deg = 0.3 * (25.0f64 / 0.3).powf(spread(0.538_597_3));
        if *nodes {
            let (lower, weight) = blocking_position(angle_deg);
            angle_deg = BLOCKING_ANGLES_DEG[(lower + usize::from(weight > 0.5)).max(1)];
        }
        let geometry = SourceGeometry { distance_m, source_altitude_m, observer_altitude_m };
        let tables = pack.resident(&[distance_m]);
        let offset_m = source_altitude_m - observer_altitude_m;
        let open = coefficients_at(&tables, 0, observer_altitude_m, offset_m, lobes);
        let (lower, upper_weight) = blocking_position(angle_deg);
        let mut mixed = vec![vec![0.0; tables.basis_count]; BAND_COUNT];
        for (angle, weight) in [(lower, 1.0 - upper_weight), (lower + 1, upper_weight)] {
            if weight > 0.0 {
                let bands = coefficients_at(&tables, angle, observer_altitude_m, offset_m, lobes);
                for (sum, values) in mixed.iter_mut().zip(&bands) {
                    for (sum, value) in sum.iter_mut().zip(values) {
                        *sum += weight * value;
                    }
                }
            }
        }
        let evaluate = |bands: &[Vec<f64>], row: usize, column: usize| -> Bands {
            std::array::from_fn(|band| {
                let value: f64 = bands[band]
                    .iter()
                    .enumerate()
                    .map(|(k, c)| c * basis_sample(&tables, k, row, column))
                    .sum();
                value.max(0.0)
            })
        };
        // The reference at a skyline, `None` without later orders.
        let fields = [0.0, angle_deg].map(|angle_deg: f64| -> Result<Option<SourceField>, Box<dyn Error>> {
            let Some(albedo) = pack.manifest().ground_albedo else { return Ok(None) };
            let setting =
                SourceSetting::for_observer(atmosphere, source_altitude_m, observer_altitude_m, albedo)?
                    .behind(angle_deg.to_radians())?;
            Ok(Some(SourceField::solve(setting, &Resolution::table())))
        });
        let [open_field, cut_field] = fields;
        let reference = |field: &Option<SourceField>, angle_deg: f64, row: usize, column: usize| {
            let (azimuth, elevation) = (azimuth_rad(column), elevation_rad(row));
            let mut sky = cut_radiance_per_watt_of(
                &atmosphere,
                &geometry,
                angle_deg.to_radians(),
                azimuth,
                elevation,
                1e-5,
            );
            if let Some(field) = field {
                let later = field.radiance_per_watt(&geometry, azimuth, elevation)?;
                for (sum, later) in sky.as_flattened_mut().iter_mut().zip(later.as_flattened()) {
                    *sum += later;
                }
            }
            let bands: Bands =
                std::array::from_fn(|band| (0..LOBE_COUNT).map(|lobe| lobes[lobe] * sky[band][lobe]).sum());
            Ok::<Bands, Box<dyn Error>>(bands)
        };
        let (open_field, cut_field) = (open_field?, cut_field?);
        let zenith = luminance_cd_m2(reference(&open_field, 0.0, ELEVATION_COUNT - 1, 64)?);
        let flux_w = (NATURAL_CD_M2 / zenith).min(MAX_FLUX_W);
        let watts = |bands: Bands| bands.map(|value| value * flux_w);
        let (mut errors, mut open_errors, mut signed) = (Vec::new(), Vec::new(), 0.0);
        for d in 0..DIRECTION_COUNT {
            let row = if d < 4 { ELEVATION_COUNT - 1 } else { (d * 25 + i as usize * 7) % ELEVATION_COUNT };
            let column = (d * 53 + i as usize * 31) % HALF_COLUMN_COUNT;
            let exact = watts(reference(&cut_field, angle_deg, row, column)?);
            let exact_open = watts(reference(&open_field, 0.0, row, column)?);
            let got = watts(evaluate(&mixed, row, column));
            errors.push(relative_error(got, exact));
            signed += (luminance_cd_m2(got) - luminance_cd_m2(exact))
                / luminance_cd_m2(exact).max(1.7e-6)
                / DIRECTION_COUNT as f64;
            open_errors.push(relative_error(watts(evaluate(&open, row, column)), exact_open));
            all_dark.push(1.0 - luminance_cd_m2(exact) / luminance_cd_m2(exact_open).max(1e-30));
        }
        let of = |errors: &[f64]| ErrorStatistics::of(errors.iter().copied());
        if let (Some(cut), Some(open)) = (of(&errors), of(&open_errors)) {
            println!(
                "{distance_m:7.0} m, source {source_altitude_m:5.0}, observer {observer_altitude_m:5.0}, {angle_deg:5.2} deg, \
                 {flux_w:8.1e} W: mean {:6.2} % (signed {:+6.2}), 99 % {:6.2} %; open {:5.2} %",
                100.0 * cut.mean,
                100.0 * signed,
                100.0 * cut.p99,
                100.0 * open.mean
            );
            cells.push((distance_m, angle_deg, cut.mean));
        }
        all.extend(errors);
        all_open.extend(open_errors);
    }
    for (name, errors) in [("behind skylines", all), ("open", all_open), ("taken by skylines", all_dark)] {
        if let Some(of) = ErrorStatistics::of(errors) {
            println!("{name}: mean {:.2} %, 99 % {:.2} %", 100.0 * of.mean, 100.0 * of.p99);
        }
    }
    for distances in [(1e3, 1e4), (1e4, 5e4), (5e4, 1.5e5)] {
        for angles in [(0.0, 2.0), (2.0, 8.0), (8.0, 32.0)] {
            let means: Vec<f64> = cells
                .iter()
                .filter(|c| c.0 >= distances.0 && c.0 < distances.1 && c.1 >= angles.0 && c.1 < angles.1)
                .map(|c| c.2)
                .collect();
            println!(
                "{:3.0}-{:3.0} km, {:2.0}-{:2.0} deg: mean {:6.2} % of {} sources",
                distances.0 / 1e3,
                distances.1 / 1e3,
                angles.0,
                angles.1,
                100.0 * means.iter().sum::<f64>() / means.len().max(1) as f64,
                means.len()
            );
        }
    }
    Ok(())
}
