//! The skies of a run whose reference is known.

use crate::{
    error::BenchError,
    options::{BenchOptions, Setting},
    reference::{self, ReferenceSky},
    scenes::LitScene,
};
use skyglow_scene::{DEMO_ID, Scene, SceneError, SceneId, SceneStore, create_demo, demo_is_wanted};
use std::path::Path;

/// Places of the demo whose first-order reference is computed: a town, the Alps, the sea. Degrees.
const DEMO_PLACES_DEG: [[f64; 2]; 3] = [[46.17, 8.79], [47.41, 10.27], [42.63, 7.07]];
/// Most directions there: each is an integral for every pixel of the demo.
const DEMO_DIRECTIONS: usize = 64;

/// Skies with a reference: the made-up scene of most cells, the raster of fewest pixels, and places of the demo. What was left out
/// is noted.
///
/// # Errors
/// Reference files that are none, a demo that cannot be made, altitudes beyond the solver's.
pub(crate) fn of_run(
    options: &BenchOptions,
    setting: &Setting,
    lit: &[LitScene],
    notes: &mut Vec<String>,
) -> Result<Vec<ReferenceSky>, BenchError> {
    let directions = options.extent.reference_directions;
    let mut skies = Vec::new();
    if directions == 0 {
        return Ok(skies);
    }
    let of = |name: &'static str| lit.iter().filter(move |scene| scene.name == name);
    let max_cells = of("cells").max_by_key(|scene| scene.lit_sources);
    let fewest_pixels = of("raster").min_by_key(|scene| scene.lit_sources);
    for scene in max_cells.into_iter().chain(fewest_pixels) {
        tracing::info!("reference of {} {}", scene.name, scene.lit_sources);
        skies.push(reference::of_scene(setting, scene, directions)?);
    }
    if options.reference_files.is_empty() && !setting.is_first_order() {
        notes.push(
            "errors of the demo with all orders were left out: no reference files were given".to_owned(),
        );
        return Ok(skies);
    }
    let temporary = tempfile::tempdir().map_err(BenchError::file(&std::env::temp_dir()))?;
    let demo = demo(&options.data, temporary.path())?;
    for path in &options.reference_files {
        let stored = reference::of_file(setting, &demo, path)?;
        if stored.is_empty() {
            let path = path.display();
            notes.push(format!("{path}: its orders of scattering or turbidities are not those of the packs"));
        }
        skies.extend(stored);
    }
    if setting.is_first_order() {
        for place in DEMO_PLACES_DEG {
            tracing::info!("reference of the demo at {place:?}");
            skies.push(reference::of_place(setting, &demo, place, directions.min(DEMO_DIRECTIONS))?);
        }
    }
    Ok(skies)
}

/// The demo of a store, or one made in another folder where that has none.
fn demo(data: &Path, other: &Path) -> Result<Scene, SceneError> {
    let id = SceneId::parse(DEMO_ID)?;
    let store = SceneStore::new(data);
    if !demo_is_wanted(&store) {
        let stored = store.open(&id)?;
        // Somebody else's scene of that name is not the demo.
        if stored.metadata().illustrative {
            return Ok(stored);
        }
    }
    tracing::info!("making the demo for this run");
    let store = SceneStore::new(other);
    create_demo(&store, &mut |_| ())?;
    store.open(&id)
}
