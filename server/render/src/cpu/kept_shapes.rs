//! Mixed shapes that are kept from one request to the next. They are mixed at the observer altitudes of the tables and
//! halfway between them, and are a quadratic in between, so that they depend on the pack, the emission, the bands and the functions, and on nothing else of a request:
//! neighbours share them. What was kept before changes no bit of an answer.

use super::{
    lanes::Aligned,
    layout::{BLOCK, MixedNode},
    mix_scale::mix_scale,
    mix_shape::mix_shape,
    work::for_each_part,
};
use crate::{
    prepare::{MixNode, Prepared},
    table_set::TableSet,
};
use skyglow_physics::{BAND_COUNT, LOBE_COUNT, interpolation::Stencil, simd_dispatch};
use skyglow_tables::resident::ResidentTables;

/// Bytes kept at most from one batch to the next; while one is rendered there may be more, for each core what one request
/// needs in one pack, which with the packs that come with the program is 42 MB at most.
pub const MAX_KEPT_BYTES: usize = 128 << 20;
/// A node that is 0.
const DARK: MixedNode = Aligned([[0.0; BLOCK]; BAND_COUNT]);
/// Nodes that a task interpolates.
const NODES_PER_TASK: usize = 256;

/// What mixed shapes depend on beside the node.
#[derive(Clone, Copy, PartialEq)]
struct Key {
    pack: usize,
    /// Number of the step of altitude.
    step: usize,
    /// Equal bits are equal shapes.
    emission_bits: [u32; LOBE_COUNT],
    lit_bands: [bool; BAND_COUNT],
    basis_count: usize,
}

/// Steps of altitude that a quadratic goes through: a table's altitude, the middle, and the next one.
const STEPS: usize = 3;

/// Number of a node among all that there are, [`TableSet::node_count`].
fn slot(set: &TableSet, node: &MixNode) -> usize {
    let (ring, offset) = (node.ring as usize, node.offset as usize);
    match (node.blocking as usize, set.blocked()) {
        (0, _) | (_, None) => ring * set.offset_count() + offset,
        (blocking, Some(axes)) => {
            let rings = set.ring_count();
            rings * set.offset_count() + ((blocking - 1) * rings + ring) * axes.offset_count() + offset
        }
    }
}

/// The steps around an altitude, and their weights, summing to 1; at one of the tables' altitudes that step alone.
fn steps_around(altitudes_m: &[f64], altitude_m: f64) -> ([usize; STEPS], [f32; STEPS]) {
    let last = altitudes_m.len() - 1;
    let lower = altitudes_m.partition_point(|node| *node <= altitude_m).saturating_sub(1);
    let upper = (lower + 1).min(last);
    let width_m = altitudes_m[upper] - altitudes_m[lower];
    let t = if width_m > 0.0 { ((altitude_m - altitudes_m[lower]) / width_m).clamp(0.0, 1.0) } else { 0.0 };
    if t == 0.0 {
        return ([2 * lower; STEPS], [1.0, 0.0, 0.0]);
    }
    let weights = [(1.0 - t) * (1.0 - 2.0 * t), 4.0 * t * (1.0 - t), t * (2.0 * t - 1.0)];
    ([2 * lower, 2 * lower + 1, 2 * lower + 2], weights.map(|weight| weight as f32))
}

/// Altitude of a step, metres.
fn step_altitude_m(altitudes_m: &[f64], step: usize) -> f64 {
    let lower = step / 2;
    let upper = (lower + step % 2).min(altitudes_m.len() - 1);
    0.5 * (altitudes_m[lower] + altitudes_m[upper])
}

/// The nodes mixed so far for one key.
struct KeptTable {
    key: Key,
    /// By [`slot`], where a node is in the blocks that sources behind skylines have too, and in the others;
    /// 0 where it was not mixed, and in the others behind skylines.
    places: [Vec<u32>; 2],
    /// By block of functions; the first node of each is 0.
    blocks: Vec<Vec<MixedNode>>,
    /// Blocks that sources behind skylines have.
    blocked_block_count: usize,
    /// When it was last asked for, in requests.
    last_used: u64,
}

/// Where the nodes of a request are.
pub(super) struct FilledNodes {
    keys: [Key; STEPS],
    weights: [f32; STEPS],
    /// By node of the request.
    slots: Vec<usize>,
}

/// Mixed shapes of the requests that were rendered last.
pub(super) struct KeptShapes {
    tables: Vec<KeptTable>,
    max_bytes: usize,
    /// Requests so far.
    now: u64,
}

