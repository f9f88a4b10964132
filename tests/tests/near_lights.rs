//! Skies next to near lights, from the packs that come with the program.
#![allow(clippy::unwrap_used, clippy::expect_used, reason = "what cannot be set up fails the test")]

mod common;

use skyglow_bench::scenes::{LitPixel, grid_under_open_sky, sources_of_pixels};
use skyglow_lab::setup::open_sky;
use skyglow_observatory::{InfluenceRequest, InfluenceSolver, Measure, Observatory, SeenMeasure, SkyRequest};
use skyglow_physics::{
    AZIMUTH_COUNT, Atmosphere, BAND_COUNT, Direction, EmissionMix, GeoPoint, Horizon, LampPreset,
    LinearMeasure, PointSource, Response, SkyCurve, Turbidity,
    panorama::{azimuth_rad, elevation_rad},
    single_source::{SourceGeometry, mixed_radiance_per_watt},
};
use skyglow_render::RenderRequest;
use skyglow_scene::{PolarGrid, SceneId};
use skyglow_tables::Scattering;
use std::sync::{Arc, LazyLock};

static OBSERVATORY: LazyLock<Observatory> = LazyLock::new(|| common::demo("near-lights"));

fn request(polar: PolarGrid, turbidity: f64) -> RenderRequest {
    RenderRequest {
        polar: Arc::new(polar),
        observer_altitude_m: 300.0,
        turbidity: Turbidity::new(turbidity).unwrap(),
        scattering: Scattering::Multiple,
        cloud_base_m: None,
        emission: EmissionMix::garstang(),
        flux_per_dnb_flux: skyglow_bench::options::REFERENCE_FLUX,
        basis: None,
    }
}

fn sky(polar: PolarGrid, turbidity: f64) -> Vec<f32> {
    let rendered = OBSERVATORY.engine().render_blocking(request(polar, turbidity)).unwrap();
    rendered.panorama.samples().to_vec()
}

/// A pixel 7 km away, 400 m above the observer, at an azimuth between two columns.
fn one_light() -> Vec<PointSource> {
    sources_of_pixels([LitPixel { east_m: 5_000.0, north_m: 4_930.0, altitude_m: 700.0, flux_dnb_w: 1e4 }])
}

/// The peak next to a near light is that of the first order of scattering.
#[test]
fn near_light_peaks_are_those_of_first_order() {
    let lights = one_light();
    let [light] = lights.as_slice() else { panic!("{} lights", lights.len()) };
    let air = Atmosphere::new(Turbidity::new(2.5).unwrap());
    let geometry = SourceGeometry {
        distance_m: light.distance_m,
        source_altitude_m: light.altitude_m,
        observer_altitude_m: 300.0,
    };
    let flux = skyglow_bench::options::REFERENCE_FLUX.map(|flux| flux * light.flux_dnb_w);
    let with = sky(grid_under_open_sky(&lights), 2.5);
    let without = sky(PolarGrid { near: Vec::new(), ..grid_under_open_sky(&lights) }, 2.5);
    let (mut right, mut wrong) = (0f64, 0f64);
    let column = (light.azimuth_rad / azimuth_rad(1)) as usize;
    // Its elevation is 3.2°, between rows 1 and 2: right above it.
    for row in 2..5 {
        for column in [column, column + 1] {
            let exact: [f64; BAND_COUNT] = mixed_radiance_per_watt(
                &[air],
                &geometry,
                EmissionMix::garstang(),
                azimuth_rad(column) - light.azimuth_rad,
                elevation_rad(row),
                1e-6,
            );
            let at = skyglow_physics::Panorama::index(1, row, column % AZIMUTH_COUNT);
            // Later orders are a few per cent of it here.
            let error = |sky: &[f32]| (f64::from(sky[at]) / (flux[1] * exact[1]) - 1.0).abs();
            right = right.max(error(&with));
            wrong = wrong.max(error(&without));
        }
    }
    println!("within {right:.3} with near lights, {wrong:.3} without");
    assert!(right < 0.2 && wrong > 1.5 * right, "{right} {wrong}");
}

/// Far from near lights nothing changes, and nothing is negative.
#[test]
fn far_from_near_lights_nothing_changes() {
    let lights = one_light();
    for turbidity in [2.5, 3.0] {
        let with = sky(grid_under_open_sky(&lights), turbidity);
        let without = sky(PolarGrid { near: Vec::new(), ..grid_under_open_sky(&lights) }, turbidity);
        let own = (lights[0].azimuth_rad / azimuth_rad(1)) as usize;
        let mut changed = 0;
        for (at, (with, without)) in with.iter().zip(&without).enumerate() {
            assert!(*with >= 0.1 * without - 1e-30 && with.is_finite(), "{with} {without}");
            let (row, column) = (at / AZIMUTH_COUNT % 64, at % AZIMUTH_COUNT);
            let aside = (column + AZIMUTH_COUNT - own) % AZIMUTH_COUNT;
            let is_near = row < 8 && (aside <= 4 || aside >= AZIMUTH_COUNT - 4);
            assert!(is_near || with == without, "row {row}, column {column}");
            changed += usize::from(with != without);
        }
        assert!(changed > 50, "{changed}");
    }
    // Lights of which none is kept as it is cost nothing.
    let far =
        sources_of_pixels([LitPixel { east_m: 31_000.0, north_m: 0.0, altitude_m: 0.0, flux_dnb_w: 1e6 }]);
    let grid = PolarGrid { near: Vec::new(), ..grid_under_open_sky(&far) };
    let rendered = OBSERVATORY.engine().render_blocking(request(grid, 2.5)).unwrap();
    assert!(rendered.passes.iter().all(|pass| pass.name != "near_lights"));
}

