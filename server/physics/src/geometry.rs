//! Spherical geometry of the Earth: great circles, azimuths, local frames, areas.
//!
//! Altitudes are metres above the sphere of radius [`EARTH_RADIUS_M`]; distances are great-circle arcs at
//! that radius, metres; azimuths are radians clockwise from true north.

use crate::error::{PhysicsError, check_range};
use glam::DVec3;
use serde::Serialize;

/// Radius of the spherical Earth, metres.
pub const EARTH_RADIUS_M: f64 = 6_371_000.0;

/// A place on the sphere (WGS84 latitude and longitude taken as spherical).
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct GeoPoint {
    latitude_rad: f64,
    longitude_rad: f64,
}

impl GeoPoint {
    /// From degrees: latitude −90..=90, longitude −180..=360 (stored in −180..180).
    ///
    /// # Errors
    /// [`PhysicsError::OutOfRange`] naming `lat` or `lon`.
    pub fn from_deg(latitude_deg: f64, longitude_deg: f64) -> Result<Self, PhysicsError> {
        check_range("lat", latitude_deg, -90.0, 90.0, "degrees")?;
        check_range("lon", longitude_deg, -180.0, 360.0, "degrees")?;
        Ok(Self::from_rad_unchecked(latitude_deg.to_radians(), longitude_deg.to_radians()))
    }

    /// From radians already known to be in range; longitude is wrapped into −π..π.
    pub fn from_rad_unchecked(latitude_rad: f64, longitude_rad: f64) -> Self {
        let two_pi = std::f64::consts::TAU;
        let wrapped = (longitude_rad + std::f64::consts::PI).rem_euclid(two_pi) - std::f64::consts::PI;
        Self { latitude_rad, longitude_rad: wrapped }
    }

    /// Latitude, radians.
    pub fn latitude_rad(self) -> f64 {
        self.latitude_rad
    }

    /// Longitude, radians, −π..π.
    pub fn longitude_rad(self) -> f64 {
        self.longitude_rad
    }

    /// Latitude, degrees.
    pub fn latitude_deg(self) -> f64 {
        self.latitude_rad.to_degrees()
    }

    /// Longitude, degrees, −180..180.
    pub fn longitude_deg(self) -> f64 {
        self.longitude_rad.to_degrees()
    }

    /// Unit vector from the Earth's centre (x to lat 0 lon 0, z to the north pole).
    pub fn unit_vector(self) -> DVec3 {
        let (sin_lat, cos_lat) = self.latitude_rad.sin_cos();
        let (sin_lon, cos_lon) = self.longitude_rad.sin_cos();
        DVec3::new(cos_lat * cos_lon, cos_lat * sin_lon, sin_lat)
    }

    /// The place in the direction of a vector from the Earth's centre (any length > 0).
    pub fn from_vector(v: DVec3) -> Self {
        let v = v.normalize();
        Self { latitude_rad: v.z.clamp(-1.0, 1.0).asin(), longitude_rad: v.y.atan2(v.x) }
    }

    /// The place `distance_m` along the great circle that starts here towards `azimuth_rad`.
    pub fn destination(self, azimuth_rad: f64, distance_m: f64) -> Self {
        let frame = LocalFrame::at(self);
        Self::from_vector(frame.along(frame.forward(azimuth_rad), distance_m))
    }
}

/// The east, north, up directions at a place, as unit vectors in the Earth-centred frame.
///
/// At the poles, where no direction is north, east is towards longitude + 90° of the given longitude, so the
/// frame is still right-handed and continuous along each meridian.
#[derive(Clone, Copy, Debug)]
pub struct LocalFrame {
    /// East.
    pub east: DVec3,
    /// North.
    pub north: DVec3,
    /// Up.
    pub up: DVec3,
}

/// Great-circle distance and initial azimuth from one place to another.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bearing {
    /// Great-circle arc at radius R, metres.
    pub distance_m: f64,
    /// Azimuth at the start, radians clockwise from north, 0..2π; 0 when the two coincide.
    pub azimuth_rad: f64,
}

impl LocalFrame {
    /// The frame at `place`.
    pub fn at(place: GeoPoint) -> Self {
        let (sin_lat, cos_lat) = place.latitude_rad.sin_cos();
        let (sin_lon, cos_lon) = place.longitude_rad.sin_cos();
        Self {
            east: DVec3::new(-sin_lon, cos_lon, 0.0),
            north: DVec3::new(-sin_lat * cos_lon, -sin_lat * sin_lon, cos_lat),
            up: DVec3::new(cos_lat * cos_lon, cos_lat * sin_lon, sin_lat),
        }
    }

    /// The horizontal direction of an azimuth, radians clockwise from north, as a unit vector.
    pub fn forward(&self, azimuth_rad: f64) -> DVec3 {
        let (sin_azimuth, cos_azimuth) = azimuth_rad.sin_cos();
        self.north * cos_azimuth + self.east * sin_azimuth
    }

    /// The unit vector of the place `distance_m` along the great circle that starts here in a horizontal direction.
    pub fn along(&self, forward: DVec3, distance_m: f64) -> DVec3 {
        let (sin_arc, cos_arc) = (distance_m / EARTH_RADIUS_M).sin_cos();
        self.up * cos_arc + forward * sin_arc
    }