impl Default for KeptShapes {
    fn default() -> Self {
        Self::with_room(MAX_KEPT_BYTES)
    }
}

impl KeptShapes {
    /// None yet, and room for so many bytes.
    pub(super) fn with_room(max_bytes: usize) -> Self {
        Self { tables: Vec::new(), max_bytes, now: 0 }
    }

    /// Bytes held.
    pub(super) fn byte_count(&self) -> usize {
        self.tables.iter().map(KeptTable::byte_count).sum()
    }

    /// Requests so far.
    pub(super) fn now(&self) -> u64 {
        self.now
    }

    /// Mixes the nodes of a request that are not there yet, and keeps them until after [`Self::shrink`], as all since `since`.
    pub(super) fn fill(
        &mut self,
        set: &TableSet,
        request: &Prepared,
        pack: usize,
        since: u64,
    ) -> FilledNodes {
        self.now += 1;
        let tables = &set.tables()[pack];
        let (steps, weights) = steps_around(&tables.observer_altitude_m, request.observer_altitude_m);
        let slots: Vec<usize> = request.nodes.iter().map(|node| slot(set, node)).collect();
        let mut lit_bands = request.lit_bands();
        let key = Key {
            pack,
            step: 0,
            emission_bits: request.emission.map(f32::to_bits),
            lit_bands: std::array::from_fn(|_| lit_bands.next().unwrap_or_default()),
            basis_count: request.basis_count.min(tables.basis_count),
        };
        let mut keys = [key; STEPS];
        keys.iter_mut().zip(steps).for_each(|(key, step)| key.step = step);
        for key in keys {
            self.add(set, request, &slots, key, since);
        }
        FilledNodes { keys, weights, slots }
    }

    /// Shape coefficients of every node, `[block of functions][node]`, as [`mix_shape`] has them but for the way over
    /// altitude.
    pub(super) fn interpolate(
        &self,
        FilledNodes { keys, weights, slots }: &FilledNodes,
        side_by_side: bool,
        mixed: &mut Vec<MixedNode>,
    ) {
        let at = |key: Key| self.tables.iter().find(|table| table.key == key);
        let [Some(lower), Some(middle), Some(upper)] = keys.map(at) else { return };
        mixed.resize(lower.blocks.len() * slots.len(), DARK);
        for (block, mixed) in mixed.chunks_exact_mut(slots.len().max(1)).enumerate() {
            let nodes = [lower, middle, upper].map(|table| table.nodes(block));
            for_each_part(side_by_side, mixed, NODES_PER_TASK, |task, mixed| {
                let slots = &slots[task * NODES_PER_TASK..][..mixed.len()];
                interpolate(nodes, *weights, slots, mixed);
            });
        }
    }

    /// Forgets what was used longest ago until no more than the room is taken.
    pub(super) fn shrink(&mut self) {
        self.make_room(0, None, u64::MAX);
    }

    /// Mixes those nodes of a request that are not there yet at a step of altitude.
    fn add(&mut self, set: &TableSet, request: &Prepared, slots: &[usize], key: Key, since: u64) {
        let kept = self.tables.iter().find(|table| table.key == key);
        let is_kept = |slot: usize| kept.is_some_and(|table| table.places[0][slot] > 0);
        let missing: Vec<usize> = (0..slots.len()).filter(|node| !is_kept(slots[*node])).collect();
        let bytes = missing.len() * key.basis_count.div_ceil(BLOCK) * size_of::<MixedNode>()
            + if kept.is_some() { 0 } else { 2 * size_of::<u32>() * set.node_count() };
        self.make_room(bytes, Some(key), since);
        let tables = &set.tables()[key.pack];
        let table = match self.tables.iter().position(|table| table.key == key) {
            Some(table) => &mut self.tables[table],
            None => {
                let blocked = tables.blocked.as_ref().map_or(0, |blocked| blocked.basis_count);
                self.tables.push(KeptTable::new(key, set.node_count(), blocked.min(key.basis_count)));
                let last = self.tables.len() - 1;
                &mut self.tables[last]
            }
        };
        table.last_used = self.now;
        if !missing.is_empty() {
            table.mix(tables, request, slots, &missing);
        }
    }

