//! The raster's own grid on the sphere: corners, centre and area of a pixel, and the pixel at a place.
//!
//! Columns count from the raster's left, rows from its top; fractional positions are 0 at the outer edge of
//! the first pixel and `width`, `height` at the outer edge of the last. No GDAL is needed once a grid is made.

use crate::lattice::Lattice;
use glam::DVec3;
use skyglow_physics::GeoPoint;
use skyglow_physics::geometry::{geographic_cell_area_m2, spherical_quadrilateral_area_m2};

/// A grid of `width` × `height` pixels on the sphere.
#[derive(Clone, Debug)]
pub(crate) struct Grid {
    pub(crate) width: u32,
    pub(crate) height: u32,
    kind: GridKind,
}

#[derive(Clone, Debug)]
enum GridKind {
    Geographic(GeographicGrid),
    Lattice(Lattice),
}

/// West edge, north edge and steps in degrees; the longitude step is positive, the latitude step either.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct GeographicAxes {
    pub(crate) first_longitude_deg: f64,
    pub(crate) first_latitude_deg: f64,
    pub(crate) longitude_step_deg: f64,
    pub(crate) latitude_step_deg: f64,
}

/// A grid along parallels and meridians, with the trigonometry of its rows and columns done once.
#[derive(Clone, Debug)]
struct GeographicGrid {
    axes: GeographicAxes,
    /// (cos, sin) of the longitude of each column edge.
    column_edges: Vec<(f64, f64)>,
    /// (cos, sin) of the longitude of each column's middle.
    column_middles: Vec<(f64, f64)>,
    /// (cos, sin) of the latitude of each row edge.
    row_edges: Vec<(f64, f64)>,
    /// Distance from the axis and height above the equator of each row's pixel centres, unit sphere.
    row_centers: Vec<(f64, f64)>,
    /// Area of a pixel of each row, m².
    row_areas_m2: Vec<f64>,
}

impl GeographicGrid {
    fn new(axes: GeographicAxes, width: u32, height: u32) -> Self {
        let cos_sin = |deg: f64| {
            let (sin, cos) = deg.to_radians().sin_cos();
            (cos, sin)
        };
        let longitude = |c: f64| axes.first_longitude_deg + c * axes.longitude_step_deg;
        // Grids of pixel centres reach half a pixel over the pole; there is nothing beyond it.
        let latitude = |r: f64| (axes.first_latitude_deg + r * axes.latitude_step_deg).clamp(-90.0, 90.0);
        let row_edges: Vec<_> = (0..=height).map(|r| cos_sin(latitude(f64::from(r)))).collect();
        let (half_cos, _) = cos_sin(0.5 * axes.longitude_step_deg);
        Self {
            axes,
            column_edges: (0..=width).map(|c| cos_sin(longitude(f64::from(c)))).collect(),
            column_middles: (0..width).map(|c| cos_sin(longitude(f64::from(c) + 0.5))).collect(),
            row_centers: row_edges
                .windows(2)
                .map(|edge| {
                    // The normalised mean of the four corners, as `SourcePixel::center` takes it.
                    let out = 0.5 * (edge[0].0 + edge[1].0) * half_cos;
                    let up = 0.5 * (edge[0].1 + edge[1].1);
                    let length = out.hypot(up);
                    (out / length, up / length)
                })
                .collect(),
            row_areas_m2: (0..height)
                .map(|r| {
                    let (a, b) = (latitude(f64::from(r)), latitude(f64::from(r) + 1.0));
                    geographic_cell_area_m2(
                        a.min(b).to_radians(),
                        a.max(b).to_radians(),
                        axes.longitude_step_deg.to_radians(),
                    )
                })
                .collect(),
            row_edges,
        }
    }

    fn edge_point(&self, column: usize, row: usize) -> DVec3 {
        let ((cos_lon, sin_lon), (cos_lat, sin_lat)) = (self.column_edges[column], self.row_edges[row]);
        DVec3::new(cos_lat * cos_lon, cos_lat * sin_lon, sin_lat)
    }

    fn position_of(&self, place: GeoPoint, width: f64) -> (f64, f64) {
        let turn = 360.0 / self.axes.longitude_step_deg;
        let east = place.longitude_deg() - self.axes.first_longitude_deg;
        let mut column = (east / self.axes.longitude_step_deg).rem_euclid(turn);
        // A grid that starts a little east of the place by rounding, as at the antimeridian.
        if column >= width && column > turn - 1e-6 {
            column = 0.0;
        }
        (column, (place.latitude_deg() - self.axes.first_latitude_deg) / self.axes.latitude_step_deg)
    }
}

