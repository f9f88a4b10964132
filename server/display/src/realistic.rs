//! The sky as a camera would show it: X, Y, Z to sRGB at a fixed exposure.

/// Allowed exposures, stops.
pub const EXPOSURE_RANGE_EV: (f64, f64) = (-12.0, 12.0);
/// Luminance that an exposure of 0 EV shows as middle grey, cd m⁻²: a suburban zenith of about 20.1 mag arcsec⁻². A reflected-light meter
/// (ISO 2720, K = 12.5: L = 12.5 N²/(t S)) sets f/2, 15 s and ISO 3 200 for it, as people set cameras for the night sky.
pub const MIDDLE_GREY_LUMINANCE_CD_M2: f64 = 1e-3;
/// Time of 0 EV at f/2 and ISO 3 200.
const EXPOSURE_TIME_S: f64 = 15.0;
/// Middle grey, of display white.
const MIDDLE_GREY: f64 = 0.18;

/// The film's curve is Lottes' (2016): z = x^a/(b x^(ad) + c), of x in times middle grey, with b and c for middle grey and white. Its
/// contrast a lets a dark sky stay dark; its shoulder d is long, so that the sky of a bright city keeps its shape.
const CONTRAST: f64 = 1.15;
const SHOULDER: f64 = 0.85;
/// What becomes display white: ten stops above middle grey.
const FILM_WHITE: f64 = 1024.0;

/// Steps of display white with a byte known in advance: few enough bytes start within one that a search is short.
const STEPS: usize = 2048;

/// XYZ from linear sRGB primaries, D65 (IEC 61966-2-1), inverted.
pub(crate) const SRGB_FROM_XYZ: [[f64; 3]; 3] = [
    [3.240_454_2, -1.537_138_5, -0.498_531_4],
    [-0.969_266_0, 1.876_010_8, 0.041_556_0],
    [0.055_643_4, -0.204_025_9, 1.057_225_2],
];

/// The same where light of 4 200 K is white, as photographers set it at night: the adaptation of X, Y, Z from (0.3720, 0.3713), a black
/// body's, to D65 by Bradford's matrix (Lam 1985; Lindbloom) comes first.
const CAMERA_FROM_XYZ: [[f64; 3]; 3] = [
    [3.053_749_2, -1.725_653_2, -0.482_897_0],
    [-1.001_199_1, 1.984_024_8, 0.027_571_7],
    [0.086_249_2, -0.251_268_0, 1.684_889_4],
];

/// Tone mapping at one exposure.
#[derive(Clone, Debug)]
pub struct ToneMap {
    /// Scene luminance of middle grey, cd m⁻².
    reference_luminance_cd_m2: f64,
    film: Film,
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
        let reference_luminance_cd_m2 = MIDDLE_GREY_LUMINANCE_CD_M2 / exposure_ev.exp2();
        Self { reference_luminance_cd_m2, film: Film::default(), bytes: SrgbBytes::default() }
    }

    /// sRGB bytes of tristimulus values X, Y, Z [cd m⁻²] of the CIE 1931 observer.
    ///
    /// Colours outside sRGB move towards grey of their own luminance until they fit. The film curve is that of the
    /// brightest channel; the others keep their ratio to it and come up to it as it nears white.
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
            let row = &CAMERA_FROM_XYZ[channel];
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
        let shown = self.film.shown(brightest);
        let whiteness = shown.powi(4);
        inside.map(|channel| {
            let ratio = channel / brightest;
            shown * (ratio + (1.0 - ratio) * whiteness)
        })
    }
}

/// The film's curve through middle grey and white.
#[derive(Clone, Copy, Debug)]
struct Film {
    slope: f64,
    toe: f64,
}

impl Default for Film {
    fn default() -> Self {
        let white = FILM_WHITE.powf(CONTRAST);
        let shoulder = white.powf(SHOULDER);
        let scale = MIDDLE_GREY * (shoulder - 1.0);
        Self { slope: (white * MIDDLE_GREY - 1.0) / scale, toe: (shoulder - white * MIDDLE_GREY) / scale }
    }
}

impl Film {
    /// Part of display white of light in times middle grey, above 0.
    fn shown(self, light: f64) -> f64 {
        let logarithm = CONTRAST * light.min(FILM_WHITE).ln();
        (logarithm.exp() / (self.slope * (SHOULDER * logarithm).exp() + self.toe)).min(1.0)
    }
}

