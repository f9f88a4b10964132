//! Units of radiance and of length, from the options, from a raster's metadata, and from what the numbers look like.

use crate::error::SceneError;
use serde::{Deserialize, Serialize};

/// The unit of the raster's radiances.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum RadianceUnit {
    /// nW cm⁻² sr⁻¹, as the VIIRS products have it.
    NanowattPerSquareCentimetreSteradian,
    /// µW cm⁻² sr⁻¹.
    MicrowattPerSquareCentimetreSteradian,
    /// W cm⁻² sr⁻¹, as the granules of VIIRS swaths have it.
    WattPerSquareCentimetreSteradian,
    /// µW m⁻² sr⁻¹.
    MicrowattPerSquareMetreSteradian,
    /// mW m⁻² sr⁻¹.
    MilliwattPerSquareMetreSteradian,
    /// W m⁻² sr⁻¹.
    WattPerSquareMetreSteradian,
}

/// Mean of the lit pixels of any real raster, nW cm⁻² sr⁻¹: from the dimmest countryside to a city cut out by itself.
const PLAUSIBLE_LIT_MEAN_NW_CM2_SR: std::ops::RangeInclusive<f64> = 0.05..=2_000.0;

/// That of a region, as it mostly is.
const USUAL_LIT_MEAN_NW_CM2_SR: f64 = 5.0;

impl RadianceUnit {
    /// All of them, the most usual first.
    pub const ALL: [Self; 6] = [
        Self::NanowattPerSquareCentimetreSteradian,
        Self::WattPerSquareMetreSteradian,
        Self::WattPerSquareCentimetreSteradian,
        Self::MilliwattPerSquareMetreSteradian,
        Self::MicrowattPerSquareCentimetreSteradian,
        Self::MicrowattPerSquareMetreSteradian,
    ];

    /// The command line's spelling.
    pub const fn name(self) -> &'static str {
        match self {
            Self::NanowattPerSquareCentimetreSteradian => "nw-cm2-sr",
            Self::MicrowattPerSquareCentimetreSteradian => "uw-cm2-sr",
            Self::WattPerSquareCentimetreSteradian => "w-cm2-sr",
            Self::MicrowattPerSquareMetreSteradian => "uw-m2-sr",
            Self::MilliwattPerSquareMetreSteradian => "mw-m2-sr",
            Self::WattPerSquareMetreSteradian => "w-m2-sr",
        }
    }

    /// From the command line's spelling, such as `nw-cm2-sr`.
    ///
    /// # Errors
    /// [`SceneError::InvalidOption`].
    pub fn parse(text: &str) -> Result<Self, SceneError> {
        Self::ALL.into_iter().find(|unit| unit.name() == text).ok_or_else(|| SceneError::InvalidOption {
            option: "--units",
            reason: format!("\"{text}\" is no unit; {} are known", Self::ALL.map(Self::name).join(", ")),
        })
    }

    /// nW cm⁻² sr⁻¹ in one of the unit.
    pub fn nw_cm2_sr(self) -> f64 {
        match self {
            Self::NanowattPerSquareCentimetreSteradian => 1.0,
            Self::MicrowattPerSquareCentimetreSteradian => 1e3,
            Self::WattPerSquareCentimetreSteradian => 1e9,
            Self::MicrowattPerSquareMetreSteradian => 0.1,
            Self::MilliwattPerSquareMetreSteradian => 1e2,
            Self::WattPerSquareMetreSteradian => 1e5,
        }
    }

    /// From a raster's own words, such as `nWatts/(cm^2 sr)`, `W m-2 sr-1`, `µW·cm⁻²·sr⁻¹`; None for what is no such unit.
    pub(super) fn from_metadata(text: &str) -> Option<Self> {
        let words = unit_words(text);
        let power = words.iter().find_map(|word| match word.as_str() {
            "nw" | "nanow" => Some('n'),
            "uw" | "microw" => Some('u'),
            "mw" | "milliw" => Some('m'),
            "w" => Some('1'),
            _ => None,
        })?;
        let area = words.iter().find_map(|word| match word.as_str() {
            "cm" => Some('c'),
            "m" => Some('m'),
            _ => None,
        })?;
        match (power, area) {
            ('n', 'c') => Some(Self::NanowattPerSquareCentimetreSteradian),
            ('u', 'c') => Some(Self::MicrowattPerSquareCentimetreSteradian),
            ('1', 'c') => Some(Self::WattPerSquareCentimetreSteradian),
            ('u', 'm') => Some(Self::MicrowattPerSquareMetreSteradian),
            ('m', 'm') => Some(Self::MilliwattPerSquareMetreSteradian),
            ('1', 'm') => Some(Self::WattPerSquareMetreSteradian),
            _ => None,
        }
    }

    /// The units in which numbers with this mean of the lit would be radiances of the Earth at night, in words, the likeliest first;
    /// None where there is none.
    ///
    /// * `mean`: as it is stored. `taken`: the unit that was taken, which makes it none.
    pub(super) fn advice(mean: f64, taken: Option<Self>) -> Option<String> {
        let in_nw = |unit: Self| mean * unit.nw_cm2_sr();
        let mut units: Vec<Self> = (Self::ALL.into_iter())
            .filter(|unit| Some(*unit) != taken)
            .filter(|unit| PLAUSIBLE_LIT_MEAN_NW_CM2_SR.contains(&in_nw(*unit)))
            .collect();
        let unlikely = |unit: Self| (in_nw(unit) / USUAL_LIT_MEAN_NW_CM2_SR).ln().abs();
        units.sort_by(|a, b| unlikely(*a).total_cmp(&unlikely(*b)));
        let each: Vec<String> =
            units.iter().map(|unit| format!("{:.2} nW cm-2 sr-1 in {}", in_nw(*unit), unit.name())).collect();
        (!each.is_empty()).then(|| {
            format!(
                "it would be {}, and that of a region is around {USUAL_LIT_MEAN_NW_CM2_SR}",
                each.join(", ")
            )
        })
    }
}

