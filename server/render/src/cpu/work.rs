//! Data parallelism within a pass: work shared among the cores.

use rayon::prelude::*;

/// Runs `work` on every part of `parts_len` values, numbered from 0: on all cores, or one part after the other where the
/// cores have other parts of the batch to do.
pub(crate) fn for_each_part<T: Send>(
    side_by_side: bool,
    values: &mut [T],
    part_len: usize,
    work: impl Fn(usize, &mut [T]) + Sync,
) {
    if side_by_side {
        values.par_chunks_mut(part_len).enumerate().for_each(|(part, values)| work(part, values));
    } else {
        values.chunks_mut(part_len).enumerate().for_each(|(part, values)| work(part, values));
    }
}
