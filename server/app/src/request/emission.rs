//! Where lights send their light: as parameters of a sky, and in an edit of a scenario.

use crate::{parameters as p, reader::Reader, validation::ValidationCode};
use serde::Deserialize;
use skyglow_physics::{Emission, EmissionKeep, EmissionMix, GarstangLaw};
use utoipa::ToSchema;

/// A preset's name, three weights, or the shares of Garstang's law.
#[derive(Clone, Debug, Deserialize, ToSchema)]
#[serde(untagged)]
pub enum EmissionBody {
    /// A preset.
    Name(String),
    /// Weights of lambert, horizon and oblique.
    Weights([f64; 3]),
    /// Shares of the lamps' light.
    Law(GarstangLawBody),
}

/// Shares of the lamps' light by Garstang's law.
#[derive(Clone, Debug, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct GarstangLawBody {
    /// Share that goes above the horizon directly, 0 to 1.
    #[schema(minimum = 0, maximum = 1)]
    pub direct_uplight: f64,
    /// Share of the rest that the ground sends back, 0 to 1; 0.15 without.
    #[schema(minimum = 0, maximum = 1)]
    pub ground_reflectance: Option<f64>,
}

impl EmissionBody {
    /// The lobes that it means; None where it means none.
    pub(super) fn mix(&self) -> Option<EmissionMix> {
        match self {
            EmissionBody::Name(name) => Emission::from_name(name).map(Emission::mix),
            EmissionBody::Weights(weights) => EmissionMix::new(*weights).ok(),
            EmissionBody::Law(law) => {
                let usual = GarstangLaw::MODERN_CITY.ground_reflectance();
                let law = GarstangLaw::new(law.direct_uplight, law.ground_reflectance.unwrap_or(usual));
                law.ok().map(GarstangLaw::mix)
            }
        }
    }

    /// What may be meant, in words.
    pub(super) fn allowed() -> String {
        format!("{}, or an object with direct_uplight and ground_reflectance, 0 to 1", p::EMISSION.allowed())
    }
}

/// The emission that a sky is asked with.
pub(super) fn read_emission(reader: &mut Reader) -> Emission {
    let named = match reader.text(&p::EMISSION) {
        None => Some(Emission::default()),
        Some(text) => {
            let weights = || Reader::three_numbers(text).and_then(|weights| EmissionMix::new(weights).ok());
            Emission::from_name(text).or_else(|| weights().map(Emission::from))
        }
    };
    let Some(named) = named else {
        reader.fail(&p::EMISSION, ValidationCode::NotAllowed, None, None);
        return Emission::default();
    };
    let emission = with_shares(reader, named);
    let keep = match reader.choice(&p::EMISSION_KEEP) {
        Some(name) => EmissionKeep::ALL.into_iter().find(|keep| keep.name() == name).unwrap_or_default(),
        None => EmissionKeep::Flux,
    };
    emission.keeping(keep).unwrap_or_else(|_| {
        let message = "the emission has too little light at the nadir to say the flux".to_owned();
        let allowed = "flux, or an emission with 0.01 or more of lambert".to_owned();
        reader.fail(&p::EMISSION_KEEP, ValidationCode::Conflict, Some(message), Some(allowed));
        emission
    })
}

