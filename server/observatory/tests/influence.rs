//! What each pixel of a stored scene does to a measure of the sky.
#![allow(clippy::unwrap_used, reason = "a test that cannot be set up fails")]

mod common;

use common::{engine, request, sky, store_scene, store_town_on, town};
use skyglow_observatory::ObservatoryError;
use skyglow_observatory::{
    InfluenceMap, InfluenceRequest, InfluenceSolver, Measure, MeasureOfCells, Observatory, Part, SeenMeasure,
    influence_of_pixels,
};
use skyglow_physics::{
    BAND_COUNT, Direction, EmissionMix, GeoPoint, Horizon, LampPreset, LinearMeasure, Response, SkyCurve,
    source_pixel::point_sources,
};
use skyglow_render::{DeviceChoice, RenderRequest, TableSet, synthetic};
use skyglow_scene::{Boundary, PolarGrid, SceneStore};
use std::sync::Arc;

/// Pixels add up to the sky and each counts as if it were alone.
#[test]
fn pixels_add_up_and_count_as_if_alone() {
    let folder = tempfile::tempdir().unwrap();
    // A slope, so that pixels that share cells stand at different altitudes.
    store_town_on(folder.path(), 1.0, &|row, column| 200.0 + 30.0 * row as f32 + 55.0 * column as f32);
    let scene = SceneStore::new(folder.path()).open(&town()).unwrap();
    let solver =
        InfluenceSolver::new(Arc::new(TableSet::new(synthetic::table_set(&[1.5, 2.5, 3.5], 24)).unwrap()));
    let rule = LampPreset::Mixed.lamp().light().rule(&Response::Photopic);
    let measures = [LinearMeasure::zenith(&Horizon::flat()), LinearMeasure::horizontal(&Horizon::flat())];
    // Beside the town, where its pixels are split, and 30 km off, where they share cells.
    for (latitude_deg, longitude_deg) in [(-1.43, 36.64), (-1.59, 36.41)] {
        let here = GeoPoint::from_deg(latitude_deg, longitude_deg).unwrap();
        let (_, shares) = scene.light_shares(here, false).remove(0);
        assert_eq!(shares.len(), 9);
        let pixels = scene.source_pixels_within(here, 300_000.0);
        for turbidity in [2.5, 2.0] {
            let asked = request(PolarGrid::clone(&shares.polar), turbidity);
            for measure in &measures {
                let of_grid = |polar: PolarGrid| -> (Vec<_>, f64) {
                    let asked = RenderRequest { polar: Arc::new(polar), ..asked.clone() };
                    let cells = solver
                        .cells(
                            &asked,
                            MeasureOfCells::Linear(SeenMeasure { measure, rule: &rule, within: None }),
                        )
                        .unwrap();
                    let fluxes = asked.polar.cells.iter().map(|cell| f64::from(cell.flux_dnb_w));
                    let sum = cells.iter().zip(fluxes).map(|(cell, flux)| cell.per_dnb_w * flux).sum();
                    (cells, sum)
                };
                let (cells, sky) = of_grid(PolarGrid::clone(&shares.polar));
                let (influence, _) = influence_of_pixels(&shares, &cells, None);
                let sum: f64 = influence.iter().map(|value| f64::from(*value)).sum();
                assert!((sum / sky - 1.0).abs() < 1e-5, "{sum:e} {sky:e}");
                // Between packs a light counts by what it adds to the others', which is not what it gives alone.
                for (position, pixel) in pixels.iter().enumerate().filter(|_| turbidity == 2.5) {
                    let sources = point_sources(here, std::slice::from_ref(pixel));
                    let (_, alone) = of_grid(PolarGrid::from_sources(
                        here,
                        sources.into_iter().map(|source| (source, 0.0)),
                    ));
                    let error = f64::from(influence[position]) / alone - 1.0;
                    assert!(error.abs() < 0.01, "{longitude_deg} {turbidity} {position}: {error}");
                }
                // The check can fail: pixels are not alike.
                let (least, most) =
                    influence.iter().fold((f32::MAX, 0f32), |(a, b), &v| (a.min(v), b.max(v)));
                assert!(most > 1.05 * least);
            }
        }
    }
}

