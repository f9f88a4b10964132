//! Mixing the scales of observer altitudes and lobes at the nodes that are needed, by log-sum-exp.

use super::{layout::NodeScales, work::for_each_part};
use crate::{
    node_table::{NodeTable, WINDOW},
    prepare::Prepared,
    twin::{lobe_shares, mixed_curvature},
};
use skyglow_physics::{BAND_COUNT, LOBE_COUNT, simd_dispatch};
use skyglow_tables::resident::ResidentTables;

/// Nodes that a task mixes.
const NODES_PER_TASK: usize = 64;

/// Lobe shares and mixed scale of every node.
pub fn mix_scale(
    tables: &ResidentTables,
    request: &Prepared,
    side_by_side: bool,
    scales: &mut Vec<NodeScales>,
) {
    scales.resize(request.nodes.len(), NodeScales::default());
    for_each_part(side_by_side, scales, NODES_PER_TASK, |task, scales| {
        let nodes = &request.nodes[task * NODES_PER_TASK..][..scales.len()];
        let mut windows = [NodeWindows::default(); BAND_COUNT];
        for (lane, node) in nodes.iter().enumerate() {
            let table = NodeTable::of(tables, request, node);
            let weights = table.altitudes.weights_f32();
            for (band, windows) in windows.iter_mut().enumerate() {
                for lobe in (0..LOBE_COUNT).filter(|&lobe| request.emission[lobe] > 0.0) {
                    let mut window = [0f32; WINDOW];
                    for (altitude, weight) in table.altitudes.nodes().zip(weights) {
                        let values = table.window(altitude, lobe, band);
                        window.iter_mut().zip(values).for_each(|(sum, value)| *sum += weight * value);
                    }
                    for (place, value) in window.into_iter().enumerate() {
                        windows.around[place][lobe][lane] = value;
                    }
                    windows.at[lobe][lane] = window[table.place_in_window];
                }
            }
        }
        for (band, windows) in windows.iter().enumerate() {
            let mut mixed = [[0f32; NODES_PER_TASK]; 5];
            mix_lobes(request.emission, windows, &mut mixed);
            for (lane, scales) in scales.iter_mut().enumerate() {
                scales.shares[band] = [mixed[0][lane], mixed[1][lane], mixed[2][lane]];
                (scales.log_scale[band], scales.curvature[band]) = (mixed[3][lane], mixed[4][lane]);
            }
        }
    });
}

/// ln of the lobes' scales at many nodes in one band.
#[derive(Clone, Copy)]
pub struct NodeWindows {
    /// At the nodes themselves, `[lobe][node]`.
    at: [[f32; NODES_PER_TASK]; LOBE_COUNT],
    /// At the three that give the curvature, `[place][lobe][node]`.
    around: [[[f32; NODES_PER_TASK]; LOBE_COUNT]; WINDOW],
}

impl Default for NodeWindows {
    fn default() -> Self {
        let lobes = [[0.0; NODES_PER_TASK]; LOBE_COUNT];
        Self { at: lobes, around: [lobes; WINDOW] }
    }
}

simd_dispatch! {
    /// [`lobe_shares`] and [`mixed_curvature`] of many nodes, `[value][node]`.
    fn mix_lobes(
        emission: [f32; LOBE_COUNT],
        windows: &NodeWindows,
        mixed: &mut [[f32; NODES_PER_TASK]; 5],
    ) = mix_lobes_body;
}

#[inline(always)]
fn mix_lobes_body(
    emission: [f32; LOBE_COUNT],
    windows: &NodeWindows,
    mixed: &mut [[f32; NODES_PER_TASK]; 5],
) {
    for lane in 0..NODES_PER_TASK {
        let lobes = |values: &[[f32; NODES_PER_TASK]; LOBE_COUNT]| {
            [values[0][lane], values[1][lane], values[2][lane]]
        };
        let [first, second, third, log_sum] = lobe_shares(emission, lobes(&windows.at));
        let [below, at, above] = &windows.around;
        let curvature = mixed_curvature([first, second, third], [lobes(below), lobes(at), lobes(above)]);
        for (out, value) in mixed.iter_mut().zip([first, second, third, log_sum, curvature]) {
            out[lane] = value;
        }
    }
}
