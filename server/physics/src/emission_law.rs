//! Garstang's law of emission (Garstang 1986), and what of an emission a request assumes (`docs/model.md#emission`).

use crate::{
    emission::{EmissionMix, Lobe},
    error::{PhysicsError, check_range},
    fixture::Fixture,
};
use serde::Serialize;

/// Least weight of `lambert` from which the radiance at the nadir says the flux: a hundredth of it.
pub const MIN_NADIR_WEIGHT: f64 = 0.01;

/// Two shares of the lamps' light: F goes above the horizon directly, and the ground sends back G of the rest.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct GarstangLaw {
    direct_uplight: f64,
    ground_reflectance: f64,
}

impl GarstangLaw {
    /// Lanterns of today: the default.
    pub const MODERN_CITY: Self = Self { direct_uplight: 0.02, ground_reflectance: 0.15 };
    /// The towns of Garstang (1986).
    pub const GARSTANG_1986: Self = Self { direct_uplight: 0.15, ground_reflectance: 0.15 };
    /// No light above the horizon but from the ground.
    pub const FULL_CUTOFF: Self = Self { direct_uplight: 0.0, ground_reflectance: 0.15 };
    /// All that have a name.
    pub const PRESETS: [(&str, Self); 3] = [
        ("modern_city", Self::MODERN_CITY),
        ("garstang_1986", Self::GARSTANG_1986),
        ("full_cutoff", Self::FULL_CUTOFF),
    ];

    /// * `direct_uplight`: F, 0 to 1.
    /// * `ground_reflectance`: G, 0 to 1.
    ///
    /// # Errors
    /// [`PhysicsError`] for a share outside its range, and where no light goes up at all.
    pub fn new(direct_uplight: f64, ground_reflectance: f64) -> Result<Self, PhysicsError> {
        check_range("direct_uplight", direct_uplight, 0.0, 1.0, "")?;
        check_range("ground_reflectance", ground_reflectance, 0.0, 1.0, "")?;
        let law = Self { direct_uplight, ground_reflectance };
        EmissionMix::new(law.upward_shares()).map(|_| law)
    }

    /// F.
    pub const fn direct_uplight(self) -> f64 {
        self.direct_uplight
    }

    /// G.
    pub const fn ground_reflectance(self) -> f64 {
        self.ground_reflectance
    }

    /// Shares of the lamps' light that go up, by lobe: G(1 − F), F and none.
    const fn upward_shares(self) -> [f64; 3] {
        let Self { direct_uplight, ground_reflectance } = self;
        [ground_reflectance * (1.0 - direct_uplight), direct_uplight, 0.0]
    }

    /// Weights of the lobes.
    pub fn mix(self) -> EmissionMix {
        EmissionMix::normalized(self.upward_shares())
    }
}

impl EmissionMix {
    /// That of [`GarstangLaw::GARSTANG_1986`], which reference solutions are made with.
    pub fn garstang() -> Self {
        GarstangLaw::GARSTANG_1986.mix()
    }
}

/// What of a light the satellite's radiance L says, whatever the emission.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum EmissionKeep {
    /// The flux: π·L of the pixel's area, as a Lambertian light sends up that has this radiance at its nadir.
    #[default]
    Flux,
    /// The radiance straight up to the satellite: of a light with little at its nadir the flux is larger.
    NadirRadiance,
}

impl EmissionKeep {
    /// Both, in the order of the interface.
    pub const ALL: [Self; 2] = [Self::Flux, Self::NadirRadiance];

