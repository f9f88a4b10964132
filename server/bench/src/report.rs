//! What a bench found, row by row: what `bench.json` holds.

use serde::{Deserialize, Serialize};

/// A whole run.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Report {
    /// Version of the program.
    pub program_version: String,
    /// Whether it was the short run.
    pub quick: bool,
    /// The machine.
    pub machine: Machine,
    /// The packs that skies were rendered from.
    pub packs: Vec<PackRecord>,
    /// Executors that there are, in the order of their rows.
    pub executors: Vec<ExecutorRecord>,
    /// Scenes whose panoramas were timed, with the times of the baselines.
    pub scenes: Vec<SceneRow>,
    /// Run times.
    pub run_times: Vec<RunTimeRow>,
    /// Panoramas that come together.
    pub batches: Vec<BatchRow>,
    /// The least time that the device would need, pass by pass.
    #[serde(rename = "floors")]
    pub roofline: Vec<RooflineRow>,
    /// Errors.
    pub errors: Vec<ErrorRow>,
    /// Performance targets, and what came out.
    #[serde(rename = "aims")]
    pub targets: Vec<TargetRow>,
    /// What was left out, and how to read the rest.
    pub notes: Vec<String>,
}

/// The machine.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Machine {
    /// Name of the processor.
    pub processor: String,
    /// Logical cores that this program may use.
    pub logical_cores: usize,
    /// Threads of the CPU executor and of both baselines.
    pub threads: usize,
    /// Tasks that ran or waited in the minute before the run, where the kernel says; above 0 others' work slowed this.
    pub load_average: Option<f64>,
    /// Bytes that the streaming sum read.
    pub stream_bytes: usize,
    /// 10⁹ bytes a second of a streaming sum over f32 on all threads.
    pub bandwidth_gb_s: f64,
    /// 10⁹ multiply-adds of f32 a second on all threads, in registers.
    pub multiply_adds_g_s: f64,
}

/// A pack.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct PackRecord {
    /// Turbidity.
    pub turbidity: f64,
    /// Orders of scattering.
    pub scattering: String,
    /// Functions of its basis.
    pub basis_count: usize,
    /// Checksum, hexadecimal.
    pub checksum: String,
}

/// What renders.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ExecutorRecord {
    /// `cpu`, `lavapipe` or `gpu`.
    pub executor: String,
    /// Name of the adapter.
    pub adapter: String,
    /// Its driver.
    pub driver: String,
    /// Bytes of packs and workspace.
    pub resident_bytes: u64,
    /// 10⁹ bytes a second that its device streams: the machine's, or a GPU's own, whose copy counts what is read and what is
    /// written.
    pub bandwidth_gb_s: f64,
    /// 10⁹ multiply-adds of f32 a second, the machine's or a GPU's own.
    pub multiply_adds_g_s: f64,
    /// Milliseconds until the host has a panorama's bytes from a GPU that has nothing else to do; None where there is none.
    pub read_back_ms: Option<f64>,
}

/// A scene, and its panorama by the baselines.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SceneRow {
    /// `cells`: so many cells of the polar grid, each one source. `raster`: so many pixels of a raster.
    pub scene: String,
    /// Lit cells or pixels asked for.
    pub lit_sources: usize,
    /// Lit cells of the polar grid.
    pub polar_cells: usize,
    /// Point sources of the direct sum: pixels within 5 km count as several.
    pub point_sources: usize,
    /// Milliseconds that it took to sort the sources into the polar grid one by one (a scene in a store gathers
    /// far ones in blocks); None where the scene is made of cells.
    pub binning_ms: Option<f64>,
    /// The direct sum.
    pub direct_sum: BaselineTime,
    /// The accumulation of images that are there for this very observer and these lobes.
    pub accumulation: BaselineTime,
    /// Bytes of these images, for the cells that were accumulated.
    pub image_bytes: u64,
    /// Mixing them from images on the pack's own axes, as a table that serves every observer has them; sources here are
    /// nodes.
    pub image_mixing: BaselineTime,
}

/// The time of a baseline for a whole panorama.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct BaselineTime {
    /// Seconds for all sources and directions, of the fastest try; scaled where a share was timed.
    pub seconds: f64,
    /// Share of the work that was timed, 0..=1; 1 is all of it.
    pub share_timed: f64,
    /// Sources or cells that were timed.
    pub sources_timed: usize,
    /// Directions that were timed, of 16 384.
    pub directions_timed: usize,
}

