//! Lines and outlines on the map: ridges, valleys, lakes, coasts. Positions in kilometres.

use glam::DVec2;

/// Kilometres in a degree of latitude.
const KM_PER_DEG: f64 = 111.19;
/// Cosine of the demo's middle latitude, 45.75°: one scale east–west is good enough for made-up terrain.
const COS_MIDDLE: f64 = 0.697_8;

/// Map position of a place.
pub(super) fn map_km(latitude_deg: f64, longitude_deg: f64) -> DVec2 {
    DVec2::new(longitude_deg * COS_MIDDLE, latitude_deg) * KM_PER_DEG
}

/// A line with a value at each point.
pub(super) struct Line {
    points: Vec<(DVec2, f64)>,
    low: DVec2,
    high: DVec2,
}

impl Line {
    /// From (latitude, longitude, value).
    pub(super) fn new(points: &[(f64, f64, f64)]) -> Self {
        let points: Vec<_> = points.iter().map(|&(lat, lon, value)| (map_km(lat, lon), value)).collect();
        let low = points.iter().fold(DVec2::INFINITY, |low, p| low.min(p.0));
        let high = points.iter().fold(DVec2::NEG_INFINITY, |high, p| high.max(p.0));
        Self { points, low, high }
    }

    /// Distance to the line and the value at its nearest point; `None` farther than `within_km`.
    pub(super) fn nearest(&self, at: DVec2, within_km: f64) -> Option<(f64, f64)> {
        let outside = (self.low - at).max(at - self.high).max(DVec2::ZERO);
        if outside.length_squared() > within_km * within_km {
            return None;
        }
        let mut best = (f64::INFINITY, 0.0);
        for pair in self.points.windows(2) {
            let ((a, va), (b, vb)) = (pair[0], pair[1]);
            let along = b - a;
            let t = ((at - a).dot(along) / along.length_squared()).clamp(0.0, 1.0);
            let distance = at.distance_squared(a + along * t);
            if distance < best.0 {
                best = (distance, va + (vb - va) * t);
            }
        }
        let distance_km = best.0.sqrt();
        (distance_km <= within_km).then_some((distance_km, best.1))
    }
}

/// Whether a position lies inside a closed outline of (latitude, longitude).
pub(super) fn is_inside(outline: &[DVec2], at: DVec2) -> bool {
    let mut inside = false;
    for (index, a) in outline.iter().enumerate() {
        let b = outline[(index + 1) % outline.len()];
        if (a.y > at.y) != (b.y > at.y) && at.x < a.x + (b.x - a.x) * (at.y - a.y) / (b.y - a.y) {
            inside = !inside;
        }
    }
    inside
}

/// 0 below `from`, 1 above `to`, smooth between.
pub(super) fn smooth_step(from: f64, to: f64, value: f64) -> f64 {
    let t = ((value - from) / (to - from)).clamp(0.0, 1.0);
    t * t * (3.0 - 2.0 * t)
}
