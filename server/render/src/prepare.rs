//! A request prepared for any executor: what must be computed, and nothing more.

use crate::{
    error::RenderError,
    light_share::LightShare,
    near_field::NearFieldCorrection,
    pack_kind::{PackKind, ResidentKind},
    request::{RenderRequest, WorkCount},
    ring_axis::{self, OFFSETS_AT_ONCE, Offsets, RingAxis},
    table_set::TableSet,
};
use rayon::prelude::*;
use skyglow_physics::{
    AZIMUTH_COUNT, BAND_COUNT, LOBE_COUNT, blocking::BLOCKING_COUNT, interpolation::Stencil,
};
use skyglow_scene::{PolarCell, PolarGrid};
use skyglow_tables::clouds::ceiling_m;

/// Two turbidities nearer than this are the same.
pub const SAME_TURBIDITY: f64 = 1e-9;
/// Largest s_b: far above any lamp's, and far below where f32 ends.
const MAX_FLUX_PER_DNB_FLUX: f64 = 1e6;
/// Largest flux of a cell, DNB watts: far above any light on Earth, and far below where f32 ends, so that no sum on the
/// way to a sky overflows (what is no number there would come out black).
const MAX_FLUX_DNB_W: f32 = 1e24;
/// Two altitudes nearer than this are the same, metres.
const SAME_ALTITUDE_M: f64 = 1e-9;

/// A (blocking angle, ring, offset) that some cell needs; the offset is source altitude − observer altitude.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct MixNode {
    /// Index in [`skyglow_physics::blocking::BLOCKING_ANGLES_DEG`]; 0 is the open sky.
    pub blocking: u32,
    /// Ring.
    pub ring: u32,
    /// Index on the offset axis of that angle and ring.
    pub offset: u32,
}

/// A lit cell with its place between two nodes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PreparedCell {
    /// Upward flux that counts, DNB watts ([`LightShare`]).
    pub flux_dnb_w: f32,
    /// Node below the cell's offset.
    pub lower_node: u32,
    /// Weight of the node above it, 0..1.
    pub upper_weight: f32,
}

impl PreparedCell {
    /// The node above the cell's offset, the next in the list of nodes, for they are numbered along each ring's axis and
    /// every one in use is listed; the same as [`Self::lower_node`] where that has all the weight.
    #[inline(always)]
    pub fn upper_node(&self) -> u32 {
        self.lower_node + u32::from(self.upper_weight > 0.0)
    }
}

/// An azimuth column with light.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct LitColumn {
    /// Azimuth column, 0..256.
    pub azimuth: u32,
    /// First of its cells.
    pub first_cell: u32,
    /// One past its last cell.
    pub end_cell: u32,
}

/// A request in the form the passes take.
#[derive(Clone, Debug)]
pub struct Prepared {
    /// Nodes to mix, by blocking angle, then ring, then offset.
    pub nodes: Vec<MixNode>,
    /// Lit cells, by column, then ring.
    pub cells: Vec<PreparedCell>,
    /// Columns with light, by azimuth.
    pub columns: Vec<LitColumn>,
    /// Observer's altitude, metres above sea level, within the tables.
    pub observer_altitude_m: f64,
    /// Interpolation over observer altitude.
    pub altitude_stencil: Stencil,
    /// The same on the altitudes of the tables of sources behind skylines; a single node without such.
    pub blocked_altitude_stencil: Stencil,
    /// Interpolation over the set's packs, all of the request's kind.
    pub turbidity_stencil: Stencil,
    /// Lobe weights, summing to 1.
    pub emission: [f32; LOBE_COUNT],
    /// s_b per band.
    pub flux_per_dnb_flux: [f32; BAND_COUNT],
    /// Basis functions wanted; a pack with fewer uses what it has.
    pub basis_count: usize,
    /// The near-field correction, which is applied when the passes are done; None without near lights.
    pub near: Option<NearFieldCorrection>,
}

