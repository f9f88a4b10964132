//! Sources whose lamps or emission differ from those of the request (`docs/model.md#fixtures`).

use crate::{
    bands::{BAND_COUNT, Band},
    emission::EmissionMix,
    lamp::{Lamp, LampPreset},
};
use serde::{Deserialize, Serialize};

/// What stays the same when a lamp is replaced.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum PreservedFlux {
    /// Σ_b K_b·Φ_b, the luminous flux: streets stay as bright as they were.
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
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
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
    /// s_b of all together.
    flux_per_dnb_flux: [f64; BAND_COUNT],
    /// DNB flux now per original DNB flux, by lamp where that is known.
    parts: Vec<(Option<LampPreset>, f64)>,
}

/// Σ_b K_b·s_b, lm.
fn lumens(flux: [f64; BAND_COUNT]) -> f64 {
    Band::ALL.iter().map(|band| band.luminous_efficacy_lm_w() * flux[band.index()]).sum()
}

impl Mixture {
    fn of(lamp: &Lamp) -> Self {
        let parts = match lamp.preset {
            Some(LampPreset::Mixed) => vec![(Some(LampPreset::Hps), 0.5), (Some(LampPreset::Led4000k), 0.5)],
            preset => vec![(preset, 1.0)],
        };
        Self { flux_per_dnb_flux: lamp.flux_per_dnb_flux, parts }
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
        // The whole may differ from the sum of its parts by rounding of the lamp table.
        let all = self.parts.iter().all(|(lamp, _)| is_replaced(lamp));
        let gone = if all { self.flux_per_dnb_flux } else { self.flux_of(is_replaced) };
        let new = change.to.flux_per_dnb_flux;
        let dnb_after = match change.preserved {
            PreservedFlux::DnbFlux => dnb,
            // A lamp of no lumens cannot stand in for one that has some.
            PreservedFlux::LuminousFlux if lumens(new) > 0.0 => lumens(gone) / lumens(new),
            PreservedFlux::LuminousFlux => 0.0,
        };
        for band in 0..BAND_COUNT {
            let left = if all { 0.0 } else { (self.flux_per_dnb_flux[band] - gone[band]).max(0.0) };
            self.flux_per_dnb_flux[band] = left + dnb_after * new[band];
        }
        self.parts.retain(|(lamp, _)| !is_replaced(lamp));
        let after = Self::of(&change.to).parts;
        self.parts.extend(after.into_iter().map(|(lamp, part)| (lamp, part * dnb_after)));
    }

    /// Whether a part is of the lamps named.
    fn holds(part: Option<LampPreset>, named: LampPreset) -> bool {
        match named {
            LampPreset::Mixed => matches!(part, Some(LampPreset::Hps | LampPreset::Led4000k)),
            named => part == Some(named),
        }
    }

