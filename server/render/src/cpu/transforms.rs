//! Transforms along azimuth: sixteen real rows at once, eight in the real and eight in the imaginary parts of one
//! complex transform, each in a lane of its own, so that nothing is shuffled.

use super::{
    basis_sum::{FrequencySums, ROWS_PER_GROUP},
    coefficients::ColumnBlock,
    lanes::{Aligned, LANES},
    mix::BLOCK,
    work::for_each_part,
};
use crate::twin::fft::{
    Complex, complex_multiply, pair_from_spectra, radix4_butterfly, split_pair_spectrum, stockham_target,
    twiddle, twiddle_index,
};
use skyglow_physics::{AZIMUTH_COUNT, BAND_COUNT, ELEVATION_COUNT, Panorama, simd_dispatch};
use skyglow_tables::resident::FREQUENCY_COUNT;

/// Functions that one transform takes.
pub const FUNCTIONS_PER_GROUP: usize = 2 * LANES;
/// Groups in a block of functions.
const GROUPS_PER_BLOCK: usize = BLOCK / FUNCTIONS_PER_GROUP;
/// Groups of rows that one inverse transform takes.
const ROW_GROUPS: usize = ELEVATION_COUNT / ROWS_PER_GROUP;

/// Spectra of one group of functions in one band: `[frequency][real, imaginary][function in group]`.
pub type GroupSpectra = Aligned<[[[f32; FUNCTIONS_PER_GROUP]; 2]; FREQUENCY_COUNT]>;

/// Spectra of functions that are 0.
pub const fn empty_spectra() -> GroupSpectra {
    Aligned([[[0.0; FUNCTIONS_PER_GROUP]; 2]; FREQUENCY_COUNT])
}

/// Eight complex numbers: real parts, imaginary parts.
type Eight = [[f32; LANES]; 2];

/// Tables of the transform of 256 points.
pub struct Transforms {
    twiddles: [Complex; AZIMUTH_COUNT],
}

impl Transforms {
    /// The tables.
    pub fn new() -> Self {
        Self { twiddles: std::array::from_fn(twiddle) }
    }

    /// F[H] of the first `basis_count` functions, `[group][band]`, from columns `[block][azimuth]`; 0 in bands without
    /// light.
    pub fn forward(
        &self,
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
            transform_columns(&self.twiddles, columns, band, group % GROUPS_PER_BLOCK, &mut target[0]);
        });
    }

    /// Radiance `[band][row][column]` from the summed spectra, clamped at 0.
    pub fn inverse(
        &self,
        lit_bands: [bool; BAND_COUNT],
        sums: &[FrequencySums],
        side_by_side: bool,
        radiance_w_m2_sr: &mut Vec<f32>,
    ) {
        self.inverse_above(0.0, lit_bands, sums, side_by_side, radiance_w_m2_sr);
    }

    /// The same, clamped at `least`.
    pub fn inverse_above(
        &self,
        least: f32,
        lit_bands: [bool; BAND_COUNT],
        sums: &[FrequencySums],
        side_by_side: bool,
        rows: &mut Vec<f32>,
    ) {
        rows.resize(Panorama::LEN, 0.0);
        for_each_part(side_by_side, rows, ROWS_PER_GROUP * AZIMUTH_COUNT, |task, rows| {
            if !lit_bands[task / ROW_GROUPS] {
                rows.fill(0.0);
                return;
            }
            let (rows, _) = rows.as_chunks_mut::<AZIMUTH_COUNT>();
            transform_rows(&self.twiddles, sums, task / ROW_GROUPS, task % ROW_GROUPS, least, rows);
        });
    }
}

simd_dispatch! {
    /// Spectra of one group of functions in one band.
    fn transform_columns(
        twiddles: &[Complex; AZIMUTH_COUNT],
        columns: &[ColumnBlock],
        band: usize,
        group_in_block: usize,
        target: &mut GroupSpectra,
    ) = transform_columns_body::<FUSED>;
}