/// The settings of a camera that exposes as a picture does: a stop more is twice the time.
pub(crate) fn camera_settings(exposure_ev: f64) -> String {
    let time_s = EXPOSURE_TIME_S * exposure_ev.exp2();
    let digits = |value: f64| {
        let decimals = usize::from(value < 9.95);
        let text = format!("{value:.decimals$}");
        text.trim_end_matches(".0").to_owned()
    };
    let time = match time_s {
        ..0.7 => format!("1/{:.0} s", 1.0 / time_s),
        ..59.5 => format!("{} s", digits(time_s)),
        ..3570.0 => format!("{} min", digits(time_s / 60.0)),
        _ => format!("{} h", digits(time_s / 3600.0)),
    };
    format!("ISO 3200, f/2, {time}")
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

    /// X, Y, Z of what the camera takes for white.
    fn white(luminance: f64) -> [f64; 3] {
        [0.3720, 0.3713, 1.0 - 0.3720 - 0.3713].map(|part| luminance * part / 0.3713)
    }

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

    /// Middle grey is 18 percent and every stop doubles the light.
    #[test]
    fn middle_grey_is_18_percent_and_stops_double() {
        let grey = ToneMap::new(0.0).rgb(white(MIDDLE_GREY_LUMINANCE_CD_M2));
        // 18 % of white is the byte 118.
        assert_eq!(grey, [118; 3]);
        let dimmer_longer = ToneMap::new(1.0).rgb(white(0.5 * MIDDLE_GREY_LUMINANCE_CD_M2));
        assert_eq!(grey, dimmer_longer);
    }

    /// The sky of a city keeps its shape at 0 EV: from its zenith to its horizon every stop is another grey, short of white.
    #[test]
    fn a_bright_city_keeps_its_shape() {
        let map = ToneMap::new(0.0);
        let greys: Vec<u8> = (0..6).map(|stop| map.rgb(white(0.008 * f64::from(stop).exp2()))[1]).collect();
        assert!(greys.windows(2).all(|pair| pair[1] >= pair[0] + 8), "{greys:?}");
        assert!(greys[0] < 200 && greys[5] < 250, "{greys:?}");
        // A pristine sky is a dark grey.
        assert!((45..75).contains(&map.rgb(white(2.5e-4))[1]));
    }

    /// White balance is Bradford's adaptation before the sRGB matrix.
    #[test]
    fn white_balance_is_bradfords() {
        let bradford = [[0.8951, 0.2664, -0.1614], [-0.7502, 1.7135, 0.0367], [0.0389, -0.0685, 1.0296]];
        let times = |matrix: &[[f64; 3]; 3], v: [f64; 3]| {
            matrix.map(|row| row.iter().zip(v).map(|(m, v)| m * v).sum::<f64>())
        };
        let cones = |xyz: [f64; 3]| times(&bradford, xyz);
        let [of_camera, of_display] = [white(1.0), [0.950_47, 1.0, 1.088_83]].map(cones);
        for display in [[0.3, 0.2, 0.1], [0.1, 0.3, 0.6], [0.5, 0.5, 0.5]] {
            let scaled = std::array::from_fn(|i| cones(display)[i] * of_camera[i] / of_display[i]);
            let linear = times(&CAMERA_FROM_XYZ, inverse(&bradford, scaled));
            for (camera, plain) in linear.iter().zip(times(&SRGB_FROM_XYZ, display)) {
                assert!((camera - plain).abs() < 1e-5, "{camera} {plain}");
            }
        }
    }

    /// What a matrix makes `wanted` of, by Cramer's rule.
    fn inverse(matrix: &[[f64; 3]; 3], wanted: [f64; 3]) -> [f64; 3] {
        let determinant = |m: [[f64; 3]; 3]| {
            (0..3)
                .map(|i| {
                    m[0][i] * (m[1][(i + 1) % 3] * m[2][(i + 2) % 3] - m[1][(i + 2) % 3] * m[2][(i + 1) % 3])
                })
                .sum::<f64>()
        };
        std::array::from_fn(|column| {
            let replaced = std::array::from_fn(|row| {
                std::array::from_fn(|i| if i == column { wanted[row] } else { matrix[row][i] })
            });
            determinant(replaced) / determinant(*matrix)
        })
    }

    /// A meter of K = 12.5 sets what the words say, and times are told as cameras have them.
    #[test]
    fn exposures_are_told_as_photographers_do() {
        let metered_cd_m2 = 12.5 * 2.0 * 2.0 / (EXPOSURE_TIME_S * 3200.0);
        assert!((metered_cd_m2 / MIDDLE_GREY_LUMINANCE_CD_M2).log2().abs() < 0.1);
        for (exposure_ev, time) in [
            (0.0, "15 s"),
            (1.0, "30 s"),
            (0.5, "21 s"),
            (2.0, "1 min"),
            (-4.0, "0.9 s"),
            (-6.0, "1/4 s"),
            (9.0, "2.1 h"),
        ] {
            assert_eq!(camera_settings(exposure_ev), format!("ISO 3200, f/2, {time}"));
        }
    }

    /// Sodium is orange and a 4000 K LED is whiter.
    #[test]
    fn sodium_is_orange_and_led_whiter() {
        let map = ToneMap::new(0.0);
        let sodium = map.rgb(light_of(LampPreset::Hps.lamp(), 1e-3));
        assert!(sodium[0] > sodium[1] + 30 && sodium[1] > sodium[2] + 50, "{sodium:?}");
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
