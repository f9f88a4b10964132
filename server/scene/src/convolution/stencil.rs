//! What the cells around a place do to it: where they lie, and the kernel there.

use super::bands::Band;
use crate::dual_tree::for_each_point;
use crate::grid::GeographicAxes;
use crate::place_kernel::{AzimuthFactor, Compass, PlaceKernel, RingPosition};
use crate::polar_grid::RING_COUNT;
use glam::{DVec3, Vec2, Vec3};
use skyglow_physics::source_pixel::SPLIT_WITHIN_M;
use skyglow_physics::{EARTH_RADIUS_M, GeoPoint};
use std::f64::consts::PI;

/// The cells of one row around a place.
#[derive(Clone, Debug)]
pub(super) struct StencilRow {
    /// Column of the first, from the cell of the place.
    pub(super) first: i64,
    pub(super) count: usize,
}

/// Parts of a cell on a ring and the next.
#[derive(Clone, Copy, Debug)]
struct Sample {
    ring: u32,
    parts: [f32; 2],
    /// The horizontal direction in which it lies.
    towards: Vec2,
}

/// The cells that a band has around a place.
pub(super) struct Stencil {
    /// Row of the first of `rows`, from the cell of the place.
    pub(super) first_row: i64,
    pub(super) rows: Vec<StencilRow>,
    /// Samples of cell i, by rows, are `samples[start[i]..start[i + 1]]`.
    start: Vec<u32>,
    samples: Vec<Sample>,
}

impl Stencil {
    /// * `latitude_deg`: of the place.
    /// * `off`: how far the place lies east and south of the middle of its cell, parts of a cell.
    pub(super) fn new(band: &Band, axes: GeographicAxes, latitude_deg: f64, off: [f64; 2]) -> Self {
        let cell = f64::from(band.cell_pixels());
        let (step_rad, latitude_step_deg) =
            (cell * axes.longitude_step_deg.to_radians(), cell * axes.latitude_step_deg);
        let half_chord = (0.5 * band.reach_m() / EARTH_RADIUS_M).powi(2);
        let latitude = |row: f64| (latitude_deg + row * latitude_step_deg).clamp(-90.0, 90.0).to_radians();
        let point = |column: f64, row: f64| {
            GeoPoint::from_rad_unchecked(latitude(row), column * step_rad).unit_vector()
        };
        let here = point(0.0, 0.0);
        let compass = Compass::at(here);
        let away_m = |to: DVec3| (EARTH_RADIUS_M * (to - here)).as_vec3();
        let reach_rows =
            (band.reach_m() / EARTH_RADIUS_M / latitude_step_deg.to_radians().abs()).ceil() as i64 + 1;
        let mut stencil =
            Self { first_row: -reach_rows, rows: Vec::new(), start: vec![0], samples: Vec::new() };
        for row in -reach_rows..=reach_rows + 1 {
            let down = row as f64 - off[1];
            let across = (half_chord - (0.5 * (latitude(down) - latitude(0.0))).sin().powi(2))
                / (latitude(0.0).cos() * latitude(down).cos()).max(1e-12);
            if across < 0.0 {
                stencil.rows.push(StencilRow { first: 0, count: 0 });
                continue;
            }
            let reach = (2.0 * across.min(1.0).sqrt().asin()).min(PI) / step_rad;
            let (first, last) = ((off[0] - reach).floor() as i64, (off[0] + reach).ceil() as i64);
            for column in first..=last {
                let along = column as f64 - off[0];
                let middle_m = away_m(point(along, down));
                let share = band.share(f64::from(middle_m.length())) as f32;
                let mut take = |away_m: Vec3, part: f32| {
                    let ring = RingPosition::of_square(away_m.length_squared());
                    if let Some((ring, out)) = ring.map(RingPosition::parts) {
                        let parts = [share * part * (1.0 - out), share * part * out];
                        let towards = compass.towards(away_m);
                        stencil.samples.push(Sample { ring: ring as u32, parts, towards });
                    }
                };
                // As the dual tree has it: pixels beyond 5 km are points.
                const POINTS_BEYOND_M2: f32 = (SPLIT_WITHIN_M * SPLIT_WITHIN_M) as f32;
                let is_point = band.level > 0 || middle_m.length_squared() >= POINTS_BEYOND_M2;
                if share > 0.0 && is_point {
                    take(middle_m, 1.0);
                } else if share > 0.0 {
                    let half_m = |to: DVec3, from: DVec3| (0.5 * EARTH_RADIUS_M * (to - from)).as_vec3();
                    let halves_m = [
                        half_m(point(along + 0.5, down), point(along - 0.5, down)),
                        half_m(point(along, down + 0.5), point(along, down - 0.5)),
                    ];
                    for_each_point(middle_m, halves_m, 1.0, &mut take);
                }
                stencil.start.push(stencil.samples.len() as u32);
            }
            stencil.rows.push(StencilRow { first, count: (last - first + 1) as usize });
        }
        stencil
    }

    /// First and last column of its cells.
    pub(super) fn columns(&self) -> [i64; 2] {
        let rows = || self.rows.iter().filter(|row| row.count > 0);
        let first = rows().map(|row| row.first).min().unwrap_or(0);
        [first, rows().map(|row| row.first + row.count as i64 - 1).max().unwrap_or(first)]
    }

    /// The kernel at its cells, row by row.
    ///
    /// * `parts`: the kernel's parts on the rings, with how they count by azimuth.
    pub(super) fn weights(&self, parts: &[(AzimuthFactor, Vec<f32>)]) -> Vec<f32> {
        let of_cell = |ends: &[u32]| {
            let samples = &self.samples[ends[0] as usize..ends[1] as usize];
            samples.iter().map(|Sample { ring, parts: [near, far], towards }| {
                let on_ring = |(factor, values): &(AzimuthFactor, Vec<f32>)| {
                    let value = near * values[*ring as usize] + far * values[*ring as usize + 1];
                    factor.towards(*towards) * value
                };
                parts.iter().map(on_ring).sum::<f32>()
            })
        };
        self.start.windows(2).map(|ends| of_cell(ends).sum()).collect()
    }
}

/// The parts of a kernel on the rings for a place and a light at two altitudes, metres, under an open sky.
pub(super) fn on_rings(kernel: &PlaceKernel, place_m: f64, light_m: f64) -> Vec<(AzimuthFactor, Vec<f32>)> {
    let (below, up) = kernel.altitudes().position(place_m as f32);
    let at = |part: usize, ring: usize| {
        let at = |node| kernel.on_ring(part, node, ring, (light_m - place_m) as f32);
        let (low, high) = (at(below), at(below + 1));
        low + up * (high - low)
    };
    let of_part = |part: usize| (0..RING_COUNT).map(|ring| at(part, ring)).collect();
    kernel.factors().enumerate().map(|(part, factor)| (factor, of_part(part))).collect()
}
