//! The numbers reported for a panorama: artificial light alone, and with the natural sky (`docs/model.md#quantities`).

use crate::{
    horizon::Horizon,
    natural_sky::{EvenSky, meter_weight},
    panorama::{azimuth_rad, elevation_rad},
    photometry::{bortle_class, brightness_mag_arcsec2, naked_eye_limit_mag},
    response_quantities::{ResponseQuantities, ZenithValue},
    seen_sky::{SeenSky, SkyPart},
    sky_sums::{Sums, in_zenith_cap, mean_kernels, value_of, weighted_mean},
    spectrum::{Colour, RGB_BANDS, Response},
    surfaces::{Slope, SurfaceLight, SurfaceSums, Surfaces},
};
use serde::{Deserialize, Serialize};

pub use crate::{natural_sky::NaturalSky, sky_sums::ZENITH_CAP_RAD};

/// The numbers of a sky. Luminances are artificial light alone unless the name says `total`, which adds the
/// natural sky: that of the `time` asked for, or without one the dark reference in every direction. Magnitudes are null for a sky without light. Where terrain hides part of
/// the sky, all are of the visible part. Clouds let a part of the natural sky through, and under them what speaks of stars is
/// null.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema), schema(as = QuantitiesAnswer))]
pub struct SkyQuantities {
    /// Mean within 5° of the zenith, cd m⁻².
    pub zenith_luminance_cd_m2: f64,
    /// The same, mag arcsec⁻².
    pub zenith_brightness_mag_arcsec2: Option<f64>,
    /// With the natural sky, cd m⁻².
    pub zenith_total_luminance_cd_m2: f64,
    /// With the natural sky, mag arcsec⁻².
    pub zenith_total_brightness_mag_arcsec2: Option<f64>,
    /// Artificial luminance at the zenith over the natural one; under clouds over the dark reference.
    pub ratio_to_natural: f64,
    /// As a Sky Quality Meter at the zenith sees it (its spectral response, Gaussian of 20° FWHM): the luminance of the magnitude that
    /// it would read of artificial light alone, cd m⁻².
    pub sqm_luminance_cd_m2: f64,
    /// What such a meter reads with the natural sky and the stars in its field, mag arcsec⁻².
    pub sqm_total_brightness_mag_arcsec2: Option<f64>,
    /// Mean over the visible sky, cd m⁻².
    pub mean_luminance_cd_m2: f64,
    /// Horizontal illuminance by the visible sky, lx.
    pub horizontal_illuminance_lx: f64,
    /// With the natural sky, and what comes straight from Sun, Moon, planets and stars, lx.
    pub horizontal_total_illuminance_lx: f64,
    /// Largest visible luminance, cd m⁻².
    pub brightest_luminance_cd_m2: f64,
    /// Its azimuth, degrees clockwise from north.
    pub brightest_azimuth_deg: f64,
    /// Its elevation, degrees.
    pub brightest_elevation_deg: f64,
    /// Bortle class, 1..=9, by how much brighter artificial light makes the zenith than the dark reference, whatever the time; null
    /// under clouds.
    pub bortle_class: Option<u8>,
    /// Naked-eye limiting magnitude at the zenith (Crumey 2014, F = 2); null under clouds.
    pub naked_eye_limit_mag: Option<f64>,
    /// Radiance at the zenith in R, G, B (600–700, 500–600, 400–500 nm), W m⁻² sr⁻¹.
    pub zenith_radiance_w_m2_sr: [f64; 3],
    /// Scotopic luminance within 5° of the zenith, what the dark-adapted eye sees, cd m⁻².
    pub zenith_scotopic_luminance_cd_m2: f64,
    /// Scotopic over photopic luminance at the zenith; null without light.
    pub zenith_scotopic_photopic_ratio: Option<f64>,
    /// Chromaticity x, y (CIE 1931) of the light at the zenith; null without light.
    pub zenith_chromaticity: Option<[f64; 2]>,
    /// Its correlated colour temperature, K; null where it has none.
    pub zenith_colour_temperature_k: Option<f64>,
    /// What eyes and instruments see within 5° of the zenith.
    pub zenith_by_response: Vec<ZenithValue>,
    /// The sky as the response that was asked for sees it; null for the photopic one, which all luminances above are of.
    pub seen: Option<ResponseQuantities>,
    /// What surfaces receive of the visible sky: level, sloping and upright ones.
    pub surfaces: Surfaces,
}

