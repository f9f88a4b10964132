//! The air and the lamps of a request, as the near-field correction needs them.

use crate::cpu::lanes::exponential;
use skyglow_physics::{
    Atmosphere, BAND_COUNT, EARTH_RADIUS_M,
    atmosphere::{AEROSOL_ALBEDO, AEROSOL_SCALE_HEIGHT_M, MOLECULE_SCALE_HEIGHT_M},
    near_light::NearScattering,
    panorama::azimuth_rad,
};

/// Largest power of e by which air is thicker or thinner than at the light.
pub(crate) const MAX_LOG_DENSITY: f32 = 8.0;

/// Scale heights of molecules and of aerosol, metres.
pub(crate) const HEIGHTS_M: [f32; 2] = [MOLECULE_SCALE_HEIGHT_M as f32, AEROSOL_SCALE_HEIGHT_M as f32];

/// The air and the lamps of a request.
pub(crate) struct Air {
    pub scattering: NearScattering,
    pub observer_altitude_m: f64,
    /// β at z = 0, `[molecules, aerosol][band]`, m⁻¹.
    pub extinction_per_m: [[f64; BAND_COUNT]; 2],
    /// ω·β at z = 0, `[molecules, aerosol][band]`, m⁻¹.
    pub scattered_per_m: [[f32; BAND_COUNT]; 2],
    /// e^{−z/H} at the observer, `[molecules, aerosol]`.
    pub density: [f32; 2],
}

impl Air {
    pub(crate) fn new(scattering: NearScattering, air: &Atmosphere, observer_altitude_m: f64) -> Self {
        let extinction_per_m = [air.molecule_extinction_per_m(), air.aerosol_extinction_per_m()];
        let [molecules, aerosol] = extinction_per_m;
        Self {
            scattering,
            observer_altitude_m,
            extinction_per_m,
            scattered_per_m: [molecules, aerosol.map(|beta| AEROSOL_ALBEDO * beta)]
                .map(|of| of.map(|beta| beta as f32)),
            density: HEIGHTS_M.map(|height_m| density(-observer_altitude_m as f32 / height_m)),
        }
    }

    /// No less than the radiance of a light per watt in each band, times its distance, half a column beside and half a row or
    /// more above it, m⁻¹ sr⁻¹, for lights of some altitudes and distances, where `scattered` is the
    /// largest F: air no thinner than at the lowest point to which a ray may
    /// come next to them, and for the way densities at the mean of its altitudes, than which their mean is no less.
    pub(crate) fn max_peak_per_m(
        &self,
        scattered: [f32; 2],
        altitude_m: [f64; 2],
        distance_m: [f64; 2],
    ) -> [f32; BAND_COUNT] {
        let step = azimuth_rad(1);
        let half = 0.99 * (0.5 * step).sin();
        // Up to 45° a column is no narrower than by √½ there.
        let aside = half * 1.5f64.sqrt();
        let [from_m, to_m] = distance_m;
        let curved_m = from_m * from_m / (2.0 * EARTH_RADIUS_M);
        let nearest_m = from_m * half + altitude_m[0].max(self.observer_altitude_m + curved_m);
        let mean_m = altitude_m[1].max(self.observer_altitude_m)
            + to_m * (0.75 * step + to_m / (6.0 * EARTH_RADIUS_M));
        let at = |altitude_m: f64| HEIGHTS_M.map(|height_m| density(-altitude_m as f32 / height_m));
        let (nearest, mean) = (at(nearest_m), at(mean_m));
        std::array::from_fn(|band| {
            let peak: f32 = (0..2).map(|s| scattered[s] * nearest[s] * self.scattered_per_m[s][band]).sum();
            let lost_per_m: f32 = (0..2).map(|s| mean[s] * self.extinction_per_m[s][band] as f32).sum();
            let root = density(-0.25 * 0.98 * from_m as f32 * lost_per_m);
            peak / aside as f32 * (root * root) * (root * root)
        })
    }
}

/// e^x with x held within ±8: no air of the model is thicker or thinner.
#[inline(always)]
pub(crate) fn density(log: f32) -> f32 {
    exponential::<false>(log.clamp(-MAX_LOG_DENSITY, MAX_LOG_DENSITY))
}
