//! A grid of longitudes and latitudes over part of a scene.

use serde_json::{Value, json};
use skyglow_physics::EARTH_RADIUS_M;
use skyglow_scene::SceneMetadata;
use std::f64::consts::PI;

/// Metres of a degree of latitude.
const METRES_PER_DEGREE: f64 = EARTH_RADIUS_M * (PI / 180.0);

/// Places at even steps of longitude and latitude.
#[derive(Clone, Debug, PartialEq)]
pub struct LonLatGrid {
    /// Longitude of the first column, degrees; columns may lie beyond 180.
    pub first_longitude_deg: f64,
    /// Degrees of longitude from column to column.
    pub longitude_step_deg: f64,
    /// Latitude of the first row, the northernmost, degrees.
    pub first_latitude_deg: f64,
    /// Degrees of latitude from row to row, southwards.
    pub latitude_step_deg: f64,
    /// Columns.
    pub columns: usize,
    /// Rows.
    pub rows: usize,
}

impl LonLatGrid {
    /// Over what a box and a scene have in common, on the scene's own places where they lie along parallels and meridians, else
    /// about as dense as they are; blocks of them share one where they would be more than `max_places`. None where they have
    /// nothing in common.
    ///
    /// * `extent_deg`: least longitude and latitude, largest longitude and latitude.
    /// * `step_pixels`: pixels of the scene from one place to the next.
    pub fn over(
        extent_deg: [f64; 4],
        scene: &SceneMetadata,
        step_pixels: u32,
        max_places: usize,
    ) -> Option<Self> {
        let [west, south, east, north] = super::base::unwrapped(scene);
        let [least, lowest, largest, highest] = extent_deg;
        let meets = |turn: &f64| least + turn <= east && largest + turn >= west;
        let turn = [0.0, 360.0, -360.0].into_iter().find(meets)?;
        let (from, to) = ((least + turn).max(west), (largest + turn).min(east));
        let (bottom, top) = (lowest.max(south), highest.min(north));
        if from > to || bottom > top {
            return None;
        }
        let own = own_axes(scene);
        let ([origin_x, step_x], [origin_y, step_y]) = own.unwrap_or_else(|| {
            let step = scene.pixel_size_m / METRES_PER_DEGREE;
            let across = step / (0.5 * (bottom + top)).to_radians().cos().max(0.01);
            ([west, across], [north, step])
        });
        let mut pixels = f64::from(step_pixels);
        loop {
            let (step_x, step_y) = (step_x * pixels, step_y * pixels);
            let [first, last] = [from, to].map(|edge| (edge - origin_x) / step_x);
            let [top_row, bottom_row] = [top, bottom].map(|edge| (origin_y - edge) / step_y);
            let (columns, column) = cells(first, last, (east - origin_x) / step_x);
            let (rows, row) = cells(top_row, bottom_row, (origin_y - south) / step_y);
            if columns * rows <= max_places.max(1) {
                return Some(Self {
                    first_longitude_deg: origin_x + (column + 0.5) * step_x,
                    longitude_step_deg: step_x,
                    first_latitude_deg: origin_y - (row + 0.5) * step_y,
                    latitude_step_deg: step_y,
                    columns,
                    rows,
                });
            }
            pixels *= 2.0;
        }
    }

    /// Longitude and latitude of a place, degrees, row by row from the north.
    pub fn place_deg(&self, index: usize) -> [f64; 2] {
        let (column, row) = (index % self.columns, index / self.columns);
        [
            self.first_longitude_deg + column as f64 * self.longitude_step_deg,
            self.first_latitude_deg - row as f64 * self.latitude_step_deg,
        ]
    }

    /// Number of places.
    pub fn len(&self) -> usize {
        self.columns * self.rows
    }

    /// Whether there is none.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Width of a cell, metres: the shorter of its sides.
    pub fn cell_m(&self) -> f64 {
        let middle_deg = self.first_latitude_deg - 0.5 * self.rows as f64 * self.latitude_step_deg;
        let across = self.longitude_step_deg * middle_deg.to_radians().cos();
        METRES_PER_DEGREE * across.min(self.latitude_step_deg)
    }

    pub(super) fn longitude_axis(&self) -> Value {
        let last = self.first_longitude_deg + (self.columns - 1) as f64 * self.longitude_step_deg;
        json!({"start": self.first_longitude_deg, "stop": last, "num": self.columns})
    }

    pub(super) fn latitude_axis(&self) -> Value {
        let last = self.first_latitude_deg - (self.rows - 1) as f64 * self.latitude_step_deg;
        json!({"start": self.first_latitude_deg, "stop": last, "num": self.rows})
    }
}

/// How many cells lie between two positions, at least one, and the first of them.
///
/// * `end`: where cells end.
fn cells(first: f64, last: f64, end: f64) -> (usize, f64) {
    let most = (end + 1e-6).floor().max(1.0);
    let first = (first + 1e-6).floor().clamp(0.0, most - 1.0);
    let last = (last - 1e-6).ceil().clamp(first + 1.0, most);
    ((last - first) as usize, first)
}

/// First longitude and step of the pixels, and first latitude and step southwards, where the raster lies along parallels and
/// meridians from the north-west; None for other rasters.
fn own_axes(scene: &SceneMetadata) -> Option<([f64; 2], [f64; 2])> {
    let [x, x_column, x_row, y, y_column, y_row] = scene.grid.geotransform;
    let [west, south, east, north] = super::base::unwrapped(scene);
    let is_close = |a: f64, b: f64| (a - b).abs() < 1e-6 * (1.0 + a.abs());
    let is_straight = x_row == 0.0 && y_column == 0.0 && x_column > 0.0 && y_row < 0.0;
    let fits = is_close(f64::from(scene.grid.width) * x_column, east - west)
        && is_close(-f64::from(scene.grid.height) * y_row, north - south)
        && is_close(y, north)
        && is_close((x - west).rem_euclid(360.0).min((west - x).rem_euclid(360.0)), 0.0);
    (is_straight && fits).then_some(([west, x_column], [north, -y_row]))
}