/// Responses that the numbers and pictures of every sky need: X, Y, Z and what the dark-adapted eye sees.
pub const SKY_RESPONSES: [Response; 4] =
    [Response::CieX, Response::Photopic, Response::CieZ, Response::Scotopic];

/// A sky to take numbers of: its parts, dark where ground hides it, and what is seen of them.
#[derive(Clone, Copy, Debug)]
pub struct SkyNumbers<'a> {
    /// The kinds of light.
    pub parts: &'a [SkyPart],
    /// [`SKY_RESPONSES`], and the response that was asked for.
    pub seen: &'a SeenSky,
    /// Below it the sky is hidden.
    pub horizon: &'a Horizon,
    /// The response that was asked for.
    pub response: &'a Response,
    /// The dark reference, which Bortle's classes count from.
    pub dark: &'a EvenSky,
    /// How the ground lies.
    pub slope: Slope,
}

impl SkyNumbers<'_> {
    /// What surfaces receive as a response sees it.
    fn surface_light(&self, natural: NaturalSky<'_>, response: &Response) -> SurfaceLight {
        let plane = self.seen.seen_by(response).unwrap_or_default();
        let artificial = SurfaceSums::of_plane(plane, self.slope);
        let natural = natural.surface_sums(self.dark, response, self.horizon, self.slope);
        SurfaceLight::new(response, &artificial, &natural.plus(&artificial))
    }
}

impl SkyPart {
    /// What a response sees of a part that is dark where ground hides it: the mean within 5° of the zenith, and over the visible sky.
    pub fn zenith_and_mean(&self, response: &Response, horizon: &Horizon) -> [f64; 2] {
        let parts = std::slice::from_ref(self);
        let everywhere = |_: f64| 1.0;
        [
            value_of(parts, &mean_kernels(parts, horizon, in_zenith_cap), response),
            value_of(parts, &mean_kernels(parts, horizon, everywhere), response),
        ]
    }
}

impl SkyQuantities {
    /// All quantities of a sky of artificial light whose hidden samples are 0, as [`Horizon::darken`] leaves it.
    pub fn with(natural: NaturalSky<'_>, sky: SkyNumbers<'_>) -> Self {
        let quantities = Self::without_stars(natural, sky);
        if matches!(natural, NaturalSky::ThroughGaps(_)) {
            return quantities;
        }
        // Of artificial light alone, for Moon and twilight pass: what they outshine is in the limiting magnitude.
        let over_dark = 1.0 + quantities.zenith_luminance_cd_m2 / sky.dark.luminance_cd_m2();
        Self {
            bortle_class: Some(bortle_class(2.5 * over_dark.log10())),
            naked_eye_limit_mag: Some(naked_eye_limit_mag(quantities.zenith_total_luminance_cd_m2)),
            ..quantities
        }
    }

