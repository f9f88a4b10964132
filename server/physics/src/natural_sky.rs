//! What shines beside artificial light: the dark reference, the same in every direction, or the sky of an instant
//! (`docs/model.md#dark-reference`, `docs/model.md#night-sky`).

use crate::{
    horizon::Horizon,
    panorama::{ELEVATION_COUNT, elevation_rad, solid_angle_sr},
    seen_sky::{SeenSky, SkyPart},
    sky_sums::{mean_kernels, value_of, visible_columns},
    spectrum::{Colour, Light, NODE_COUNT, Response},
    surfaces::{BeamSums, Slope, SurfaceSums},
};
use std::{f64::consts::PI, sync::Arc};

/// Full width at half maximum of a Sky Quality Meter's response, radians (20°).
pub const SQM_FWHM_RAD: f64 = 20.0 * PI / 180.0;

/// A kind of light with what each node has of it.
#[derive(Clone, Debug)]
pub struct NodeLight {
    /// The kind.
    pub light: Arc<Light>,
    /// In the unit of the kind, per sr.
    pub kernel: [f64; NODE_COUNT],
}

impl NodeLight {
    /// What a response sees of lights, in its unit.
    fn value(lights: &[Self], response: &Response) -> f64 {
        lights.iter().map(|part| part.light.rule(response).value(part.kernel)).sum()
    }
}

impl PartialEq for NodeLight {
    fn eq(&self, other: &Self) -> bool {
        self.kernel == other.kernel && self.light.spectrum() == other.light.spectrum()
    }
}

/// A natural sky that is the same in every direction.
#[derive(Clone, Debug, PartialEq)]
pub struct EvenSky {
    /// What shines between the stars.
    pub background: Vec<NodeLight>,
    /// Mean of what comes straight from stars: an eye sees the sky between them, a meter sees them too.
    pub stars: Vec<NodeLight>,
    /// Whether it is seen through air; else it is that outside.
    pub is_through_air: bool,
}

impl EvenSky {
    /// What a response sees between the stars, in its unit.
    pub fn value(&self, response: &Response) -> f64 {
        NodeLight::value(&self.background, response)
    }

    /// Luminance between the stars, cd m⁻².
    pub fn luminance_cd_m2(&self) -> f64 {
        self.value(&Response::Photopic)
    }

    /// What a meter of a wide field reads, stars included.
    pub fn meter_value(&self, response: &Response) -> f64 {
        self.value(response) + NodeLight::value(&self.stars, response)
    }

    /// Chromaticity x, y (CIE 1931) between the stars; None without light.
    pub fn chromaticity(&self) -> Option<[f64; 2]> {
        let xyz = [Response::CieX, Response::Photopic, Response::CieZ].map(|response| self.value(&response));
        Colour::of_tristimulus(xyz).map(|(chromaticity, _)| chromaticity)
    }
}

/// How much a Sky Quality Meter at the zenith sees of a direction, by its angle to the zenith, rad: 1 at the zenith.
pub fn meter_weight(angle_rad: f64) -> f64 {
    let sigma = SQM_FWHM_RAD / (8.0 * std::f64::consts::LN_2).sqrt();
    (-0.5 * (angle_rad / sigma) * (angle_rad / sigma)).exp()
}

/// Mean over the meter's visible field of what comes straight from points of light, given their angles to the zenith, rad, and
/// irradiances; 0 where nothing of the field is visible.
pub fn meter_mean_of_points(
    points: impl Iterator<Item = (f64, [f64; NODE_COUNT])>,
    horizon: &Horizon,
) -> [f64; NODE_COUNT] {
    let field_sr: f64 = (0..ELEVATION_COUNT)
        .map(|row| {
            let cell_sr = meter_weight(PI / 2.0 - elevation_rad(row)) * solid_angle_sr(row);
            cell_sr * visible_columns(horizon, row) as f64
        })
        .sum();
    let mut mean = [0.0; NODE_COUNT];
    if field_sr > 0.0 {
        for (angle_rad, irradiance) in points {
            let weight = meter_weight(angle_rad) / field_sr;
            mean.iter_mut().zip(irradiance).for_each(|(mean, value)| *mean += weight * value);
        }
    }
    mean
}