    /// The name used in requests, answers and files.
    pub const fn name(self) -> &'static str {
        match self {
            EmissionKeep::Flux => "flux",
            EmissionKeep::NadirRadiance => "nadir_radiance",
        }
    }

    /// Flux per π·L of lights that send it out so. `lambert` alone has intensity at the nadir.
    ///
    /// # Errors
    /// [`PhysicsError::Invalid`] where the radiance at the nadir is to be kept and the weight of `lambert` is below
    /// [`MIN_NADIR_WEIGHT`].
    pub fn flux_factor(self, mix: EmissionMix) -> Result<f64, PhysicsError> {
        let nadir = mix.weights()[Lobe::Lambert.index()];
        if self == EmissionKeep::NadirRadiance && nadir < MIN_NADIR_WEIGHT {
            let reason = format!(
                "of lights with a weight of lambert of {nadir} the radiance at the nadir does not say the flux"
            );
            return Err(PhysicsError::Invalid { parameter: "emission_keep", reason });
        }
        Ok(self.factor(nadir))
    }

    fn factor(self, nadir: f64) -> f64 {
        match self {
            EmissionKeep::Flux => 1.0,
            EmissionKeep::NadirRadiance => 1.0 / nadir,
        }
    }
}

/// Where lamps send their light, as a request assumes it and its answer repeats it.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Emission {
    mix: EmissionMix,
    law: Option<GarstangLaw>,
    keep: EmissionKeep,
}

impl Emission {
    /// The preset of that name: of [`GarstangLaw::PRESETS`], `lambert`, or the older `garstang` and `shielded`.
    pub fn from_name(name: &str) -> Option<Self> {
        let name = match name {
            "garstang" => "garstang_1986",
            "shielded" => "full_cutoff",
            "lambert" => return Some(EmissionMix::lambert().into()),
            name => name,
        };
        GarstangLaw::PRESETS.iter().find(|(preset, _)| *preset == name).map(|(_, law)| (*law).into())
    }

    /// The name of the preset; None where there is none.
    pub fn name(self) -> Option<&'static str> {
        match self.law {
            Some(law) => {
                GarstangLaw::PRESETS.iter().find(|(_, preset)| *preset == law).map(|(name, _)| *name)
            }
            None => (self.mix == EmissionMix::lambert()).then_some("lambert"),
        }
    }

    /// Weights of the lobes, of lights without an emission of their own.
    pub const fn mix(self) -> EmissionMix {
        self.mix
    }

    /// The law that they follow from; None where they were given themselves.
    pub const fn law(self) -> Option<GarstangLaw> {
        self.law
    }

    /// What the satellite's radiance says, of all lights.
    pub const fn keep(self) -> EmissionKeep {
        self.keep
    }

    /// The same with something else kept.
    ///
    /// # Errors
    /// As [`EmissionKeep::flux_factor`].
    pub fn keeping(self, keep: EmissionKeep) -> Result<Self, PhysicsError> {
        keep.flux_factor(self.mix).map(|_| Self { keep, ..self })
    }

    /// Flux per π·L of lights without an emission of their own.
    pub fn flux_factor(self) -> f64 {
        self.keep.factor(self.mix.weights()[Lobe::Lambert.index()])
    }

    /// The lobes of a fixture's lights, and their flux per DNB flux π·L.
    ///
    /// # Errors
    /// As [`EmissionKeep::flux_factor`].
    pub fn of_fixture(self, fixture: &Fixture) -> Result<(EmissionMix, f64), PhysicsError> {
        let mix = fixture.emission(self.mix);
        Ok((mix, self.keep.flux_factor(mix)?))
    }
}

impl Default for Emission {
    fn default() -> Self {
        GarstangLaw::MODERN_CITY.into()
    }
}

impl From<GarstangLaw> for Emission {
    fn from(law: GarstangLaw) -> Self {
        Self { mix: law.mix(), law: Some(law), keep: EmissionKeep::Flux }
    }
}

