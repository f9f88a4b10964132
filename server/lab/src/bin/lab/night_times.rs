//! How long the natural sky of a time takes, and what it is made of.

use crate::arguments::{Outcome, place, turbidity};
use skyglow_celestial::{Component, Heavens, Instant, IrradianceGrid};
use skyglow_observatory::{NightSky, SkyTime, night_sky::Overhead};
use skyglow_physics::{
    AZIMUTH_COUNT, BAND_COUNT, Direction, ELEVATION_COUNT, GeoPoint, Horizon, Response, SKY_RESPONSES,
    SeenSky, SkyPart, Turbidity,
    panorama::{azimuth_rad, elevation_rad},
    photometry::brightness_mag_arcsec2,
};
use skyglow_render::celestial::{BeamGrid, CelestialTables};
use skyglow_tables::CelestialTable;
use std::{array::from_fn, f64::consts::FRAC_PI_2, path::PathBuf};

/// Runs that the fastest is taken of.
const RUNS: usize = 12;

/// Times the natural sky of a time over a place, first and again, by tables of a folder or made-up ones; prints its components, their light at the nodes and the
/// medians of six bands of altitude in V.
#[derive(Debug, clap::Args)]
pub(crate) struct Arguments {
    /// Such as 2026-08-20T23:16:00Z.
    time: String,
    /// Latitude and longitude, degrees.
    #[arg(value_parser = place)]
    place: GeoPoint,
    /// Altitude of the eye, m.
    #[arg(long, default_value_t = 0.0)]
    altitude_m: f64,
    /// Turbidity.
    #[arg(long, default_value = "2.5", value_parser = turbidity)]
    turbidity: Turbidity,
    /// Radio flux of the Sun at 10.7 cm, solar flux units.
    #[arg(long, default_value_t = 100.0)]
    solar_flux_sfu: f64,
    /// Folder of celestial tables; without it they are made up.
    #[arg(long)]
    packs: Option<PathBuf>,
}

pub(crate) fn run(arguments: &Arguments) -> Outcome {
    let tables = match &arguments.packs {
        Some(folder) => CelestialTables::open(folder)?.ok_or("there are no celestial tables")?,
        None => {
            let of = |t: f64| Turbidity::new(t).map(CelestialTable::synthetic);
            CelestialTables::new([1.5, 2.0, 2.5, 3.5].into_iter().map(of).collect::<Result<_, _>>()?)?
        }
    };
    let time =
        SkyTime { instant: Instant::parse(&arguments.time)?, solar_flux_sfu: arguments.solar_flux_sfu };
    let horizon = Horizon::flat();
    let over = Overhead {
        place: arguments.place,
        altitude_m: arguments.altitude_m,
        horizon: &horizon,
        turbidity: arguments.turbidity,
        gaps: None,
    };
    let mut sky = None;
    let mut times_ms = Vec::new();
    let mut before_ms = None;
    for run in 0..RUNS {
        if run == 1 {
            before_ms = processor_ms();
        }
        // Another second every time: nothing of the sky itself is kept.
        let instant = time.instant.plus_s(run as f64);
        let start = std::time::Instant::now();
        let found = NightSky::new(&tables, &over, SkyTime { instant, ..time }, &SKY_RESPONSES)?;
        times_ms.push(1e3 * start.elapsed().as_secs_f64());
        sky.get_or_insert(found);
    }
    let Some(sky) = sky else { return Ok(()) };
    let again_ms = times_ms.iter().skip(1).copied().fold(f64::INFINITY, f64::min);
    println!("first {:.1} ms, again {again_ms:.2} ms (the fastest of {})", times_ms[0], RUNS - 1);
    if let (Some(before_ms), Some(after_ms)) = (before_ms, processor_ms()) {
        println!("processor time again: {:.2} ms in the mean", (after_ms - before_ms) / (RUNS - 1) as f64);
    }
    let magnitude = |luminance: f64| brightness_mag_arcsec2(luminance).unwrap_or(f64::INFINITY);
    for (part, light) in sky.components().iter().zip(sky.parts()) {
        let nodes: [f64; BAND_COUNT] =
            from_fn(|band| light.kernel.radiance_w_m2_sr(band, ELEVATION_COUNT - 1, 0));
        println!("{:<16} nodes at the zenith {nodes:.3?}", part.component.name());
        let (zenith, mean) = (part.zenith_luminance_cd_m2, part.mean_luminance_cd_m2);
        println!(
            "{:<16} zenith {zenith:.3e} cd m-2 ({:.2}), mean {mean:.3e} ({:.2}), direct {:.3e} lx",
            part.component.name(),
            magnitude(zenith),
            magnitude(mean),
            part.direct_illuminance_lx
        );
    }
    let heavens = sky.heavens();
    println!(
        "| component | light on beams, ms | scattered, ms | straight, ms | as {} responses see it, ms | kB |\n|---|---|---|---|---|---|",
        SKY_RESPONSES.len()
    );
    for (of, part) in sky.components().iter().zip(sky.parts()) {
        let [beams, scattered, straight] = parts_ms(&tables, &over, heavens, of.component);
        let seen = fastest_ms(|| SeenSky::of(std::slice::from_ref(part), &SKY_RESPONSES));
        let bytes = size_of_val(part.kernel.samples());
        println!(
            "| {} | {beams:.2} | {scattered:.2} | {straight:.2} | {seen:.2} | {} |",
            of.component.name(),
            bytes / 1_000
        );
    }
    println!("skies of beams kept: {:.1} MB", 1e-6 * tables.kept_bytes() as f64);
    println!("bands of altitude, V: {}", bands(sky.parts()).map(|m| format!("{m:.3}")).join(" "));
    Ok(())
}

