//! How the Milky Way stands out: the contrast of its starlight against the whole sky there (Weber's contrast).

use crate::{components::Component, heavens::Heavens};
use glam::DVec3;
use serde::Serialize;
use skyglow_physics::{Direction, Response, spectrum::NODE_COUNT};

/// Lowest elevation that is looked at, degrees.
const LOWEST_DEG: f64 = 15.0;
/// Galactic latitude whose starlight counts as the sky beside the band, degrees.
const BESIDE_DEG: f64 = 30.0;

/// Where the Milky Way stands out most.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
pub struct MilkyWayContrast {
    /// What the band adds to the sky beside it, over that sky: 0 is none.
    pub contrast: f64,
    /// Clockwise from true north, degrees.
    pub azimuth_deg: f64,
    /// Degrees above the horizontal plane.
    pub elevation_deg: f64,
    /// Galactic longitude of the place, degrees.
    pub galactic_longitude_deg: f64,
}

/// Looks along the galactic plane for the greatest contrast above 15° of elevation: starlight of the plane less the mean of that 30° to
/// either side of it, as it arrives through the air, over all the rest of the sky. Given are the luminance of the sky, cd m⁻², and the
/// extinction, magnitudes in V, by direction. None where no part of the plane is that high.
pub fn milky_way_contrast(
    heavens: &Heavens,
    background_cd_m2: impl Fn(Direction) -> f64,
    extinction_mag: impl Fn(Direction) -> f64,
) -> Option<MilkyWayContrast> {
    let enu_from_galactic = heavens.galactic_from_enu().transpose();
    let rule = Component::Starlight.light().rule(&Response::Photopic);
    let luminance = |enu: DVec3| {
        let radiance: [f64; NODE_COUNT] = heavens.radiance_outside_enu(Component::Starlight, enu);
        rule.value(radiance)
    };
    let place = |longitude_deg: f64, latitude_deg: f64| {
        let (longitude, latitude) = (longitude_deg.to_radians(), latitude_deg.to_radians());
        let galactic =
            DVec3::new(longitude.cos() * latitude.cos(), longitude.sin() * latitude.cos(), latitude.sin());
        enu_from_galactic * galactic
    };
    (0..180)
        .map(|step| f64::from(step) * 2.0)
        .filter_map(|longitude_deg| {
            let enu = place(longitude_deg, 0.0);
            let direction = crate::ephemeris::direction_of(enu);
            if direction.elevation_rad.to_degrees() < LOWEST_DEG {
                return None;
            }
            let beside = 0.5
                * (luminance(place(longitude_deg, BESIDE_DEG))
                    + luminance(place(longitude_deg, -BESIDE_DEG)));
            let arrives = 10f64.powf(-0.4 * extinction_mag(direction));
            let band = (luminance(enu) - beside).max(0.0) * arrives;
            // A sky darker than its own band would be no sky.
            let rest = (background_cd_m2(direction) - band).max(0.01 * band);
            Some(MilkyWayContrast {
                contrast: band / rest,
                azimuth_deg: direction.azimuth_rad.to_degrees(),
                elevation_deg: direction.elevation_rad.to_degrees(),
                galactic_longitude_deg: longitude_deg,
            })
        })
        .max_by(|a, b| a.contrast.total_cmp(&b.contrast))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{site::Site, time::Instant};

    /// In a southern July the band is as bright as the rest of a dark sky; under a city's it is a few per cent.
    #[test]
    fn the_band_stands_out_in_the_dark() {
        let site = Site::new(-30.0, 0.0, 0.0).unwrap();
        let heavens = Heavens::new(site, Instant::parse("2026-07-01T23:00:00Z").unwrap(), 100.0).unwrap();
        let rule = Component::Starlight.light().rule(&Response::Photopic);
        let of = |rest: f64| {
            let starlight =
                |direction: Direction| rule.value(heavens.radiance_outside(Component::Starlight, direction));
            milky_way_contrast(&heavens, |direction| rest + starlight(direction), |_| 0.2).unwrap()
        };
        let (dark, city) = (of(2e-4), of(1e-2));
        assert!((0.3..3.0).contains(&dark.contrast), "{dark:?}");
        assert!((0.005..0.1).contains(&city.contrast), "{city:?}");
        assert!(dark.elevation_deg > 15.0);
        assert_eq!(dark.galactic_longitude_deg, city.galactic_longitude_deg);
    }
}
