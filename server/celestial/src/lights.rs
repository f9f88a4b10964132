//! Kinds of light of the night sky: a spectrum for each component, in the unit that its kernels count.

use crate::{
    airglow,
    components::Component,
    magnitudes::{DEG2_SR, black_body, with_magnitude_v},
    solar_spectrum::solar_irradiance,
    zodiacal_light,
};
use skyglow_physics::spectrum::{FIRST_NM, KernelShape, Light, NODE_COUNT, STEP_NM, Spectrum, nodes_nm};
use std::sync::{Arc, LazyLock};

/// V magnitude of the Sun at 1 au.
pub const SUN_MAGNITUDE_V: f64 = -26.74;
/// V magnitude of the full Moon at its mean distance from the Earth's centre, the Sun at 1 au (Krisciunas, Schaefer 1991).
pub const FULL_MOON_MAGNITUDE_V: f64 = -12.73;
/// B − V of the Sun (Ramírez et al. 2012).
pub(crate) const SUN_B_MINUS_V: f64 = 0.653;
/// B − V of starlight that no star is seen of, taken for all of it (Mattila 1980 has 0.7 to 0.8).
const STARLIGHT_B_MINUS_V: f64 = 0.75;
/// Temperature of the black body that stands for all stars, K: their light together has B − V = 0.4.
const STARS_K: f64 = 6_700.0;

/// The Sun's light reddened by so many magnitudes of B − V, as a power of the wavelength; the same at a wavelength, nm.
pub(crate) fn reddened_sun(excess_mag: f64, same_at_nm: f64) -> Spectrum {
    // B and V see 440 and 550 nm in the mean.
    let power = 0.4 * excess_mag * std::f64::consts::LN_10 / (550.0_f64 / 440.0).ln();
    let sun = solar_irradiance();
    sun.product(&Spectrum::from_fn(|nm| (nm / same_at_nm).powf(power)))
}

/// Sunlight by the Moon's reflectance at a phase of 30°, W m⁻² nm⁻¹ of the full Moon: ln A = 0.960 x − 0.239 x² with
/// x = ln(λ/550 nm), fitted to the bands of Kieffer and Stone (2005) from 405 to 882 nm within 3 %.
fn moonlight() -> Spectrum {
    let reflectance = Spectrum::from_fn(|nm| {
        let x = (nm / 550.0).ln();
        (0.960 * x - 0.239 * x * x).exp()
    });
    with_magnitude_v(&solar_irradiance().product(&reflectance), FULL_MOON_MAGNITUDE_V)
}

/// Sunlight of one star of magnitude 10 with the Sun's colour a square degree, W m⁻² sr⁻¹ nm⁻¹.
fn sunlight_s10() -> Spectrum {
    with_magnitude_v(&solar_irradiance(), 10.0).scaled(1.0 / DEG2_SR)
}

/// Starlight of 1 S10 at 440 nm, W m⁻² sr⁻¹ nm⁻¹.
fn starlight_s10() -> Spectrum {
    let sun = solar_irradiance();
    let scale = with_magnitude_v(&sun, 10.0).0[0] / sun.0[0] / DEG2_SR;
    reddened_sun(STARLIGHT_B_MINUS_V - SUN_B_MINUS_V, 440.0).scaled(scale)
}

static LIGHTS: LazyLock<[Arc<Light>; Component::ALL.len()]> = LazyLock::new(|| {
    Component::ALL.map(|component| {
        let light = Light::new(match component {
            Component::Sun => with_magnitude_v(&solar_irradiance(), SUN_MAGNITUDE_V),
            Component::Moon => moonlight(),
            Component::Planets => with_magnitude_v(&solar_irradiance(), 0.0),
            Component::Stars => with_magnitude_v(&Spectrum::from_fn(|nm| black_body(nm, STARS_K)), 0.0),
            Component::Starlight => starlight_s10(),
            Component::ZodiacalLight => sunlight_s10().product(&Spectrum::from_fn(|nm| {
                zodiacal_light::reddening(nm, zodiacal_light::MEAN_ELONGATION_DEG)
            })),
            Component::Airglow => airglow::spectrum_s10(),
        });
        let shape = match component {
            Component::Sun => KernelShape::ThroughOzone,
            _ => KernelShape::Polynomial,
        };
        Arc::new(light.behind(shape))
    })
});