/// Processor time of all threads of this program so far, ms, where the system tells it; it counts no time that others take.
fn processor_ms() -> Option<f64> {
    let tasks = std::fs::read_dir("/proc/self/task").ok()?;
    let nanoseconds = tasks.filter_map(|task| {
        let text = std::fs::read_to_string(task.ok()?.path().join("schedstat")).ok()?;
        text.split_whitespace().next()?.parse::<f64>().ok()
    });
    Some(1e-6 * nanoseconds.sum::<f64>())
}

/// The fastest of some runs.
fn fastest_ms<T>(work: impl Fn() -> T) -> f64 {
    let times_ms = (0..RUNS).map(|_| {
        let start = std::time::Instant::now();
        std::hint::black_box(work());
        1e3 * start.elapsed().as_secs_f64()
    });
    times_ms.fold(f64::INFINITY, f64::min)
}

/// Times of a component's light on beams, what they scatter, and what comes straight, each alone.
fn parts_ms(
    tables: &CelestialTables,
    over: &Overhead<'_>,
    heavens: &Heavens,
    component: Component,
) -> [f64; 3] {
    let angles = tables.zenith_angles_rad();
    if let (Component::Sun | Component::Moon, Some(point)) = (component, heavens.points(component).first()) {
        let beam = (FRAC_PI_2 - point.direction.elevation_rad, point.direction.azimuth_rad);
        return [0.0, fastest_ms(|| tables.beam_sky(over.turbidity, beam, over.altitude_m)), 0.0];
    }
    let beams = fastest_ms(|| IrradianceGrid::of(heavens, component, angles));
    let grid = IrradianceGrid::of(heavens, component, angles);
    let values: Vec<f32> = grid.values().iter().map(|value| *value as f32).collect();
    let scattered = fastest_ms(|| {
        BeamGrid::new(angles.len(), values.clone())
            .map(|grid| tables.grid_sky(over.turbidity, &grid, over.altitude_m))
    });
    let straight = fastest_ms(|| {
        let rows = if component.is_extended() { ELEVATION_COUNT } else { 0 };
        let columns = if component == Component::Airglow { 1 } else { AZIMUTH_COUNT };
        let directions = (0..rows).flat_map(|row| (0..columns).map(move |column| (row, column)));
        let towards = directions.map(|(row, column)| {
            let direction = Direction { azimuth_rad: azimuth_rad(column), elevation_rad: elevation_rad(row) };
            heavens.radiance_outside(component, direction)[0]
        });
        towards.sum::<f64>()
    });
    [beams, scattered, straight]
}

/// Medians of V in six bands of altitude, each sample as often as there are columns: rows of a band weigh alike.
fn bands(parts: &[SkyPart]) -> [f64; 6] {
    let seen = SeenSky::of(parts, &[Response::JohnsonV]);
    let rows = ELEVATION_COUNT as f64 / 6.0;
    std::array::from_fn(|band| {
        let first = (band as f64 * rows).round() as usize * AZIMUTH_COUNT;
        let end = ((band + 1) as f64 * rows).round() as usize * AZIMUTH_COUNT;
        let mut values = seen.plane(0)[first..end].to_vec();
        values.sort_by(f32::total_cmp);
        brightness_mag_arcsec2(f64::from(values[values.len() / 2])).unwrap_or(f64::INFINITY)
    })
}
