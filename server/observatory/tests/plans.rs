//! Changed scenes and reduction plans, against the skies of the scenes that they make.
#![allow(clippy::unwrap_used, reason = "a test that cannot be set up fails")]

mod common;

use common::{engine, sky, store_scene, town};
use skyglow_observatory::ObservatoryError;
use skyglow_observatory::{
    BrightnessRequest, InfluenceRequest, Level, Limit, MapMeasure, Measure, Observatory, PlanMethod,
    PlanOutcome, PlanRequest, SkyRequest, TargetSite,
};
use skyglow_physics::{
    Emission, EmissionKeep, EmissionMix, Lamp, LampChange, LampPreset, Lobe, PreservedFlux, Response, SeenSky,
};
use skyglow_render::DeviceChoice;
use skyglow_scene::{Area, Boundary, Change, ChangeId, ChangeStore, Edit, Scenario, Scene, StoredPlan};
use std::path::Path;

/// An observatory over a scene of 80 × 80 pixels at 36.4–37.2° E, 2.0–1.2° S, hilly and lit unevenly.
fn observatory(folder: &Path) -> Observatory {
    let ground_m = |row: usize, column: usize| 300.0 + 40.0 * ((row * 7 + column * 13) % 23) as f32;
    let light = |row: usize, column: usize| ((row * 31 + column * 17) % 19) as f32 * 0.7;
    store_scene(folder, 80, [36.4, -1.2, 0.01], 1.0, &ground_m, &light);
    Observatory::new(engine(DeviceChoice::Cpu, &[1.5, 2.5, 3.5], 24), Vec::new(), folder, 1)
}

fn polygon(west: f64, south: f64, east: f64, north: f64) -> Vec<Vec<Vec<[f64; 2]>>> {
    vec![vec![vec![[west, south], [east, south], [east, north], [west, north], [west, south]]]]
}

/// The western half of the scene; no pixel's centre is on its edge.
fn west() -> Area {
    Area::Polygons(polygon(36.0, -3.0, 36.8, 0.0))
}

fn east() -> Area {
    Area::Polygons(polygon(36.8, -3.0, 38.0, 0.0))
}

fn alter(area: Area, factor: f64, lamp: Option<LampChange>, emission: Option<EmissionMix>) -> Edit {
    Edit { area, change: Change::Alter { factor, lamp, emission } }
}

fn painted(observatory: &Observatory, base: Option<ChangeId>, edits: Vec<Edit>) -> ChangeId {
    observatory.store_scenario(&Scenario { scene: town(), title: None, base, edits }).unwrap().0
}

fn in_scenario(request: &SkyRequest, scenario: &ChangeId) -> SkyRequest {
    SkyRequest { scenario: Some(scenario.clone()), ..request.clone() }
}

/// Responses that lamps are told apart by.
const SEEN_BY: [Response; 3] = [Response::Photopic, Response::Scotopic, Response::JohnsonR];

fn seen(observatory: &Observatory, request: &SkyRequest) -> Vec<Vec<f32>> {
    let sky = SeenSky::of(&observatory.sky_blocking(request).unwrap().parts, &SEEN_BY);
    (0..SEEN_BY.len()).map(|place| sky.plane(place).to_vec()).collect()
}

/// Largest difference of values, relative to the largest of the response.
fn difference(a: &[Vec<f32>], b: &[Vec<f32>]) -> f64 {
    let of_plane = |(a, b): (&Vec<f32>, &Vec<f32>)| {
        let most = b.iter().copied().fold(0f32, f32::max).max(1e-30);
        a.iter().zip(b).map(|(a, b)| (a - b).abs() / most).fold(0f32, f32::max)
    };
    f64::from(a.iter().zip(b).map(of_plane).fold(0f32, f32::max))
}

fn sum(a: &[Vec<f32>], b: &[Vec<f32>], of_a: f64) -> Vec<Vec<f32>> {
    let planes = a.iter().zip(b);
    planes.map(|(a, b)| a.iter().zip(b).map(|(a, b)| of_a as f32 * a + b).collect()).collect()
}

