//! Where the observer stands.

use crate::error::CelestialError;
use serde::Serialize;
use skyglow_physics::error::check_range;

/// A place on WGS84.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
pub struct Site {
    latitude_deg: f64,
    longitude_deg: f64,
    altitude_m: f64,
}

impl Site {
    /// Latitude −90..=90° (geodetic), longitude −180..=360° eastwards, altitude −500..=12 000 m.
    ///
    /// # Errors
    /// [`CelestialError::Physics`] naming `lat`, `lon` or `altitude_m`.
    pub fn new(latitude_deg: f64, longitude_deg: f64, altitude_m: f64) -> Result<Self, CelestialError> {
        check_range("lat", latitude_deg, -90.0, 90.0, "degrees")?;
        check_range("lon", longitude_deg, -180.0, 360.0, "degrees")?;
        check_range("altitude_m", altitude_m, -500.0, 12_000.0, "m")?;
        // Within the range it stays as it is, digit by digit.
        let wrapped_deg = if longitude_deg < 180.0 { longitude_deg } else { longitude_deg - 360.0 };
        Ok(Self { latitude_deg, longitude_deg: wrapped_deg, altitude_m })
    }

    /// Geodetic latitude, degrees.
    pub fn latitude_deg(self) -> f64 {
        self.latitude_deg
    }

    /// Longitude eastwards, degrees, −180..180.
    pub fn longitude_deg(self) -> f64 {
        self.longitude_deg
    }

    /// Altitude, m.
    pub fn altitude_m(self) -> f64 {
        self.altitude_m
    }
}
