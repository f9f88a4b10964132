//! Sources whose lamps or emission differ from those of the request (`docs/model.md#fixtures`).

use crate::{
    emission::EmissionMix,
    lamp::Lamp,
    spectrum::{LampPreset, Light, SAMPLE_COUNT, Spectrum},
};
use serde::{Deserialize, Serialize};
use std::sync::Arc;

/// What stays the same when a lamp is replaced.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum PreservedFlux {
    /// The luminous flux: streets stay as bright as they were.
    #[default]
    LuminousFlux,
    /// The flux that the satellite sees.
    DnbFlux,
}

impl PreservedFlux {
    /// Both, in the order of the interface.
    pub const ALL: [Self; 2] = [Self::LuminousFlux, Self::DnbFlux];

    /// The name used in requests, answers and files.
    pub const fn name(self) -> &'static str {
        match self {
            PreservedFlux::LuminousFlux => "luminous_flux",
            PreservedFlux::DnbFlux => "dnb_flux",
        }
    }
}

/// Lamps replaced by others.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct LampChange {
    /// Which lamps; None for all. Of `mixed` half are `hps` and half `led_4000k`.
    pub from: Option<LampPreset>,
    /// The new ones.
    pub to: Lamp,
    /// What stays the same.
    #[serde(rename = "kept")]
    pub preserved: PreservedFlux,
}

/// How some sources differ from those of the request.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Fixture {
    /// Lamps replaced, one change after the other.
    pub lamps: Vec<LampChange>,
    /// Their emission; None for that of the request.
    pub emission: Option<EmissionMix>,
}

/// A mixture of lamps, by their parts of the flux that the satellite saw originally.
#[derive(Clone, Debug)]
struct Mixture {
    /// Of all together, W nm⁻¹ per watt that the satellite saw originally.
    spectrum: Spectrum,
    /// DNB flux now per original DNB flux, by lamp where that is known.
    parts: Vec<(Option<LampPreset>, f64)>,
}

impl Mixture {
    fn of(lamp: &Lamp) -> Self {
        Self { spectrum: lamp.light().spectrum().clone(), parts: lamp.parts() }
    }

    /// Whether a change replaces any of the lamps.
    fn meets(&self, change: &LampChange) -> bool {
        self.parts.iter().any(|(lamp, dnb)| Self::replaces(change, lamp) && *dnb > 0.0)
    }

    fn replaces(change: &LampChange, lamp: &Option<LampPreset>) -> bool {
        change.from.is_none_or(|from| Self::holds(*lamp, from))
    }

    fn replace(&mut self, change: &LampChange) {
        let is_replaced = |lamp: &Option<LampPreset>| Self::replaces(change, lamp);
        let dnb: f64 = self.parts.iter().filter(|(lamp, _)| is_replaced(lamp)).map(|(_, dnb)| dnb).sum();
        if dnb == 0.0 {
            return;
        }
        let all = self.parts.iter().all(|(lamp, _)| is_replaced(lamp));
        let gone = if all { self.spectrum.clone() } else { self.spectrum_of(is_replaced) };
        let new = change.to.light().spectrum();
        let dnb_after = match change.preserved {
            PreservedFlux::DnbFlux => dnb,
            // A lamp of no lumens cannot stand in for one that has some.
            PreservedFlux::LuminousFlux if new.lumens() > 0.0 => gone.lumens() / new.lumens(),
            PreservedFlux::LuminousFlux => 0.0,
        };
        for ((light, gone), new) in self.spectrum.0.iter_mut().zip(gone.0).zip(new.0) {
            let left = if all { 0.0 } else { (*light - gone).max(0.0) };
            *light = left + dnb_after * new;
        }
        self.parts.retain(|(lamp, _)| !is_replaced(lamp));
        self.parts.extend(change.to.parts().into_iter().map(|(lamp, part)| (lamp, part * dnb_after)));
    }

    /// Whether a part is of the lamps named.
    fn holds(part: Option<LampPreset>, named: LampPreset) -> bool {
        match named {
            LampPreset::Mixed => matches!(part, Some(LampPreset::Hps | LampPreset::Led4000k)),
            named => part == Some(named),
        }
    }