impl Prepared {
    /// Checks a request against the resident tables and lists its work.
    ///
    /// # Errors
    /// Scattering or clouds that are not resident, altitude, turbidity, basis or lamp out of range, or a malformed polar
    /// grid.
    pub fn new(request: &RenderRequest, set: &TableSet) -> Result<Self, RenderError> {
        let packs = set.kind(request.kind())?;
        check_below_clouds(request.observer_altitude_m, packs.kind)?;
        let altitudes_m = set.observer_altitude_m(packs);
        let observer_altitude_m = checked_altitude_m(request.observer_altitude_m, altitudes_m)?;
        let altitude_stencil = Stencil::lagrange_or_node(altitudes_m, observer_altitude_m, SAME_ALTITUDE_M);
        let blocked_altitude_stencil =
            set.blocked_observer_altitude_m(packs).map_or(Stencil::single(0), |blocked_m| {
                Stencil::lagrange_or_node(blocked_m, observer_altitude_m, SAME_ALTITUDE_M)
            });
        let turbidity_stencil = turbidity_stencil(request.turbidity.value(), packs)?;
        let basis_count = basis_count_with(request, packs, &turbidity_stencil, set)?;
        check_grid(&request.polar, set.ring_count())?;
        check_lamp(request.flux_per_dnb_flux)?;
        let flux_per_dnb_flux = request.flux_per_dnb_flux.map(|flux| flux as f32);
        let mut prepared = Self {
            nodes: Vec::new(),
            cells: Vec::new(),
            columns: Vec::new(),
            observer_altitude_m,
            altitude_stencil,
            blocked_altitude_stencil,
            turbidity_stencil,
            emission: request.emission.weights().map(|weight| weight as f32),
            flux_per_dnb_flux,
            basis_count,
            near: NearFieldCorrection::of(request).filter(|_| !set.is_synthetic()),
        };
        if flux_per_dnb_flux.iter().any(|flux| *flux > 0.0) {
            let axes = NodeAxes { set, hides_lights: packs.hides_lights };
            let cloud_altitude_m = packs.kind.cloud_altitude_m();
            prepared.list_work(&request.polar, observer_altitude_m, cloud_altitude_m, &axes);
        }
        Ok(prepared)
    }

    /// True where there is no light at all: the sky is black and nothing is rendered.
    pub fn is_dark(&self) -> bool {
        self.cells.is_empty()
    }

    /// Whether the lamps have light in each of the bands.
    pub fn lit_bands(&self) -> impl Iterator<Item = bool> {
        self.flux_per_dnb_flux.iter().map(|flux| *flux > 0.0)
    }

    /// True where one submission can serve both requests.
    pub fn is_compatible(&self, other: &Self) -> bool {
        self.basis_count == other.basis_count
            && self.turbidity_stencil.nodes() == other.turbidity_stencil.nodes()
    }

    /// How much work this is.
    pub fn work(&self) -> WorkCount {
        WorkCount {
            mixed_nodes: self.nodes.len(),
            lit_cells: self.cells.len(),
            lit_columns: self.columns.len(),
            lit_bands: if self.is_dark() { 0 } else { self.lit_bands().filter(|lit| *lit).count() },
            packs: if self.is_dark() { 0 } else { self.turbidity_stencil.nodes().len() },
        }
    }

    /// Lists the lit cells and the nodes that they touch; light at `cloud_altitude_m` and above shines on clouds from
    /// above, and none of it comes through ([`LightShare`]).
    fn list_work(
        &mut self,
        polar: &PolarGrid,
        observer_altitude_m: f64,
        cloud_altitude_m: f64,
        axes: &NodeAxes<'_>,
    ) {
        let slots = axes.slot_count(polar);
        let columns: Vec<usize> = (0..polar.azimuth_start.len() - 1).collect();
        let columns_per_task =
            if polar.cells.len() < CELLS_WORTH_TASKS { columns.len() } else { COLUMNS_PER_TASK };
        let mut listed: Vec<Listed> = columns
            .par_chunks(columns_per_task)
            .map(|columns| Listed::of(polar, columns, [observer_altitude_m, cloud_altitude_m], slots, axes))
            .collect();
        let mut node_of = vec![u32::MAX; slots];
        for (slot, node) in node_of.iter_mut().enumerate() {
            if listed.iter().any(|listed| listed.is_used[slot]) {
                *node = self.nodes.len() as u32;
                self.nodes.push(axes.node(slot));
            }
        }
        listed.par_iter_mut().for_each(|listed| {
            for cell in &mut listed.cells {
                cell.lower_node = node_of[cell.lower_node as usize];
            }
        });
        self.cells.reserve_exact(listed.iter().map(|listed| listed.cells.len()).sum());
        for listed in listed {
            let before = self.cells.len() as u32;
            self.columns.extend(listed.columns.iter().map(|column| LitColumn {
                first_cell: before + column.first_cell,
                end_cell: before + column.end_cell,
                ..*column
            }));
            self.cells.extend(listed.cells);
        }
    }
}

/// From so many cells on some tasks list them.
const CELLS_WORTH_TASKS: usize = 8_192;
/// Columns that such a task lists.
const COLUMNS_PER_TASK: usize = 64;

/// The lit cells of some columns, which carry the slots of their nodes until all nodes in use are known.
struct Listed {
    cells: Vec<PreparedCell>,
    /// Counted from the first of these cells.
    columns: Vec<LitColumn>,
    /// By slot.
    is_used: Vec<bool>,
}