impl Grid {
    /// A grid along parallels and meridians.
    pub(crate) fn geographic(axes: GeographicAxes, width: u32, height: u32) -> Self {
        Self { width, height, kind: GridKind::Geographic(GeographicGrid::new(axes, width, height)) }
    }

    /// A grid in any projection, by the places of a lattice of its pixel corners.
    pub(crate) fn from_lattice(lattice: Lattice) -> Self {
        let (width, height) = lattice.size();
        Self { width, height, kind: GridKind::Lattice(lattice) }
    }

    /// The axes of a geographic grid.
    pub(crate) fn axes(&self) -> Option<GeographicAxes> {
        match &self.kind {
            GridKind::Geographic(grid) => Some(grid.axes),
            GridKind::Lattice(_) => None,
        }
    }

    /// The lattice of a projected grid.
    pub(crate) fn lattice(&self) -> Option<&Lattice> {
        match &self.kind {
            GridKind::Geographic(_) => None,
            GridKind::Lattice(lattice) => Some(lattice),
        }
    }

    /// Corners of a pixel as unit vectors, in order around it; not finite off the world.
    pub(crate) fn corners(&self, column: u32, row: u32) -> [DVec3; 4] {
        let (c, r) = (column as usize, row as usize);
        match &self.kind {
            GridKind::Geographic(grid) => [
                grid.edge_point(c, r),
                grid.edge_point(c + 1, r),
                grid.edge_point(c + 1, r + 1),
                grid.edge_point(c, r + 1),
            ],
            GridKind::Lattice(lattice) => {
                let (x, y) = (f64::from(column), f64::from(row));
                [(x, y), (x + 1.0, y), (x + 1.0, y + 1.0), (x, y + 1.0)].map(|(x, y)| lattice.point(x, y))
            }
        }
    }

    /// The place at pixel coordinates as a unit vector: (0, 0) is the outer corner of the first pixel; not finite off the world.
    pub(crate) fn point(&self, x: f64, y: f64) -> DVec3 {
        match &self.kind {
            GridKind::Geographic(grid) => {
                let axes = grid.axes;
                let (sin_lon, cos_lon) =
                    (axes.first_longitude_deg + axes.longitude_step_deg * x).to_radians().sin_cos();
                let (sin_lat, cos_lat) =
                    (axes.first_latitude_deg + axes.latitude_step_deg * y).to_radians().sin_cos();
                DVec3::new(cos_lat * cos_lon, cos_lat * sin_lon, sin_lat)
            }
            GridKind::Lattice(lattice) => lattice.point(x, y),
        }
    }

    /// Centre of a pixel as a unit vector: the normalised mean of its corners; not finite off the world.
    pub(crate) fn center(&self, column: u32, row: u32) -> DVec3 {
        match &self.kind {
            GridKind::Geographic(grid) => {
                let (cos_lon, sin_lon) = grid.column_middles[column as usize];
                let (out, up) = grid.row_centers[row as usize];
                DVec3::new(out * cos_lon, out * sin_lon, up)
            }
            GridKind::Lattice(_) => {
                let [a, b, c, d] = self.corners(column, row);
                (a + b + c + d).normalize()
            }
        }
    }

    /// Area of a pixel on the sphere, m².
    pub(crate) fn area_m2(&self, column: u32, row: u32) -> f64 {
        match &self.kind {
            GridKind::Geographic(grid) => grid.row_areas_m2[row as usize],
            GridKind::Lattice(_) => spherical_quadrilateral_area_m2(self.corners(column, row)),
        }
    }

    /// Fractional (column, row) of a place, `0..width` and `0..height`; `None` outside the grid.
    pub(crate) fn position_of(&self, place: GeoPoint) -> Option<(f64, f64)> {
        let (width, height) = (f64::from(self.width), f64::from(self.height));
        let (mut column, mut row) = match &self.kind {
            GridKind::Geographic(grid) => grid.position_of(place, width),
            GridKind::Lattice(lattice) => lattice.position_of(place.unit_vector())?,
        };
        // The far edges belong to the grid.
        let snap = |value: f64, end: f64| {
            if (end..=end + 1e-9 * end).contains(&value) { end.next_down() } else { value }
        };
        (column, row) = (snap(column, width), snap(row, height));
        let inside = (0.0..width).contains(&column) && (0.0..height).contains(&row);
        inside.then_some((column, row))
    }

