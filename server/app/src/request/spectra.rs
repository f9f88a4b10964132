//! Lamps and responses as texts: by name, as mixes, as curves of the user's own.

use crate::{parameters as p, reader::Reader, validation::ValidationCode};
use skyglow_physics::{Lamp, LampPreset, PhysicsError, Response, spectrum::Spectrum};
use std::sync::Arc;

/// Most characters of a text that is a curve.
const MAX_CURVE_CHARACTERS: usize = 4_096;

pub(super) fn read_lamp(reader: &mut Reader) -> Lamp {
    let Some(text) = reader.text(&p::LAMP) else { return Lamp::default() };
    lamp_of(text).unwrap_or_else(|reason| {
        reader.fail(&p::LAMP, ValidationCode::NotAllowed, reason, None);
        Lamp::default()
    })
}

/// A lamp by its preset's name, by three fluxes `r,g,b`, as a mix `name:share,…` or as a spectrum `nm:power,…`; the reason why it is
/// none, where one can be given.
pub(super) fn lamp_of(text: &str) -> Result<Lamp, Option<String>> {
    if let Some(preset) = LampPreset::from_name(text) {
        return Ok(preset.lamp());
    }
    if let Some(fluxes) = Reader::three_numbers(text) {
        return Lamp::custom(fluxes).map_err(reason);
    }
    if !text.contains(':') {
        return Err(None);
    }
    if text.starts_with(|first: char| first.is_alphabetic()) {
        return Lamp::mix(&mix_of(text)?).map_err(reason);
    }
    curve_of(text).and_then(|spectrum| Lamp::from_spectrum(&spectrum).map_err(reason))
}

/// Names with shares of lumens.
fn mix_of(text: &str) -> Result<Vec<(LampPreset, f64)>, Option<String>> {
    let part = |part: &str| {
        let (name, share) = part.split_once(':').unwrap_or((part, ""));
        let share = share.trim().parse().map_err(|_| Some(format!("gives {name} no share")))?;
        let lamp = LampPreset::from_name(name.trim());
        Ok((lamp.ok_or_else(|| Some(format!("names {name}, which is no lamp")))?, share))
    };
    text.split(',').map(part).collect()
}

fn curve_of(text: &str) -> Result<Spectrum, Option<String>> {
    if text.len() > MAX_CURVE_CHARACTERS {
        return Err(Some(format!(
            "has more than {MAX_CURVE_CHARACTERS} characters; leave some wavelengths out"
        )));
    }
    let lines = text.replace(',', "\n").replace(':', ",");
    Spectrum::from_csv(&lines).map_err(reason)
}

pub(super) fn read_response(reader: &mut Reader) -> Response {
    let Some(text) = reader.text(&p::RESPONSE) else { return Response::default() };
    response_of(text).unwrap_or_else(|reason| {
        reader.fail(&p::RESPONSE, ValidationCode::NotAllowed, reason, None);
        Response::default()
    })
}

/// A response by its name or as a curve `nm:value,…`.
fn response_of(text: &str) -> Result<Response, Option<String>> {
    match Response::from_name(text) {
        Some(response) => Ok(response),
        None if text.contains(':') => Ok(Response::Custom(Arc::new(curve_of(text)?))),
        None => Err(None),
    }
}

fn reason(error: PhysicsError) -> Option<String> {
    Some(match error {
        PhysicsError::Invalid { reason, .. } => reason,
        other => other.to_string(),
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::answers::LampAnswer;
    use skyglow_physics::LampKind;

    #[test]
    fn lamps_are_names_mixes_bands_or_spectra() {
        assert_eq!(lamp_of("hps"), Ok(LampPreset::Hps.lamp()));
        assert_eq!(lamp_of("0.1,0.2,0.3"), Ok(Lamp::custom([0.1, 0.2, 0.3]).unwrap()));
        let mix = Lamp::mix(&[(LampPreset::Hps, 7.0), (LampPreset::Led4000k, 3.0)]).unwrap();
        assert_eq!(lamp_of("hps:0.7,led_4000k:0.3"), Ok(mix));
        let twice = lamp_of("hps:0.3,led_4000k:0.4,hps:0.3").unwrap();
        let said = LampAnswer::from(&twice).mix.unwrap();
        assert_eq!(
            said.into_iter().collect::<Vec<_>>(),
            [("hps".to_owned(), 0.6), ("led_4000k".to_owned(), 0.4)]
        );
        let own = lamp_of("400:0,500:1.5,600:0").unwrap();
        assert!(matches!(own.kind(), LampKind::Spectrum(samples) if samples[24] == 1.5));
        for (bad, said) in [
            ("candle", None),
            ("1,2", None),
            ("0,0,0", Some("at least one must be positive")),
            ("hps:-1", Some("0 or more")),
            ("candle:1,hps:2", Some("names candle")),
            ("hps:1,led_4000k", Some("no share")),
            ("500:1,400:2", Some("ascend")),
            ("380:1,400:1", Some("sees nothing")),
        ] {
            let reason = lamp_of(bad).unwrap_err();
            match said {
                Some(said) => assert!(
                    reason.as_deref().is_some_and(|reason| reason.contains(said)),
                    "{bad}: {reason:?}"
                ),
                None => assert_eq!(reason, None, "{bad}"),
            }
        }
        let long =
            (0..2_000).map(|at| format!("{}:1", 380.0 + 0.1 * f64::from(at))).collect::<Vec<_>>().join(",");
        assert!(lamp_of(&long).unwrap_err().is_some_and(|reason| reason.contains("characters")));
    }

    #[test]
    fn responses_are_names_or_curves() {
        assert_eq!(response_of("melanopic"), Ok(Response::Melanopic));
        let curve = response_of("500:0,550:1,600:0").unwrap();
        assert!(matches!(curve, Response::Custom(curve) if curve.0[34] == 1.0 && curve.0[44] == 0.0));
        assert_eq!(response_of("eye"), Err(None));
        assert!(response_of("500:1").unwrap_err().is_some());
    }
}
