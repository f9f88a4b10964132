//! A great circle over terrain: where it runs in the columns and rows of each raster, and the ground below it.

use super::elevation::Terrain;
use super::raster::TerrainRaster;
use super::sampler::Sampler;
use glam::DVec3;
use skyglow_physics::geometry::LocalFrame;
use skyglow_physics::{EARTH_RADIUS_M, GeoPoint};

/// Distances from one place at which ground is looked at along every azimuth.
pub(super) struct Distances {
    /// Arc distances, metres, ascending.
    pub(super) metres: Vec<f64>,
    /// sin and cos of their arcs.
    arcs: Vec<(f64, f64)>,
}

impl Distances {
    pub(super) fn new(metres: Vec<f64>) -> Self {
        let arcs = metres.iter().map(|distance_m| (distance_m / EARTH_RADIUS_M).sin_cos()).collect();
        Self { metres, arcs }
    }

    /// [`skyglow_physics::horizon::terrain_elevation_tangent`] at a distance.
    pub(super) fn tangent(&self, at: usize, eye_altitude_m: f64, altitude_m: f64) -> f64 {
        let (sin, cos) = self.arcs[at];
        let radius_m = EARTH_RADIUS_M + altitude_m;
        (radius_m * cos - (EARTH_RADIUS_M + eye_altitude_m)) / (radius_m * sin)
    }
}

/// A point on the path.
#[derive(Clone, Copy, Debug)]
pub(super) struct PathPoint {
    /// Metres above sea level; None where there is no terrain.
    pub(super) elevation_m: Option<f64>,
    /// The raster that says so, and where in its columns and rows.
    raster: usize,
    position: (f64, f64),
    /// Columns and rows for each metre along the path.
    along: (f64, f64),
}

/// A great circle from a place.
pub(super) struct Path<'a> {
    distances: &'a Distances,
    up: DVec3,
    forward: DVec3,
    /// Across it, to the right.
    right: DVec3,
    terrain: &'a Terrain,
    rasters: Vec<OverRaster<'a>>,
}

/// A stretch of the path over one raster counts as straight in its columns and rows.
struct OverRaster<'a> {
    raster: &'a TerrainRaster,
    levels: Vec<Option<Sampler<'a>>>,
    /// Where a stretch begins and ends; None where a projection has no such place.
    ends: [Option<(f64, f64)>; 2],
    /// Which distances those are.
    at: [usize; 2],
}

impl<'a> Path<'a> {
    pub(super) fn new(
        terrain: &'a Terrain,
        distances: &'a Distances,
        frame: &LocalFrame,
        azimuth_rad: f64,
    ) -> Self {
        let rasters = terrain.rasters.iter().map(|raster| OverRaster {
            raster,
            levels: Vec::new(),
            ends: [None; 2],
            at: [usize::MAX; 2],
        });
        Self {
            distances,
            up: frame.up,
            forward: frame.forward(azimuth_rad),
            right: frame.forward(azimuth_rad + std::f64::consts::FRAC_PI_2),
            terrain,
            rasters: rasters.collect(),
        }
    }

    fn vector(&self, at: usize) -> DVec3 {
        let (sin, cos) = self.distances.arcs[at];
        self.up * cos + self.forward * sin
    }

    /// Goes on to a stretch between two of the distances, and says how high its ground is at most, metres; −∞ where there is none.
    pub(super) fn enter(&mut self, from: usize, to: usize) -> f64 {
        let (begin, end) = (self.vector(from), self.vector(to));
        self.rasters
            .iter_mut()
            .map(|over| over.enter((from, begin), (to, end)))
            .fold(f64::NEG_INFINITY, f64::max)
    }

