//! Clouds as bodies: square columns between a base and a top, and how a ray passes through them (Amanatides and Woo 1987).
//!
//! A cell is cloud or gap. Which it is comes from independent draws, from the noise of the program's own patterns, or it is always the
//! same. Every path sees cells that were turned and shifted anew, so means over paths are means over patterns.

use super::draws::Random;
use crate::{
    broken_clouds::Layer,
    error::{PhysicsError, check_range},
    geometry::EARTH_RADIUS_M,
};
use glam::{DVec2, DVec3};
use rayon::prelude::*;
use std::{f64::consts::TAU, sync::Arc};

/// Cells of a stored pattern each way, and how many patterns are drawn from.
const PATTERN_CELLS: usize = 512;
const PATTERNS: u32 = 24;
/// Shifts are drawn within this, metres.
const MAX_SHIFT_M: f64 = 1e6;

/// What a layer of clouds is made of.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum CloudMatter {
    /// Drops: light is scattered, none is absorbed.
    Drops {
        /// From base to top, metres.
        thickness_m: f64,
        /// Of a cloud from its base to its top.
        optical_depth: f64,
    },
    /// A flat lid that lets nothing through, Lambertian on both sides.
    Lid {
        /// Of both sides.
        albedo: f64,
    },
}

/// Where there are clouds in a layer.
#[derive(Clone, Debug)]
enum Cells {
    Independent { cover: f64 },
    Patterns(Arc<Vec<Vec<bool>>>),
    Closed,
}

/// A layer of clouds with gaps.
#[derive(Clone, Debug)]
pub struct CloudField {
    base_m: f64,
    matter: CloudMatter,
    cell_m: f64,
    cells: Cells,
}

impl CloudField {
    /// A layer without gaps, its base at an altitude [m].
    ///
    /// # Errors
    /// [`PhysicsError::OutOfRange`] naming what is no cloud's.
    pub fn closed(base_m: f64, matter: CloudMatter) -> Result<Self, PhysicsError> {
        check_range("cloud_base", base_m, 0.0, 20_000.0, "m")?;
        match matter {
            CloudMatter::Drops { thickness_m, optical_depth } => {
                check_range("thickness", thickness_m, 1e-3, 20_000.0, "m")?;
                check_range("optical_depth", optical_depth, 0.0, 1e4, "")?;
            }
            CloudMatter::Lid { albedo } => {
                check_range("cloud_albedo", albedo, 0.0, 1.0, "")?;
            }
        }
        Ok(Self { base_m, matter, cell_m: 1_000.0, cells: Cells::Closed })
    }

    /// The same with square clouds of this size [m], each there with the chance `cover`.
    ///
    /// # Errors
    /// [`PhysicsError::OutOfRange`] naming `cloud_cover` or `cell`.
    pub fn of_cells(self, cover: f64, cell_m: f64) -> Result<Self, PhysicsError> {
        check_range("cloud_cover", cover, 0.0, 1.0, "")?;
        check_range("cell", cell_m, 1.0, 100_000.0, "m")?;
        Ok(Self { cell_m, cells: Cells::Independent { cover }, ..self })
    }

    /// The same with the clouds of the program's own patterns, in cells of this size [m].
    ///
    /// # Errors
    /// As [`Self::of_cells`].
    pub fn of_patterns(self, cover: f64, cell_m: f64) -> Result<Self, PhysicsError> {
        let of_cells = self.of_cells(cover, cell_m)?;
        let drawn = |pattern: u32| {
            let layer = Layer::new(cover, u64::from(pattern), 1.0);
            let noise = |at: usize| {
                let [row, column] = [at / PATTERN_CELLS, at % PATTERN_CELLS].map(|cell| cell as f64 * cell_m);
                layer.noise(column, row)
            };
            let values: Vec<f64> = (0..PATTERN_CELLS * PATTERN_CELLS).map(noise).collect();
            // Every pattern covers exactly what it is to.
            let mut sorted = values.clone();
            sorted.sort_unstable_by(f64::total_cmp);
            let gaps = ((1.0 - cover) * sorted.len() as f64).round() as usize;
            let threshold = sorted.get(gaps).copied().unwrap_or(f64::INFINITY);
            values.iter().map(|value| *value >= threshold).collect()
        };
        let patterns: Vec<Vec<bool>> = (0..PATTERNS).into_par_iter().map(drawn).collect();
        Ok(Self { cells: Cells::Patterns(Arc::new(patterns)), ..of_cells })
    }

