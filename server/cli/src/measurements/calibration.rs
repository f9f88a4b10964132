//! The calibration of a scene that fits measured skies best: Gauss-Newton least squares in the logarithm of a factor, with a jackknife over
//! places. The definitions are those of `skyglow.measurements.fit_calibration` of the Python package.

use serde::Serialize;
use skyglow_physics::photometry::{brightness_mag_arcsec2, luminance_from_brightness_cd_m2};
use std::f64::consts::LN_10;
use thiserror::Error;

/// Magnitudes a unit of the natural logarithm.
const MAG_PER_LOG: f64 = 2.5 / LN_10;

/// A reading beside the model.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Compared {
    pub(crate) latitude_deg: f64,
    pub(crate) longitude_deg: f64,
    /// Measured.
    pub(crate) brightness_mag_arcsec2: f64,
    /// What a Sky Quality Meter would read by the model.
    pub(crate) model_mag_arcsec2: f64,
    /// Its artificial part.
    pub(crate) model_artificial_cd_m2: f64,
}

impl Compared {
    /// The natural part of the model.
    pub(crate) fn model_natural_cd_m2(&self) -> f64 {
        luminance_from_brightness_cd_m2(self.model_mag_arcsec2) - self.model_artificial_cd_m2
    }

    /// Reading less model: positive where it is darker than the model.
    pub(crate) fn residual_mag_arcsec2(&self) -> f64 {
        self.brightness_mag_arcsec2 - self.model_mag_arcsec2
    }

    /// Reading less a model whose artificial light has a factor, and how the model's magnitudes change with its logarithm.
    fn misfit(&self, log_factor: f64) -> (f64, f64) {
        let lit_cd_m2 = log_factor.exp() * self.model_artificial_cd_m2;
        let all_cd_m2 = lit_cd_m2 + self.model_natural_cd_m2();
        let model = brightness_mag_arcsec2(all_cd_m2).unwrap_or(f64::NAN);
        (self.brightness_mag_arcsec2 - model, -MAG_PER_LOG * lit_cd_m2 / all_cd_m2)
    }
}

/// A factor on a scene's light with which the model agrees best with readings.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub(crate) struct Calibration {
    /// Relative to the scene as it is.
    pub(crate) factor: f64,
    /// Of the factor's natural logarithm. A jackknife over places; of one place that of readings that are independent, which is too small.
    pub(crate) log_standard_error: f64,
    /// The factor less and more one standard error.
    pub(crate) interval: [f64; 2],
    /// What to ingest the scene with.
    pub(crate) calibration: f64,
    pub(crate) rms_before_mag: f64,
    pub(crate) rms_after_mag: f64,
    /// Readings with artificial light in the model.
    pub(crate) readings: usize,
    pub(crate) places: usize,
}

/// Why there is no factor.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub(crate) enum FitError {
    /// Too little to fit.
    #[error("{readings} readings with artificial light in the model: a fit needs two or more")]
    TooFew {
        /// How many there are.
        readings: usize,
    },
    /// Readings that no artificial light explains.
    #[error(
        "no factor fits: the readings are as dark as the natural sky, or brighter than any light explains"
    )]
    NoFactor,
}

/// The factor on artificial light that makes residuals smallest.
///
/// * `of_scene`: the calibration of the scene as it is.
pub(crate) fn fit(compared: &[Compared], of_scene: f64) -> Result<Calibration, FitError> {
    let used: Vec<Compared> =
        compared.iter().copied().filter(|one| one.model_artificial_cd_m2 > 0.0).collect();
    if used.len() < 2 {
        return Err(FitError::TooFew { readings: used.len() });
    }
    let log_factor = log_factor_of(used.iter())?;
    let mut places: Vec<(f64, f64)> = Vec::new();
    for place in used.iter().map(place_of) {
        if !places.contains(&place) {
            places.push(place);
        }
    }
    let log_standard_error = if places.len() > 1 {
        let without = |place: &(f64, f64)| log_factor_of(used.iter().filter(|one| place_of(one) != *place));
        let found = places.iter().map(without).collect::<Result<Vec<f64>, FitError>>()?;
        let count = places.len() as f64;
        let mean = found.iter().sum::<f64>() / count;
        ((count - 1.0) / count * found.iter().map(|one| (one - mean).powi(2)).sum::<f64>()).sqrt()
    } else {
        let (left, slope) = sums_of_squares(used.iter().map(|one| one.misfit(log_factor)));
        (left / (used.len() - 1) as f64 / slope).sqrt()
    };
    let rms = |log_factor: f64| {
        (sums_of_squares(used.iter().map(|one| one.misfit(log_factor))).0 / used.len() as f64).sqrt()
    };
    let (factor, spread) = (log_factor.exp(), log_standard_error.exp());
    Ok(Calibration {
        factor,
        log_standard_error,
        interval: [factor / spread, factor * spread],
        calibration: factor * of_scene,
        rms_before_mag: rms(0.0),
        rms_after_mag: rms(log_factor),
        readings: used.len(),
        places: places.len(),
    })
}