/// What shines beside artificial light.
#[derive(Clone, Copy, Debug)]
pub enum NaturalSky<'a> {
    /// The dark reference.
    Dark,
    /// That of an instant.
    OfInstant(NaturalLight<'a>),
    /// What comes through clouds and gaps between them: of stars nothing is said.
    ThroughGaps(NaturalLight<'a>),
}

/// A natural sky that is not the same in every direction.
#[derive(Clone, Copy, Debug)]
pub struct NaturalLight<'a> {
    /// Its kinds of light, dark where ground hides them.
    pub parts: &'a [SkyPart],
    /// What is seen of them, by the responses of [`SkyNumbers::seen`](crate::SkyNumbers::seen).
    pub seen: &'a SeenSky,
    /// Means over the meter's field of what comes straight from points of light.
    pub points: &'a [NodeLight],
    /// What comes straight from them to surfaces.
    pub beams: &'a [BeamSums],
}

impl NaturalSky<'_> {
    /// Mean of what a response sees of it over the visible directions by the weight of their angles to the zenith.
    pub(crate) fn mean(
        self,
        dark: &EvenSky,
        response: &Response,
        horizon: &Horizon,
        weight: impl Fn(f64) -> f64,
    ) -> f64 {
        match self {
            Self::Dark => dark.value(response),
            Self::OfInstant(light) | Self::ThroughGaps(light) => {
                value_of(light.parts, &mean_kernels(light.parts, horizon, weight), response)
            }
        }
    }

    /// What a Sky Quality Meter at the zenith sees of it, stars included.
    pub(crate) fn in_meter(self, dark: &EvenSky, horizon: &Horizon) -> f64 {
        let of_points = match self {
            Self::Dark => return dark.meter_value(&Response::Sqm),
            Self::OfInstant(light) | Self::ThroughGaps(light) => {
                NodeLight::value(light.points, &Response::Sqm)
            }
        };
        self.mean(dark, &Response::Sqm, horizon, meter_weight) + of_points
    }

    /// What surfaces receive of it, as a response of [`SkyNumbers::seen`](crate::SkyNumbers::seen) sees it.
    pub(crate) fn surface_sums(
        self,
        dark: &EvenSky,
        response: &Response,
        horizon: &Horizon,
        slope: Slope,
    ) -> SurfaceSums {
        match self {
            Self::Dark => SurfaceSums::of_even(dark.value(response), horizon, slope),
            Self::OfInstant(light) | Self::ThroughGaps(light) => {
                let plane = light.seen.seen_by(response).unwrap_or_default();
                SurfaceSums::of_plane(plane, slope).plus_beams(light.beams, response)
            }
        }
    }
}

/// A dark sky of sunlight's colour with a luminance, cd m⁻², and as much again as a share of it from stars.
#[cfg(test)]
pub(crate) fn even_sky(luminance_cd_m2: f64, share_of_stars: f64) -> EvenSky {
    let light = Arc::new(Light::new(crate::spectrum::Spectrum::from_fn(|_| 1.0)));
    let kernel = luminance_cd_m2 / light.rule(&Response::Photopic).value([1.0; NODE_COUNT]);
    let of = |share: f64| vec![NodeLight { light: Arc::clone(&light), kernel: [share * kernel; NODE_COUNT] }];
    EvenSky { background: of(1.0), stars: of(share_of_stars), is_through_air: true }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Responses see an even sky by its light; a meter sees its stars too.
    #[test]
    fn meters_see_the_stars_of_an_even_sky() {
        let sky = even_sky(2e-4, 0.1);
        assert!((sky.luminance_cd_m2() / 2e-4 - 1.0).abs() < 1e-12);
        for response in [Response::Sqm, Response::JohnsonB] {
            assert!((sky.meter_value(&response) / sky.value(&response) - 1.1).abs() < 1e-12);
        }
        let chromaticity = sky.chromaticity().unwrap();
        assert!(chromaticity.iter().all(|value| (value - 1.0 / 3.0).abs() < 2e-3), "{chromaticity:?}");
        assert_ne!(sky, even_sky(2e-4, 0.2));
        assert_eq!(sky, even_sky(2e-4, 0.1));
    }

    /// Points all over the sky are seen as a sky of their mean radiance; one outside the field is not seen.
    #[test]
    fn points_all_over_are_a_sky() {
        let open = Horizon::flat();
        let everywhere = (0..ELEVATION_COUNT).map(|row| {
            let irradiance = crate::AZIMUTH_COUNT as f64 * solid_angle_sr(row);
            (PI / 2.0 - elevation_rad(row), [3.0 * irradiance; NODE_COUNT])
        });
        let mean = meter_mean_of_points(everywhere, &open);
        assert!(mean.iter().all(|value| (value / 3.0 - 1.0).abs() < 1e-9), "{mean:?}");
        let [overhead, low] =
            [0.0, 1.2].map(|angle| meter_mean_of_points([(angle, [1.0; NODE_COUNT])].into_iter(), &open)[0]);
        assert!(low < 1e-3 * overhead && (5.0..9.0).contains(&overhead), "{overhead} {low}");
    }
}