    /// Distance and azimuth to the place whose Earth-centred unit vector is `target`.
    /// Accurate for all distances from millimetres to the antipode (atan2 of sine and cosine).
    pub fn bearing_to(&self, target: DVec3) -> Bearing {
        let (e, n, u) = (target.dot(self.east), target.dot(self.north), target.dot(self.up));
        let sine = (e * e + n * n).sqrt();
        let azimuth = e.atan2(n);
        Bearing {
            distance_m: EARTH_RADIUS_M * sine.atan2(u),
            azimuth_rad: if azimuth < 0.0 { azimuth + std::f64::consts::TAU } else { azimuth },
        }
    }
}

/// Area on the sphere between two parallels and two meridians, m²: R²·Δλ·(sin φ_north − sin φ_south).
pub fn geographic_cell_area_m2(south_rad: f64, north_rad: f64, longitude_width_rad: f64) -> f64 {
    // The difference of sines as a product keeps its digits for small cells near the poles.
    let half_sum = 0.5 * (north_rad + south_rad);
    let half_diff = 0.5 * (north_rad - south_rad);
    EARTH_RADIUS_M
        * EARTH_RADIUS_M
        * longitude_width_rad.abs()
        * (2.0 * half_sum.cos() * half_diff.sin()).abs()
}

/// Area on the sphere of the quadrilateral with great-circle edges through four unit vectors, m².
/// Corners in either orientation; solid angle of two triangles (van Oosterom and Strackee 1983).
pub fn spherical_quadrilateral_area_m2(corners: [DVec3; 4]) -> f64 {
    let triangle = |a: DVec3, b: DVec3, c: DVec3| {
        // Differences first: for cells of metres the triple product of unit vectors loses all digits.
        let numerator = a.dot((b - a).cross(c - a));
        let denominator = 1.0 + a.dot(b) + b.dot(c) + c.dot(a);
        2.0 * numerator.atan2(denominator)
    };
    let [a, b, c, d] = corners;
    EARTH_RADIUS_M * EARTH_RADIUS_M * (triangle(a, b, c) + triangle(a, c, d)).abs()
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// Mount Kenya is 138 km north-east of Nairobi.
    #[test]
    fn nairobi_to_mount_kenya() {
        let nairobi = GeoPoint::from_deg(-1.2864, 36.8172).unwrap();
        let mount_kenya = GeoPoint::from_deg(-0.1521, 37.3084).unwrap();
        let bearing = LocalFrame::at(nairobi).bearing_to(mount_kenya.unit_vector());
        // Haversine by hand: 137.4 km, 23.4 degrees.
        assert!((bearing.distance_m - 137_440.0).abs() < 300.0, "{bearing:?}");
        assert!((bearing.azimuth_rad.to_degrees() - 23.4).abs() < 0.2, "{bearing:?}");
    }

    #[test]
    fn the_whole_sphere_has_four_pi_r_squared() {
        let whole = geographic_cell_area_m2(
            -std::f64::consts::FRAC_PI_2,
            std::f64::consts::FRAC_PI_2,
            std::f64::consts::TAU,
        );
        let expected = 4.0 * std::f64::consts::PI * EARTH_RADIUS_M * EARTH_RADIUS_M;
        assert!((whole / expected - 1.0).abs() < 1e-14);
    }

    /// A small cell has the same area by both formulas.
    #[test]
    fn both_area_formulas_agree() {
        let (south, north, west, east) = (0.7f64, 0.7 + 7.3e-5, 0.1f64, 0.1 + 7.3e-5);
        let corner = |lat, lon| GeoPoint::from_rad_unchecked(lat, lon).unit_vector();
        let quad = spherical_quadrilateral_area_m2([
            corner(south, west),
            corner(south, east),
            corner(north, east),
            corner(north, west),
        ]);
        let cell = geographic_cell_area_m2(south, north, east - west);
        assert!((quad / cell - 1.0).abs() < 1e-6, "{quad} {cell}");
    }

    #[test]
    fn latitude_91_is_refused_by_name() {
        let error = GeoPoint::from_deg(91.0, 0.0).unwrap_err();
        assert!(error.to_string().contains("lat is 91"), "{error}");
        assert!(GeoPoint::from_deg(f64::NAN, 0.0).is_err());
    }

    proptest! {
        /// The bearing to a destination has the distance and the azimuth that led there.
        #[test]
        fn destination_and_bearing_are_inverse(
            lat in -89.0f64..89.0, lon in -180.0f64..180.0, azimuth in 0.0f64..6.2, distance in 1.0f64..1e6,
        ) {
            let start = GeoPoint::from_deg(lat, lon).unwrap();
            let end = start.destination(azimuth, distance);
            let bearing = LocalFrame::at(start).bearing_to(end.unit_vector());
            prop_assert!((bearing.distance_m - distance).abs() < 1e-6 * distance + 1e-6);
            let turn = (bearing.azimuth_rad - azimuth + std::f64::consts::PI)
                .rem_euclid(std::f64::consts::TAU) - std::f64::consts::PI;
            prop_assert!((turn * distance).abs() < 1e-2);
        }
    }
}
