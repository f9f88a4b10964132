//! Spectra of lamps.

use super::{
    Colour, Response, STEP_NM, Spectrum, lamp_tables as tables, response::PHOTOPIC_LM_W, wavelength_nm,
};

/// A lamp whose spectrum is known from 380 to 780 nm.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum LampSpectrum {
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
    Led2700k,
    /// White LED, CIE LED-B2, 2 998 K.
    Led3000k,
    /// White LED, CIE LED-B3, 4 103 K.
    Led4000k,
    /// White LED, CIE LED-B4, 5 109 K.
    Led5000k,
    /// White LED, CIE LED-B5, 6 598 K.
    Led6500k,
    /// Blue LED with phosphor and a red LED, CIE LED-BH1, 2 851 K.
    LedHybrid,
    /// Red, green and blue LEDs, CIE LED-RGB1, 2 840 K.
    LedRgb,
    /// Violet LED with phosphors, CIE LED-V1, 2 724 K.
    LedViolet2700k,
    /// Violet LED with phosphors, CIE LED-V2, 4 070 K.
    LedViolet4000k,
    /// Metal halide, CIE HP3, 3 144 K.
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

impl LampSpectrum {
    /// All, in the order of the model's table.
    pub const ALL: [LampSpectrum; 20] = [
        LampSpectrum::Incandescent,
        LampSpectrum::Hps,
        LampSpectrum::HpsColourEnhanced,
        LampSpectrum::Lps,
        LampSpectrum::PcAmber,
        LampSpectrum::Led2700k,
        LampSpectrum::Led3000k,
        LampSpectrum::Led4000k,
        LampSpectrum::Led5000k,
        LampSpectrum::Led6500k,
        LampSpectrum::LedHybrid,
        LampSpectrum::LedRgb,
        LampSpectrum::LedViolet2700k,
        LampSpectrum::LedViolet4000k,
        LampSpectrum::MetalHalide3000k,
        LampSpectrum::MetalHalide,
        LampSpectrum::MetalHalideCeramic,
        LampSpectrum::Mercury,
        LampSpectrum::Fluorescent,
        LampSpectrum::FluorescentThreeBand,
    ];

    /// The name in requests, answers and files.
    pub const fn name(self) -> &'static str {
        match self {
            LampSpectrum::Incandescent => "incandescent",
            LampSpectrum::Hps => "hps",
            LampSpectrum::HpsColourEnhanced => "hps_colour_enhanced",
            LampSpectrum::Lps => "lps",
            LampSpectrum::PcAmber => "pc_amber",
            LampSpectrum::Led2700k => "led_2700k",
            LampSpectrum::Led3000k => "led_3000k",
            LampSpectrum::Led4000k => "led_4000k",
            LampSpectrum::Led5000k => "led_5000k",
            LampSpectrum::Led6500k => "led_6500k",
            LampSpectrum::LedHybrid => "led_hybrid",
            LampSpectrum::LedRgb => "led_rgb",
            LampSpectrum::LedViolet2700k => "led_violet_2700k",
            LampSpectrum::LedViolet4000k => "led_violet_4000k",
            LampSpectrum::MetalHalide3000k => "metal_halide_3000k",
            LampSpectrum::MetalHalide => "metal_halide",
            LampSpectrum::MetalHalideCeramic => "metal_halide_ceramic",
            LampSpectrum::Mercury => "mercury",
            LampSpectrum::Fluorescent => "fluorescent",
            LampSpectrum::FluorescentThreeBand => "fluorescent_three_band",
        }
    }

    /// The lamp of that name.
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|lamp| lamp.name() == name)
    }

    /// Relative power per nm.
    pub fn spectrum(self) -> Spectrum {
        Spectrum::from_samples(match self {
            LampSpectrum::Incandescent => &tables::CIE_A,
            LampSpectrum::Hps => &tables::CIE_HP1,
            LampSpectrum::HpsColourEnhanced => &tables::CIE_HP2,
            LampSpectrum::Lps => return sodium_doublet(),
            LampSpectrum::PcAmber => return amber_phosphor(),
            LampSpectrum::Led2700k => &tables::CIE_LED_B1,
            LampSpectrum::Led3000k => &tables::CIE_LED_B2,
            LampSpectrum::Led4000k => &tables::CIE_LED_B3,
            LampSpectrum::Led5000k => &tables::CIE_LED_B4,
            LampSpectrum::Led6500k => &tables::CIE_LED_B5,
            LampSpectrum::LedHybrid => &tables::CIE_LED_BH1,
            LampSpectrum::LedRgb => &tables::CIE_LED_RGB1,
            LampSpectrum::LedViolet2700k => &tables::CIE_LED_V1,
            LampSpectrum::LedViolet4000k => &tables::CIE_LED_V2,
            LampSpectrum::MetalHalide3000k => &tables::CIE_HP3,
            LampSpectrum::MetalHalide => &tables::CIE_HP4,
            LampSpectrum::MetalHalideCeramic => &tables::CIE_HP5,
            LampSpectrum::Mercury => &tables::MERCURY,
            LampSpectrum::Fluorescent => &tables::CIE_FL4,
            LampSpectrum::FluorescentThreeBand => &tables::CIE_FL11,
        })
    }

    /// Colour and scotopic ratio.
    pub fn colour(self) -> Option<Colour> {
        Colour::of(&self.spectrum())
    }
}

