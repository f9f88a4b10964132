//! Where a flight of light crosses the surface that a view ray sweeps out about the source's vertical.

use super::{
    super::{optics::SlantPath, setting::SourceSetting},
    Detector,
};
use crate::geometry::EARTH_RADIUS_M;
use glam::{DVec2, DVec3};

/// A view ray in the frame of the source: z is the source's vertical, the origin the source.
pub(super) struct Ray {
    observer: DVec3,
    view: DVec3,
    pub(super) path: SlantPath,
}

/// A flight crossing the surface.
#[derive(Clone, Copy, Debug)]
pub(super) struct Crossing {
    /// Path from the flight's start, metres.
    pub(super) flight_m: f64,
    /// Path from the observer, metres.
    pub(super) view_m: f64,
    /// Cosine of the angle by which light turns here towards the observer.
    pub(super) cos_gamma: f64,
    /// ρ·|ω·(v × φ̂)|, metres.
    pub(super) facing_m: f64,
}

impl Ray {
    pub(super) fn new(setting: &SourceSetting, detector: &Detector) -> Self {
        let geometry = &detector.geometry;
        let arc = geometry.distance_m / EARTH_RADIUS_M;
        let (sine, cosine) = arc.sin_cos();
        let half = (0.5 * arc).sin();
        let radius = EARTH_RADIUS_M + geometry.observer_altitude_m;
        let drop = radius * 2.0 * half * half;
        let height = geometry.observer_altitude_m - setting.source_altitude_m - drop;
        let (sin_az, cos_az) = detector.relative_azimuth_rad.sin_cos();
        let (sin_el, cos_el) = detector.elevation_rad.sin_cos();
        let view = DVec3::new(-cosine, 0.0, sine) * (cos_el * cos_az)
            + DVec3::Y * (cos_el * sin_az)
            + DVec3::new(sine, 0.0, cosine) * sin_el;
        Self {
            observer: DVec3::new(radius * sine, 0.0, height),
            view,
            path: SlantPath::new(geometry.observer_altitude_m, sin_el),
        }
    }

    /// Where a flight of length `end_m` from `start` along the unit vector `direction` crosses the surface.
    pub(super) fn crossings(&self, start: DVec3, direction: DVec3, end_m: f64) -> [Option<Crossing>; 2] {
        let (x, w, o, v) = (start, direction, self.observer, self.view);
        if v.z.abs() < 1e-4 {
            return [None; 2];
        }
        // Same height: u = u₀ + u₁t along the view ray; same distance from the vertical: at² + 2bt + c = 0.
        let (u0, u1) = ((x.z - o.z) / v.z, w.z / v.z);
        let across2 = v.x * v.x + v.y * v.y;
        let a = w.x * w.x + w.y * w.y - across2 * u1 * u1;
        let b = x.x * w.x + x.y * w.y - o.x * v.x * u1 - across2 * u0 * u1;
        let c = x.x * x.x + x.y * x.y - o.x * o.x - 2.0 * o.x * v.x * u0 - across2 * u0 * u0;
        let discriminant = b * b - a * c;
        if discriminant < 0.0 {
            return [None; 2];
        }
        // Both roots without cancellation.
        let q = -(b + discriminant.sqrt().copysign(b));
        [q / a, c / q].map(|t| {
            let u = u0 + u1 * t;
            (t > 0.0 && t < end_m && u > 0.0).then(|| self.crossing(x, w, t, u)).flatten()
        })
    }

    fn crossing(&self, start: DVec3, direction: DVec3, flight_m: f64, view_m: f64) -> Option<Crossing> {
        let (here, there) = (start + direction * flight_m, self.observer + self.view * view_m);
        let rho = here.x.hypot(here.y);
        if rho < 1e-6 {
            return None;
        }
        // Turns the view ray about the vertical until it passes through the crossing.
        let around = DVec2::new(here.x, here.y) / rho;
        let turn = around.rotate(DVec2::new(there.x, -there.y) / rho);
        let across = turn.rotate(DVec2::new(self.view.x, self.view.y));
        let view = DVec3::new(across.x, across.y, self.view.z);
        let tangent = DVec3::new(-around.y, around.x, 0.0);
        let facing_m = rho * direction.dot(view.cross(tangent)).abs().max(1e-12);
        Some(Crossing { flight_m, view_m, cos_gamma: -direction.dot(view), facing_m })
    }
}
