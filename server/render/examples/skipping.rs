//! What is left out of a rendering, on and off: `cargo run --release -p skyglow-engine --example skipping`.
//!
//! Arguments: lit cells (30000), basis functions (64), rounds (100). On the processor, made-up tables and light.

use skyglow_physics::{EmissionMix, Lamp, LampPreset, Turbidity};
use skyglow_render::{DeviceChoice, Engine, EngineConfig, RenderRequest, synthetic};
use skyglow_scene::PolarGrid;
use skyglow_tables::Scattering;
use std::{error::Error, sync::Arc, time::Instant};

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let number = |position: usize, default: usize| {
        arguments.get(position).and_then(|text| text.parse().ok()).unwrap_or(default)
    };
    let (lit_cells, basis_count, rounds) = (number(0, 30_000), number(1, 64), number(2, 100));
    let tables = synthetic::table_set(&[1.5, 2.0, 3.0, 4.0], basis_count);
    let engine = Engine::start(EngineConfig { device: DeviceChoice::Cpu, tables, ..Default::default() })?;
    let grid = synthetic::polar_grid(1, lit_cells);
    let request = |grid: &PolarGrid| -> Result<RenderRequest, Box<dyn Error>> {
        Ok(RenderRequest {
            polar: Arc::new(grid.clone()),
            observer_altitude_m: 1661.0,
            turbidity: Turbidity::new(2.0)?,
            scattering: Scattering::Single,
            cloud_base_m: None,
            emission: EmissionMix::new([0.5, 0.3, 0.2])?,
            flux_per_dnb_flux: LampPreset::Mixed.lamp().flux_per_dnb_flux,
            basis: None,
        })
    };
    let all = request(&grid)?;
    let sodium: Lamp = LampPreset::Lps.lamp();
    let cases = [
        ("all of it", all.clone()),
        ("half the azimuths dark", request(&darkened(&grid, |azimuth, _| azimuth < 128))?),
        ("dark beyond ring 96, 8.8 km", request(&darkened(&grid, |_, ring| ring < 96))?),
        ("one band", RenderRequest { flux_per_dnb_flux: sodium.flux_per_dnb_flux, ..all.clone() }),
        ("one lobe", RenderRequest { emission: EmissionMix::new([1.0, 0.0, 0.0])?, ..all.clone() }),
        ("observer at a table's altitude", RenderRequest { observer_altitude_m: 1200.0, ..all.clone() }),
        ("a quarter of the functions", RenderRequest { basis: Some(basis_count / 4), ..all.clone() }),
        ("between turbidities", RenderRequest { turbidity: Turbidity::new(2.4)?, ..all.clone() }),
        ("no light", request(&synthetic::dark_grid())?),
    ];
    println!("{lit_cells} lit cells, {basis_count} functions, fastest tenth of {rounds} rounds");
    for (name, request) in cases {
        let mut whole_s = Vec::with_capacity(rounds);
        let mut work = None;
        for _ in 0..rounds {
            let start = Instant::now();
            let rendered = engine.render_blocking(request.clone())?;
            whole_s.push(start.elapsed().as_secs_f64());
            work = Some(rendered.work);
        }
        whole_s.sort_by(f64::total_cmp);
        println!("{name}: {:.2} ms, {work:?}", 1e3 * whole_s[rounds / 10]);
    }
    Ok(())
}

/// The grid with light only where `keep` says so of (azimuth, ring).
fn darkened(grid: &PolarGrid, keep: impl Fn(usize, u32) -> bool) -> PolarGrid {
    let mut dark = grid.clone();
    for (azimuth, column) in grid.azimuth_start.windows(2).enumerate() {
        let cells = &mut dark.cells[column[0] as usize..column[1] as usize];
        for cell in cells.iter_mut().filter(|cell| !keep(azimuth, cell.ring)) {
            cell.flux_dnb_w = 0.0;
        }
    }
    dark
}
