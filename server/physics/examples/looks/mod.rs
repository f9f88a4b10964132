//! What single sources are compared at: some distances, and some directions of the panorama's grid.

use skyglow_physics::{
    Atmosphere,
    multiple_scattering::SourceField,
    panorama::{azimuth_rad, elevation_rad},
    single_source::{RadiancePerWatt, SourceGeometry, radiance_per_watt_of},
};
use std::error::Error;

pub(crate) const DISTANCE_M: [f64; 6] = [1_000.0, 4_000.0, 15_000.0, 50_000.0, 100_000.0, 200_000.0];
const ROWS: [usize; 5] = [0, 3, 9, 25, 63];
const COLUMNS: [usize; 5] = [0, 5, 28, 70, 120];

/// A source and an observer at some altitudes, metres.
#[derive(Clone, Copy)]
pub(crate) struct Pair {
    pub(crate) source_altitude_m: f64,
    pub(crate) observer_altitude_m: f64,
}

impl Pair {
    /// First order, m⁻² sr⁻¹ per watt, `[distance][look × band × lobe]`.
    pub(crate) fn first(self, atmosphere: &Atmosphere) -> Result<Vec<Vec<f64>>, Box<dyn Error>> {
        self.looks(|geometry, azimuth_rad, elevation_rad| {
            Ok(radiance_per_watt_of(atmosphere, geometry, azimuth_rad, elevation_rad, 1e-5))
        })
    }

    /// The later orders of a field, as [`Self::first`].
    pub(crate) fn later(self, field: &SourceField) -> Result<Vec<Vec<f64>>, Box<dyn Error>> {
        self.looks(|geometry, azimuth_rad, elevation_rad| {
            Ok(field.radiance_per_watt(geometry, azimuth_rad, elevation_rad)?)
        })
    }

    fn looks(
        self,
        value: impl Fn(&SourceGeometry, f64, f64) -> Result<RadiancePerWatt, Box<dyn Error>>,
    ) -> Result<Vec<Vec<f64>>, Box<dyn Error>> {
        let Self { source_altitude_m, observer_altitude_m } = self;
        let at = |distance_m| {
            let geometry = SourceGeometry { distance_m, source_altitude_m, observer_altitude_m };
            let mut values = Vec::new();
            for (row, column) in ROWS.into_iter().flat_map(|row| COLUMNS.map(|column| (row, column))) {
                values.extend(value(&geometry, azimuth_rad(column), elevation_rad(row))?.as_flattened());
            }
            Ok(values)
        };
        DISTANCE_M.into_iter().map(at).collect()
    }
}