/// Lights with other lamps and shades shine as if the sky were asked with those.
#[test]
fn changed_lights_shine_as_in_a_sky_asked_so() {
    let folder = tempfile::tempdir().unwrap();
    let observatory = observatory(folder.path());
    let request = sky(2.5, -1.43, 36.93);
    let lamp =
        LampChange { from: None, to: LampPreset::PcAmber.lamp(), preserved: PreservedFlux::LuminousFlux };
    let shade = EmissionMix::lambert();
    let fitted = painted(&observatory, None, vec![alter(west(), 1.0, Some(lamp.clone()), Some(shade))]);
    let [only_west, only_east] =
        [east(), west()].map(|dark| painted(&observatory, None, vec![alter(dark, 0.0, None, None)]));
    // Of as many lumens.
    let lumens = |lamp: &Lamp| lamp.light().spectrum().lumens();
    let ratio = lumens(&request.lamp) / lumens(&lamp.to);
    let of_west = SkyRequest { lamp: lamp.to, emission: shade.into(), ..in_scenario(&request, &only_west) };
    let wanted =
        sum(&seen(&observatory, &of_west), &seen(&observatory, &in_scenario(&request, &only_east)), ratio);
    let got = seen(&observatory, &in_scenario(&request, &fitted));
    assert!(difference(&got, &wanted) < 1e-4, "{}", difference(&got, &wanted));
    assert!(difference(&got, &seen(&observatory, &request)) > 0.01, "lamps change nothing");
    // A tolerance holds for the sum.
    let coarse = SkyRequest { tolerance: Some(0.3), ..in_scenario(&request, &fitted) };
    let coarse = observatory.sky_blocking(&coarse).unwrap();
    assert!(coarse.context.basis_error_bound.unwrap() <= 0.3 && coarse.context.basis_count <= 24);
    // Nothing is left of the scene's own sky where the id is of no scenario, or one of another scene.
    let unknown = in_scenario(&request, &ChangeStore::plan_id(b"none"));
    assert!(matches!(observatory.sky_blocking(&unknown), Err(ObservatoryError::ChangeStore(_))));
}

/// With the radiance at the nadir kept, every light has the flux of its own emission, and one that is dark there is refused.
#[test]
fn kept_nadir_radiance_is_of_each_fixture() {
    let folder = tempfile::tempdir().unwrap();
    let observatory = observatory(folder.path());
    let flux_kept = sky(2.5, -1.43, 36.93);
    let emission = flux_kept.emission.keeping(EmissionKeep::NadirRadiance).unwrap();
    let request = SkyRequest { emission, ..flux_kept.clone() };
    let more = 0.2775 / 0.1275;
    let nothing = vec![vec![0f32; 1 << 14]; SEEN_BY.len()];
    let whole = sum(&seen(&observatory, &flux_kept), &nothing, more);
    assert!(difference(&seen(&observatory, &request), &whole) < 1e-5);
    // Of shielded lights the satellite's radiance is all there is.
    let shade = EmissionMix::lambert();
    let shaded = painted(&observatory, None, vec![alter(west(), 1.0, None, Some(shade))]);
    let [only_west, only_east] =
        [east(), west()].map(|dark| painted(&observatory, None, vec![alter(dark, 0.0, None, None)]));
    let of_west = SkyRequest { emission: shade.into(), ..in_scenario(&flux_kept, &only_west) };
    let of_east = seen(&observatory, &in_scenario(&flux_kept, &only_east));
    let got = seen(&observatory, &in_scenario(&request, &shaded));
    assert!(difference(&got, &sum(&of_east, &seen(&observatory, &of_west), more)) < 1e-4);
    // Influences and maps have it too.
    let zenith = |request: &SkyRequest| {
        let ask = InfluenceRequest { sky: in_scenario(request, &shaded), measure: Measure::Zenith };
        observatory.influence(&ask).unwrap().total().influence
    };
    let luminance = observatory.sky_blocking(&in_scenario(&request, &shaded)).unwrap().quantities;
    assert!((zenith(&request) / luminance.zenith_luminance_cd_m2 - 1.0).abs() < 1e-4);
    let map = |emission: Emission| {
        let ask = BrightnessRequest {
            cloud_base_m: None,
            scene: request.scene.clone(),
            scenario: None,
            turbidity: request.turbidity,
            scattering: request.scattering,
            lamp: request.lamp.clone(),
            measure: MapMeasure::Zenith,
            light: skyglow_observatory::MapLight::Artificial,
            response: Response::Photopic,
            emission,
            terrain_hides: false,
            max_places: 100,
        };
        let map = observatory.brightness(&ask, &|_: f64| true).unwrap();
        map.places().values().iter().map(|value| f64::from(*value)).sum::<f64>()
    };
    assert!((map(emission) / map(flux_kept.emission) / (0.2775 / 0.1275) - 1.0).abs() < 1e-5);
    let low = EmissionMix::only(Lobe::Horizon);
    let low = painted(&observatory, None, vec![alter(west(), 1.0, None, Some(low))]);
    assert!(observatory.sky_blocking(&in_scenario(&flux_kept, &low)).is_ok());
    let refused = observatory.sky_blocking(&in_scenario(&request, &low));
    assert!(matches!(refused, Err(ObservatoryError::Emission(_))));
}

