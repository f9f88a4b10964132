//! Lamps: light by its spectrum, scaled to one watt that the satellite sees (`docs/model.md#lamps`).

use crate::{
    error::{PhysicsError, check_range},
    spectrum::{LampPreset, Light, RGB_BANDS, Spectrum},
};
use serde::{Deserialize, Serialize};
use std::sync::{Arc, LazyLock};

/// What a lamp was given as.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(untagged)]
pub enum LampKind {
    /// By its name.
    Preset(LampPreset),
    /// Flux in R, G, B (600–700, 500–600, 400–500 nm, the same at every wavelength of a band) per watt that the satellite sees.
    Bands([f64; 3]),
    /// Named lamps, each with its share of the lumens; shares sum to 1.
    Mix(Vec<(LampPreset, f64)>),
    /// A spectrum of the user's own, 380 to 900 nm every 5 nm, relative.
    Spectrum(Vec<f64>),
}

/// A lamp. A satellite sees no blue, so the lamp is an assumption that every answer repeats.
///
/// In files it is its [`LampKind`].
#[derive(Clone, Debug, Serialize, Deserialize)]
#[serde(into = "LampKind", try_from = "LampKind")]
pub struct Lamp {
    kind: LampKind,
    light: Arc<Light>,
}

impl PartialEq for Lamp {
    fn eq(&self, other: &Self) -> bool {
        self.kind == other.kind
    }
}

impl From<Lamp> for LampKind {
    fn from(lamp: Lamp) -> Self {
        lamp.kind
    }
}

impl TryFrom<LampKind> for Lamp {
    type Error = PhysicsError;

    fn try_from(kind: LampKind) -> Result<Self, PhysicsError> {
        match kind {
            LampKind::Preset(preset) => Ok(preset.lamp()),
            LampKind::Bands(flux_per_dnb_flux) => Lamp::custom(flux_per_dnb_flux),
            LampKind::Mix(parts) => Lamp::mix(&parts),
            LampKind::Spectrum(samples) => Lamp::from_spectrum(&Spectrum::from_samples(&samples)),
        }
    }
}

/// The light of every preset, whose rules are then found once.
static PRESETS: LazyLock<Vec<Arc<Light>>> =
    LazyLock::new(|| LampPreset::ALL.iter().map(|preset| Arc::new(Light::new(preset.spectrum()))).collect());

impl LampPreset {
    /// The lamp of that name.
    pub fn lamp(self) -> Lamp {
        let at = Self::ALL.iter().position(|preset| *preset == self).unwrap_or_default();
        Lamp { kind: LampKind::Preset(self), light: Arc::clone(&PRESETS[at]) }
    }
}

impl Lamp {
    /// A custom lamp from its fluxes in R, G, B per watt that the satellite sees, each 0..=100, not all zero.
    ///
    /// # Errors
    /// [`PhysicsError`] naming `lamp`.
    pub fn custom(flux_per_dnb_flux: [f64; 3]) -> Result<Self, PhysicsError> {
        for flux in flux_per_dnb_flux {
            check_range("lamp", flux, 0.0, 100.0, "per DNB flux")?;
        }
        if flux_per_dnb_flux.iter().all(|&flux| flux == 0.0) {
            return Err(invalid("all three fluxes are zero; at least one must be positive"));
        }
        let mut spectrum = Spectrum::from_samples(&[]);
        for (band, flux) in RGB_BANDS.iter().zip(flux_per_dnb_flux) {
            let curve = band.curve();
            let width_nm = curve.integral_with(&Spectrum::from_fn(|_| 1.0));
            spectrum = spectrum.sum(&curve.scaled(flux / width_nm));
        }
        Ok(Self { kind: LampKind::Bands(flux_per_dnb_flux), light: Arc::new(Light::new(spectrum)) })
    }

