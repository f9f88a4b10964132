//! A part of a lattice: the places within bounds, and who stands there.

use super::place_lattice::PlaceLattice;
use crate::grid::GeographicAxes;
use crate::grid::Grid;
use rayon::prelude::*;
use skyglow_physics::GeoPoint;
use std::ops::Range;

/// Columns and rows of a lattice. Of one that goes all around the Earth the columns may go on beyond the last, from the first.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct PlaceWindow {
    /// From west to east (along the raster's rows).
    pub columns: Range<u32>,
    /// From north to south (along the raster's columns).
    pub rows: Range<u32>,
}

impl PlaceLattice {
    /// All places.
    pub fn whole(&self) -> PlaceWindow {
        PlaceWindow { columns: 0..self.columns, rows: 0..self.rows }
    }

    /// The lattice of the places of a window: they lie where they lie, bit for bit.
    pub fn part(&self, window: &PlaceWindow) -> Self {
        let [left, top] = self.first;
        let [across, down] = self.steps;
        Self {
            columns: window.columns.end - window.columns.start,
            rows: window.rows.end - window.rows.start,
            first: [left + window.columns.start * across, top + window.rows.start * down],
            ..*self
        }
    }
}

impl PlaceWindow {
    /// Whether two have places in common.
    pub fn overlaps(&self, other: &Self) -> bool {
        let meet = |a: &Range<u32>, b: &Range<u32>| a.start < b.end && b.start < a.end;
        meet(&self.columns, &other.columns) && meet(&self.rows, &other.rows)
    }

    /// How many places it has.
    pub fn count(&self) -> usize {
        self.columns.len() * self.rows.len()
    }

    /// Column and row of a place by its number among those of the window, row by row from the north.
    pub fn place(&self, number: usize) -> [u32; 2] {
        let across = self.columns.len().max(1);
        [self.columns.start + (number % across) as u32, self.rows.start + (number / across) as u32]
    }

    /// Whether it has places, all of them those of a lattice, columns that go on beyond the last not among them.
    pub fn is_within(&self, lattice: PlaceLattice) -> bool {
        let is_within = |range: &Range<u32>, count: u32| range.start < range.end && range.end <= count;
        is_within(&self.columns, lattice.columns) && is_within(&self.rows, lattice.rows)
    }

    /// Windows without columns beyond the last that have its places, from the west: one, or two.
    pub fn pieces(&self, lattice: PlaceLattice) -> Vec<Self> {
        let (Range { start, end }, last) = (self.columns.clone(), lattice.columns);
        let piece = |columns: Range<u32>| Self { columns, rows: self.rows.clone() };
        match start < last && end > last {
            true => vec![piece(start..last), piece(0..end - last)],
            false => vec![self.clone()],
        }
    }

    /// The smallest of whole blocks of `side` × `side` places of a lattice, of less at its ends, that it lies in.
    pub(crate) fn of_whole_blocks(&self, side: u32, lattice: PlaceLattice) -> Self {
        let whole = |range: &Range<u32>, count: u32| {
            range.start / side * side..range.end.div_ceil(side).saturating_mul(side).min(count)
        };
        Self { columns: whole(&self.columns, lattice.columns), rows: whole(&self.rows, lattice.rows) }
    }

    /// Values of its places, row by row, from those of a window that it lies in; the same where that is itself.
    ///
    /// # Panics
    /// Where they are not as many as the other's places, or it does not lie in that.
    pub fn cut<T: Clone>(&self, values: Vec<T>, of: &Self) -> Vec<T> {
        if self == of {
            return values;
        }
        let first = (self.columns.start - of.columns.start) as usize;
        let rows = values.chunks_exact(of.columns.len());
        let rows = rows.skip((self.rows.start - of.rows.start) as usize).take(self.rows.len());
        rows.flat_map(|row| row[first..first + self.columns.len()].iter().cloned()).collect()
    }

