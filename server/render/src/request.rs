//! Render requests and their answers.

use crate::pack_kind::PackKind;
use serde::Serialize;
use skyglow_physics::{BAND_COUNT, EmissionMix, Panorama, Turbidity};
use skyglow_scene::PolarGrid;
use skyglow_tables::Scattering;
use std::sync::Arc;

/// One sky to render.
#[derive(Clone, Debug)]
pub struct RenderRequest {
    /// Light around the observer.
    pub polar: Arc<PolarGrid>,
    /// Observer's altitude, metres above sea level; below 0 counts as 0.
    pub observer_altitude_m: f64,
    /// Turbidity, within the resident range.
    pub turbidity: Turbidity,
    /// Orders of scattering, of which packs are resident.
    pub scattering: Scattering,
    /// Base of the layer of cloud above sea level, metres, of which packs are resident; None under a clear sky.
    pub cloud_base_m: Option<u32>,
    /// Where the lamps send their light.
    pub emission: EmissionMix,
    /// s_b: the lamps' flux in each band per DNB flux.
    pub flux_per_dnb_flux: [f64; BAND_COUNT],
    /// Number of basis functions; None for all resident with that scattering.
    pub basis: Option<usize>,
}

impl RenderRequest {
    /// The kind of packs that it is rendered from.
    pub fn kind(&self) -> PackKind {
        PackKind { cloud_base_m: self.cloud_base_m, scattering: self.scattering }
    }
}

/// A rendered sky.
#[derive(Clone, Debug)]
pub struct Rendered {
    /// Radiance over the sky.
    pub panorama: Panorama,
    /// Time of each pass, for the whole batch.
    pub passes: Vec<PassTime>,
    /// Requests that were rendered together with this one, itself included; 0 if nothing had to be rendered.
    pub batch_size: usize,
    /// What rendered it.
    pub executor: ExecutorKind,
    /// How much work this request was.
    pub work: WorkCount,
    /// Basis functions used, the most over the packs.
    pub basis_count: usize,
}

impl Rendered {
    /// The answer to a request without light.
    pub(crate) fn dark(executor: ExecutorKind) -> Self {
        Self {
            panorama: Panorama::dark(),
            passes: Vec::new(),
            batch_size: 0,
            executor,
            work: WorkCount::default(),
            basis_count: 0,
        }
    }
}

/// Time of one pass over a whole batch, all packs together; near lights are of each request. Where requests come together it holds
/// what its threads did for others meanwhile.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct PassTime {
    /// Name of the pass, as in `shaders/passes`.
    pub name: &'static str,
    /// Microseconds.
    pub microseconds: f64,
}

/// What one request costs: dark parts cost nothing.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct WorkCount {
    /// Nodes (ring × source altitude) mixed in each pack.
    pub mixed_nodes: usize,
    /// Lit cells.
    pub lit_cells: usize,
    /// Columns with light.
    pub lit_columns: usize,
    /// Bands with light: the others are black, and the executor in plain Rust leaves them out.
    pub lit_bands: usize,
    /// Packs rendered.
    pub packs: usize,
}

/// What renders.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum ExecutorKind {
    /// A hardware GPU.
    Gpu,
    /// Mesa's software Vulkan.
    Lavapipe,
    /// Plain Rust.
    Cpu,
}

impl ExecutorKind {
    /// The name used in answers and metrics.
    pub const fn name(self) -> &'static str {
        match self {
            ExecutorKind::Gpu => "gpu",
            ExecutorKind::Lavapipe => "lavapipe",
            ExecutorKind::Cpu => "cpu",
        }
    }

    /// The choice that opens this kind and no other.
    pub const fn choice(self) -> DeviceChoice {
        match self {
            ExecutorKind::Gpu => DeviceChoice::Gpu,
            ExecutorKind::Lavapipe => DeviceChoice::Lavapipe,
            ExecutorKind::Cpu => DeviceChoice::Cpu,
        }
    }
}

/// Which device to use.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum DeviceChoice {
    /// A hardware GPU if there is one, else the CPU: it is faster than lavapipe, which runs on the same cores.
    #[default]
    Auto,
    /// A hardware GPU or an error.
    Gpu,
    /// Lavapipe or an error.
    Lavapipe,
    /// Plain Rust on the CPU.
    Cpu,
}

impl DeviceChoice {
    /// The choice of that name: `auto`, `gpu`, `lavapipe` or `cpu`.
    pub fn from_name(name: &str) -> Option<Self> {
        match name {
            "auto" => Some(Self::Auto),
            "gpu" => Some(Self::Gpu),
            "lavapipe" => Some(Self::Lavapipe),
            "cpu" => Some(Self::Cpu),
            _ => None,
        }
    }
}
