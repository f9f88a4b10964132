//! Ray–cone intersection: the part of a straight ray that is lit by a source whose light is cut at a skyline.
//!
//! A source whose skyline stands at elevation e all around lights the solid cone of elevations above e. The cone is
//! convex, so a ray meets it in one interval, between roots of (ŝ·w)² = sin²e·|w|², w = w₀ + u·v.

use glam::DVec3;

/// A ray w₀ + u·v (v of unit length) as seen from a source with the vertical `up`, metres.
#[derive(Clone, Copy, Debug)]
pub(crate) struct RayFromSource {
    /// From the source to the start of the ray, metres.
    pub(crate) start_m: DVec3,
    /// Direction of the ray.
    pub(crate) view: DVec3,
    /// The source's vertical.
    pub(crate) up: DVec3,
}

/// Sine of a blocking angle; exactly 0 for the open sky, angles below 0 and no number.
pub(crate) fn sin_blocking(blocking_rad: f64) -> f64 {
    blocking_rad.clamp(0.0, std::f64::consts::FRAC_PI_2).sin().max(0.0)
}

impl RayFromSource {
    /// Where the ray crosses the cone of elevation asin `sine` or its mirror image below the source, path lengths [m],
    /// in no order; fewer than two where it runs along the cone or misses both.
    pub(crate) fn crossings_m(&self, sine: f64) -> impl Iterator<Item = f64> {
        let (rate, height) = (self.up.dot(self.view), self.up.dot(self.start_m));
        let share = sine * sine;
        let a = rate * rate - share;
        let b = rate * height - share * self.view.dot(self.start_m);
        let c = height * height - share * self.start_m.length_squared();
        let discriminant = b * b - a * c;
        // au² + 2bu + c = 0 without cancellation: q = −(b ± √), u = q/a and c/q.
        let q = -(b + discriminant.max(0.0).sqrt().copysign(b));
        let roots = if discriminant >= 0.0 { [q / a, c / q] } else { [f64::NAN; 2] };
        roots.into_iter().filter(|root| root.is_finite())
    }

    /// Sine of the elevation at the source of the point at `path_m`.
    fn sin_elevation(&self, path_m: f64) -> f64 {
        let from_source = self.start_m + self.view * path_m;
        self.up.dot(from_source) / from_source.length().max(f64::MIN_POSITIVE)
    }

    /// The part of `low..high` [m] that lies above elevation asin `sine` at the source; all of it for `sine` = 0, which
    /// the caller has cut at the source's horizontal plane. None where no part does.
    pub(crate) fn lit_m(&self, sine: f64, (low, high): (f64, f64)) -> Option<(f64, f64)> {
        if sine <= 0.0 {
            return Some((low, high));
        }
        let mut edges = [low, high, high, high];
        let inside = self.crossings_m(sine).filter(|&u| u > low && u < high);
        for (edge, crossing) in edges[1..3].iter_mut().zip(inside) {
            *edge = crossing;
        }
        edges.sort_by(f64::total_cmp);
        // The lit points are one interval: what is between two crossings is lit as its middle is.
        let mut lit: Option<(f64, f64)> = None;
        for pair in edges.windows(2) {
            if pair[1] > pair[0] && self.sin_elevation(0.5 * (pair[0] + pair[1])) > sine {
                lit = Some((lit.map_or(pair[0], |(start, _)| start), pair[1]));
            }
        }
        lit
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        /// The lit part of a ray ends where the elevation at the source falls to the blocking
        /// angle, and nothing outside it is lit.
        #[test]
        fn lit_part_ends_at_the_blocking_angle(
            x in -5e4f64..5e4, z in -3e3f64..3e3, azimuth in 0.0f64..6.2, elevation in -1.5f64..1.57,
            blocking_deg in 0.1f64..80.0,
        ) {
            let (sin_az, cos_az) = azimuth.sin_cos();
            let (sin_el, cos_el) = elevation.sin_cos();
            let ray = RayFromSource {
                start_m: DVec3::new(x, 300.0, z),
                view: DVec3::new(cos_el * cos_az, cos_el * sin_az, sin_el),
                up: DVec3::Z,
            };
            let sine = sin_blocking(blocking_deg.to_radians());
            let lit = ray.lit_m(sine, (0.0, 2e5));
            for k in 0..2_000 {
                let path_m = 100.0 * (f64::from(k) + 0.5);
                let within = lit.is_some_and(|(low, high)| path_m > low && path_m < high);
                let sin_elevation = ray.sin_elevation(path_m);
                // At the edge itself rounding decides.
                prop_assert!(within == (sin_elevation > sine) || (sin_elevation - sine).abs() < 1e-9);
            }
        }
    }
}
