//! Brightness of a whole scene beside panoramas: time and error.

use crate::arguments::{Outcome, turbidity};
use skyglow_celestial::{Instant, heavens::DEFAULT_SOLAR_FLUX_SFU};
use skyglow_lab::setup::{observatory, open_sky};
use skyglow_observatory::{BrightnessRequest, MapLight, MapMeasure, RenderedSky, SkyRequest, SkyTime};
use skyglow_physics::{EmissionMix, LampPreset, Response, Turbidity};
use skyglow_scene::{SceneId, SumWay};
use skyglow_tables::Scattering;
use std::path::PathBuf;

/// Brightness of a whole scene beside the panoramas of single places: at some places, drawn evenly from those of the map,
/// the zenith of the map beside that of the sky that `skyglow sky` gives, and how many times faster all were found together.
#[derive(Debug, clap::Args)]
pub(crate) struct Arguments {
    /// Folder of scenes.
    data: PathBuf,
    /// Folder of packs.
    packs: PathBuf,
    /// Id of the scene.
    #[arg(value_parser = SceneId::parse)]
    scene: SceneId,
    /// Turbidity.
    #[arg(value_parser = turbidity)]
    turbidity: Turbidity,
    /// Whether terrain hides lights: on or off.
    #[arg(value_parser = ["on", "off"])]
    terrain: String,
    /// Most places of the map.
    max_places: usize,
    /// Panoramas beside it.
    count: usize,
    /// What of the sky.
    #[arg(long, default_value = "zenith", value_parser = measure)]
    measure: MapMeasure,
    /// With the natural sky of a time, such as 2026-08-24T23:00:00Z, or of none: dark [default: artificial light alone]
    #[arg(long)]
    natural: Option<String>,
    /// Under a closed layer of cloud at this altitude, metres [default: a clear sky]
    #[arg(long)]
    clouds: Option<u32>,
    /// How lights are summed: as the program chooses, by the dual tree, or by convolution where that can be.
    #[arg(long, default_value = "auto", value_parser = ["auto", "tree", "convolution"])]
    way: String,
}

fn measure(name: &str) -> Result<MapMeasure, String> {
    MapMeasure::named(name).ok_or_else(|| format!("no measure of maps is named {name}"))
}

/// The number of a sky that a map shows at its place.
fn of_sky(measure: MapMeasure, light: MapLight, sky: &RenderedSky) -> f64 {
    let numbers = &sky.quantities;
    let of_photopic = &numbers.surfaces.by_response[0];
    let is_total = light != MapLight::Artificial;
    let surfaces = if is_total { of_photopic.total } else { of_photopic.artificial };
    match measure {
        MapMeasure::Zenith if is_total => numbers.zenith_total_luminance_cd_m2,
        MapMeasure::Zenith => numbers.zenith_luminance_cd_m2,
        MapMeasure::Horizontal if is_total => numbers.horizontal_total_illuminance_lx,
        MapMeasure::Mean => numbers.mean_luminance_cd_m2,
        MapMeasure::Horizontal => numbers.horizontal_illuminance_lx,
        MapMeasure::Slope => surfaces.slope,
        MapMeasure::VerticalNorth => surfaces.vertical_north,
        MapMeasure::VerticalEast => surfaces.vertical_east,
        MapMeasure::VerticalSouth => surfaces.vertical_south,
        MapMeasure::VerticalWest => surfaces.vertical_west,
        MapMeasure::VerticalLargest => surfaces.vertical_largest,
        MapMeasure::Cylindrical => surfaces.cylindrical,
        MapMeasure::Spherical => surfaces.spherical,
    }
}

