//! Light behind skylines: both executors against f64, and what they do where nothing is hidden or packs know no skylines.
#![allow(clippy::unwrap_used, reason = "a test that cannot be set up fails")]

mod common;

use common::{largest_error, request, vulkan};
use skyglow_physics::{BAND_COUNT, LOBE_COUNT};
use skyglow_render::{
    DeviceChoice, Engine, EngineConfig, TableSet, prepare::Prepared, reference::render_f64, synthetic,
};
use skyglow_scene::{PolarCell, PolarGrid};
use skyglow_tables::ResidentTables;
use std::sync::Arc;

fn engine(device: DeviceChoice, turbidities: &[f64]) -> Engine {
    let tables = synthetic::table_set_with_skylines(turbidities, 16);
    Engine::start(EngineConfig { device, tables, ..EngineConfig::default() }).unwrap()
}

/// All light of a grid at one blocking angle.
fn all_behind(mut grid: PolarGrid, blocking: u32) -> PolarGrid {
    grid.cells.iter_mut().for_each(|cell| cell.blocking = blocking);
    grid
}

/// Vulkan and CPU agree with f64 on light behind skylines.
#[test]
fn executors_agree_with_f64_behind_skylines() {
    let engines = [vulkan(), DeviceChoice::Cpu].map(|device| engine(device, &[2.0, 3.0, 4.0]));
    let set = TableSet::new(engines[0].tables().to_vec()).unwrap();
    for (turbidity, basis) in [(2.0, None), (2.4, None), (3.0, Some(5))] {
        let mut request = request(synthetic::polar_grid_with_skylines(7, 3000), turbidity);
        request.basis = basis;
        let prepared = Prepared::new(&request, &set).unwrap();
        assert!(prepared.nodes.iter().any(|node| node.blocking == 7));
        let exact = render_f64(&prepared, &set);
        for engine in &engines {
            let rendered = engine.render_blocking(request.clone()).unwrap();
            let error = largest_error(rendered.panorama.samples(), &exact);
            println!(
                "{:?}, T = {turbidity}, basis {basis:?}: largest relative error {error:.1e}",
                rendered.executor
            );
            assert!(error < 1e-5, "{error}");
        }
        // Other angles are seen.
        let mut other = request.clone();
        for cell in Arc::make_mut(&mut other.polar).cells.iter_mut().step_by(50) {
            cell.blocking = (cell.blocking + 1) % 8;
        }
        let rendered = engines[1].render_blocking(other).unwrap();
        assert!(largest_error(rendered.panorama.samples(), &exact) > 1e-5);
    }
}

/// A coefficient under an open sky and one behind a skyline.
fn one_of_each(tables: &ResidentTables) -> [half::f16; 2] {
    let blocked = tables.blocked.as_ref().unwrap();
    [
        tables.shape[tables.shape_index(1, 2, 1, 30, 3) * tables.basis_count],
        blocked.shape[blocked.shape_index(1, 4, 2, 1, 30, 3) * blocked.basis_count],
    ]
}

/// The same pack with one observer altitude fewer and the others closer together, below clouds at 2 000 m.
fn closed(pack: Arc<ResidentTables>) -> Arc<ResidentTables> {
    let mut pack = synthetic::under_clouds(vec![pack], 2_000).remove(0);
    let tables = Arc::make_mut(&mut pack);
    let before = one_of_each(tables);
    let blocked = tables.blocked.as_mut().unwrap();
    for (altitudes_m, log_scale, shape, basis_count) in [
        (&mut tables.observer_altitude_m, &mut tables.log_scale, &mut tables.shape, tables.basis_count),
        (&mut blocked.observer_altitude_m, &mut blocked.log_scale, &mut blocked.shape, blocked.basis_count),
    ] {
        let count = altitudes_m.len();
        altitudes_m.truncate(count - 1);
        log_scale.truncate(log_scale.len() / count * (count - 1));
        let images = LOBE_COUNT * BAND_COUNT * basis_count;
        let kept = shape.chunks_exact(count * images).flat_map(|node| &node[..(count - 1) * images]);
        *shape = kept.copied().collect();
        let part = 1_800.0 / altitudes_m[count - 2];
        altitudes_m.iter_mut().for_each(|altitude_m| *altitude_m *= part);
    }
    // What is kept is where it belongs.
    assert_eq!(one_of_each(tables), before);
    pack
}