    fn spectrum_of(&self, is_meant: impl Fn(&Option<LampPreset>) -> bool) -> Spectrum {
        let mut sum = Spectrum([0.0; SAMPLE_COUNT]);
        for (lamp, dnb) in self.parts.iter().filter(|(lamp, _)| is_meant(lamp)) {
            let Some(preset) = lamp else { continue };
            sum = sum.sum(&preset.lamp().light().spectrum().scaled(*dnb));
        }
        sum
    }
}

impl Fixture {
    /// Whether nothing differs.
    pub fn is_unchanged(&self) -> bool {
        self.lamps.is_empty() && self.emission.is_none()
    }

    /// Replaces lamps. Earlier changes without effect are dropped: those before all lamps are replaced by the same
    /// rule, and a repetition of the last one.
    pub fn replace(&mut self, change: LampChange) {
        if change.from.is_none() && self.lamps.iter().all(|before| before.preserved == change.preserved) {
            self.lamps.clear();
        }
        if self.lamps.last() != Some(&change) {
            self.lamps.push(change);
        }
    }

    /// The light per watt that the satellite saw of these sources before their lamps were replaced; the lamp of the request is
    /// `requested`.
    pub fn light(&self, requested: &Lamp) -> Arc<Light> {
        if self.lamps.is_empty() {
            return Arc::clone(requested.light());
        }
        let mut mixture = Mixture::of(requested);
        self.lamps.iter().for_each(|change| mixture.replace(change));
        Arc::new(Light::new(mixture.spectrum))
    }

    /// Lamps that a change replaces although none are left by then; the lamp of the request is `requested`.
    pub fn lamps_not_met(&self, requested: &Lamp) -> Vec<LampPreset> {
        let mut mixture = Mixture::of(requested);
        let mut not_met = Vec::new();
        for change in &self.lamps {
            not_met.extend(change.from.filter(|_| !mixture.meets(change)));
            mixture.replace(change);
        }
        not_met
    }

