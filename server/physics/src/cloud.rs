//! The base of an overcast sky: a Lambertian surface (`docs/model.md#overcast`).

use crate::error::{PhysicsError, check_range};

/// A closed layer of cloud seen from below: a Lambertian surface at one altitude everywhere.
///
/// It reflects [`Self::albedo`] of the light that reaches it from below and lets none through from above.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CloudBase {
    altitude_m: f64,
    albedo: f64,
}

impl CloudBase {
    /// Default albedo from below.
    pub const DEFAULT_ALBEDO: f64 = 0.5;
    /// Lowest base, metres above the sphere.
    pub const MIN_ALTITUDE_M: f64 = 200.0;
    /// Highest base, metres above the sphere.
    pub const MAX_ALTITUDE_M: f64 = 12_000.0;

    /// Checks the ranges: altitude in metres above the sphere, 200..=12 000; albedo 0..=1.
    ///
    /// # Errors
    /// [`PhysicsError::OutOfRange`] naming `cloud_base` or `cloud_albedo`.
    pub fn new(altitude_m: f64, albedo: f64) -> Result<Self, PhysicsError> {
        check_range("cloud_base", altitude_m, Self::MIN_ALTITUDE_M, Self::MAX_ALTITUDE_M, "m")?;
        check_range("cloud_albedo", albedo, 0.0, 1.0, "")?;
        Ok(Self { altitude_m, albedo })
    }

    /// Altitude above the sphere, metres.
    pub fn altitude_m(self) -> f64 {
        self.altitude_m
    }

    /// Lambertian albedo from below, the same in all bands.
    pub fn albedo(self) -> f64 {
        self.albedo
    }
}
