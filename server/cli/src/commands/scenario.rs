//! `skyglow scenario`: paints over a scene.

use crate::{failure::Failure, flags::DataFlags, print, query};
use clap::Args;
use skyglow_app::{answers::ScenarioAnswer, request};
use skyglow_observatory::{ScenarioRecord, store_scenario};
use skyglow_scene::SceneId;
use std::{
    path::PathBuf,
    time::{SystemTime, UNIX_EPOCH},
};

/// Paint over a scene: dim, brighten or add lights, replace lamps; needs no packs
///
/// The changes are a JSON file as POST /api/v1/scenes/ID/scenarios takes it. The scenario is kept beside the scenes; its id is
/// taken by every query as --scenario. What it does to the scene is printed as JSON.
#[derive(Debug, Args)]
#[command(after_help = "Example:\n  \
    echo '{\"edits\": [{\"brush\": {\"points\": [[8.79, 46.17]], \"radius_m\": 5000}, \"lamp\": \"pc_amber\"}]}' > changes.json\n  \
    skyglow scenario --scene demo --changes changes.json")]
pub(crate) struct Scenario {
    /// The scene's id
    #[arg(long, env = "SKYGLOW_SCENE", value_name = "ID", value_parser = SceneId::parse)]
    scene: SceneId,
    /// JSON file that says what is painted where
    #[arg(long, env = "SKYGLOW_CHANGES", value_name = "FILE")]
    changes: PathBuf,
    #[command(flatten)]
    data: DataFlags,
}

impl Scenario {
    /// Runs the command.
    pub(crate) fn run(self) -> Result<(), Failure> {
        let body = std::fs::read(&self.changes).map_err(|error| Failure::file(&self.changes, error))?;
        let (scenario, _) =
            request::scenario(None, &body, self.scene.clone()).map_err(|error| query::failure(&error))?;
        let (id, summary, scene) =
            store_scenario(&self.data.folder(), &scenario).map_err(|error| query::failure(&error.into()))?;
        let now_s = SystemTime::now().duration_since(UNIX_EPOCH).map_or(0, |since| since.as_secs());
        let record = ScenarioRecord { scenario, summary, scene, created_unix_s: now_s };
        print::print_json(&ScenarioAnswer::new(&id, &record))
    }
}
