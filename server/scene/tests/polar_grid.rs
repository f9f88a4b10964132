//! The polar grid against the sum over the raster's own pixels.

#![expect(clippy::unwrap_used, reason = "a test stops at the first error")]

mod common;

use common::{STEP, TestRaster, TestStore, place};
use proptest::prelude::*;
use skyglow_physics::geometry::LocalFrame;
use skyglow_physics::source_pixel::{point_sources, upward_flux_dnb_w};
use skyglow_physics::{EARTH_RADIUS_M, GeoPoint};
use skyglow_scene::{FAR_BLOCK_RATIO, PolarGrid, Scene, ring_distance_m};
use std::sync::OnceLock;

/// Flux of all pixels whose centre is within `radius_m`, straight from the raster's values by spherical
/// formulas written out here.
fn direct_flux_dnb_w(raster: &TestRaster, observer: GeoPoint, radius_m: f64) -> f64 {
    let g = raster.geotransform;
    let (width, _) = raster.size;
    let lit = raster.values.iter().enumerate().filter(|(_, value)| **value > 0.0);
    lit.map(|(index, value)| {
        let (column, row) = ((index % width) as f64, (index / width) as f64);
        let (north, south) = ((g[3] + row * g[5]).to_radians(), (g[3] + (row + 1.0) * g[5]).to_radians());
        let center = ((g[3] + (row + 0.5) * g[5]).to_radians(), (g[0] + (column + 0.5) * g[1]).to_radians());
        let (lat, lon) = (observer.latitude_rad(), observer.longitude_rad());
        let haversine = ((center.0 - lat) / 2.0).sin().powi(2)
            + center.0.cos() * lat.cos() * ((center.1 - lon) / 2.0).sin().powi(2);
        let distance_m = 2.0 * EARTH_RADIUS_M * haversine.sqrt().asin();
        let area_m2 = EARTH_RADIUS_M.powi(2) * g[1].to_radians() * (north.sin() - south.sin());
        if distance_m <= radius_m { upward_flux_dnb_w(f64::from(*value as f32), area_m2) } else { 0.0 }
    })
    .sum()
}

/// How far a pixel's centre here, in the middle of its parallels and meridians, is from the mean of its corners at
/// most: R·sin φ·cos φ·(Δλ/2)²/2. A pixel so near to 300 km may fall on either side.
fn center_slack_m(raster: &TestRaster) -> f64 {
    EARTH_RADIUS_M * raster.geotransform[1].to_radians().powi(2) / 16.0 + 1e-3
}

fn cell_flux(grid: &PolarGrid) -> f64 {
    grid.cells.iter().map(|cell| f64::from(cell.flux_dnb_w)).sum()
}

