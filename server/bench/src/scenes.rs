//! Made-up light: scenes of any number of lit sources over hills, the same every time.

use skyglow_physics::{
    AZIMUTH_COUNT, EARTH_RADIUS_M, GeoPoint, PointSource, SourcePixel,
    geometry::LocalFrame,
    panorama::azimuth_rad,
    source_pixel::{MAX_SOURCE_DISTANCE_M, upward_flux_dnb_w},
};
use skyglow_render::{
    TableSet,
    synthetic::{Noise, polar_grid_of},
};
use skyglow_scene::{
    FAR_BLOCK_RATIO, NO_BLOCKS_WITHIN_M, NearLight, PolarCell, PolarGrid, RING_COUNT, ring_distance_m,
};
use std::{collections::BTreeMap, sync::Arc, time::Instant};

/// Eye above the ground, metres.
const EYE_HEIGHT_M: f64 = 2.0;
/// Side of a raster pixel, metres: 15″.
pub const PIXEL_SIDE_M: f64 = EARTH_RADIUS_M * std::f64::consts::PI / (180.0 * 240.0);
/// Radiance in the middle of the range, nW cm⁻² sr⁻¹; lights are a tenth to ten times as bright.
const MIDDLE_RADIANCE_NW_CM2_SR: f64 = 20.0;
/// Flux that stands for darkness where nothing is to be skipped, DNB watts: far below any light, and so far above nothing
/// that no product of it is subnormal, which some processors are slow at.
const DARK_FLUX_W: f32 = 1e-6;

/// Lights around an observer.
#[derive(Clone, Debug)]
pub struct LitScene {
    /// `cells` or `raster`.
    pub name: &'static str,
    /// Lit cells or pixels asked for.
    pub lit_sources: usize,
    /// What the engine takes.
    pub polar: Arc<PolarGrid>,
    /// What the direct sum takes.
    pub sources: Vec<PointSource>,
    /// Altitude of the observer's eye, metres.
    pub observer_altitude_m: f64,
    /// How long it took to sort the sources into the polar grid, milliseconds; None where it is made of cells.
    pub binning_ms: Option<f64>,
}

/// Height of the made-up hills, 100 to 900 m, at metres east and north of the observer.
fn terrain_m(east_m: f64, north_m: f64) -> f64 {
    let broad = 250.0 * (east_m / 23_000.0).sin() * (north_m / 31_000.0).cos();
    500.0 + broad + 150.0 * ((east_m + north_m) / 11_000.0).sin()
}

fn terrain_at_m(azimuth_rad: f64, distance_m: f64) -> f64 {
    terrain_m(distance_m * azimuth_rad.sin(), distance_m * azimuth_rad.cos())
}

/// Flux of a light of some area, DNB watts, with `noise` in 0..1.
fn flux_dnb_w(noise: f64, area_m2: f64) -> f64 {
    upward_flux_dnb_w(MIDDLE_RADIANCE_NW_CM2_SR * 10f64.powf(2.0 * noise - 1.0), area_m2)
}

/// The `count` members with the lowest random keys of `0..of`; fewer ones are among more ones.
fn chosen(of: usize, count: usize, seed: u64) -> Vec<usize> {
    let mut noise = Noise::new(seed);
    let mut keyed: Vec<(f64, usize)> = (0..of).map(|member| (noise.unit(), member)).collect();
    let count = count.min(of);
    if count < of {
        keyed.select_nth_unstable_by(count, |a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        keyed.truncate(count);
    }
    let mut members: Vec<usize> = keyed.into_iter().map(|(_, member)| member).collect();
    members.sort_unstable();
    members
}

/// A 15″ pixel with light, its middle at metres east and north of the observer.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LitPixel {
    /// Metres east of the observer.
    pub east_m: f64,
    /// Metres north of the observer.
    pub north_m: f64,
    /// Altitude, metres.
    pub altitude_m: f64,
    /// Upward flux, DNB watts.
    pub flux_dnb_w: f64,
}

/// Where the observer of made-up light stands.
fn observer() -> GeoPoint {
    GeoPoint::from_rad_unchecked(0.0, 0.0)
}