fn curve(corners_deg: &[(f64, f64)]) -> SkyCurve {
    let corner = |&(azimuth_deg, elevation_deg): &(f64, f64)| Direction {
        azimuth_rad: azimuth_deg.to_radians(),
        elevation_rad: elevation_deg.to_radians(),
    };
    SkyCurve::new(corners_deg.iter().map(corner).collect()).unwrap()
}

/// An observatory over a scene of 80 × 80 pixels, hilly and lit unevenly: far lights are taken by blocks.
fn observatory(folder: &std::path::Path) -> Observatory {
    let ground_m = |row: usize, column: usize| 300.0 + 40.0 * ((row * 7 + column * 13) % 23) as f32;
    let light = |row: usize, column: usize| ((row * 31 + column * 17) % 19) as f32 * 0.7;
    store_scene(folder, 80, [36.4, -1.2, 0.01], 1.0, &ground_m, &light);
    Observatory::new(engine(DeviceChoice::Cpu, &[1.5, 2.5, 3.5], 24), Vec::new(), folder, 1)
}

fn sum(parts: &[Part]) -> f64 {
    parts.iter().map(|part| part.influence).sum()
}

/// Influences add up to the panoramas own value and so do their parts.
#[test]
fn influences_and_parts_add_up_to_the_panorama() {
    let folder = tempfile::tempdir().unwrap();
    let observatory = observatory(folder.path());
    let region = curve(&[(340.0, 5.0), (20.0, 5.0), (0.0, 60.0)]);
    for turbidity in [2.5, 3.1] {
        let sky = sky(turbidity, -1.23, 36.43);
        let answer = observatory.sky_blocking(&sky).unwrap();
        let of_region = LinearMeasure::region(&region, &answer.horizon);
        for (measure, wanted) in [
            (Measure::Zenith, answer.quantities.zenith_luminance_cd_m2),
            (Measure::Mean, answer.quantities.mean_luminance_cd_m2),
            (Measure::Horizontal, answer.quantities.horizontal_illuminance_lx),
            (Measure::Region(region.clone()), of_region.of(answer.values())),
        ] {
            let map = observatory.influence(&InfluenceRequest { sky: sky.clone(), measure }).unwrap();
            assert_eq!((map.context.coverage, map.context.basis_count), (answer.context.coverage, 24));
            assert!((map.context.flux_dnb_w / answer.context.flux_dnb_w - 1.0).abs() < 1e-12);
            assert!(map.influence().iter().all(|value| value.is_finite()));
            // What makes them add up is small.
            assert!(map.scale != 1.0 && (map.scale - 1.0).abs() < 3e-3, "{}", map.scale);
            let total = map.total();
            assert!(
                (total.influence / wanted - 1.0).abs() < 1e-4,
                "{turbidity} {}",
                total.influence / wanted
            );
            assert!((sum(&map.rings()) / wanted - 1.0).abs() < 1e-4);
            assert!((sum(&map.sectors()) / wanted - 1.0).abs() < 1e-4);
            assert_eq!(total.pixels, map.pixels().len() as u64);
            assert!((total.flux_dnb_w / answer.context.flux_dnb_w - 1.0).abs() < 1e-5);
        }
    }
}

/// Whether a pixel's centre lies in a box: west, south, east, north.
fn is_in(map: &InfluenceMap, position: usize, [west, south, east, north]: [f64; 4]) -> bool {
    let (latitude, longitude) = (map.place(position).latitude_deg(), map.place(position).longitude_deg());
    (west..east).contains(&longitude) && (south..north).contains(&latitude)
}