impl Spectrum {
    /// This light scaled so that the satellite sees a watt of it: ∫ S·R_DNB dλ = 1. None for light that it does not see.
    ///
    /// Tables of lamps end at 780 nm. What a lamp radiates beyond is seen by the satellite and not by the eye: sodium's line at
    /// 819 nm is a sixth of what it sees of a high-pressure sodium lamp. `beyond_780_nm` is that share, 0 to 0.9.
    pub fn per_dnb_watt(&self, beyond_780_nm: f64) -> Option<Self> {
        let seen = self.integral_with(&Response::Dnb.curve());
        (seen > 0.0).then(|| self.scaled((1.0 - beyond_780_nm.clamp(0.0, 0.9)) / seen))
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

/// The D doublet of sodium, 589.0 and 589.6 nm, between the samples at 585 and 590 nm: the same mean wavelength.
fn sodium_doublet() -> Spectrum {
    const MEAN_NM: f64 = 589.3;
    Spectrum::from_fn(|nm| (1.0 - (nm - MEAN_NM).abs() / STEP_NM).max(0.0) / STEP_NM)
}

/// A phosphor band of Gaussian shape whose lumens per DNB watt and scotopic ratio are those of measured amber LEDs (451 and 0.44).
fn amber_phosphor() -> Spectrum {
    const PEAK_NM: f64 = 604.0;
    const SIGMA_NM: f64 = 33.0;
    let last_nm = wavelength_nm(80);
    Spectrum::from_fn(
        |nm| {
            if nm > last_nm { 0.0 } else { (-0.5 * ((nm - PEAK_NM) / SIGMA_NM).powi(2)).exp() }
        },
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Temperatures that CIE 015 prints beside its illuminants, and scotopic ratios where they are published.
    #[test]
    fn lamps_have_their_published_colour() {
        for (lamp, temperature_k) in [
            (LampSpectrum::Incandescent, 2_856.0),
            (LampSpectrum::Hps, 1_959.0),
            (LampSpectrum::HpsColourEnhanced, 2_506.0),
            (LampSpectrum::MetalHalide3000k, 3_144.0),
            (LampSpectrum::MetalHalide, 4_002.0),
            (LampSpectrum::MetalHalideCeramic, 4_039.0),
            (LampSpectrum::Led2700k, 2_733.0),
            (LampSpectrum::Led3000k, 2_998.0),
            (LampSpectrum::Led4000k, 4_103.0),
            (LampSpectrum::Led5000k, 5_109.0),
            (LampSpectrum::Led6500k, 6_598.0),
            (LampSpectrum::LedHybrid, 2_851.0),
            (LampSpectrum::LedRgb, 2_840.0),
            (LampSpectrum::LedViolet2700k, 2_724.0),
            (LampSpectrum::LedViolet4000k, 4_070.0),
            (LampSpectrum::Fluorescent, 2_940.0),
            (LampSpectrum::FluorescentThreeBand, 4_000.0),
        ] {
            let found = lamp.colour().unwrap().temperature_k.unwrap();
            assert!((found / temperature_k - 1.0).abs() < 0.006, "{}: {found:.0} K", lamp.name());
        }
        let ratio = |lamp: LampSpectrum| lamp.colour().unwrap().scotopic_photopic_ratio;
        for (lamp, published) in
            [(LampSpectrum::Incandescent, 1.41), (LampSpectrum::Lps, 0.23), (LampSpectrum::PcAmber, 0.44)]
        {
            assert!((ratio(lamp) / published - 1.0).abs() < 0.05, "{}: {}", lamp.name(), ratio(lamp));
        }
        for lamp in LampSpectrum::ALL {
            assert_eq!(LampSpectrum::from_name(lamp.name()), Some(lamp));
        }
    }

    #[test]
    fn a_dnb_watt_is_what_the_satellite_sees() {
        let dnb = Response::Dnb.curve();
        for lamp in LampSpectrum::ALL {
            let watt = lamp.spectrum().per_dnb_watt(0.25).unwrap();
            assert!((watt.integral_with(&dnb) - 0.75).abs() < 1e-12, "{}", lamp.name());
        }
        assert_eq!(Spectrum::from_fn(|nm| f64::from(u8::from(nm < 470.0))).per_dnb_watt(0.0), None);
    }

    #[test]
    fn mixes_have_their_shares_of_lumens() {
        let [sodium, led] = [LampSpectrum::Hps, LampSpectrum::Led4000k].map(LampSpectrum::spectrum);
        let mixed = Spectrum::mix_by_lumens(&[(&sodium, 3.0), (&led, 1.0)]).unwrap();
        assert!((mixed.lumens() - 1.0).abs() < 1e-12);
        let ratio = |light: &Spectrum| Colour::of(light).unwrap().scotopic_photopic_ratio;
        // Scotopic lumens add up.
        assert!((ratio(&mixed) - (0.75 * ratio(&sodium) + 0.25 * ratio(&led))).abs() < 1e-12);
        assert_eq!(Spectrum::mix_by_lumens(&[(&Spectrum::from_fn(|_| 0.0), 1.0)]), None);
        assert_eq!(Spectrum::mix_by_lumens(&[(&led, 0.0)]), None);
    }
}