    /// The ground at a distance within the stretch.
    pub(super) fn point(&mut self, at: usize) -> PathPoint {
        let distances = self.distances;
        let mut point = PathPoint { elevation_m: None, raster: 0, position: (0.0, 0.0), along: (0.0, 0.0) };
        for (number, over) in self.rasters.iter_mut().enumerate() {
            let ([Some(begin), Some(end)], [from, to]) = (over.ends, over.at) else { continue };
            let length_m = distances.metres[to] - distances.metres[from];
            let along = ((end.0 - begin.0) / length_m, (end.1 - begin.1) / length_m);
            let part_m = distances.metres[at] - distances.metres[from];
            let position = (begin.0 + part_m * along.0, begin.1 + part_m * along.1);
            if let elevation_m @ Some(_) = over.level(0).bilinear_m(position) {
                point = PathPoint { elevation_m, raster: number, position, along };
                break;
            }
        }
        point
    }

    /// How much the ground rises along the path and to its right at a point, metres for each metre: by differences over two samples
    /// each way, or `width_m` where that is more; beyond the raster in those that lie there. Level beside voids.
    pub(super) fn rise(&mut self, at: usize, point: &PathPoint, width_m: f64) -> (f64, f64) {
        let vector = self.vector(at);
        let (right, terrain) = (self.right, self.terrain);
        let (sin, cos) = self.distances.arcs[at];
        let ahead = self.forward * cos - self.up * sin;
        let Some(over) = self.rasters.get_mut(point.raster).filter(|_| point.elevation_m.is_some()) else {
            return (0.0, 0.0);
        };
        let sample_m = over.raster.sample_size_m();
        let step_m = sample_m.max(0.5 * width_m);
        let beside = (vector + right * (step_m / EARTH_RADIUS_M)).normalize();
        let Some(beside) = over.raster.grid().position_near(beside, point.position) else {
            return (0.0, 0.0);
        };
        let (column, row) = point.position;
        let across = (beside.0 - column, beside.1 - row);
        let along = (point.along.0 * step_m, point.along.1 * step_m);
        let sampler = over.level((step_m / sample_m).log2().floor() as usize);
        let mut rise = |(columns, rows): (f64, f64), direction: DVec3| {
            let mut at = |sign: f64| {
                // Beyond the raster another may lie.
                let beyond = || (vector + direction * (sign * step_m / EARTH_RADIUS_M)).normalize();
                let here_m = sampler.bilinear_m((column + sign * columns, row + sign * rows));
                here_m.or_else(|| terrain.overview_m(GeoPoint::from_vector(beyond()), step_m))
            };
            let (ahead_m, behind_m) = (at(1.0), at(-1.0));
            ahead_m.zip(behind_m).map_or(0.0, |(ahead_m, behind_m)| (ahead_m - behind_m) / (2.0 * step_m))
        };
        (rise(along, ahead), rise(across, right))
    }
}

impl<'a> OverRaster<'a> {
    fn level(&mut self, level: usize) -> &mut Sampler<'a> {
        let raster = self.raster;
        if self.levels.len() <= level {
            self.levels.resize_with(level + 1, || None);
        }
        self.levels[level].get_or_insert_with(|| Sampler::new(raster, level))
    }

    fn enter(&mut self, (from, begin): (usize, DVec3), (to, end): (usize, DVec3)) -> f64 {
        let grid = self.raster.grid();
        let (width, height) = (f64::from(grid.width), f64::from(grid.height));
        let near = self.ends[1].unwrap_or((0.5 * width, 0.5 * height));
        let begin = if self.at[1] == from { self.ends[1] } else { grid.position_near(begin, near) };
        self.ends = [begin, grid.position_near(end, begin.unwrap_or(near))];
        self.at = [from, to];
        let [Some((c0, r0)), Some((c1, r1))] = self.ends else { return f64::NEG_INFINITY };
        if grid.turn_columns().is_some() {
            return self.raster.maxima().highest_m();
        }
        // A cell lies between sample centres, half a sample beside columns and rows.
        let cells = |a: f64, b: f64, end: f64| {
            let (low, high) = (a.min(b), a.max(b));
            let is_inside = high >= 0.0 && low < end;
            let cell = |at: f64| (at.clamp(0.0, end) + 0.5) as usize;
            is_inside.then(|| cell(low)..=cell(high))
        };
        match (cells(c0, c1, width), cells(r0, r1, height)) {
            (Some(columns), Some(rows)) => self.raster.maxima().max_over_m(columns, rows),
            _ => f64::NEG_INFINITY,
        }
    }
}
