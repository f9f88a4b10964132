//! The sky as the eye sees it: mesopic brightness (CIE 191:2010), the response of photoreceptors (Naka and Rushton 1966) adapted to the
//! sky, though never wholly (equivalent background, Crawford 1947), and shown before a dark surround (Bartleson and Breneman 1967), colour that fades to blue-grey where cones see nothing (Jensen et
//! al. 2000).

use crate::realistic::{SRGB_FROM_XYZ, SrgbBytes};
use skyglow_physics::mesopic::mesopic;

/// Exponent of the response of photoreceptors (Boynton and Whitten 1970).
const RESPONSE_EXPONENT: f64 = 0.73;
/// Half of the brightest response is at the luminance adapted to, cd m⁻², to this power: by eye, so that a dark sky is near-black, a
/// city's a dark grey and dusk a middle tone.
const ADAPTATION_EXPONENT: f64 = 0.8;
/// Adaptation to the dark stays incomplete: what an eye saw before acts like a background of this luminance, cd m⁻² (Stiles and
/// Crawford 1932, Crawford 1947). So a darker sky looks darker to an eye that is adapted to it. By eye, as the power is.
const EQUIVALENT_BACKGROUND_CD_M2: f64 = 0.0025;
/// Of contrast: 1.5 is what a picture in the dark needs, and the rest is by eye, so that the Milky Way stands out as it does outside.
const CONTRAST_EXPONENT: f64 = 2.0;
/// Chromaticity of what rods alone see: two thirds of the way from white (D65) to the blue that painters and viewers choose for
/// moonlight, (0.25, 0.25). As cones see more, it turns white.
const ROD_CHROMATICITY: [f64; 2] = [0.271, 0.276];
/// Chromaticity of D65.
const WHITE: [f64; 2] = [0.3127, 0.3290];
/// Luminances that an eye can be adapted to, cd m⁻².
pub const ADAPTATION_RANGE_CD_M2: (f64, f64) = (1e-4, 1e5);

/// Less than this is darkness behind a veil, cd m⁻².
const DARK_CD_M2: f64 = 1e-5;

/// How much more an eye is adapted to where a veil lies over a luminance, both together: by as much as the veil brightens it.
pub fn dazzle(luminance_cd_m2: f64, veil_cd_m2: f64) -> f64 {
    1.0 + veil_cd_m2 / (luminance_cd_m2 - veil_cd_m2).max(DARK_CD_M2)
}

/// X, Y, Z and scotopic luminance, cd m⁻².
pub type Seen = [f64; 4];

/// An eye at one exposure that is adapted to a luminance.
#[derive(Clone, Debug)]
pub struct Eye {
    gain: f64,
    adaptation_cd_m2: f64,
    bytes: SrgbBytes,
}

impl Eye {
    /// An eye adapted to `adaptation_cd_m2` whose pupil lets through `exposure_ev` stops more.
    pub fn new(exposure_ev: f64, adaptation_cd_m2: f64) -> Self {
        Self { gain: exposure_ev.exp2(), adaptation_cd_m2, bytes: SrgbBytes::default() }
    }

    /// Linear sRGB, 0..=1, of what is seen, where the eye is adapted to `dazzled` times as much.
    pub fn linear(&self, [x, y, z, scotopic]: Seen, dazzled: f64) -> [f64; 3] {
        let mesopic = mesopic(y, scotopic);
        let adaptation_cd_m2 = (self.adaptation_cd_m2 * dazzled).max(ADAPTATION_RANGE_CD_M2.0);
        let background_cd_m2 = adaptation_cd_m2 + EQUIVALENT_BACKGROUND_CD_M2;
        let half_cd_m2 = background_cd_m2.powf(ADAPTATION_EXPONENT) / self.gain;
        let power = mesopic.luminance_cd_m2.max(0.0).powf(RESPONSE_EXPONENT);
        let shown = (power / (power + half_cd_m2.powf(RESPONSE_EXPONENT))).powf(CONTRAST_EXPONENT);
        if shown <= 0.0 {
            return [0.0; 3];
        }
        let [blue, white] = [ROD_CHROMATICITY, WHITE].map(|[x, y]| [x / y, 1.0, (1.0 - x - y) / y]);
        // Colour is there as far as cones see, and no further.
        let share = mesopic.cone_share;
        let rods: [f64; 3] = std::array::from_fn(|i| share * white[i] + (1.0 - share) * blue[i]);
        let cones = if y > 0.0 { [x / y, 1.0, z / y] } else { rods };
        let xyz: [f64; 3] = std::array::from_fn(|i| shown * (share * cones[i] + (1.0 - share) * rods[i]));
        let linear = SRGB_FROM_XYZ.map(|row| row.iter().zip(xyz).map(|(m, v)| m * v).sum::<f64>());
        within_display(linear, shown)
    }

