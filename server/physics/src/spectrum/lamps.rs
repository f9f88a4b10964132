//! Spectra of lamps.

use serde::{Deserialize, Serialize};

use super::{
    Colour, Response, STEP_NM, Spectrum, lamp_tables as tables,
    response::{PHOTOPIC_LM_W, planck},
};

/// A lamp that has a name.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum LampPreset {
    /// One watt in each 100 nm from 400 to 700 nm, whatever the satellite sees of it: for tests.
    Neutral,
    /// Half `hps`, half `led_4000k`, by what the satellite sees: the default.
    Mixed,
    /// Incandescent, CIE A.
    Incandescent,
    /// High-pressure sodium, CIE HP1.
    Hps,
    /// Colour-enhanced high-pressure sodium, CIE HP2.
    HpsColourEnhanced,
    /// Low-pressure sodium: the D doublet.
    Lps,
    /// LED with an amber phosphor that leaves no blue.
    PcAmber,
    /// White LED, CIE LED-B1, 2 733 K.
    #[serde(rename = "led_2700k")]
    Led2700k,
    /// White LED, CIE LED-B2, 2 998 K.
    #[serde(rename = "led_3000k")]
    Led3000k,
    /// White LED, CIE LED-B3, 4 103 K.
    #[serde(rename = "led_4000k")]
    Led4000k,
    /// White LED, CIE LED-B4, 5 109 K.
    #[serde(rename = "led_5000k")]
    Led5000k,
    /// White LED, CIE LED-B5, 6 598 K.
    #[serde(rename = "led_6500k")]
    Led6500k,
    /// Blue LED with phosphor and a red LED, CIE LED-BH1, 2 851 K.
    LedHybrid,
    /// Red, green and blue LEDs, CIE LED-RGB1, 2 840 K.
    LedRgb,
    /// Violet LED with phosphors, CIE LED-V1, 2 724 K.
    #[serde(rename = "led_violet_2700k")]
    LedViolet2700k,
    /// Violet LED with phosphors, CIE LED-V2, 4 070 K.
    #[serde(rename = "led_violet_4000k")]
    LedViolet4000k,
    /// Metal halide, CIE HP3, 3 144 K.
    #[serde(rename = "metal_halide_3000k")]
    MetalHalide3000k,
    /// Metal halide, CIE HP4, 4 002 K.
    MetalHalide,
    /// Metal halide, CIE HP5, 4 039 K.
    MetalHalideCeramic,
    /// Clear mercury vapour.
    Mercury,
    /// Warm white fluorescent, CIE FL4.
    Fluorescent,
    /// Three-band fluorescent, CIE FL11.
    FluorescentThreeBand,
}

impl LampPreset {
    /// All, in the order of the model's table.
    pub const ALL: [LampPreset; 22] = [
        LampPreset::Neutral,
        LampPreset::Mixed,
        LampPreset::Incandescent,
        LampPreset::Hps,
        LampPreset::HpsColourEnhanced,
        LampPreset::Lps,
        LampPreset::PcAmber,
        LampPreset::Led2700k,
        LampPreset::Led3000k,
        LampPreset::Led4000k,
        LampPreset::Led5000k,
        LampPreset::Led6500k,
        LampPreset::LedHybrid,
        LampPreset::LedRgb,
        LampPreset::LedViolet2700k,
        LampPreset::LedViolet4000k,
        LampPreset::MetalHalide3000k,
        LampPreset::MetalHalide,
        LampPreset::MetalHalideCeramic,
        LampPreset::Mercury,
        LampPreset::Fluorescent,
        LampPreset::FluorescentThreeBand,
    ];