#[inline(always)]
fn transform_columns_body<const FUSED: bool>(
    twiddles: &[Complex; AZIMUTH_COUNT],
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
    transform(twiddles, points);
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

simd_dispatch! {
    /// Sixteen rows of radiance in one band.
    fn transform_rows(
        twiddles: &[Complex; AZIMUTH_COUNT],
        sums: &[FrequencySums],
        band: usize,
        row_group: usize,
        least: f32,
        rows: &mut [[f32; AZIMUTH_COUNT]],
    ) = transform_rows_body::<FUSED>;
}

#[inline(always)]
fn transform_rows_body<const FUSED: bool>(
    twiddles: &[Complex; AZIMUTH_COUNT],
    sums: &[FrequencySums],
    band: usize,
    row_group: usize,
    least: f32,
    rows: &mut [[f32; AZIMUTH_COUNT]],
) {
    let Aligned(points) = &mut Aligned([[[0f32; LANES]; 2]; AZIMUTH_COUNT]);
    for (f, sums) in sums.iter().enumerate() {
        let part = |part: usize| &sums.0[band][part].as_chunks::<LANES>().0[2 * row_group..][..2];
        let (real, imaginary) = (part(0), part(1));
        let (mut direct, mut mirrored) = ([[0f32; LANES]; 2], [[0f32; LANES]; 2]);
        for lane in 0..LANES {
            let spectra = [real[0][lane], imaginary[0][lane], real[1][lane], imaginary[1][lane]];
            [direct[0][lane], direct[1][lane]] = pair_from_spectra(spectra, false);
            [mirrored[0][lane], mirrored[1][lane]] = pair_from_spectra(spectra, true);
        }
        // Frequencies 0 and 128 are their own mirror images, and real.
        points[(AZIMUTH_COUNT - f) % AZIMUTH_COUNT] = mirrored;
        points[f] = direct;
    }
    transform(twiddles, points);
    let scale = 1.0 / AZIMUTH_COUNT as f32;
    for (lane, row) in rows.iter_mut().enumerate() {
        let (part, lane, scale) = if lane < LANES { (0, lane, scale) } else { (1, lane - LANES, -scale) };
        for (sample, point) in row.iter_mut().zip(points.iter()) {
            *sample = (point[part][lane] * scale).max(least);
        }
    }
}

/// [`crate::twin::fft::transform_256`] in every lane.
#[inline(always)]
fn transform(twiddles: &[Complex; AZIMUTH_COUNT], points: &mut [Eight; AZIMUTH_COUNT]) {
    let Aligned(other) = &mut Aligned([[[0f32; LANES]; 2]; AZIMUTH_COUNT]);
    stage::<1>(twiddles, points, other);
    stage::<4>(twiddles, other, points);
    stage::<16>(twiddles, points, other);
    stage::<64>(twiddles, other, points);
}

/// One stage, whose sub-transforms have `SPAN` points.
#[inline(always)]
fn stage<const SPAN: usize>(
    twiddles: &[Complex; AZIMUTH_COUNT],
    from: &[Eight; AZIMUTH_COUNT],
    to: &mut [Eight; AZIMUTH_COUNT],
) {
    const LEG: usize = AZIMUTH_COUNT / 4;
    for within in 0..SPAN {
        let turn: [Complex; 4] = std::array::from_fn(|leg| {
            twiddles[twiddle_index(within as u32, SPAN as u32, leg as u32) as usize]
        });
        for butterfly in (within..LEG).step_by(SPAN) {
            let legs: [&Eight; 4] = std::array::from_fn(|leg| &from[butterfly + LEG * leg]);
            let mut out = [[[0f32; LANES]; 2]; 4];
            for lane in 0..LANES {
                let turned: [Complex; 4] = std::array::from_fn(|leg| {
                    let value = [legs[leg][0][lane], legs[leg][1][lane]];
                    // The first leg, and all of the first stage, are turned by nothing.
                    if leg == 0 || SPAN == 1 { value } else { complex_multiply(value, turn[leg]) }
                });
                for (out, [real, imaginary]) in out.iter_mut().zip(radix4_butterfly(turned)) {
                    out[0][lane] = real;
                    out[1][lane] = imaginary;
                }
            }
            for (leg, out) in out.into_iter().enumerate() {
                to[stockham_target(butterfly as u32, SPAN as u32, leg as u32) as usize] = out;
            }
        }
    }
}
