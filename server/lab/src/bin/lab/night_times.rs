//! How long the natural sky of a time takes, and what it is made of.

use crate::arguments::{Outcome, place, turbidity};
use skyglow_celestial::Instant;
use skyglow_observatory::{NightSky, SkyTime, night_sky::Overhead};
use skyglow_physics::{
    AZIMUTH_COUNT, BAND_COUNT, ELEVATION_COUNT, GeoPoint, Horizon, Response, SKY_RESPONSES, SkyPart,
    Turbidity, photometry::brightness_mag_arcsec2,
};
use skyglow_render::celestial::CelestialTables;
use skyglow_tables::CelestialTable;
use std::{array::from_fn, path::PathBuf};

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
    for run in 0..RUNS {
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
    println!("bands of altitude, V: {}", bands(sky.parts()).map(|m| format!("{m:.3}")).join(" "));
    Ok(())
}

/// Medians of V in six bands of altitude, each sample as often as there are columns: rows of a band weigh alike.
fn bands(parts: &[SkyPart]) -> [f64; 6] {
    let seen = skyglow_physics::SeenSky::of(parts, &[Response::JohnsonV]);
    let rows = ELEVATION_COUNT as f64 / 6.0;
    std::array::from_fn(|band| {
        let first = (band as f64 * rows).round() as usize * AZIMUTH_COUNT;
        let end = ((band + 1) as f64 * rows).round() as usize * AZIMUTH_COUNT;
        let mut values = seen.plane(0)[first..end].to_vec();
        values.sort_by(f32::total_cmp);
        brightness_mag_arcsec2(f64::from(values[values.len() / 2])).unwrap_or(f64::INFINITY)
    })
}
