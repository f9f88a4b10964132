//! Lamps: flux of a source in each band per flux seen by the satellite (`docs/model.md#lamps`).

use crate::{
    bands::BAND_COUNT,
    error::{PhysicsError, check_range},
};
use serde::{Deserialize, Serialize};

/// A named lamp. A satellite sees no blue, so the lamp is an assumption that every answer repeats.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum LampPreset {
    /// One watt in every band: for tests.
    Neutral,
    /// High-pressure sodium.
    Hps,
    /// Low-pressure sodium.
    Lps,
    /// Phosphor-converted amber LED.
    PcAmber,
    /// White LED, 3000 K.
    #[serde(rename = "led_3000k")]
    Led3000k,
    /// White LED, 4000 K.
    #[serde(rename = "led_4000k")]
    Led4000k,
    /// Metal halide.
    MetalHalide,
    /// Mercury vapour.
    Mercury,
    /// Half `hps`, half `led_4000k`: the default.
    Mixed,
}

/// Properties of a lamp, from measured spectra and the DNB response.
///
/// In files it is the name of its preset, or its three fluxes.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(into = "StoredLamp", try_from = "StoredLamp")]
pub struct Lamp {
    /// s_b: flux in band b (R, G, B) per flux weighted by the DNB response.
    pub flux_per_dnb_flux: [f64; BAND_COUNT],
    /// Lumens per DNB watt, where known.
    pub lumens_per_dnb_watt: Option<f64>,
    /// Ratio of scotopic to photopic flux, where known.
    pub scotopic_photopic_ratio: Option<f64>,
    /// The preset, or None for a custom lamp.
    pub preset: Option<LampPreset>,
}

/// The form of a lamp in files.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
#[serde(untagged)]
enum StoredLamp {
    Preset(LampPreset),
    Custom([f64; BAND_COUNT]),
}

impl From<Lamp> for StoredLamp {
    fn from(lamp: Lamp) -> Self {
        lamp.preset.map_or(StoredLamp::Custom(lamp.flux_per_dnb_flux), StoredLamp::Preset)
    }
}

impl TryFrom<StoredLamp> for Lamp {
    type Error = PhysicsError;

    fn try_from(stored: StoredLamp) -> Result<Self, PhysicsError> {
        match stored {
            StoredLamp::Preset(preset) => Ok(preset.lamp()),
            StoredLamp::Custom(flux_per_dnb_flux) => Lamp::custom(flux_per_dnb_flux),
        }
    }
}

impl LampPreset {
    /// All presets, in the order of the model's table.
    pub const ALL: [LampPreset; 9] = [
        LampPreset::Neutral,
        LampPreset::Hps,
        LampPreset::Lps,
        LampPreset::PcAmber,
        LampPreset::Led3000k,
        LampPreset::Led4000k,
        LampPreset::MetalHalide,
        LampPreset::Mercury,
        LampPreset::Mixed,
    ];

    /// The name used in requests, answers and files.
    pub const fn name(self) -> &'static str {
        match self {
            LampPreset::Neutral => "neutral",
            LampPreset::Hps => "hps",
            LampPreset::Lps => "lps",
            LampPreset::PcAmber => "pc_amber",
            LampPreset::Led3000k => "led_3000k",
            LampPreset::Led4000k => "led_4000k",
            LampPreset::MetalHalide => "metal_halide",
            LampPreset::Mercury => "mercury",
            LampPreset::Mixed => "mixed",
        }
    }

    /// The preset of that name.
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|preset| preset.name() == name)
    }

    /// The lamp's properties.
    pub const fn lamp(self) -> Lamp {
        let (flux_per_dnb_flux, lumens, ratio) = match self {
            LampPreset::Neutral => ([1.0, 1.0, 1.0], None, None),
            LampPreset::Hps => ([0.366, 0.559, 0.068], Some(419.0), Some(0.60)),
            LampPreset::Lps => ([0.0, 1.241, 0.0], Some(652.0), Some(0.23)),
            LampPreset::PcAmber => ([0.585, 0.554, 0.009], Some(451.0), Some(0.44)),
            LampPreset::Led3000k => ([0.554, 0.576, 0.133], Some(438.0), Some(1.21)),
            LampPreset::Led4000k => ([0.449, 0.725, 0.303], Some(522.0), Some(1.46)),
            LampPreset::MetalHalide => ([0.264, 0.755, 0.365], Some(481.0), Some(1.72)),
            LampPreset::Mercury => ([0.218, 0.818, 0.301], Some(555.0), Some(1.25)),
            LampPreset::Mixed => ([0.408, 0.642, 0.186], Some(470.0), Some(1.08)),
        };
        Lamp {
            flux_per_dnb_flux,
            lumens_per_dnb_watt: lumens,
            scotopic_photopic_ratio: ratio,
            preset: Some(self),
        }
    }
}

impl Lamp {
    /// A custom lamp from its three fluxes per DNB flux, each 0..=100, not all zero.
    ///
    /// # Errors
    /// [`PhysicsError`] naming `lamp`.
    pub fn custom(flux_per_dnb_flux: [f64; BAND_COUNT]) -> Result<Self, PhysicsError> {
        for flux in flux_per_dnb_flux {
            check_range("lamp", flux, 0.0, 100.0, "per DNB flux")?;
        }
        if flux_per_dnb_flux.iter().all(|&flux| flux == 0.0) {
            return Err(PhysicsError::Invalid {
                parameter: "lamp",
                reason: "all three fluxes are zero; at least one must be positive".to_owned(),
            });
        }
        Ok(Self { flux_per_dnb_flux, lumens_per_dnb_watt: None, scotopic_photopic_ratio: None, preset: None })
    }
}

impl Default for Lamp {
    fn default() -> Self {
        LampPreset::Mixed.lamp()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The mixed lamp is half sodium and half LED within the rounding of the table.
    #[test]
    fn mixed_is_half_sodium_and_half_led() {
        let (hps, led, mixed) =
            (LampPreset::Hps.lamp(), LampPreset::Led4000k.lamp(), LampPreset::Mixed.lamp());
        for band in 0..BAND_COUNT {
            let half = 0.5 * (hps.flux_per_dnb_flux[band] + led.flux_per_dnb_flux[band]);
            assert!((mixed.flux_per_dnb_flux[band] - half).abs() < 1e-3);
        }
    }

    #[test]
    fn every_preset_is_found_by_its_name() {
        for preset in LampPreset::ALL {
            assert_eq!(LampPreset::from_name(preset.name()), Some(preset));
        }
        assert_eq!(LampPreset::from_name("candle"), None);
    }

    #[test]
    fn custom_lamps_refuse_negative_nan_and_darkness() {
        assert!(Lamp::custom([0.1, 0.2, 0.3]).is_ok());
        assert!(Lamp::custom([-0.1, 0.2, 0.3]).is_err());
        assert!(Lamp::custom([f64::NAN, 0.2, 0.3]).is_err());
        assert!(Lamp::custom([0.0; 3]).is_err());
    }
}
