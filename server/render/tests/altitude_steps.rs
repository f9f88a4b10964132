//! What it costs in exactness that the CPU executor has shapes a quadratic between steps of altitude, by packs that come with the
//! program.
#![allow(clippy::unwrap_used, reason = "a test that cannot be set up fails")]

use skyglow_physics::Turbidity;
use skyglow_render::{
    DeviceChoice, Engine, EngineConfig, RenderRequest, TableSet, cpu::CpuExecutor, prepare::Prepared,
    resident_tables, synthetic,
};
use skyglow_tables::Scattering;
use std::path::Path;

/// A quarter of the way between two altitudes of the tables, where it is worst, a sky is the one that is mixed for its very altitude
/// within 0.01 % in the mean and 0.06 % in 99 of 100 directions.
#[test]
fn steps_of_altitude_cost_little() {
    let packs = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../precomputed");
    for turbidity in ["2.50", "6.00"] {
        let pack = packs.join(format!("turbidity-{turbidity}-multiple.skyglow"));
        let tables = resident_tables(&[pack]).unwrap().0;
        let set = TableSet::new(tables.clone()).unwrap();
        let exact = CpuExecutor::new(set.clone());
        let config = EngineConfig { device: DeviceChoice::Cpu, tables, ..EngineConfig::default() };
        let engine = Engine::start(config).unwrap();
        // The tables have 0, 300, 700, 1 200, 1 800, 2 600 and 3 600 m.
        for (observer_altitude_m, lit_cells) in
            [(2.0, 300), (75.0, 300), (225.0, 3_000), (800.0, 3_000), (1_350.0, 300), (2_850.0, 300)]
        {
            let polar = synthetic::polar_grid_with_skylines(7, lit_cells);
            let request = synthetic::request(polar, Turbidity::new(turbidity.parse().unwrap()).unwrap());
            let request = RenderRequest { observer_altitude_m, scattering: Scattering::Multiple, ..request };
            let exact = exact.sky(&Prepared::new(&request, &set).unwrap(), 0, true);
            let stepped = engine.render_blocking(request).unwrap().panorama;
            let floor = 1e-2 * exact.iter().sum::<f32>() / exact.len() as f32;
            let mut errors: Vec<f32> = exact
                .iter()
                .zip(stepped.samples())
                .map(|(exact, stepped)| (stepped - exact).abs() / exact.max(floor))
                .collect();
            errors.sort_by(f32::total_cmp);
            let mean = errors.iter().sum::<f32>() / errors.len() as f32;
            let [p99, worst] = [errors.len() * 99 / 100, errors.len() - 1].map(|place| errors[place]);
            println!(
                "T = {turbidity}, {observer_altitude_m} m: mean {mean:.1e}, 99 % {p99:.1e}, worst {worst:.1e}"
            );
            assert!(mean < 1e-4 && p99 < 6e-4, "{observer_altitude_m} m: {mean} {p99}");
            // It is another sky: the check can fail.
            assert!(observer_altitude_m == 2.0 || worst > 1e-6);
        }
    }
}
