//! The sky as the dark-adapted eye sees it: mesopic brightness (CIE 191:2010), the response of photoreceptors (Naka and Rushton 1966),
//! colour that fades to blue-grey where cones see nothing (Jensen et al. 2000).

use crate::realistic::{SRGB_FROM_XYZ, SrgbBytes};
use skyglow_physics::mesopic::mesopic;

/// Exponent of the response of photoreceptors (Boynton and Whitten 1970).
const RESPONSE_EXPONENT: f64 = 0.73;
/// Mesopic luminance that an eye adapted to the night sees as half of the brightest, cd m⁻². Fixed, so that two skies compare: a sky
/// of 22 mag arcsec⁻² is then a near-black blue-grey, the dome of a city a middle tone, a full moon white.
const HALF_BRIGHTNESS_CD_M2: f64 = 0.25;
/// Chromaticity of what rods alone see: half-way from white (D65) to the blue that painters and viewers choose for moonlight,
/// (0.25, 0.25).
const ROD_CHROMATICITY: [f64; 2] = [0.281, 0.290];

/// X, Y, Z and scotopic luminance, cd m⁻².
pub type Seen = [f64; 4];

/// An eye at one exposure.
#[derive(Clone, Debug)]
pub struct Eye {
    half_brightness_cd_m2: f64,
    bytes: SrgbBytes,
}

impl Eye {
    /// An eye whose pupil lets through `exposure_ev` stops more than one adapted to the night.
    pub fn new(exposure_ev: f64) -> Self {
        Self {
            half_brightness_cd_m2: HALF_BRIGHTNESS_CD_M2 / exposure_ev.exp2(),
            bytes: SrgbBytes::default(),
        }
    }

    /// Linear sRGB, 0..=1, of what is seen.
    pub fn linear(&self, [x, y, z, scotopic]: Seen) -> [f64; 3] {
        let mesopic = mesopic(y, scotopic);
        let power = mesopic.luminance_cd_m2.max(0.0).powf(RESPONSE_EXPONENT);
        let shown = power / (power + self.half_brightness_cd_m2.powf(RESPONSE_EXPONENT));
        if shown <= 0.0 {
            return [0.0; 3];
        }
        let [rod_x, rod_y] = ROD_CHROMATICITY;
        let rods = [rod_x / rod_y, 1.0, (1.0 - rod_x - rod_y) / rod_y];
        let cones = if y > 0.0 { [x / y, 1.0, z / y] } else { rods };
        // Colour is there as far as cones see, and no further.
        let share = mesopic.cone_share;
        let xyz: [f64; 3] = std::array::from_fn(|i| shown * (share * cones[i] + (1.0 - share) * rods[i]));
        let linear = SRGB_FROM_XYZ.map(|row| row.iter().zip(xyz).map(|(m, v)| m * v).sum::<f64>());
        within_display(linear, shown)
    }

    /// sRGB bytes of linear values.
    pub fn encoded(&self, linear: [f64; 3]) -> [u8; 3] {
        linear.map(|channel| self.bytes.of(channel))
    }
}

/// A colour moved towards grey of its own luminance until every channel is 0..=1.
fn within_display(linear: [f64; 3], grey: f64) -> [f64; 3] {
    let mut saturation: f64 = 1.0;
    for channel in linear {
        let room = if channel > grey { 1.0 - grey } else { grey };
        let away = (channel - grey).abs();
        if away > room {
            saturation = saturation.min(room / away);
        }
    }
    linear.map(|channel| (grey + saturation * (channel - grey)).clamp(0.0, 1.0))
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use skyglow_physics::{Lamp, LampPreset, Response};

    /// A lamp's light with a luminance.
    fn lit(preset: LampPreset, luminance_cd_m2: f64) -> Seen {
        let lamp: Lamp = preset.lamp();
        let spectrum = lamp.light().spectrum();
        let scale = luminance_cd_m2 / Response::Photopic.value_of(spectrum);
        [Response::CieX, Response::Photopic, Response::CieZ, Response::Scotopic]
            .map(|response| scale * response.value_of(spectrum))
    }

    fn bytes(seen: Seen) -> [u8; 3] {
        let eye = Eye::new(0.0);
        eye.encoded(eye.linear(seen))
    }

    /// A pristine sky is a near-black blue-grey whatever its light, a city's dome has its lamps' colour, and bright light is white.
    #[test]
    fn night_looks_like_night() {
        for lamp in [LampPreset::Hps, LampPreset::Led5000k] {
            let [red, green, blue] = bytes(lit(lamp, 2e-4));
            assert!(red < green && green < blue && (15..70).contains(&blue), "{red} {green} {blue}");
        }
        let [red, _, blue] = bytes(lit(LampPreset::Hps, 0.3));
        assert!(red > blue + 40, "{red} {blue}");
        assert!(bytes(lit(LampPreset::Led5000k, 3e3)).iter().all(|byte| *byte > 245));
        assert_eq!(bytes([0.0; 4]), [0; 3]);
    }

    proptest! {
        /// More light is never darker in the display's luminance.
        #[test]
        fn more_light_is_never_darker(exponent in -6.0..3.0_f64, more in 1.0..10.0_f64) {
            let eye = Eye::new(0.0);
            let luminance = |seen: Seen| {
                let [red, green, blue] = eye.linear(seen);
                0.2126 * red + 0.7152 * green + 0.0722 * blue
            };
            let seen = lit(LampPreset::Mixed, 10f64.powf(exponent));
            prop_assert!(luminance(seen.map(|value| value * more)) >= luminance(seen) - 1e-6);
        }

        #[test]
        fn every_channel_fits_the_display(x in 0.0..2.0_f64, y in 0.0..2.0_f64, z in 0.0..2.0_f64, s in 0.0..5.0_f64) {
            prop_assert!(Eye::new(3.0).linear([x, y, z, s]).iter().all(|channel| (0.0..=1.0).contains(channel)));
        }
    }
}
