//! Stars, planets, Moon and Sun of a night as pictures have them.

use skyglow_display::{Disc, PointLight, SkyBodies};
use skyglow_observatory::night_sky::NightSky;

/// Stars, planets, Moon and Sun as pictures have them.
pub(crate) fn bodies_of(night: &NightSky) -> SkyBodies {
    let points = night.points().into_iter().map(|point| PointLight {
        direction: point.direction,
        illuminance_lx: point.illuminance_lx,
        limit_mag: point.limit_mag,
    });
    SkyBodies { points: points.collect(), discs: discs_of(night) }
}

/// Moon and Sun above the horizon.
pub(crate) fn discs_of(night: &NightSky) -> Vec<Disc> {
    let discs = night.discs().into_iter().map(|disc| {
        let lit_cd_m2 = disc.lit_cd_m2();
        Disc {
            direction: disc.point.direction,
            radius_rad: 0.5 * disc.diameter_rad,
            lit_cd_m2,
            dark_cd_m2: lit_cd_m2.map(|luminance| luminance * disc.dark_ratio),
            lit_share: disc.lit_share,
            bright_limb_rad: disc.bright_limb_rad,
        }
    });
    discs.collect()
}
