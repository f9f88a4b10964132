//! Reads a query string against the table of parameters; collects every mistake before it gives up.

use crate::{
    error::AppError,
    parameters::{Kind, Parameter},
    validation::{FieldError, ValidationCode, echo},
};

/// At most this many mistakes are listed.
const MAX_ERRORS: usize = 32;

/// A query string taken apart, and what is wrong with it so far.
#[derive(Debug)]
pub struct Reader {
    values: Vec<(&'static str, String)>,
    errors: Vec<FieldError>,
}

impl Reader {
    /// Splits a raw query string (without its `?`); unknown and repeated parameters are mistakes.
    pub fn new(query: Option<&str>, known: &'static [Parameter]) -> Self {
        let mut reader = Self { values: Vec::new(), errors: Vec::new() };
        for (name, value) in form_urlencoded::parse(query.unwrap_or_default().as_bytes()) {
            let Some(parameter) = known.iter().find(|parameter| parameter.name == name) else {
                let names: Vec<&str> = known.iter().map(|parameter| parameter.name).collect();
                let allowed =
                    if names.is_empty() { "no parameters here".to_owned() } else { names.join(", ") };
                reader.push(
                    &echo(&name),
                    Some(echo(&value)),
                    allowed,
                    ValidationCode::UnknownParameter,
                    None,
                );
                continue;
            };
            if reader.values.iter().any(|(given, _)| *given == parameter.name) {
                reader.push(
                    parameter.name,
                    Some(echo(&value)),
                    "one value".to_owned(),
                    ValidationCode::Repeated,
                    None,
                );
                continue;
            }
            reader.values.push((parameter.name, value.into_owned()));
        }
        reader
    }

    fn push(
        &mut self,
        parameter: &str,
        value: Option<String>,
        allowed: String,
        code: ValidationCode,
        message: Option<String>,
    ) {
        let message = message.unwrap_or_else(|| code.description().to_owned());
        self.fail_field(FieldError { parameter: parameter.to_owned(), value, allowed, message, code });
    }

    /// Notes a mistake in something that is no query parameter.
    pub fn fail_field(&mut self, error: FieldError) {
        if self.errors.len() < MAX_ERRORS {
            self.errors.push(error);
        }
    }

    /// Notes a mistake in a parameter that is given; `allowed` from the table where None.
    pub fn fail(
        &mut self,
        parameter: &Parameter,
        code: ValidationCode,
        message: Option<String>,
        allowed: Option<String>,
    ) {
        let value = self.text(parameter).map(echo);
        self.push(parameter.name, value, allowed.unwrap_or_else(|| parameter.allowed()), code, message);
    }

    /// The value of a parameter as it came.
    pub fn text(&self, parameter: &Parameter) -> Option<&str> {
        self.values.iter().find(|(name, _)| *name == parameter.name).map(|(_, value)| value.as_str())
    }

    /// A finite number, its range not checked; None where absent or unreadable (then noted).
    pub fn number_of_any_size(&mut self, parameter: &Parameter) -> Option<f64> {
        let text = self.text(parameter)?;
        match text.trim().parse::<f64>() {
            Ok(number) if number.is_finite() => Some(number),
            _ => {
                self.fail(parameter, ValidationCode::Malformed, Some("is not a number".to_owned()), None);
                None
            }
        }
    }

    /// A number in the range of the table; None where absent or wrong (then noted).
    pub fn number(&mut self, parameter: &Parameter) -> Option<f64> {
        let number = self.number_of_any_size(parameter)?;
        if let Kind::Number { minimum, maximum, .. } = parameter.kind
            && !(minimum..=maximum).contains(&number)
        {
            self.fail(parameter, ValidationCode::NotAllowed, None, None);
            return None;
        }
        Some(number)
    }

    /// A number that must be given.
    pub fn required_number(&mut self, parameter: &Parameter) -> Option<f64> {
        if self.text(parameter).is_none() {
            self.fail(parameter, ValidationCode::Missing, None, None);
            return None;
        }
        self.number(parameter)
    }

    /// A whole number, its range not checked; None where absent or unreadable (then noted).
    pub fn whole_number_of_any_size(&mut self, parameter: &Parameter) -> Option<i64> {
        let text = self.text(parameter)?;
        let number = text.trim().parse::<i64>().ok();
        if number.is_none() {
            self.fail(parameter, ValidationCode::Malformed, Some("is not a whole number".to_owned()), None);
        }
        number
    }