/// Near lights are corrected only where a measure looks.
#[test]
fn near_lights_are_corrected_where_needed() {
    let solver = InfluenceSolver::new(OBSERVATORY.engine().table_set());
    let rule = LampPreset::Mixed.lamp().light().rule(&Response::Photopic);
    // 3° high, in the north-east.
    let asked = request(grid_under_open_sky(&one_light()), 2.5);
    let of = |measure: &LinearMeasure| {
        solver.near_lights(&asked, &asked, SeenMeasure { measure, rule: &rule, within: None }).unwrap()
    };
    let region = |corners_deg: [(f64, f64); 4]| {
        let corner = |(azimuth_deg, elevation_deg): (f64, f64)| Direction {
            azimuth_rad: azimuth_deg.to_radians(),
            elevation_rad: elevation_deg.to_radians(),
        };
        LinearMeasure::region(&SkyCurve::new(corners_deg.map(corner).to_vec()).unwrap(), &Horizon::flat())
    };
    let around = of(&region([(30.0, 0.1), (60.0, 0.1), (60.0, 6.0), (30.0, 6.0)]));
    assert!(around.len() == 1 && around[0].1 != 0.0, "{around:?}");
    assert_eq!(of(&LinearMeasure::mean(&Horizon::flat())).len(), 1);
    // Where nothing of it is, nothing is made, and nothing is missing: its share of the sky there is the cells'.
    let (above, behind) = (
        region([(30.0, 40.0), (60.0, 40.0), (60.0, 60.0), (30.0, 60.0)]),
        region([(200.0, 0.1), (250.0, 0.1), (250.0, 6.0), (200.0, 6.0)]),
    );
    for elsewhere in [LinearMeasure::zenith(&Horizon::flat()), above, behind] {
        assert_eq!(of(&elsewhere).iter().filter(|(_, value)| *value != 0.0).count(), 0);
    }
    assert!(of(&LinearMeasure::zenith(&Horizon::flat())).is_empty());
}

/// A near light too weak to show is left as the cells have it.
#[test]
fn weak_near_lights_are_left_to_the_cells() {
    // A town fills the sky; one more light beside it, faint and then bright.
    let town = (0..900).map(|pixel| LitPixel {
        east_m: 2_000.0 + 460.0 * f64::from(pixel % 30),
        north_m: -7_000.0 + 460.0 * f64::from(pixel / 30),
        altitude_m: 300.0,
        flux_dnb_w: 1e5,
    });
    let sky_with = |flux_dnb_w: f64| {
        let one = LitPixel { east_m: 9_100.0, north_m: 300.0, altitude_m: 300.0, flux_dnb_w };
        let grid = grid_under_open_sky(&sources_of_pixels(town.clone().chain([one])));
        let last = grid.near.len() - 1;
        let fewer = PolarGrid { near: grid.near[..last].to_vec(), ..grid.clone() };
        (sky(grid, 2.5), sky(fewer, 2.5))
    };
    let (with, without) = sky_with(1e3);
    assert_eq!(with, without);
    let (with, without) = sky_with(1e7);
    assert_ne!(with, without);
}

/// Parts of the lights around add up to the sky with near lights in it.
#[test]
fn influences_add_up_with_near_lights() {
    let id = SceneId::parse("demo").unwrap();
    // In a town between mountains, at a pack's turbidity and between packs.
    let place = GeoPoint::from_deg(46.17, 8.79).unwrap();
    for turbidity in [2.5, 3.0] {
        let sky = SkyRequest {
            terrain_hides: true,
            ..open_sky(id.clone(), place, Turbidity::new(turbidity).unwrap())
        };
        let rendered = OBSERVATORY.sky_blocking(&sky).unwrap();
        assert!(rendered.passes.iter().any(|pass| pass.name == "near_lights"));
        let whole = [
            (Measure::Zenith, rendered.quantities.zenith_luminance_cd_m2),
            (Measure::Mean, rendered.quantities.mean_luminance_cd_m2),
            (Measure::Horizontal, rendered.quantities.horizontal_illuminance_lx),
        ];
        for (measure, whole) in whole {
            let asked = InfluenceRequest { sky: sky.clone(), measure };
            let map = OBSERVATORY.influence(&asked).unwrap();
            let sum: f64 = map.influence().iter().copied().map(f64::from).sum();
            assert!((sum / whole - 1.0).abs() < 1e-4, "{turbidity} {:?}: {sum} {whole}", asked.measure);
        }
    }
}
