//! Areas to edit, polygons or brush strokes, and the pixels in them, found by quadtree descent.

use crate::boundary::{Boundary, BoundaryError, Position};
use crate::grid::Grid;
use crate::light_tree::LightTree;
use glam::DVec3;
use serde::{Deserialize, Serialize};
use skyglow_physics::{EARTH_RADIUS_M, GeoPoint};
use thiserror::Error;

/// Most points of a stroke.
pub const MAX_BRUSH_POINTS: usize = 1000;
/// Radius of a brush, metres.
const BRUSH_RADIUS_M: std::ops::RangeInclusive<f64> = 1.0..=50_000.0;
/// Longest way from a point of a stroke to the next, metres.
const MAX_STEP_M: f64 = 500_000.0;
/// Blocks of pixels of this side and smaller are searched pixel by pixel.
const SMALL_BLOCK: u32 = 8;

/// An area on the ground.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Area {
    /// Polygons of closed rings in longitude and latitude, the outer ring first.
    Polygons(Vec<Vec<Vec<Position>>>),
    /// All that is within a radius of a line.
    Brush {
        /// Longitude and latitude of its points; one is a dot.
        points: Vec<Position>,
        /// Metres.
        radius_m: f64,
    },
}

/// Why nothing can be painted there.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum AreaError {
    /// Polygons that bound no area.
    #[error(transparent)]
    Boundary(#[from] BoundaryError),
    /// A stroke without points.
    #[error("a stroke needs a point at least")]
    NoPoint,
    /// A stroke of too many points.
    #[error("a stroke has {count} points, at most {MAX_BRUSH_POINTS} are taken")]
    TooManyPoints {
        /// Points given.
        count: usize,
    },
    /// A point that is no place.
    #[error("longitude {}, latitude {} is no place", position[0], position[1])]
    NoPlace {
        /// The point.
        position: Position,
    },
    /// A brush too thin or too wide.
    #[error("the brush's radius is {radius_m} m; allowed is {} to {} m", BRUSH_RADIUS_M.start(), BRUSH_RADIUS_M.end())]
    Radius {
        /// Metres.
        radius_m: f64,
    },
    /// Points too far apart.
    #[error("a stroke goes {distance_m:.0} m from a point to the next, at most {MAX_STEP_M} m are taken")]
    LongStep {
        /// Metres.
        distance_m: f64,
    },
}

/// Point-in-area tests that may still be made.
#[derive(Debug)]
pub(super) struct Budget(u64);

/// Sides of a polygon that are compared in the time of one test.
const SIDES_PER_TEST: usize = 16;

impl Budget {
    pub(super) fn new(tests: u64) -> Self {
        Self(tests)
    }

    /// Takes some; false where so many are not left.
    fn take(&mut self, tests: u64) -> bool {
        let is_left = self.0 >= tests;
        self.0 = self.0.saturating_sub(tests);
        is_left
    }

    /// Whether nothing is left.
    pub(super) fn is_spent(&self) -> bool {
        self.0 == 0
    }
}

/// A part of an area that is searched by itself: a place is in the area if it is in any of them.
pub(super) struct AreaPart {
    /// A circle around it: centre as a unit vector, radius along the chord, metres.
    center: DVec3,
    reach_m: f64,
    /// Cost of a point-in-area test.
    tests: u64,
    shape: Shape,
}

enum Shape {
    Polygons(Boundary),
    /// Ends of a step of a brush as unit vectors, and the brush's radius, metres.
    Step {
        ends: [DVec3; 2],
        radius_m: f64,
    },
}

impl Area {
    /// Its parts.
    pub(super) fn parts(&self) -> Result<Vec<AreaPart>, AreaError> {
        match self {
            Area::Polygons(polygons) => Ok(vec![AreaPart::of_polygons(Boundary::new(polygons)?)]),
            Area::Brush { points, radius_m } => {
                let ends = brush_ends(points, *radius_m)?;
                let step = |ends: &[DVec3]| AreaPart::of_step([ends[0], ends[ends.len() - 1]], *radius_m);
                if ends.len() == 1 { Ok(vec![step(&ends)]) } else { Ok(ends.windows(2).map(step).collect()) }
            }
        }
    }