/// The rasters: mid latitudes, across the antimeridian, 0..360 at a coarse step, the north pole.
fn worlds() -> &'static [(TestRaster, Scene)] {
    static WORLDS: OnceLock<Vec<(TestRaster, Scene)>> = OnceLock::new();
    WORLDS.get_or_init(|| {
        let at = |west, north, step| {
            let mut raster = TestRaster::scattered(900, 700);
            raster.geotransform = [west, step, 0.0, north, 0.0, -step];
            raster
        };
        let mut rasters = vec![at(36.0, 1.0, STEP), at(178.5, -15.0, STEP), at(-181.0, 60.0, STEP)];
        let mut whole = at(0.0, 90.0, 0.4);
        whole.size = (900, 450);
        whole.values.truncate(900 * 450);
        rasters.push(whole);
        rasters.push(at(0.0, 90.0, 0.4));
        let mut pole = at(-180.0, 90.0, 0.4);
        pole.geotransform[5] = -0.01;
        rasters[4] = pole;
        rasters
            .into_iter()
            .map(|raster| {
                let scene = TestStore::new().scene(&raster);
                (raster, scene)
            })
            .collect()
    })
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 24, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn flux_is_that_of_the_pixels_within_300_km(world in 0usize..5, x in -0.2f64..1.2, y in 0.0f64..1.2) {
        let (raster, scene) = &worlds()[world];
        let g = raster.geotransform;
        let longitude = (g[0] + g[1] * x * raster.size.0 as f64 + 540.0).rem_euclid(360.0) - 180.0;
        let latitude = (g[3] + g[5] * y * raster.size.1 as f64).clamp(-90.0, 90.0);
        let observer = place(latitude, longitude);
        let slack_m = center_slack_m(raster);
        let [least, most] = [-slack_m, slack_m].map(|more_m| direct_flux_dnb_w(raster, observer, 300_000.0 + more_m));
        let grid = scene.polar_grid(observer, false);
        let flux = grid.flux_dnb_w;
        prop_assert!((least * (1.0 - 1e-9)..=most * (1.0 + 1e-9)).contains(&flux), "{least} {flux} {most}");
        prop_assert!((cell_flux(&grid) - flux).abs() <= 1e-6 * flux);
        let exact: f64 = scene.source_pixels_within(observer, 300_000.0).iter().map(|p| p.flux_dnb_w).sum();
        prop_assert!((exact - flux).abs() <= 1e-9 * flux);
        prop_assert_eq!(grid.azimuth_start.len(), 257);
        prop_assert!(grid.azimuth_start.windows(2).all(|w| w[0] <= w[1]));
        prop_assert!(grid.cells.iter().all(|c| c.ring < 192 && c.flux_dnb_w > 0.0));
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 12, failure_persistence: None, ..ProptestConfig::default() })]

    /// The light of every pixel is found in the cells that it went to.
    #[test]
    fn light_shares_point_to_the_cells_of_a_pixel(world in 0usize..5, x in -0.1f64..1.1, y in 0.0f64..1.1) {
        let (raster, scene) = &worlds()[world];
        let g = raster.geotransform;
        let longitude = (g[0] + g[1] * x * raster.size.0 as f64 + 540.0).rem_euclid(360.0) - 180.0;
        let observer = place((g[3] + g[5] * y * raster.size.1 as f64).clamp(-90.0, 90.0), longitude);
        let (_, shares) = scene.light_shares(observer, false).remove(0);
        // The grid is that of every pixel by itself.
        let alone = scene.polar_grid_with_ratio(observer, false, 0.0);
        prop_assert!((shares.polar.flux_dnb_w - alone.flux_dnb_w).abs() <= 1e-9 * alone.flux_dnb_w);
        prop_assert_eq!(shares.polar.cells.len(), alone.cells.len());
        let mut of_cells = vec![0f64; shares.polar.cells.len()];
        prop_assert!(shares.pixels().windows(2).all(|pair| pair[0].number < pair[1].number));
        let frame = LocalFrame::at(observer);
        for (position, pixel) in shares.pixels().iter().enumerate() {
            let (column, row) = scene.column_and_row(pixel.number);
            let value = raster.values[row as usize * raster.size.0 + column as usize];
            prop_assert!(value > 0.0);
            let bearing = frame.bearing_to(scene.pixel_center(column, row).unit_vector());
            let distance_m = bearing.distance_m;
            prop_assert!(distance_m <= 300_000.0);
            prop_assert!((f64::from(pixel.distance_m) - distance_m).abs() <= 1e-6 * distance_m);
            prop_assert!((f64::from(pixel.azimuth_rad) - bearing.azimuth_rad).abs() < 1e-6);
            let mut flux = 0.0;
            for share in shares.shares(position) {
                of_cells[share.cell as usize] += f64::from(share.flux_dnb_w);
                flux += f64::from(share.flux_dnb_w);
                let ring_m = ring_distance_m(shares.polar.cells[share.cell as usize].ring as usize);
                // Pieces of a near pixel are where they are; a far one lies between its rings.
                prop_assert!(distance_m < 5_000.0 || (ring_m / distance_m).ln().abs() < 0.0372);
            }
            let (north, south) = (g[3] + f64::from(row) * g[5], g[3] + f64::from(row + 1) * g[5]);
            let area_m2 = EARTH_RADIUS_M.powi(2)
                * g[1].to_radians()
                * (north.to_radians().sin() - south.to_radians().sin());
            let wanted = upward_flux_dnb_w(f64::from(value as f32), area_m2);
            prop_assert!((flux / wanted - 1.0).abs() < 1e-5, "{flux} {wanted}");
            prop_assert!((f64::from(pixel.flux_dnb_w) / wanted - 1.0).abs() < 1e-5);
        }
        for (sum, cell) in of_cells.iter().zip(&shares.polar.cells) {
            let flux = f64::from(cell.flux_dnb_w);
            prop_assert!((sum - flux).abs() < 1e-5 * flux, "{sum} {flux}");
        }
    }
}

