//! The readable description of a celestial table, and its sample points.

use serde::{Deserialize, Serialize};
use skyglow_physics::{Band, multiple_scattering::DEFAULT_GROUND_ALBEDO};

/// Version of the file format; a table of another version is refused.
pub const CELESTIAL_FORMAT_VERSION: u32 = 1;
/// Version of the physical model of beams; raised when skies change. A table of another version is refused.
pub const CELESTIAL_MODEL_VERSION: u32 = 1;

/// Sample points of a celestial table, each ascending.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct CelestialAxes {
    /// True zenith angles of the source, degrees.
    pub zenith_angle_deg: Vec<f64>,
    /// Altitudes of the observer, metres.
    pub observer_altitude_m: Vec<f64>,
    /// Elevations of the view, degrees, 0 to 90.
    pub elevation_deg: Vec<f64>,
    /// Azimuths of the view from the source's, even from 0 to 180°: how many.
    pub azimuth_count: usize,
    /// Points of the direct beam, even in the square root of the zenith angle's distance from the edge of the shadow: how many.
    pub direct_count: usize,
}

impl CelestialAxes {
    /// Those of the tables that come with the program.
    pub fn full() -> Self {
        let steps: [(f64, f64); 7] =
            [(0.0, 12.0), (48.0, 8.0), (64.0, 4.0), (76.0, 2.0), (84.0, 1.0), (88.0, 0.5), (94.0, 1.0)];
        let mut zenith_angle_deg = Vec::new();
        for (index, &(from, step)) in steps.iter().enumerate() {
            let to = steps.get(index + 1).map_or(112.0 + step, |next| next.0);
            let count = ((to - from) / step).round() as usize;
            zenith_angle_deg.extend((0..count).map(|k| from + step * k as f64));
        }
        Self {
            zenith_angle_deg,
            observer_altitude_m: vec![0.0, 400.0, 900.0, 1_500.0, 2_300.0, 3_300.0, 4_500.0],
            elevation_deg: vec![
                0.0, 0.7, 1.5, 2.5, 4.0, 6.0, 8.5, 11.5, 15.0, 19.0, 24.0, 30.0, 36.0, 43.0, 50.0, 57.0,
                64.0, 71.0, 78.0, 84.0, 90.0,
            ],
            azimuth_count: 25,
            direct_count: 96,
        }
    }

    /// Values of the scattered light: sample points times bands.
    pub(super) fn sample_counts(&self) -> [usize; 4] {
        [
            self.observer_altitude_m.len(),
            self.zenith_angle_deg.len(),
            skyglow_physics::BAND_COUNT,
            self.direction_count(),
        ]
    }

    /// Directions of the view.
    pub(super) fn direction_count(&self) -> usize {
        self.elevation_deg.len() * self.azimuth_count
    }
}

/// Error of a table against the solver itself, at zenith angles, altitudes and directions between its sample points.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct BeamSkyError {
    /// Directions times bands tried.
    pub samples: usize,
    /// What the error is relative to.
    pub relative_to: String,
    /// Mean.
    pub mean: f64,
    /// Median.
    pub median: f64,
    /// 90th percentile.
    pub p90: f64,
    /// 99th percentile.
    pub p99: f64,
    /// Largest.
    pub largest: f64,
    /// Largest at the highest row.
    pub zenith_largest: f64,
}

/// Description of a celestial table, sufficient to read its data and to compute it again.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct CelestialManifest {
    /// File format.
    pub format_version: u32,
    /// Physical model.
    pub model_version: u32,
    /// Turbidity at sea level.
    pub turbidity: f64,
    /// Lambertian albedo of the ground at sea level.
    pub ground_albedo: f64,
    /// Wavelengths of the bands in array order, nanometres.
    pub bands_nm: Vec<f64>,
    /// Sample points.
    pub axes: CelestialAxes,
    /// ln of one step of the stored numbers.
    pub log_step: f64,
    /// What the data mean.
    pub equation: String,
    /// Layout and unit of each section.
    pub sections: Vec<String>,
    /// Error against the solver.
    pub measured_error: BeamSkyError,
    /// BLAKE3 of the sections, hexadecimal.
    pub checksum: String,
    /// The command that makes this table.
    pub command: String,
}

impl CelestialManifest {
    /// The manifest of a table of a turbidity, without error and checksum.
    pub(super) fn new(turbidity: f64, ground_albedo: f64, axes: CelestialAxes, log_step: f64) -> Self {
        let albedo = if ground_albedo == DEFAULT_GROUND_ALBEDO {
            String::new()
        } else {
            format!(" --ground-albedo {ground_albedo}")
        };
        Self {
            format_version: CELESTIAL_FORMAT_VERSION,
            model_version: CELESTIAL_MODEL_VERSION,
            turbidity,
            ground_albedo,
            bands_nm: Band::ALL.map(Band::wavelength_nm).to_vec(),
            axes,
            log_step,
            equation: "b = p(gamma) * exp(log_step * scattered) [sr-1], radiance per irradiance of the beam outside \
                       the air; p is the phase function of the air over the observer, gamma the angle from the source"
                .to_owned(),
            sections: [
                "scattered i16 [observer_altitude][zenith_angle][band][elevation][azimuth], steps; stored as \
                 differences along azimuth, elevation and zenith angle",
                "direct f32 [observer_altitude][point][band], ln of the optical depth: of -ln of the share of the beam that comes \
                 through",
                "shadow f32 [observer_altitude], rad, true zenith angle at which the beam is cut off",
            ]
            .map(str::to_owned)
            .to_vec(),
            measured_error: BeamSkyError::default(),
            checksum: String::new(),
            command: format!("skyglow precompute --turbidity {turbidity} --part celestial{albedo}"),
        }
    }
}
