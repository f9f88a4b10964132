//! Light that the base of a cloud adds to a view ray (`docs/model.md#overcast`).
//!
//!   b_base = E(P)·R/π · exp(−τ(P,O)),   E(P) = f(ψ)/d² · cos i · exp(−τ(S,P))     [m⁻² sr⁻¹ per watt]
//!
//! P is where the ray meets the base, i the zenith angle of the light there, R the reflectance there and in these directions, which is
//! the albedo where the base is Lambertian. Nothing comes through the base: an
//! observer at or above it sees nothing of this light, and a source at or above it emits nothing below.

use super::{
    RayPoint, SourceGeometry, SourceRay,
    scattering::{Integrand, relative_densities},
};
use crate::{
    bands::BAND_COUNT,
    emission::{LOBE_COUNT, lobe_intensities_per_sr},
};
use std::f64::consts::PI;

/// The light of the air and of the base, if it is seen.
pub(super) fn with_base<const N: usize>(mut air: [f64; N], base: Option<[f64; N]>) -> [f64; N] {
    if let Some(base) = base {
        air.iter_mut().zip(base).for_each(|(sum, value)| *sum += value);
    }
    air
}

impl Integrand<'_> {
    /// The view ray past the source, behind its skyline and below the cloud.
    pub(super) fn ray(
        &self,
        geometry: &SourceGeometry,
        blocking_rad: f64,
        relative_azimuth_rad: f64,
        elevation_rad: f64,
    ) -> SourceRay {
        SourceRay::new(geometry, relative_azimuth_rad, elevation_rad).cut_at(blocking_rad).under(self.cloud)
    }

    /// Where a ray meets the base of the cloud, if the source lights that point; None under a clear sky.
    pub(super) fn lit_base_point(&self, ray: &SourceRay) -> Option<RayPoint> {
        if self.cloud.is_none() || ray.top_altitude_m == f64::NEG_INFINITY {
            return None;
        }
        let point = ray.point(ray.path_to_altitude_m(ray.top_altitude_m));
        (point.cos_zenith_at_source > self.sin_blocking).then_some(point)
    }

    /// b of the light reflected at a point of the base [m⁻² sr⁻¹], `[atmosphere][band][lobe]`.
    pub(super) fn reflected_by_lobe<const N: usize>(&self, p: &RayPoint) -> [f64; N] {
        let lobes = lobe_intensities_per_sr(p.cos_zenith_at_source);
        let mut out = [0.0; N];
        self.reflected(p, |slot, reflected| {
            for (lobe, intensity) in lobes.iter().enumerate() {
                out[slot * LOBE_COUNT + lobe] = reflected * intensity;
            }
        });
        out
    }

    /// b of the light of a mix of lobes reflected at a point of the base [m⁻² sr⁻¹], `[atmosphere][band]`.
    pub(super) fn reflected_of_mix<const N: usize>(
        &self,
        p: &RayPoint,
        weights: [f64; LOBE_COUNT],
    ) -> [f64; N] {
        let lobes = lobe_intensities_per_sr(p.cos_zenith_at_source);
        let intensity: f64 = lobes.iter().zip(weights).map(|(f, w)| f * w).sum();
        let mut out = [0.0; N];
        self.reflected(p, |slot, reflected| out[slot] = reflected * intensity);
        out
    }

    /// cos i·R/π times both transmissions over d² [m⁻² sr⁻¹, per unit intensity] for each (atmosphere, band) slot.
    fn reflected(&self, p: &RayPoint, mut put: impl FnMut(usize, f64)) {
        let Some(cloud) = self.cloud else { return };
        let [molecules_m, aerosol_m] = self.columns_m(p, relative_densities(p.altitude_m));
        let cos_light = p.cos_zenith_of_light.max(0.0);
        let reflectance = cloud.reflectance(cos_light, p.cos_zenith_of_view, p.cos_gamma);
        let response = reflectance / PI * cos_light / p.source_distance_m2;
        for (index, atmosphere) in self.atmospheres.iter().enumerate() {
            let beta_m = atmosphere.molecule_extinction_per_m();
            let beta_a = atmosphere.aerosol_extinction_per_m();
            for band in 0..BAND_COUNT {
                let depth = beta_m[band] * molecules_m + beta_a[band] * aerosol_m;
                put(index * BAND_COUNT + band, (-depth).exp() * response);
            }
        }
    }
}
