//! A view ray past a source on the spherical Earth, and integrals along its lit part in the equiangular variable
//! (Kulla and Fajardo 2012).
//!
//! The ray is cut where the integrand has a kink or a jump: at the Earth's shadow (the source's horizon plane, where the
//! `horizon` lobe jumps to zero) or the cone of the skyline that cuts the source's light, at the ray's nearest points to
//! the source and to the vertical above it, at the 60° cone where the `oblique` lobe ends, and at a few scale heights.
//! Between cuts the variable is the angle α at the source, u = u_c + D·tan α, which absorbs 1/d².

use crate::{
    cloud::CloudBase,
    cone::{RayFromSource, sin_blocking},
    geometry::EARTH_RADIUS_M,
    quadrature::integrate_pieces,
};
use glam::DVec3;

/// Rays end at this altitude: 30 scale heights of the molecules, beyond which less than 1e-12 is left.
const TOP_ALTITUDE_M: f64 = 240_000.0;
/// Rays are cut at these heights above the observer, metres: some scale heights of each species.
const CUT_HEIGHTS_M: [f64; 2] = [4_000.0, 25_000.0];

/// Where the source is, seen from the observer.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SourceGeometry {
    /// Great-circle arc from observer to source, metres.
    pub distance_m: f64,
    /// Altitude of the source, metres.
    pub source_altitude_m: f64,
    /// Altitude of the observer, metres.
    pub observer_altitude_m: f64,
}

/// A view ray and a source in one frame: observer at the origin, z up, the source's azimuth along x.
#[derive(Clone, Copy, Debug)]
pub struct SourceRay {
    geometry: SourceGeometry,
    radius_m: f64,
    observer_radius_m: f64,
    source: DVec3,
    source_up: DVec3,
    view: DVec3,
    /// Sine of the elevation at the source at and below which it emits nothing; 0 for the open sky.
    sin_blocking: f64,
    /// Altitude at which the ray ends, metres: [`TOP_ALTITUDE_M`], or the base of a cloud.
    pub(super) top_altitude_m: f64,
}

/// A point on a view ray with everything scattering there needs.
#[derive(Clone, Copy, Debug)]
pub struct RayPoint {
    /// Distance from the observer, metres.
    pub path_m: f64,
    /// Altitude, metres.
    pub altitude_m: f64,
    /// Distance from the source squared, m².
    pub source_distance_m2: f64,
    /// Cosine of the zenith angle of S→P at S.
    pub cos_zenith_at_source: f64,
    /// Cosine of the zenith angle of S→P at P.
    pub cos_zenith_of_light: f64,
    /// Cosine of the zenith angle of the view ray at P.
    pub cos_zenith_of_view: f64,
    /// Cosine of the angle by which light turns at P towards the observer.
    pub cos_gamma: f64,
}

/// u = u_c + D·tan α between the ends of the lit part of a ray.
#[derive(Clone, Debug)]
struct Equiangular {
    start_m: f64,
    end_m: f64,
    nearest_m: f64,
    miss_m: f64,
    /// Ascending values of α between which the integrand is smooth.
    edges: Vec<f64>,
}

impl Equiangular {
    /// Path length at α, and du/dα = D(1 + tan²α).
    fn path_and_jacobian_m(&self, alpha: f64) -> (f64, f64) {
        let tangent = alpha.tan();
        let path_m = (self.nearest_m + self.miss_m * tangent).clamp(self.start_m, self.end_m);
        (path_m, self.miss_m * (1.0 + tangent * tangent))
    }
}

impl SourceRay {
    /// The ray at `relative_azimuth_rad` from the source's azimuth and `elevation_rad` ≥ 0.
    pub fn new(geometry: &SourceGeometry, relative_azimuth_rad: f64, elevation_rad: f64) -> Self {
        Self::on_sphere(EARTH_RADIUS_M, geometry, relative_azimuth_rad, elevation_rad)
    }

