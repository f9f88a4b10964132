//! What can go wrong between a request and its panorama.

use crate::pack_kind::PackKind;
use skyglow_physics::BAND_COUNT;
use skyglow_tables::TablesError;
use thiserror::Error;

/// Why no panorama came out.
#[derive(Debug, Error)]
pub enum RenderError {
    /// The queue is full: try again later.
    #[error("the render queue is full ({capacity} requests are waiting)")]
    Busy {
        /// Requests the queue holds.
        capacity: usize,
    },
    /// The engine is shutting down or its thread has ended.
    #[error("the engine has stopped")]
    Stopped,
    /// Nobody waits for the work any more.
    #[error("nobody waits for this work any more")]
    Ended,
    /// The observer is above the tables' range; below their range counts as the lowest altitude.
    #[error("altitude is {altitude_m} m; allowed is {minimum_m} to {maximum_m} m")]
    AltitudeOutOfRange {
        /// Altitude asked for, metres above sea level.
        altitude_m: f64,
        /// Lowest allowed, metres.
        minimum_m: f64,
        /// Highest allowed, metres.
        maximum_m: f64,
    },
    /// The observer is at the clouds or above them.
    #[error("altitude is {altitude_m} m; the clouds are at {base_m} m, and allowed is up to {maximum_m} m")]
    AboveClouds {
        /// Altitude asked for, metres above sea level.
        altitude_m: f64,
        /// Base of the clouds, metres above sea level.
        base_m: u32,
        /// Highest allowed, metres.
        maximum_m: f64,
    },
    /// Celestial tables that do not fit together.
    #[error(
        "the celestial tables do not fit together: {reason}; `skyglow precompute --part celestial` makes them"
    )]
    CelestialTables {
        /// Why.
        reason: String,
    },
    /// No resident packs of this kind.
    #[error("no packs with {kind} are resident; resident is {}", listed(resident))]
    KindNotResident {
        /// The kind asked for.
        kind: PackKind,
        /// The kinds that are resident.
        resident: Vec<PackKind>,
    },
    /// No resident packs of the kind asked for around this turbidity.
    #[error("turbidity is {turbidity}; resident is {minimum} to {maximum}")]
    TurbidityOutOfRange {
        /// Turbidity asked for.
        turbidity: f64,
        /// Lowest resident of that kind.
        minimum: f64,
        /// Highest resident of that kind.
        maximum: f64,
    },
    /// More basis functions than the tables hold, or none.
    #[error("basis is {basis}; allowed is 1 to {maximum}")]
    BasisOutOfRange {
        /// Number of functions asked for.
        basis: usize,
        /// Number resident.
        maximum: usize,
    },
    /// A polar grid that no scene makes.
    #[error("the polar grid is malformed: {reason}")]
    BadPolarGrid {
        /// What is wrong.
        reason: String,
    },
    /// A lamp that no spectrum gives: its samples would be NaN, and come out black.
    #[error(
        "the lamp sends {flux_per_dnb_flux:?} per flux seen in the bands; each must be a number from 0 to {maximum}"
    )]
    BadLamp {
        /// Flux in each band per flux weighted by the DNB response.
        flux_per_dnb_flux: [f64; BAND_COUNT],
        /// Largest allowed.
        maximum: f64,
    },
    /// No tables were given.
    #[error("no table packs are resident")]
    NoTables,
    /// Packs that cannot be interpolated between, or are not what they say.
    #[error("the pack for turbidity {turbidity} with {kind} does not fit: {reason}")]
    IncompatibleTables {
        /// The pack's turbidity.
        turbidity: f64,
        /// The pack's kind.
        kind: PackKind,
        /// What is wrong.
        reason: String,
    },
    /// No adapter of the wanted kind.
    #[error("no {wanted} adapter was found; found: {found}")]
    NoAdapter {
        /// `gpu` or `lavapipe`.
        wanted: &'static str,
        /// Names of the adapters that are there.
        found: String,
    },
    /// Packs and workspace do not fit into the byte budget.
    #[error("{needed_bytes} bytes are needed on the device; the budget is {budget_bytes}")]
    OverBudget {
        /// Bytes of packs and workspace.
        needed_bytes: u64,
        /// Bytes allowed.
        budget_bytes: u64,
    },
    /// More packs than there is memory for.
    #[error(
        "{count} packs take about {} MiB of memory, and {} are there for them: give it more, or fewer packs",
        needed_bytes.div_ceil(1 << 20),
        most_bytes.div_ceil(1 << 20)
    )]
    TooManyPacks {
        /// Number of packs.
        count: usize,
        /// Bytes that all take, about.
        needed_bytes: u64,
        /// Bytes that are there for them.
        most_bytes: u64,
    },
    /// A size beyond the adapter's limits.
    #[error("{what} needs {needed}; the adapter allows {allowed}")]
    BeyondLimit {
        /// Name of the size.
        what: &'static str,
        /// Wanted value.
        needed: u64,
        /// Adapter's limit.
        allowed: u64,
    },
    /// The device failed, and failed again after it was made anew.
    #[error(transparent)]
    Device(#[from] DeviceFault),
    /// A pack that is not there or was refused.
    #[error(transparent)]
    Tables(#[from] TablesError),
    /// The operating system refused the render thread.
    #[error("the render thread did not start: {reason}")]
    Thread {
        /// What the system said.
        reason: String,
    },
}

fn listed(kinds: &[PackKind]) -> String {
    kinds.iter().map(PackKind::to_string).collect::<Vec<_>>().join(", ")
}

/// A failure of the device while it worked.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum DeviceFault {
    /// The device is gone.
    #[error("the device was lost: {0}")]
    Lost(String),
    /// An allocation failed.
    #[error("the device is out of memory: {0}")]
    OutOfMemory(String),
    /// Validation or driver error.
    #[error("the device reported an error: {0}")]
    Other(String),
}