/// The point sources that pixels are to the observer; those within 5 km are split as everywhere in the model.
pub fn sources_of_pixels(pixels: impl IntoIterator<Item = LitPixel>) -> Vec<PointSource> {
    let frame = LocalFrame::at(observer());
    let unit = |east_m: f64, north_m: f64| {
        observer().destination(east_m.atan2(north_m), east_m.hypot(north_m)).unit_vector()
    };
    let side = 0.5 * PIXEL_SIDE_M;
    let mut sources = Vec::new();
    for LitPixel { east_m, north_m, altitude_m, flux_dnb_w } in pixels {
        let corners = [(-side, -side), (side, -side), (side, side), (-side, side)]
            .map(|(east, north)| unit(east_m + east, north_m + north));
        let pixel = SourcePixel { corners, flux_dnb_w, altitude_m };
        pixel.for_each_point_source(&frame, &mut |source| sources.push(source));
    }
    sources
}

/// The polar grid of sources that nothing hides.
pub fn grid_under_open_sky(sources: &[PointSource]) -> PolarGrid {
    PolarGrid::from_sources(observer(), sources.iter().map(|&source| (source, 0.0)))
}

/// Pixels or blocks of them of a square's side: a scene lists its lights by the squares of a quadtree, here it is one size of them.
const SQUARE: i64 = 8;

/// Lights beyond [`NO_BLOCKS_WITHIN_M`] by blocks of pixels, as wide as those of a scene; the lights of a square side by side.
fn far_ones_in_blocks(lights: &[NearLight]) -> Vec<NearLight> {
    let mut blocks = BTreeMap::new();
    let mut kept = Vec::new();
    for light in lights {
        if f64::from(light.distance_m) <= NO_BLOCKS_WITHIN_M {
            kept.push(*light);
            continue;
        }
        let distance_m = f64::from(light.distance_m);
        let (sin, cos) = f64::from(light.azimuth_rad).sin_cos();
        let pixels = std::f64::consts::SQRT_2 * FAR_BLOCK_RATIO * distance_m / PIXEL_SIDE_M;
        let side_m = 2f64.powi(pixels.max(1.0).log2() as i32) * PIXEL_SIDE_M;
        let at = |along_m: f64| (along_m / side_m).floor() as i64;
        let (east_m, north_m) = (distance_m * sin, distance_m * cos);
        let block = [at(east_m), at(north_m)];
        let square = block.map(|at| at.div_euclid(SQUARE));
        let sums: &mut [f64; 4] = blocks.entry((side_m as u32, square, block)).or_insert([0.0; 4]);
        let flux_dnb_w = f64::from(light.flux_dnb_w);
        for (sum, part) in sums.iter_mut().zip([1.0, east_m, north_m, f64::from(light.altitude_m)]) {
            *sum += flux_dnb_w * part;
        }
    }
    kept.sort_by_key(|light| {
        let (sin, cos) = f64::from(light.azimuth_rad).sin_cos();
        [sin, cos]
            .map(|part| (f64::from(light.distance_m) * part / PIXEL_SIDE_M).floor() as i64)
            .map(|at| at.div_euclid(SQUARE))
    });
    kept.extend((0..).zip(blocks.into_values()).map(|(number, [flux_dnb_w, east, north, altitude])| {
        let (east_m, north_m) = (east / flux_dnb_w, north / flux_dnb_w);
        NearLight {
            number,
            pixel_count: 1,
            azimuth_rad: east_m.atan2(north_m).rem_euclid(std::f64::consts::TAU) as f32,
            distance_m: east_m.hypot(north_m) as f32,
            altitude_m: (altitude / flux_dnb_w) as f32,
            flux_dnb_w: flux_dnb_w as f32,
        }
    }));
    kept
}

