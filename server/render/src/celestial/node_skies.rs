//! Skies of beams at the zenith angles of a table as spectra along azimuth, and sums of any number of such beams: the convolution that
//! adds up lights on the ground, with skies of zenith angles in place of basis functions (`docs/model.md#night-sky`).

use crate::{
    cpu::{
        azimuth_fft::azimuth_fft,
        inverse_fft::inverse_fft,
        lanes::Aligned,
        layout::{
            BLOCK, ColumnBlock, FUNCTIONS_PER_GROUP, FrequencySums, GroupSpectra, ROW_GROUPS, ROWS_PER_GROUP,
        },
    },
    twin::Twiddles,
};
use rayon::prelude::*;
use skyglow_physics::{
    AZIMUTH_COUNT, BAND_COUNT, ELEVATION_COUNT, Panorama, simd::multiply_add, simd_dispatch,
};
use skyglow_tables::resident::FREQUENCY_COUNT;

/// Frequencies that a task sums.
const FREQUENCIES_PER_TASK: usize = 16;
/// All bands: beams have light in each.
const LIT: [bool; BAND_COUNT] = [true; BAND_COUNT];

/// Light on beams: irradiance outside the air by zenith angle and azimuth.
#[derive(Clone, Debug, PartialEq)]
pub struct BeamGrid {
    node_count: usize,
    /// `[band][node][azimuth]`.
    irradiance: Vec<f32>,
    is_even: bool,
}

impl BeamGrid {
    /// From `[band][node][azimuth]`, azimuth i at i·360/256° from north, in any unit; None where the length is another.
    pub fn new(node_count: usize, irradiance: Vec<f32>) -> Option<Self> {
        if irradiance.len() != BAND_COUNT * node_count * AZIMUTH_COUNT {
            return None;
        }
        let is_even = irradiance
            .chunks_exact(AZIMUTH_COUNT)
            .all(|row| row.iter().all(|value| (value - row[0]).abs() <= 1e-6 * row[0].abs()));
        Some(Self { node_count, irradiance, is_even })
    }

    /// Irradiance by azimuth.
    fn row(&self, band: usize, node: usize) -> &[f32] {
        &self.irradiance[(band * self.node_count + node) * AZIMUTH_COUNT..][..AZIMUTH_COUNT]
    }

    /// Frequencies along azimuth that it has: one where all azimuths are alike.
    pub fn frequency_count(&self) -> usize {
        if self.is_even { 1 } else { FREQUENCY_COUNT }
    }

    /// Spectra along azimuth, `[group of nodes][band]`.
    fn spectra(&self, twiddles: &Twiddles) -> Vec<GroupSpectra> {
        let mut columns: Vec<ColumnBlock> =
            vec![Aligned([[0.0; BLOCK]; BAND_COUNT]); self.node_count.div_ceil(BLOCK) * AZIMUTH_COUNT];
        for band in 0..BAND_COUNT {
            for node in 0..self.node_count {
                let block = &mut columns[node / BLOCK * AZIMUTH_COUNT..][..AZIMUTH_COUNT];
                for (column, value) in block.iter_mut().zip(self.row(band, node)) {
                    column.0[band][node % BLOCK] = *value;
                }
            }
        }
        let mut spectra = Vec::new();
        azimuth_fft(twiddles, LIT, &columns, self.node_count, true, &mut spectra);
        spectra
    }

    /// The same of a grid whose azimuths are alike: frequency 0 alone.
    fn even_spectra(&self) -> Vec<GroupSpectra> {
        let groups = self.node_count.div_ceil(FUNCTIONS_PER_GROUP);
        let mut spectra = vec![crate::cpu::layout::empty_spectra(); groups * BAND_COUNT];
        for band in 0..BAND_COUNT {
            for node in 0..self.node_count {
                let group = &mut spectra[node / FUNCTIONS_PER_GROUP * BAND_COUNT + band];
                group.0[0][0][node % FUNCTIONS_PER_GROUP] = AZIMUTH_COUNT as f32 * self.row(band, node)[0];
            }
        }
        spectra
    }
}

/// Skies of beams from the north at every zenith angle of a table, for one observer's altitude. A sky is even about its beam, so its
/// spectrum is real.
pub struct NodeSkies {
    node_count: usize,
    /// `[frequency][band][group of elevations][node]`.
    spectra: Vec<Aligned<[f32; ROWS_PER_GROUP]>>,
}

impl NodeSkies {
    /// From the sky of each zenith angle, sr⁻¹, the beam in the north.
    pub fn of(node_count: usize, sky: impl Fn(usize) -> Panorama + Sync, twiddles: &Twiddles) -> Self {
        let rows: Vec<Vec<GroupSpectra>> =
            (0..node_count).into_par_iter().map(|node| row_spectra(&sky(node), twiddles)).collect();
        let mut spectra = Vec::with_capacity(FREQUENCY_COUNT * BAND_COUNT * ROW_GROUPS * node_count);
        for f in 0..FREQUENCY_COUNT {
            for band in 0..BAND_COUNT {
                for group in 0..ROW_GROUPS {
                    spectra.extend(
                        rows.iter().map(|of_node| Aligned(of_node[group * BAND_COUNT + band].0[f][0])),
                    );
                }
            }
        }
        Self { node_count, spectra }
    }

