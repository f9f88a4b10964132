//! The roofline model (Williams, Waterman and Patterson 2009): the least time of each pass by its bytes and operations.
//!
//! Bytes are those of a pass's input and output, each counted once: what no cache can save. Operations are those of the
//! formula with the functions in use, without the padding of any executor. At the measured rates of the device both become
//! times; the longer one is the least that the pass can take. Tables that stay in a cache from one panorama to the next
//! are read faster than memory is, so that a pass of few operations may come in below the time of its bytes.

use crate::report::ExecutorRecord;
use skyglow_physics::{AZIMUTH_COUNT, BAND_COUNT, ELEVATION_COUNT, Panorama};
use skyglow_render::{TableSet, plan::Pass, prepare::Prepared};
use skyglow_tables::resident::FREQUENCY_COUNT;

/// Bytes of an f32.
const F32: f64 = 4.0;
/// Bytes of a coefficient in the tables.
const F16: f64 = 2.0;
/// Bytes of a listed cell: flux, two nodes, weight.
const CELL: f64 = 16.0;
/// Operations of a real transform of 256 samples: half of 5 N log₂ N.
const TRANSFORM: f64 = 2.5 * 256.0 * 8.0;
/// Operations that an exponential or a logarithm counts as.
const ELEMENTARY: f64 = 10.0;

/// The least work of a pass.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PassRoofline {
    /// The pass.
    pub pass: Pass,
    /// Bytes in and out.
    pub bytes: f64,
    /// Floating-point operations; a multiply-add is two.
    pub operations: f64,
}

impl PassRoofline {
    /// The bytes at the bandwidth of the executor's device, milliseconds.
    pub fn bytes_ms(&self, executor: &ExecutorRecord) -> f64 {
        1e3 * self.bytes / (executor.bandwidth_gb_s * 1e9)
    }

    /// The operations at its rate, milliseconds.
    pub fn operations_ms(&self, executor: &ExecutorRecord) -> f64 {
        1e3 * self.operations / (2.0 * executor.multiply_adds_g_s * 1e9)
    }

    /// The longer of both, milliseconds.
    pub fn ms(&self, executor: &ExecutorRecord) -> f64 {
        self.bytes_ms(executor).max(self.operations_ms(executor))
    }
}

/// The roofline of every pass of a request under an open sky, all its packs together, in the order of the passes.
pub fn of_request(request: &Prepared, set: &TableSet) -> Vec<PassRoofline> {
    let packs = request.turbidity_stencil.nodes();
    let mut passes: Vec<PassRoofline> =
        Pass::ALL.into_iter().map(|pass| PassRoofline { pass, bytes: 0.0, operations: 0.0 }).collect();
    for pack in packs.clone() {
        let functions = request.basis_count.min(set.tables()[pack].basis_count);
        for (pass, (bytes, operations)) in passes.iter_mut().zip(of_pack(request, functions)) {
            pass.bytes += bytes;
            pass.operations += operations;
        }
    }
    if packs.len() > 1 {
        let samples = Panorama::LEN as f64;
        if let Some(blend) = passes.last_mut() {
            blend.bytes = F32 * samples * (packs.len() + 1) as f64;
            blend.operations = samples * ((ELEMENTARY + 4.0) * packs.len() as f64 + ELEMENTARY);
        }
    }
    passes
}

/// All passes together.
pub fn whole(passes: &[PassRoofline]) -> Option<PassRoofline> {
    passes.iter().copied().reduce(|sum, pass| PassRoofline {
        bytes: sum.bytes + pass.bytes,
        operations: sum.operations + pass.operations,
        ..sum
    })
}