/// One run time.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct RunTimeRow {
    /// `cpu`, `lavapipe` or `gpu`.
    pub executor: String,
    /// As [`SceneRow::scene`].
    pub scene: String,
    /// As [`SceneRow::lit_sources`].
    pub lit_sources: usize,
    /// Whether dark cells, columns and nodes were left out, as the program does. Where not, the dark ones were given
    /// 1e-6 W, so that all were worked on.
    pub skipping: bool,
    /// Turbidity.
    pub turbidity: f64,
    /// Packs that it was rendered from and blended.
    pub packs: usize,
    /// Functions of the basis.
    pub basis_count: usize,
    /// Cells worked on.
    pub cells: usize,
    /// Nodes mixed, a pack.
    pub nodes: usize,
    /// Columns worked on.
    pub columns: usize,
    /// Rounds.
    pub rounds: usize,
    /// Median over the rounds, from the polar grid to the panorama, milliseconds.
    pub median_ms: f64,
    /// Fastest round, milliseconds.
    pub fastest_ms: f64,
    /// Each pass in the round of the median, milliseconds.
    pub passes: Vec<PassRow>,
    /// The direct sum's time over the fastest round.
    pub times_direct_sum: f64,
    /// The time of mixing and accumulating images over the fastest round.
    pub times_accumulation: f64,
    /// The time of accumulating images that are there for this very observer over the fastest round.
    pub times_ready_accumulation: f64,
}

/// Time of a pass.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct PassRow {
    /// Its name.
    pub pass: String,
    /// Milliseconds.
    pub ms: f64,
}

/// How many panoramas a second, where several callers ask for the same at once.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct BatchRow {
    /// `cpu`, `lavapipe` or `gpu`.
    pub executor: String,
    /// As [`SceneRow::scene`].
    pub scene: String,
    /// As [`SceneRow::lit_sources`].
    pub lit_sources: usize,
    /// Functions of the basis.
    pub basis_count: usize,
    /// Callers, each of whom asks for the next panorama once it has the last.
    pub callers: usize,
    /// Panoramas of a batch, in the mean over the batches of the fastest round.
    pub batch_size: f64,
    /// Panoramas a second in the fastest round.
    pub panoramas_per_s: f64,
    /// The same in the median round.
    pub median_panoramas_per_s: f64,
    /// Least time of a panorama's passes alone by their bytes and operations, pass by pass, milliseconds; the near-field correction
    /// is none of them, and tables that a batch shares count for each.
    #[serde(rename = "passes_floor_ms")]
    pub passes_roofline_ms: f64,
}

/// What a pass needs at least.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct RooflineRow {
    /// As in the row of run times that it belongs to.
    pub executor: String,
    /// The same.
    pub scene: String,
    /// The same.
    pub lit_sources: usize,
    /// The same.
    pub basis_count: usize,
    /// The pass; the last of a request is the whole panorama.
    pub pass: String,
    /// Bytes of its input and output, each counted once.
    pub bytes: f64,
    /// Floating-point operations.
    pub operations: f64,
    /// The bytes at the bandwidth of the executor's device, milliseconds.
    pub bytes_ms: f64,
    /// The operations at its rate, two to a multiply-add, milliseconds.
    pub operations_ms: f64,
    /// What it took in the round of the median, milliseconds.
    pub measured_ms: f64,
}

/// One error.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ErrorRow {
    /// The scene, and the place in it.
    pub scene: String,
    /// Turbidity.
    pub turbidity: f64,
    /// Packs blended.
    pub packs: usize,
    /// Orders of scattering.
    pub scattering: String,
    /// Flux within 300 km, DNB watts.
    pub flux_dnb_w: f64,
    /// True luminance at the zenith, cd m⁻².
    pub zenith_cd_m2: f64,
    /// The same over that of the natural sky.
    pub zenith_over_natural: f64,
    /// `cpu`, `lavapipe` or `gpu`, in f32; `f64`: plain sums over the same tables.
    pub executor: String,
    /// Precision of the coefficients, as packs store them.
    pub coefficients: String,
    /// Functions of the basis.
    pub basis_count: usize,
    /// Directions compared.
    pub directions: usize,
    /// Mean relative error.
    pub mean: f64,
    /// 99th percentile.
    pub p99: f64,
    /// Largest.
    pub maximum: f64,
    /// Relative error of the luminance at the zenith, with its sign.
    pub zenith_error: f64,
    /// Relative error of the horizontal illuminance, with its sign.
    pub horizontal_error: f64,
    /// Median run time of that panorama, milliseconds; None for `f64`.
    pub median_ms: Option<f64>,
    /// Its fastest, milliseconds; None for `f64`.
    pub fastest_ms: Option<f64>,
}

/// A performance target.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct TargetRow {
    /// What is wanted.
    #[serde(rename = "aim")]
    pub target: String,
    /// On which executor.
    pub executor: String,
    /// What is wanted at least, or at most.
    pub wanted: f64,
    /// What was measured.
    pub measured: f64,
    /// Whether that is met.
    pub is_met: bool,
}