#[test]
fn a_pixel_more_is_seen_in_the_flux() {
    let (raster, scene) = &worlds()[0];
    let observer = place(0.0, 37.5);
    let mut other = raster.clone();
    let dark = other.values.iter().position(|v| *v == 0.0).unwrap();
    other.values[dark] = 40.0;
    let missed =
        (scene.polar_grid(observer, false).flux_dnb_w / direct_flux_dnb_w(&other, observer, 300_000.0) - 1.0)
            .abs();
    assert!(missed > 1e-6, "{missed}");
}

#[test]
fn light_near_300_km_is_cut_pixel_by_pixel() {
    let (raster, scene) = &worlds()[0];
    // The raster is 417 km wide: from its west edge the circle passes through it.
    let observer = place(-0.5, 36.0);
    let all = scene.metadata().report.flux_dnb_w;
    let grid = scene.polar_grid(observer, false);
    assert!(grid.flux_dnb_w < 0.9 * all);
    assert!((grid.flux_dnb_w / direct_flux_dnb_w(raster, observer, 300_000.0) - 1.0).abs() < 1e-12);
}

/// Turning the observer at the pole turns the polar grid.
#[test]
fn turning_at_the_pole_turns_the_grid() {
    let (_, scene) = &worlds()[4];
    let step_deg = 360.0 / 256.0;
    let (first, turned) =
        (scene.polar_grid(place(90.0, 10.0), false), scene.polar_grid(place(90.0, 10.0 + step_deg), false));
    let column = |grid: &PolarGrid, i: usize| -> Vec<(u32, f32)> {
        let range = grid.azimuth_start[i] as usize..grid.azimuth_start[i + 1] as usize;
        grid.cells[range].iter().map(|c| (c.ring, c.flux_dnb_w)).collect()
    };
    let sum = |cells: &[(u32, f32)]| cells.iter().map(|c| f64::from(c.1)).sum::<f64>();
    // At the north pole azimuth is measured from the meridian of the given longitude + 180° towards smaller
    // longitudes, so turning east by a column moves every light to the column after.
    for i in 0..256 {
        let (a, b) = (sum(&column(&first, i)), sum(&column(&turned, (i + 1) % 256)));
        assert!((a / b - 1.0).abs() < 1e-4, "{i}: {a} {b}");
    }
    // The control: without the turn the columns differ.
    let unturned =
        (0..256).filter(|&i| (sum(&column(&first, i)) / sum(&column(&turned, i)) - 1.0).abs() > 1e-3);
    assert!(unturned.count() > 100);
}

/// What a smooth law makes of the light: r^−2.5, sharper towards one azimuth.
fn weigh(sources: impl Iterator<Item = (f64, f64, f64)>, towards_rad: f64) -> f64 {
    sources
        .map(|(azimuth_rad, distance_m, flux)| {
            flux * (distance_m / 1e4).powf(-2.5) * (6.0 * ((azimuth_rad - towards_rad).cos() - 1.0)).exp()
        })
        .sum()
}

