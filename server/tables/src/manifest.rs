//! The readable description of a pack.

use crate::{
    axes::TableAxes,
    blocked::BlockedAxes,
    clouds::Clouds,
    fit_constants::{FitConstants, WEIGHT_EXPONENT},
    images::{DARK_LOG_SCALE, NODES_PER_PIECE},
    multiple::MultipleAxes,
    packing::ShapeLayout,
};
use serde::{Deserialize, Serialize};
use skyglow_physics::{
    AZIMUTH_COUNT, Band, ELEVATION_COUNT, Lobe, multiple_scattering::DEFAULT_GROUND_ALBEDO,
};

/// Version of the file format and of what its node numbers mean; a pack of another version is refused.
pub const FORMAT_VERSION: u32 = 5;
/// Version of the physical model; raised when the images change. A pack of another one is refused: between packs of two models
/// skies would be interpolated.
pub const MODEL_VERSION: u32 = 7;

/// The versions in a manifest, which decide whether the rest can be read.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
pub(crate) struct Versions {
    pub(crate) format_version: u32,
    pub(crate) model_version: u32,
}

impl Versions {
    /// Whether this program reads packs of them.
    pub(crate) fn are_read(self) -> bool {
        (self.format_version, self.model_version) == (FORMAT_VERSION, MODEL_VERSION)
    }
}

/// Which orders of scattering a pack holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Scattering {
    /// First order alone.
    Single,
    /// All orders, with light that a Lambertian ground reflects.
    Multiple,
}

impl Scattering {
    /// Both, the better one last.
    pub const ALL: [Self; 2] = [Self::Single, Self::Multiple];

    /// Name in files, commands and requests.
    pub fn name(self) -> &'static str {
        match self {
            Self::Single => "single",
            Self::Multiple => "multiple",
        }
    }
}

/// Error of a pack against the converged f64 integral, on single sources between its sample points: distance,
/// offset and observer altitude all interpolated, sources from sea level to a slope of one half above the
/// observer.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct MeasuredError {
    /// Sources tried.
    pub sources: usize,
    /// What the error is relative to.
    pub relative_to: String,
    /// For each lobe, all bands together.
    pub lobes: Vec<LobeError>,
}

/// Error of one lobe; see [`MeasuredError`].
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct LobeError {
    /// Name of the lobe.
    pub lobe: String,
    /// Directions times bands tried.
    pub samples: usize,
    /// Mean.
    pub mean: f64,
    /// Median.
    pub median: f64,
    /// 90th percentile.
    pub p90: f64,
    /// 99th percentile.
    pub p99: f64,
    /// Median at the highest row.
    pub zenith_median: f64,
}

/// Description of a pack, sufficient to read its data and to compute it again.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Manifest {
    /// File format.
    pub format_version: u32,
    /// Physical model.
    pub model_version: u32,
    /// Turbidity at sea level.
    pub turbidity: f64,
    /// Orders of scattering.
    pub scattering: Scattering,
    /// Lambertian albedo of the ground that multiply scattered light was computed over.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub ground_albedo: Option<f64>,
    /// The layer of cloud that closes the sky; not there under a clear one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub clouds: Option<Clouds>,
    /// Wavelengths of the bands in array order, nanometres.
    pub bands_nm: Vec<f64>,
    /// Lobes in array order.
    pub lobes: Vec<String>,
    /// Columns of the panorama.
    pub azimuth_count: usize,
    /// Rows of the panorama.
    pub elevation_count: usize,
    /// Sample points.
    pub axes: TableAxes,
    /// Sample points of sources behind skylines; null where the pack holds the open sky alone.
    #[serde(default)]
    pub blocked: Option<BlockedAxes>,
    /// M, number of basis functions.
    pub basis_count: usize,
    /// What the data mean.
    pub equation: String,
    /// Layout and unit of each section.
    pub sections: Vec<String>,
    /// Parameters of the computation.
    pub parameters: Parameters,
    /// Error against the f64 oracle.
    pub measured_error: MeasuredError,
    /// BLAKE3 of the sections, hexadecimal.
    pub checksum: String,
    /// The command that makes this pack.
    pub command: String,
}

/// Parameters of the computation that are not axes.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Parameters {
    /// Quadrature nodes a smooth piece of a ray.
    pub nodes_per_piece: usize,
    /// Exponent q of the weights of the fit.
    pub weight_exponent: f64,
    /// Geometries in the training set of the basis.
    pub training_geometries: usize,
    /// Alternating-least-squares iterations.
    pub fit_iterations: usize,
    /// Log scale that stands for no light.
    pub dark_log_scale: f64,
    /// Sample points of multiply scattered light.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub multiple: Option<MultipleAxes>,
    /// Constants of the fit.
    pub fit: FitConstants,
}