    /// Named lamps, each with its share of the lumens, which are brought to a sum of 1.
    ///
    /// # Errors
    /// [`PhysicsError`] naming `lamp`: no parts, more than eight, shares that are negative or not finite or all 0.
    pub fn mix(parts: &[(LampPreset, f64)]) -> Result<Self, PhysicsError> {
        let sum: f64 = parts.iter().map(|(_, share)| share).sum();
        let are_shares = parts.iter().all(|(_, share)| share.is_finite() && *share >= 0.0);
        if !(are_shares && sum > 0.0 && sum.is_finite() && parts.len() <= 8) {
            return Err(invalid("a mix has one to eight lamps, each with a share of 0 or more, not all 0"));
        }
        let shares: Vec<(LampPreset, f64)> = parts.iter().map(|(lamp, share)| (*lamp, share / sum)).collect();
        let lights: Vec<Spectrum> = shares.iter().map(|(lamp, _)| lamp.spectrum()).collect();
        let weighed: Vec<(&Spectrum, f64)> =
            lights.iter().zip(&shares).map(|(light, (_, share))| (light, *share)).collect();
        let watts: f64 = dnb_watts_of_lumens(&shares).iter().map(|(_, watts)| watts).sum();
        let mixed =
            Spectrum::mix_by_lumens(&weighed).ok_or_else(|| invalid("a lamp of the mix has no lumens"))?;
        Ok(Self { kind: LampKind::Mix(shares), light: Arc::new(Light::new(mixed.scaled(1.0 / watts))) })
    }

    /// A lamp of the user's own spectrum, relative.
    ///
    /// # Errors
    /// [`PhysicsError`] naming `lamp` for light that the satellite does not see, from which no flux follows.
    pub fn from_spectrum(spectrum: &Spectrum) -> Result<Self, PhysicsError> {
        let watt = spectrum.per_dnb_watt().ok_or_else(|| {
            invalid("the satellite, which sees 480 to 900 nm, sees nothing of this spectrum")
        })?;
        let kind = LampKind::Spectrum(spectrum.0.to_vec());
        Ok(Self { kind, light: Arc::new(Light::new(watt)) })
    }

    /// What it was given as.
    pub fn kind(&self) -> &LampKind {
        &self.kind
    }

    /// The preset; None for others.
    pub fn preset(&self) -> Option<LampPreset> {
        match self.kind {
            LampKind::Preset(preset) => Some(preset),
            _ => None,
        }
    }

    /// Its light per watt that the satellite sees.
    pub fn light(&self) -> &Arc<Light> {
        &self.light
    }

    /// Flux in R, G, B (600–700, 500–600, 400–500 nm) per watt that the satellite sees.
    pub fn flux_per_dnb_flux(&self) -> [f64; 3] {
        RGB_BANDS.each_ref().map(|band| band.value_of(self.light.spectrum()))
    }

    /// What it is made of: named lamps with their parts of the flux that the satellite sees; None for what has no name.
    pub(crate) fn parts(&self) -> Vec<(Option<LampPreset>, f64)> {
        match &self.kind {
            LampKind::Preset(LampPreset::Mixed) => {
                vec![(Some(LampPreset::Hps), 0.5), (Some(LampPreset::Led4000k), 0.5)]
            }
            LampKind::Preset(preset) => vec![(Some(*preset), 1.0)],
            LampKind::Mix(shares) => {
                let watts = dnb_watts_of_lumens(shares);
                let sum: f64 = watts.iter().map(|(_, watts)| watts).sum();
                watts.into_iter().map(|(lamp, watts)| (Some(lamp), watts / sum)).collect()
            }
            LampKind::Bands(_) | LampKind::Spectrum(_) => vec![(None, 1.0)],
        }
    }
}

/// Watts that the satellite sees of so many lumens of each lamp.
fn dnb_watts_of_lumens(lumens: &[(LampPreset, f64)]) -> Vec<(LampPreset, f64)> {
    lumens.iter().map(|(lamp, lumens)| (*lamp, lumens / lamp.spectrum().lumens())).collect()
}

