//! Forward transforms along azimuth: sixteen real functions at once, eight in the real and eight in the imaginary parts of
//! one complex transform (two real transforms for one, Cooley, Lewis and Welch 1970), each in a lane of its own, so that
//! nothing is shuffled.

use super::{
    lanes::{Aligned, LANES},
    layout::{BLOCK, ColumnBlock, FUNCTIONS_PER_GROUP, GroupSpectra, empty_spectra},
    work::for_each_part,
};
use crate::twin::{Twiddles, split_pair_spectrum, transform_256};
use skyglow_physics::{AZIMUTH_COUNT, BAND_COUNT, simd_dispatch};

/// Groups in a block of functions.
const GROUPS_PER_BLOCK: usize = BLOCK / FUNCTIONS_PER_GROUP;

/// F[H] of the first `basis_count` functions, `[group][band]`, from columns `[block][azimuth]`; 0 in bands without
/// light.
pub fn azimuth_fft(
    twiddles: &Twiddles,
    lit_bands: [bool; BAND_COUNT],
    columns: &[ColumnBlock],
    basis_count: usize,
    side_by_side: bool,
    spectra: &mut Vec<GroupSpectra>,
) {
    spectra.resize(basis_count.div_ceil(FUNCTIONS_PER_GROUP) * BAND_COUNT, empty_spectra());
    for_each_part(side_by_side, spectra, 1, |task, target| {
        let (group, band) = (task / BAND_COUNT, task % BAND_COUNT);
        if !lit_bands[band] {
            target[0] = empty_spectra();
            return;
        }
        let columns = &columns[group / GROUPS_PER_BLOCK * AZIMUTH_COUNT..][..AZIMUTH_COUNT];
        transform_columns(twiddles, columns, band, group % GROUPS_PER_BLOCK, &mut target[0]);
    });
}

simd_dispatch! {
    /// Spectra of one group of functions in one band.
    fn transform_columns(
        twiddles: &Twiddles,
        columns: &[ColumnBlock],
        band: usize,
        group_in_block: usize,
        target: &mut GroupSpectra,
    ) = transform_columns_body;
}

#[inline(always)]
fn transform_columns_body(
    twiddles: &Twiddles,
    columns: &[ColumnBlock],
    band: usize,
    group_in_block: usize,
    target: &mut GroupSpectra,
) {
    let Aligned(points) = &mut Aligned([[[0f32; LANES]; 2]; AZIMUTH_COUNT]);
    for (point, column) in points.iter_mut().zip(columns) {
        let functions = &column.0[band].as_chunks::<LANES>().0[2 * group_in_block..][..2];
        *point = [functions[0], functions[1]];
    }
    transform_256(twiddles, points);
    for (f, [real, imaginary]) in target.0.iter_mut().enumerate() {
        let (z, mirrored) = (&points[f], &points[(AZIMUTH_COUNT - f) % AZIMUTH_COUNT]);
        for lane in 0..LANES {
            let [a_real, a_imaginary, b_real, b_imaginary] =
                split_pair_spectrum([z[0][lane], z[1][lane]], [mirrored[0][lane], mirrored[1][lane]]);
            real[lane] = a_real;
            real[LANES + lane] = b_real;
            imaginary[lane] = a_imaginary;
            imaginary[LANES + lane] = b_imaginary;
        }
    }
}