fn cells_of(grid: &PolarGrid) -> impl Iterator<Item = (f64, f64, f64)> + '_ {
    (0..256).flat_map(move |i| {
        let range = grid.azimuth_start[i] as usize..grid.azimuth_start[i + 1] as usize;
        let azimuth_rad = i as f64 * std::f64::consts::TAU / 256.0;
        grid.cells[range]
            .iter()
            .map(move |c| (azimuth_rad, ring_distance_m(c.ring as usize), f64::from(c.flux_dnb_w)))
    })
}

/// Far blocks change a smooth sky by less than splatting does.
#[test]
fn far_blocks_change_less_than_splatting() {
    let (_, scene) = &worlds()[0];
    let observer = place(-0.4, 37.9);
    let blocks = scene.polar_grid(observer, false);
    let pixels = scene.polar_grid_with_ratio(observer, false, 0.0);
    let exact = point_sources(observer, &scene.source_pixels_within(observer, 300_000.0));
    let (mut by_blocks, mut by_splat) = (0f64, 0f64);
    for k in 0..16 {
        let towards = f64::from(k) * std::f64::consts::TAU / 16.0;
        let reference = weigh(exact.iter().map(|s| (s.azimuth_rad, s.distance_m, s.flux_dnb_w)), towards);
        let [blocks, pixels] = [&blocks, &pixels].map(|grid| weigh(cells_of(grid), towards));
        by_blocks = by_blocks.max((blocks / pixels - 1.0).abs());
        by_splat = by_splat.max((pixels / reference - 1.0).abs());
    }
    println!("blocks change it by {by_blocks:.1e}, the splat by {by_splat:.1e}");
    assert!(by_blocks < 1e-4 && by_splat < 3e-3);
    // The control: blocks eight times as wide are seen.
    let coarse = scene.polar_grid_with_ratio(observer, false, 8.0 * FAR_BLOCK_RATIO);
    let changed = (weigh(cells_of(&coarse), 1.0) / weigh(cells_of(&pixels), 1.0) - 1.0).abs();
    assert!(changed > by_blocks, "{changed}");
}

/// Near lights represent every pixel once, and blocks among them are narrow.
#[test]
fn near_lights_cover_every_pixel_once() {
    let mut lit_worlds = 0;
    for (_, scene) in worlds() {
        let [west, south, east, north] = scene.metadata().bounds;
        let longitude = (0.5 * (west + east) + 540.0).rem_euclid(360.0) - 180.0;
        let observer = place(0.5 * (south + north), longitude);
        let grid = scene.polar_grid(observer, false);
        let lit = scene.source_pixels_within(observer, 300_000.0);
        let mut seen = std::collections::BTreeMap::new();
        for light in &grid.near {
            // Pieces of one pixel come one after the other.
            let count = seen.entry(light.number).or_insert(light.pixel_count);
            assert_eq!(*count, light.pixel_count);
            assert!(light.pixel_count == 1 || light.distance_m > 30_000.0, "{light:?}");
        }
        let mut last = None;
        for (number, count) in &seen {
            assert!(last.is_none_or(|last| last <= *number), "{number} twice");
            last = Some(number + count);
        }
        let pixels: u32 = seen.values().sum();
        assert_eq!(pixels as usize, lit.len());
        if lit.is_empty() {
            continue;
        }
        lit_worlds += 1;
        let flux: f64 = grid.near.iter().map(|light| f64::from(light.flux_dnb_w)).sum();
        assert!((flux / grid.flux_dnb_w - 1.0).abs() < 1e-5, "{flux} of {}", grid.flux_dnb_w);
    }
    assert!(lit_worlds >= 3, "{lit_worlds}");
}