    /// The name in requests, answers and files.
    pub const fn name(self) -> &'static str {
        match self {
            LampPreset::Neutral => "neutral",
            LampPreset::Mixed => "mixed",
            LampPreset::Incandescent => "incandescent",
            LampPreset::Hps => "hps",
            LampPreset::HpsColourEnhanced => "hps_colour_enhanced",
            LampPreset::Lps => "lps",
            LampPreset::PcAmber => "pc_amber",
            LampPreset::Led2700k => "led_2700k",
            LampPreset::Led3000k => "led_3000k",
            LampPreset::Led4000k => "led_4000k",
            LampPreset::Led5000k => "led_5000k",
            LampPreset::Led6500k => "led_6500k",
            LampPreset::LedHybrid => "led_hybrid",
            LampPreset::LedRgb => "led_rgb",
            LampPreset::LedViolet2700k => "led_violet_2700k",
            LampPreset::LedViolet4000k => "led_violet_4000k",
            LampPreset::MetalHalide3000k => "metal_halide_3000k",
            LampPreset::MetalHalide => "metal_halide",
            LampPreset::MetalHalideCeramic => "metal_halide_ceramic",
            LampPreset::Mercury => "mercury",
            LampPreset::Fluorescent => "fluorescent",
            LampPreset::FluorescentThreeBand => "fluorescent_three_band",
        }
    }

    /// The lamp of that name.
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|lamp| lamp.name() == name)
    }

    /// What it radiates beyond the 780 nm where tables end: its share of what the satellite sees, which makes lumens per DNB watt those
    /// of measured lamps, and its shape. Sodium has a pair of lines there; of mercury nothing finer is known, so it is even.
    fn beyond_780_nm(self) -> Option<(f64, Spectrum)> {
        match self {
            LampPreset::Hps | LampPreset::HpsColourEnhanced => Some((0.164, line(819.1))),
            LampPreset::Mercury => {
                Some((0.15, Spectrum::from_fn(|nm| f64::from(u8::from(nm > LAST_OF_TABLES_NM)))))
            }
            _ => None,
        }
    }

    /// Power per nm of as much light as the satellite sees a watt of.
    pub fn spectrum(self) -> Spectrum {
        let watt = |light: Spectrum| light.per_dnb_watt().unwrap_or(light);
        match self {
            LampPreset::Neutral => Response::Band { from_nm: 400, to_nm: 700 }.curve().scaled(0.01),
            LampPreset::Mixed => LampPreset::Hps.spectrum().sum(&LampPreset::Led4000k.spectrum()).scaled(0.5),
            lamp => {
                let table = watt(lamp.shape());
                lamp.beyond_780_nm().map_or(table.clone(), |(share, beyond)| {
                    table.scaled(1.0 - share).sum(&watt(beyond).scaled(share))
                })
            }
        }
    }

    /// Relative power per nm: a table, or a law.
    fn shape(self) -> Spectrum {
        Spectrum::from_samples(match self {
            LampPreset::Incandescent => return Spectrum::from_fn(|nm| planck(nm, CIE_A_K)),
            LampPreset::Hps => &tables::CIE_HP1,
            LampPreset::HpsColourEnhanced => &tables::CIE_HP2,
            LampPreset::Lps => return line(589.3),
            LampPreset::PcAmber => return amber_phosphor(),
            LampPreset::Led2700k => &tables::CIE_LED_B1,
            LampPreset::Led3000k => &tables::CIE_LED_B2,
            LampPreset::Led4000k => &tables::CIE_LED_B3,
            LampPreset::Led5000k => &tables::CIE_LED_B4,
            LampPreset::Led6500k => &tables::CIE_LED_B5,
            LampPreset::LedHybrid => &tables::CIE_LED_BH1,
            LampPreset::LedRgb => &tables::CIE_LED_RGB1,
            LampPreset::LedViolet2700k => &tables::CIE_LED_V1,
            LampPreset::LedViolet4000k => &tables::CIE_LED_V2,
            LampPreset::MetalHalide3000k => &tables::CIE_HP3,
            LampPreset::MetalHalide => &tables::CIE_HP4,
            LampPreset::MetalHalideCeramic => &tables::CIE_HP5,
            LampPreset::Mercury => &tables::MERCURY,
            LampPreset::Fluorescent => &tables::CIE_FL4,
            LampPreset::FluorescentThreeBand => &tables::CIE_FL11,
            LampPreset::Neutral | LampPreset::Mixed => &[],
        })
    }

    /// Colour and scotopic ratio.
    pub fn colour(self) -> Option<Colour> {
        Colour::of(&self.spectrum())
    }
}

impl Spectrum {
    /// This light scaled so that the satellite sees a watt of it: ∫ S·R_DNB dλ = 1. None for light that it does not see.
    pub fn per_dnb_watt(&self) -> Option<Self> {
        let seen = self.integral_with(&Response::Dnb.curve());
        (seen > 0.0).then(|| self.scaled(1.0 / seen))
    }

    /// Luminous flux of a spectral flux, lm.
    pub fn lumens(&self) -> f64 {
        PHOTOPIC_LM_W * self.integral_with(&Response::Photopic.curve())
    }

    /// Lights together, each with its share of the lumens; a lumen in all. None where one has no lumens or shares add up to nothing.
    pub fn mix_by_lumens(parts: &[(&Spectrum, f64)]) -> Option<Spectrum> {
        let shares: f64 = parts.iter().map(|(_, share)| share).sum();
        let mut mixed = Spectrum::from_samples(&[]);
        for (light, share) in parts {
            let lumens = light.lumens();
            if !(lumens > 0.0 && *share >= 0.0 && shares > 0.0) {
                return None;
            }
            mixed = mixed.sum(&light.scaled(share / (shares * lumens)));
        }
        (shares > 0.0).then_some(mixed)
    }
}

/// Where tables of lamps end, nm.
const LAST_OF_TABLES_NM: f64 = 780.0;
/// Temperature of CIE A by today's second radiation constant (CIE 015 has 2 848 K with the constant of 1931), K.
const CIE_A_K: f64 = 2_855.496;

/// A line or a narrow pair between two samples, with that mean wavelength: sodium's D doublet at 589.0 and 589.6 nm, its pair at 818.3 and
/// 819.5 nm, the longer one twice as strong.
fn line(mean_nm: f64) -> Spectrum {
    Spectrum::from_fn(|nm| (1.0 - (nm - mean_nm).abs() / STEP_NM).max(0.0) / STEP_NM)
}

