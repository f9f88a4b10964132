//! The faintest stars by direction, how many of the stars are seen, and how the Milky Way stands out.

use super::{NightSky, V_BAND};
use skyglow_celestial::{
    Component,
    limiting_magnitude::{Eye, VisibleStars, visible_stars},
    milky_way::{MilkyWayContrast, milky_way_contrast},
};
use skyglow_physics::{AZIMUTH_COUNT, Direction, ELEVATION_COUNT, Horizon};

/// Azimuths and elevations that limits are said for, beside the zenith.
const AZIMUTHS: usize = 8;
const ELEVATIONS_DEG: [f64; 3] = [10.0, 30.0, 60.0];
/// Luminance that stands for ground, before which nothing is seen, cd m⁻².
const GROUND_CD_M2: f64 = 1e9;

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

/// What is seen of the stars.
#[derive(Clone, Debug, PartialEq)]
pub struct SeenStars {
    /// At the zenith, then by azimuth within elevation.
    pub limits: Vec<DirectionLimit>,
    /// Stars to V = 6.5, seen against the sky of their direction.
    pub count: VisibleStars,
    /// Where the Milky Way stands out most; None where starlight does not count, or no part of the band is high enough.
    pub milky_way: Option<MilkyWayContrast>,
}

impl NightSky {
    /// Magnitudes of V that the air takes at a row of the panorama.
    fn extinction_mag(&self, row: usize) -> f64 {
        -2.5 * self.transmittance[row][V_BAND].max(1e-30).log10()
    }

    /// Of these the ones that it takes more than at the zenith, which the limits of Crumey are for.
    pub(super) fn more_extinction_mag(&self, row: usize) -> f64 {
        self.extinction_mag(row) - self.extinction_mag(ELEVATION_COUNT - 1)
    }

    /// What is seen of the stars in a sky of so much luminance in all, `[row][column]`, cd m⁻², given the even background that hides as
    /// much as a luminance in a direction: the veil that the eye makes of all light is over it.
    pub fn seen_stars(
        &self,
        total_cd_m2: &[f32],
        horizon: &Horizon,
        background_cd_m2: impl Fn(Direction, f64) -> f64,
    ) -> SeenStars {
        let luminance = |direction: Direction| {
            let (row, column) = direction.nearest_sample();
            match horizon.hides_sample(row, column) {
                true => GROUND_CD_M2,
                false => f64::from(total_cd_m2[row * AZIMUTH_COUNT + column]),
            }
        };
        let behind = |direction: Direction| background_cd_m2(direction, luminance(direction));
        let eye = Eye::default();
        let limit = |(azimuth_deg, elevation_deg): (f64, f64)| {
            let direction = Direction {
                azimuth_rad: azimuth_deg.to_radians(),
                elevation_rad: elevation_deg.to_radians(),
            };
            let (row, column) = direction.nearest_sample();
            let is_ground = horizon.hides_sample(row, column);
            let luminance_cd_m2 = if is_ground { 0.0 } else { luminance(direction) };
            let limit_mag = eye.limit_mag(behind(direction)) - self.more_extinction_mag(row);
            let limit_mag = (!is_ground).then_some(limit_mag);
            DirectionLimit { azimuth_deg, elevation_deg, luminance_cd_m2, limit_mag }
        };
        let around = |elevation_deg: f64| {
            (0..AZIMUTHS).map(move |step| (360.0 / AZIMUTHS as f64 * step as f64, elevation_deg))
        };
        let directions = [(0.0, 90.0)].into_iter().chain(ELEVATIONS_DEG.into_iter().flat_map(around));
        let row = |direction: Direction| direction.nearest_sample().0;
        let more_mag = |direction: Direction| self.more_extinction_mag(row(direction));
        let has_starlight = self.components.iter().any(|sky| sky.component == Component::Starlight);
        SeenStars {
            limits: directions.map(limit).collect(),
            count: visible_stars(&self.heavens, eye, behind, more_mag),
            milky_way: has_starlight
                .then(|| {
                    let mag = |direction: Direction| self.extinction_mag(row(direction));
                    milky_way_contrast(&self.heavens, behind, mag)
                })
                .flatten(),
        }
    }
}