/// Influences of a changed scene add up to its sky.
#[test]
fn changed_influences_add_up_to_the_sky() {
    let folder = tempfile::tempdir().unwrap();
    let observatory = observatory(folder.path());
    let lamp = LampChange {
        from: Some(LampPreset::Hps),
        to: LampPreset::Led4000k.lamp(),
        preserved: PreservedFlux::DnbFlux,
    };
    let new = Change::Add { radiance_nw_cm2_sr: 30.0, lamp: Some(LampPreset::Lps.lamp()), emission: None };
    let brush = Area::Brush { points: vec![[36.9, -1.5], [37.0, -1.5]], radius_m: 3_000.0 };
    let edits = vec![alter(west(), 0.5, Some(lamp), None), Edit { area: brush, change: new }];
    let scenario = painted(&observatory, None, edits);
    for turbidity in [2.5, 3.1] {
        let request = in_scenario(&sky(turbidity, -1.43, 36.93), &scenario);
        let answer = observatory.sky_blocking(&request).unwrap();
        for (measure, wanted) in [
            (Measure::Zenith, answer.quantities.zenith_luminance_cd_m2),
            (Measure::Horizontal, answer.quantities.horizontal_illuminance_lx),
        ] {
            let map = observatory.influence(&InfluenceRequest { sky: request.clone(), measure }).unwrap();
            assert!(
                (map.total().influence / wanted - 1.0).abs() < 1e-4,
                "{} {wanted}",
                map.total().influence
            );
            assert!((map.scale - 1.0).abs() < 3e-3 && map.pixels().len() > 6_000);
            assert!(map.pixels().windows(2).all(|pair| pair[0].number < pair[1].number));
        }
        // Norms of lights are positive whatever lamp they have.
        let norms = InfluenceRequest { sky: request, measure: Measure::Norm };
        assert!(observatory.influence(&norms).unwrap().influence().iter().all(|norm| *norm > 0.0));
    }
}

fn target(request: &SkyRequest, measure: Measure, limit: Limit) -> TargetSite {
    TargetSite { influence: InfluenceRequest { sky: request.clone(), measure }, limit }
}

fn plan(
    observatory: &Observatory,
    sites: Vec<TargetSite>,
    max_cut: f64,
    protect: Option<Boundary>,
) -> PlanOutcome {
    observatory.plan(&PlanRequest { method: PlanMethod::Target { sites, max_cut, protect } }).unwrap()
}

/// The plan as every query takes it.
fn kept(observatory: &Observatory, outcome: &PlanOutcome, base: Option<ChangeId>) -> ChangeId {
    let plan = StoredPlan {
        scene: town(),
        scene_version: observatory.view(&town(), None).unwrap().version().to_owned(),
        base,
        answer: serde_json::Value::Null,
        factors: outcome.factors(),
        effects: outcome.pixels.iter().map(|pixel| pixel.effect as f32).collect(),
    };
    let id = ChangeStore::plan_id(format!("{:?}", outcome.pixels).as_bytes());
    observatory.changes().store_plan(&id, &plan).unwrap();
    id
}

