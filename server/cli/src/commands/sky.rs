//! `skyglow sky`: the numbers of a sky.

use crate::{
    failure::Failure,
    flags::{JsonFlags, ProgramFlags},
    print,
    query::{self, QueryFlags},
    render,
    table::aligned,
};
use clap::Args;
use skyglow_app::{
    answers::{Assumptions, EmissionAnswer, NightSkyAnswer, SkyAnswer},
    parameters::SkyParameters,
    request,
};
use skyglow_celestial::answers::BodyPlace;
use skyglow_physics::{
    Band, CloudBase, EmissionKeep, SkyQuantities,
    surfaces::{SurfaceLight, Surfaces},
};
use skyglow_scene::SceneId;

/// Compute the numbers of the sky at a place
#[derive(Debug, Args)]
#[command(after_help = "Example:\n  skyglow sky --scene demo --lat 46.17 --lon 8.79 --turbidity 3 --json")]
pub(crate) struct Sky {
    /// The scene's id
    #[arg(long, env = "SKYGLOW_SCENE", value_name = "ID", value_parser = SceneId::parse)]
    scene: SceneId,
    #[command(flatten)]
    query: QueryFlags<SkyParameters>,
    #[command(flatten)]
    program: ProgramFlags,
    #[command(flatten)]
    json: JsonFlags,
}

impl Sky {
    /// Runs the command.
    pub(crate) fn run(self) -> Result<(), Failure> {
        let read = |facts: &_| {
            request::sky(Some(self.query.query()), self.scene.clone(), facts).map_err(|e| query::failure(&e))
        };
        read(&self.program.facts())?;
        let source = self.program.source()?;
        let request = read(source.facts())?;
        let (assumptions, sky) = render::rendered(source.as_ref(), request)?;
        if self.json.json {
            return print::print_json(&SkyAnswer::new(assumptions, &sky));
        }
        let answer = SkyAnswer::new(assumptions, &sky);
        let mut rows = rows(&answer.assumptions, &answer.sky);
        rows.extend(answer.night_sky.iter().flat_map(night_rows));
        print::print_line(aligned(&rows).trim_end())
    }
}

fn rows(assumptions: &Assumptions, sky: &SkyQuantities) -> Vec<Vec<String>> {
    let or_dark = |magnitude: Option<f64>| {
        magnitude.map_or_else(|| "no light".to_owned(), |m| format!("{m:.2} mag arcsec-2"))
    };
    let or_clouds = |value: Option<String>| value.unwrap_or_else(|| "behind clouds".to_owned());
    let observer = &assumptions.observer;
    let depth: Vec<String> = Band::ALL
        .iter()
        .zip(assumptions.local_optical_depth)
        .map(|(band, depth)| format!("{depth:.3} at {} nm", band.wavelength_nm()))
        .collect();
    let row = |name: &str, value: String| vec![name.to_owned(), value];
    let bound = assumptions
        .basis_error_bound
        .map_or_else(String::new, |bound| format!(", within {bound:.4} of the sky of all"));
    let mut rows = vec![
        row("zenith, artificial", or_dark(sky.zenith_brightness_mag_arcsec2)),
        row("", format!("{:.4e} cd m-2", sky.zenith_luminance_cd_m2)),
        row("zenith, total", or_dark(sky.zenith_total_brightness_mag_arcsec2)),
        row("Sky Quality Meter", or_dark(sky.sqm_total_brightness_mag_arcsec2)),
        row("artificial / natural", format!("{:.4}", sky.ratio_to_natural)),
        row("Bortle class", or_clouds(sky.bortle_class.map(|class| class.to_string()))),
        row("faintest star", or_clouds(sky.naked_eye_limit_mag.map(|limit| format!("{limit:.2} mag")))),
        row("horizontal", format!("{:.4e} lx", sky.horizontal_illuminance_lx)),
        row("walls", on_walls(&sky.surfaces)),
        row("sloping ground", on_slope(&sky.surfaces)),
        row("all-sky mean", format!("{:.4e} cd m-2", sky.mean_luminance_cd_m2)),
        row(
            "brightest",
            format!(
                "{:.4e} cd m-2 at azimuth {:.1}, elevation {:.1} degrees",
                sky.brightest_luminance_cd_m2, sky.brightest_azimuth_deg, sky.brightest_elevation_deg
            ),
        ),
        row("observer", format!("{:.0} m above sea level", observer.altitude_m)),
        row("turbidity", format!("{} at sea level", assumptions.turbidity)),
        row("optical depth there", depth.join(", ")),
        row("scattering", scattering(assumptions)),
        row("clouds", clouds(assumptions)),
        row("lamp", assumptions.lamp.preset.clone().unwrap_or_else(|| "custom".to_owned())),
        row("emission", emission(&assumptions.emission)),
        row("terrain", terrain(assumptions).to_owned()),
        row("calibration", assumptions.calibration.to_string()),
        row("coverage", format!("{:.1} % of the 300 km around", 100.0 * assumptions.coverage)),
        row(
            "computed by",
            format!("{}, {} basis functions{bound}", assumptions.executor, assumptions.basis_count),
        ),
    ];
    for warning in &assumptions.warnings {
        rows.push(row("warning", warning.clone()));
    }
    if assumptions.scene.illustrative {
        rows.push(row("note", "an illustrative scene: made-up light, not a measurement".to_owned()));
    }
    rows
}

