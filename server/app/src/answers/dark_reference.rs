//! The dark reference that an answer rests on.

use serde::Serialize;
use skyglow_celestial::heavens::DEFAULT_SOLAR_FLUX_SFU;
use skyglow_physics::{EvenSky, Response, photometry::brightness_mag_arcsec2};
use utoipa::ToSchema;

/// The natural sky of no time in particular, overhead: no Moon, no twilight, zodiacal light and starlight in the mean. Totals have it in
/// every direction where no time is asked for; Bortle's classes always count from it.
#[derive(Clone, Debug, Serialize, ToSchema)]
pub struct DarkReferenceAnswer {
    /// Between the stars, cd m⁻².
    pub luminance_cd_m2: f64,
    /// The same, mag arcsec⁻².
    pub brightness_mag_arcsec2: Option<f64>,
    /// What a Sky Quality Meter reads of it, the light of stars in its field included, mag arcsec⁻².
    pub sqm_brightness_mag_arcsec2: Option<f64>,
    /// Between the stars as the response sees it, in its unit.
    pub value: f64,
    /// Chromaticity x, y (CIE 1931) between the stars.
    pub chromaticity: Option<[f64; 2]>,
    /// Radio flux of the Sun at 10.7 cm that its airglow goes with, solar flux units.
    pub solar_flux_sfu: f64,
    /// Whether it is seen through the air of the request; false without celestial tables: then it is that outside the air.
    pub is_through_air: bool,
}

impl DarkReferenceAnswer {
    pub(super) fn new(dark: &EvenSky, response: &Response) -> Self {
        let luminance_cd_m2 = dark.luminance_cd_m2();
        Self {
            luminance_cd_m2,
            brightness_mag_arcsec2: brightness_mag_arcsec2(luminance_cd_m2),
            sqm_brightness_mag_arcsec2: brightness_mag_arcsec2(dark.meter_value(&Response::Sqm)),
            value: dark.value(response),
            chromaticity: dark.chromaticity(),
            solar_flux_sfu: DEFAULT_SOLAR_FLUX_SFU,
            is_through_air: dark.is_through_air,
        }
    }
}
