//! The base of an overcast sky: a plane layer of drops, or a Lambertian surface (`docs/model.md#overcast`).

use crate::{
    drop_reflectance::{DROP_ASYMMETRY, DropLayer},
    error::{PhysicsError, check_range},
};

/// A closed layer of cloud seen from below, at one altitude everywhere.
///
/// It reflects light that reaches it from below and lets none through from above.
#[derive(Clone, Copy, Debug)]
pub struct CloudBase {
    altitude_m: f64,
    albedo: f64,
    /// None for a Lambertian surface.
    drops: Option<&'static DropLayer>,
}

impl PartialEq for CloudBase {
    fn eq(&self, other: &Self) -> bool {
        (self.altitude_m, self.albedo, self.is_lambertian())
            == (other.altitude_m, other.albedo, other.is_lambertian())
    }
}

impl CloudBase {
    /// Default albedo from below.
    pub const DEFAULT_ALBEDO: f64 = 0.5;
    /// Largest albedo of a layer of drops: an optical depth of 253.
    pub const MAX_ALBEDO: f64 = 0.95;
    /// Lowest base, metres above the sphere.
    pub const MIN_ALTITUDE_M: f64 = 200.0;
    /// Highest base, metres above the sphere.
    pub const MAX_ALTITUDE_M: f64 = 12_000.0;

    /// A layer of drops. Checks the ranges: altitude in metres above the sphere, 200..=12 000; albedo 0..=0.95.
    ///
    /// * `albedo`: of light that goes straight up, about: that of two streams, which stands for the optical depth
    ///   ([`Self::optical_depth`]). Grazing light is reflected more, and forward.
    ///
    /// # Errors
    /// [`PhysicsError::OutOfRange`] naming `cloud_base` or `cloud_albedo`.
    pub fn new(altitude_m: f64, albedo: f64) -> Result<Self, PhysicsError> {
        check_range("cloud_albedo", albedo, 0.0, Self::MAX_ALBEDO, "")?;
        let lambertian = Self::lambertian(altitude_m, albedo)?;
        Ok(Self { drops: Some(DropLayer::of_depth(Self::optical_depth(albedo))), ..lambertian })
    }

    /// A surface that reflects the same in every direction: for closed forms and the tracers. Checks the ranges: altitude in metres
    /// above the sphere, 200..=12 000; albedo 0..=1.
    ///
    /// # Errors
    /// [`PhysicsError::OutOfRange`] naming `cloud_base` or `cloud_albedo`.
    pub fn lambertian(altitude_m: f64, albedo: f64) -> Result<Self, PhysicsError> {
        check_range("cloud_base", altitude_m, Self::MIN_ALTITUDE_M, Self::MAX_ALTITUDE_M, "m")?;
        check_range("cloud_albedo", albedo, 0.0, 1.0, "")?;
        Ok(Self { altitude_m, albedo, drops: None })
    }

    /// Altitude above the sphere, metres.
    pub fn altitude_m(self) -> f64 {
        self.altitude_m
    }

    /// Albedo from below, the same in all bands: of a layer of drops, that of light that goes straight up.
    pub fn albedo(self) -> f64 {
        self.albedo
    }

    /// Whether it is a Lambertian surface.
    pub fn is_lambertian(self) -> bool {
        self.drops.is_none()
    }

    /// Optical depth of a layer of drops of an albedo by two streams (Bohren 1987): A = (1 − g)τ/(2 + (1 − g)τ).
    pub fn optical_depth(albedo: f64) -> f64 {
        2.0 * albedo / ((1.0 - DROP_ASYMMETRY) * (1.0 - albedo))
    }

    /// Albedo of a layer of drops of an optical depth, by the same.
    pub fn albedo_of(optical_depth: f64) -> f64 {
        let scaled = (1.0 - DROP_ASYMMETRY) * optical_depth;
        scaled / (2.0 + scaled)
    }

    /// Share of diffuse light that is reflected.
    pub fn diffuse_albedo(self) -> f64 {
        self.drops.map_or(self.albedo, |drops| drops.get().spherical_albedo())
    }

    /// Share of light from one direction that is reflected, by the cosine of its zenith angle there.
    pub fn plane_albedo(self, cos_zenith: f64) -> f64 {
        self.drops.map_or(self.albedo, |drops| drops.get().plane_albedo(cos_zenith))
    }

    /// What a direction has of reflected diffuse light, over the mean weighted by the cosine of its zenith angle.
    pub fn diffuse_share(self, cos_zenith: f64) -> f64 {
        let mean = self.diffuse_albedo();
        if mean > 0.0 { self.plane_albedo(cos_zenith) / mean } else { 1.0 }
    }

    /// Radiance over that of a white Lambertian surface in the same light, by the cosines of the zenith angles of the light and of
    /// the view ray there, 0..=1, and of the angle by which light turns.
    pub fn reflectance(self, cos_light: f64, cos_view: f64, cos_turn: f64) -> f64 {
        self.drops.map_or(self.albedo, |drops| drops.get().reflectance(cos_light, cos_view, cos_turn))
    }
}