/// What decides a pack's content, before it is made.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct PackParameters {
    /// Turbidity at sea level.
    pub turbidity: f64,
    /// Orders of scattering.
    pub scattering: Scattering,
    /// Sample points of multiply scattered light, where scattering is multiple.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub multiple: Option<MultipleAxes>,
    /// The layer of cloud that closes the sky; None under a clear one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub clouds: Option<Clouds>,
    /// Sample points.
    pub axes: TableAxes,
    /// Sample points of sources behind skylines.
    pub blocked: Option<BlockedAxes>,
    /// M.
    pub basis_count: usize,
    /// Geometries in the training set.
    pub training_geometries: usize,
    /// Alternating-least-squares iterations.
    pub fit_iterations: usize,
    /// Constants of the fit.
    pub fit: FitConstants,
}

impl Manifest {
    /// Sample points of the shape coefficients.
    pub(crate) fn shape_layout(&self) -> ShapeLayout {
        ShapeLayout {
            distances: self.axes.distance_m.len(),
            offsets: self.axes.offset_count,
            basis: self.basis_count,
        }
    }
}

impl PackParameters {
    /// The command that makes the pack.
    fn command(&self) -> String {
        let albedo = match &self.multiple {
            Some(multiple) if multiple.ground_albedo != DEFAULT_GROUND_ALBEDO => {
                format!(" --ground-albedo {}", multiple.ground_albedo)
            }
            _ => String::new(),
        };
        let clouds = self.clouds.map_or_else(String::new, |clouds| clouds.flags());
        format!(
            "skyglow precompute --turbidity {} --scattering {}{albedo}{clouds} --basis {}",
            self.turbidity,
            self.scattering.name(),
            self.basis_count
        )
    }

    /// Layout and unit of each section.
    fn sections(&self) -> Vec<String> {
        let mut sections = vec![
            "log_scale f32 [observer_altitude][lobe][band][distance][offset], ln(m-2 sr-1)",
            "shape_step i8 [observer_altitude][lobe][band][distance][offset], power of 2 of the step of a node's \
             coefficients",
            "shape u16 the same with [basis], steps off the line through the two distances before, sign in the lowest \
             bit; coefficients of 1, f16",
            "basis_spectrum f32 [basis][elevation][frequency 0..=128], 1, to 15 bits of mantissa",
        ];
        if self.blocked.is_some() {
            sections.extend([
                "blocked_log_part f32 [observer_altitude][angle 0.5 to 32 degrees][lobe][band][distance][offset], ln of \
                 the scale over that of the open sky",
                "blocked_shape_less_open f16 the same with [basis], 1: coefficients less those of the open sky; packed \
                 as differences of the bits along distance",
            ]);
        }
        sections.into_iter().map(str::to_owned).collect()
    }

    /// The manifest of a finished pack.
    pub fn manifest(&self, measured_error: MeasuredError, checksum: String) -> Manifest {
        Manifest {
            format_version: FORMAT_VERSION,
            model_version: MODEL_VERSION,
            turbidity: self.turbidity,
            scattering: self.scattering,
            ground_albedo: self.multiple.as_ref().map(|multiple| multiple.ground_albedo),
            clouds: self.clouds,
            bands_nm: Band::ALL.map(Band::wavelength_nm).to_vec(),
            lobes: Lobe::ALL.map(|lobe| lobe.name().to_owned()).to_vec(),
            azimuth_count: AZIMUTH_COUNT,
            elevation_count: ELEVATION_COUNT,
            axes: self.axes.clone(),
            blocked: self.blocked.clone(),
            basis_count: self.basis_count,
            equation: "b = exp(log_scale) * sum_k shape_k * B_k  [m-2 sr-1], radiance per watt of upward \
                       flux; F[B_k](f) = sum_i B_k(theta_i) cos(2 pi f i / 256)"
                .to_owned(),
            sections: self.sections(),
            parameters: Parameters {
                nodes_per_piece: NODES_PER_PIECE,
                weight_exponent: WEIGHT_EXPONENT,
                training_geometries: self.training_geometries,
                fit_iterations: self.fit_iterations,
                dark_log_scale: DARK_LOG_SCALE,
                multiple: self.multiple.clone(),
                fit: self.fit,
            },
            measured_error,
            checksum,
            command: self.command(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Packs of this format and model are read and no others.
    #[test]
    fn only_this_format_and_model_are_read() {
        let read = |format_version, model_version| Versions { format_version, model_version }.are_read();
        assert!(read(FORMAT_VERSION, MODEL_VERSION));
        assert!(!read(FORMAT_VERSION, MODEL_VERSION + 1) && !read(FORMAT_VERSION, MODEL_VERSION - 1));
        assert!(!read(FORMAT_VERSION - 1, MODEL_VERSION) && !read(FORMAT_VERSION + 1, MODEL_VERSION));
    }
}