    /// Share of rays at an elevation that meet no cloud between base and top, mean over patterns, from `rays` rays of an eye at sea level.
    pub fn gap_share(&self, elevation_rad: f64, rays: u64, seed: u64) -> f64 {
        let direction = DVec3::new(elevation_rad.cos(), 0.0, elevation_rad.sin());
        let spheres_m = (EARTH_RADIUS_M + self.base_m, EARTH_RADIUS_M + self.top_m());
        let passage = between_spheres(EARTH_RADIUS_M, direction.z, spheres_m, f64::INFINITY);
        let mut random = Random::new(seed, 0);
        let passes = |_: &u64| {
            let clouds = self.drawn(&mut random);
            let start = DVec3::Z * EARTH_RADIUS_M;
            passage.into_iter().flatten().all(|part| clouds.follow(start, direction, part, 1e-9).is_err())
        };
        (0..rays).filter(passes).count() as f64 / rays as f64
    }

    /// Altitude of the base, metres.
    pub(super) fn base_m(&self) -> f64 {
        self.base_m
    }

    /// Altitude of the top, metres; that of the base for a lid.
    pub(super) fn top_m(&self) -> f64 {
        match self.matter {
            CloudMatter::Drops { thickness_m, .. } => self.base_m + thickness_m,
            CloudMatter::Lid { .. } => self.base_m,
        }
    }

    /// Albedo, if it is a lid.
    pub(super) fn lid_albedo(&self) -> Option<f64> {
        match self.matter {
            CloudMatter::Drops { .. } => None,
            CloudMatter::Lid { albedo } => Some(albedo),
        }
    }

    /// Optical depth of a metre within a cloud.
    pub(super) fn extinction_per_m(&self) -> f64 {
        match self.matter {
            CloudMatter::Drops { thickness_m, optical_depth } => optical_depth / thickness_m,
            CloudMatter::Lid { .. } => 0.0,
        }
    }

    /// One pattern of it, turned and shifted.
    pub(super) fn drawn(&self, random: &mut Random) -> Clouds<'_> {
        let (sine, cosine) = (TAU * random.unit()).sin_cos();
        let shift = DVec2::new(random.unit(), random.unit()) * (MAX_SHIFT_M / self.cell_m);
        let number = (random.unit() * f64::from(1u32 << 31)) as u64;
        Clouds { field: self, turn: DVec2::new(cosine, sine), shift, number }
    }
}

/// One pattern of a [`CloudField`].
pub(super) struct Clouds<'a> {
    field: &'a CloudField,
    turn: DVec2,
    shift: DVec2,
    number: u64,
}