impl LitScene {
    /// So many cells of the polar grid, spread over all its columns and rings, each with one source at its middle that
    /// is as bright as ground of the cell's area.
    pub fn of_cells(count: usize) -> Self {
        let mut noise = Noise::new(2);
        let ring_step = (ring_distance_m(1) / ring_distance_m(0)).ln();
        let brightness: Vec<f64> = (0..AZIMUTH_COUNT * RING_COUNT).map(|_| noise.unit()).collect();
        let mut cells = Vec::with_capacity(count);
        let mut sources = Vec::with_capacity(count);
        for cell in chosen(AZIMUTH_COUNT * RING_COUNT, count, 1) {
            let (column, ring) = (cell / RING_COUNT, cell % RING_COUNT);
            let (azimuth_rad, distance_m) = (azimuth_rad(column), ring_distance_m(ring));
            let width_m = std::f64::consts::TAU / AZIMUTH_COUNT as f64 * distance_m;
            let flux_dnb_w = f64::from(flux_dnb_w(brightness[cell], width_m * ring_step * distance_m) as f32);
            let altitude_m = f64::from(terrain_at_m(azimuth_rad, distance_m) as f32);
            cells.push((column, ring as u32, flux_dnb_w as f32, altitude_m as f32));
            sources.push(PointSource { azimuth_rad, distance_m, altitude_m, flux_dnb_w });
        }
        Self {
            name: "cells",
            lit_sources: sources.len(),
            polar: Arc::new(polar_grid_of(&cells)),
            sources,
            observer_altitude_m: terrain_m(0.0, 0.0) + EYE_HEIGHT_M,
            binning_ms: None,
        }
    }

    /// So many 15″ pixels of the disc of 300 km around the observer, of 1.3 million; those within 5 km are split as
    /// everywhere in the model.
    pub fn of_pixels(count: usize) -> Self {
        let half = (MAX_SOURCE_DISTANCE_M / PIXEL_SIDE_M) as i64;
        let middle_m = |index: i64| (index as f64 + 0.5) * PIXEL_SIDE_M;
        let inside: Vec<(i64, i64)> = (-half..half)
            .flat_map(|row| (-half..half).map(move |column| (column, row)))
            .filter(|&(column, row)| {
                middle_m(column).hypot(middle_m(row)) <= MAX_SOURCE_DISTANCE_M - PIXEL_SIDE_M
            })
            .collect();
        let mut noise = Noise::new(4);
        let pixels = chosen(inside.len(), count, 3);
        let lit = pixels.iter().map(|&pixel| {
            let (east_m, north_m) = (middle_m(inside[pixel].0), middle_m(inside[pixel].1));
            LitPixel {
                east_m,
                north_m,
                altitude_m: terrain_m(east_m, north_m),
                flux_dnb_w: flux_dnb_w(noise.unit(), PIXEL_SIDE_M * PIXEL_SIDE_M),
            }
        });
        let sources = sources_of_pixels(lit);
        let start = Instant::now();
        let mut polar = grid_under_open_sky(&sources);
        polar.near = far_ones_in_blocks(&polar.near);
        Self {
            name: "raster",
            lit_sources: pixels.len(),
            polar: Arc::new(polar),
            binning_ms: Some(1e3 * start.elapsed().as_secs_f64()),
            sources,
            observer_altitude_m: terrain_m(0.0, 0.0) + EYE_HEIGHT_M,
        }
    }

    /// Flux of all sources, DNB watts.
    pub fn flux_dnb_w(&self) -> f64 {
        self.sources.iter().map(|source| source.flux_dnb_w).sum()
    }

