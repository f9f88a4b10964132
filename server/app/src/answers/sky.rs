//! The numbers of a sky.

use super::Assumptions;
use serde::Serialize;
use skyglow_physics::SkyQuantities;
use utoipa::ToSchema;

/// The numbers of a sky. Luminances are artificial light alone unless the name says `total`, which adds a
/// uniform natural sky of 22.0 mag arcsec⁻². Magnitudes are null for a sky without light. Where terrain hides part of
/// the sky, all are of the visible part. Nothing natural comes through clouds: under them totals are artificial light
/// alone, and what speaks of stars is null.
#[derive(Clone, Debug, Serialize, ToSchema)]
pub struct QuantitiesAnswer {
    /// Mean within 5° of the zenith, cd m⁻².
    pub zenith_luminance_cd_m2: f64,
    /// The same, mag arcsec⁻².
    pub zenith_brightness_mag_arcsec2: Option<f64>,
    /// With the natural sky, cd m⁻².
    pub zenith_total_luminance_cd_m2: f64,
    /// With the natural sky, mag arcsec⁻².
    pub zenith_total_brightness_mag_arcsec2: Option<f64>,
    /// Artificial luminance at the zenith over the natural one of a clear sky.
    pub ratio_to_natural: f64,
    /// As a Sky Quality Meter at the zenith sees it (Gaussian, FWHM 20°), cd m⁻².
    pub sqm_luminance_cd_m2: f64,
    /// What such a meter reads with the natural sky, mag arcsec⁻².
    pub sqm_total_brightness_mag_arcsec2: Option<f64>,
    /// Mean over the visible sky, cd m⁻².
    pub mean_luminance_cd_m2: f64,
    /// Horizontal illuminance by the visible sky, lx.
    pub horizontal_illuminance_lx: f64,
    /// With the natural sky, lx.
    pub horizontal_total_illuminance_lx: f64,
    /// Largest visible luminance, cd m⁻².
    pub brightest_luminance_cd_m2: f64,
    /// Its azimuth, degrees clockwise from north.
    pub brightest_azimuth_deg: f64,
    /// Its elevation, degrees.
    pub brightest_elevation_deg: f64,
    /// Bortle class of the total at the zenith, 1..=9; null under clouds.
    pub bortle_class: Option<u8>,
    /// Naked-eye limiting magnitude at the zenith (Crumey 2014, F = 2); null under clouds.
    pub naked_eye_limit_mag: Option<f64>,
    /// Radiance at the zenith in R, G, B, W m⁻² sr⁻¹.
    pub zenith_radiance_w_m2_sr: [f64; 3],
}

impl From<&SkyQuantities> for QuantitiesAnswer {
    fn from(quantities: &SkyQuantities) -> Self {
        // Taken apart by name, so that a quantity added to the model is not forgotten here.
        let SkyQuantities {
            zenith_luminance_cd_m2,
            zenith_brightness_mag_arcsec2,
            zenith_total_luminance_cd_m2,
            zenith_total_brightness_mag_arcsec2,
            ratio_to_natural,
            sqm_luminance_cd_m2,
            sqm_total_brightness_mag_arcsec2,
            mean_luminance_cd_m2,
            horizontal_illuminance_lx,
            horizontal_total_illuminance_lx,
            brightest_luminance_cd_m2,
            brightest_azimuth_deg,
            brightest_elevation_deg,
            bortle_class,
            naked_eye_limit_mag,
            zenith_radiance_w_m2_sr,
        } = *quantities;
        Self {
            zenith_luminance_cd_m2,
            zenith_brightness_mag_arcsec2,
            zenith_total_luminance_cd_m2,
            zenith_total_brightness_mag_arcsec2,
            ratio_to_natural,
            sqm_luminance_cd_m2,
            sqm_total_brightness_mag_arcsec2,
            mean_luminance_cd_m2,
            horizontal_illuminance_lx,
            horizontal_total_illuminance_lx,
            brightest_luminance_cd_m2,
            brightest_azimuth_deg,
            brightest_elevation_deg,
            bortle_class,
            naked_eye_limit_mag,
            zenith_radiance_w_m2_sr,
        }
    }
}

/// The numbers alone.
#[derive(Clone, Debug, Serialize, ToSchema)]
pub struct SkyAnswer {
    /// What they depend on.
    #[serde(flatten)]
    pub assumptions: Assumptions,
    /// The numbers.
    pub sky: QuantitiesAnswer,
}
