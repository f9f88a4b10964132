//! What one response sees of a sky.

use crate::{photometry::brightness_mag_arcsec2, sky_sums::Sums, spectrum::Response, surfaces::SurfaceLight};
use serde::{Deserialize, Serialize};

/// What a response sees at the zenith.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
pub struct ZenithValue {
    /// Which.
    pub response: String,
    /// Unit of the values.
    pub unit: String,
    /// Of artificial light.
    pub value: f64,
    /// With the natural sky.
    pub total: f64,
    /// Magnitude of the value in the response's own system; null where it has none.
    pub brightness_mag_arcsec2: Option<f64>,
    /// Magnitude of the total.
    pub total_brightness_mag_arcsec2: Option<f64>,
}

impl ZenithValue {
    pub(crate) fn new(response: &Response, value: f64, natural: f64) -> Self {
        let magnitude =
            |value: f64| response.has_magnitude().then(|| brightness_mag_arcsec2(value)).flatten();
        Self {
            response: response.name().to_owned(),
            unit: response.unit().to_owned(),
            value,
            total: value + natural,
            brightness_mag_arcsec2: magnitude(value),
            total_brightness_mag_arcsec2: magnitude(value + natural),
        }
    }
}

/// The numbers of a sky as one response sees it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
pub struct ResponseQuantities {
    /// Which.
    pub response: String,
    /// Unit of all but the sums over directions, which are in that times sr.
    pub unit: String,
    /// Mean within 5° of the zenith, of artificial light.
    pub zenith: f64,
    /// With the natural sky.
    pub zenith_total: f64,
    /// Magnitude of the zenith in the response's own system; null where it has none.
    pub zenith_brightness_mag_arcsec2: Option<f64>,
    /// With the natural sky.
    pub zenith_total_brightness_mag_arcsec2: Option<f64>,
    /// Mean over the visible sky, of artificial light.
    pub mean: f64,
    /// ∫ sin(elevation) dΩ over the visible sky, of artificial light: an illuminance where the unit is that of a luminance.
    pub horizontal: f64,
    /// With the natural sky.
    pub horizontal_total: f64,
    /// Largest, of artificial light.
    pub brightest: f64,
}

impl ResponseQuantities {
    pub(crate) fn new(response: &Response, sums: &Sums, natural: f64, surfaces: &SurfaceLight) -> Self {
        let zenith = ZenithValue::new(response, sums.zenith, natural);
        Self {
            response: zenith.response,
            unit: zenith.unit,
            zenith: zenith.value,
            zenith_total: zenith.total,
            zenith_brightness_mag_arcsec2: zenith.brightness_mag_arcsec2,
            zenith_total_brightness_mag_arcsec2: zenith.total_brightness_mag_arcsec2,
            mean: sums.mean,
            horizontal: surfaces.artificial.horizontal,
            horizontal_total: surfaces.total.horizontal,
            brightest: sums.brightest,
        }
    }
}
