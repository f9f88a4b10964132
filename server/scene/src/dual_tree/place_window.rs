//! A part of a lattice: the places within bounds.

use super::place_lattice::PlaceLattice;
use crate::grid::Grid;
use rayon::prelude::*;
use skyglow_physics::GeoPoint;
use std::ops::Range;

/// Columns and rows of a lattice.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct PlaceWindow {
    /// From west to east (along the raster's rows).
    pub columns: Range<u32>,
    /// From north to south (along the raster's columns).
    pub rows: Range<u32>,
}

impl PlaceLattice {
    /// The lattice of the places of a window.
    pub(super) fn part(&self, window: &PlaceWindow) -> Self {
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

    /// The smallest that has all places of a lattice within bounds; None where there are none.
    ///
    /// * `bounds`: west, south, east, north, degrees; west of east beyond the antimeridian.
    pub(crate) fn within(lattice: PlaceLattice, grid: &Grid, bounds: [f64; 4]) -> Option<Self> {
        let [west, south, east, north] = bounds;
        let width = (east - west).rem_euclid(360.0);
        let width = if width == 0.0 && east > west { 360.0 } else { width };
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

    #[test]
    fn windows_overlap_where_they_share_places() {
        let whole = PlaceWindow { columns: 0..4, rows: 0..4 };
        assert!(whole.overlaps(&PlaceWindow { columns: 3..9, rows: 3..4 }));
        assert!(!whole.overlaps(&PlaceWindow { columns: 4..9, rows: 0..4 }));
        assert!(!whole.overlaps(&PlaceWindow { columns: 0..4, rows: 4..5 }));
    }
}