    /// Fractional (column, row) of a place given as a unit vector, also outside the grid: of the turns around
    /// the Earth the one nearest to `near`, which lies on the same path. `None` where a projection has no place.
    pub(crate) fn position_near(&self, target: DVec3, near: (f64, f64)) -> Option<(f64, f64)> {
        match &self.kind {
            GridKind::Geographic(grid) => {
                let axes = grid.axes;
                let (longitude, latitude) = (target.y.atan2(target.x), target.z.clamp(-1.0, 1.0).asin());
                let column = (longitude.to_degrees() - axes.first_longitude_deg) / axes.longitude_step_deg;
                let row = (latitude.to_degrees() - axes.first_latitude_deg) / axes.latitude_step_deg;
                let turn = 360.0 / axes.longitude_step_deg;
                Some((column - turn * ((column - near.0) / turn).round(), row))
            }
            GridKind::Lattice(lattice) => lattice.position_near(target, near),
        }
    }

    /// Columns of a whole turn around the Earth where the grid spans so much of it that a path may meet the grid
    /// again on its other side; `None` for smaller grids and projections.
    pub(crate) fn turn_columns(&self) -> Option<f64> {
        let turn = 360.0 / self.axes()?.longitude_step_deg;
        (f64::from(self.width) > 0.5 * turn).then_some(turn)
    }

    /// A circle on the sphere that holds the grid: its centre as a unit vector and its angular radius, radians; π,
    /// the whole sphere, for grids that are large or leave the world.
    pub(crate) fn cap(&self) -> (DVec3, f64) {
        const STEPS: u32 = 16;
        let border = (0..=STEPS).flat_map(|i| {
            let (c, r) = (i * (self.width - 1) / STEPS, i * (self.height - 1) / STEPS);
            [(c, 0), (c, self.height - 1), (0, r), (self.width - 1, r)]
        });
        let points: Vec<DVec3> = border.flat_map(|(column, row)| self.corners(column, row)).collect();
        let center = points.iter().sum::<DVec3>().normalize_or_zero();
        let radius_rad = points.iter().map(|point| center.distance(*point)).fold(0.0, f64::max);
        // Chords are shorter than their arcs and the border bulges between its points: by less than a tenth here.
        let is_small = points.iter().all(|point| point.is_finite()) && (1e-9..0.5).contains(&radius_rad);
        if is_small { (center, 1.1 * radius_rad) } else { (DVec3::Z, std::f64::consts::PI) }
    }

    /// The pixel at a place; `None` outside the grid.
    pub(crate) fn pixel_at(&self, place: GeoPoint) -> Option<(u32, u32)> {
        self.position_of(place).map(|(column, row)| (column as u32, row as u32))
    }

    /// Side of a square of the area of the middle pixel, metres.
    pub(crate) fn pixel_size_m(&self) -> f64 {
        let middle = self.area_m2(self.width / 2, self.height / 2).sqrt();
        if middle.is_finite() {
            return middle;
        }
        // The middle can lie off the world; take any pixel that does not.
        let pixels = (0..64u32).flat_map(|r| (0..64u32).map(move |c| (c, r)));
        pixels
            .map(|(c, r)| self.area_m2(c * (self.width - 1) / 63, r * (self.height - 1) / 63).sqrt())
            .find(|size| size.is_finite())
            .unwrap_or(f64::NAN)
    }

    /// West, south, east, north in degrees; west > east across the antimeridian.
    pub(crate) fn bounds_deg(&self) -> [f64; 4] {
        match &self.kind {
            GridKind::Geographic(grid) => {
                let axes = grid.axes;
                let span = axes.longitude_step_deg * f64::from(self.width);
                let a = axes.first_latitude_deg;
                let b = a + axes.latitude_step_deg * f64::from(self.height);
                let (west, east) = if span >= 360.0 - 1e-9 {
                    (-180.0, 180.0)
                } else {
                    let wrap = |deg: f64| (deg + 180.0).rem_euclid(360.0) - 180.0;
                    let west = wrap(axes.first_longitude_deg);
                    let east = wrap(axes.first_longitude_deg + span);
                    (west, if east == -180.0 { 180.0 } else { east })
                };
                [west, a.min(b).max(-90.0), east, a.max(b).min(90.0)]
            }
            GridKind::Lattice(lattice) => lattice.bounds_deg(),
        }
    }
}

#[cfg(test)]
#[path = "grid_tests.rs"]
mod tests;