    /// The grid with nothing dark: every cell that is dark gets 1e-6 W on its ground, and so do some cells besides at
    /// altitudes that touch every node. Whatever the scene, as many cells, columns and nodes are then listed.
    pub fn without_skipping(&self, set: &TableSet) -> PolarGrid {
        let dark = |ring: usize, altitude_m: f64| PolarCell {
            ring: ring as u32,
            flux_dnb_w: DARK_FLUX_W,
            altitude_m: altitude_m as f32,
            blocking: 0,
        };
        let between_nodes_m = |ring: usize, pair: usize| {
            let axis = &set.offset_axis()[ring];
            self.observer_altitude_m + axis.offset_m((2 * pair).min(axis.count - 2) as f64 + 0.5)
        };
        let pairs = set.offset_count().div_ceil(2);
        let mut grid = PolarGrid { azimuth_start: vec![0], cells: Vec::new(), ..(*self.polar).clone() };
        for column in 0..AZIMUTH_COUNT {
            let start = &self.polar.azimuth_start;
            let mut lit =
                self.polar.cells[start[column] as usize..start[column + 1] as usize].iter().peekable();
            for ring in 0..RING_COUNT {
                match lit.next_if(|cell| cell.ring as usize == ring) {
                    Some(cell) => grid.cells.push(*cell),
                    None => {
                        grid.cells.push(dark(ring, terrain_at_m(azimuth_rad(column), ring_distance_m(ring))))
                    }
                }
                if column < pairs {
                    grid.cells.push(dark(ring, between_nodes_m(ring, column)));
                }
            }
            grid.azimuth_start.push(grid.cells.len() as u32);
        }
        grid
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use skyglow_physics::{BAND_COUNT, EmissionMix, Turbidity};
    use skyglow_render::{RenderRequest, prepare::Prepared, synthetic};
    use skyglow_tables::Scattering;

    /// A scene has the lights asked for and its grid has their flux.
    #[test]
    fn scenes_have_their_lights_and_grids_their_flux() {
        for scene in [LitScene::of_cells(1), LitScene::of_cells(300), LitScene::of_pixels(2_000)] {
            let flux_w = scene.flux_dnb_w();
            assert!((scene.polar.flux_dnb_w / flux_w - 1.0).abs() < 1e-5);
            let of_cells: f64 = scene.polar.cells.iter().map(|cell| f64::from(cell.flux_dnb_w)).sum();
            assert!((of_cells / flux_w - 1.0).abs() < 1e-5, "{} {}", scene.name, scene.lit_sources);
            let altitudes = scene.sources.iter().map(|source| source.altitude_m);
            assert!(altitudes.into_iter().all(|altitude_m| (100.0..=900.0).contains(&altitude_m)));
        }
        let cells = LitScene::of_cells(300);
        assert_eq!((cells.lit_sources, cells.polar.cells.len()), (300, 300));
        let pixels = LitScene::of_pixels(2_000);
        assert!(pixels.lit_sources == 2_000 && pixels.polar.cells.len() > 2_000);
        // Another number of lights is another scene.
        assert!((LitScene::of_cells(200).flux_dnb_w() / cells.flux_dnb_w() - 1.0).abs() > 0.01);
    }

    /// Without skipping all scenes are as much work and as bright as before.
    #[test]
    fn without_skipping_work_is_equal_not_brighter() {
        let set = TableSet::new(synthetic::table_set(&[2.0], 8)).unwrap();
        let work = |polar: PolarGrid, observer_altitude_m| {
            let request = RenderRequest {
                polar: Arc::new(polar),
                observer_altitude_m,
                turbidity: Turbidity::new(2.0).unwrap(),
                scattering: Scattering::Single,
                cloud_base_m: None,
                emission: EmissionMix::garstang(),
                flux_per_dnb_flux: [1.0; BAND_COUNT],
                basis: None,
            };
            Prepared::new(&request, &set).unwrap().work()
        };
        let scenes = [LitScene::of_cells(1), LitScene::of_cells(2_048), LitScene::of_pixels(1_000)];
        let full = work(scenes[0].without_skipping(&set), scenes[0].observer_altitude_m);
        assert_eq!(full.lit_columns, AZIMUTH_COUNT);
        assert_eq!(full.mixed_nodes, set.ring_count() * set.offset_count());
        for scene in &scenes {
            assert_eq!(work(scene.without_skipping(&set), scene.observer_altitude_m), full);
            let skipped = work((*scene.polar).clone(), scene.observer_altitude_m);
            assert!(skipped.lit_cells < full.lit_cells / 4 && skipped.mixed_nodes < full.mixed_nodes);
            let flux =
                |grid: &PolarGrid| grid.cells.iter().map(|cell| f64::from(cell.flux_dnb_w)).sum::<f64>();
            let added_w = flux(&scene.without_skipping(&set)) - flux(&scene.polar);
            assert!(added_w > 0.0 && added_w < 0.06, "{added_w}");
        }
    }
}
