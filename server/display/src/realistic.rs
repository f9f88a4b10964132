//! The sky as a camera would show it: X, Y, Z to sRGB at a fixed exposure.

/// Allowed exposures, stops.
pub const EXPOSURE_RANGE_EV: (f64, f64) = (-12.0, 12.0);
/// Luminance that an exposure of 0 EV shows as middle grey (18 % of display white), cd m⁻²: a suburban
/// zenith of about 20.1 mag arcsec⁻². The natural sky is then a dark grey, a city's horizon white.
pub const MIDDLE_GREY_LUMINANCE_CD_M2: f64 = 1e-3;

/// Steps of display white with a byte known in advance: few enough bytes start within one that a search is short.
const STEPS: usize = 2048;

/// XYZ from linear sRGB primaries, D65 (IEC 61966-2-1), inverted.
pub(crate) const SRGB_FROM_XYZ: [[f64; 3]; 3] = [
    [3.240_454_2, -1.537_138_5, -0.498_531_4],
    [-0.969_266_0, 1.876_010_8, 0.041_556_0],
    [0.055_643_4, -0.204_025_9, 1.057_225_2],
];

/// Tone mapping at one exposure.
#[derive(Clone, Debug)]
pub struct ToneMap {
    /// Scene luminance that counts as 1 before the film curve, cd m⁻².
    reference_luminance_cd_m2: f64,
    bytes: SrgbBytes,
}

/// sRGB bytes by parts of display white.
#[derive(Clone, Debug)]
pub(crate) struct SrgbBytes {
    /// The sRGB curve inverted: byte `i + 1` starts at `starts[i]`, of display white.
    starts: [f64; 255],
    /// Bytes of display white's `i / STEPS`, where a search begins.
    first: [u8; STEPS + 1],
}

impl Default for SrgbBytes {
    fn default() -> Self {
        let starts: [f64; 255] = std::array::from_fn(|i| decode_srgb((i as f64 + 0.5) / 255.0));
        let first = std::array::from_fn(|step| {
            starts.partition_point(|&start| start <= step as f64 / STEPS as f64) as u8
        });
        Self { starts, first }
    }
}

impl SrgbBytes {
    /// The byte of a part of display white, 0..=1: the number of bytes that start at or below it.
    #[inline]
    pub(crate) fn of(&self, value: f64) -> u8 {
        let mut byte = self.first[((value * STEPS as f64) as usize).min(STEPS)];
        while self.starts.get(usize::from(byte)).is_some_and(|&start| start <= value) {
            byte += 1;
        }
        byte
    }
}

impl ToneMap {
    /// A tone map `exposure_ev` stops above the reference.
    pub fn new(exposure_ev: f64) -> Self {
        // 1 − exp(−x) is 0.18 at x = 0.198.
        let reference_luminance_cd_m2 =
            MIDDLE_GREY_LUMINANCE_CD_M2 / -(1.0f64 - 0.18).ln() / exposure_ev.exp2();
        Self { reference_luminance_cd_m2, bytes: SrgbBytes::default() }
    }

    /// sRGB bytes of tristimulus values X, Y, Z [cd m⁻²] of the CIE 1931 observer.
    ///
    /// Colours outside sRGB move towards grey of their own luminance until they fit. The film curve 1 − exp(−x)
    /// is that of the brightest channel; the others keep their ratio to it and come up to it as it nears white.
    /// So bright light turns white and keeps its hue on the way, where channels that saturate apart turn orange
    /// yellow.
    pub fn rgb(&self, xyz_cd_m2: [f64; 3]) -> [u8; 3] {
        self.linear(xyz_cd_m2).map(|channel| self.bytes.of(channel))
    }

    /// Bytes of parts of display white.
    pub(crate) fn bytes(&self) -> &SrgbBytes {
        &self.bytes
    }

    /// The same before it becomes bytes: linear sRGB, 0..=1.
    pub(crate) fn linear(&self, xyz_cd_m2: [f64; 3]) -> [f64; 3] {
        let linear: [f64; 3] = std::array::from_fn(|channel| {
            let row = &SRGB_FROM_XYZ[channel];
            row.iter().zip(xyz_cd_m2).map(|(m, v)| m * v).sum::<f64>() / self.reference_luminance_cd_m2
        });
        let grey = 0.2126 * linear[0] + 0.7152 * linear[1] + 0.0722 * linear[2];
        let lowest = linear.iter().copied().fold(f64::INFINITY, f64::min);
        let saturation = if lowest < 0.0 && grey > lowest { grey / (grey - lowest) } else { 1.0 };
        let inside = linear.map(|channel| (grey + saturation * (channel - grey)).max(0.0));
        let brightest = inside.iter().copied().fold(0.0, f64::max);
        if brightest == 0.0 {
            return [0.0; 3];
        }
        let shown = 1.0 - (-brightest).exp();
        let whiteness = shown.powi(4);
        inside.map(|channel| {
            let ratio = channel / brightest;
            shown * (ratio + (1.0 - ratio) * whiteness)
        })
    }
}

