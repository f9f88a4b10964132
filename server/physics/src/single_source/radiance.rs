//! Sky radiance of one source at one direction: of all lobes or of a mix, by an adaptive or a fixed rule, under an open
//! sky or behind a skyline.
//!
//! `blocking_rad` is the elevation of the skyline as seen from the source: at and below it the source emits
//! nothing, in any direction. 0 and below is the open sky, with the same bits as the functions without it; at π/2 all
//! is dark. Radiance falls as it rises.
//!
//! Under a cloud (`Atmosphere::under`) the light that its base reflects is added; an observer at or above the base sees
//! exactly nothing, and of a source there nothing is seen. Atmospheres that are evaluated together must lie under the same
//! cloud: the functions panic if not.

use super::{OUTPUT_COUNT, RadiancePerWatt, SourceGeometry, overcast::with_base, scattering::Integrand};
use crate::{
    atmosphere::Atmosphere,
    bands::BAND_COUNT,
    emission::{EmissionMix, LOBE_COUNT},
};

/// Sky radiance per watt of every band and lobe at one direction, `[atmosphere][band][lobe]`, for several
/// turbidities at once, each to a relative `tolerance`.
///
/// `floor_per_m2_sr`: values below it need only be right to `tolerance` times it (0: always relative).
/// Exactly zero where the whole ray lies in the Earth's shadow. `N` must be the number of atmospheres times
/// [`OUTPUT_COUNT`].
pub fn radiance_per_watt<const N: usize>(
    atmospheres: &[Atmosphere],
    geometry: &SourceGeometry,
    relative_azimuth_rad: f64,
    elevation_rad: f64,
    tolerance: f64,
    floor_per_m2_sr: f64,
) -> [f64; N] {
    cut_radiance_per_watt(
        atmospheres,
        geometry,
        0.0,
        relative_azimuth_rad,
        elevation_rad,
        tolerance,
        floor_per_m2_sr,
    )
}

/// As [`radiance_per_watt`] behind a skyline.
pub fn cut_radiance_per_watt<const N: usize>(
    atmospheres: &[Atmosphere],
    geometry: &SourceGeometry,
    blocking_rad: f64,
    relative_azimuth_rad: f64,
    elevation_rad: f64,
    tolerance: f64,
    floor_per_m2_sr: f64,
) -> [f64; N] {
    assert_eq!(N, atmospheres.len() * OUTPUT_COUNT, "one slot for each atmosphere, band and lobe");
    let scattering = Integrand::new(atmospheres, geometry, blocking_rad, elevation_rad);
    let ray = scattering.ray(geometry, blocking_rad, relative_azimuth_rad, elevation_rad);
    let air = ray.integrate(tolerance, floor_per_m2_sr, |p| scattering.by_lobe(p));
    with_base(air, scattering.lit_base_point(&ray).map(|p| scattering.reflected_by_lobe(&p)))
}

/// As [`radiance_per_watt`] with a fixed rule (see [`super::SourceRay::integrate_fixed`]): about 1e-4 with 10 nodes.
pub fn radiance_per_watt_fixed<const N: usize>(
    atmospheres: &[Atmosphere],
    geometry: &SourceGeometry,
    relative_azimuth_rad: f64,
    elevation_rad: f64,
    nodes: &[(f64, f64)],
) -> [f64; N] {
    cut_radiance_per_watt_fixed(atmospheres, geometry, 0.0, relative_azimuth_rad, elevation_rad, nodes)
}

/// As [`radiance_per_watt_fixed`] behind a skyline.
pub fn cut_radiance_per_watt_fixed<const N: usize>(
    atmospheres: &[Atmosphere],
    geometry: &SourceGeometry,
    blocking_rad: f64,
    relative_azimuth_rad: f64,
    elevation_rad: f64,
    nodes: &[(f64, f64)],
) -> [f64; N] {
    assert_eq!(N, atmospheres.len() * OUTPUT_COUNT, "one slot for each atmosphere, band and lobe");
    let scattering = Integrand::new(atmospheres, geometry, blocking_rad, elevation_rad);
    let ray = scattering.ray(geometry, blocking_rad, relative_azimuth_rad, elevation_rad);
    let air = ray.integrate_fixed(nodes, |p| scattering.by_lobe(p));
    with_base(air, scattering.lit_base_point(&ray).map(|p| scattering.reflected_by_lobe(&p)))
}

/// Sky radiance per watt of a source with a mix of lobes, m⁻² sr⁻¹, `[atmosphere][band]`, to a relative
/// `tolerance`. `N` must be the number of atmospheres times [`BAND_COUNT`].
pub fn mixed_radiance_per_watt<const N: usize>(
    atmospheres: &[Atmosphere],
    geometry: &SourceGeometry,
    emission: EmissionMix,
    relative_azimuth_rad: f64,
    elevation_rad: f64,
    tolerance: f64,
) -> [f64; N] {
    cut_mixed_radiance_per_watt(
        atmospheres,
        geometry,
        emission,
        0.0,
        relative_azimuth_rad,
        elevation_rad,
        tolerance,
    )
}

/// As [`mixed_radiance_per_watt`] behind a skyline.
pub fn cut_mixed_radiance_per_watt<const N: usize>(
    atmospheres: &[Atmosphere],
    geometry: &SourceGeometry,
    emission: EmissionMix,
    blocking_rad: f64,
    relative_azimuth_rad: f64,
    elevation_rad: f64,
    tolerance: f64,
) -> [f64; N] {
    assert_eq!(N, atmospheres.len() * BAND_COUNT, "one slot for each atmosphere and band");
    let scattering = Integrand::new(atmospheres, geometry, blocking_rad, elevation_rad);
    let weights = emission.weights();
    let ray = scattering.ray(geometry, blocking_rad, relative_azimuth_rad, elevation_rad);
    let air = ray.integrate(tolerance, 0.0, |p| scattering.of_mix(p, weights));
    with_base(air, scattering.lit_base_point(&ray).map(|p| scattering.reflected_of_mix(&p, weights)))
}

/// [`radiance_per_watt`] for one atmosphere, as `[band][lobe]`.
pub fn radiance_per_watt_of(
    atmosphere: &Atmosphere,
    geometry: &SourceGeometry,
    relative_azimuth_rad: f64,
    elevation_rad: f64,
    tolerance: f64,
) -> RadiancePerWatt {
    cut_radiance_per_watt_of(atmosphere, geometry, 0.0, relative_azimuth_rad, elevation_rad, tolerance)
}

/// As [`radiance_per_watt_of`] behind a skyline.
pub fn cut_radiance_per_watt_of(
    atmosphere: &Atmosphere,
    geometry: &SourceGeometry,
    blocking_rad: f64,
    relative_azimuth_rad: f64,
    elevation_rad: f64,
    tolerance: f64,
) -> RadiancePerWatt {
    let flat: [f64; OUTPUT_COUNT] = cut_radiance_per_watt(
        std::slice::from_ref(atmosphere),
        geometry,
        blocking_rad,
        relative_azimuth_rad,
        elevation_rad,
        tolerance,
        0.0,
    );
    std::array::from_fn(|band| std::array::from_fn(|lobe| flat[band * LOBE_COUNT + lobe]))
}
