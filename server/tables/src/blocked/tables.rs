//! The tables of sources behind skylines as a pack stores them, and resampled for evaluation.

use super::{ANGLE_COUNT, BlockedAxes, blocking_deg};
use crate::{
    axes::OffsetAxis,
    curvature::log_scale_at,
    layout::IMAGE_COUNT,
    resident::{ResidentBlocked, ResidentTables},
};
use half::{f16, slice::HalfFloatSliceExt};
use rayon::prelude::*;
use skyglow_physics::{BAND_COUNT, interpolation::Stencil};

/// Coefficients that are converted to f32 at once.
const AT_ONCE: usize = 32;

/// Differences to the open tables at the pack's own sample points.
#[derive(Clone, Debug)]
pub(crate) struct BlockedTables {
    pub(crate) axes: BlockedAxes,
    /// ln of the scale over the open one, ≤ 0, `[observer_altitude][angle_index][lobe][band][distance][offset]`.
    pub(crate) log_part: Vec<f32>,
    /// Shape coefficients less the open ones, the same with `[basis]` last.
    pub(crate) shape_less_open: Vec<f16>,
}

/// The open tables at one (observer, lobe, band, ring) and any offset, as the renderer interpolates them: ln scale, and
/// the first shape coefficients into `shape`.
pub(super) fn open_sample(
    open: &ResidentTables,
    observers: Stencil,
    image: usize,
    ring: usize,
    offset_m: f64,
    shape: &mut [f32],
) -> f64 {
    let position = open.offset_axis[ring].position(offset_m);
    open_shape(open, observers, image, ring, position, shape);
    open_log_scale(open, observers, image, ring, position)
}

/// ln of the open scale at a fractional node.
fn open_log_scale(
    open: &ResidentTables,
    observers: Stencil,
    image: usize,
    ring: usize,
    position: f64,
) -> f64 {
    let (lobe, band) = (image / BAND_COUNT, image % BAND_COUNT);
    log_scale_at(&open.offset_axis[ring], position, |offset| {
        let at = |observer| open.log_scale[open.scale_index(observer, lobe, band, ring, offset)];
        observers.sum(|observer| f64::from(at(observer)))
    })
}

/// The first open shape coefficients at a fractional node.
fn open_shape(
    open: &ResidentTables,
    observers: Stencil,
    image: usize,
    ring: usize,
    position: f64,
    shape: &mut [f32],
) {
    let low = (position as usize).min(open.offset_count - 2);
    let upper_weight = position - low as f64;
    let (lobe, band) = (image / BAND_COUNT, image % BAND_COUNT);
    shape.fill(0.0);
    for (observer, observer_weight) in observers {
        for (side, side_weight) in [(0, 1.0 - upper_weight), (1, upper_weight)] {
            let weight = observer_weight * side_weight;
            if weight == 0.0 {
                continue;
            }
            let node = open.shape_index(observer, lobe, band, ring, low + side);
            let values = &open.shape[node * open.basis_count..][..shape.len()];
            for (sums, values) in shape.chunks_mut(AT_ONCE).zip(values.chunks(AT_ONCE)) {
                let mut wide = [0.0f32; AT_ONCE];
                values.convert_to_f32_slice(&mut wide[..values.len()]);
                for (sum, value) in sums.iter_mut().zip(wide) {
                    *sum += weight as f32 * value;
                }
            }
        }
    }
}

