//! What a bench runs, and how much of it.

use crate::error::BenchError;
use skyglow_physics::{
    BAND_COUNT, EmissionMix, LOBE_COUNT, Panorama, Turbidity, multiple_scattering::DEFAULT_GROUND_ALBEDO,
};
use skyglow_render::{PackKind, TableSet};
use skyglow_tables::{Manifest, ResidentTables, Scattering};
use std::{path::PathBuf, sync::Arc, time::Duration};

/// Flux of the bands per DNB flux that skies are compared at, and stored reference skies have: sodium and LED, half of each.
pub const REFERENCE_FLUX: [f64; BAND_COUNT] = [0.26, 0.50, 0.34, 0.13];

/// What to run.
#[derive(Clone, Debug)]
pub struct BenchOptions {
    /// The packs.
    pub tables: Vec<Arc<ResidentTables>>,
    /// Their manifests.
    pub manifests: Vec<Manifest>,
    /// How much.
    pub extent: Extent,
    /// Reference files of the demo, as `tests/reference` holds them.
    pub reference_files: Vec<PathBuf>,
    /// Folder of scenes; where it has no demo, one is made for the run.
    pub data: PathBuf,
}

/// How much of everything.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Extent {
    /// Whether it is the short run.
    pub quick: bool,
    /// Scenes of so many lit cells.
    pub cell_counts: Vec<usize>,
    /// Scenes of so many lit pixels.
    pub pixel_counts: Vec<usize>,
    /// Basis sizes; those beyond what the packs have are left out.
    pub bases: Vec<usize>,
    /// Rounds of every run time.
    pub rounds: usize,
    /// Most integrals (a source in a direction) of a direct sum that is timed.
    pub direct_sum_integrals: usize,
    /// Most cells of an accumulation that is timed.
    pub accumulated_cells: usize,
    /// Most nodes whose images are mixed.
    pub mixed_nodes: usize,
    /// How long baselines and measures of the machine are tried again; the fastest try counts.
    pub time_for_tries: Duration,
    /// Bytes of the streaming sum.
    pub stream_bytes: usize,
    /// Multiply-adds a thread.
    pub multiply_adds: usize,
    /// Directions of a reference that is computed; 0 leaves errors out.
    pub reference_directions: usize,
}

impl Extent {
    /// The paper's scenes of 1 to 2 048 lit cells and rasters of 10⁴, 10⁵ and 10⁶ pixels: minutes.
    pub fn full() -> Self {
        Self {
            quick: false,
            cell_counts: (0..12).map(|exponent| 1 << exponent).collect(),
            pixel_counts: vec![10_000, 100_000, 1_000_000],
            bases: vec![8, 16, 32, 64],
            rounds: 15,
            direct_sum_integrals: 1 << 14,
            accumulated_cells: 2_048,
            mixed_nodes: 192,
            time_for_tries: Duration::from_secs(1),
            stream_bytes: 1 << 29,
            multiply_adds: 1 << 30,
            reference_directions: 200,
        }
    }

    /// Fewer scenes and no errors: within two minutes.
    pub fn quick() -> Self {
        Self {
            quick: true,
            cell_counts: vec![1, 64, 2_048],
            pixel_counts: vec![100_000],
            bases: vec![8, 16, 32, 64],
            rounds: 7,
            direct_sum_integrals: 1 << 14,
            accumulated_cells: 512,
            mixed_nodes: 64,
            time_for_tries: Duration::from_millis(500),
            stream_bytes: 1 << 29,
            multiply_adds: 1 << 30,
            reference_directions: 0,
        }
    }
}

/// What all skies of a run have in common.
#[derive(Clone, Debug)]
pub(crate) struct Setting {
    /// The packs as one set.
    pub(crate) set: TableSet,
    /// The kind of packs.
    pub(crate) kind: PackKind,
    /// Their turbidities, ascending.
    pub(crate) turbidities: Vec<f64>,
    /// Albedo of their ground.
    pub(crate) ground_albedo: f64,
    /// Turbidity of a pack in the middle.
    pub(crate) turbidity: Turbidity,
    /// A turbidity between it and the next one.
    pub(crate) between: Option<Turbidity>,
    /// Basis sizes, ascending.
    pub(crate) bases: Vec<usize>,
    /// Where the lamps send their light.
    pub(crate) emission: EmissionMix,
    /// s_b of the lamps.
    pub(crate) flux_per_dnb_flux: [f64; BAND_COUNT],
}

impl Setting {
    /// The best kind of packs of a clear sky, at a turbidity in the middle of theirs.
    ///
    /// # Errors
    /// [`BenchError::NoClearPacks`], or packs that do not fit together.
    pub(crate) fn of(options: &BenchOptions) -> Result<Self, BenchError> {
        let set = TableSet::new(options.tables.clone())?;
        let clear = set.kinds().iter().rfind(|packs| packs.kind.cloud_base_m.is_none());
        let packs = clear.ok_or(BenchError::NoClearPacks)?.clone();
        let middle = (packs.turbidities.len() - 1) / 2;
        let next = packs.turbidities.get(middle + 1);
        let turbidity = packs.turbidities[middle];
        let mut bases: Vec<usize> =
            options.extent.bases.iter().copied().filter(|&basis| basis <= packs.basis_count).collect();
        // All functions: a turbidity's packs may have fewer than others.
        if bases.last() != Some(&packs.basis_count) {
            bases.push(packs.basis_count);
        }
        let mut manifests = options.manifests.iter();
        let albedo = manifests.find(|manifest| PackKind::of_manifest(manifest) == packs.kind);
        Ok(Self {
            set,
            kind: packs.kind,
            ground_albedo: albedo
                .and_then(|manifest| manifest.ground_albedo)
                .unwrap_or(DEFAULT_GROUND_ALBEDO),
            turbidity: Turbidity::new(turbidity)?,
            between: next.map(|next| Turbidity::new(0.5 * (turbidity + next))).transpose()?,
            turbidities: packs.turbidities,
            bases,
            emission: EmissionMix::garstang(),
            flux_per_dnb_flux: REFERENCE_FLUX,
        })
    }

    /// The largest basis.
    pub(crate) fn basis_count(&self) -> usize {
        self.bases.last().copied().unwrap_or(1)
    }

    /// Bytes of a table of f32 images at every node of a pack: observer altitude, lobe, ring and source altitude.
    pub(crate) fn stored_image_bytes(&self) -> f64 {
        let altitudes = self.set.kind(self.kind).map_or(0, |packs| self.set.observer_altitude_m(packs).len());
        let nodes = altitudes * LOBE_COUNT * self.set.ring_count() * self.set.offset_count();
        (nodes * Panorama::LEN * size_of::<f32>()) as f64
    }

    /// Whether the packs hold the first order alone.
    pub(crate) fn is_first_order(&self) -> bool {
        self.kind.scattering == Scattering::Single
    }
}
