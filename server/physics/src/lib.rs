//! The physical model of skyglow: pure functions in f64, no files, no GPU, no global state.
//!
//! Everything here follows Dobashi, Ishikawa, Iwasaki, *Efficient Visualization of Light Pollution for the
//! Night Sky*, ACM TOG 42(6) 219 (2023), "the paper", and extends it: spherical Earth, three
//! emission lobes, altitudes of source and observer.
//!
//! It holds the reference solution: every fast path is measured against [`direct_sum`] and
//! [`multiple_scattering::MultipleSum`].

pub mod aerial_perspective;
pub mod atmosphere;
pub mod bands;
pub mod beam;
pub mod blocked_source;
pub mod blocking;
pub mod broken_clouds;
pub mod chapman;
pub mod cloud;
mod cone;
pub mod direct_sum;
mod drop_reflectance;
pub mod emission;
pub mod emission_law;
pub mod error;
pub mod error_metric;
pub mod fixture;
pub mod fresnel;
pub mod geometry;
pub mod hidden_sum;
pub mod horizon;
pub mod interpolation;
pub mod lamp;
pub mod lit_ground;
pub mod lit_slopes;
pub mod mesopic;
pub mod multiple_scattering;
pub mod natural_sky;
pub mod near_light;
pub mod panorama;
pub mod phase;
pub mod photometry;
pub mod quadrature;
pub mod response_quantities;
pub mod sampler;
pub mod seen_sky;
pub mod simd;
pub mod single_source;
pub mod sky_curve;
pub mod sky_measure;
pub mod sky_quantities;
mod sky_sums;
pub mod source_pixel;
pub mod spectrum;
pub mod surfaces;
pub mod value_noise;

pub use atmosphere::{Atmosphere, Turbidity};
pub use bands::{BAND_COUNT, Band};
pub use blocked_source::BlockedSource;
pub use broken_clouds::{BrokenClouds, CoverSlopes, Gaps};
pub use cloud::CloudBase;
pub use drop_reflectance::DROP_ASYMMETRY;
pub use emission::{EmissionMix, LOBE_COUNT, Lobe};
pub use emission_law::{Emission, EmissionKeep, GarstangLaw};
pub use error::PhysicsError;
pub use fixture::{Fixture, LampChange, PreservedFlux};
pub use geometry::{EARTH_RADIUS_M, GeoPoint};
pub use horizon::Horizon;
pub use lamp::{Lamp, LampKind};
pub use lit_ground::{LitGround, LitLine, SeenLight};
pub use natural_sky::{EvenSky, NaturalLight, NaturalSky, NodeLight};
pub use panorama::{AZIMUTH_COUNT, Direction, ELEVATION_COUNT, Panorama};
pub use seen_sky::{SeenSky, SkyPart};
pub use sky_curve::SkyCurve;
pub use sky_measure::LinearMeasure;
pub use sky_quantities::{SKY_RESPONSES, SkyNumbers, SkyQuantities};
pub use source_pixel::{PointSource, SourcePixel};
pub use spectrum::{LampPreset, Response};
pub use surfaces::{BeamSums, Slope, Surfaces};