    /// Whether it bounds an area at all.
    ///
    /// # Errors
    /// [`AreaError`].
    pub fn check(&self) -> Result<(), AreaError> {
        self.parts().map(|_| ())
    }
}

fn brush_ends(points: &[Position], radius_m: f64) -> Result<Vec<DVec3>, AreaError> {
    if points.is_empty() {
        return Err(AreaError::NoPoint);
    }
    if points.len() > MAX_BRUSH_POINTS {
        return Err(AreaError::TooManyPoints { count: points.len() });
    }
    if !BRUSH_RADIUS_M.contains(&radius_m) {
        return Err(AreaError::Radius { radius_m });
    }
    let end = |&position: &Position| {
        let [longitude_deg, latitude_deg] = position;
        let place = GeoPoint::from_deg(latitude_deg, longitude_deg);
        place.map(GeoPoint::unit_vector).map_err(|_| AreaError::NoPlace { position })
    };
    let ends: Vec<DVec3> = points.iter().map(end).collect::<Result<_, _>>()?;
    let steps = ends.windows(2).map(|ends| EARTH_RADIUS_M * ends[0].distance(ends[1]));
    match steps.into_iter().find(|&distance_m| distance_m > MAX_STEP_M) {
        Some(distance_m) => Err(AreaError::LongStep { distance_m }),
        None => Ok(ends),
    }
}

impl AreaPart {
    fn of_polygons(boundary: Boundary) -> Self {
        let (center, reach_m) = boundary.circle();
        let tests = 1 + (boundary.sides_per_band() / SIDES_PER_TEST) as u64;
        Self { center, reach_m, tests, shape: Shape::Polygons(boundary) }
    }

    fn of_step(ends: [DVec3; 2], radius_m: f64) -> Self {
        // The chord from the middle to the tip is longer than both chords together, by less than a hundredth.
        let reach_m = 1.01 * (0.5 * EARTH_RADIUS_M * ends[0].distance(ends[1]) + radius_m) + 1.0;
        let center = (ends[0] + ends[1]).normalize();
        Self { center, reach_m, tests: 1, shape: Shape::Step { ends, radius_m } }
    }

    /// Whether the part has any pixel of a raster.
    pub(super) fn meets(&self, grid: &Grid, budget: &mut Budget) -> bool {
        let mut meets = false;
        self.for_each_pixel(grid, budget, |_, _| {
            meets = true;
            false
        });
        meets
    }

    /// Whether a place is in it; false where the budget is spent.
    pub(super) fn has(&self, place: DVec3, budget: &mut Budget) -> bool {
        budget.take(self.tests) && self.holds(place)
    }

    fn holds(&self, place: DVec3) -> bool {
        match &self.shape {
            Shape::Polygons(boundary) => boundary.contains(GeoPoint::from_vector(place)),
            Shape::Step { ends, radius_m } => distance_to_step_m(place, *ends) <= *radius_m,
        }
    }

    /// Calls `take` with the index of each light in it, as far as the budget goes. Pixels right under a brush are excluded.
    pub(super) fn for_each_light(
        &self,
        light: &LightTree<'_>,
        budget: &mut Budget,
        mut take: impl FnMut(usize),
    ) {
        let radius_m = 2.0 * EARTH_RADIUS_M * (0.5 * self.reach_m / EARTH_RADIUS_M).min(1.0).asin();
        light.for_each_near(self.center, radius_m, |index, center| {
            if self.has(center, budget) {
                take(index);
            }
        });
    }