    /// The smallest that has all places of a lattice within bounds; None where there are none.
    ///
    /// * `bounds`: west, south, east, north, degrees; west of east beyond the antimeridian.
    pub(crate) fn within(lattice: PlaceLattice, grid: &Grid, bounds: [f64; 4]) -> Option<Self> {
        let [west, south, east, north] = bounds;
        let width = (east - west).rem_euclid(360.0);
        let width = if width == 0.0 && east > west { 360.0 } else { width };
        if let Some(axes) = grid.axes() {
            let is_around = grid.turn_columns().is_some_and(|turn| {
                let [across, _] = lattice.steps;
                (turn - f64::from(lattice.columns * across)).abs() < 1e-6
            });
            return Self::along_axes(lattice, axes, is_around, [west, width], [south, north]);
        }
        let is_inside = |column: u32, row: u32| {
            let point = lattice.point(grid, f64::from(column), f64::from(row));
            let place = GeoPoint::from_vector(point);
            point.is_finite()
                && (south..=north).contains(&place.latitude_deg())
                && (place.longitude_deg() - west).rem_euclid(360.0) <= width
        };
        let of_row = |row: u32| {
            let first = (0..lattice.columns).find(|column| is_inside(*column, row))?;
            let last = (first..lattice.columns).rev().find(|column| is_inside(*column, row))?;
            Some(Self { columns: first..last + 1, rows: row..row + 1 })
        };
        (0..lattice.rows).into_par_iter().filter_map(of_row).reduce_with(|a, b| Self {
            columns: a.columns.start.min(b.columns.start)..a.columns.end.max(b.columns.end),
            rows: a.rows.start.min(b.rows.start)..a.rows.end.max(b.rows.end),
        })
    }

    /// The same along parallels and meridians, where a place's longitude depends on its column alone and its latitude on its row.
    ///
    /// * `is_around`: whether the column after the last is the first again.
    fn along_axes(
        lattice: PlaceLattice,
        axes: GeographicAxes,
        is_around: bool,
        [west, width]: [f64; 2],
        [south, north]: [f64; 2],
    ) -> Option<Self> {
        let range = |count: u32, is_inside: &dyn Fn(f64) -> bool| {
            let first = (0..count).find(|at| is_inside(f64::from(*at)))?;
            let last = (first..count).rev().find(|at| is_inside(f64::from(*at)))?;
            Some(first..last + 1)
        };
        let is_between = |column: f64| {
            let (x, _) = lattice.position(column, 0.0);
            (axes.first_longitude_deg + axes.longitude_step_deg * x - west).rem_euclid(360.0) <= width
        };
        let mut columns = range(lattice.columns, &is_between);
        let gap = |at: f64| !is_between(at);
        if let Some(all) = columns.clone().filter(|all| is_around && *all == (0..lattice.columns))
            && let Some(gap) = range(lattice.columns, &gap)
        {
            columns = Some(gap.end..all.end + gap.start);
        }
        let rows = range(lattice.rows, &|row| {
            let (_, y) = lattice.position(0.0, row);
            (south..=north).contains(&(axes.first_latitude_deg + axes.latitude_step_deg * y))
        });
        Some(Self { columns: columns?, rows: rows? })
    }
}

/// Observers at the places of a window of a lattice.
#[derive(Clone, Debug, PartialEq)]
pub struct Observers {
    /// Of the places.
    pub lattice: PlaceLattice,
    /// Where the observers are.
    pub window: PlaceWindow,
    /// Of each of them, metres above sea level, row by row from the north; NaN where none can be.
    pub altitudes_m: Vec<f32>,
}

impl Observers {
    /// At all places of a lattice.
    pub fn everywhere(lattice: PlaceLattice, altitudes_m: Vec<f32>) -> Self {
        Self { lattice, window: lattice.whole(), altitudes_m }
    }