impl Clouds<'_> {
    pub(super) fn field(&self) -> &CloudField {
        self.field
    }

    /// Where a point lies over the cells.
    fn over_cells(&self, position: DVec3) -> DVec2 {
        let level = DVec2::new(position.x, position.y) * (EARTH_RADIUS_M / position.length());
        self.turn.rotate(level) / self.field.cell_m + self.shift
    }

    /// Whether a cell is cloud.
    fn is_cloud(&self, cell: [i64; 2]) -> bool {
        match &self.field.cells {
            Cells::Closed => true,
            Cells::Independent { cover } => even(cell, self.number) < *cover,
            Cells::Patterns(patterns) => {
                let size = PATTERN_CELLS as i64;
                let [column, row] = cell.map(|at| at.rem_euclid(size) as usize);
                patterns[self.number as usize % patterns.len()][row * PATTERN_CELLS + column]
            }
        }
    }

    /// Whether there is a cloud over or under a point.
    pub(super) fn covers(&self, position: DVec3) -> bool {
        let at = self.over_cells(position);
        self.is_cloud([at.x.floor() as i64, at.y.floor() as i64])
    }

    /// Follows a ray within the layer from one path [m] to another: the path at which its optical depth through clouds reaches
    /// `wanted`, or else that depth.
    pub(super) fn follow(
        &self,
        start: DVec3,
        direction: DVec3,
        (from_m, to_m): (f64, f64),
        wanted: f64,
    ) -> Result<f64, f64> {
        let per_m = self.field.extinction_per_m();
        let from = self.over_cells(start + direction * from_m);
        let way = self.over_cells(start + direction * to_m) - from;
        let length_m = to_m - from_m;
        let mut cell = [from.x.floor() as i64, from.y.floor() as i64];
        let (step, mut next, each) = {
            let axis = |from: f64, way: f64| {
                let each = if way == 0.0 { f64::INFINITY } else { 1.0 / way.abs() };
                let ahead = if way > 0.0 { 1.0 - from.rem_euclid(1.0) } else { from.rem_euclid(1.0) };
                (way.signum() as i64, if way == 0.0 { f64::INFINITY } else { ahead * each }, each)
            };
            let ((a, b, c), (d, e, f)) = (axis(from.x, way.x), axis(from.y, way.y));
            ([a, d], [b, e], [c, f])
        };
        let (mut at, mut depth) = (0.0, 0.0);
        while at < 1.0 {
            let along = usize::from(next[1] < next[0]);
            let end = next[along].min(1.0);
            if self.is_cloud(cell) {
                let more = per_m * length_m * (end - at).max(0.0);
                if depth + more >= wanted {
                    return Ok(from_m + at * length_m + (wanted - depth) / per_m);
                }
                depth += more;
            }
            at = end;
            cell[along] += step[along];
            next[along] += each[along];
        }
        Err(depth)
    }
}

/// A number in 0..1 for a cell (SplitMix64's finalizer).
fn even(cell: [i64; 2], number: u64) -> f64 {
    let mut z = (cell[0] as u64)
        .wrapping_mul(0x9e37_79b9_7f4a_7c15)
        .wrapping_add((cell[1] as u64).wrapping_mul(0xd1b5_4a32_d192_ed03))
        .wrapping_add(number.wrapping_mul(0x8cb9_2ba7_2f3d_8dd7));
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    ((z ^ (z >> 31)) >> 11) as f64 / (1u64 << 53) as f64
}

/// The parts of a straight ray [m] that lie between two spheres, from a start at a radius [m] with a cosine of the zenith angle, up to a
/// path [m]: two at most.
pub(super) fn between_spheres(
    start_radius_m: f64,
    cos_zenith: f64,
    (inner_m, outer_m): (f64, f64),
    end_m: f64,
) -> [Option<(f64, f64)>; 2] {
    let Some((in_m, out_m)) = sphere_m(start_radius_m, cos_zenith, outer_m) else { return [None; 2] };
    let within = |from_m: f64, to_m: f64| {
        let (from_m, to_m) = (from_m.max(0.0), to_m.min(end_m));
        (from_m < to_m).then_some((from_m, to_m))
    };
    match sphere_m(start_radius_m, cos_zenith, inner_m) {
        None => [within(in_m, out_m), None],
        Some((down_m, up_m)) => [within(in_m, down_m), within(up_m, out_m)],
    }
}