    /// Calls `take` with column and row of each pixel in it, lit or dark, as far as the budget goes and until it returns false.
    /// Pixels right under a brush are excluded unless their centre is in it.
    pub(super) fn for_each_pixel(
        &self,
        grid: &Grid,
        budget: &mut Budget,
        mut take: impl FnMut(u32, u32) -> bool,
    ) {
        let side = grid.width.max(grid.height).next_power_of_two();
        let mut stack = vec![(0u32, 0u32, side)];
        while let Some((column, row, side)) = stack.pop() {
            if column >= grid.width || row >= grid.height || !budget.take(1) {
                continue;
            }
            let (last_column, last_row) =
                ((column + (side - 1)).min(grid.width - 1), (row + (side - 1)).min(grid.height - 1));
            if !self.may_meet(grid, [column, last_column], [row, last_row]) {
                continue;
            }
            if side > SMALL_BLOCK {
                let half = side / 2;
                stack.extend(
                    [(0, 0), (half, 0), (0, half), (half, half)]
                        .map(|(right, down)| (column + right, row + down, half)),
                );
                continue;
            }
            for row in row..=last_row {
                for column in column..=last_column {
                    let center = grid.center(column, row);
                    if center.is_finite() && self.has(center, budget) && !take(column, row) {
                        return;
                    }
                }
            }
        }
    }

    /// Whether a block of pixels may have some in the part: by circles around both.
    fn may_meet(&self, grid: &Grid, columns: [u32; 2], rows: [u32; 2]) -> bool {
        let middle = |[first, last]: [u32; 2]| first + (last - first) / 2;
        let across = [columns[0], middle(columns), columns[1]];
        let down = [rows[0], middle(rows), rows[1]];
        let points: Vec<DVec3> = across
            .iter()
            .flat_map(|&column| down.iter().map(move |&row| (column, row)))
            .flat_map(|(column, row)| grid.corners(column, row))
            .collect();
        let center = points.iter().sum::<DVec3>().normalize_or_zero();
        let radius = points.iter().map(|point| center.distance(*point)).fold(0.0, f64::max);
        // What lies between the points bulges by less than a tenth in small blocks; large ones are opened.
        let is_small = points.iter().all(|point| point.is_finite()) && radius < 0.25;
        !is_small || EARTH_RADIUS_M * (self.center.distance(center) - 1.1 * radius) <= self.reach_m
    }

    /// Calls `take` with column and row of the pixels right under a brush, however fine it is, as far as the budget goes; some
    /// may come twice.
    pub(super) fn for_each_pixel_under_brush(
        &self,
        grid: &Grid,
        budget: &mut Budget,
        mut take: impl FnMut(u32, u32),
    ) {
        let Shape::Step { ends, .. } = &self.shape else { return };
        let length_m = EARTH_RADIUS_M * ends[0].distance(ends[1]);
        let count = (2.0 * length_m / grid.pixel_size_m().max(0.1)).ceil() as u64;
        for step in 0..=count {
            if !budget.take(1) {
                return;
            }
            let along = step as f64 / count.max(1) as f64;
            let place = GeoPoint::from_vector(ends[0].lerp(ends[1], along));
            if let Some((column, row)) = grid.pixel_at(place) {
                take(column, row);
            }
        }
    }
}

/// Distance along the ground from a place to the great circle between two, metres.
fn distance_to_step_m(place: DVec3, [a, b]: [DVec3; 2]) -> f64 {
    let arc_m = |from: DVec3| 2.0 * EARTH_RADIUS_M * (0.5 * from.distance(place)).min(1.0).asin();
    let normal = a.cross(b).normalize_or_zero();
    let is_beside =
        normal != DVec3::ZERO && normal.cross(a).dot(place) >= 0.0 && b.cross(normal).dot(place) >= 0.0;
    if is_beside { EARTH_RADIUS_M * normal.dot(place).abs().min(1.0).asin() } else { arc_m(a).min(arc_m(b)) }
}