    /// Forgets what was used longest ago until so many bytes more fit, but not `kept`, and nothing used after `since`.
    fn make_room(&mut self, bytes: usize, kept: Option<Key>, since: u64) {
        while self.byte_count() + bytes > self.max_bytes {
            let oldest = (0..self.tables.len())
                .filter(|&table| {
                    self.tables[table].last_used <= since && Some(self.tables[table].key) != kept
                })
                .min_by_key(|&table| self.tables[table].last_used);
            let Some(oldest) = oldest else { return };
            self.tables.swap_remove(oldest);
        }
    }
}

impl KeptTable {
    fn new(key: Key, slot_count: usize, blocked_basis_count: usize) -> Self {
        Self {
            places: [vec![0; slot_count], vec![0; slot_count]],
            blocks: vec![vec![DARK]; key.basis_count.div_ceil(BLOCK)],
            blocked_block_count: blocked_basis_count.div_ceil(BLOCK),
            last_used: 0,
            key,
        }
    }

    fn byte_count(&self) -> usize {
        let nodes: usize = self.blocks.iter().map(Vec::capacity).sum();
        nodes * size_of::<MixedNode>()
            + self.places.iter().map(|places| size_of_val(&**places)).sum::<usize>()
    }

    /// The nodes of a block.
    fn nodes(&self, block: usize) -> BlockNodes<'_> {
        let places = &self.places[usize::from(block >= self.blocked_block_count)];
        BlockNodes { places, nodes: &self.blocks[block] }
    }

    /// Mixes the nodes of a request that are missing, by their places in [`Prepared::nodes`].
    fn mix(&mut self, tables: &ResidentTables, request: &Prepared, slots: &[usize], missing: &[usize]) {
        let altitude_m = step_altitude_m(&tables.observer_altitude_m, self.key.step);
        let on = |altitudes_m: &[f64]| Stencil::lagrange_or_node(altitudes_m, altitude_m, 1e-9);
        let blocked = tables.blocked.as_ref();
        let at_step = Prepared {
            nodes: missing.iter().map(|node| request.nodes[*node]).collect(),
            cells: Vec::new(),
            columns: Vec::new(),
            observer_altitude_m: altitude_m,
            altitude_stencil: on(&tables.observer_altitude_m),
            blocked_altitude_stencil: blocked
                .map_or(Stencil::single(0), |blocked| on(&blocked.observer_altitude_m)),
            near: None,
            ..*request
        };
        let (mut scales, mut mixed) = (Vec::new(), Vec::new());
        mix_scale(tables, &at_step, true, &mut scales);
        mix_shape(tables, &at_step, &scales, true, &mut mixed);
        // Those under an open sky are listed first.
        let open_count = at_step.nodes.partition_point(|node| node.blocking == 0);
        for (group, places) in self.places.iter_mut().enumerate() {
            let (blocks, count) = match group {
                0 => (0..self.blocked_block_count, missing.len()),
                _ => (self.blocked_block_count..self.blocks.len(), open_count),
            };
            let first = self.blocks.get(blocks.start).filter(|_| !blocks.is_empty()).map_or(1, Vec::len);
            for (place, node) in (first as u32..).zip(&missing[..count]) {
                places[slots[*node]] = place;
            }
            for block in blocks {
                let kept = &mut self.blocks[block];
                kept.reserve_exact(count);
                kept.extend_from_slice(&mixed[block * missing.len()..][..count]);
            }
        }
    }
}

/// Nodes of a kept table in one block, and their places by slot.
#[derive(Clone, Copy)]
struct BlockNodes<'a> {
    places: &'a [u32],
    nodes: &'a [MixedNode],
}

simd_dispatch! {
    /// The nodes of some slots between steps of altitude.
    fn interpolate(
        steps: [BlockNodes<'_>; STEPS],
        weights: [f32; STEPS],
        slots: &[usize],
        mixed: &mut [MixedNode],
    ) = interpolate_body;
}

#[inline(always)]
fn interpolate_body(
    steps: [BlockNodes<'_>; STEPS],
    weights: [f32; STEPS],
    slots: &[usize],
    mixed: &mut [MixedNode],
) {
    for (slot, mixed) in slots.iter().zip(mixed) {
        let [lower, middle, upper] = steps.map(|step| &step.nodes[step.places[*slot] as usize].0);
        for band in 0..BAND_COUNT {
            for k in 0..BLOCK {
                mixed.0[band][k] =
                    weights[0] * lower[band][k] + weights[1] * middle[band][k] + weights[2] * upper[band][k];
            }
        }
    }
}
