//! Light that the air scatters at a point of a view ray towards the observer: the integrand of b.

use super::{RayPoint, SourceGeometry};
use crate::{
    atmosphere::{AEROSOL_ALBEDO, AEROSOL_SCALE_HEIGHT_M, Atmosphere, MOLECULE_SCALE_HEIGHT_M},
    bands::BAND_COUNT,
    chapman::{self, ChapmanAt},
    cloud::CloudBase,
    cone::sin_blocking,
    emission::{LOBE_COUNT, lobe_intensities_per_sr},
    phase::{AEROSOL_ASYMMETRY, henyey_greenstein_per_sr, rayleigh_per_sr},
};

/// The integrand of b for several atmospheres at once: the geometry and the columns are shared.
pub(super) struct Integrand<'a> {
    pub(super) atmospheres: &'a [Atmosphere],
    /// The columns' tables of molecules and aerosol at the source.
    source_tables: [ChapmanAt<'static>; 2],
    /// Sine of the elevation at the source at and below which it emits nothing.
    pub(super) sin_blocking: f64,
    /// Densities of molecules and aerosol at the source, relative to z = 0.
    source_density: [f64; 2],
    /// Columns of molecules and aerosol from the observer along the whole view ray, metres.
    observer_column_m: [f64; 2],
    /// The cloud over all the atmospheres.
    pub(super) cloud: Option<CloudBase>,
}

/// The cloud over atmospheres that share one geometry; None for a clear sky, and without atmospheres.
///
/// # Panics
/// If they do not lie under the same cloud: rays of one geometry end at one altitude.
fn shared_cloud(atmospheres: &[Atmosphere]) -> Option<CloudBase> {
    let cloud = atmospheres.first().and_then(Atmosphere::cloud);
    assert!(
        atmospheres.iter().all(|atmosphere| atmosphere.cloud() == cloud),
        "atmospheres that are evaluated together lie under one cloud"
    );
    cloud
}

/// Densities of molecules and aerosol relative to z = 0.
pub(super) fn relative_densities(altitude_m: f64) -> [f64; 2] {
    [(-altitude_m / MOLECULE_SCALE_HEIGHT_M).exp(), (-altitude_m / AEROSOL_SCALE_HEIGHT_M).exp()]
}

impl<'a> Integrand<'a> {
    pub(super) fn new(
        atmospheres: &'a [Atmosphere],
        geometry: &SourceGeometry,
        blocking_rad: f64,
        elevation_rad: f64,
    ) -> Self {
        let observer_density = relative_densities(geometry.observer_altitude_m);
        let sin_elevation = elevation_rad.sin();
        let tables = [chapman::molecules(), chapman::aerosol()];
        Self {
            atmospheres,
            source_tables: tables.map(|table| table.at(geometry.source_altitude_m)),
            sin_blocking: sin_blocking(blocking_rad),
            source_density: relative_densities(geometry.source_altitude_m),
            observer_column_m: std::array::from_fn(|species| {
                tables[species].column_m(
                    geometry.observer_altitude_m,
                    sin_elevation,
                    observer_density[species],
                )
            }),
            cloud: shared_cloud(atmospheres),
        }
    }

    /// b's integrand [m⁻³ sr⁻¹], `[atmosphere][band][lobe]`.
    pub(super) fn by_lobe<const N: usize>(&self, p: &RayPoint) -> [f64; N] {
        let lobes = lobe_intensities_per_sr(p.cos_zenith_at_source);
        let mut out = [0.0; N];
        self.scattered(p, |slot, scattered| {
            for (lobe, intensity) in lobes.iter().enumerate() {
                out[slot * LOBE_COUNT + lobe] = scattered * intensity;
            }
        });
        out
    }

    /// b's integrand [m⁻³ sr⁻¹] of a mix of lobes, `[atmosphere][band]`.
    pub(super) fn of_mix<const N: usize>(&self, p: &RayPoint, weights: [f64; LOBE_COUNT]) -> [f64; N] {
        let lobes = lobe_intensities_per_sr(p.cos_zenith_at_source);
        let intensity: f64 = lobes.iter().zip(weights).map(|(f, w)| f * w).sum();
        let mut out = [0.0; N];
        self.scattered(p, |slot, scattered| out[slot] = scattered * intensity);
        out
    }

    /// Columns of molecules and aerosol from the source by way of a point to the observer, metres.
    pub(super) fn columns_m(&self, p: &RayPoint, density: [f64; 2]) -> [f64; 2] {
        let column = |species: usize, table: &chapman::ChapmanTable| {
            let here = density[species];
            let table = table.at(p.altitude_m);
            let from_source = self.source_tables[species]
                .column_m(p.cos_zenith_at_source, self.source_density[species])
                - table.column_m(p.cos_zenith_of_light, here);
            let to_observer = self.observer_column_m[species] - table.column_m(p.cos_zenith_of_view, here);
            (from_source + to_observer).max(0.0)
        };
        [column(0, chapman::molecules()), column(1, chapman::aerosol())]
    }

    /// Scattering times both transmissions over d² [m⁻³ sr⁻¹, per unit intensity] for each (atmosphere, band)
    /// slot.
    fn scattered(&self, p: &RayPoint, mut put: impl FnMut(usize, f64)) {
        if p.cos_zenith_at_source <= self.sin_blocking {
            return;
        }
        let density = relative_densities(p.altitude_m);
        let [path_molecules_m, path_aerosol_m] = self.columns_m(p, density);
        let phase_molecules = density[0] * rayleigh_per_sr(p.cos_gamma) / p.source_distance_m2;
        let phase_aerosol =
            density[1] * AEROSOL_ALBEDO * henyey_greenstein_per_sr(p.cos_gamma, AEROSOL_ASYMMETRY)
                / p.source_distance_m2;
        for (index, atmosphere) in self.atmospheres.iter().enumerate() {
            let beta_m = atmosphere.molecule_extinction_per_m();
            let beta_a = atmosphere.aerosol_extinction_per_m();
            for band in 0..BAND_COUNT {
                let depth = beta_m[band] * path_molecules_m + beta_a[band] * path_aerosol_m;
                let scattering = beta_m[band] * phase_molecules + beta_a[band] * phase_aerosol;
                put(index * BAND_COUNT + band, (-depth).exp() * scattering);
            }
        }
    }
}