    /// A whole number in the range of the table; None where absent or wrong (then noted).
    pub fn integer(&mut self, parameter: &Parameter) -> Option<u32> {
        let number = self.whole_number_of_any_size(parameter)?;
        match (parameter.kind, u32::try_from(number)) {
            (Kind::Integer { minimum, maximum }, Ok(number)) if (minimum..=maximum).contains(&number) => {
                Some(number)
            }
            _ => {
                self.fail(parameter, ValidationCode::NotAllowed, None, None);
                None
            }
        }
    }

    /// One of the words of the table; None where absent or wrong (then noted).
    pub fn choice(&mut self, parameter: &Parameter) -> Option<&'static str> {
        let text = self.text(parameter)?;
        let Kind::Choice(words) = parameter.kind else { return None };
        let found = words.iter().copied().find(|word| *word == text);
        if found.is_none() {
            self.fail(parameter, ValidationCode::NotAllowed, None, None);
        }
        found
    }

    /// Three numbers separated by commas; None where the text is something else.
    pub fn three_numbers(text: &str) -> Option<[f64; 3]> {
        let mut parts = text.split(',').map(|part| part.trim().parse::<f64>().ok());
        let numbers = [parts.next()??, parts.next()??, parts.next()??];
        (parts.next().is_none() && numbers.iter().all(|n| n.is_finite())).then_some(numbers)
    }

    /// Ends the reading.
    ///
    /// # Errors
    /// [`AppError::Parameters`] with every mistake noted.
    pub fn finish(self) -> Result<(), AppError> {
        if self.errors.is_empty() { Ok(()) } else { Err(AppError::Parameters(self.errors)) }
    }

    /// Whether nothing is wrong so far.
    pub fn is_fine(&self) -> bool {
        self.errors.is_empty()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::parameters::{self, ParameterSet, SkyParameters};

    fn mistakes(query: &str, read: impl Fn(&mut Reader)) -> Vec<(String, ValidationCode)> {
        let mut reader = Reader::new(Some(query), SkyParameters::ALL);
        read(&mut reader);
        match reader.finish() {
            Ok(()) => Vec::new(),
            Err(AppError::Parameters(errors)) => {
                errors.into_iter().map(|error| (error.parameter, error.code)).collect()
            }
            Err(other) => panic!("{other}"),
        }
    }

    #[test]
    fn every_mistake_is_named_in_one_answer() {
        let found = mistakes("lat=91&lon=x&colour=red&lat=2&terrain=maybe&basis=0", |reader| {
            reader.required_number(&parameters::LAT);
            reader.required_number(&parameters::LON);
            reader.choice(&parameters::TERRAIN);
            reader.integer(&parameters::BASIS);
        });
        let expected = [
            ("colour", ValidationCode::UnknownParameter),
            ("lat", ValidationCode::Repeated),
            ("lat", ValidationCode::NotAllowed),
            ("lon", ValidationCode::Malformed),
            ("terrain", ValidationCode::NotAllowed),
            ("basis", ValidationCode::NotAllowed),
        ];
        assert_eq!(found, expected.map(|(name, code)| (name.to_owned(), code)));
    }

    #[test]
    fn nan_and_infinity_are_no_numbers() {
        for bad in ["NaN", "inf", "-infinity", "1e999", "", "1,5", "0x10"] {
            let found = mistakes(&format!("lat={bad}"), |reader| {
                reader.required_number(&parameters::LAT);
            });
            assert_eq!(found, [("lat".to_owned(), ValidationCode::Malformed)], "{bad}");
        }
    }

    #[test]
    fn three_numbers_are_three_and_finite() {
        assert_eq!(Reader::three_numbers("1, 2.5,3e-1"), Some([1.0, 2.5, 0.3]));
        for bad in ["1,2", "1,2,3,4", "a,b,c", "1,,3", "", "1,2,NaN"] {
            assert_eq!(Reader::three_numbers(bad), None, "{bad}");
        }
    }

    #[test]
    fn a_flood_of_mistakes_is_cut_short() {
        let query: String = (0..500).map(|i| format!("x{i}={}&", "y".repeat(300))).collect();
        let mut reader = Reader::new(Some(&query), SkyParameters::ALL);
        reader.fail(&parameters::LAT, ValidationCode::Missing, None, None);
        let Err(AppError::Parameters(errors)) = reader.finish() else { panic!("accepted") };
        assert_eq!(errors.len(), MAX_ERRORS);
        assert!(errors.iter().all(|e| e.value.as_ref().is_none_or(|v| v.chars().count() <= 101)));
    }
}