impl Listed {
    fn of(
        polar: &PolarGrid,
        columns: &[usize],
        [observer_altitude_m, cloud_altitude_m]: [f64; 2],
        slots: usize,
        axes: &NodeAxes<'_>,
    ) -> Self {
        let mut listed = Self { cells: Vec::new(), columns: Vec::new(), is_used: vec![false; slots] };
        let (mut offsets, mut positions) = (Offsets::default(), [0.0; OFFSETS_AT_ONCE]);
        let start = |column: usize| polar.azimuth_start[column] as usize;
        if let (Some(first), Some(last)) = (columns.first(), columns.last()) {
            listed.cells.reserve_exact(start(last + 1) - start(*first));
        }
        for &column in columns {
            let first_cell = listed.cells.len() as u32;
            for cells in polar.cells[start(column)..start(column + 1)].chunks(OFFSETS_AT_ONCE) {
                for (lane, cell) in cells.iter().enumerate() {
                    let offset_m = (f64::from(cell.altitude_m) - observer_altitude_m) as f32;
                    offsets.set(lane, axes.axis(cell), offset_m);
                }
                ring_axis::positions(&offsets, &mut positions);
                for (cell, position) in cells.iter().zip(positions) {
                    let share = LightShare::of(cell, observer_altitude_m, cloud_altitude_m).share;
                    if share <= 0.0 {
                        continue;
                    }
                    let (node, upper_weight) = node_below(position);
                    let lower = axes.first_slot_on_ring(cell) + node;
                    let upper = lower + usize::from(upper_weight > 0.0);
                    (listed.is_used[lower], listed.is_used[upper]) = (true, true);
                    listed.cells.push(PreparedCell {
                        flux_dnb_w: share * cell.flux_dnb_w,
                        lower_node: lower as u32,
                        upper_weight,
                    });
                }
            }
            let end_cell = listed.cells.len() as u32;
            if end_cell > first_cell {
                listed.columns.push(LitColumn { azimuth: column as u32, first_cell, end_cell });
            }
        }
        listed
    }
}

/// Every node that there is, numbered: those of the open sky first, then angle by angle, each by ring, then offset.
struct NodeAxes<'a> {
    set: &'a TableSet,
    hides_lights: bool,
}

impl NodeAxes<'_> {
    /// Slots that a grid may need: those of angles above 0 only where it has light behind skylines.
    fn slot_count(&self, polar: &PolarGrid) -> usize {
        let highest = polar.cells.iter().map(|cell| self.blocking(cell)).max().unwrap_or(0);
        self.first_slot(highest + 1)
    }

    /// The blocking angle of a cell; packs that know no skylines take its light for light under an open sky.
    fn blocking(&self, cell: &PolarCell) -> usize {
        if self.hides_lights { cell.blocking as usize } else { 0 }
    }

    fn offset_count(&self, blocking: usize) -> usize {
        match (blocking, self.set.blocked()) {
            (0, _) | (_, None) => self.set.offset_count(),
            (_, Some(blocked)) => blocked.offset_count(),
        }
    }

    fn first_slot(&self, blocking: usize) -> usize {
        let open = self.set.ring_count() * self.offset_count(0);
        let blocked = self.set.ring_count() * self.offset_count(1);
        if blocking == 0 { 0 } else { open + (blocking - 1) * blocked }
    }

    /// The axis that a cell's offset is on.
    fn axis(&self, cell: &PolarCell) -> &RingAxis {
        match (self.blocking(cell), self.set.blocked()) {
            (0, _) | (_, None) => self.set.axis(cell.ring as usize),
            (blocking, Some(blocked)) => blocked.axis(blocking, cell.ring as usize),
        }
    }

    /// Slot of the first node of that axis.
    fn first_slot_on_ring(&self, cell: &PolarCell) -> usize {
        let blocking = self.blocking(cell);
        self.first_slot(blocking) + cell.ring as usize * self.offset_count(blocking)
    }

    /// The node of a slot.
    fn node(&self, slot: usize) -> MixNode {
        let rings = self.set.ring_count();
        let open = self.first_slot(1);
        let (blocking, within, offsets) = if slot < open {
            (0, slot, self.offset_count(0))
        } else {
            let per_angle = rings * self.offset_count(1);
            (1 + (slot - open) / per_angle, (slot - open) % per_angle, self.offset_count(1))
        };
        MixNode {
            blocking: blocking as u32,
            ring: (within / offsets) as u32,
            offset: (within % offsets) as u32,
        }
    }
}

/// Node at or below a fractional position, and the weight of the one above it; none within 2e-6 of a node,
/// which is what f32 resolves.
fn node_below(position: f32) -> (usize, f32) {
    // Positions are not negative: the conversion rounds down.
    let (node, nearest) = (position as usize, (position + 0.5) as usize);
    if (position - nearest as f32).abs() < 2e-6 { (nearest, 0.0) } else { (node, position - node as f32) }
}

