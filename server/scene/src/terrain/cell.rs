//! A line of sight within one cell of a raster: where the bilinear surface is highest against the sky, in closed form.

use skyglow_physics::EARTH_RADIUS_M;

/// How far rounding puts a place from where it is, cells.
const ROUNDING: f64 = 1e-6;
/// Samples along a cell where the ground ends within it.
const EDGE_SAMPLES: u32 = 16;

/// A segment of a great circle over a layer, straight in the layer's cells: positions (u, v) are cells with their
/// fractions, and the distance [m] from the observer runs evenly between them.
#[derive(Clone, Copy, Debug)]
pub(super) struct RaySegment {
    pub(super) start: (f64, f64),
    pub(super) end: (f64, f64),
    pub(super) start_m: f64,
    pub(super) end_m: f64,
}

impl RaySegment {
    /// The part between two fractions of the segment.
    pub(super) fn part(&self, from: f64, to: f64) -> Self {
        let at = |t: f64| {
            (self.start.0 + t * (self.end.0 - self.start.0), self.start.1 + t * (self.end.1 - self.start.1))
        };
        Self { start: at(from), end: at(to), start_m: self.distance_m(from), end_m: self.distance_m(to) }
    }

    /// Distance from the observer at a fraction of the segment, metres.
    pub(super) fn distance_m(&self, t: f64) -> f64 {
        self.start_m + t * (self.end_m - self.start_m)
    }

    /// The part over `0.5..=0.5 + size` along both axes, where the layer has samples, and by rounding beyond: a line along the edge of two
    /// layers must be in one of them.
    pub(super) fn clipped(&self, (width, height): (f64, f64)) -> Option<Self> {
        let (mut from, mut to) = (0.0f64, 1.0f64);
        for (start, end, size) in [(self.start.0, self.end.0, width), (self.start.1, self.end.1, height)] {
            let (a, b) = (0.5 - ROUNDING - start, 0.5 + ROUNDING + size - start);
            let run = end - start;
            if run == 0.0 {
                if a > 0.0 || b < 0.0 {
                    return None;
                }
                continue;
            }
            let (first, last) = if run > 0.0 { (a / run, b / run) } else { (b / run, a / run) };
            (from, to) = (from.max(first), to.min(last));
        }
        (from < to).then(|| self.part(from, to))
    }

    /// Cells along the longer axis.
    pub(super) fn extent(&self) -> f64 {
        (self.end.0 - self.start.0).abs().max((self.end.1 - self.start.1).abs())
    }
}

/// A segment that lies in one cell, and the cell's ground.
#[derive(Clone, Copy, Debug)]
pub(super) struct CellCrossing<'a> {
    segment: &'a RaySegment,
    /// Samples in the north-west, north-east, south-west and south-east (on a grid with north up), metres; NaN is void.
    corners_m: [f64; 4],
    /// Position of the first corner.
    origin: (f64, f64),
}

impl<'a> CellCrossing<'a> {
    pub(super) fn new(segment: &'a RaySegment, corners_m: [f64; 4], origin: (f64, f64)) -> Self {
        Self { segment, corners_m, origin }
    }

    /// Whether there are no voids at the corners.
    pub(super) fn is_whole(&self) -> bool {
        self.corners_m.iter().all(|height_m| height_m.is_finite())
    }

    /// Elevation at a fraction of the segment, metres, bilinear as [`TerrainRaster::bilinear_m`] has it: voids are left
    /// out of the mean while they have less than half of the weight.
    ///
    /// [`TerrainRaster::bilinear_m`]: super::raster::TerrainRaster::bilinear_m
    pub(super) fn height_m(&self, fraction: f64) -> Option<f64> {
        let RaySegment { start, end, .. } = self.segment;
        let s = start.0 + fraction * (end.0 - start.0) - self.origin.0;
        let t = start.1 + fraction * (end.1 - start.1) - self.origin.1;
        let weights = [(1.0 - s) * (1.0 - t), s * (1.0 - t), (1.0 - s) * t, s * t];
        let (mut sum, mut total) = (0.0, 0.0);
        for (height_m, weight) in self.corners_m.into_iter().zip(weights) {
            if height_m.is_finite() {
                sum += weight * height_m;
                total += weight;
            }
        }
        (total >= 0.5).then(|| sum / total)
    }

    /// The fraction inside a whole cell at which the ground is highest against the sky, if it is not at an end.
    ///
    /// Along a line, bilinear is quadratic: height above the eye's plane, which bends down by d²/2R, is
    /// p + q·d + r·d², and its ratio to d is highest where d² = p/r with both negative.
    pub(super) fn crest(&self, observer_altitude_m: f64) -> Option<f64> {
        let above_m = |t: f64| {
            let distance_m = self.segment.distance_m(t);
            let plane_m = observer_altitude_m + 0.5 * distance_m * distance_m / EARTH_RADIUS_M;
            self.height_m(t).map(|height_m| height_m - plane_m)
        };
        let (a_m, middle_m, b_m) = (above_m(0.0)?, above_m(0.5)?, above_m(1.0)?);
        let length_m = self.segment.end_m - self.segment.start_m;
        let curvature_m = 2.0 * (a_m + b_m - 2.0 * middle_m);
        let slope_m = b_m - a_m - curvature_m;
        let back = self.segment.start_m / length_m;
        let (p, r) = (a_m - slope_m * back + curvature_m * back * back, curvature_m / (length_m * length_m));
        let t = (p < 0.0 && r < 0.0).then(|| ((p / r).sqrt() - self.segment.start_m) / length_m)?;
        (0.0..1.0).contains(&t).then_some(t)
    }

    /// Visits points of ground along the cell, its abrupt ends among them: at a void or under another layer it is
    /// highest at its very edge where it falls away from the observer. `ground_m` at a fraction is None where there
    /// is none.
    pub(super) fn with_edges(&self, ground_m: &dyn Fn(f64) -> Option<f64>, mut visit: impl FnMut(f64, f64)) {
        let mut before = None;
        for point in 0..=EDGE_SAMPLES {
            let t = f64::from(point) / f64::from(EDGE_SAMPLES);
            let here = ground_m(t);
            if let Some(height_m) = here {
                visit(t, height_m);
            }
            if point > 0 && before.is_some() != here.is_some() {
                let last = t - 1.0 / f64::from(EDGE_SAMPLES);
                let edge = if here.is_some() { edge(ground_m, t, last) } else { edge(ground_m, last, t) };
                if let Some(height_m) = ground_m(edge) {
                    visit(edge, height_m);
                }
            }
            before = here;
        }
    }
}

/// The last fraction with ground on the way from one that has it to one that has none, to 2⁻²⁰ of the way.
fn edge(ground_m: &dyn Fn(f64) -> Option<f64>, mut ground: f64, mut none: f64) -> f64 {
    for _ in 0..20 {
        let middle = 0.5 * (ground + none);
        *if ground_m(middle).is_some() { &mut ground } else { &mut none } = middle;
    }
    ground
}
