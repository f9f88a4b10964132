//! Which stored numbers are no measurement: what the file or the options declare, compared in the band's own type, and values
//! that programs fill gaps with.

use gdal::raster::{GdalDataType, RasterBand};

/// Attributes that name a value of no data, in lower case; in HDF5 groups and the dataset stand before them.
const NO_DATA_KEYS: [&str; 6] =
    ["_fillvalue", "fillvalue", "missing_value", "nodata", "no_data", "nodata_value"];
/// No noise of any instrument reaches below this, nW cm⁻² sr⁻¹: what does is a fill.
const MIN_NOISE_NW_CM2_SR: f64 = -90.0;
/// Largest numbers of integer types, as they are and in tenths, where a float raster was made of counts without their fill value.
const COUNT_FILLS: [f64; 4] = [65_535.0, 6_553.5, 32_767.0, 3_276.7];
/// Above this no number is a radiance: 1e20, 9.97e36 of NetCDF and 3.4e38 are fills.
const MAX_NUMBER: f64 = 1e15;

/// What of a band's stored numbers is no measurement.
#[derive(Clone, Debug)]
pub(super) struct NoData {
    declared: Vec<f64>,
    /// Inclusive range of measurements, as stored.
    valid: [f64; 2],
    single_precision: bool,
    integer_ends: Option<[f64; 2]>,
    /// 0 is declared no data and means dark.
    zero_is_dark: bool,
}

/// What a stored number is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    /// A measurement, or NaN and infinity.
    Number,
    /// Declared no data.
    NoData,
    /// Nobody says so, but it fills gaps.
    Fill,
}

impl NoData {
    /// Of a band with its attributes `key=value`; `own` are those of the options.
    pub(super) fn of(band: &RasterBand<'_>, attributes: &[String], own: &[f64]) -> Self {
        let mut declared = own.to_vec();
        declared.extend(band.no_data_value());
        let mut valid = [f64::NEG_INFINITY, f64::INFINITY];
        for (key, value) in attributes.iter().filter_map(|item| item.split_once('=')) {
            let key = key.to_lowercase();
            let numbers = numbers(value);
            if NO_DATA_KEYS.iter().any(|name| key.ends_with(name)) {
                declared.extend(&numbers);
            } else if key.ends_with("valid_range") && numbers.len() == 2 {
                valid = [valid[0].max(numbers[0]), valid[1].min(numbers[1])];
            } else if key.ends_with("valid_min") {
                valid[0] = numbers.first().map_or(valid[0], |n| valid[0].max(*n));
            } else if key.ends_with("valid_max") {
                valid[1] = numbers.first().map_or(valid[1], |n| valid[1].min(*n));
            }
        }
        if valid[0] >= valid[1] {
            valid = [f64::NEG_INFINITY, f64::INFINITY];
        }
        let kind = band.band_type();
        Self {
            declared,
            valid,
            single_precision: matches!(kind, GdalDataType::Float32),
            integer_ends: integer_ends(kind),
            zero_is_dark: false,
        }
    }

    /// Adds a value where none is declared.
    pub(super) fn or_declare(&mut self, value: f64) {
        if self.declared.is_empty() {
            self.declared.push(value);
        }
    }

    /// Whether 0 is declared no data.
    pub(super) fn has_zero(&self) -> bool {
        self.declared.contains(&0.0)
    }

    /// Takes 0 for dark ground, whatever is declared.
    pub(super) fn take_zero_for_dark(&mut self) {
        self.zero_is_dark = true;
    }

    /// What a stored number is, which is `radiance` nW cm⁻² sr⁻¹ after scaling.
    pub(super) fn kind(&self, stored: f64, radiance: f64) -> Kind {
        if stored == 0.0 && self.zero_is_dark {
            return Kind::Number;
        }
        if self.declared.iter().any(|&declared| self.is_same(stored, declared)) {
            return Kind::NoData;
        }
        if stored < self.valid[0] || stored > self.valid[1] {
            return Kind::NoData;
        }
        if !stored.is_finite() {
            return Kind::Number;
        }
        let is_fill = match self.integer_ends {
            Some([lowest, highest]) => stored == highest || (lowest < 0.0 && stored == lowest),
            None => {
                COUNT_FILLS.iter().any(|&fill| stored == fill || stored as f32 == fill as f32)
                    || stored.abs() > MAX_NUMBER
            }
        };
        if is_fill || radiance < MIN_NOISE_NW_CM2_SR || is_gap_code(stored) {
            Kind::Fill
        } else {
            Kind::Number
        }
    }