    /// Bytes of parts of display white.
    pub(crate) fn bytes(&self) -> &SrgbBytes {
        &self.bytes
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

    fn bytes(seen: Seen, adaptation_cd_m2: f64) -> [u8; 3] {
        let eye = Eye::new(0.0, adaptation_cd_m2);
        eye.encoded(eye.linear(seen, 1.0))
    }

    /// A pristine sky is a near-black blue-grey whatever its light, a city's dome has its lamps' colour, and bright light is white.
    #[test]
    fn night_looks_like_night() {
        for lamp in [LampPreset::Hps, LampPreset::Led5000k] {
            let [red, green, blue] = bytes(lit(lamp, 2e-4), 2e-4);
            assert!(red < green && green < blue && (5..45).contains(&blue), "{red} {green} {blue}");
        }
        let [red, _, blue] = bytes(lit(LampPreset::Hps, 0.3), 0.02);
        assert!(red > blue + 40, "{red} {blue}");
        assert!(bytes(lit(LampPreset::Led5000k, 3e3), 0.02).iter().all(|byte| *byte > 245));
        assert_eq!(bytes([0.0; 4], 2e-4), [0; 3]);
    }

    /// Twice the light of a dark sky, as the Milky Way has, stands out; the same sky is darker to an eye that comes from a town.
    #[test]
    fn the_milky_way_stands_out() {
        let green = |luminance_cd_m2, adaptation_cd_m2| {
            f64::from(bytes(lit(LampPreset::Led5000k, luminance_cd_m2), adaptation_cd_m2)[1])
        };
        let (faint, bright) = (green(2e-4, 2.5e-4), green(4e-4, 2.5e-4));
        assert!(bright > 1.5 * faint && bright > faint + 15.0, "{faint} {bright}");
        assert!(green(2e-4, 2e-2) < 10.0, "{}", green(2e-4, 2e-2));
        let eye = Eye::new(0.0, 2.5e-4);
        assert!(
            eye.linear(lit(LampPreset::Led5000k, 0.1), 9.0)[1]
                < eye.linear(lit(LampPreset::Led5000k, 0.1), 1.0)[1]
        );
    }

    /// The viewer's eye has the same values in a test of its own (`web/src/sky/eye.test.ts`).
    #[test]
    fn the_viewer_has_the_same_eye() {
        for (light, dazzled, adaptation_cd_m2, wanted) in [
            ([2.1e-4, 2e-4, 1.9e-4, 4.6e-4], 1.05, 2.5e-4, [23, 26, 35]),
            ([4.2e-4, 4e-4, 3.9e-4, 9.4e-4], 1.05, 2.5e-4, [40, 45, 57]),
            ([0.034, 0.03, 0.006, 0.02], 1.1, 0.02, [109, 100, 109]),
            ([0.35, 0.3, 0.05, 0.2], 1.5, 0.02, [245, 183, 149]),
            ([1.9, 2.0, 2.2, 4.8], 1.5, 1.0, [156, 157, 158]),
            ([2400.0, 2500.0, 2700.0, 6000.0], 1000.0, 0.01, [255, 251, 251]),
        ] {
            let eye = Eye::new(0.0, adaptation_cd_m2);
            let rgb = eye.encoded(eye.linear(light, dazzled));
            assert!(
                rgb.iter().zip(wanted).all(|(byte, wanted)| byte.abs_diff(wanted) <= 1),
                "{rgb:?} for {wanted:?}"
            );
        }
    }

    proptest! {
        /// More light is never darker in the display's luminance.
        #[test]
        fn more_light_is_never_darker(exponent in -6.0..3.0_f64, more in 1.0..10.0_f64) {
            let eye = Eye::new(0.0, 1e-3);
            let luminance = |seen: Seen| {
                let [red, green, blue] = eye.linear(seen, 1.0);
                0.2126 * red + 0.7152 * green + 0.0722 * blue
            };
            let seen = lit(LampPreset::Mixed, 10f64.powf(exponent));
            prop_assert!(luminance(seen.map(|value| value * more)) >= luminance(seen) - 1e-6);
        }

        #[test]
        fn every_channel_fits_the_display(x in 0.0..2.0_f64, y in 0.0..2.0_f64, z in 0.0..2.0_f64, s in 0.0..5.0_f64) {
            prop_assert!(Eye::new(3.0, 1e-3).linear([x, y, z, s], 1.0).iter().all(|channel| (0.0..=1.0).contains(channel)));
        }
    }
}
