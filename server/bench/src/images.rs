//! Tables of whole source images, laid out so that a task streams through its own rows of all of them.

use rayon::prelude::*;
use skyglow_physics::{AZIMUTH_COUNT, BAND_COUNT, ELEVATION_COUNT, simd::multiply_add, simd_dispatch};
use skyglow_render::reference::basis_images;
use skyglow_tables::ResidentTables;

/// Rows that a task works on: its part of the sky stays in the nearest cache.
const ROWS_PER_TASK: usize = 8;
/// Samples of them.
pub(crate) const TASK_LEN: usize = ROWS_PER_TASK * AZIMUTH_COUNT;
/// Tasks of one band.
pub(crate) const TASKS_PER_BAND: usize = ELEVATION_COUNT / ROWS_PER_TASK;
/// Tasks of a sky.
pub(crate) const TASK_COUNT: usize = BAND_COUNT * TASKS_PER_BAND;

/// Images of 256 × 64 directions in every band, in f32. Column 0 looks at the source.
#[derive(Clone, Debug)]
pub(crate) struct ImageTable {
    image_count: usize,
    /// `[task][image][row in task][column]`; tasks by band, then row.
    values: Vec<f32>,
}

impl ImageTable {
    /// Expands images from a pack's basis: Σ_k shape_k · B_k. `shape` is `[band][image]` of coefficients, all of the
    /// same length.
    pub(crate) fn expand(tables: &ResidentTables, shape: &[Vec<f32>]) -> Self {
        let image_count = shape.len() / BAND_COUNT;
        let basis_count = shape.first().map_or(0, Vec::len);
        let basis: Vec<f32> =
            basis_images(tables, basis_count).into_iter().map(|value| value as f32).collect();
        let mut table = Self { image_count, values: vec![0.0; TASK_COUNT * image_count * TASK_LEN] };
        table.values.par_chunks_mut(image_count.max(1) * TASK_LEN).enumerate().for_each(|(task, images)| {
            let (band, rows) = (task / TASKS_PER_BAND, task % TASKS_PER_BAND);
            for (image, shape) in images.chunks_exact_mut(TASK_LEN).zip(&shape[band * image_count..]) {
                let functions = basis.chunks_exact(ELEVATION_COUNT * AZIMUTH_COUNT);
                for (function, &value) in functions.zip(shape) {
                    add_scaled(&function[rows * TASK_LEN..][..TASK_LEN], value, image);
                }
            }
        });
        table
    }

    /// A task's rows of every image, one image after the other.
    pub(crate) fn of_task(&self, task: usize) -> &[f32] {
        &self.values[task * self.image_count * TASK_LEN..][..self.image_count * TASK_LEN]
    }

    /// Bytes of the images.
    pub(crate) fn bytes(&self) -> u64 {
        size_of_val(self.values.as_slice()) as u64
    }
}

simd_dispatch! {
    /// Adds `value · from` to `target`.
    fn add_scaled(from: &[f32], value: f32, target: &mut [f32]) = add_scaled_body::<FUSED>;
}

#[inline(always)]
pub(crate) fn add_scaled_body<const FUSED: bool>(from: &[f32], value: f32, target: &mut [f32]) {
    for (target, from) in target.iter_mut().zip(from) {
        *target = multiply_add::<FUSED>(value, *from, *target);
    }
}