    /// Bytes held.
    pub fn byte_count(&self) -> usize {
        size_of_val(&self.spectra[..])
    }

    /// The sky of all beams of a grid together: radiance in the grid's unit per sr. None where the grid is on other zenith angles.
    pub fn sky(&self, grid: &BeamGrid, twiddles: &Twiddles) -> Option<Panorama> {
        if grid.node_count != self.node_count {
            return None;
        }
        let count = grid.frequency_count();
        let spectra = if count == 1 { grid.even_spectra() } else { grid.spectra(twiddles) };
        let mut sums: Vec<FrequencySums> = vec![Aligned([[[0.0; ELEVATION_COUNT]; 2]; BAND_COUNT]); count];
        let per_frequency = BAND_COUNT * ROW_GROUPS * self.node_count;
        sums.par_chunks_mut(FREQUENCIES_PER_TASK).enumerate().for_each(|(task, sums)| {
            let first = task * FREQUENCIES_PER_TASK;
            let skies = &self.spectra[first * per_frequency..][..sums.len() * per_frequency];
            sum_frequencies(skies, self.node_count, &spectra, first, sums);
        });
        if count == 1 {
            return Some(even_sky(&sums[0]));
        }
        let mut rows = Vec::new();
        inverse_fft(twiddles, 0.0, LIT, &sums, true, &mut rows);
        Panorama::from_samples(rows)
    }
}

/// The rows of a sky as functions of azimuth, `[group of elevations][band]`.
fn row_spectra(sky: &Panorama, twiddles: &Twiddles) -> Vec<GroupSpectra> {
    let mut columns: Vec<ColumnBlock> =
        vec![Aligned([[0.0; BLOCK]; BAND_COUNT]); ELEVATION_COUNT / BLOCK * AZIMUTH_COUNT];
    for band in 0..BAND_COUNT {
        for row in 0..ELEVATION_COUNT {
            let samples = &sky.samples()[Panorama::index(band, row, 0)..][..AZIMUTH_COUNT];
            let block = &mut columns[row / BLOCK * AZIMUTH_COUNT..][..AZIMUTH_COUNT];
            for (column, sample) in block.iter_mut().zip(samples) {
                column.0[band][row % BLOCK] = *sample;
            }
        }
    }
    let mut spectra = Vec::new();
    azimuth_fft(twiddles, LIT, &columns, ELEVATION_COUNT, false, &mut spectra);
    spectra
}

/// The sky whose azimuths are all alike.
fn even_sky(sums: &FrequencySums) -> Panorama {
    let mut sky = Panorama::dark();
    for band in 0..BAND_COUNT {
        for row in 0..ELEVATION_COUNT {
            let value = (sums.0[band][0][row] / AZIMUTH_COUNT as f32).max(0.0);
            sky.samples_mut()[Panorama::index(band, row, 0)..][..AZIMUTH_COUNT].fill(value);
        }
    }
    sky
}

simd_dispatch! {
    /// Sums over all nodes at consecutive frequencies from `first` on, of which `skies` holds the nodes' skies.
    fn sum_frequencies(
        skies: &[Aligned<[f32; ROWS_PER_GROUP]>],
        node_count: usize,
        spectra: &[GroupSpectra],
        first: usize,
        sums: &mut [FrequencySums],
    ) = sum_frequencies_body::<FUSED>;
}

