//! Columns along any straight ray of the spherical atmosphere, by the Chapman function: upwards, downwards, or through a
//! lowest point.

use crate::{
    atmosphere::{AEROSOL_SCALE_HEIGHT_M, Atmosphere, MOLECULE_SCALE_HEIGHT_M},
    bands::BAND_COUNT,
    chapman,
    geometry::EARTH_RADIUS_M,
};

/// Densities of molecules and aerosol relative to z = 0.
pub(super) fn relative_densities(altitude_m: f64) -> [f64; 2] {
    [(-altitude_m / MOLECULE_SCALE_HEIGHT_M).exp(), (-altitude_m / AEROSOL_SCALE_HEIGHT_M).exp()]
}

/// Columns of both species from a point to space along a ray with cos zenith ≥ 0, metres at z = 0 density.
pub(super) fn columns_to_space_m(altitude_m: f64, cos_zenith: f64, density: [f64; 2]) -> [f64; 2] {
    [
        chapman::molecules().column_m(altitude_m, cos_zenith, density[0]),
        chapman::aerosol().column_m(altitude_m, cos_zenith, density[1]),
    ]
}

/// Extinction optical depth of a pair of columns, per band.
pub(super) fn optical_depths(atmosphere: &Atmosphere, columns_m: [f64; 2]) -> [f64; BAND_COUNT] {
    let (molecules, aerosol) =
        (atmosphere.molecule_extinction_per_m(), atmosphere.aerosol_extinction_per_m());
    std::array::from_fn(|band| molecules[band] * columns_m[0] + aerosol[band] * columns_m[1])
}

/// A straight ray from a point, with what it needs to know about its start.
#[derive(Clone, Copy, Debug)]
pub(super) struct SlantPath {
    start_radius_m: f64,
    start_altitude_m: f64,
    cos_zenith: f64,
    /// Columns to space from the start along the ray, or against it if it goes down.
    start_columns_m: [f64; 2],
    /// Path to the lowest point, and twice the columns from there to space; for rays that go down.
    lowest: Option<(f64, [f64; 2])>,
}

/// A point of a [`SlantPath`].
#[derive(Clone, Copy, Debug)]
pub(super) struct SlantPoint {
    pub(super) altitude_m: f64,
    /// Cosine of the zenith angle of the ray here.
    pub(super) cos_zenith: f64,
    /// Densities of molecules and aerosol relative to z = 0.
    pub(super) density: [f64; 2],
    /// Columns of both species from the start to here, metres.
    pub(super) columns_m: [f64; 2],
}

impl SlantPath {
    pub(super) fn new(altitude_m: f64, cos_zenith: f64) -> Self {
        let start_radius_m = EARTH_RADIUS_M + altitude_m;
        let start_columns_m =
            columns_to_space_m(altitude_m, cos_zenith.abs(), relative_densities(altitude_m));
        let lowest = (cos_zenith < 0.0).then(|| {
            let sine2 = (1.0 - cos_zenith * cos_zenith).max(0.0);
            let altitude = start_radius_m * sine2.sqrt() - EARTH_RADIUS_M;
            // Rays that meet the ground far below the surface never get there; the table ends at −10 km.
            let altitude = altitude.max(-10_000.0);
            let columns = columns_to_space_m(altitude, 0.0, relative_densities(altitude));
            (-start_radius_m * cos_zenith, columns.map(|c| 2.0 * c))
        });
        Self { start_radius_m, start_altitude_m: altitude_m, cos_zenith, start_columns_m, lowest }
    }

    /// Path to the sphere at a lower or equal altitude, metres; None if the ray misses it.
    pub(super) fn path_down_to_m(&self, altitude_m: f64) -> Option<f64> {
        if self.cos_zenith >= 0.0 {
            return None;
        }
        let below = (self.start_altitude_m - altitude_m).max(0.0);
        let c = below * (self.start_radius_m + EARTH_RADIUS_M + altitude_m);
        let b = self.start_radius_m * -self.cos_zenith;
        let discriminant = b * b - c;
        (discriminant >= 0.0).then(|| c / (b + discriminant.sqrt()))
    }

    /// Path to where the ray leaves the sphere at a higher altitude, metres; 0 if it starts above it.
    pub(super) fn path_up_to_m(&self, altitude_m: f64) -> f64 {
        let above = altitude_m - self.start_altitude_m;
        if above <= 0.0 {
            return 0.0;
        }
        let c = above * (self.start_radius_m + EARTH_RADIUS_M + altitude_m);
        let b = self.start_radius_m * self.cos_zenith;
        let root = (b * b + c).sqrt();
        if b >= 0.0 { c / (b + root) } else { root - b }
    }

