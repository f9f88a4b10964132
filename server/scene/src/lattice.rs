//! Grids in a projection, without the projection: exact places of every n-th pixel corner, bilinear interpolation between them,
//! and Newton's method for the inverse.
//!
//! The step is chosen when the lattice is made so that the bilinear places are within a small part of a
//! pixel (see `ingest::georeference`). A great circle deviates from its chord by n²·p/8R pixels, which
//! for pixels of p = 500 m and n = 16 is 0.003.

use glam::DVec3;
use skyglow_physics::GeoPoint;

/// Unit vectors of the pixel corners at columns 0, step, 2·step … width and rows alike; NaN off the world.
#[derive(Clone, Debug)]
pub(crate) struct Lattice {
    width: u32,
    height: u32,
    step: u32,
    nodes: Vec<DVec3>,
}

/// Nodes along an axis of `length` pixels.
pub(crate) fn node_count(length: u32, step: u32) -> u32 {
    length.div_ceil(step) + 1
}

/// Pixel coordinate of node `index` on an axis of `length` pixels.
pub(crate) fn node_position(index: u32, length: u32, step: u32) -> f64 {
    f64::from((index * step).min(length))
}

impl Lattice {
    /// From nodes row by row; `None` when their number does not fit.
    pub(crate) fn new(width: u32, height: u32, step: u32, nodes: Vec<DVec3>) -> Option<Self> {
        let fits = width > 0
            && height > 0
            && step > 0
            && nodes.len() == node_count(width, step) as usize * node_count(height, step) as usize;
        fits.then_some(Self { width, height, step, nodes })
    }

    /// Width and height in pixels.
    pub(crate) fn size(&self) -> (u32, u32) {
        (self.width, self.height)
    }

    /// Pixels between nodes.
    pub(crate) fn step(&self) -> u32 {
        self.step
    }

    /// The nodes, row by row.
    pub(crate) fn nodes(&self) -> &[DVec3] {
        &self.nodes
    }

    /// Cell index, its start and its length along one axis, for a position (also a little outside).
    fn cell(&self, position: f64, length: u32) -> (usize, f64, f64) {
        let last = node_count(length, self.step) - 2;
        let index = ((position / f64::from(self.step)).max(0.0) as u32).min(last);
        let start = node_position(index, length, self.step);
        (index as usize, start, node_position(index + 1, length, self.step) - start)
    }

    /// The point (chords, not normalised) at pixel coordinates, and its derivatives along both axes.
    fn chord_point(&self, x: f64, y: f64) -> (DVec3, DVec3, DVec3) {
        let (i, x0, dx) = self.cell(x, self.width);
        let (j, y0, dy) = self.cell(y, self.height);
        let columns = node_count(self.width, self.step) as usize;
        let (s, t) = ((x - x0) / dx, (y - y0) / dy);
        let top = &self.nodes[j * columns + i..];
        let bottom = &self.nodes[(j + 1) * columns + i..];
        let (a, b, c, d) = (top[0], top[1], bottom[0], bottom[1]);
        let (upper, lower) = (a.lerp(b, s), c.lerp(d, s));
        (upper.lerp(lower, t), (b - a).lerp(d - c, t) / dx, (lower - upper) / dy)
    }

    /// The unit vector at pixel coordinates.
    pub(crate) fn point(&self, x: f64, y: f64) -> DVec3 {
        self.chord_point(x, y).0.normalize()
    }

    /// Pixel coordinates of a place given as a unit vector; `None` well outside or off the world.
    pub(crate) fn position_of(&self, target: DVec3) -> Option<(f64, f64)> {
        self.solve(target, self.nearest_node(target)?, f64::from(self.step))
    }

    /// The same from a guess, for the next place on a path: also far outside, where the outermost cells are
    /// continued and positions only say on which side of the grid a place lies.
    pub(crate) fn position_near(&self, target: DVec3, guess: (f64, f64)) -> Option<(f64, f64)> {
        let reach = 4.0 * f64::from(self.width.max(self.height));
        self.solve(target, guess, reach).or_else(|| self.position_of(target))
    }