pub(crate) fn run(arguments: &Arguments) -> Outcome {
    let observatory = observatory(&arguments.data, &arguments.packs)?;
    let (id, turbidity) = (arguments.scene.clone(), arguments.turbidity);
    let light = match arguments.natural.as_deref() {
        None => MapLight::Artificial,
        Some("dark") => MapLight::Total(None),
        Some(time) => {
            let (instant, solar_flux_sfu) = (Instant::parse(time)?, DEFAULT_SOLAR_FLUX_SFU);
            MapLight::Total(Some(SkyTime { instant, solar_flux_sfu }))
        }
    };
    let request = BrightnessRequest {
        scene: id.clone(),
        scenario: None,
        turbidity,
        scattering: Scattering::Multiple,
        cloud_base_m: arguments.clouds,
        lamp: LampPreset::Mixed.lamp(),
        measure: arguments.measure,
        light,
        response: Response::Photopic,
        emission: EmissionMix::garstang().into(),
        terrain_hides: arguments.terrain == "on",
        max_places: arguments.max_places,
    };
    let way = match arguments.way.as_str() {
        "tree" => Some(SumWay::DualTree),
        "convolution" => Some(SumWay::Convolution),
        _ => None,
    };
    let view = observatory.view(&id, None)?;
    let start = std::time::Instant::now();
    let map = observatory.brightness_by(&view, &request, way, &|_: f64| true)?;
    let seconds = start.elapsed().as_secs_f64();
    let lattice = map.places().lattice();
    println!(
        "{} x {} places, every {} pixels, {} lit pixels: {seconds:.2} s ({})",
        lattice.columns,
        lattice.rows,
        lattice.step,
        map.scene().lit_pixels,
        map.steps
            .iter()
            .map(|(name, time)| format!("{name} {:.2}", time.as_secs_f64()))
            .collect::<Vec<_>>()
            .join(", ")
    );
    let count = arguments.count;
    let start = std::time::Instant::now();
    let mut errors = Vec::new();
    let mut dark = 0;
    for number in 0..count {
        let spread = |ratio: f64, length: u32| (number as f64 * ratio).fract() * f64::from(length);
        let (column, row) =
            (spread(0.754_877_666, lattice.columns) as u32, spread(0.569_840_291, lattice.rows) as u32);
        let found = map.places().values()[(row * lattice.columns + column) as usize];
        let place = map.open_scene().lattice_place(lattice, column, row);
        let time = if let MapLight::Total(time) = light { time } else { None };
        let open = open_sky(id.clone(), place, turbidity);
        let cloud_base_m = arguments.clouds;
        let sky = SkyRequest { terrain_hides: request.terrain_hides, time, cloud_base_m, ..open };
        // Ground at the clouds has no value in either.
        let sky = match observatory.sky_blocking(&sky) {
            Ok(sky) if found.is_finite() => sky,
            _ => continue,
        };
        let wanted = of_sky(arguments.measure, light, &sky);
        // A ten-thousandth of the natural sky.
        if wanted < 1.7e-8 {
            dark += 1;
        } else {
            errors.push((100.0 * (f64::from(found) / wanted - 1.0), place, wanted));
        }
    }
    let each_s = start.elapsed().as_secs_f64() / count as f64;
    errors.sort_by(|a, b| a.0.abs().total_cmp(&b.0.abs()));
    let at = |part: f64| errors[((errors.len() - 1) as f64 * part) as usize].0.abs();
    println!(
        "{} places ({dark} more under 1.7e-8 cd m-2): error {:.3} % mean, {:.3} % median, {:.3} % 90th, {:.3} % 99th, {:.3} % largest",
        errors.len(),
        errors.iter().map(|error| error.0.abs()).sum::<f64>() / errors.len() as f64,
        at(0.5),
        at(0.9),
        at(0.99),
        at(1.0),
    );
    println!(
        "mean with its sign {:+.3} %",
        errors.iter().map(|error| error.0).sum::<f64>() / errors.len() as f64
    );
    println!(
        "a panorama {:.2} ms; all places by panoramas {:.0} s, {:.0} times as long",
        1e3 * each_s,
        each_s * lattice.len() as f64,
        each_s * lattice.len() as f64 / seconds
    );
    for (error, place, luminance) in errors.iter().rev().take(6) {
        println!(
            "{error:+.2} % at {:.4} {:.4}, {luminance:.2e} cd m-2",
            place.latitude_deg(),
            place.longitude_deg()
        );
    }
    Ok(())
}
