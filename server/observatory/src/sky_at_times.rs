//! How a night goes over a place: the sky at several times, of which the artificial part is one rendered before.

use crate::{
    error::ObservatoryError,
    night_sky::{NightSky, Overhead, SkyTime},
    observatory::Observatory,
    sky::{RenderedSky, SkyRequest, responses_of},
};
use rayon::prelude::*;
use skyglow_celestial::BodiesAnswer;
use skyglow_physics::{
    ELEVATION_COUNT, Horizon, Response, SkyQuantities,
    panorama::{AZIMUTH_COUNT, elevation_rad, solid_angle_sr},
};

/// Elevation up to which the sky is that at the horizon, degrees.
pub const HORIZON_ENDS_DEG: f64 = 10.0;

/// The sky at a time.
#[derive(Clone, Debug)]
pub struct SkyAtTime {
    /// Sun, Moon and planets.
    pub bodies: BodiesAnswer,
    /// The numbers, of which totals have the natural sky of the time.
    pub quantities: SkyQuantities,
    /// Mean luminance of all light in the visible sky below [`HORIZON_ENDS_DEG`], cd m⁻²; None where ground hides all of it.
    pub horizon_luminance_cd_m2: Option<f64>,
}

impl Observatory {
    /// The sky of a request at several times; `sky` is what was rendered for it without a time, under a clear sky. Takes a few
    /// milliseconds of a core a time.
    ///
    /// # Errors
    /// [`ObservatoryError::NoCelestialTables`], [`ObservatoryError::Celestial`] for a solar flux out of range.
    pub fn sky_at_times(
        &self,
        request: &SkyRequest,
        sky: &RenderedSky,
        times: &[SkyTime],
    ) -> Result<Vec<SkyAtTime>, ObservatoryError> {
        let tables = self.celestial_tables().ok_or(ObservatoryError::NoCelestialTables)?;
        let over = Overhead {
            place: request.place,
            altitude_m: sky.context.altitude_m,
            horizon: &sky.horizon,
            turbidity: request.turbidity,
            gaps: sky.gaps.as_ref(),
        };
        let responses = responses_of(request);
        let at = |time: &SkyTime| {
            let night = NightSky::new(tables, &over, *time, &responses)?;
            let mut total = sky.seen.clone();
            total.add(night.seen());
            let plane = total.seen_by(&Response::Photopic).unwrap_or_default();
            Ok(SkyAtTime {
                bodies: BodiesAnswer::of(night.heavens()),
                quantities: sky.quantities_with(&night),
                horizon_luminance_cd_m2: mean_at_horizon(plane, &sky.horizon),
            })
        };
        times.par_iter().map(at).collect()
    }
}

/// Mean by solid angle of a plane over the visible directions below [`HORIZON_ENDS_DEG`].
fn mean_at_horizon(plane: &[f32], horizon: &Horizon) -> Option<f64> {
    let (mut sum, mut sr) = (0.0, 0.0);
    for row in (0..ELEVATION_COUNT).filter(|row| elevation_rad(*row).to_degrees() < HORIZON_ENDS_DEG) {
        for column in (0..AZIMUTH_COUNT).filter(|column| !horizon.hides_sample(row, *column)) {
            sum += f64::from(plane[row * AZIMUTH_COUNT + column]) * solid_angle_sr(row);
            sr += solid_angle_sr(row);
        }
    }
    (sr > 0.0).then(|| sum / sr)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The horizon is the lowest ten degrees of what is visible.
    #[test]
    fn the_horizon_is_the_lowest_visible_sky() {
        let plane: Vec<f32> = (0..ELEVATION_COUNT * AZIMUTH_COUNT)
            .map(|at| {
                let (row, column) = (at / AZIMUTH_COUNT, at % AZIMUTH_COUNT);
                if row >= 7 {
                    9.0
                } else if column < AZIMUTH_COUNT / 2 {
                    1.0
                } else {
                    3.0
                }
            })
            .collect();
        assert!((mean_at_horizon(&plane, &Horizon::flat()).unwrap() - 2.0).abs() < 1e-9);
        let half = (0..AZIMUTH_COUNT).map(|column| if column < AZIMUTH_COUNT / 2 { 1.0 } else { 0.0 });
        let walled = Horizon::new(half.collect()).unwrap();
        assert!((mean_at_horizon(&plane, &walled).unwrap() - 3.0).abs() < 1e-9);
        let shut = Horizon::new(vec![0.5; AZIMUTH_COUNT]).unwrap();
        assert_eq!(mean_at_horizon(&plane, &shut), None);
    }
}