#[test]
fn one_lamp_is_found_where_it_is() {
    let test_store = TestStore::new();
    let raster = TestRaster::new(700, 500, |c, r| if (c, r) == (600, 100) { 25.0 } else { 0.0 });
    let scene = test_store.scene(&raster);
    let lamp = place(-1.0 - 100.5 * STEP, 37.0 + 600.5 * STEP);
    for (lat, lon) in [(-2.0, 37.5), (-1.5, 40.5), (-1.5, 39.6), (0.9, 39.0)] {
        let observer = place(lat, lon);
        let bearing = LocalFrame::at(observer).bearing_to(lamp.unit_vector());
        let grid = scene.polar_grid(observer, false);
        let (mut azimuth, mut log, mut flux) = ((0.0, 0.0), 0.0, 0.0);
        for (cell_azimuth, cell_distance, cell_flux) in cells_of(&grid) {
            azimuth.0 += cell_flux * cell_azimuth.sin();
            azimuth.1 += cell_flux * cell_azimuth.cos();
            log += cell_flux * cell_distance.ln();
            flux += cell_flux;
        }
        let turn = (azimuth.0.atan2(azimuth.1) - bearing.azimuth_rad).sin();
        assert!(turn.abs() < 1e-3, "{turn}");
        assert!(((log / flux).exp() / bearing.distance_m - 1.0).abs() < 1e-3, "{lat} {lon}");
        assert!((flux / scene.metadata().report.flux_dnb_w - 1.0).abs() < 1e-6);
    }
}

/// The calibration multiplies the flux and not the radiance.
#[test]
fn calibration_scales_flux_not_radiance() {
    let test_store = TestStore::new();
    let raster = TestRaster::scattered(100, 100);
    let plain = test_store.scene(&raster);
    let brighter = test_store.scene_with(&raster, |options| options.calibration = 1.5);
    let observer = place(-1.2, 37.2);
    let ratio =
        brighter.polar_grid(observer, false).flux_dnb_w / plain.polar_grid(observer, false).flux_dnb_w;
    assert!((ratio - 1.5).abs() < 1e-12);
    assert_eq!(brighter.radiance_nw_cm2_sr(observer), plain.radiance_nw_cm2_sr(observer));
    assert_ne!(brighter.metadata().version, plain.metadata().version);
}

#[test]
fn coverage_is_the_covered_part_of_the_disc() {
    let (raster, scene) = &worlds()[0];
    for (lat, lon) in [(-0.5, 37.9), (-1.0, 36.0), (3.0, 37.0), (-30.0, 37.0)] {
        let observer = place(lat, lon);
        let (mut inside, mut all) = (0.0, 0.0);
        let frame = LocalFrame::at(observer);
        // A fine geographic raster of the disc, each pixel with its area.
        for i in 0..1200 {
            for j in 0..1200 {
                let (dlat, dlon) = (-3.0 + 0.005 * f64::from(i), -4.0 + f64::from(j) / 150.0);
                let (there_lat, there_lon) = (lat + dlat, lon + dlon);
                let vector = GeoPoint::from_rad_unchecked(there_lat.to_radians(), there_lon.to_radians())
                    .unit_vector();
                if frame.bearing_to(vector).distance_m <= 300_000.0 {
                    let area = there_lat.to_radians().cos();
                    let g = raster.geotransform;
                    let (c, r) = ((there_lon - g[0]) / g[1], (there_lat - g[3]) / g[5]);
                    all += area;
                    inside += if (0.0..900.0).contains(&c) && (0.0..700.0).contains(&r) { area } else { 0.0 };
                }
            }
        }
        let coverage = scene.coverage(observer);
        assert!((coverage - inside / all).abs() < 0.005, "{coverage} {}", inside / all);
        assert_eq!(scene.polar_grid(observer, false).coverage, coverage);
    }
}

#[test]
fn no_data_is_not_covered_and_darkness_is() {
    let test_store = TestStore::new();
    let mut raster = TestRaster::new(1600, 1600, |c, r| if (c, r) == (800, 800) { 9.0 } else { 0.0 });
    let observer = place(-1.0 - 800.0 * STEP, 37.0 + 800.0 * STEP);
    assert!(test_store.scene(&raster).coverage(observer) > 0.999);
    raster.no_data = Some(-1.0);
    for (index, value) in raster.values.iter_mut().enumerate() {
        if index % 1600 < 800 {
            *value = -1.0;
        }
    }
    let half = test_store.scene(&raster).coverage(observer);
    assert!((half - 0.5).abs() < 0.003, "{half}");
}