/// A phosphor band of Gaussian shape whose lumens per DNB watt and scotopic ratio are those of measured amber LEDs (451 and 0.44).
fn amber_phosphor() -> Spectrum {
    const PEAK_NM: f64 = 604.0;
    const SIGMA_NM: f64 = 33.0;
    Spectrum::from_fn(|nm| {
        if nm > LAST_OF_TABLES_NM { 0.0 } else { (-0.5 * ((nm - PEAK_NM) / SIGMA_NM).powi(2)).exp() }
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Temperatures that CIE 015 prints beside its illuminants, and scotopic ratios where they are published.
    #[test]
    fn lamps_have_their_published_colour() {
        for (lamp, temperature_k) in [
            (LampPreset::Incandescent, 2_856.0),
            (LampPreset::Hps, 1_959.0),
            (LampPreset::HpsColourEnhanced, 2_506.0),
            (LampPreset::MetalHalide3000k, 3_144.0),
            (LampPreset::MetalHalide, 4_002.0),
            (LampPreset::MetalHalideCeramic, 4_039.0),
            (LampPreset::Led2700k, 2_733.0),
            (LampPreset::Led3000k, 2_998.0),
            (LampPreset::Led4000k, 4_103.0),
            (LampPreset::Led5000k, 5_109.0),
            (LampPreset::Led6500k, 6_598.0),
            (LampPreset::LedHybrid, 2_851.0),
            (LampPreset::LedRgb, 2_840.0),
            (LampPreset::LedViolet2700k, 2_724.0),
            (LampPreset::LedViolet4000k, 4_070.0),
            (LampPreset::Fluorescent, 2_940.0),
            (LampPreset::FluorescentThreeBand, 4_000.0),
        ] {
            let found = lamp.colour().unwrap().temperature_k.unwrap();
            assert!((found / temperature_k - 1.0).abs() < 0.006, "{}: {found:.0} K", lamp.name());
        }
        let ratio = |lamp: LampPreset| lamp.colour().unwrap().scotopic_photopic_ratio;
        for (lamp, published) in
            [(LampPreset::Incandescent, 1.41), (LampPreset::Lps, 0.23), (LampPreset::PcAmber, 0.44)]
        {
            assert!((ratio(lamp) / published - 1.0).abs() < 0.05, "{}: {}", lamp.name(), ratio(lamp));
        }
        for lamp in LampPreset::ALL {
            assert_eq!(LampPreset::from_name(lamp.name()), Some(lamp));
        }
    }

    /// Of every lamp the satellite sees a watt, of which what lies beyond the eye's light is a part: of an incandescent lamp a third.
    #[test]
    fn a_dnb_watt_is_what_the_satellite_sees() {
        let dnb = Response::Dnb.curve();
        for lamp in LampPreset::ALL {
            let light = lamp.spectrum();
            let watt = light.per_dnb_watt().unwrap();
            assert!((watt.integral_with(&dnb) - 1.0).abs() < 1e-12, "{}", lamp.name());
            let seen = light.integral_with(&dnb);
            assert!(lamp == LampPreset::Neutral || (seen - 1.0).abs() < 1e-12, "{} {seen}", lamp.name());
            let beyond = light.integral_with(&Spectrum::from_fn(|nm| {
                if nm > LAST_OF_TABLES_NM { dnb.0[((nm - 380.0) / STEP_NM) as usize] } else { 0.0 }
            }));
            let share = match lamp {
                LampPreset::Incandescent => 0.332,
                LampPreset::Hps | LampPreset::HpsColourEnhanced => 0.164,
                LampPreset::Mercury => 0.15,
                LampPreset::Mixed => 0.082,
                _ => 0.0,
            };
            assert!((beyond - share).abs() < 5e-4, "{} {beyond}", lamp.name());
        }
        // CIE A, cut at 780 nm, would have 183.
        assert!((LampPreset::Incandescent.spectrum().lumens() - 122.0).abs() < 0.1);
        assert_eq!(Spectrum::from_fn(|nm| f64::from(u8::from(nm < 470.0))).per_dnb_watt(), None);
    }

    #[test]
    fn mixes_have_their_shares_of_lumens() {
        let [sodium, led] = [LampPreset::Hps, LampPreset::Led4000k].map(LampPreset::spectrum);
        let mixed = Spectrum::mix_by_lumens(&[(&sodium, 3.0), (&led, 1.0)]).unwrap();
        assert!((mixed.lumens() - 1.0).abs() < 1e-12);
        let ratio = |light: &Spectrum| Colour::of(light).unwrap().scotopic_photopic_ratio;
        // Scotopic lumens add up.
        assert!((ratio(&mixed) - (0.75 * ratio(&sodium) + 0.25 * ratio(&led))).abs() < 1e-12);
        assert_eq!(Spectrum::mix_by_lumens(&[(&Spectrum::from_fn(|_| 0.0), 1.0)]), None);
        assert_eq!(Spectrum::mix_by_lumens(&[(&led, 0.0)]), None);
    }
}