/// Where a ray enters and leaves a sphere, metres along it from its start, negative behind it.
pub(super) fn sphere_m(start_radius_m: f64, cos_zenith: f64, radius_m: f64) -> Option<(f64, f64)> {
    let b = start_radius_m * cos_zenith;
    let c = (start_radius_m - radius_m) * (start_radius_m + radius_m);
    let root = (b * b - c).max(-1.0);
    if root < 0.0 {
        return None;
    }
    let far = if b > 0.0 { -b - root.sqrt() } else { -b + root.sqrt() };
    let near = if far == 0.0 { 0.0 } else { c / far };
    Some((far.min(near), far.max(near)))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn drops(thickness_m: f64, optical_depth: f64) -> CloudMatter {
        CloudMatter::Drops { thickness_m, optical_depth }
    }

    /// Rays pass through a layer where quadrature finds them in it.
    #[test]
    fn layers_are_passed_where_they_are() {
        let (low_m, high_m) = (EARTH_RADIUS_M + 1_500.0, EARTH_RADIUS_M + 2_000.0);
        for altitude_m in [0.0, 1_400.0, 1_500.0, 1_700.0, 2_000.0, 5_000.0] {
            for cosine in [-1.0, -0.3, -0.03, -0.015, -0.001, 0.0, 0.01, 0.5, 1.0] {
                let (start_m, end_m) = (EARTH_RADIUS_M + altitude_m, 250_000.0);
                let parts = between_spheres(start_m, cosine, (low_m, high_m), end_m);
                let length_m: f64 = parts.into_iter().flatten().map(|(from_m, to_m)| to_m - from_m).sum();
                let steps = 250_000;
                let step_m = end_m / f64::from(steps);
                let is_within = |step: &i32| {
                    let u = (f64::from(*step) + 0.5) * step_m;
                    let radius = (start_m * start_m + 2.0 * start_m * cosine * u + u * u).sqrt();
                    (low_m..high_m).contains(&radius)
                };
                let expected_m = (0..steps).filter(is_within).count() as f64 * step_m;
                assert!(
                    (length_m - expected_m).abs() < 3.0,
                    "{altitude_m} {cosine}: {length_m} {expected_m}"
                );
            }
        }
    }

    /// Cells and patterns cover what they are to, and a ray's depth is its length in clouds.
    #[test]
    fn cells_have_their_cover() {
        for cover in [0.25, 0.75] {
            let closed = CloudField::closed(1_500.0, drops(400.0, 12.0)).unwrap();
            let fields = [
                closed.clone().of_cells(cover, 500.0).unwrap(),
                closed.clone().of_patterns(cover, 100.0).unwrap(),
            ];
            for field in fields {
                let mut random = Random::new(3, 1);
                let (draws, mut covered, mut depth) = (20_000, 0.0, 0.0);
                let start = DVec3::Z * (EARTH_RADIUS_M + 1_500.0);
                for _ in 0..draws {
                    let clouds = field.drawn(&mut random);
                    covered += f64::from(clouds.covers(start)) / f64::from(draws);
                    let slant = DVec3::new(0.6, 0.0, 0.8);
                    depth += clouds.follow(start, slant, (0.0, 500.0), 1e9).unwrap_err() / f64::from(draws);
                }
                assert!((covered - cover).abs() < 0.02, "{cover}: {covered}");
                assert!((depth / (0.03 * 500.0 * cover) - 1.0).abs() < 0.04, "{cover}: {depth}");
            }
        }
    }

    /// A ray stops where its depth is reached.
    #[test]
    fn rays_stop_at_their_depth() {
        let field = CloudField::closed(1_500.0, drops(400.0, 12.0)).unwrap();
        let mut random = Random::new(3, 1);
        let clouds = field.drawn(&mut random);
        let start = DVec3::Z * EARTH_RADIUS_M;
        let at_m = clouds.follow(start, DVec3::Z, (1_500.0, 1_900.0), 3.0).unwrap();
        assert!((at_m - 1_600.0).abs() < 1e-6, "{at_m}");
    }

    #[test]
    fn what_no_field_is_is_refused() {
        assert!(CloudField::closed(-1.0, drops(100.0, 1.0)).is_err());
        assert!(CloudField::closed(1_000.0, drops(0.0, 1.0)).is_err());
        assert!(CloudField::closed(1_000.0, CloudMatter::Lid { albedo: 1.1 }).is_err());
        let closed = CloudField::closed(1_000.0, drops(100.0, 1.0)).unwrap();
        assert!(closed.clone().of_cells(1.1, 100.0).is_err());
        assert!(closed.of_patterns(0.5, 0.0).is_err());
    }
}