/// A target is met by the sky itself with the least flux.
#[test]
fn a_target_is_met_with_the_least_flux() {
    let folder = tempfile::tempdir().unwrap();
    let observatory = observatory(folder.path());
    // Between packs too, where a sky is not the sum of what its lights give alone.
    for turbidity in [2.5, 3.1] {
        let request = sky(turbidity, -1.05, 36.8);
        let request =
            SkyRequest { place: skyglow_physics::GeoPoint::from_deg(-1.21, 36.8).unwrap(), ..request };
        let outcome =
            plan(&observatory, vec![target(&request, Measure::Zenith, Limit::ReduceBy(0.3))], 0.9, None);
        let site = &outcome.sites[0];
        let (before, after) = (site.before.value, site.after.value);
        assert!((after / before - 0.7).abs() < 2e-4, "{turbidity}: {}", after / before);
        let told = site.target.unwrap();
        assert!(told.is_met && told.least < 0.15 * before && told.of_protected == 0.0);
        assert!((before / site.before.sky.quantities.zenith_luminance_cd_m2 - 1.0).abs() < 1e-6);
        // Near lights do most: a third of the light goes with much less of the flux.
        let removed = outcome.flux_removed_dnb_w();
        assert!(removed < 0.25 * outcome.flux_within_reach_dnb_w, "{removed:e}");
        let least = outcome.least_flux_dnb_w.unwrap();
        assert!(removed >= least * (1.0 - 1e-9) && removed <= least * (1.0 + 1e-9), "{removed:e} {least:e}");
        assert!(outcome.pixels.iter().all(|pixel| pixel.cut > 1e-6 && pixel.cut <= 0.9));
        let effects: f64 = outcome.pixels.iter().map(|pixel| pixel.effect).sum();
        assert!((effects - 1.0).abs() < 1e-9);
        // Its id brings the same sky to every query.
        let id = kept(&observatory, &outcome, None);
        let again = observatory.sky_blocking(&in_scenario(&request, &id)).unwrap();
        assert_eq!(again.quantities, site.after.sky.quantities);
    }
}

/// Several sites share a plan and protected lights stay.
#[test]
fn sites_share_a_plan_and_protected_lights_stay() {
    let folder = tempfile::tempdir().unwrap();
    let observatory = observatory(folder.path());
    let (a, b) = (sky(2.5, -1.35, 36.6), sky(2.5, -1.85, 37.05));
    let sites = vec![
        target(&a, Measure::Zenith, Limit::ReduceBy(0.2)),
        target(&b, Measure::Horizontal, Limit::ReduceBy(0.1)),
    ];
    let protect = Boundary::new(&polygon(36.7, -1.6, 36.9, -1.4)).unwrap();
    let together = plan(&observatory, sites.clone(), 0.8, Some(protect.clone()));
    for site in &together.sites {
        let told = site.target.unwrap();
        assert!(told.is_met && told.of_protected > 0.0 && told.of_uncut > 0.0, "{told:?}");
        assert!(site.after.value <= told.wanted * (1.0 + 1e-4));
    }
    for pixel in &together.pixels {
        let (column, row) = Scene::column_and_row_of(pixel.code);
        assert!(!protect.contains(together.scene.pixel_center(column, row)) && pixel.cut <= 0.8 + 1e-9);
    }
    let removed = together.flux_removed_dnb_w();
    assert!(removed <= together.least_flux_dnb_w.unwrap() * (1.0 + 1e-4));
    // Both together cost no more than each by itself, and no less than either.
    let alone = sites
        .into_iter()
        .map(|site| plan(&observatory, vec![site], 0.8, Some(protect.clone())).flux_removed_dnb_w());
    let alone: Vec<f64> = alone.collect();
    assert!(removed <= (alone[0] + alone[1]) * (1.0 + 1e-3), "{removed:e} {alone:?}");
    assert!(removed >= alone[0].max(alone[1]) * (1.0 - 1e-3));
}

