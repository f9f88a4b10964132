//! Raster pixels as sources, and their recursive subdivision into point sources for one observer.

use crate::geometry::{EARTH_RADIUS_M, GeoPoint, LocalFrame};
use glam::DVec3;

/// A source nearer than this counts as at this distance on its own azimuth, metres.
pub const MIN_SOURCE_DISTANCE_M: f64 = 250.0;
/// A source farther than this is left out, metres.
pub const MAX_SOURCE_DISTANCE_M: f64 = 300_000.0;
/// Pixels whose centre is nearer than this are split, metres.
pub const SPLIT_WITHIN_M: f64 = 5_000.0;
/// A piece is small enough when its longer side is below max(r, 250 m) times this.
pub const SPLIT_RATIO: f64 = 0.1;

/// W m⁻² sr⁻¹ in one nW cm⁻² sr⁻¹.
pub const W_M2_SR_PER_NW_CM2_SR: f64 = 1e-5;

/// Upward flux [W, DNB-weighted] of a pixel: Φ = π · L · 1e-5 · A, with L in nW cm⁻² sr⁻¹ and A in m².
/// Multiply by a lamp's s_b for the flux in band b.
pub fn upward_flux_dnb_w(radiance_nw_cm2_sr: f64, area_m2: f64) -> f64 {
    std::f64::consts::PI * radiance_nw_cm2_sr * W_M2_SR_PER_NW_CM2_SR * area_m2
}

/// One lit raster pixel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SourcePixel {
    /// Corners as unit vectors from the Earth's centre, in order around the pixel.
    pub corners: [DVec3; 4],
    /// Upward flux, watts weighted by the DNB response, calibration included.
    pub flux_dnb_w: f64,
    /// Altitude of the source, metres above the sphere.
    pub altitude_m: f64,
}

/// A point source as one observer sees it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PointSource {
    /// Azimuth at the observer, radians clockwise from north, 0..2π.
    pub azimuth_rad: f64,
    /// Great-circle distance, metres, `MIN_SOURCE_DISTANCE_M..=MAX_SOURCE_DISTANCE_M`.
    pub distance_m: f64,
    /// Altitude, metres above the sphere.
    pub altitude_m: f64,
    /// Upward flux, DNB watts.
    pub flux_dnb_w: f64,
}

impl SourcePixel {
    /// The pixel's centre (of its corners) as a unit vector.
    pub fn center(&self) -> DVec3 {
        (self.corners[0] + self.corners[1] + self.corners[2] + self.corners[3]).normalize()
    }

    /// Calls `visit` with the point sources of this pixel for an observer: one at its centre, or, when
    /// the centre is nearer than [`SPLIT_WITHIN_M`], pieces each smaller than [`SPLIT_RATIO`] of its
    /// distance. Nothing where the centre is farther than [`MAX_SOURCE_DISTANCE_M`].
    /// The flux of the pieces sums to the pixel's. The same rule serves the reference solution and the fast path.
    pub fn for_each_point_source(&self, observer: &LocalFrame, visit: &mut impl FnMut(PointSource)) {
        let bearing = observer.bearing_to(self.center());
        if bearing.distance_m > MAX_SOURCE_DISTANCE_M {
            return;
        }
        if bearing.distance_m >= SPLIT_WITHIN_M {
            visit(PointSource {
                azimuth_rad: bearing.azimuth_rad,
                distance_m: bearing.distance_m.max(MIN_SOURCE_DISTANCE_M),
                altitude_m: self.altitude_m,
                flux_dnb_w: self.flux_dnb_w,
            });
        } else {
            split(self.corners, self.flux_dnb_w, self.altitude_m, observer, visit);
        }
    }
}

fn split(
    corners: [DVec3; 4],
    flux_dnb_w: f64,
    altitude_m: f64,
    observer: &LocalFrame,
    visit: &mut impl FnMut(PointSource),
) {
    let [a, b, c, d] = corners;
    let center = (a + b + c + d) * 0.25;
    let bearing = observer.bearing_to(center);
    let side_m = EARTH_RADIUS_M * (b - a).length().max((c - b).length());
    if side_m <= bearing.distance_m.max(MIN_SOURCE_DISTANCE_M) * SPLIT_RATIO {
        visit(PointSource {
            azimuth_rad: bearing.azimuth_rad,
            distance_m: bearing.distance_m.max(MIN_SOURCE_DISTANCE_M),
            altitude_m,
            flux_dnb_w,
        });
        return;
    }
    let (ab, bc, cd, da) = ((a + b) * 0.5, (b + c) * 0.5, (c + d) * 0.5, (d + a) * 0.5);
    for quarter in [[a, ab, center, da], [ab, b, bc, center], [center, bc, c, cd], [da, center, cd, d]] {
        split(quarter, flux_dnb_w * 0.25, altitude_m, observer, visit);
    }
}

/// All point sources of `pixels` for an observer at `place`.
pub fn point_sources(place: GeoPoint, pixels: &[SourcePixel]) -> Vec<PointSource> {
    let frame = LocalFrame::at(place);
    let mut sources = Vec::with_capacity(pixels.len());
    for pixel in pixels {
        pixel.for_each_point_source(&frame, &mut |source| sources.push(source));
    }
    sources
}

#[cfg(test)]
mod tests {
    use super::*;

    fn square_pixel(center: GeoPoint, side_m: f64) -> SourcePixel {
        let half = side_m / 2f64.sqrt();
        let corner =
            |k: f64| center.destination(std::f64::consts::FRAC_PI_4 * (2.0 * k + 1.0), half).unit_vector();
        SourcePixel {
            corners: [corner(0.0), corner(1.0), corner(2.0), corner(3.0)],
            flux_dnb_w: 7.0,
            altitude_m: 100.0,
        }
    }

    #[test]
    fn a_near_pixel_is_split_and_keeps_its_flux() {
        let here = GeoPoint::from_deg(-1.3, 36.8).unwrap();
        for distance_m in [0.0, 300.0, 1_000.0, 4_999.0] {
            let pixel = square_pixel(here.destination(1.0, distance_m), 463.0);
            let sources = point_sources(here, &[pixel]);
            let flux: f64 = sources.iter().map(|s| s.flux_dnb_w).sum();
            assert!((flux - 7.0).abs() < 1e-9);
            assert!(sources.iter().all(|s| s.distance_m >= MIN_SOURCE_DISTANCE_M));
            if distance_m <= 1_000.0 {
                assert!(sources.len() >= 16, "{distance_m}: {}", sources.len());
            }
        }
    }

    /// A far pixel is one point, and one beyond 300 km is none.
    #[test]
    fn far_pixels_are_points_up_to_300_km() {
        let here = GeoPoint::from_deg(10.0, 179.9).unwrap();
        assert_eq!(point_sources(here, &[square_pixel(here.destination(1.0, 2e5), 463.0)]).len(), 1);
        assert_eq!(point_sources(here, &[square_pixel(here.destination(1.0, 3.01e5), 463.0)]).len(), 0);
    }

    /// Ten nanowatt (per cm² and sr) over a square kilometre are 314 watts.
    #[test]
    fn radiance_to_upward_flux() {
        assert!((upward_flux_dnb_w(10.0, 1e6) - 314.159).abs() < 1e-3);
    }
}