    fn flux_of(&self, is_meant: impl Fn(&Option<LampPreset>) -> bool) -> [f64; BAND_COUNT] {
        let mut flux = [0.0; BAND_COUNT];
        for (lamp, dnb) in self.parts.iter().filter(|(lamp, _)| is_meant(lamp)) {
            let Some(preset) = lamp else { continue };
            let of_lamp = preset.lamp().flux_per_dnb_flux;
            flux.iter_mut().zip(of_lamp).for_each(|(flux, of_lamp)| *flux += dnb * of_lamp);
        }
        flux
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

    /// s_b: flux in R, G, B per DNB flux that the satellite saw of these sources before their lamps were replaced; the
    /// lamp of the request is `requested`.
    pub fn flux_per_dnb_flux(&self, requested: &Lamp) -> [f64; BAND_COUNT] {
        let mut mixture = Mixture::of(requested);
        self.lamps.iter().for_each(|change| mixture.replace(change));
        mixture.flux_per_dnb_flux
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

    proptest! {
        /// At equal luminous flux the lumens stay, whatever is replaced.
        #[test]
        fn equal_luminous_flux_keeps_lumens(
            requested in preset(), from in prop::option::of(preset()), to in preset(), again in preset(),
        ) {
            let lamps = [change(from, to, PreservedFlux::LuminousFlux), change(Some(to), again, PreservedFlux::LuminousFlux)];
            let before = lumens(requested.lamp().flux_per_dnb_flux);
            let after = lumens(fixture(&lamps).flux_per_dnb_flux(&requested.lamp()));
            // The table of lamps is rounded to a thousandth.
            prop_assert!((after / before - 1.0).abs() < 2e-3, "{} {}", before, after);
        }

        #[test]
        fn what_is_forgotten_makes_no_difference(
            requested in preset(), changes in prop::collection::vec((prop::option::of(preset()), preset(), any::<bool>()), 1..5),
        ) {
            let kept = |dnb: bool| if dnb { PreservedFlux::DnbFlux } else { PreservedFlux::LuminousFlux };
            let lamps: Vec<LampChange> =
                changes.into_iter().map(|(from, to, dnb)| change(from, to, kept(dnb))).collect();
            let mut short = Fixture::default();
            lamps.iter().for_each(|change| short.replace(*change));
            prop_assert!(short.lamps.len() <= lamps.len());
            let (short, long) =
                (short.flux_per_dnb_flux(&requested.lamp()), fixture(&lamps).flux_per_dnb_flux(&requested.lamp()));
            for (short, long) in short.iter().zip(long) {
                // The table of lamps is rounded to a thousandth.
                prop_assert!((short - long).abs() < 4e-3 * long.max(0.05), "{} {}", short, long);
            }
        }

        /// All lamps replaced at equal DNB flux have the spectrum of the new ones.
        #[test]
        fn equal_dnb_flux_gives_the_new_lamp(requested in preset(), to in preset()) {
            let after = fixture(&[change(None, to, PreservedFlux::DnbFlux)]).flux_per_dnb_flux(&requested.lamp());
            for (after, new) in after.iter().zip(to.lamp().flux_per_dnb_flux) {
                prop_assert!((after - new).abs() < 1e-12);
            }
        }
    }

    #[test]
    fn what_is_not_there_is_not_replaced() {
        let lamps = [change(Some(LampPreset::Mercury), LampPreset::PcAmber, PreservedFlux::LuminousFlux)];
        let requested = LampPreset::Mixed.lamp();
        assert_eq!(fixture(&lamps).flux_per_dnb_flux(&requested), requested.flux_per_dnb_flux);
        let custom = Lamp::custom([0.4, 0.5, 0.6]).unwrap();
        assert_eq!(fixture(&lamps).flux_per_dnb_flux(&custom), custom.flux_per_dnb_flux);
    }

    /// Lamps that are to be replaced and are not there are named.
    #[test]
    fn absent_lamps_are_named() {
        let to_led = change(Some(LampPreset::Hps), LampPreset::Led4000k, PreservedFlux::LuminousFlux);
        let not_met =
            |lamps: &[LampChange], requested: LampPreset| fixture(lamps).lamps_not_met(&requested.lamp());
        assert_eq!(not_met(&[to_led], LampPreset::Mixed), []);
        assert_eq!(not_met(&[to_led], LampPreset::Led3000k), [LampPreset::Hps]);
        // None are left the second time; a change of all lamps always applies.
        assert_eq!(not_met(&[to_led, to_led], LampPreset::Hps), [LampPreset::Hps]);
        assert_eq!(
            not_met(&[change(None, LampPreset::Hps, PreservedFlux::DnbFlux), to_led], LampPreset::Led3000k),
            []
        );
    }

    /// Of the mixed lamps the sodium half alone is replaced.
    #[test]
    fn sodium_half_of_mixed_is_replaced() {
        let lamps = [change(Some(LampPreset::Hps), LampPreset::Led4000k, PreservedFlux::DnbFlux)];
        let after = fixture(&lamps).flux_per_dnb_flux(&LampPreset::Mixed.lamp());
        for (after, led) in after.iter().zip(LampPreset::Led4000k.lamp().flux_per_dnb_flux) {
            assert!((after - led).abs() < 1e-3, "{after} {led}");
        }
        // White lamps at as many lumens are bluer: what people see stays, what the sky scatters does not.
        let lamps = [change(None, LampPreset::Led4000k, PreservedFlux::LuminousFlux)];
        let sodium = LampPreset::Hps.lamp();
        assert!(fixture(&lamps).flux_per_dnb_flux(&sodium)[2] > 3.0 * sodium.flux_per_dnb_flux[2]);
    }

    #[test]
    fn nothing_differs_by_default() {
        let (lamp, mix) = (Lamp::default(), EmissionMix::garstang());
        let plain = Fixture::default();
        assert!(plain.is_unchanged());
        assert_eq!(plain.flux_per_dnb_flux(&lamp), lamp.flux_per_dnb_flux);
        assert_eq!(plain.emission(mix), mix);
        assert_eq!(
            Fixture { emission: Some(EmissionMix::lambert()), ..plain }.emission(mix),
            EmissionMix::lambert()
        );
    }
}
