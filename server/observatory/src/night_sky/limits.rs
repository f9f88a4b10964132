//! The faintest stars by direction, and how many of the stars are seen.

use super::NightSky;
use skyglow_celestial::{Component, Heavens};
use skyglow_physics::{
    AZIMUTH_COUNT, Direction, ELEVATION_COUNT, Horizon, Response, photometry::naked_eye_limit_mag,
};
use std::f64::consts::{FRAC_PI_2, TAU};

/// Azimuths and elevations that limits are said for, beside the zenith.
const AZIMUTHS: usize = 8;
const ELEVATIONS_DEG: [f64; 3] = [10.0, 30.0, 60.0];
/// Lowest elevation at which the Milky Way is looked for.
const MILKY_WAY_LOWEST_DEG: f64 = 20.0;

/// The faintest star of a direction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DirectionLimit {
    /// Degrees clockwise from north.
    pub azimuth_deg: f64,
    /// Degrees.
    pub elevation_deg: f64,
    /// Luminance of all light there, cd m⁻².
    pub luminance_cd_m2: f64,
    /// V outside the air of the faintest star; None where ground hides the direction.
    pub limit_mag: Option<f64>,
}

/// Stars to V = 6.5.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct StarCount {
    /// Above the horizon, or the terrain.
    pub above_horizon: usize,
    /// Of them not fainter than the limit of their own direction.
    pub visible: usize,
}

/// What is seen of the stars.
#[derive(Clone, Debug, PartialEq)]
pub struct VisibleStars {
    /// At the zenith, then by azimuth within elevation.
    pub limits: Vec<DirectionLimit>,
    /// Stars to V = 6.5.
    pub stars: StarCount,
    /// Largest share of all luminance that starlight has, at 20° and higher; None where starlight does not count.
    pub milky_way_contrast: Option<f64>,
}

/// Row and column of the sample nearest to a direction above the horizon.
fn nearest_sample(direction: Direction) -> (usize, usize) {
    let row = (direction.elevation_rad / FRAC_PI_2 * ELEVATION_COUNT as f64) as usize;
    let column = (direction.azimuth_rad / TAU * AZIMUTH_COUNT as f64).round() as usize;
    (row.min(ELEVATION_COUNT - 1), column % AZIMUTH_COUNT)
}

impl NightSky {
    /// V outside the air of the faintest star behind a luminance in a row of the panorama: Crumey's limit, which holds at the zenith,
    /// less what the air takes more than there.
    fn limit_mag(&self, luminance_cd_m2: f64, row: usize) -> f64 {
        let through = self.transmittance[row] / self.transmittance[ELEVATION_COUNT - 1];
        naked_eye_limit_mag(luminance_cd_m2) + 2.5 * through.max(1e-30).log10()
    }

    /// What is seen of the stars in a sky of so much luminance in all, `[row][column]`, cd m⁻².
    pub fn visible_stars(&self, total_cd_m2: &[f32], horizon: &Horizon) -> VisibleStars {
        let luminance =
            |(row, column): (usize, usize)| f64::from(total_cd_m2[row * AZIMUTH_COUNT + column]);
        let limit = |azimuth_deg: f64, elevation_deg: f64| {
            let direction = Direction {
                azimuth_rad: azimuth_deg.to_radians(),
                elevation_rad: elevation_deg.to_radians(),
            };
            let (row, column) = nearest_sample(direction);
            let luminance_cd_m2 = luminance((row, column));
            let is_sky = !horizon.hides_sample(row, column);
            let limit_mag = is_sky.then(|| self.limit_mag(luminance_cd_m2, row));
            DirectionLimit { azimuth_deg, elevation_deg, luminance_cd_m2, limit_mag }
        };
        let around = |elevation_deg: f64| {
            (0..AZIMUTHS).map(move |step| (360.0 / AZIMUTHS as f64 * step as f64, elevation_deg))
        };
        let directions = [(0.0, 90.0)].into_iter().chain(ELEVATIONS_DEG.into_iter().flat_map(around));
        let limits = directions.map(|(azimuth, elevation)| limit(azimuth, elevation)).collect();
        let stars = self.count(&self.heavens, horizon, |sample| self.limit_mag(luminance(sample), sample.0));
        VisibleStars { limits, stars, milky_way_contrast: self.milky_way_contrast(total_cd_m2) }
    }

    fn count(
        &self,
        heavens: &Heavens,
        horizon: &Horizon,
        limit_mag: impl Fn((usize, usize)) -> f64,
    ) -> StarCount {
        let mut count = StarCount::default();
        for star in heavens.points(Component::Stars) {
            if star.direction.elevation_rad < 0.0 || horizon.hides(star.direction) {
                continue;
            }
            count.above_horizon += 1;
            if star.magnitude_v <= limit_mag(nearest_sample(star.direction)) {
                count.visible += 1;
            }
        }
        count
    }

    fn milky_way_contrast(&self, total_cd_m2: &[f32]) -> Option<f64> {
        let place = self.components.iter().position(|sky| sky.component == Component::Starlight)?;
        let part = &self.parts[place];
        let rule = part.light.rule(&Response::Photopic);
        let lowest = (MILKY_WAY_LOWEST_DEG / 90.0 * ELEVATION_COUNT as f64).ceil() as usize;
        let mut largest = 0f64;
        for row in lowest..ELEVATION_COUNT {
            // Every other column: the map of starlight is coarser.
            for column in (0..AZIMUTH_COUNT).step_by(2) {
                let total = f64::from(total_cd_m2[row * AZIMUTH_COUNT + column]);
                if total > 0.0 {
                    let kernel = std::array::from_fn(|band| part.kernel.radiance_w_m2_sr(band, row, column));
                    largest = largest.max(rule.value(kernel) / total);
                }
            }
        }
        Some(largest)
    }
}