    /// All but quantities of stars.
    fn without_stars(natural_sky: NaturalSky<'_>, sky: SkyNumbers<'_>) -> Self {
        let SkyNumbers { parts, seen, horizon, response, dark, .. } = sky;
        let natural_of = |of: &Response| natural_sky.mean(dark, of, horizon, in_zenith_cap);
        let plane = |of: &Response| seen.seen_by(of).unwrap_or_default();
        let photopic = Sums::of(plane(&Response::Photopic), horizon);
        let mut lit_by = vec![&Response::Photopic, &Response::Scotopic];
        if !lit_by.contains(&response) {
            lit_by.push(response);
        }
        let by_response: Vec<_> = lit_by.iter().map(|of| sky.surface_light(natural_sky, of)).collect();
        let on_surfaces = &by_response[0];
        let asked = (*response != Response::Photopic).then(|| {
            let sums = Sums::of(plane(response), horizon);
            // The last is that of the response that was asked for.
            ResponseQuantities::new(
                response,
                &sums,
                natural_of(response),
                &by_response[by_response.len() - 1],
            )
        });
        let natural = natural_of(&Response::Photopic);
        let at_zenith = mean_kernels(parts, horizon, in_zenith_cap);
        let sqm = value_of(parts, &mean_kernels(parts, horizon, meter_weight), &Response::Sqm);
        let zenith = photopic.zenith;
        let scotopic = weighted_mean(plane(&Response::Scotopic), horizon, in_zenith_cap);
        let xyz = [Response::CieX, Response::Photopic, Response::CieZ]
            .map(|of| weighted_mean(plane(&of), horizon, in_zenith_cap));
        let colour = Colour::of_tristimulus(xyz);
        let total_brightness =
            |luminance: f64, natural: f64| brightness_mag_arcsec2(luminance.max(0.0) + natural);
        Self {
            zenith_luminance_cd_m2: zenith,
            zenith_brightness_mag_arcsec2: brightness_mag_arcsec2(zenith),
            zenith_total_luminance_cd_m2: zenith + natural,
            zenith_total_brightness_mag_arcsec2: total_brightness(zenith, natural),
            // Over what a clear sky would have, where clouds hide it; over nothing where all of the zenith is ground.
            ratio_to_natural: zenith / if natural > 0.0 { natural } else { dark.luminance_cd_m2() },
            sqm_luminance_cd_m2: sqm,
            sqm_total_brightness_mag_arcsec2: total_brightness(sqm, natural_sky.in_meter(dark, horizon)),
            mean_luminance_cd_m2: photopic.mean,
            horizontal_illuminance_lx: on_surfaces.artificial.horizontal,
            horizontal_total_illuminance_lx: on_surfaces.total.horizontal,
            brightest_luminance_cd_m2: photopic.brightest,
            brightest_azimuth_deg: azimuth_rad(photopic.brightest_column).to_degrees(),
            brightest_elevation_deg: elevation_rad(photopic.brightest_row).to_degrees(),
            bortle_class: None,
            naked_eye_limit_mag: None,
            zenith_radiance_w_m2_sr: RGB_BANDS.each_ref().map(|band| value_of(parts, &at_zenith, band)),
            zenith_scotopic_luminance_cd_m2: scotopic,
            zenith_scotopic_photopic_ratio: (zenith > 0.0).then(|| scotopic / zenith),
            zenith_chromaticity: colour.map(|(chromaticity, _)| chromaticity),
            zenith_colour_temperature_k: colour.and_then(|(_, temperature_k)| temperature_k),
            zenith_by_response: Response::ALL
                .iter()
                .map(|of| ZenithValue::new(of, value_of(parts, &at_zenith, of), natural_of(of)))
                .collect(),
            seen: asked,
            surfaces: Surfaces::new(sky.slope, by_response),
        }
    }
}

/// All quantities of artificial light above a horizon, whose hidden samples are 0, beside a dark sky of 22.0 mag arcsec⁻².
#[cfg(test)]
pub(crate) fn quantities_over(parts: &[SkyPart], horizon: &Horizon) -> SkyQuantities {
    let seen = SeenSky::of(parts, &SKY_RESPONSES);
    let dark = &crate::natural_sky::even_sky(crate::photometry::luminance_from_brightness_cd_m2(22.0), 0.1);
    SkyQuantities::with(
        NaturalSky::Dark,
        SkyNumbers {
            parts,
            seen: &seen,
            horizon,
            response: &Response::Photopic,
            dark,
            slope: Slope::default(),
        },
    )
}

