//! How many basis functions a tolerance takes at a real place: the bound that is reported, the difference that there
//! really is to the sky of all functions, and the time.
//!
//! `tolerance DATA_DIR PACKS_DIR SCENE LATITUDE LONGITUDE TURBIDITY`, on the processor.

use skyglow_physics::{EmissionMix, GeoPoint, LampPreset, Turbidity};
use skyglow_render::{
    DeviceChoice, Engine, EngineConfig, RenderRequest, resident_tables, truncation::relative_difference,
};
use skyglow_scene::{SceneId, SceneStore};
use skyglow_tables::{Scattering, packs_in};
use std::{error::Error, path::Path, sync::Arc, time::Instant};

const ROUNDS: usize = 20;

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().collect();
    let [_, data, packs, id, latitude, longitude, turbidity] = arguments.as_slice() else {
        return Err("usage: tolerance DATA_DIR PACKS_DIR SCENE LATITUDE LONGITUDE TURBIDITY".into());
    };
    let scene = SceneStore::new(data).open(&SceneId::parse(id)?)?;
    let place = GeoPoint::from_deg(latitude.parse()?, longitude.parse()?)?;
    let (tables, _) = resident_tables(&packs_in(Path::new(packs))?)?;
    let scattering = tables.iter().map(|tables| tables.scattering).max().unwrap_or(Scattering::Single);
    let request = RenderRequest {
        polar: Arc::new(scene.polar_grid(place, true)),
        observer_altitude_m: scene.ground(place).altitude_m() + 2.0,
        turbidity: Turbidity::new(turbidity.parse()?)?,
        scattering,
        cloud_base_m: None,
        emission: EmissionMix::garstang(),
        flux_per_dnb_flux: LampPreset::Mixed.lamp().flux_per_dnb_flux,
        basis: None,
    };
    let engine = Engine::start(EngineConfig { device: DeviceChoice::Cpu, tables, ..Default::default() })?;
    let all = engine.render_blocking(request.clone())?;
    let chooser = engine.basis_chooser();
    let start = Instant::now();
    chooser.basis_within(&request, 0.5)?;
    println!("norms of the pack: {:.0} ms, once", 1e3 * start.elapsed().as_secs_f64());
    for tolerance in [0.5, 0.2, 0.1, 0.05, 0.02, 0.01, 0.005, 0.001] {
        let mut rounds = Vec::with_capacity(ROUNDS);
        let mut within = chooser.basis_within(&request, tolerance)?;
        let mut sky = all.panorama.clone();
        for _ in 0..ROUNDS {
            let start = Instant::now();
            within = chooser.basis_within(&request, tolerance)?;
            let chosen_s = start.elapsed().as_secs_f64();
            let request = RenderRequest { basis: Some(within.basis_count), ..request.clone() };
            sky = engine.render_blocking(request)?.panorama;
            rounds.push((start.elapsed().as_secs_f64(), chosen_s));
        }
        rounds.sort_by(|a, b| a.0.total_cmp(&b.0));
        let (whole_s, chosen_s) = rounds[ROUNDS / 10];
        println!(
            "tolerance {tolerance}: {} functions, bound {:.4}, difference {:.5}; {:.2} ms, of which choosing {:.2}",
            within.basis_count,
            within.error_bound,
            relative_difference(&all.panorama, &sky),
            1e3 * whole_s,
            1e3 * chosen_s
        );
    }
    Ok(())
}
