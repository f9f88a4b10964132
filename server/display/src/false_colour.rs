//! False colour: luminance on a fixed logarithmic range.

use crate::error::{DisplayError, check};
use serde::{Deserialize, Serialize};
use skyglow_physics::Response;
use skyglow_physics::photometry::{brightness_mag_arcsec2, luminance_from_brightness_cd_m2};

/// Unit of a colour range's ends. The colours are the same for both: magnitudes are a logarithm of luminance.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Scale {
    /// Ends in cd m⁻², colours linear in the logarithm.
    #[default]
    Luminance,
    /// Ends in mag arcsec⁻², colours linear in magnitudes, the smaller (brighter) end at the bright colour.
    Magnitude,
}

/// Allowed ends of a luminance range, cd m⁻².
pub const LUMINANCE_LIMITS_CD_M2: (f64, f64) = (1e-9, 1e6);
/// Allowed ends of a magnitude range, mag arcsec⁻².
pub const MAGNITUDE_LIMITS_MAG_ARCSEC2: (f64, f64) = (-5.0, 40.0);

impl Scale {
    /// The name used in requests.
    pub const fn name(self) -> &'static str {
        match self {
            Scale::Luminance => "luminance",
            Scale::Magnitude => "magnitude",
        }
    }

    /// `min` and `max` when none are given: 1e-5 to 0.1 cd m⁻² or 15 to 25 mag arcsec⁻², about the same
    /// colours; from a twentieth of the natural sky to the horizon over a large city.
    pub const fn default_ends(self) -> (f64, f64) {
        match self {
            Scale::Luminance => (1e-5, 0.1),
            Scale::Magnitude => (15.0, 25.0),
        }
    }
}

/// The luminances that the two ends of a colour map stand for.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct ColourRange {
    /// Unit of both ends.
    pub scale: Scale,
    /// The smaller number, in the scale's unit.
    pub min: f64,
    /// The larger number, in the scale's unit.
    pub max: f64,
}

impl Default for ColourRange {
    fn default() -> Self {
        Self::of(Scale::default())
    }
}

impl ColourRange {
    /// The fixed default range of a scale.
    pub const fn of(scale: Scale) -> Self {
        let (min, max) = scale.default_ends();
        Self { scale, min, max }
    }

    /// The default range of what a response sees, in its unit: as bright a sky as that of luminances.
    pub fn for_response(scale: Scale, response: &Response) -> Self {
        match (scale, response.unit()) {
            (Scale::Magnitude, _) | (_, "cd m-2") => Self::of(scale),
            (_, "nW cm-2 sr-1") => Self { scale, min: 1e-3, max: 10.0 },
            _ => Self { scale, min: 1e-8, max: 1e-4 },
        }
    }

    /// Checks that both ends are in the scale's limits and in order.
    ///
    /// # Errors
    /// [`DisplayError`] naming `min` or `max`.
    pub fn check(&self) -> Result<(), DisplayError> {
        let ((low, high), unit) = match self.scale {
            Scale::Luminance => (LUMINANCE_LIMITS_CD_M2, " cd/m2"),
            Scale::Magnitude => (MAGNITUDE_LIMITS_MAG_ARCSEC2, " mag/arcsec2"),
        };
        check("min", self.min, low, high, unit)?;
        check("max", self.max, low, high, unit)?;
        if self.min >= self.max {
            return Err(DisplayError::EmptyRange { minimum: self.min, maximum: self.max });
        }
        Ok(())
    }

    /// Luminance at the dark and at the bright end, cd m⁻².
    pub fn luminance_ends_cd_m2(&self) -> (f64, f64) {
        match self.scale {
            Scale::Luminance => (self.min, self.max),
            Scale::Magnitude => {
                (luminance_from_brightness_cd_m2(self.max), luminance_from_brightness_cd_m2(self.min))
            }
        }
    }

    /// Surface brightness at the dark and at the bright end, mag arcsec⁻².
    pub fn brightness_ends_mag_arcsec2(&self) -> (f64, f64) {
        let (dark, bright) = self.luminance_ends_cd_m2();
        let magnitude = |luminance| brightness_mag_arcsec2(luminance).unwrap_or(f64::INFINITY);
        (magnitude(dark), magnitude(bright))
    }

    /// Place of a luminance on the colour map: 0 at the dark end, 1 at the bright end, clamped.
    pub fn position(&self, luminance_cd_m2: f64) -> f64 {
        let (dark, bright) = self.luminance_ends_cd_m2();
        if luminance_cd_m2 <= dark {
            return 0.0;
        }
        ((luminance_cd_m2 / dark).ln() / (bright / dark).ln()).min(1.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_scale_is_logarithmic_and_clamped() {
        let range = ColourRange { scale: Scale::Luminance, min: 1e-4, max: 1e-2 };
        assert!((range.position(1e-3) - 0.5).abs() < 1e-12);
        assert_eq!(range.position(0.0), 0.0);
        assert_eq!(range.position(1e-5), 0.0);
        assert_eq!(range.position(3.0), 1.0);
    }

    #[test]
    fn the_smaller_magnitude_is_the_brighter_colour() {
        let range = ColourRange { scale: Scale::Magnitude, min: 16.0, max: 24.0 };
        let at = |mag| range.position(luminance_from_brightness_cd_m2(mag));
        assert!((at(16.0) - 1.0).abs() < 1e-12 && at(24.0).abs() < 1e-12);
        assert!((at(20.0) - 0.5).abs() < 1e-12);
    }

    #[test]
    fn ranges_that_mean_nothing_are_refused_by_name() {
        let message =
            |min, max| ColourRange { scale: Scale::Luminance, min, max }.check().unwrap_err().to_string();
        assert!(message(0.0, 1.0).contains("min is 0"));
        assert!(message(1e-3, f64::NAN).contains("max is NaN"));
        assert!(message(1e-2, 1e-3).contains("min must be the smaller"));
        assert!(ColourRange::of(Scale::Luminance).check().is_ok());
        assert!(ColourRange::of(Scale::Magnitude).check().is_ok());
    }
}