/// What walls receive of artificial light.
fn on_walls(surfaces: &Surfaces) -> String {
    let light = |SurfaceLight { artificial, unit, .. }: &SurfaceLight| {
        let (largest, facing_deg) = (artificial.vertical_largest, artificial.vertical_largest_azimuth_deg);
        let mean = artificial.cylindrical;
        format!("{largest:.4e} {unit} at most, facing {facing_deg:.0} degrees; {mean:.4e} in the mean")
    };
    surfaces.by_response.first().map_or_else(String::new, light)
}

/// What the ground receives of artificial light as it slopes.
fn on_slope(surfaces: &Surfaces) -> String {
    let lies = surfaces.downhill_azimuth_deg.map_or_else(
        || "level".to_owned(),
        |downhill_deg| format!("{:.1} degrees steep, falling towards {downhill_deg:.0}", surfaces.slope_deg),
    );
    let light = |light: &SurfaceLight| format!("{:.4e} {}, {lies}", light.artificial.slope, light.unit);
    surfaces.by_response.first().map_or_else(String::new, light)
}

/// What the natural sky of a time is made of.
fn night_rows(night: &NightSkyAnswer) -> Vec<Vec<String>> {
    let row = |name: &str, value: String| vec![name.to_owned(), value];
    let place = |place: &BodyPlace| {
        format!("{:.1} degrees up, azimuth {:.1}", place.apparent_altitude_deg, place.azimuth_deg)
    };
    let mut rows = vec![
        row("Sun", place(&night.bodies.sun.place)),
        row(
            "Moon",
            format!(
                "{}, {:.0} % lit",
                place(&night.bodies.moon.place),
                100.0 * night.bodies.moon.illuminated_fraction
            ),
        ),
    ];
    rows.extend(night.components.iter().map(|part| {
        let zenith = part.zenith_luminance_cd_m2;
        let mean = part.mean_luminance_cd_m2;
        row(part.component.name(), format!("{zenith:.3e} cd m-2 at the zenith, {mean:.3e} in the mean"))
    }));
    let stars = &night.stars;
    rows.push(row("stars seen", format!("{} of {} above the horizon", stars.visible, stars.above_horizon)));
    if let Some(contrast) = night.milky_way.map(|milky_way| milky_way.contrast) {
        rows.push(row("Milky Way", format!("{:.1} % brighter than the sky beside it", 100.0 * contrast)));
    }
    rows
}

fn emission(emission: &EmissionAnswer) -> String {
    let name = emission.preset.as_deref().unwrap_or("custom");
    let shares = match (emission.direct_uplight, emission.ground_reflectance) {
        (Some(f), Some(g)) => format!(" (direct uplight {f}, ground reflectance {g})"),
        _ => String::new(),
    };
    let kept = match emission.keep {
        EmissionKeep::Flux => String::new(),
        EmissionKeep::NadirRadiance => {
            format!("; flux times {:.3}, as the radiance at the nadir is kept", emission.flux_factor)
        }
    };
    let EmissionAnswer { lambert, horizon, oblique, .. } = emission;
    format!("{name}{shares}: lambert {lambert:.3}, horizon {horizon:.3}, oblique {oblique:.3}{kept}")
}

fn terrain(assumptions: &Assumptions) -> &'static str {
    match (assumptions.terrain_occlusion, assumptions.hidden_lights) {
        (false, _) => "hides nothing",
        (true, false) => "hides the sky below the horizon",
        (true, true) => "hides the sky below the horizon, and light below its source's skyline",
    }
}

fn clouds(assumptions: &Assumptions) -> String {
    match assumptions.cloud_albedo {
        Some(albedo) => format!(
            "{} at {} m above sea level, of albedo {albedo} (optical depth {:.0})",
            match assumptions.cloud_cover {
                Some(cover) if cover < 1.0 => format!("{:.0} % covered", 100.0 * cover),
                _ => "closed".to_owned(),
            },
            assumptions.clouds,
            CloudBase::optical_depth(albedo)
        ),
        None => assumptions.clouds.clone(),
    }
}

fn scattering(assumptions: &Assumptions) -> String {
    match assumptions.ground_albedo {
        Some(albedo) => format!("{}, over ground of albedo {albedo}", assumptions.scattering),
        None => assumptions.scattering.clone(),
    }
}