/// What is out of reach is brought as near as it can be and said why.
#[test]
fn what_is_out_of_reach_is_brought_near() {
    let folder = tempfile::tempdir().unwrap();
    let observatory = observatory(folder.path());
    let request = sky(2.5, -1.35, 36.6);
    let protect = Boundary::new(&polygon(36.5, -1.4, 36.65, -1.3)).unwrap();
    let outcome =
        plan(&observatory, vec![target(&request, Measure::Mean, Limit::AtMost(0.0))], 0.5, Some(protect));
    let site = &outcome.sites[0];
    let told = site.target.unwrap();
    assert!(!told.is_met && told.wanted == 0.0);
    assert!((site.after.value / told.least - 1.0).abs() < 1e-3, "{} {}", site.after.value, told.least);
    assert!(told.of_protected > 0.0 && told.of_uncut > 0.0);
    assert!((told.of_protected + told.of_uncut - told.least).abs() < 1e-9 * told.least);
    assert!(outcome.pixels.iter().all(|pixel| (pixel.cut - 0.5).abs() < 1e-9));
    // All of the light is a wish that can be met.
    let outcome = plan(&observatory, vec![target(&request, Measure::Mean, Limit::ReduceBy(1.0))], 1.0, None);
    assert!(outcome.sites[0].target.unwrap().is_met, "{:?}", outcome.sites[0].target);
    let everything = outcome.flux_removed_dnb_w() / outcome.flux_within_reach_dnb_w;
    // To what f32 holds of influences.
    assert!(everything > 0.99999 && everything <= 1.0, "{everything}");
    // What is met already costs nothing.
    let outcome = plan(&observatory, vec![target(&request, Measure::Mean, Limit::AtMost(1.0))], 1.0, None);
    assert!(outcome.pixels.is_empty() && outcome.sites[0].target.unwrap().is_met);
    assert_eq!(outcome.sites[0].before.value, outcome.sites[0].after.value);
}

/// Thresholds cut the influential and stand upon scenarios.
#[test]
fn thresholds_cut_and_stand_upon_scenarios() {
    let folder = tempfile::tempdir().unwrap();
    let observatory = observatory(folder.path());
    let base = painted(&observatory, None, vec![alter(west(), 0.5, None, None)]);
    let request = in_scenario(&sky(2.5, -1.43, 36.73), &base);
    for measure in [Measure::Norm, Measure::Horizontal] {
        let site = InfluenceRequest { sky: request.clone(), measure };
        let method = PlanMethod::Threshold {
            site: Box::new(site.clone()),
            from: Level::Percentile(80.0),
            to: Level::Percentile(95.0),
            gamma: 0.6,
        };
        let outcome = observatory.plan(&PlanRequest { method }).unwrap();
        let map = observatory.influence(&site).unwrap();
        let [from, to] = outcome.thresholds.unwrap();
        let above = |level: f64| map.influence().iter().filter(|q| f64::from(**q) > level).count();
        let count = map.pixels().len();
        assert!(above(from).abs_diff(count / 5) < 3 && above(to).abs_diff(count / 20) < 3);
        assert_eq!(outcome.pixels.len(), above(from));
        let full = outcome.pixels.iter().filter(|pixel| (pixel.cut - 0.6).abs() < 1e-12).count();
        assert!(full.abs_diff(above(to)) < 3 && outcome.pixels.iter().all(|pixel| pixel.cut <= 0.6));
        let site = &outcome.sites[0];
        assert!(site.after.value < 0.9 * site.before.value && site.target.is_none());
        let id = kept(&observatory, &outcome, Some(base.clone()));
        let again = observatory.sky_blocking(&SkyRequest { scenario: Some(id), ..request.clone() }).unwrap();
        assert_eq!(again.quantities, site.after.sky.quantities);
    }
    let site = InfluenceRequest { sky: request, measure: Measure::Zenith };
    let (from, to) = (Level::Value(1.0), Level::Percentile(50.0));
    let method = PlanMethod::Threshold { site: site.into(), from, to, gamma: 1.0 };
    assert!(matches!(observatory.plan(&PlanRequest { method }), Err(ObservatoryError::BadPlan { .. })));
}