fn checked_altitude_m(altitude_m: f64, altitudes_m: &[f64]) -> Result<f64, RenderError> {
    let maximum_m = altitudes_m.last().copied().unwrap_or(0.0);
    if !altitude_m.is_finite() || altitude_m > maximum_m {
        return Err(RenderError::AltitudeOutOfRange { altitude_m, minimum_m: 0.0, maximum_m });
    }
    Ok(altitude_m.max(0.0))
}

fn check_below_clouds(altitude_m: f64, kind: PackKind) -> Result<(), RenderError> {
    let Some(base_m) = kind.cloud_base_m else { return Ok(()) };
    let maximum_m = ceiling_m(f64::from(base_m));
    if altitude_m > maximum_m {
        return Err(RenderError::AboveClouds { altitude_m, base_m, maximum_m });
    }
    Ok(())
}

/// Basis functions that a request takes: as many as it asks for, but no more than the packs of its turbidity have.
///
/// # Errors
/// Scattering, clouds or a turbidity that are not resident, and more functions than any pack of the kind has.
pub fn basis_count_in_use(request: &RenderRequest, set: &TableSet) -> Result<usize, RenderError> {
    let packs = set.kind(request.kind())?;
    basis_count_with(request, packs, &turbidity_stencil(request.turbidity.value(), packs)?, set)
}

/// [`basis_count_in_use`] of a request whose packs are known.
fn basis_count_with(
    request: &RenderRequest,
    packs: &ResidentKind,
    turbidity_stencil: &Stencil,
    set: &TableSet,
) -> Result<usize, RenderError> {
    let (wanted, maximum) = (request.basis.unwrap_or(packs.basis_count), packs.basis_count);
    if wanted == 0 || wanted > maximum {
        return Err(RenderError::BasisOutOfRange { basis: wanted, maximum });
    }
    let in_use = turbidity_stencil.nodes().map(|pack| set.tables()[pack].basis_count).max();
    Ok(wanted.min(in_use.unwrap_or(maximum)))
}

fn turbidity_stencil(turbidity: f64, packs: &ResidentKind) -> Result<Stencil, RenderError> {
    let nodes = &packs.turbidities;
    let (minimum, maximum) = (nodes[0], nodes[nodes.len() - 1]);
    if !(minimum - SAME_TURBIDITY..=maximum + SAME_TURBIDITY).contains(&turbidity) {
        return Err(RenderError::TurbidityOutOfRange { turbidity, minimum, maximum });
    }
    // Radiance is closest to a cubic in the logarithm of turbidity: a fifth of the error of one in turbidity.
    let log_nodes: Vec<f64> = nodes.iter().map(|node| node.ln()).collect();
    Ok(Stencil::lagrange_or_node(&log_nodes, turbidity.ln(), SAME_TURBIDITY).shifted(packs.first))
}

fn check_lamp(flux_per_dnb_flux: [f64; BAND_COUNT]) -> Result<(), RenderError> {
    let maximum = MAX_FLUX_PER_DNB_FLUX;
    if flux_per_dnb_flux.iter().all(|flux| (0.0..=maximum).contains(flux)) {
        Ok(())
    } else {
        Err(RenderError::BadLamp { flux_per_dnb_flux, maximum })
    }
}

fn check_grid(polar: &PolarGrid, ring_count: usize) -> Result<(), RenderError> {
    let refuse = |reason: String| Err(RenderError::BadPolarGrid { reason });
    let starts = &polar.azimuth_start;
    if starts.len() != AZIMUTH_COUNT + 1
        || starts[0] != 0
        || starts[AZIMUTH_COUNT] as usize != polar.cells.len()
        || starts.windows(2).any(|pair| pair[0] > pair[1])
    {
        return refuse(format!("its {} column offsets do not divide its cells", starts.len()));
    }
    if polar.cells.len() > AZIMUTH_COUNT * ring_count * BLOCKING_COUNT {
        return refuse(format!("{} cells are more than the grid has", polar.cells.len()));
    }
    for cell in &polar.cells {
        if cell.ring as usize >= ring_count {
            return refuse(format!("ring {} is beyond the {ring_count} of the tables", cell.ring));
        }
        if cell.blocking as usize >= BLOCKING_COUNT {
            return refuse(format!(
                "blocking angle {} is beyond the {BLOCKING_COUNT} there are",
                cell.blocking
            ));
        }
        if !(0.0..=MAX_FLUX_DNB_W).contains(&cell.flux_dnb_w) || !cell.altitude_m.is_finite() {
            return refuse(format!("a cell has flux {} W at {} m", cell.flux_dnb_w, cell.altitude_m));
        }
    }
    Ok(())
}

#[cfg(test)]
#[path = "prepare_tests.rs"]
mod tests;