impl BlockedTables {
    /// The tables on the rings and observer altitudes of the open ones: differences are interpolated over distance (cubic
    /// in ln r at constant fractional offset node) and observer altitude, and added to the open tables there.
    pub(crate) fn resident(&self, open: &ResidentTables) -> ResidentBlocked {
        let axes = &self.axes;
        let (offsets, count) = (axes.offset_count, axes.basis_count);
        let rings = open.ring_distance_m.len();
        let log_distance: Vec<f64> = axes.distance_m.iter().map(|d| d.ln()).collect();
        let distance_stencils: Vec<Stencil> =
            open.ring_distance_m.iter().map(|d| Stencil::lagrange(&log_distance, d.ln())).collect();
        let offset_axis: Vec<Vec<OffsetAxis>> = (0..ANGLE_COUNT)
            .map(|angle| {
                let axis = |&d: &f64| OffsetAxis::behind_skyline(d, blocking_deg(angle), offsets);
                open.ring_distance_m.iter().map(axis).collect()
            })
            .collect();
        // The same for every observer and image.
        let position = |angle: usize, ring: usize, offset: usize| {
            open.offset_axis[ring].position(offset_axis[angle][ring].offset_m(offset as f64))
        };
        let positions: Vec<f64> = (0..ANGLE_COUNT * rings * offsets)
            .map(|node| position(node / (rings * offsets), node / offsets % rings, node % offsets))
            .collect();
        let observers = open.observer_altitude_m.len();
        let differences: Vec<(Vec<f32>, Vec<f32>)> = (0..observers * ANGLE_COUNT * IMAGE_COUNT)
            .into_par_iter()
            .map(|table| {
                let observer_m = open.observer_altitude_m[table / (ANGLE_COUNT * IMAGE_COUNT)];
                self.at_observer(observer_m, table % (ANGLE_COUNT * IMAGE_COUNT))
            })
            .collect();
        let mut log_scale = vec![0.0f32; differences.len() * rings * offsets];
        log_scale.par_chunks_exact_mut(rings * offsets).zip(&differences).enumerate().for_each(
            |(table, (log_scale, (log_part, _)))| {
                let (observer, rest) =
                    (table / (ANGLE_COUNT * IMAGE_COUNT), table % (ANGLE_COUNT * IMAGE_COUNT));
                let positions = &positions[rest / IMAGE_COUNT * rings * offsets..];
                for (node, (log_scale, position)) in log_scale.iter_mut().zip(positions).enumerate() {
                    let ring = node / offsets;
                    let open_log =
                        open_log_scale(open, Stencil::single(observer), rest % IMAGE_COUNT, ring, *position);
                    let part = |distance| f64::from(log_part[distance * offsets + node % offsets]);
                    let log = distance_stencils[ring].sum(part);
                    // Between nodes, too, a skyline takes light and adds none.
                    *log_scale = (open_log + log.min(0.0)) as f32;
                }
            },
        );
        let mut shape = vec![f16::ZERO; log_scale.len() * count];
        let node_images = observers * IMAGE_COUNT;
        shape.par_chunks_exact_mut(offsets * node_images * count).enumerate().for_each(|(place, shape)| {
            let (angle, ring) = (place / rings, place % rings);
            let mut sum = vec![0.0f32; count];
            for (slot, shape) in shape.chunks_exact_mut(count).enumerate() {
                let (offset, observer, image) =
                    (slot / node_images, slot / IMAGE_COUNT % observers, slot % IMAGE_COUNT);
                open_shape(
                    open,
                    Stencil::single(observer),
                    image,
                    ring,
                    positions[place * offsets + offset],
                    &mut sum,
                );
                let (_, differences) = &differences[(observer * ANGLE_COUNT + angle) * IMAGE_COUNT + image];
                for (distance, weight) in distance_stencils[ring] {
                    let differences = &differences[(distance * offsets + offset) * count..];
                    for (sum, value) in sum.iter_mut().zip(differences) {
                        *sum += weight as f32 * value;
                    }
                }
                shape.convert_from_f32_slice(&sum);
            }
        });
        ResidentBlocked {
            observer_altitude_m: open.observer_altitude_m.clone(),
            offset_count: offsets,
            offset_axis,
            basis_count: count,
            log_scale,
            shape,
        }
    }

    /// Differences of one (angle, image), `table` = angle · images + image, at an observer altitude,
    /// `[distance][offset]` and the same with `[basis]`.
    fn at_observer(&self, observer_m: f64, table: usize) -> (Vec<f32>, Vec<f32>) {
        let nodes = self.axes.distance_m.len() * self.axes.offset_count;
        let count = self.axes.basis_count;
        let (mut log_part, mut differences) = (vec![0.0f32; nodes], vec![0.0f32; nodes * count]);
        for (observer, weight) in Stencil::lagrange(&self.axes.observer_altitude_m, observer_m) {
            let (weight, start) = (weight as f32, (observer * ANGLE_COUNT * IMAGE_COUNT + table) * nodes);
            for (sum, value) in log_part.iter_mut().zip(&self.log_part[start..]) {
                *sum += weight * value;
            }
            for (sum, value) in differences.iter_mut().zip(&self.shape_less_open[start * count..]) {
                *sum += weight * value.to_f32();
            }
        }
        (log_part, differences)
    }
}