    /// As [`Self::new`] on a sphere of any radius; a huge one is a flat Earth, for closed forms.
    pub fn on_sphere(
        radius_m: f64,
        geometry: &SourceGeometry,
        relative_azimuth_rad: f64,
        elevation_rad: f64,
    ) -> Self {
        let (sin_arc, cos_arc) = (geometry.distance_m / radius_m).sin_cos();
        let half_sine = (0.5 * geometry.distance_m / radius_m).sin();
        let (sin_az, cos_az) = relative_azimuth_rad.sin_cos();
        let (sin_el, cos_el) = elevation_rad.sin_cos();
        let source_radius = radius_m + geometry.source_altitude_m;
        // z of the source relative to the observer, without subtracting two radii:
        // (R + h_c)cos α − (R + h_o) = h_c − h_o − (R + h_c)·2sin²(α/2).
        let drop = source_radius * 2.0 * half_sine * half_sine;
        Self {
            geometry: *geometry,
            radius_m,
            observer_radius_m: radius_m + geometry.observer_altitude_m,
            source: DVec3::new(
                source_radius * sin_arc,
                0.0,
                geometry.source_altitude_m - geometry.observer_altitude_m - drop,
            ),
            source_up: DVec3::new(sin_arc, 0.0, cos_arc),
            view: DVec3::new(cos_el * cos_az, cos_el * sin_az, sin_el),
            sin_blocking: 0.0,
            top_altitude_m: TOP_ALTITUDE_M,
        }
    }

    /// The same ray past a source that emits nothing at elevations of `blocking_rad` and below, all around.
    pub fn cut_at(self, blocking_rad: f64) -> Self {
        Self { sin_blocking: sin_blocking(blocking_rad), ..self }
    }

    /// The same ray below a cloud: it ends at the base. All of it is dark if the observer or the source is not below
    /// the base. Without a cloud (None) it is the ray itself.
    pub fn under(self, cloud: Option<CloudBase>) -> Self {
        let Some(cloud) = cloud else { return self };
        let highest_m = self.geometry.observer_altitude_m.max(self.geometry.source_altitude_m);
        let is_below = highest_m < cloud.altitude_m();
        Self { top_altitude_m: if is_below { cloud.altitude_m() } else { f64::NEG_INFINITY }, ..self }
    }

    /// The point at distance `path_m` along the ray.
    pub fn point(&self, path_m: f64) -> RayPoint {
        let observer_radius = self.observer_radius_m;
        let along = observer_radius * self.view.z + path_m;
        let radius = (observer_radius * observer_radius
            + path_m * (2.0 * observer_radius * self.view.z + path_m))
            .sqrt();
        // r − r_o = (2 r_o u sin φ + u²)/(r + r_o): no cancellation.
        let height_m = path_m * (2.0 * observer_radius * self.view.z + path_m) / (radius + observer_radius);
        let from_source = self.view * path_m - self.source;
        let distance2 = from_source.length_squared();
        let distance = distance2.sqrt();
        let from_center = self.view * path_m + DVec3::new(0.0, 0.0, observer_radius);
        RayPoint {
            path_m,
            altitude_m: observer_radius - self.radius_m + height_m,
            source_distance_m2: distance2,
            cos_zenith_at_source: self.source_up.dot(from_source) / distance,
            cos_zenith_of_light: from_center.dot(from_source) / (distance * radius),
            cos_zenith_of_view: along / radius,
            cos_gamma: (-from_source.dot(self.view) / distance).clamp(-1.0, 1.0),
        }
    }

    /// Path at which the ray reaches an altitude above its start, metres; 0 if it starts above it.
    pub(super) fn path_to_altitude_m(&self, altitude_m: f64) -> f64 {
        let height_m = altitude_m - (self.observer_radius_m - self.radius_m);
        if height_m <= 0.0 {
            return 0.0;
        }
        // u² + 2 r_o sin φ u − height_m(2r_o + height_m) = 0, the positive root without cancellation.
        let b = self.observer_radius_m * self.view.z;
        let c = height_m * (2.0 * self.observer_radius_m + height_m);
        c / (b + (b * b + c).sqrt())
    }

    /// The lit part of the ray, metres: above the source's horizon plane (the upper-hemisphere rule is the
    /// Earth's shadow), above its skyline, and below [`TOP_ALTITUDE_M`] or the base of the cloud. None where no
    /// part is lit.
    pub fn lit_range_m(&self) -> Option<(f64, f64)> {
        let end = self.path_to_altitude_m(self.top_altitude_m);
        // Height of the observer below the source's horizon plane, and how fast the ray climbs through it.
        let below = self.source_up.dot(self.source);
        let rate = self.source_up.dot(self.view);
        let (low, high) = if rate > 0.0 {
            ((below / rate).max(0.0), end)
        } else if below < 0.0 {
            (0.0, if rate < 0.0 { (below / rate).min(end) } else { end })
        } else {
            return None;
        };
        let from_source = RayFromSource { start_m: -self.source, view: self.view, up: self.source_up };
        (high > low).then_some((low, high)).and_then(|range| from_source.lit_m(self.sin_blocking, range))
    }

