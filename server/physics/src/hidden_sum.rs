//! The reference solution for sources behind terrain: first-order light, each segment from a source to a point of the
//! view ray tested against the ground (`docs/model.md#reference`).
//!
//! Slow and simple on purpose. The ground is the caller's: a function tells whether it hides one point from another.
//! Beside it is the definition that the tables follow, each source's lobe cut at one blocking angle
//! all around ([`cut_sum`]), summed by the same rule, so that the two differ by the definition alone.

use crate::{
    atmosphere::Atmosphere,
    bands::BAND_COUNT,
    emission::EmissionMix,
    geometry::{EARTH_RADIUS_M, GeoPoint, LocalFrame},
    panorama::Direction,
    quadrature::gauss_legendre,
    single_source::{SourceGeometry, mixed_radiance_per_watt_where},
    source_pixel::PointSource,
};
use glam::DVec3;
use rayon::prelude::*;

/// Points on each of the half dozen pieces of a view ray: some hundreds a ray.
const NODES_PER_PIECE: usize = 96;

/// Observer, sources and directions: the input of both sums.
#[derive(Clone, Copy, Debug)]
pub struct SkySum<'a> {
    /// The observer's place.
    pub place: GeoPoint,
    /// The observer's altitude, metres above the sphere.
    pub observer_altitude_m: f64,
    /// Point sources as that observer sees them.
    pub sources: &'a [PointSource],
    /// Emission of every source.
    pub emission: EmissionMix,
    /// The lamp's s_b.
    pub flux_per_dnb_flux: [f64; BAND_COUNT],
    /// View directions.
    pub directions: &'a [Direction],
}

/// Sky radiance [W m⁻² sr⁻¹] at each direction, `[direction][band]`, without the light that `is_hidden` takes away.
///
/// `is_hidden` is given the positions of a source and of a point that it would light, metres from the Earth's centre
/// in the frame of [`GeoPoint::unit_vector`]. Parallel over directions; the result does not depend on threads.
pub fn hidden_sum(
    atmosphere: &Atmosphere,
    sum: &SkySum<'_>,
    is_hidden: &(dyn Fn(DVec3, DVec3) -> bool + Sync),
) -> Vec<[f64; BAND_COUNT]> {
    let frame = LocalFrame::at(sum.place);
    let eye_m = frame.up * (EARTH_RADIUS_M + sum.observer_altitude_m);
    let sources_m: Vec<DVec3> = sum
        .sources
        .iter()
        .map(|source| {
            let place = sum.place.destination(source.azimuth_rad, source.distance_m);
            place.unit_vector() * (EARTH_RADIUS_M + source.altitude_m)
        })
        .collect();
    sum_where(atmosphere, sum, &|index, direction, path_m, _| {
        let enu = direction.enu();
        let view = frame.east * enu.x + frame.north * enu.y + frame.up * enu.z;
        !is_hidden(sources_m[index], eye_m + view * path_m)
    })
}

/// Sky radiance [W m⁻² sr⁻¹] at each direction, `[direction][band]`, with each source's lobe cut all around below its
/// own blocking angle.
///
/// `blocking_rad`: radians above the source's horizontal plane, in parallel with the sources; 0 and less cut nothing.
pub fn cut_sum(atmosphere: &Atmosphere, sum: &SkySum<'_>, blocking_rad: &[f64]) -> Vec<[f64; BAND_COUNT]> {
    let sines: Vec<f64> = blocking_rad.iter().map(|angle| angle.sin()).collect();
    sum_where(atmosphere, sum, &|index, _, _, cos_zenith_at_source| cos_zenith_at_source >= sines[index])
}

/// Whether a source (by its index) lights the point of a view direction at a distance [m] from the observer, where the
/// light leaves the source at the cosine of a zenith angle.
type IsLit<'a> = dyn Fn(usize, &Direction, f64, f64) -> bool + Sync + 'a;

fn sum_where(atmosphere: &Atmosphere, sum: &SkySum<'_>, is_lit: &IsLit<'_>) -> Vec<[f64; BAND_COUNT]> {
    let nodes = gauss_legendre(NODES_PER_PIECE);
    let of_direction = |direction: &Direction| {
        let mut radiance = [0.0; BAND_COUNT];
        for (index, source) in sum.sources.iter().enumerate() {
            let geometry = SourceGeometry {
                distance_m: source.distance_m,
                source_altitude_m: source.altitude_m,
                observer_altitude_m: sum.observer_altitude_m,
            };
            let per_watt: [f64; BAND_COUNT] = mixed_radiance_per_watt_where(
                std::slice::from_ref(atmosphere),
                &geometry,
                sum.emission,
                direction.azimuth_rad - source.azimuth_rad,
                direction.elevation_rad,
                &nodes,
                |path_m, cos_zenith| is_lit(index, direction, path_m, cos_zenith),
            );
            for (band, value) in per_watt.into_iter().enumerate() {
                radiance[band] += source.flux_dnb_w * sum.flux_per_dnb_flux[band] * value;
            }
        }
        radiance
    };
    sum.directions.par_iter().map(of_direction).collect()
}

#[cfg(test)]
#[path = "hidden_sum_tests.rs"]
mod tests;