#[inline(always)]
fn sum_frequencies_body<const FUSED: bool>(
    skies: &[Aligned<[f32; ROWS_PER_GROUP]>],
    node_count: usize,
    spectra: &[GroupSpectra],
    first: usize,
    sums: &mut [FrequencySums],
) {
    let mut slabs = skies.chunks_exact(node_count);
    for (f, sums) in (first..).zip(sums) {
        for (band, of_band) in sums.0.iter_mut().enumerate() {
            for (row_group, slab) in slabs.by_ref().take(ROW_GROUPS).enumerate() {
                let mut sum = [[0f32; ROWS_PER_GROUP]; 2];
                let groups = slab.chunks(FUNCTIONS_PER_GROUP).zip(spectra.chunks_exact(BAND_COUNT));
                for (slab, bands) in groups {
                    let [real, imaginary] = &bands[band].0[f];
                    for ((Aligned(rows), real), imaginary) in slab.iter().zip(real).zip(imaginary) {
                        for row in 0..ROWS_PER_GROUP {
                            sum[0][row] = multiply_add::<FUSED>(*real, rows[row], sum[0][row]);
                            sum[1][row] = multiply_add::<FUSED>(*imaginary, rows[row], sum[1][row]);
                        }
                    }
                }
                for (target, sum) in of_band.iter_mut().zip(sum) {
                    target[row_group * ROWS_PER_GROUP..][..ROWS_PER_GROUP].copy_from_slice(&sum);
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{synthetic::Noise, twin::twiddles};

    const NODES: usize = 21;

    /// Smooth skies that are even about the north.
    fn node_sky(node: usize) -> Panorama {
        let mut sky = Panorama::dark();
        for band in 0..BAND_COUNT {
            for row in 0..ELEVATION_COUNT {
                for column in 0..AZIMUTH_COUNT {
                    let azimuth = skyglow_physics::panorama::azimuth_rad(column);
                    let peak = (2.0 * azimuth.cos() * (1.0 + 0.1 * node as f64)).exp();
                    let value = peak * (1.0 + 0.3 * band as f64) / (1.0 + 0.05 * (row * (node + 1)) as f64);
                    sky.samples_mut()[Panorama::index(band, row, column)] = value as f32;
                }
            }
        }
        sky
    }

    fn direct_sum(grid: &BeamGrid) -> Vec<f64> {
        let mut sum = vec![0f64; Panorama::LEN];
        for node in 0..NODES {
            let sky = node_sky(node);
            for band in 0..BAND_COUNT {
                for (source, irradiance) in grid.row(band, node).iter().enumerate() {
                    if *irradiance == 0.0 {
                        continue;
                    }
                    for row in 0..ELEVATION_COUNT {
                        for column in 0..AZIMUTH_COUNT {
                            let turned = (column + AZIMUTH_COUNT - source) % AZIMUTH_COUNT;
                            sum[Panorama::index(band, row, column)] +=
                                f64::from(*irradiance) * sky.radiance_w_m2_sr(band, row, turned);
                        }
                    }
                }
            }
        }
        sum
    }

    fn largest_difference(sky: &Panorama, exact: &[f64]) -> f64 {
        let relative = |(value, exact): (&f32, &f64)| (f64::from(*value) / exact - 1.0).abs();
        sky.samples().iter().zip(exact).map(relative).fold(0.0, f64::max)
    }

    fn grid(value: impl FnMut(usize) -> f32) -> BeamGrid {
        BeamGrid::new(NODES, (0..BAND_COUNT * NODES * AZIMUTH_COUNT).map(value).collect()).unwrap()
    }

    /// What transforms add up is the sum of the turned skies, and differs where a beam moves by a column.
    #[test]
    fn transforms_add_up_turned_skies() {
        let twiddles = twiddles();
        let skies = NodeSkies::of(NODES, node_sky, &twiddles);
        let mut noise = Noise::new(5);
        let sparse = grid(|_| if noise.unit() < 0.01 { noise.unit() as f32 } else { 0.0 });
        assert_eq!(sparse.frequency_count(), FREQUENCY_COUNT);
        let exact = direct_sum(&sparse);
        let sky = skies.sky(&sparse, &twiddles).unwrap();
        assert!(largest_difference(&sky, &exact) < 1e-4, "{:e}", largest_difference(&sky, &exact));
        let moved = BeamGrid {
            irradiance: sparse
                .irradiance
                .chunks_exact(AZIMUTH_COUNT)
                .flat_map(|row| row.iter().cycle().skip(1).take(AZIMUTH_COUNT).copied())
                .collect(),
            ..sparse
        };
        assert!(largest_difference(&skies.sky(&moved, &twiddles).unwrap(), &exact) > 1e-2);
    }

    /// Light that is the same at all azimuths takes one frequency and gives the same sky as with all.
    #[test]
    fn even_light_needs_one_frequency() {
        let twiddles = twiddles();
        let skies = NodeSkies::of(NODES, node_sky, &twiddles);
        let even = grid(|at| 1.0 + 0.1 * (at / AZIMUTH_COUNT) as f32);
        assert_eq!(even.frequency_count(), 1);
        let quick = skies.sky(&even, &twiddles).unwrap();
        let all = skies.sky(&BeamGrid { is_even: false, ..even }, &twiddles).unwrap();
        let exact: Vec<f64> = all.samples().iter().map(|value| f64::from(*value)).collect();
        assert!(largest_difference(&quick, &exact) < 1e-5);
        let uneven = grid(|at| if at == 7 { 1.01 } else { 1.0 });
        assert_eq!(uneven.frequency_count(), FREQUENCY_COUNT);
    }

    /// Grids of another length or on other zenith angles give nothing.
    #[test]
    fn grids_fit_their_skies() {
        assert_eq!(BeamGrid::new(NODES, vec![0.0; 5]), None);
        let other = BeamGrid::new(3, vec![0.0; BAND_COUNT * 3 * AZIMUTH_COUNT]).unwrap();
        let twiddles = twiddles();
        assert!(NodeSkies::of(NODES, node_sky, &twiddles).sky(&other, &twiddles).is_none());
    }
}