/// The words of a unit in lower case without exponents: "nWatts/(cm^2 sr)" gives nw, cm, sr.
fn unit_words(text: &str) -> Vec<String> {
    let plain: String = text
        .chars()
        .map(|c| match c {
            'µ' | 'μ' => 'u',
            c if c.is_ascii_alphabetic() => c.to_ascii_lowercase(),
            _ => ' ',
        })
        .collect();
    let short = |word: &str| {
        let mut word = word.to_owned();
        for (long, unit) in [
            ("watts", "w"),
            ("watt", "w"),
            ("centimeters", "cm"),
            ("centimetres", "cm"),
            ("centimeter", "cm"),
            ("centimetre", "cm"),
            ("meters", "m"),
            ("metres", "m"),
            ("meter", "m"),
            ("metre", "m"),
        ] {
            word = word.replace(long, unit);
        }
        word
    };
    plain.split_whitespace().map(short).collect()
}

/// Metres in one of a raster's unit of elevation; None for words that are no length.
pub(super) fn metres_in(text: &str) -> Option<f64> {
    let key: String = text.chars().filter(char::is_ascii_alphanumeric).collect::<String>().to_lowercase();
    match key.as_str() {
        "m" | "meter" | "meters" | "metre" | "metres" => Some(1.0),
        "ft" | "foot" | "feet" | "footinternational" | "internationalfoot" | "internationalfeet"
        | "feetinternational" => Some(0.3048),
        "ftus" | "usft" | "ussurveyfoot" | "ussurveyfeet" | "footus" | "usfoot" | "usfeet" | "surveyfoot"
        | "ussurveyft" => Some(1200.0 / 3937.0),
        "dm" | "decimeter" | "decimeters" | "decimetre" | "decimetres" => Some(0.1),
        "cm" | "centimeter" | "centimeters" | "centimetre" | "centimetres" => Some(0.01),
        "mm" | "millimeter" | "millimeters" | "millimetre" | "millimetres" => Some(0.001),
        "km" | "kilometer" | "kilometers" | "kilometre" | "kilometres" => Some(1_000.0),
        "yd" | "yard" | "yards" => Some(0.9144),
        "fathom" | "fathoms" => Some(1.8288),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Units are read as products and people spell them.
    #[test]
    fn units_are_read_in_all_spellings() {
        use RadianceUnit as U;
        for (text, unit) in [
            ("nWatts/(cm^2 sr)", U::NanowattPerSquareCentimetreSteradian),
            ("nW·cm⁻²·sr⁻¹", U::NanowattPerSquareCentimetreSteradian),
            ("nanoWatts/cm2/sr", U::NanowattPerSquareCentimetreSteradian),
            ("nWatts-cm-2-sr-1", U::NanowattPerSquareCentimetreSteradian),
            ("W m-2 sr-1", U::WattPerSquareMetreSteradian),
            ("Watts/meter^2/steradian", U::WattPerSquareMetreSteradian),
            ("W/cm2/sr", U::WattPerSquareCentimetreSteradian),
            ("W/(cm^2 sr)", U::WattPerSquareCentimetreSteradian),
            ("mW m-2 sr-1", U::MilliwattPerSquareMetreSteradian),
            ("µW/m²/sr", U::MicrowattPerSquareMetreSteradian),
        ] {
            assert_eq!(U::from_metadata(text), Some(unit), "{text}");
        }
        for text in ["", "1", "DN", "cd/m2", "metre", "unitless"] {
            assert_eq!(U::from_metadata(text), None, "{text}");
        }
        for unit in U::ALL {
            assert_eq!(U::parse(unit.name()).unwrap(), unit);
        }
    }

    /// The likeliest unit comes first, and every one that makes the mean a radiance of the Earth at night is named.
    #[test]
    fn advised_units_give_plausible_means() {
        use RadianceUnit as U;
        for mean_nw in [0.3, 3.0, 30.0] {
            for unit in U::ALL {
                let advice = U::advice(mean_nw / unit.nw_cm2_sr(), None).unwrap();
                assert!(
                    advice.contains(&format!("{mean_nw:.2} nW cm-2 sr-1 in {}", unit.name())),
                    "{advice}"
                );
            }
        }
        let advice = U::advice(6.46e-3, Some(U::NanowattPerSquareCentimetreSteradian)).unwrap();
        assert!(advice.starts_with("it would be 6.46 nW cm-2 sr-1 in uw-cm2-sr, 0.65"), "{advice}");
        assert_eq!(U::advice(1e-30, None), None);
    }

    #[test]
    fn lengths_are_read() {
        assert_eq!(metres_in("ft"), Some(0.3048));
        assert_eq!(metres_in("US survey foot"), Some(1200.0 / 3937.0));
        assert_eq!(metres_in("Metre"), Some(1.0));
        assert_eq!(metres_in("degC"), None);
    }
}
