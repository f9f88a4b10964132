//! First-order light at a place, summed over directions: moments over spherical harmonics, and fluxes.

use super::{
    LANES, Lanes,
    harmonics::{cosines, legendre, pair_count, pair_index},
};
use crate::{geometry::EARTH_RADIUS_M, quadrature::gauss_legendre};
use glam::DVec3;

/// How finely first-order light is sampled.
#[derive(Clone, Debug)]
pub(super) struct FirstOrderRule {
    /// Nodes in the angle from the source's direction, half of them in the bright part around it.
    pub(super) polar: Vec<(f64, f64)>,
    /// Directions around it in a half turn.
    pub(super) around: usize,
    /// Nodes in each piece of a ray.
    pub(super) along: Vec<(f64, f64)>,
}

impl FirstOrderRule {
    pub(super) fn new(polar: usize, around: usize, along: usize) -> Self {
        Self { polar: gauss_legendre(polar / 2), around, along: gauss_legendre(along) }
    }
}

/// First-order light at one place.
#[derive(Clone, Debug)]
pub(super) struct FirstOrderPlace {
    /// Moments of the radiance per watt, m⁻², `[pair][lane]`.
    pub(super) moments: Vec<Lanes>,
    /// Flux through the horizontal from above, m⁻².
    pub(super) down_flux: [f64; LANES],
    /// Flux through the horizontal from below, m⁻².
    pub(super) up_flux: [f64; LANES],
}

/// The sum over directions of first-order light at one place.
pub(super) struct Gathering {
    degree: usize,
    moments: Vec<[f64; LANES]>,
    down_flux: [f64; LANES],
    up_flux: [f64; LANES],
}

impl Gathering {
    pub(super) fn new(degree: usize) -> Self {
        let moments = vec![[0.0f64; LANES]; pair_count(degree)];
        Self { degree, moments, down_flux: [0.0; LANES], up_flux: [0.0; LANES] }
    }

    /// Adds radiance [m⁻² sr⁻¹ per watt] from direction `view` times a solid angle [sr], which holds the mirror image
    /// on the other side of the source's vertical plane.
    pub(super) fn add(&mut self, place: &Place, view: DVec3, radiance: &[f64; LANES], solid_angle: f64) {
        let cos_zenith = view.dot(place.up).clamp(-1.0, 1.0);
        let horizontal = (1.0 - cos_zenith * cos_zenith).sqrt().max(1e-12);
        let cos_azimuth = (view.dot(place.outward) / horizontal).clamp(-1.0, 1.0);
        let polar = legendre(self.degree, cos_zenith);
        let azimuthal = cosines(self.degree, cos_azimuth);
        for l in 0..=self.degree {
            for m in 0..=l {
                let factor = polar[pair_index(l, m)] * azimuthal[m] * solid_angle;
                for (sum, value) in self.moments[pair_index(l, m)].iter_mut().zip(radiance) {
                    *sum += factor * value;
                }
            }
        }
        for (sum, value) in self.down_flux.iter_mut().zip(radiance) {
            *sum += value * cos_zenith.max(0.0) * solid_angle;
        }
        for (sum, value) in self.up_flux.iter_mut().zip(radiance) {
            *sum += value * (-cos_zenith).max(0.0) * solid_angle;
        }
    }

    pub(super) fn done(self) -> FirstOrderPlace {
        FirstOrderPlace {
            moments: self.moments.iter().map(|moment| moment.map(|value| value as f32)).collect(),
            down_flux: self.down_flux,
            up_flux: self.up_flux,
        }
    }
}

/// A place and its local directions in the frame of the Earth's centre with the source on the z axis.
pub(super) struct Place {
    pub(super) position: DVec3,
    pub(super) outward: DVec3,
    pub(super) up: DVec3,
    pub(super) altitude_m: f64,
}

impl Place {
    pub(super) fn new(distance_m: f64, altitude_m: f64) -> Self {
        let (sine, cosine) = (distance_m / EARTH_RADIUS_M).sin_cos();
        let up = DVec3::new(sine, 0.0, cosine);
        Self {
            position: up * (EARTH_RADIUS_M + altitude_m),
            outward: DVec3::new(cosine, 0.0, -sine),
            up,
            altitude_m,
        }
    }
}