/// The emission with the shares that are given instead of its own.
fn with_shares(reader: &mut Reader, named: Emission) -> Emission {
    let given = [&p::DIRECT_UPLIGHT, &p::GROUND_REFLECTANCE]
        .map(|parameter| (reader.text(parameter).is_some(), reader.number(parameter)));
    let [(false, _), (false, _)] = given else {
        let [(_, direct_uplight), (is_ground, ground_reflectance)] = given;
        let parameter = if is_ground { &p::GROUND_REFLECTANCE } else { &p::DIRECT_UPLIGHT };
        let Some(law) = named.law() else {
            let message = "the emission that is given too follows from no such share".to_owned();
            let allowed = "with modern_city, garstang_1986, full_cutoff or no `emission`".to_owned();
            reader.fail(parameter, ValidationCode::Conflict, Some(message), Some(allowed));
            return named;
        };
        let law = GarstangLaw::new(
            direct_uplight.unwrap_or(law.direct_uplight()),
            ground_reflectance.unwrap_or(law.ground_reflectance()),
        );
        return law.map(Emission::from).unwrap_or_else(|_| {
            let message = "lamps that send nothing up over black ground make no sky".to_owned();
            let allowed = "above 0, or with a direct uplight above 0".to_owned();
            reader.fail(parameter, ValidationCode::Conflict, Some(message), Some(allowed));
            named
        });
    };
    named
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        error::AppError,
        parameters::{ParameterSet, SkyParameters},
    };

    fn read(query: &str) -> Result<Emission, Vec<(String, ValidationCode)>> {
        let mut reader = Reader::new(Some(query), SkyParameters::ALL);
        let emission = read_emission(&mut reader);
        match reader.finish() {
            Ok(()) => Ok(emission),
            Err(AppError::Parameters(errors)) => {
                Err(errors.into_iter().map(|error| (error.parameter, error.code)).collect())
            }
            Err(other) => panic!("{other}"),
        }
    }

    /// Presets, older names, weights, and shares in place of a preset's own.
    #[test]
    fn every_way_to_say_an_emission_is_read() {
        let law = |f, g| Emission::from(GarstangLaw::new(f, g).unwrap());
        assert_eq!(read(""), Ok(law(0.02, 0.15)));
        assert_eq!(read("emission=modern_city"), read(""));
        assert_eq!(read("emission=garstang"), Ok(law(0.15, 0.15)));
        assert_eq!(read("emission=shielded"), Ok(law(0.0, 0.15)));
        assert_eq!(read("emission=lambert"), Ok(EmissionMix::lambert().into()));
        assert_eq!(read("emission=1,1,2").unwrap().mix().weights(), [0.25, 0.25, 0.5]);
        assert_eq!(read("direct_uplight=0.05"), Ok(law(0.05, 0.15)));
        assert_eq!(read("ground_reflectance=0.6"), Ok(law(0.02, 0.6)));
        assert_eq!(read("emission=garstang_1986&ground_reflectance=0.6"), Ok(law(0.15, 0.6)));
        let kept = read("emission=garstang_1986&emission_keep=nadir_radiance").unwrap();
        assert!((kept.flux_factor() - 0.2775 / 0.1275).abs() < 1e-12);
        assert_eq!(read("emission_keep=flux"), read(""));
    }

    /// What cannot be meant, or not together, is refused by name.
    #[test]
    fn emissions_that_cannot_be_meant_are_refused() {
        use ValidationCode::{Conflict, NotAllowed};
        for (query, parameter, code) in [
            ("emission=upwards", "emission", NotAllowed),
            ("emission=0,0,0", "emission", NotAllowed),
            ("direct_uplight=1.1", "direct_uplight", NotAllowed),
            ("ground_reflectance=-0.1", "ground_reflectance", NotAllowed),
            ("emission=lambert&direct_uplight=0.1", "direct_uplight", Conflict),
            ("emission=1,1,0&ground_reflectance=0.1", "ground_reflectance", Conflict),
            ("emission=full_cutoff&ground_reflectance=0", "ground_reflectance", Conflict),
            ("emission_keep=calm", "emission_keep", NotAllowed),
            ("emission=0,1,0&emission_keep=nadir_radiance", "emission_keep", Conflict),
            ("direct_uplight=1&emission_keep=nadir_radiance", "emission_keep", Conflict),
        ] {
            assert_eq!(read(query), Err(vec![(parameter.to_owned(), code)]), "{query}");
        }
        assert!(read("emission=0,1,0").is_ok());
    }
}
