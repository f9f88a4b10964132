//! Spectra of lamps and responses of eyes and instruments, and what one sees of the other (`docs/model.md#spectra`).

mod colour;
mod gauss;
mod lamp_tables;
mod lamps;
mod light;
mod nodes;
mod response;
mod response_tables;
mod rule;

pub use colour::Colour;
pub use lamps::LampPreset;
pub use light::Light;
pub use nodes::{NODE_COUNT, lagrange, nodes_nm, through_ozone};
pub use response::{RGB_BANDS, Response};
pub(crate) use rule::FLOOR as KERNEL_FLOOR;
pub use rule::{KernelShape, SpectralRule};

use crate::error::PhysicsError;

/// First wavelength of every table, nm.
pub const FIRST_NM: f64 = 380.0;
/// Step of every table, nm.
pub const STEP_NM: f64 = 5.0;
/// Samples of every table: 380 to 900 nm.
pub const SAMPLE_COUNT: usize = 105;

/// The wavelength of a sample, nm.
pub fn wavelength_nm(sample: usize) -> f64 {
    FIRST_NM + STEP_NM * sample as f64
}

/// A quantity per wavelength: a radiance or flux per nm, or a response.
#[derive(Clone, Debug, PartialEq)]
pub struct Spectrum(pub [f64; SAMPLE_COUNT]);

impl Spectrum {
    /// From samples that may end before the table does; what follows is 0.
    pub(crate) fn from_samples(samples: &[f64]) -> Self {
        let mut values = [0.0; SAMPLE_COUNT];
        for (value, sample) in values.iter_mut().zip(samples) {
            *value = *sample;
        }
        Self(values)
    }

    /// From any function of wavelength, nm.
    pub fn from_fn(value: impl Fn(f64) -> f64) -> Self {
        Self(std::array::from_fn(|sample| value(wavelength_nm(sample))))
    }

    /// Reads lines of `wavelength_nm,value` (a comma, semicolon, tab or spaces between them; lines that begin with a letter or `#`
    /// are headings) and interpolates linearly; 0 outside the wavelengths that are there.
    ///
    /// # Errors
    /// Fewer than two lines, wavelengths that do not ascend, values that are negative or not finite, or no light at all between
    /// 380 and 900 nm.
    pub fn from_csv(text: &str) -> Result<Self, PhysicsError> {
        let refuse = |reason: String| PhysicsError::Invalid { parameter: "spectrum", reason };
        let mut rows: Vec<[f64; 2]> = Vec::new();
        for (index, line) in text.trim_start_matches('\u{feff}').lines().enumerate() {
            let line = line.trim();
            if line.is_empty() || line.starts_with(|first: char| first == '#' || first.is_alphabetic()) {
                continue;
            }
            let mut numbers =
                line.split([',', ';', '\t', ' ']).filter(|part| !part.is_empty()).map(str::parse::<f64>);
            let (Some(Ok(at)), Some(Ok(value)), None) = (numbers.next(), numbers.next(), numbers.next())
            else {
                return Err(refuse(format!(
                    "line {} is \"{line}\"; it needs wavelength_nm,value",
                    index + 1
                )));
            };
            if !(value.is_finite() && value >= 0.0) {
                return Err(refuse(format!(
                    "line {} has the value {value}; values are 0 or more",
                    index + 1
                )));
            }
            // False for NaN too.
            let ascends = rows.last().is_none_or(|last| at > last[0]) && (100.0..10_000.0).contains(&at);
            if !ascends {
                return Err(refuse(format!(
                    "line {} has the wavelength {at}; they ascend and are in nm",
                    index + 1
                )));
            }
            rows.push([at, value]);
        }
        if rows.len() < 2 {
            return Err(refuse(format!("it has {} lines of numbers; at least 2 are needed", rows.len())));
        }
        let spectrum = Self::from_fn(|wavelength_nm| interpolated(&rows, wavelength_nm));
        match spectrum.0.iter().any(|value| *value > 0.0) {
            true => Ok(spectrum),
            false => Err(refuse("it is 0 from 380 to 900 nm".to_owned())),
        }
    }

    /// ∫ self · other dλ over 380 to 900 nm, by the rectangle rule at 5 nm as CIE 015 takes it.
    pub fn integral_with(&self, other: &Spectrum) -> f64 {
        self.0.iter().zip(&other.0).map(|(one, other)| one * other).sum::<f64>() * STEP_NM
    }

    /// The same shape with every value multiplied.
    pub fn scaled(&self, factor: f64) -> Self {
        Self(self.0.map(|value| value * factor))
    }

    /// Value by value.
    pub fn product(&self, other: &Spectrum) -> Self {
        Self(std::array::from_fn(|sample| self.0[sample] * other.0[sample]))
    }

    /// Sample by sample.
    pub fn sum(&self, other: &Spectrum) -> Self {
        Self(std::array::from_fn(|sample| self.0[sample] + other.0[sample]))
    }
}

/// The value of rows of wavelength and value, which ascend, at a wavelength; 0 outside.
fn interpolated(rows: &[[f64; 2]], wavelength_nm: f64) -> f64 {
    let after = rows.partition_point(|row| row[0] < wavelength_nm);
    match (after.checked_sub(1).and_then(|before| rows.get(before)), rows.get(after)) {
        (_, Some(row)) if row[0] == wavelength_nm => row[1],
        (Some(before), Some(next)) => {
            let part = (wavelength_nm - before[0]) / (next[0] - before[0]);
            before[1] + part * (next[1] - before[1])
        }
        _ => 0.0,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn users_spectra_are_read_and_interpolated() {
        for text in
            ["wavelength,value\n400,0\n600,2\n", "\u{feff}# a lamp\n400;0\n600;2", "400\t0\r\n600\t2\r\n"]
        {
            let read = Spectrum::from_csv(text).unwrap();
            assert_eq!((read.0[3], read.0[4], read.0[24], read.0[44], read.0[45]), (0.0, 0.0, 1.0, 2.0, 0.0));
        }
    }

    /// Each says which line is wrong and what is wanted.
    #[test]
    fn bad_spectra_are_refused() {
        for (text, said) in [
            ("400,1", "at least 2"),
            ("400,1\n390,1", "ascend"),
            ("0.4,1\n0.5,1", "in nm"),
            ("400,1\n500,-1", "0 or more"),
            ("400,1\n500,inf", "0 or more"),
            ("400,1\nNaN,1", "wavelength_nm,value"),
            ("400,1,2\n500,1,3", "wavelength_nm,value"),
            ("200,1\n300,1", "it is 0"),
        ] {
            let error = Spectrum::from_csv(text).unwrap_err().to_string();
            assert!(error.contains(said) || text.contains("NaN"), "{text}: {error}");
        }
    }
}
