//! Packs in which all passes but one have nothing to do, so that what comes out shows that one's rounding.
//!
//! As made, a pack of `plain` has scale 1, no shapes and a black basis. A basis function whose spectrum is 256 at frequency
//! 0 is 1 in every column; one whose spectrum is 1 at every frequency is 1 at the lit column and 0 elsewhere.

use half::f16;
use skyglow_physics::{AZIMUTH_COUNT, BAND_COUNT, ELEVATION_COUNT, LOBE_COUNT};
use skyglow_render::synthetic;
use skyglow_scene::{RING_COUNT, ring_distance_m};
use skyglow_tables::{OffsetAxis, ResidentTables, Scattering, resident::FREQUENCY_COUNT};

/// Observer altitudes of plain packs, metres.
pub(crate) const ALTITUDES_M: [f64; 4] = [0.0, 700.0, 1_900.0, 6_000.0];
/// Nodes of their offset axis.
pub(crate) const OFFSET_COUNT: usize = 5;

/// A pack of scale 1, without shapes, over a black basis.
pub(crate) fn tables(turbidity: f64, basis_count: usize) -> ResidentTables {
    let ring_distance_m: Vec<f64> = (0..RING_COUNT).map(ring_distance_m).collect();
    let nodes = ALTITUDES_M.len() * LOBE_COUNT * BAND_COUNT * RING_COUNT * OFFSET_COUNT;
    ResidentTables {
        turbidity,
        scattering: Scattering::Single,
        clouds: None,
        checksum: format!("plain-{:016x}", turbidity.to_bits() ^ basis_count as u64),
        is_synthetic: true,
        observer_altitude_m: ALTITUDES_M.to_vec(),
        offset_count: OFFSET_COUNT,
        offset_axis: ring_distance_m
            .iter()
            .map(|distance_m| OffsetAxis::at_distance(*distance_m, OFFSET_COUNT))
            .collect(),
        ring_distance_m,
        basis_count,
        log_scale: vec![0.0; nodes],
        shape: vec![f16::ZERO; nodes * basis_count],
        basis_spectrum: vec![0.0; basis_count * ELEVATION_COUNT * FREQUENCY_COUNT],
        blocked: None,
    }
}

/// Makes function `k` the value `of_row` in every column of each row.
pub(crate) fn make_uniform(tables: &mut ResidentTables, k: usize, of_row: impl Fn(usize) -> f64) {
    for row in 0..ELEVATION_COUNT {
        let at = tables.spectrum_index(k, row, 0);
        tables.basis_spectrum[at] = (AZIMUTH_COUNT as f64 * of_row(row)) as f32;
    }
}

/// Makes function `k` 1 towards the lit column and 0 elsewhere, in every row.
pub(crate) fn make_needle(tables: &mut ResidentTables, k: usize) {
    for row in 0..ELEVATION_COUNT {
        let at = tables.spectrum_index(k, row, 0);
        tables.basis_spectrum[at..at + FREQUENCY_COUNT].fill(1.0);
    }
}

/// Gives every coefficient `of` its place on the offset axis and its function.
pub(crate) fn fill_shape(tables: &mut ResidentTables, mut of: impl FnMut(usize, usize) -> f64) {
    let count = tables.basis_count;
    let node = ALTITUDES_M.len() * LOBE_COUNT * BAND_COUNT * count;
    for (position, value) in tables.shape.iter_mut().enumerate() {
        *value = f16::from_f64(of(position / node % OFFSET_COUNT, position % count));
    }
}

/// Gives every node a logarithm of the scale between the two.
pub(crate) fn fill_scale(tables: &mut ResidentTables, seed: u64, low: f64, high: f64) {
    let mut noise = synthetic::Noise::new(seed);
    tables.log_scale.iter_mut().for_each(|value| *value = (low + (high - low) * noise.unit()) as f32);
}
