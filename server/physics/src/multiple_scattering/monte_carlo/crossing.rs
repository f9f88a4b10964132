//! Where a photon path crosses the surface that a view ray sweeps out about the source's vertical.

use super::super::{
    optics::{SlantPath, optical_depths},
    setting::SourceSetting,
};
use crate::{geometry::EARTH_RADIUS_M, single_source::SourceGeometry};
use glam::{DVec2, DVec3};
use std::f64::consts::{PI, TAU};

/// A view ray that collects light: observer and direction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Detector {
    /// Observer and source; the source altitude must be the tracer's.
    pub geometry: SourceGeometry,
    /// Azimuth from the source's, radians.
    pub relative_azimuth_rad: f64,
    /// Elevation, radians, 0..=π/2. Rays that are horizontal at the source's place (within 1e-4) collect nothing.
    pub elevation_rad: f64,
}

/// A view ray in the frame of the source: z is the source's vertical, the origin the source.
pub(super) struct Ray {
    observer: DVec3,
    view: DVec3,
    pub(super) path: SlantPath,
    base: Option<BaseRing>,
}

/// Where a view ray meets the base of a cloud.
struct BaseRing {
    /// Nearest and farthest distance from the source's vertical at which arriving light is counted, metres.
    from_m: f64,
    to_m: f64,
    /// Radiance that the observer sees of 1 W arriving in the ring, m⁻² sr⁻¹.
    radiance_per_w: f64,
}

/// Half the width of a ring over the distance of the view ray's end from the source: the light that arrives falls as
/// a power of that distance, so its mean over the ring is that at its middle to a few parts in 1 000.
const RING_HALF_WIDTH: f64 = 0.05;

impl BaseRing {
    /// None under a clear sky and for an observer at or above the base.
    fn new(
        setting: &SourceSetting,
        band: usize,
        observer: DVec3,
        view: DVec3,
        path: &SlantPath,
    ) -> Option<Self> {
        let cloud = setting.atmosphere.cloud()?;
        let length_m = path.path_up_to_m(cloud.altitude_m());
        if length_m <= 0.0 {
            return None;
        }
        let end = observer + view * length_m;
        let (rho_m, half_m) = (end.x.hypot(end.y), RING_HALF_WIDTH * end.length());
        let (from_m, to_m) = ((rho_m - half_m).max(0.0), rho_m + half_m);
        // The sphere over a ring is larger than its shadow by the tilt of its vertical.
        let radius_m = EARTH_RADIUS_M + cloud.altitude_m();
        let cap = |rho_m: f64| TAU * radius_m * radius_m * (1.0 - (1.0 - (rho_m / radius_m).powi(2)).sqrt());
        let through = (-optical_depths(&setting.atmosphere, path.point(length_m).columns_m)[band]).exp();
        let radiance_per_w = cloud.albedo() / PI * through / (cap(to_m) - cap(from_m));
        Some(Self { from_m, to_m, radiance_per_w })
    }
}

/// A photon path crossing the surface.
#[derive(Clone, Copy, Debug)]
pub(super) struct Crossing {
    /// Path from the photon path's start, metres.
    pub(super) photon_m: f64,
    /// Path from the observer, metres.
    pub(super) view_m: f64,
    /// Cosine of the angle by which light turns here towards the observer.
    pub(super) cos_gamma: f64,
    /// ρ·|ω·(v × φ̂)|, metres.
    pub(super) facing_m: f64,
}

impl Ray {
    pub(super) fn new(setting: &SourceSetting, band: usize, detector: &Detector) -> Self {
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
        let observer = DVec3::new(radius * sine, 0.0, height);
        let path = SlantPath::new(geometry.observer_altitude_m, sin_el);
        let base = BaseRing::new(setting, band, observer, view, &path);
        Self { observer, view, path, base }
    }

    /// Radiance that the observer sees at the base of a cloud for 1 W that arrives there, m⁻² sr⁻¹; 0 outside the ring
    /// that stands for the end of the view ray.
    pub(super) fn base_radiance_per_w(&self, arrival: DVec3) -> f64 {
        let rho_m = arrival.x.hypot(arrival.y);
        let ring = self.base.as_ref().filter(|ring| rho_m >= ring.from_m && rho_m < ring.to_m);
        ring.map_or(0.0, |ring| ring.radiance_per_w)
    }

    /// Where a photon path of length `end_m` from `start` along the unit vector `direction` crosses the surface.
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

    fn crossing(&self, start: DVec3, direction: DVec3, photon_m: f64, view_m: f64) -> Option<Crossing> {
        let (here, there) = (start + direction * photon_m, self.observer + self.view * view_m);
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
        Some(Crossing { photon_m, view_m, cos_gamma: -direction.dot(view), facing_m })
    }
}