/// Bytes and operations of the passes of one pack; none of the blend.
fn of_pack(request: &Prepared, functions: usize) -> [(f64, f64); Pass::ALL.len()] {
    let bands = BAND_COUNT as f64;
    let functions = functions as f64;
    let [nodes, cells, columns] =
        [request.nodes.len(), request.cells.len(), request.columns.len()].map(|count| count as f64);
    let lobes = request.emission.iter().filter(|weight| **weight > 0.0).count() as f64;
    let altitudes = request.altitude_stencil.nodes().len() as f64;
    let shapes = F32 * bands * nodes * functions;
    let sums = F32 * bands * columns * functions;
    let frequencies = FREQUENCY_COUNT as f64;
    let spectra = 2.0 * F32 * bands * functions * frequencies;
    let rows = ELEVATION_COUNT as f64;
    let sky_spectrum = 2.0 * F32 * bands * rows * frequencies;
    [
        (
            bands * nodes * (F32 * lobes * altitudes + 4.0 * F32),
            bands * nodes * (lobes * (2.0 * altitudes + ELEMENTARY) + ELEMENTARY),
        ),
        (
            bands * nodes * functions * F16 * lobes * altitudes + shapes,
            2.0 * bands * nodes * functions * lobes * altitudes,
        ),
        (CELL * cells + F32 * bands * nodes + 2.0 * F32 * bands * cells, bands * cells * (6.0 + ELEMENTARY)),
        (CELL * cells + 2.0 * F32 * bands * cells + shapes + sums, 4.0 * bands * cells * functions),
        (sums + spectra, TRANSFORM * bands * functions),
        (
            F32 * functions * rows * frequencies + spectra + sky_spectrum,
            4.0 * bands * functions * rows * frequencies,
        ),
        (sky_spectrum + F32 * bands * rows * AZIMUTH_COUNT as f64, TRANSFORM * bands * rows),
        (0.0, 0.0),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{executors, options::Setting, scenes::LitScene};

    fn roofline_of(setting: &Setting, cells: usize, turbidity: f64, basis: usize) -> Vec<PassRoofline> {
        let scene = LitScene::of_cells(cells);
        let turbidity = skyglow_physics::Turbidity::new(turbidity).unwrap();
        let request = executors::request(setting, &scene.polar, scene.observer_altitude_m, turbidity, basis);
        of_request(&Prepared::new(&request, &setting.set).unwrap(), &setting.set)
    }

    /// Passes over the sky do not grow with its lights and those over cells do.
    #[test]
    fn only_cell_passes_grow_with_the_lights() {
        let setting = crate::run::tests::setting(16);
        let (few, many) = (roofline_of(&setting, 10, 2.0, 16), roofline_of(&setting, 1_000, 2.0, 16));
        for (few, many) in few.iter().zip(&many) {
            let of_sky = matches!(few.pass, Pass::BasisSum | Pass::InverseFft | Pass::Blend);
            assert_eq!(few == many, of_sky, "{few:?} {many:?}");
        }
        // Bands × 1 000 cells × 16 functions × 2 nodes, a multiply-add each.
        let coefficients = many[Pass::Coefficients.index()].operations;
        assert!((coefficients - 2.0 * (BAND_COUNT * 32_000) as f64).abs() < 1.0, "{coefficients}");
        let half = roofline_of(&setting, 1_000, 2.0, 8)[Pass::Coefficients.index()].operations;
        assert!((half / coefficients - 0.5).abs() < 1e-9);
    }

    /// Between packs all of them are worked on and blended.
    #[test]
    fn between_packs_both_count_and_are_blended() {
        let setting = crate::run::tests::setting(16);
        let (one, between) = (roofline_of(&setting, 10, 2.0, 16), roofline_of(&setting, 10, 2.5, 16));
        assert_eq!(one[Pass::Blend.index()].bytes, 0.0);
        assert!(between[Pass::Blend.index()].bytes > 4.0 * Panorama::LEN as f64);
        assert_eq!(between[Pass::BasisSum.index()].bytes, 2.0 * one[Pass::BasisSum.index()].bytes);
        let executor = ExecutorRecord {
            executor: "cpu".to_owned(),
            adapter: String::new(),
            driver: String::new(),
            resident_bytes: 1,
            bandwidth_gb_s: 10.0,
            multiply_adds_g_s: 50.0,
            read_back_ms: None,
        };
        let pass = PassRoofline { pass: Pass::Blend, bytes: 1e7, operations: 1e9 };
        assert_eq!((pass.bytes_ms(&executor), pass.operations_ms(&executor)), (1.0, 10.0));
        assert_eq!(pass.ms(&executor), 10.0);
    }
}