/// The sRGB transfer curve inverted: encoded 0..=1 to linear.
pub(crate) fn decode_srgb(encoded: f64) -> f64 {
    if encoded <= 0.040_45 { encoded / 12.92 } else { ((encoded + 0.055) / 1.055).powf(2.4) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use skyglow_physics::{Lamp, LampPreset, spectrum::Colour};

    /// X, Y, Z of a lamp's light with a luminance, cd m⁻².
    fn light_of(lamp: Lamp, luminance: f64) -> [f64; 3] {
        let xyz = Colour::of(lamp.light().spectrum()).unwrap().xyz;
        xyz.map(|value| value * luminance / xyz[1])
    }

    /// Middle grey is 18 percent and every stop doubles the light.
    /// The short search finds the byte of the whole one, at the starts themselves too.
    #[test]
    fn bytes_are_found_where_they_start() {
        let bytes = SrgbBytes::default();
        let whole = |value: f64| bytes.starts.partition_point(|&start| start <= value) as u8;
        let around = |start: &f64| [start.next_down(), *start, start.next_up()];
        let even = (0..=10_000).map(|i| f64::from(i) / 1e4);
        for value in bytes.starts.iter().flat_map(around).chain(even).chain([1.0]) {
            assert_eq!(bytes.of(value), whole(value), "{value}");
        }
        assert_eq!((bytes.of(0.0), bytes.of(1.0)), (0, 255));
    }

    #[test]
    fn middle_grey_is_18_percent_and_stops_double() {
        let grey = ToneMap::new(0.0).rgb(light_of(LampPreset::Neutral.lamp(), MIDDLE_GREY_LUMINANCE_CD_M2));
        // 18 % of white is the byte 118.
        let luminance = [0.2126, 0.7152, 0.0722]
            .iter()
            .zip(grey)
            .map(|(weight, byte)| weight * decode_srgb(f64::from(byte) / 255.0))
            .sum::<f64>();
        assert!((luminance - 0.18).abs() < 0.02, "{grey:?} {luminance}");
        let dimmer_longer =
            ToneMap::new(1.0).rgb(light_of(LampPreset::Neutral.lamp(), 0.5 * MIDDLE_GREY_LUMINANCE_CD_M2));
        assert_eq!(grey, dimmer_longer);
    }

    /// Sodium is orange and a 4000 K LED is whiter.
    #[test]
    fn sodium_is_orange_and_led_whiter() {
        let map = ToneMap::new(0.0);
        let sodium = map.rgb(light_of(LampPreset::Hps.lamp(), 1e-3));
        assert!(sodium[0] > sodium[1] + 30 && sodium[1] > sodium[2] + 60, "{sodium:?}");
        let led = map.rgb(light_of(LampPreset::Led4000k.lamp(), 1e-3));
        assert!(led[2] > sodium[2] && led[0] < sodium[0], "{led:?} {sodium:?}");
    }

    /// Bright light turns white without changing its hue.
    #[test]
    fn bright_light_turns_white_and_keeps_its_hue() {
        let map = ToneMap::new(0.0);
        // Mixing with grey and scaling leave (G − B) / (R − B) as it is.
        let hue = |luminance: f64| {
            let rgb = map.rgb(light_of(LampPreset::Hps.lamp(), luminance));
            let [r, g, b] = rgb.map(|byte| decode_srgb(f64::from(byte) / 255.0));
            (rgb, (r - b) / r, (g - b) / (r - b))
        };
        let (_, _, dim) = hue(3e-4);
        let mut last_saturation = f64::INFINITY;
        for luminance in [3e-4, 1e-3, 2e-3, 4e-3, 7e-3] {
            let (rgb, saturation, bright) = hue(luminance);
            assert!((bright - dim).abs() < 0.05, "{luminance}: {rgb:?} has {bright}, not {dim}");
            assert!(saturation < last_saturation, "{luminance}: {rgb:?}");
            last_saturation = saturation;
        }
        assert_eq!(hue(1.0).0, [255; 3]);
    }

    #[test]
    fn more_light_is_never_darker_and_ends_white() {
        let map = ToneMap::new(0.0);
        let mut last = 0;
        for exponent in -60..=30 {
            let rgb = map.rgb(light_of(LampPreset::Mixed.lamp(), 10f64.powf(f64::from(exponent) / 10.0)));
            let sum = rgb.iter().map(|&c| u32::from(c)).sum::<u32>();
            assert!(sum >= last);
            last = sum;
        }
        assert_eq!(last, 3 * 255);
        assert_eq!(map.rgb([0.0; 3]), [0, 0, 0]);
    }
}