    /// Path to the base of a cloud that is not below the start, metres: 0 from the base itself upwards, the whole chord
    /// below it downwards.
    pub(super) fn path_to_base_m(&self, base_altitude_m: f64) -> f64 {
        let above = (base_altitude_m - self.start_altitude_m).max(0.0);
        let c = above * (self.start_radius_m + EARTH_RADIUS_M + base_altitude_m);
        let b = self.start_radius_m * self.cos_zenith;
        let root = (b * b + c).sqrt();
        if b > 0.0 { c / (b + root) } else { root - b }
    }

    /// The point at distance `path_m` ≥ 0 along the ray.
    pub(super) fn point(&self, path_m: f64) -> SlantPoint {
        let (r0, mu) = (self.start_radius_m, self.cos_zenith);
        let rise = path_m * (2.0 * r0 * mu + path_m);
        let radius = (r0 * r0 + rise).max(0.0).sqrt();
        let altitude_m = self.start_altitude_m + rise / (radius + r0);
        let cos_zenith = ((r0 * mu + path_m) / radius).clamp(-1.0, 1.0);
        let density = relative_densities(altitude_m);
        let here = columns_to_space_m(altitude_m, cos_zenith.abs(), density);
        let start = self.start_columns_m;
        let columns_m = std::array::from_fn(|s| match self.lowest {
            None => start[s] - here[s],
            Some((lowest_path_m, _)) if path_m <= lowest_path_m => here[s] - start[s],
            Some((_, twice)) => twice[s] - start[s] - here[s],
        });
        SlantPoint { altitude_m, cos_zenith, density, columns_m: columns_m.map(|c: f64| c.max(0.0)) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::quadrature::integrate_adaptive;

    /// Columns up, down and through a lowest point agree with quadrature.
    #[test]
    fn columns_agree_with_quadrature() {
        for (altitude_m, mu, path_m) in [
            (0.0, 0.3, 20_000.0),
            (3_000.0, -0.4, 6_000.0),
            (5_000.0, -0.02, 60_000.0),
            (5_000.0, -0.02, 300_000.0),
            (40_000.0, -0.09, 900_000.0),
        ] {
            let ray = SlantPath::new(altitude_m, mu);
            let r0 = EARTH_RADIUS_M + altitude_m;
            let reference = integrate_adaptive(0.0, path_m, 1e-10, 0.0, |u| {
                let z = (r0 * r0 + 2.0 * r0 * mu * u + u * u).sqrt() - EARTH_RADIUS_M;
                relative_densities(z)
            });
            let got = ray.point(path_m).columns_m;
            for s in 0..2 {
                assert!(
                    (got[s] / reference[s] - 1.0).abs() < 1e-5,
                    "{altitude_m} {mu} {path_m}: {got:?} {reference:?}"
                );
            }
        }
    }

    /// Rays meet the ground and the top where they should.
    #[test]
    fn rays_meet_the_ground_and_the_top() {
        let ray = SlantPath::new(1_000.0, -0.5);
        let path_m = ray.path_down_to_m(200.0).unwrap();
        assert!((ray.point(path_m).altitude_m - 200.0).abs() < 1e-6);
        assert!(SlantPath::new(1_000.0, -0.01).path_down_to_m(0.0).is_none());
        for mu in [-0.01, 0.0, 0.7] {
            let up = SlantPath::new(1_000.0, mu);
            assert!((up.point(up.path_up_to_m(60_000.0)).altitude_m - 60_000.0).abs() < 1e-6);
            assert!((up.path_up_to_m(60_000.0) - up.path_to_base_m(60_000.0)).abs() < 1e-6);
        }
        // From the base itself: a chord below it, or nothing.
        let chord = SlantPath::new(1_000.0, -0.01).path_to_base_m(1_000.0);
        assert!((chord / (0.02 * (EARTH_RADIUS_M + 1_000.0)) - 1.0).abs() < 1e-12);
        assert_eq!(SlantPath::new(1_000.0, 0.3).path_to_base_m(1_000.0), 0.0);
        assert_eq!(SlantPath::new(1_000.0, 0.0).path_to_base_m(1_000.0), 0.0);
    }
}