/// Skies of kinds with altitudes of their own agree with f64 side by side.
#[test]
fn kinds_with_own_altitudes_agree_with_f64() {
    let mut tables = synthetic::table_set_with_skylines(&[2.0, 3.0], 8);
    tables.extend(synthetic::table_set_with_skylines(&[2.0, 3.0], 8).into_iter().map(closed));
    let set = TableSet::new(tables.clone()).unwrap();
    for device in [vulkan(), DeviceChoice::Cpu] {
        let engine =
            Engine::start(EngineConfig { device, tables: tables.clone(), ..EngineConfig::default() })
                .unwrap();
        let skies = [None, Some(2_000)].map(|cloud_base_m| {
            let mut request = request(synthetic::polar_grid_with_skylines(7, 3000), 2.4);
            request.cloud_base_m = cloud_base_m;
            let prepared = Prepared::new(&request, &set).unwrap();
            // Under clouds nothing hides lights, whatever tables a pack has.
            assert_eq!(prepared.nodes.iter().any(|node| node.blocking > 0), cloud_base_m.is_none());
            let exact = render_f64(&prepared, &set);
            let rendered = engine.render_blocking(request).unwrap();
            let error = largest_error(rendered.panorama.samples(), &exact);
            assert!(error < 2e-5, "{device:?}, clouds {cloud_base_m:?}: {error}");
            exact
        });
        // At one altitude they are read at other nodes.
        assert_ne!(skies[0], skies[1]);
    }
}

/// More nodes than one column of the texture holds come out right.
#[test]
fn nodes_beyond_one_texture_column_are_right() {
    // Light at every angle and at many altitudes on every ring.
    let mut grid = synthetic::dark_grid();
    for azimuth in 0..256 {
        if azimuth % 4 == 0 {
            for ring in 0..192u32 {
                for blocking in 0..8 {
                    let altitude_m = 40.0 * ((azimuth / 4 * 37 + 11 * ring as usize) % 150) as f32;
                    grid.cells.push(PolarCell { ring, flux_dnb_w: 1e4, altitude_m, blocking });
                }
            }
        }
        grid.azimuth_start[azimuth + 1] = grid.cells.len() as u32;
    }
    let engines = [vulkan(), DeviceChoice::Cpu].map(|device| engine(device, &[2.0]));
    let set = TableSet::new(engines[0].tables().to_vec()).unwrap();
    let request = request(grid, 2.0);
    let prepared = Prepared::new(&request, &set).unwrap();
    assert!(prepared.nodes.len() > 8192, "{}", prepared.nodes.len());
    let exact = render_f64(&prepared, &set);
    for engine in &engines {
        let rendered = engine.render_blocking(request.clone()).unwrap();
        let error = largest_error(rendered.panorama.samples(), &exact);
        assert!(error < 1e-5, "{error}");
    }
}

/// An open sky is rendered as by packs that know no skylines and costs no more.
#[test]
fn an_open_sky_costs_no_more_with_skylines() {
    for device in [vulkan(), DeviceChoice::Cpu] {
        let knowing = engine(device, &[2.0, 3.0]);
        let plain = common::engine(device, &[2.0, 3.0], 16);
        let open = request(synthetic::polar_grid(3, 800), 2.3);
        let (a, b) = (knowing.render_blocking(open.clone()).unwrap(), plain.render_blocking(open).unwrap());
        assert_eq!(a.panorama, b.panorama);
        assert_eq!(a.work, b.work);
    }
}

/// Packs that know no skylines take hidden light for open.
#[test]
fn packs_without_skylines_hide_no_light() {
    let plain = common::engine(DeviceChoice::Cpu, &[2.0], 16);
    let open = synthetic::polar_grid(3, 800);
    let behind = plain.render_blocking(request(all_behind(open.clone(), 5), 2.0)).unwrap();
    assert_eq!(behind.panorama, plain.render_blocking(request(open, 2.0)).unwrap().panorama);
    assert!(!TableSet::new(plain.tables().to_vec()).unwrap().kinds()[0].hides_lights);
}

#[test]
fn higher_skylines_make_darker_skies() {
    let engine = engine(DeviceChoice::Cpu, &[2.0]);
    let open = synthetic::polar_grid(3, 800);
    let mut before = f64::INFINITY;
    for blocking in 1..8 {
        let sky = engine.render_blocking(request(all_behind(open.clone(), blocking), 2.0)).unwrap();
        let sum: f64 = sky.panorama.samples().iter().map(|value| f64::from(*value)).sum();
        assert!(sum < before, "{blocking}: {sum} {before}");
        before = sum;
    }
}