    /// Newton's method from a guess; positions stay within `reach` pixels of the grid.
    fn solve(&self, target: DVec3, (mut x, mut y): (f64, f64), reach: f64) -> Option<(f64, f64)> {
        for _ in 0..20 {
            let (point, along_x, along_y) = self.chord_point(x, y);
            // The point's radius is a little below 1: stretch the target to it, the rest is tangential.
            let miss = target * point.length() - point;
            let (xx, xy, yy) = (along_x.dot(along_x), along_x.dot(along_y), along_y.dot(along_y));
            let (mx, my) = (along_x.dot(miss), along_y.dot(miss));
            let determinant = xx * yy - xy * xy;
            let (dx, dy) = ((yy * mx - xy * my) / determinant, (xx * my - xy * mx) / determinant);
            if !(dx.is_finite() && dy.is_finite()) {
                return None;
            }
            x = (x + dx).clamp(-reach, f64::from(self.width) + reach);
            y = (y + dy).clamp(-reach, f64::from(self.height) + reach);
            if dx.abs() + dy.abs() < 1e-7 {
                // A tangent plane is also met from the far side of the Earth.
                return (point.dot(target) > 0.9).then_some((x, y));
            }
        }
        None
    }

    /// A node near the target, from at most 48 × 48 of them.
    fn nearest_node(&self, target: DVec3) -> Option<(f64, f64)> {
        let (columns, rows) = (node_count(self.width, self.step), node_count(self.height, self.step));
        let stride = |count: u32| count.div_ceil(48).max(1) as usize;
        let mut best = (f64::INFINITY, None);
        for j in (0..rows).step_by(stride(rows)) {
            for i in (0..columns).step_by(stride(columns)) {
                let node = self.nodes[(j * columns + i) as usize];
                let distance = node.distance_squared(target);
                if distance < best.0 {
                    best = (distance, Some((i, j)));
                }
            }
        }
        best.1
            .map(|(i, j)| (node_position(i, self.width, self.step), node_position(j, self.height, self.step)))
    }

    /// West, south, east, north in degrees, from the nodes; west > east across the antimeridian.
    pub(crate) fn bounds_deg(&self) -> [f64; 4] {
        let places: Vec<GeoPoint> =
            self.nodes.iter().filter(|n| n.is_finite()).map(|n| GeoPoint::from_vector(*n)).collect();
        let latitudes = places.iter().map(|p| p.latitude_deg());
        let (mut south, mut north) =
            latitudes.fold((90.0f64, -90.0f64), |(s, n), lat| (s.min(lat), n.max(lat)));
        let mut longitudes: Vec<f64> = places.iter().map(|p| p.longitude_deg()).collect();
        longitudes.sort_by(f64::total_cmp);
        let has_pole = |z: f64| {
            self.position_of(DVec3::new(0.0, 0.0, z)).is_some_and(|(x, y)| {
                (0.0..=f64::from(self.width)).contains(&x) && (0.0..=f64::from(self.height)).contains(&y)
            })
        };
        if has_pole(1.0) {
            north = 90.0;
        }
        if has_pole(-1.0) {
            south = -90.0;
        }
        if north == 90.0 || south == -90.0 || longitudes.is_empty() {
            return [-180.0, south, 180.0, north];
        }
        // The widest stretch of longitude without a node is what the grid does not span.
        let last = longitudes.len() - 1;
        let mut gap = (longitudes[0] + 360.0 - longitudes[last], longitudes[0], longitudes[last]);
        for pair in longitudes.windows(2) {
            if pair[1] - pair[0] > gap.0 {
                gap = (pair[1] - pair[0], pair[1], pair[0]);
            }
        }
        [gap.1, south, gap.2, north]
    }
}
