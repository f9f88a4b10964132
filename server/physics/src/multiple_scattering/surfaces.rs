//! The two surfaces that reflect light of later orders, Lambertian (Lambert 1760): the ground, and the base of a cloud.

use super::{
    grid::{FieldGrid, LinearStencil},
    lanes::{LANES, Lanes, exp_lanes},
    path::Surface,
    radiance::Radiance,
    setting::SourceSetting,
};
use std::f64::consts::PI;

/// Radiance that stands for darkness, m⁻² sr⁻¹ per watt.
const DARKNESS: f64 = 1e-36;

/// ln of the radiance of a Lambertian surface, or of one with the same flux, [m⁻² sr⁻¹ per watt], `[ring]`.
#[derive(Clone, Debug)]
pub(super) struct SurfaceRadiance(Vec<Lanes>);

impl SurfaceRadiance {
    /// A·E/π from the flux that arrives, `[ring]`.
    fn new(albedo: f64, flux: &[[f64; LANES]]) -> Self {
        let ln = |flux: f64| (albedo * flux / PI).max(DARKNESS).ln() as f32;
        Self(flux.iter().map(|flux| flux.map(ln)).collect())
    }

    #[inline]
    pub(super) fn at(&self, ring: LinearStencil) -> Lanes {
        let (near, far) = (&self.0[ring.lower], &self.0[ring.lower + 1]);
        let w = ring.upper_weight as f32;
        exp_lanes(&std::array::from_fn(|lane| near[lane] + w * (far[lane] - near[lane])))
    }
}

/// What the surfaces reflect of the light of one order.
#[derive(Clone, Debug)]
pub(super) struct Surfaces {
    ground: SurfaceRadiance,
    base: Option<SurfaceRadiance>,
}

impl Surfaces {
    /// From the fluxes of one order in the lowest and the highest layer.
    pub(super) fn new(setting: &SourceSetting, grid: &FieldGrid, radiance: &Radiance) -> Self {
        let rings = grid.ring_count();
        Self {
            ground: SurfaceRadiance::new(setting.ground_albedo, &radiance.down_flux[..rings]),
            base: setting.atmosphere.cloud().map(|cloud| {
                SurfaceRadiance::new(cloud.diffuse_albedo(), &radiance.up_flux[grid.point_count() - rings..])
            }),
        }
    }

    /// Radiance of a surface, m⁻² sr⁻¹ per watt. A base that is not there is dark.
    #[inline]
    pub(super) fn at(&self, surface: Surface, ring: LinearStencil) -> Lanes {
        match (surface, &self.base) {
            (Surface::Ground, _) => self.ground.at(ring),
            (Surface::Base, Some(base)) => base.at(ring),
            (Surface::Base, None) => [0.0; LANES],
        }
    }
}

/// Flux onto the base of a cloud, summed over orders, m⁻² per watt, `[ring]`.
#[derive(Clone, Debug)]
pub(super) struct BaseFlux {
    sum: Vec<[f64; LANES]>,
    before: Vec<[f64; LANES]>,
    last: Vec<[f64; LANES]>,
}

impl BaseFlux {
    pub(super) fn dark(grid: &FieldGrid) -> Self {
        let dark = vec![[0.0; LANES]; grid.ring_count()];
        Self { sum: dark.clone(), before: dark.clone(), last: dark }
    }

    /// Adds the flux of the next order.
    pub(super) fn add(&mut self, grid: &FieldGrid, radiance: &Radiance) {
        let arriving = &radiance.up_flux[grid.point_count() - grid.ring_count()..];
        for (sum, flux) in self.sum.iter_mut().zip(arriving) {
            sum.iter_mut().zip(flux).for_each(|(sum, flux)| *sum += flux);
        }
        self.before = std::mem::replace(&mut self.last, arriving.to_vec());
    }

    /// What the base reflects of all orders, those after the last one added as a geometric series with the ratio of
    /// the last two, no steeper than `steepest`.
    pub(super) fn radiance(mut self, albedo: f64, steepest: f64) -> SurfaceRadiance {
        for ((sum, before), last) in self.sum.iter_mut().zip(&self.before).zip(&self.last) {
            for lane in 0..LANES {
                if before[lane] > 0.0 {
                    let ratio = (last[lane] / before[lane]).clamp(0.0, steepest);
                    sum[lane] += last[lane] * ratio / (1.0 - ratio);
                }
            }
        }
        SurfaceRadiance::new(albedo, &self.sum)
    }
}