    /// The emission of these sources, given that of the request.
    pub fn emission(&self, requested: EmissionMix) -> EmissionMix {
        self.emission.unwrap_or(requested)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::spectrum::{Response, STEP_NM};
    use proptest::prelude::*;

    fn change(from: Option<LampPreset>, to: LampPreset, preserved: PreservedFlux) -> LampChange {
        LampChange { from, to: to.lamp(), preserved }
    }

    fn fixture(lamps: &[LampChange]) -> Fixture {
        Fixture { lamps: lamps.to_vec(), emission: None }
    }

    fn preset() -> impl Strategy<Value = LampPreset> {
        prop::sample::select(LampPreset::ALL.to_vec())
    }

    /// Largest difference of two spectra, of the mean of the second.
    fn difference(one: &Light, other: &Light) -> f64 {
        let (one, other) = (one.spectrum(), other.spectrum());
        let mean = other.0.iter().sum::<f64>() / SAMPLE_COUNT as f64;
        one.0.iter().zip(other.0).map(|(one, other)| (one - other).abs()).fold(0.0, f64::max) / mean
    }

    proptest! {
        /// At equal luminous flux the lumens stay, whatever is replaced.
        #[test]
        fn equal_luminous_flux_keeps_lumens(
            requested in preset(), from in prop::option::of(preset()), to in preset(), again in preset(),
        ) {
            let lamps = [change(from, to, PreservedFlux::LuminousFlux), change(Some(to), again, PreservedFlux::LuminousFlux)];
            let before = requested.lamp().light().spectrum().lumens();
            let after = fixture(&lamps).light(&requested.lamp()).spectrum().lumens();
            prop_assert!((after / before - 1.0).abs() < 1e-9, "{} {}", before, after);
        }

        #[test]
        fn what_is_forgotten_makes_no_difference(
            requested in preset(), changes in prop::collection::vec((prop::option::of(preset()), preset(), any::<bool>()), 1..5),
        ) {
            let kept = |dnb: bool| if dnb { PreservedFlux::DnbFlux } else { PreservedFlux::LuminousFlux };
            let lamps: Vec<LampChange> =
                changes.into_iter().map(|(from, to, dnb)| change(from, to, kept(dnb))).collect();
            let mut short = Fixture::default();
            lamps.iter().for_each(|change| short.replace(change.clone()));
            prop_assert!(short.lamps.len() <= lamps.len());
            let (short, long) = (short.light(&requested.lamp()), fixture(&lamps).light(&requested.lamp()));
            prop_assert!(difference(&short, &long) < 1e-9);
        }

        /// All lamps replaced at equal DNB flux have the spectrum of the new ones.
        #[test]
        fn equal_dnb_flux_gives_the_new_lamp(requested in preset(), to in preset()) {
            let after = fixture(&[change(None, to, PreservedFlux::DnbFlux)]).light(&requested.lamp());
            prop_assert!(difference(&after, to.lamp().light()) < 1e-12);
        }
    }

    #[test]
    fn what_is_not_there_is_not_replaced() {
        let lamps = [change(Some(LampPreset::Mercury), LampPreset::PcAmber, PreservedFlux::LuminousFlux)];
        for requested in [LampPreset::Mixed.lamp(), Lamp::custom([0.4, 0.5, 0.6]).unwrap()] {
            assert_eq!(fixture(&lamps).light(&requested), *requested.light());
        }
    }

    /// Lamps that are to be replaced and are not there are named.
    #[test]
    fn absent_lamps_are_named() {
        let to_led = || change(Some(LampPreset::Hps), LampPreset::Led4000k, PreservedFlux::LuminousFlux);
        let not_met =
            |lamps: &[LampChange], requested: LampPreset| fixture(lamps).lamps_not_met(&requested.lamp());
        assert_eq!(not_met(&[to_led()], LampPreset::Mixed), []);
        assert_eq!(not_met(&[to_led()], LampPreset::Led3000k), [LampPreset::Hps]);
        // None are left the second time; a change of all lamps always applies.
        assert_eq!(not_met(&[to_led(), to_led()], LampPreset::Hps), [LampPreset::Hps]);
        assert_eq!(
            not_met(&[change(None, LampPreset::Hps, PreservedFlux::DnbFlux), to_led()], LampPreset::Led3000k),
            []
        );
    }

    /// Of the mixed lamps, and of a mix by lumens, the sodium part alone is replaced.
    #[test]
    fn the_sodium_part_alone_is_replaced() {
        let to_led = [change(Some(LampPreset::Hps), LampPreset::Led4000k, PreservedFlux::DnbFlux)];
        let mix = Lamp::mix(&[(LampPreset::Hps, 0.3), (LampPreset::Led4000k, 0.7)]).unwrap();
        for requested in [LampPreset::Mixed.lamp(), mix] {
            let after = fixture(&to_led).light(&requested);
            assert!(difference(&after, LampPreset::Led4000k.lamp().light()) < 1e-9);
        }
    }

    /// White lamps at as many lumens are bluer: what the light-adapted eye sees stays, what the dark-adapted one sees does not.
    #[test]
    fn white_lamps_are_bluer() {
        let lamps = [change(None, LampPreset::Led4000k, PreservedFlux::LuminousFlux)];
        let sodium = LampPreset::Hps.lamp();
        let after = fixture(&lamps).light(&sodium);
        let ratio = |response: &Response| {
            response.value_of(after.spectrum()) / response.value_of(sodium.light().spectrum())
        };
        assert!((ratio(&Response::Photopic) - 1.0).abs() < 1e-9);
        assert!(ratio(&Response::Scotopic) > 2.0 && ratio(&Response::Melanopic) > 3.0);
        assert!(after.spectrum().0.iter().sum::<f64>() * STEP_NM > 0.5);
    }

    #[test]
    fn nothing_differs_by_default() {
        let (lamp, mix) = (Lamp::default(), EmissionMix::garstang());
        let plain = Fixture::default();
        assert!(plain.is_unchanged());
        assert!(Arc::ptr_eq(&plain.light(&lamp), lamp.light()));
        assert_eq!(plain.emission(mix), mix);
        assert_eq!(
            Fixture { emission: Some(EmissionMix::lambert()), ..plain }.emission(mix),
            EmissionMix::lambert()
        );
    }
}