    /// The lowest and the highest altitude, metres; None where nobody can be.
    pub fn altitude_range_m(&self) -> Option<[f32; 2]> {
        self.altitudes_m.iter().filter(|m| !m.is_nan()).fold(None, |range, &altitude_m| {
            let [lowest, highest]: [f32; 2] = range.unwrap_or([altitude_m; 2]);
            Some([lowest.min(altitude_m), highest.max(altitude_m)])
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::grid::GeographicAxes;

    fn window(bounds: [f64; 4]) -> Option<PlaceWindow> {
        let axes = GeographicAxes {
            first_longitude_deg: 170.0,
            first_latitude_deg: 10.0,
            longitude_step_deg: 1.0,
            latitude_step_deg: -1.0,
        };
        let grid = Grid::geographic(axes, 20, 10);
        PlaceWindow::within(PlaceLattice::within(20, 10, 200), &grid, bounds)
    }

    /// Places lie in the middles of pixels; bounds may cross the antimeridian.
    #[test]
    fn a_window_has_the_places_within_bounds() {
        let part = |columns, rows| Some(PlaceWindow { columns, rows });
        assert_eq!(window([172.0, 2.0, 175.0, 4.0]), part(2..5, 6..8));
        assert_eq!(window([172.6, 2.6, 174.4, 3.4]), None, "rows between the middles");
        assert_eq!(window([178.0, 0.0, -178.0, 10.0]), part(8..12, 0..10));
        assert_eq!(window([-180.0, -90.0, 180.0, 90.0]), part(0..20, 0..10));
        assert_eq!(window([0.0, 0.0, 10.0, 10.0]), None);
    }

    /// Around the Earth bounds across the raster's ends are one window, whose pieces lie within the lattice; of a lattice that leaves
    /// a rest of the raster it is all columns.
    #[test]
    fn windows_go_on_beyond_the_last_column() {
        let axes = GeographicAxes {
            first_longitude_deg: -180.0,
            first_latitude_deg: 75.0,
            longitude_step_deg: 1.0 / 240.0,
            latitude_step_deg: -1.0 / 240.0,
        };
        let grid = Grid::geographic(axes, 86_400, 33_600);
        let lattice = PlaceLattice::within(86_400, 33_600, usize::MAX);
        let within = |lattice, bounds| PlaceWindow::within(lattice, &grid, bounds).unwrap();
        let part = PlaceWindow { columns: 86_160..86_640, rows: 16_800..17_040 };
        assert_eq!(within(lattice, [179.0, 4.0, -179.0, 5.0]), part);
        let piece = |columns| PlaceWindow { columns, rows: 16_800..17_040 };
        assert_eq!(part.pieces(lattice), [piece(86_160..86_400), piece(0..240)]);
        assert_eq!(piece(5..9).pieces(lattice), [piece(5..9)]);
        assert!(!part.is_within(lattice) && piece(0..86_400).is_within(lattice));
        assert_eq!(within(lattice, [-180.0, 4.0, 180.0, 5.0]), piece(0..86_400));
        assert_eq!(within(lattice, [-180.0, 4.0, -179.0, 5.0]), piece(0..240));
        let all = lattice.point(&grid, 86_399.0 + 3.0, 7.0).distance(lattice.point(&grid, 2.0, 7.0));
        assert!(all < 1e-12, "{all}");
        let seventh = PlaceLattice { columns: 12_342, step: 7, steps: [7, 7], ..lattice };
        assert_eq!(within(seventh, [179.0, 4.0, -179.0, 5.0]).columns, 0..12_342);
    }

    #[test]
    fn windows_overlap_where_they_share_places() {
        let whole = PlaceWindow { columns: 0..4, rows: 0..4 };
        assert!(whole.overlaps(&PlaceWindow { columns: 3..9, rows: 3..4 }));
        assert!(!whole.overlaps(&PlaceWindow { columns: 4..9, rows: 0..4 }));
        assert!(!whole.overlaps(&PlaceWindow { columns: 0..4, rows: 4..5 }));
    }
}