/// The most influential pixels come first and a boundary holds its own.
#[test]
fn the_influential_come_first_and_areas_hold() {
    let folder = tempfile::tempdir().unwrap();
    let observatory = observatory(folder.path());
    let ask = InfluenceRequest { sky: sky(2.5, -1.5, 36.8), measure: Measure::Zenith };
    let map = observatory.influence(&ask).unwrap();
    let all = map.most(usize::MAX);
    assert!(all.windows(2).all(|pair| map.influence()[pair[0]] >= map.influence()[pair[1]]));
    assert_eq!((map.most(7).as_slice(), map.most(0).len()), (&all[..7], 0));
    assert_eq!(map.brightest_colour(), f64::from(map.influence()[all[31]]));
    assert!(map.pixels()[all[0]].distance_m < 10_000.0);
    let inside = [36.603, -1.597, 36.901, -1.403];
    let [w, s, e, n] = inside;
    let square = vec![vec![vec![[w, s], [e, s], [e, n], [w, n], [w, s]]]];
    let part = map.within(&Boundary::new(&square).unwrap());
    let positions: Vec<usize> =
        (0..map.pixels().len()).filter(|&position| is_in(&map, position, inside)).collect();
    let wanted: f64 = positions.iter().map(|&position| f64::from(map.influence()[position])).sum();
    assert_eq!(part.pixels, positions.len() as u64);
    assert!((part.influence / wanted - 1.0).abs() < 1e-9);
    assert!(part.influence > 0.3 * map.total().influence && part.influence < map.total().influence);
}

/// A region without a visible direction is refused and a norm is that of the light alone.
#[test]
fn hidden_regions_are_refused_norms_are_alone() {
    let folder = tempfile::tempdir().unwrap();
    let observatory = observatory(folder.path());
    // Between two rows of directions.
    let sliver = curve(&[(10.0, 45.1), (11.0, 45.1), (10.5, 45.2)]);
    let ask = InfluenceRequest { sky: sky(2.5, -1.5, 36.8), measure: Measure::Region(sliver) };
    assert!(matches!(observatory.influence(&ask), Err(ObservatoryError::EmptyRegion)));
    let outside = InfluenceRequest { sky: sky(2.5, 1.5, 36.8), measure: Measure::Norm };
    assert!(matches!(observatory.influence(&outside), Err(ObservatoryError::OutsideScene { .. })));
    let map = observatory.influence(&InfluenceRequest { measure: Measure::Norm, ..ask.clone() }).unwrap();
    assert!(map.influence().iter().all(|value| value.is_finite() && *value > 0.0));
    // Norms are those of pixels alone: near ones are wide, far ones points.
    let scene = SceneStore::new(folder.path()).open(&town()).unwrap();
    let pixels = scene.source_pixels_within(sky(2.5, -1.5, 36.8).place, 300_000.0);
    let solver = InfluenceSolver::new(Arc::new(TableSet::new(synthetic::table_set(&[2.5], 24)).unwrap()));
    let rule = LampPreset::Mixed.lamp().light().rule(&Response::Photopic);
    let mut nearest: Vec<usize> = (0..pixels.len()).collect();
    nearest.sort_by(|a, b| map.pixels()[*a].distance_m.total_cmp(&map.pixels()[*b].distance_m));
    for &position in nearest.iter().take(40).step_by(3).chain(nearest.iter().skip(100).step_by(500)) {
        let sources = point_sources(ask.sky.place, std::slice::from_ref(&pixels[position]));
        let polar = PolarGrid::from_sources(ask.sky.place, sources.into_iter().map(|source| (source, 0.0)));
        let alone = RenderRequest {
            polar: Arc::new(polar),
            observer_altitude_m: map.context.altitude_m,
            flux_per_dnb_flux: [1.0; BAND_COUNT],
            emission: EmissionMix::garstang(),
            ..request(synthetic::dark_grid(), 2.5)
        };
        let error = f64::from(map.influence()[position]) / solver.norm(&alone, &rule).unwrap() - 1.0;
        let pixel = map.pixels()[position];
        assert!(error.abs() < if pixel.distance_m < 5_000.0 { 1e-3 } else { 0.03 }, "{pixel:?} {error}");
    }
    // Norms of lights are no parts of the norm of all: together they are more.
    let whole = observatory.sky_blocking(&sky(2.5, -1.5, 36.8)).unwrap();
    assert!(map.total().influence > whole.quantities.mean_luminance_cd_m2 * std::f64::consts::TAU.sqrt());
}
