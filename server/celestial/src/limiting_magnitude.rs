//! The faintest star that an eye sees, by direction, and how many it sees (Crumey 2014, eqs. 47 to 53, by `physics`).

use crate::{components::Component, heavens::Heavens};
use serde::Serialize;
use skyglow_physics::{
    Direction,
    error::{PhysicsError, check_range},
    photometry::naked_eye_limit_mag,
};

/// Field factor that [`naked_eye_limit_mag`] has in it: a typical observer.
pub const TYPICAL_FIELD_FACTOR: f64 = 2.0;

/// An eye: its field factor F, 1 (a young expert in a laboratory) to about 3.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Eye {
    field_factor: f64,
}

impl Default for Eye {
    fn default() -> Self {
        Self { field_factor: TYPICAL_FIELD_FACTOR }
    }
}

impl Eye {
    /// With a field factor, 0.5..=10: thresholds are so many times those of Blackwell's observers.
    ///
    /// # Errors
    /// [`PhysicsError`] naming `field_factor`.
    pub fn new(field_factor: f64) -> Result<Self, PhysicsError> {
        Ok(Self { field_factor: check_range("field_factor", field_factor, 0.5, 10.0, "")? })
    }

    /// The faintest magnitude, as it arrives, that is seen against a background of so many cd m⁻²; below 1e-5 it counts as 1e-5.
    pub fn limit_mag(self, background_cd_m2: f64) -> f64 {
        naked_eye_limit_mag(background_cd_m2) - 2.5 * (self.field_factor / TYPICAL_FIELD_FACTOR).log10()
    }
}

/// How many stars an eye sees of those that are above the horizon.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
pub struct VisibleStars {
    /// Seen against the sky of their own direction.
    pub visible: u32,
    /// Of the catalogue, to V = 6.5, above the horizontal plane.
    pub above_horizon: u32,
}

/// Counts the stars that an eye sees, given the luminance of the sky, cd m⁻², and the extinction, magnitudes in V, by direction. The
/// catalogue ends at V = 6.5, and so does the count.
pub fn visible_stars(
    heavens: &Heavens,
    eye: Eye,
    background_cd_m2: impl Fn(Direction) -> f64,
    extinction_mag: impl Fn(Direction) -> f64,
) -> VisibleStars {
    let mut count = VisibleStars { visible: 0, above_horizon: 0 };
    let stars = heavens.points(Component::Stars);
    for star in stars.iter().filter(|star| star.direction.elevation_rad > 0.0) {
        count.above_horizon += 1;
        let arrives_mag = star.magnitude_v + extinction_mag(star.direction);
        count.visible += u32::from(arrives_mag <= eye.limit_mag(background_cd_m2(star.direction)));
    }
    count
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{site::Site, time::Instant};
    use proptest::prelude::*;
    use skyglow_physics::photometry::luminance_from_brightness_cd_m2;

    fn heavens(utc: &str) -> Heavens {
        Heavens::new(Site::new(40.0, 0.0, 0.0).unwrap(), Instant::parse(utc).unwrap(), 100.0).unwrap()
    }

    /// Crumey's limits for F = 2, and what other eyes gain and lose.
    #[test]
    fn limits_are_those_of_crumey() {
        let typical = Eye::default();
        for (brightness, limit) in [(22.0, 6.27), (20.0, 5.52), (18.0, 4.99)] {
            let found = typical.limit_mag(luminance_from_brightness_cd_m2(brightness));
            assert!((found - limit).abs() < 0.006, "{brightness}: {found}");
        }
        let keen = Eye::new(1.4).unwrap();
        let gain = keen.limit_mag(1.7e-4) - typical.limit_mag(1.7e-4);
        assert!((gain - 2.5 * (2.0_f64 / 1.4).log10()).abs() < 1e-12);
        assert!(Eye::new(0.0).is_err() && Eye::new(f64::NAN).is_err());
    }

    /// A dark sky shows some thousands of stars, a city's some tens.
    #[test]
    fn cities_hide_stars() {
        let heavens = heavens("2026-01-15T22:00:00Z");
        let count = |brightness: f64| {
            let background = luminance_from_brightness_cd_m2(brightness);
            let extinction = |direction: Direction| 0.2 / direction.elevation_rad.sin().max(0.03);
            visible_stars(&heavens, Eye::default(), |_| background, extinction)
        };
        let [dark, town, city] = [22.0, 20.0, 17.0].map(count);
        assert!((1_500..3_000).contains(&dark.visible), "{}", dark.visible);
        assert!((400..1_000).contains(&town.visible), "{}", town.visible);
        assert!((80..400).contains(&city.visible), "{}", city.visible);
        assert!(dark.above_horizon == city.above_horizon && dark.above_horizon > dark.visible);
    }

    proptest! {
        /// A brighter sky shows no more: the fit rises by less than 0.03 mag around 0.05 cd m⁻².
        #[test]
        fn limits_fall_with_light(dark in 1e-4..1.0_f64, more in 1.0..10.0_f64) {
            let eye = Eye::default();
            prop_assert!(eye.limit_mag(dark * more) <= eye.limit_mag(dark) + 0.03);
        }
    }
}