impl From<EmissionMix> for Emission {
    fn from(mix: EmissionMix) -> Self {
        Self { mix, law: None, keep: EmissionKeep::Flux }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn weights_follow_from_f_and_g() {
        for (law, lambert, horizon) in [
            (GarstangLaw::GARSTANG_1986, 0.1275 / 0.2775, 0.15 / 0.2775),
            (GarstangLaw::MODERN_CITY, 0.147 / 0.167, 0.02 / 0.167),
            (GarstangLaw::FULL_CUTOFF, 1.0, 0.0),
        ] {
            let weights = law.mix().weights();
            assert!((weights[0] - lambert).abs() < 1e-15 && (weights[1] - horizon).abs() < 1e-15, "{law:?}");
            assert_eq!(weights[2], 0.0);
        }
        assert_eq!(EmissionMix::garstang(), GarstangLaw::GARSTANG_1986.mix());
    }

    /// Shares outside 0 to 1 and lamps that send nothing up are refused.
    #[test]
    fn impossible_shares_are_refused() {
        for (f, g) in [(-0.1, 0.1), (1.1, 0.1), (0.1, -0.1), (0.1, 1.1), (f64::NAN, 0.1), (0.0, 0.0)] {
            assert!(GarstangLaw::new(f, g).is_err(), "{f} {g}");
        }
        assert_eq!(GarstangLaw::new(0.02, 0.15), Ok(GarstangLaw::MODERN_CITY));
    }

    /// Every preset is known by its name, and the older names mean what they meant.
    #[test]
    fn presets_have_names_and_older_names() {
        for (name, law) in GarstangLaw::PRESETS {
            let emission = Emission::from_name(name).unwrap();
            assert_eq!((emission.name(), emission.law()), (Some(name), Some(law)));
        }
        let named = |name| Emission::from_name(name).unwrap();
        assert_eq!(named("garstang"), named("garstang_1986"));
        assert_eq!(named("shielded"), named("full_cutoff"));
        assert_eq!(named("shielded").mix(), named("lambert").mix());
        assert_eq!((named("lambert").name(), named("lambert").law()), (Some("lambert"), None));
        assert_eq!(Emission::default(), named("modern_city"));
        assert_eq!(Emission::from_name("upwards"), None);
    }

    /// With the radiance at the nadir kept, intensity straight up is that of a Lambertian light of flux π·L.
    #[test]
    fn kept_nadir_radiance_is_lambertian_there() {
        for mix in [EmissionMix::garstang(), EmissionMix::new([0.2, 0.3, 0.5]).unwrap()] {
            let of = |emission: Emission, fixture: &Fixture| {
                let (mix, flux) = emission.of_fixture(fixture).unwrap();
                let lobes = crate::emission::lobe_intensities_per_sr(1.0).into_iter().zip(mix.weights());
                flux * lobes.map(|(f, w)| f * w).sum::<f64>()
            };
            let kept = Emission::from(mix).keeping(EmissionKeep::NadirRadiance).unwrap();
            let own = Fixture { emission: Some(EmissionMix::garstang()), ..Fixture::default() };
            for fixture in [Fixture::default(), own] {
                let lambertian = of(EmissionMix::lambert().into(), &Fixture::default());
                assert!((of(kept, &fixture) / lambertian - 1.0).abs() < 1e-12);
                assert!(of(mix.into(), &fixture) < 0.6 * lambertian, "the flux is kept by default");
            }
        }
    }

    /// Lights that send nothing to the nadir have no flux that the satellite would see.
    #[test]
    fn lights_dark_at_the_nadir_are_refused() {
        for weights in [[0.0, 1.0, 0.0], [0.0, 0.5, 0.5], [0.005, 0.995, 0.0]] {
            let mix = EmissionMix::new(weights).unwrap();
            assert!(EmissionKeep::NadirRadiance.flux_factor(mix).is_err(), "{weights:?}");
            assert_eq!(EmissionKeep::Flux.flux_factor(mix), Ok(1.0));
        }
        let dark = Fixture { emission: Some(EmissionMix::only(Lobe::Horizon)), ..Fixture::default() };
        let kept = Emission::default().keeping(EmissionKeep::NadirRadiance).unwrap();
        assert!(
            (kept.flux_factor() - 0.167 / 0.147).abs() < 1e-12 && Emission::default().flux_factor() == 1.0
        );
        assert!(kept.of_fixture(&dark).is_err());
    }
}
