//! Inverse transforms along azimuth, each by a forward transform of conjugates: sixteen rows at once, two real ones for one
//! complex one, each in a lane of its own.

use super::{
    lanes::{Aligned, LANES},
    layout::{FrequencySums, ROW_GROUPS, ROWS_PER_GROUP},
    work::for_each_part,
};
use crate::twin::{Twiddles, pair_from_spectra, transform_256};
use skyglow_physics::{AZIMUTH_COUNT, BAND_COUNT, Panorama, simd_dispatch};

/// Rows `[band][row][column]` from the summed spectra, none below `floor`; 0 in bands without light. Radiance has the
/// floor 0.
pub fn inverse_fft(
    twiddles: &Twiddles,
    floor: f32,
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
        transform_rows(twiddles, sums, task / ROW_GROUPS, task % ROW_GROUPS, floor, rows);
    });
}

simd_dispatch! {
    /// Sixteen rows of radiance in one band.
    fn transform_rows(
        twiddles: &Twiddles,
        sums: &[FrequencySums],
        band: usize,
        row_group: usize,
        floor: f32,
        rows: &mut [[f32; AZIMUTH_COUNT]],
    ) = transform_rows_body;
}

#[inline(always)]
fn transform_rows_body(
    twiddles: &Twiddles,
    sums: &[FrequencySums],
    band: usize,
    row_group: usize,
    floor: f32,
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
    transform_256(twiddles, points);
    let scale = 1.0 / AZIMUTH_COUNT as f32;
    for (lane, row) in rows.iter_mut().enumerate() {
        let (part, lane, scale) = if lane < LANES { (0, lane, scale) } else { (1, lane - LANES, -scale) };
        for (sample, point) in row.iter_mut().zip(points.iter()) {
            *sample = (point[part][lane] * scale).max(floor);
        }
    }
}
