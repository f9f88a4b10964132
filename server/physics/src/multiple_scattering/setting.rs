//! Input of the solver of multiply scattered light: source, atmosphere and ground, and the resolution.

use crate::{
    atmosphere::Atmosphere,
    error::{PhysicsError, check_range},
};

/// Default albedo of the ground.
pub const DEFAULT_GROUND_ALBEDO: f64 = 0.15;
/// A field is solved for sources at least so far below the base of a cloud, metres: nearer, the spot that they light is
/// smaller than the field's rings.
pub const MIN_BELOW_BASE_M: f64 = 25.0;
/// Highest source, metres.
const MAX_SOURCE_M: f64 = 10_000.0;

/// One source in its air above its ground.
///
/// The ground is the sphere through the lower of source and observer. For every observer as high as the source
/// or higher that is the source's own altitude; an observer below the source needs a field of its own, with
/// the ground at the observer's altitude.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SourceSetting {
    /// The air, and the cloud over it, if any.
    pub atmosphere: Atmosphere,
    /// Altitude of the source, metres, −2 000..=10 000, and [`MIN_BELOW_BASE_M`] and more below the base of a cloud.
    pub source_altitude_m: f64,
    /// Altitude of the ground, metres, −2 000..=source_altitude_m.
    pub ground_altitude_m: f64,
    /// Lambertian albedo of the ground, 0..=1, the same in all bands.
    pub ground_albedo: f64,
    /// Elevation of the skyline around the source, radians, 0..=π/2: at and below it the source emits nothing.
    /// 0 is the open sky.
    pub blocking_rad: f64,
}

impl SourceSetting {
    /// Checks the ranges; the sky is open. Under a cloud a source at the base or less than [`MIN_BELOW_BASE_M`] below
    /// it is refused.
    ///
    /// # Errors
    /// [`PhysicsError::OutOfRange`] naming `source_altitude`, `ground_altitude` or `ground_albedo`.
    pub fn new(
        atmosphere: Atmosphere,
        source_altitude_m: f64,
        ground_altitude_m: f64,
        ground_albedo: f64,
    ) -> Result<Self, PhysicsError> {
        let highest_m = atmosphere
            .cloud()
            .map_or(f64::INFINITY, |cloud| cloud.altitude_m() - MIN_BELOW_BASE_M)
            .min(MAX_SOURCE_M);
        check_range("source_altitude", source_altitude_m, -2_000.0, highest_m, "m")?;
        check_range("ground_altitude", ground_altitude_m, -2_000.0, source_altitude_m, "m")?;
        check_range("ground_albedo", ground_albedo, 0.0, 1.0, "")?;
        Ok(Self { atmosphere, source_altitude_m, ground_altitude_m, ground_albedo, blocking_rad: 0.0 })
    }

    /// The same with the source behind a skyline.
    ///
    /// # Errors
    /// [`PhysicsError::OutOfRange`] naming `blocking_angle`.
    pub fn behind(self, blocking_rad: f64) -> Result<Self, PhysicsError> {
        check_range("blocking_angle", blocking_rad, 0.0, std::f64::consts::FRAC_PI_2, "rad")?;
        Ok(Self { blocking_rad, ..self })
    }

    /// The setting of a source and an observer: the ground through the lower of the two.
    ///
    /// # Errors
    /// As [`Self::new`].
    pub fn for_observer(
        atmosphere: Atmosphere,
        source_altitude_m: f64,
        observer_altitude_m: f64,
        ground_albedo: f64,
    ) -> Result<Self, PhysicsError> {
        Self::new(atmosphere, source_altitude_m, source_altitude_m.min(observer_altitude_m), ground_albedo)
    }
}

/// How finely a field is solved.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Resolution {
    /// Step between rings in ln(1 + ρ/60 m) + ρ/100 km.
    pub ring_step: f64,
    /// Parts into which each gap between layers is cut.
    pub layer_cuts: usize,
    /// Highest degree of the moments of first-order light.
    pub first_degree: usize,
    /// Highest degree of the moments of all later orders.
    pub later_degree: usize,
    /// First-order directions: from the source's direction, and around it in a half turn.
    pub first_polar: usize,
    /// See `first_polar`.
    pub first_around: usize,
    /// Gauss nodes in each piece of a first-order ray.
    pub first_along: usize,
    /// Zenith angles of later orders in each hemisphere: from 16 on a multiple of 4, for they are in four pieces then.
    pub polar_per_hemisphere: usize,
    /// Azimuths of later orders in a half turn, at least a quarter more than `later_degree`: with fewer the
    /// moments alias (23 % at 50 km in thick haze with 10 for degree 12).
    pub azimuths: usize,
    /// Orders are computed until one adds less than this share of the source function anywhere within 300 km;
    /// the rest is summed as a geometric series. At turbidity 4, 0.05 instead of 0.005 moves no direction at
    /// 50 and 100 km by more than 2e-3 of its radiance; at turbidity 6 it moves one by 5e-3, 0.1 by 2e-2 and 0.15 by 4e-2
    /// at 50 km.
    pub tolerance: f64,
    /// No more orders than this; the rest is summed as a geometric series.
    pub max_orders: usize,
}

impl Resolution {
    /// For tables: seconds a field.
    pub fn table() -> Self {
        Self {
            ring_step: 0.2,
            layer_cuts: 1,
            first_degree: 24,
            later_degree: 14,
            first_polar: 20,
            first_around: 12,
            first_along: 5,
            polar_per_hemisphere: 16,
            azimuths: 18,
            tolerance: 0.05,
            max_orders: 16,
        }
    }

    /// For the reference solution: about a minute a field.
    pub fn reference() -> Self {
        Self {
            ring_step: 0.11,
            layer_cuts: 2,
            first_degree: 36,
            later_degree: 20,
            first_polar: 36,
            first_around: 26,
            first_along: 8,
            polar_per_hemisphere: 24,
            azimuths: 28,
            tolerance: 1e-3,
            max_orders: 20,
        }
    }

    /// For tests and for ratios of two fields, in which most of what it has wrong cancels: a coarse field in a second or
    /// two. Packs rest on it (`later` of their manifests): raise the model's version with it.
    pub fn coarse() -> Self {
        Self {
            ring_step: 0.4,
            first_degree: 14,
            first_polar: 14,
            first_around: 8,
            first_along: 4,
            later_degree: 6,
            polar_per_hemisphere: 6,
            azimuths: 10,
            max_orders: 6,
            ..Self::table()
        }
    }
}