/// A sky of one kind of light, of which `rule` of the photopic response gives `luminance`.
#[cfg(test)]
pub(crate) fn uniform_kernel(light: &crate::spectrum::Light, luminance_cd_m2: f64) -> f64 {
    luminance_cd_m2 / light.rule(&Response::Photopic).value([1.0; crate::spectrum::NODE_COUNT])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        Panorama,
        natural_sky::{NaturalLight, NodeLight, even_sky},
        panorama::Direction,
        spectrum::{LampPreset, NODE_COUNT},
        surfaces::BeamSums,
    };
    use std::{f64::consts::PI, sync::Arc};

    /// A uniform sky of the default lamp with a luminance, cd m⁻².
    fn uniform(luminance_cd_m2: f64) -> Vec<SkyPart> {
        let light = Arc::clone(LampPreset::Mixed.lamp().light());
        let kernel = uniform_kernel(&light, luminance_cd_m2) as f32;
        vec![SkyPart { light, kernel: Panorama::from_samples(vec![kernel; Panorama::LEN]).unwrap() }]
    }

    /// A uniform sky gives πL on the ground and half of it on a wall.
    #[test]
    fn a_uniform_sky_gives_pi_l() {
        let (parts, luminance) = (uniform(1e-3), 1e-3);
        let quantities = quantities_over(&parts, &Horizon::flat());
        assert!((quantities.horizontal_illuminance_lx / (PI * luminance) - 1.0).abs() < 1e-6);
        let [photopic, scotopic] = &quantities.surfaces.by_response[..] else { panic!("two responses") };
        assert_eq!((photopic.response.as_str(), scotopic.response.as_str()), ("photopic", "scotopic"));
        let on_ground = photopic.artificial.horizontal / quantities.horizontal_illuminance_lx;
        assert!((on_ground - 1.0).abs() < 1e-9, "{on_ground}");
        assert!((photopic.artificial.vertical_east / (PI * luminance / 2.0) - 1.0).abs() < 1e-3);
        let dark_lx = photopic.total.horizontal - photopic.artificial.horizontal;
        assert!(
            (dark_lx / (PI * crate::photometry::luminance_from_brightness_cd_m2(22.0)) - 1.0).abs() < 1e-3
        );
        for value in [
            quantities.zenith_luminance_cd_m2,
            quantities.mean_luminance_cd_m2,
            quantities.brightest_luminance_cd_m2,
            quantities.zenith_by_response[0].value,
        ] {
            assert!((value / luminance - 1.0).abs() < 1e-6, "{value}");
        }
    }

    /// A uniform sky has the colour of its lamp, and as many scotopic lumens to each photopic one.
    #[test]
    fn a_uniform_sky_has_the_colour_of_its_lamp() {
        let quantities = quantities_over(&uniform(1e-3), &Horizon::flat());
        let colour = LampPreset::Mixed.colour().unwrap();
        assert!(
            (quantities.zenith_scotopic_photopic_ratio.unwrap() / colour.scotopic_photopic_ratio - 1.0).abs()
                < 2e-3
        );
        let chromaticity = quantities.zenith_chromaticity.unwrap();
        assert!((0..2).all(|at| (chromaticity[at] - colour.chromaticity[at]).abs() < 1e-3));
        let temperature = quantities.zenith_colour_temperature_k.unwrap();
        assert!((temperature / colour.temperature_k.unwrap() - 1.0).abs() < 5e-3, "{temperature}");
        // The meter sees more of it than the eye, whose magnitudes agree for sunlight.
        let by = |name: &str| {
            let found = quantities.zenith_by_response.iter().find(|value| value.response == name);
            found.unwrap().brightness_mag_arcsec2.unwrap()
        };
        assert!(
            (0.3..0.8).contains(&(by("sqm") - by("photopic"))) && by("johnson_b") > by("johnson_v") + 0.5
        );
    }

    /// A dark sky is natural and has no artificial magnitude.
    #[test]
    fn a_dark_sky_is_natural() {
        let quantities = quantities_over(&[], &Horizon::flat());
        assert_eq!(quantities.zenith_brightness_mag_arcsec2, None);
        assert!((quantities.zenith_total_brightness_mag_arcsec2.unwrap() - 22.0).abs() < 1e-9);
        assert_eq!(quantities.bortle_class, Some(1));
        assert!((quantities.naked_eye_limit_mag.unwrap() - 6.27).abs() < 0.01);
        assert_eq!((quantities.zenith_chromaticity, quantities.zenith_scotopic_photopic_ratio), (None, None));
    }

    /// Nothing through clouds that let nothing through.
    fn nothing(none: &SeenSky) -> NaturalSky<'_> {
        NaturalSky::ThroughGaps(NaturalLight { parts: &[], seen: none, points: &[], beams: &[] })
    }

    /// Under clouds that let nothing through totals are artificial light alone, and there are no stars.
    #[test]
    fn overcast_totals_are_artificial_light() {
        let (parts, open) = (uniform(1e-3), Horizon::flat());
        let dark = &even_sky(1.7e-4, 0.0);
        let responses = SKY_RESPONSES.into_iter().chain([Response::Melanopic]).collect::<Vec<_>>();
        let none = SeenSky::of(&[], &responses);
        let under = |natural: NaturalSky<'_>, parts: &[SkyPart]| {
            let responses = SKY_RESPONSES.into_iter().chain([Response::Melanopic]).collect::<Vec<_>>();
            let seen = SeenSky::of(parts, &responses);
            let response = &Response::Melanopic;
            let slope = Slope::default();
            SkyQuantities::with(
                natural,
                SkyNumbers { parts, seen: &seen, horizon: &open, response, dark, slope },
            )
        };
        let (clear, cloudy) = (under(NaturalSky::Dark, &parts), under(nothing(&none), &parts));
        assert_eq!(cloudy.zenith_total_luminance_cd_m2, cloudy.zenith_luminance_cd_m2);
        assert_eq!(cloudy.zenith_total_brightness_mag_arcsec2, cloudy.zenith_brightness_mag_arcsec2);
        assert_eq!(cloudy.horizontal_total_illuminance_lx, cloudy.horizontal_illuminance_lx);
        assert_eq!((cloudy.bortle_class, cloudy.naked_eye_limit_mag), (None, None));
        assert_eq!(cloudy.ratio_to_natural, clear.ratio_to_natural);
        assert!(clear.horizontal_total_illuminance_lx > 1.0001 * cloudy.horizontal_total_illuminance_lx);
        let (seen, total) = (clear.seen.unwrap(), cloudy.seen.unwrap());
        assert_eq!((seen.response.as_str(), seen.zenith, seen.mean), ("melanopic", total.zenith, total.mean));
        assert!(seen.zenith_total > seen.zenith && total.zenith_total == total.zenith);
        assert_eq!(under(nothing(&none), &[]).zenith_total_brightness_mag_arcsec2, None);
    }

    /// The natural sky of an instant is added to totals as its parts have it, and hidden where ground hides it.
    #[test]
    fn totals_have_the_natural_sky_of_an_instant() {
        let (parts, natural) = (uniform(1e-3), uniform(2e-4));
        let responses = SKY_RESPONSES.into_iter().chain([Response::Melanopic]).collect::<Vec<_>>();
        let [seen, natural_seen] = [&parts, &natural].map(|parts| SeenSky::of(parts, &responses));
        let open = Horizon::flat();
        let (response, dark) = (&Response::Melanopic, &even_sky(1.7e-4, 0.0));
        let slope = Slope { steepness_rad: 0.4, downhill_azimuth_rad: 1.0 };
        let numbers = SkyNumbers { parts: &parts, seen: &seen, horizon: &open, response, dark, slope };
        let sky = NaturalSky::OfInstant(NaturalLight {
            parts: &natural,
            seen: &natural_seen,
            points: &[],
            beams: &[],
        });
        let found = SkyQuantities::with(sky, numbers);
        let none = SeenSky::of(&[], &responses);
        let artificial = SkyQuantities::with(nothing(&none), numbers);
        let seen = found.seen.as_ref().unwrap();
        for (total, value) in [
            (found.zenith_total_luminance_cd_m2, found.zenith_luminance_cd_m2),
            (found.horizontal_total_illuminance_lx, found.horizontal_illuminance_lx),
            (found.zenith_by_response[1].total, found.zenith_by_response[1].value),
            (seen.zenith_total, seen.zenith),
            (seen.horizontal_total, seen.horizontal),
        ] {
            assert!((total / value - 1.2).abs() < 1e-5, "{total} {value}");
        }
        assert!((found.ratio_to_natural - 5.0).abs() < 1e-5);
        // The class is that of the place, under whatever Moon.
        let moonlit = uniform(0.05);
        let moonlit_seen = SeenSky::of(&moonlit, &responses);
        let moonlight = NaturalLight { parts: &moonlit, seen: &moonlit_seen, points: &[], beams: &[] };
        for (parts, class) in [(&parts[..], 5), (&[], 1)] {
            let seen = &SeenSky::of(parts, &responses);
            let numbers = SkyNumbers { parts, seen, ..numbers };
            for natural in [NaturalSky::Dark, NaturalSky::OfInstant(moonlight)] {
                assert_eq!(SkyQuantities::with(natural, numbers).bortle_class, Some(class));
            }
        }
        let brighter = artificial.sqm_total_brightness_mag_arcsec2.unwrap()
            - found.sqm_total_brightness_mag_arcsec2.unwrap();
        assert!((brighter - 2.5 * 1.2f64.log10()).abs() < 1e-5, "{brighter}");
        // Stars in its field make the meter's reading brighter, and nothing else.
        let light = Arc::clone(&natural[0].light);
        let kernel = uniform_kernel(&light, 1e-4);
        let points = &[NodeLight { light: Arc::clone(&light), kernel: [kernel; NODE_COUNT] }];
        let zenith = Direction { azimuth_rad: 0.0, elevation_rad: PI / 2.0 };
        let beams = &[BeamSums::new(light, slope, [(zenith, [kernel; NODE_COUNT])].into_iter())];
        let starry =
            NaturalSky::OfInstant(NaturalLight { parts: &natural, seen: &natural_seen, points, beams });
        let with_stars = SkyQuantities::with(starry, numbers);
        let brighter = found.sqm_total_brightness_mag_arcsec2.unwrap()
            - with_stars.sqm_total_brightness_mag_arcsec2.unwrap();
        assert!((brighter - 2.5 * (1.3f64 / 1.2).log10()).abs() < 1e-5, "{brighter}");
        assert_eq!(with_stars.zenith_total_luminance_cd_m2, found.zenith_total_luminance_cd_m2);
        // The ground has their light too.
        let more_lx = with_stars.horizontal_total_illuminance_lx - found.horizontal_total_illuminance_lx;
        assert!((more_lx / 1e-4 - 1.0).abs() < 1e-5, "{more_lx}");
        let on_slope = |of: &SkyQuantities| of.surfaces.by_response[0].total.slope;
        let more_lx = on_slope(&with_stars) - on_slope(&found);
        assert!((more_lx / (1e-4 * 0.4f64.cos()) - 1.0).abs() < 1e-5, "{more_lx}");
        let lit = &with_stars.surfaces.by_response[0];
        assert!((lit.total.horizontal / with_stars.horizontal_total_illuminance_lx - 1.0).abs() < 1e-9);
        assert_eq!(with_stars.surfaces.by_response[2].response, "melanopic");
    }

    #[test]
    fn the_brightest_direction_is_found_where_it_is() {
        let mut parts = uniform(1e-6);
        for node in 0..NODE_COUNT {
            parts[0].kernel.samples_mut()[Panorama::index(node, 3, 64)] = 1.0;
        }
        let quantities = quantities_over(&parts, &Horizon::flat());
        assert!((quantities.brightest_azimuth_deg - 90.0).abs() < 1e-9);
        assert!((quantities.brightest_elevation_deg - 3.5 * 90.0 / 64.0).abs() < 1e-9);
    }
}
