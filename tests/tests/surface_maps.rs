//! Maps of the light on surfaces beside the panoramas of their places.
#![allow(clippy::unwrap_used, reason = "a test that cannot be set up fails")]

mod common;

use skyglow_celestial::{Instant, heavens::DEFAULT_SOLAR_FLUX_SFU};
use skyglow_lab::setup::open_sky;
use skyglow_observatory::{BrightnessRequest, MapLight, MapMeasure, RenderedSky, SkyRequest, SkyTime};
use skyglow_physics::{GeoPoint, Response, Turbidity};
use skyglow_scene::SceneId;

/// Places that are compared, of each map.
const COMPARED: usize = 60;
/// Darker places are left out, parts of the dark reference: a map's colours begin at 0.01.
const LEAST_OF_NATURAL: f64 = 1e-3;

fn sky(place: GeoPoint, turbidity: Turbidity, light: MapLight, terrain_hides: bool) -> SkyRequest {
    let time = if let MapLight::Total(time) = light { time } else { None };
    let open = open_sky(SceneId::parse("demo").unwrap(), place, turbidity);
    SkyRequest { terrain_hides, time, ..open }
}

fn of_sky(measure: MapMeasure, light: MapLight, sky: &RenderedSky) -> f64 {
    let surfaces = &sky.quantities.surfaces.by_response[0];
    let of = if light == MapLight::Artificial { surfaces.artificial } else { surfaces.total };
    match measure {
        MapMeasure::Horizontal => of.horizontal,
        MapMeasure::Slope => of.slope,
        MapMeasure::VerticalEast => of.vertical_east,
        MapMeasure::VerticalLargest => of.vertical_largest,
        MapMeasure::Cylindrical => of.cylindrical,
        MapMeasure::Spherical => of.spherical,
        other => panic!("{other:?} is no surface"),
    }
}

/// A map, what is compared with it, and the largest median and 90th percentile of its errors.
struct Case(MapMeasure, MapLight, f64, usize, [f64; 2]);

/// In the place of a turbidity: 2.5 under closed clouds at 1 500 m.
const UNDER_CLOUDS: f64 = 0.0;

/// On slopes behind their horizons, on walls, cylinders and spheres, by artificial light, with the dark reference and by a Moon, maps
/// say what the integrals over the panoramas of their places do.
#[test]
fn surfaces_are_lit_as_panoramas_say() {
    let observatory = common::demo("surface-maps");
    let instant = Instant::parse("2026-08-22T19:30:00Z").unwrap();
    let moon = MapLight::Total(Some(SkyTime { instant, solar_flux_sfu: DEFAULT_SOLAR_FLUX_SFU }));
    let artificial = MapLight::Artificial;
    let places: usize =
        std::env::var("SURFACE_MAP_PLACES").ok().and_then(|count| count.parse().ok()).unwrap_or(5_000);
    for Case(measure, light, turbidity, max_places, [most_median, most_90]) in [
        Case(MapMeasure::Slope, artificial, 2.5, places, [0.01, 0.03]),
        Case(MapMeasure::Cylindrical, artificial, 2.5, 5_000, [0.005, 0.03]),
        Case(MapMeasure::VerticalEast, artificial, 3.0, 5_000, [0.01, 0.05]),
        Case(MapMeasure::VerticalLargest, artificial, 2.5, 5_000, [0.01, 0.03]),
        Case(MapMeasure::Slope, MapLight::Total(None), 2.5, 5_000, [0.01, 0.03]),
        // What the horizon takes of scattered moonlight hangs on more than its height.
        Case(MapMeasure::Slope, moon, 2.5, 5_000, [0.03, 0.07]),
        Case(MapMeasure::VerticalLargest, moon, 2.5, 5_000, [0.04, 0.1]),
        // Under clouds, in valleys whose neighbours are above them too.
        Case(MapMeasure::Slope, artificial, UNDER_CLOUDS, 5_000, [0.01, 0.03]),
    ] {
        let terrain_hides = measure == MapMeasure::Slope;
        let cloud_base_m = (turbidity == UNDER_CLOUDS).then_some(1_500);
        let turbidity = Turbidity::new(if cloud_base_m.is_some() { 2.5 } else { turbidity }).unwrap();
        let here = GeoPoint::from_rad_unchecked(0.0, 0.0);
        let SkyRequest { scene, scattering, lamp, response, emission, .. } =
            sky(here, turbidity, light, terrain_hides);
        let request = BrightnessRequest {
            cloud_base_m,
            scene,
            scenario: None,
            turbidity,
            scattering,
            lamp,
            measure,
            light,
            response,
            emission,
            terrain_hides,
            max_places,
        };
        let map = observatory.brightness(&request, &|_: f64| true).unwrap();
        let lattice = map.places().lattice();
        let natural = measure.natural_value(&Response::Photopic);
        let mut errors: Vec<f64> = (0..lattice.len())
            .step_by((lattice.len() / COMPARED).max(1) | 1)
            .filter_map(|at| {
                let (column, row) = (at as u32 % lattice.columns, at as u32 / lattice.columns);
                let place = map.open_scene().lattice_place(lattice, column, row);
                let sky = SkyRequest { cloud_base_m, ..sky(place, turbidity, light, terrain_hides) };
                let sky = observatory.sky_blocking(&sky).ok()?;
                let wanted = of_sky(measure, light, &sky);
                let found = f64::from(map.places().values()[at]);
                (wanted > LEAST_OF_NATURAL * natural).then(|| (found / wanted - 1.0).abs())
            })
            .collect();
        errors.sort_by(f64::total_cmp);
        let at = |part: f64| errors[((errors.len() - 1) as f64 * part) as usize];
        let mean = errors.iter().sum::<f64>() / errors.len() as f64;
        println!(
            "{measure:?} {light:?}, turbidity {}, clouds {cloud_base_m:?}, {} places, {} compared: {mean:.5} mean, {:.5} median, {:.5} 90th, {:.5} 99th, {:.5} \
             largest; {:?}",
            turbidity.value(),
            lattice.len(),
            errors.len(),
            at(0.5),
            at(0.9),
            at(0.99),
            at(1.0),
            map.steps
        );
        assert!(at(0.5) <= most_median && at(0.9) <= most_90, "{measure:?} {light:?}");
    }
}