    /// Declared values compare in the band's own precision; text in a tag may have lost digits of the largest floats.
    fn is_same(&self, stored: f64, declared: f64) -> bool {
        stored == declared
            || (stored.is_nan() && declared.is_nan())
            || (self.single_precision && stored as f32 == declared as f32)
            || (declared.abs() > 1e30 && stored.abs() > 1e30 && stored.signum() == declared.signum())
            || (self.integer_ends.is_none()
                && declared != 0.0
                && (stored - declared).abs() <= 1e-6 * declared.abs())
    }
}

/// Negative codes for gaps, such as -999, -999.3 and -9999, also where a scale makes a small number of them.
fn is_gap_code(stored: f64) -> bool {
    stored <= -99.0 && {
        let digits = (-stored).trunc() as u64;
        [99, 999, 9_999, 99_999, 32_767, 32_768].contains(&digits)
    }
}

/// Lowest and highest number of an integer type; None for floats.
fn integer_ends(kind: GdalDataType) -> Option<[f64; 2]> {
    Some(match kind {
        GdalDataType::UInt8 => [0.0, 255.0],
        GdalDataType::UInt16 => [0.0, 65_535.0],
        GdalDataType::Int16 => [-32_768.0, 32_767.0],
        GdalDataType::UInt32 => [0.0, f64::from(u32::MAX)],
        GdalDataType::Int32 => [f64::from(i32::MIN), f64::from(i32::MAX)],
        GdalDataType::UInt64 => [0.0, u64::MAX as f64],
        GdalDataType::Int64 => [i64::MIN as f64, i64::MAX as f64],
        _ => return None,
    })
}

/// The numbers in an attribute's text: `65535`, `{0, 65534}`, `-999.9f`.
fn numbers(text: &str) -> Vec<f64> {
    text.split(|c: char| c.is_whitespace() || ",;{}[]()".contains(c))
        .filter_map(|word| word.trim_end_matches(['f', 'F']).parse().ok())
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn floats(declared: &[f64]) -> NoData {
        NoData {
            declared: declared.to_vec(),
            valid: [f64::NEG_INFINITY, f64::INFINITY],
            single_precision: true,
            integer_ends: None,
            zero_is_dark: false,
        }
    }

    /// A declared value is met in the band's own precision.
    #[test]
    fn declared_values_compare_in_the_bands_type() {
        let no_data = floats(&[-999.9]);
        assert_eq!(no_data.kind(f64::from(-999.9f32), -999.9), Kind::NoData);
        assert_eq!(floats(&[-3.4e38]).kind(f64::from(f32::MIN), -3.4e38), Kind::NoData);
        assert_eq!(floats(&[f64::NAN]).kind(f64::NAN, f64::NAN), Kind::NoData);
        assert_eq!(floats(&[0.0]).kind(1e-9, 1e-9), Kind::Number);
    }

    /// Values that fill gaps are no light and no darkness, declared or not.
    #[test]
    fn undeclared_fills_are_found() {
        let no_data = floats(&[]);
        for fill in [-9999.0, -999.3, -999.9, -99.0, -3.4028234663852886e38, 65_535.0, 6_553.5, 1e20] {
            assert_eq!(no_data.kind(f64::from(fill as f32), fill), Kind::Fill, "{fill}");
        }
        for number in [-1.5, -20.0, 0.0, 3.0, 3_000.0, 65_534.0, 9_999.0, f64::NAN, f64::INFINITY] {
            assert_eq!(no_data.kind(number, number), Kind::Number, "{number}");
        }
    }

    #[test]
    fn numbers_are_found_in_attributes() {
        assert_eq!(numbers("{0, 65534}"), [0.0, 65_534.0]);
        assert_eq!(numbers("-999.9f"), [-999.9]);
        assert_eq!(numbers("none"), Vec::<f64>::new());
    }
}