fn place_of(compared: &Compared) -> (f64, f64) {
    (compared.latitude_deg, compared.longitude_deg)
}

/// Σ of the squares of residuals, and of slopes.
fn sums_of_squares(misfits: impl Iterator<Item = (f64, f64)>) -> (f64, f64) {
    misfits.fold((0.0, 0.0), |(left, slope), misfit| (left + misfit.0.powi(2), slope + misfit.1.powi(2)))
}

fn log_factor_of<'a>(used: impl Iterator<Item = &'a Compared> + Clone) -> Result<f64, FitError> {
    let mut log_factor = 0.0_f64;
    for _ in 0..100 {
        let misfits = used.clone().map(|one| one.misfit(log_factor));
        let along: f64 = misfits.clone().map(|(left, slope)| left * slope).sum();
        // A dark sky says little about the factor: a step is held to a factor of e.
        let step = (along / sums_of_squares(misfits).1).clamp(-1.0, 1.0);
        log_factor += step;
        if step.abs() < 1e-10 {
            return Ok(log_factor);
        }
        if log_factor.is_nan() || log_factor.abs() > 20.0 {
            break;
        }
    }
    Err(FitError::NoFactor)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Readings at a place of a sky with so much artificial light, as if it had a factor and an error.
    fn read(place: u32, artificial_cd_m2: f64, factor: f64, error_mag: f64) -> Compared {
        let natural_cd_m2 = 1.8e-4;
        let magnitude = |luminance_cd_m2: f64| brightness_mag_arcsec2(luminance_cd_m2).unwrap();
        Compared {
            latitude_deg: 46.0 + f64::from(place),
            longitude_deg: 8.0,
            brightness_mag_arcsec2: magnitude(factor * artificial_cd_m2 + natural_cd_m2) + error_mag,
            model_mag_arcsec2: magnitude(artificial_cd_m2 + natural_cd_m2),
            model_artificial_cd_m2: artificial_cd_m2,
        }
    }

    /// Exact readings give their factor back, without an error.
    #[test]
    fn a_known_calibration_is_found() {
        for factor in [0.4, 1.0, 1.6] {
            let readings: Vec<Compared> =
                (0..6).map(|place| read(place, 1e-4 * f64::from(1 << place), factor, 0.0)).collect();
            let found = fit(&readings, 2.0).unwrap();
            assert!((found.factor / factor - 1.0).abs() < 1e-9, "{found:?}");
            assert!((found.calibration / (2.0 * factor) - 1.0).abs() < 1e-9);
            assert!(found.log_standard_error < 1e-9 && found.rms_after_mag < 1e-9);
            assert_eq!((found.readings, found.places), (6, 6));
        }
    }

    /// What the Python package finds of the same readings.
    #[test]
    fn a_fit_is_that_of_the_python_package() {
        let errors_mag = [0.05, -0.08, 0.02, 0.11];
        let of_places = [(0, 1e-4), (0, 1e-4), (1, 9e-4), (2, 4e-3)];
        let readings: Vec<Compared> = of_places
            .iter()
            .zip(errors_mag)
            .map(|(&(place, artificial_cd_m2), error)| read(place, artificial_cd_m2, 1.3, error))
            .collect();
        let found = fit(&readings, 1.0).unwrap();
        let numbers = [found.factor, found.log_standard_error, found.rms_before_mag, found.rms_after_mag];
        for (number, wanted) in numbers.iter().zip(PYTHON) {
            assert!((number / wanted - 1.0).abs() < 1e-9, "{numbers:?}");
        }
        assert_eq!(found.places, 3);
        let one_place = fit(&readings[..2], 1.0).unwrap();
        assert!((one_place.log_standard_error / PYTHON_OF_ONE_PLACE - 1.0).abs() < 1e-9, "{one_place:?}");
    }
    /// Factor, standard error, and deviations before and after.
    const PYTHON: [f64; 4] =
        [1.235499543163812, 0.04283905588983475, 0.17048621783921541, 0.06182409846692378];
    const PYTHON_OF_ONE_PLACE: f64 = 0.14009873116773403;

    #[test]
    fn what_cannot_be_fitted_is_refused() {
        let one = read(0, 1e-3, 1.0, 0.0);
        assert_eq!(fit(&[one], 1.0), Err(FitError::TooFew { readings: 1 }));
        let unlit = Compared { model_artificial_cd_m2: 0.0, ..one };
        assert_eq!(fit(&[unlit; 3], 1.0), Err(FitError::TooFew { readings: 0 }));
        let dark = Compared { brightness_mag_arcsec2: 25.0, ..one };
        assert_eq!(fit(&[dark; 3], 1.0), Err(FitError::NoFactor));
    }
}
