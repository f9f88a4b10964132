//! Skyglow of one source whose light does not reach every point of the view ray, by a fixed quadrature.

use super::{SourceGeometry, overcast::with_base, scattering::Integrand};
use crate::{atmosphere::Atmosphere, bands::BAND_COUNT, emission::EmissionMix};

/// As [`mixed_radiance_per_watt`](super::mixed_radiance_per_watt), m⁻² sr⁻¹, `[atmosphere][band]`, counting only
/// the points of the view ray that the source lights: `is_lit` is called at each with its distance [m] from the
/// observer and the cosine of the zenith angle at which its light left the source.
///
/// What hides the source makes the integrand jump where it likes, so no adaptive rule is right: `nodes` (on 0..1,
/// weights summing to 1) are taken on each of the half dozen pieces of the ray, in the angle at the source. A jump
/// costs at most half a node's share of a piece. Under a cloud the point where the ray meets the base is tested too.
/// `N` must be the number of atmospheres times [`BAND_COUNT`].
pub fn mixed_radiance_per_watt_where<const N: usize>(
    atmospheres: &[Atmosphere],
    geometry: &SourceGeometry,
    emission: EmissionMix,
    relative_azimuth_rad: f64,
    elevation_rad: f64,
    nodes: &[(f64, f64)],
    mut is_lit: impl FnMut(f64, f64) -> bool,
) -> [f64; N] {
    assert_eq!(N, atmospheres.len() * BAND_COUNT, "one slot for each atmosphere and band");
    let scattering = Integrand::new(atmospheres, geometry, 0.0, elevation_rad);
    let weights = emission.weights();
    let ray = scattering.ray(geometry, 0.0, relative_azimuth_rad, elevation_rad);
    let air = ray.integrate_fixed(nodes, |point| {
        if is_lit(point.path_m, point.cos_zenith_at_source) {
            scattering.of_mix(point, weights)
        } else {
            [0.0; N]
        }
    });
    let base = scattering.lit_base_point(&ray).filter(|p| is_lit(p.path_m, p.cos_zenith_at_source));
    with_base(air, base.map(|p| scattering.reflected_of_mix(&p, weights)))
}