fn invalid(reason: &str) -> PhysicsError {
    PhysicsError::Invalid { parameter: "lamp", reason: reason.to_owned() }
}

impl Default for Lamp {
    fn default() -> Self {
        LampPreset::Mixed.lamp()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::spectrum::{Colour, Response};

    /// Half of what the satellite sees is sodium, half LED.
    #[test]
    fn mixed_is_half_sodium_and_half_led() {
        let [hps, led, mixed] = [LampPreset::Hps, LampPreset::Led4000k, LampPreset::Mixed]
            .map(|preset| preset.lamp().light().spectrum().clone());
        assert!(
            hps.sum(&led).scaled(0.5).0.iter().zip(mixed.0).all(|(half, mixed)| (half - mixed).abs() < 1e-15)
        );
    }

    /// Lumens per DNB watt of measured lamps, within what their makes differ by.
    #[test]
    fn lumens_are_those_of_measured_lamps() {
        for (preset, measured) in [
            (LampPreset::Hps, 419.0),
            (LampPreset::Lps, 652.0),
            (LampPreset::PcAmber, 451.0),
            (LampPreset::Led3000k, 438.0),
            (LampPreset::Led4000k, 522.0),
            (LampPreset::MetalHalide, 481.0),
            (LampPreset::Mercury, 555.0),
        ] {
            let lumens = preset.lamp().light().spectrum().lumens();
            assert!((lumens / measured - 1.0).abs() < 0.12, "{}: {lumens:.0} lm", preset.name());
        }
    }

    #[test]
    fn custom_lamps_refuse_negative_nan_and_darkness() {
        let custom = Lamp::custom([0.1, 0.2, 0.3]).unwrap();
        for (flux, given) in custom.flux_per_dnb_flux().into_iter().zip([0.1, 0.2, 0.3]) {
            assert!((flux - given).abs() < 1e-12);
        }
        assert!(Lamp::custom([-0.1, 0.2, 0.3]).is_err());
        assert!(Lamp::custom([f64::NAN, 0.2, 0.3]).is_err());
        assert!(Lamp::custom([0.0; 3]).is_err());
    }

    /// A mix has its shares of the lumens, one watt that the satellite sees, and is written and read as it was given.
    #[test]
    fn mixes_have_their_shares() {
        let mix = Lamp::mix(&[(LampPreset::Lps, 3.0), (LampPreset::Led5000k, 1.0)]).unwrap();
        let spectrum = mix.light().spectrum();
        assert!((spectrum.integral_with(&Response::Dnb.curve()) - 1.0).abs() < 1e-12);
        let ratio = |spectrum: &Spectrum| Colour::of(spectrum).unwrap().scotopic_photopic_ratio;
        let wanted =
            0.75 * ratio(&LampPreset::Lps.spectrum()) + 0.25 * ratio(&LampPreset::Led5000k.spectrum());
        assert!((ratio(spectrum) - wanted).abs() < 1e-12);
        let parts = mix.parts();
        assert!((parts[0].1 + parts[1].1 - 1.0).abs() < 1e-12 && parts[0].1 < 0.75);
        assert!(Lamp::mix(&[]).is_err() && Lamp::mix(&[(LampPreset::Hps, -1.0)]).is_err());
        let own = Lamp::from_spectrum(&LampPreset::Mercury.spectrum()).unwrap();
        let bands = Lamp::custom([1.0, 2.0, 3.0]).unwrap();
        for lamp in [mix, own, bands, LampPreset::Led2700k.lamp()] {
            let read = Lamp::try_from(LampKind::from(lamp.clone())).unwrap();
            assert_eq!(read, lamp);
            assert_eq!(read.light().spectrum(), lamp.light().spectrum());
        }
        assert!(Lamp::from_spectrum(&Spectrum::from_fn(|nm| f64::from(u8::from(nm < 450.0)))).is_err());
    }
}