impl Component {
    /// Its kind of light. Kernels at the nodes count it in the component's [unit](Self::unit), so that unit × kernel × spectrum is
    /// a spectral radiance, W m⁻² sr⁻¹ nm⁻¹, or for bodies an irradiance outside the air, W m⁻² nm⁻¹.
    pub fn light(self) -> &'static Arc<Light> {
        &LIGHTS[self.index()]
    }

    /// Its spectrum at the nodes, per unit.
    pub fn spectrum_at_nodes(self) -> [f64; NODE_COUNT] {
        at_nodes(self.light().spectrum())
    }
}

/// A spectrum at the nodes, linear between samples.
pub(crate) fn at_nodes(spectrum: &Spectrum) -> [f64; NODE_COUNT] {
    nodes_nm().map(|nm| {
        let place = (nm - FIRST_NM) / STEP_NM;
        let (below, part) = (place.floor(), place.fract());
        let sample = |at: f64| spectrum.0.get(at as usize).copied().unwrap_or(0.0);
        sample(below) + part * (sample(below + 1.0) - sample(below))
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::magnitudes::{S10_MAG_ARCSEC2, ZERO_MAGNITUDE_LX, magnitude_v};
    use skyglow_physics::{Response, photometry::ZERO_POINT_CD_M2};

    fn b_minus_v(spectrum: &Spectrum) -> f64 {
        let magnitude = |response: Response| -2.5 * response.value_of(spectrum).log10();
        magnitude(Response::JohnsonB) - magnitude(Response::JohnsonV)
    }

    /// Zero point, S10 and the magnitudes of the bodies are those that are published.
    #[test]
    fn units_are_what_they_say() {
        assert!((ZERO_MAGNITUDE_LX / 2.54e-6 - 1.0).abs() < 1e-3, "{ZERO_MAGNITUDE_LX}");
        let s10_cd_m2 = ZERO_POINT_CD_M2 * 10f64.powf(-0.4 * S10_MAG_ARCSEC2);
        assert!((s10_cd_m2 / 8.35e-7 - 1.0).abs() < 2e-3, "{s10_cd_m2}");
        for (component, magnitude) in [
            (Component::Sun, SUN_MAGNITUDE_V),
            (Component::Moon, FULL_MOON_MAGNITUDE_V),
            (Component::Planets, 0.0),
            (Component::Stars, 0.0),
        ] {
            assert!((magnitude_v(component.light().spectrum()) - magnitude).abs() < 1e-9, "{component:?}");
        }
        for (component, tolerance) in
            [(Component::Starlight, 0.1), (Component::ZodiacalLight, 0.04), (Component::Airglow, 1e-9)]
        {
            let v = Response::JohnsonV.value_of(component.light().spectrum());
            assert!((v / s10_cd_m2 - 1.0).abs() < tolerance + 1e-3, "{component:?}: {v}");
        }
        // Full moonlight is a quarter of a lux.
        let lux = Response::Photopic.value_of(Component::Moon.light().spectrum());
        assert!((0.30..0.34).contains(&lux), "{lux}");
    }

    /// B − V: Sun 0.65, Moon 0.85 at full and 0.92 at the quarters, night sky 0.8 to 1.0, of which airglow is the reddest part.
    #[test]
    fn colours_are_those_measured() {
        for (component, colour, tolerance) in [
            (Component::Sun, SUN_B_MINUS_V, 0.03),
            (Component::Moon, 0.88, 0.03),
            (Component::Starlight, STARLIGHT_B_MINUS_V, 0.04),
            (Component::ZodiacalLight, 0.72, 0.06),
            (Component::Airglow, 1.05, 0.02),
        ] {
            let found = b_minus_v(component.light().spectrum());
            assert!((found - colour).abs() < tolerance, "{component:?}: {found:.3}");
        }
    }
}
