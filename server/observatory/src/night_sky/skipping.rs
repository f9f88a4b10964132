//! What of the natural sky need not be looked for, as the answer has it whether it is there or not.

use skyglow_celestial::{Component, Heavens, airglow::zenith_s10};
use skyglow_physics::{BAND_COUNT, Panorama, Response, SkyPart};

/// Share of the Sun's sky, where that is darkest, below which other light is left out.
pub const DAY_BOUND: f64 = 1e-4;
/// Degrees below the horizon from which on the Moon is left out: a full Moon there gives the zenith less than 1e-8 cd m⁻².
pub const MOON_LOWEST_DEG: f64 = -12.0;

/// Radiance that points of light give no direction more of than this, per irradiance outside the air, sr⁻¹, but close to them.
const MOST_SCATTERED_PER_SR: f64 = 0.1;
/// Brightest starlight and zodiacal light of the dark sky, S10.
const BRIGHTEST_S10: f64 = 2_000.0;
/// Airglow near the horizon over that at the zenith.
const MOST_VAN_RHIJN: f64 = 6.0;

/// Whether anything is left out.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Skipping {
    /// All is looked for.
    OfNothing,
    /// What the answer does not show.
    OfWhatDoesNotCount,
}

impl Skipping {
    /// Components beside the Sun that are looked for, with the Sun's sky.
    pub(super) fn wanted(self, heavens: &Heavens, sun: Option<&SkyPart>) -> Vec<Component> {
        let mut wanted: Vec<Component> =
            Component::ALL.into_iter().filter(|component| *component != Component::Sun).collect();
        if self == Self::OfNothing {
            return wanted;
        }
        let darkest_cd_m2 = sun.map_or(0.0, darkest_cd_m2);
        let is_up = heavens.moon().position.true_altitude_deg() >= MOON_LOWEST_DEG;
        wanted.retain(|component| {
            (*component != Component::Moon || is_up)
                && brightest_cd_m2(heavens, *component) >= DAY_BOUND * darkest_cd_m2
        });
        wanted
    }
}

/// Luminance of a sky where it is darkest, of what is not hidden.
fn darkest_cd_m2(part: &SkyPart) -> f64 {
    let at = |band: usize, direction: usize| {
        f64::from(part.kernel.samples()[band * (Panorama::LEN / BAND_COUNT) + direction])
    };
    let middle = skyglow_physics::Band::MIDDLE.index();
    let seen = (0..Panorama::LEN / BAND_COUNT).filter(|direction| at(middle, *direction) > 0.0);
    let darkest = seen.min_by(|a, b| at(middle, *a).total_cmp(&at(middle, *b)));
    darkest.map_or(0.0, |direction| {
        let kernel = std::array::from_fn(|band| at(band, direction));
        part.light.rule(&Response::Photopic).value(kernel)
    })
}

/// Luminance that a component has nowhere more of, but near its points.
fn brightest_cd_m2(heavens: &Heavens, component: Component) -> f64 {
    let luminance = |kernel: f64| component.light().rule(&Response::Photopic).value([kernel; BAND_COUNT]);
    match component {
        Component::Airglow => MOST_VAN_RHIJN * luminance(zenith_s10(heavens.solar_flux_sfu())),
        Component::Starlight | Component::ZodiacalLight => luminance(BRIGHTEST_S10),
        // All stars together are 95 of V = 0.
        Component::Stars => MOST_SCATTERED_PER_SR * luminance(95.0),
        Component::Sun | Component::Moon | Component::Planets => {
            let points = heavens.points(component);
            let rule = component.light().rule(&Response::Photopic);
            MOST_SCATTERED_PER_SR * points.iter().map(|point| rule.value(point.irradiance)).sum::<f64>()
        }
    }
}