    /// N integrals over the lit part of the ray by path length [m], each to a relative `tolerance` (or to
    /// `tolerance · floor` where it is smaller than `floor`).
    pub fn integrate<const N: usize>(
        &self,
        tolerance: f64,
        floor: f64,
        mut integrand: impl FnMut(&RayPoint) -> [f64; N],
    ) -> [f64; N] {
        let Some(variable) = self.equiangular(&CUT_HEIGHTS_M) else {
            return [0.0; N];
        };
        integrate_pieces(&variable.edges, tolerance, floor, &mut |alpha| {
            let (path_m, jacobian) = variable.path_and_jacobian_m(alpha);
            integrand(&self.point(path_m)).map(|value| value * jacobian)
        })
    }

    /// As [`Self::integrate`] with a fixed Gauss–Legendre rule a piece (`nodes` of
    /// [`crate::quadrature::gauss_legendre`]): for tables, where speed counts.
    pub fn integrate_fixed<const N: usize>(
        &self,
        nodes: &[(f64, f64)],
        mut integrand: impl FnMut(&RayPoint) -> [f64; N],
    ) -> [f64; N] {
        let mut sum = [0.0; N];
        let Some(variable) = self.equiangular(&CUT_HEIGHTS_M) else { return sum };
        for pair in variable.edges.windows(2) {
            let width = pair[1] - pair[0];
            for &(x, weight) in nodes {
                let (path_m, jacobian) = variable.path_and_jacobian_m(pair[0] + width * x);
                let factor = jacobian * width * weight;
                let values = integrand(&self.point(path_m));
                for (sum, value) in sum.iter_mut().zip(values) {
                    *sum += factor * value;
                }
            }
        }
        sum
    }

    /// The lit part of the ray in the equiangular variable, cut where the integrand has a kink and at the given
    /// heights [m] above the observer. None where nothing is lit.
    fn equiangular(&self, heights_m: &[f64]) -> Option<Equiangular> {
        let (start_m, end_m) = self.lit_range_m()?;
        let nearest_m = self.source.dot(self.view);
        let miss_m = (self.source - self.view * nearest_m).length().max(1e-3);
        let mut cuts = vec![start_m, end_m, nearest_m];
        let observer_altitude = (self.observer_radius_m - self.radius_m).max(0.0);
        cuts.extend(heights_m.iter().map(|height_m| self.path_to_altitude_m(observer_altitude + height_m)));
        self.push_axis_and_cone_cuts(&mut cuts);
        cuts.retain(|&u| u.is_finite() && u >= start_m && u <= end_m);
        cuts.sort_by(f64::total_cmp);
        let mut edges: Vec<f64> = cuts.iter().map(|&u| ((u - nearest_m) / miss_m).atan()).collect();
        edges.dedup_by(|a, b| (*a - *b).abs() < 1e-12);
        Some(Equiangular { start_m, end_m, nearest_m, miss_m, edges })
    }

    /// Nearest point to the vertical above the source, where sin ψ has a (near-)kink, and the 60° cone.
    fn push_axis_and_cone_cuts(&self, cuts: &mut Vec<f64>) {
        let (rate, below) = (self.source_up.dot(self.view), self.source_up.dot(self.source));
        let view_across = self.view - self.source_up * rate;
        let source_across = self.source - self.source_up * below;
        let across2 = view_across.length_squared();
        if across2 > 1e-18 {
            cuts.push(source_across.dot(view_across) / across2);
        }
        // (ŝ·w)² = ¼|w|² for w = uv − S.
        let a = rate * rate - 0.25;
        let b = -rate * below + 0.25 * self.view.dot(self.source);
        let c = below * below - 0.25 * self.source.length_squared();
        let discriminant = b * b - a * c;
        if discriminant > 0.0 && a.abs() > 1e-12 {
            let root = discriminant.sqrt();
            cuts.extend([(-b - root) / a, (-b + root) / a]);
        }
    }
}
