//! `skyglow scenes`: what is stored.

use crate::{
    failure::Failure,
    flags::{DataFlags, JsonFlags},
    report,
    table::aligned,
};
use clap::Args;
use skyglow_scene::SceneStore;

/// List the scenes, each with the report of its ingest
#[derive(Debug, Args)]
#[command(after_help = "Example:\n  skyglow scenes --json")]
pub(crate) struct Scenes {
    #[command(flatten)]
    data: DataFlags,
    #[command(flatten)]
    json: JsonFlags,
}

impl Scenes {
    /// Runs the command.
    pub(crate) fn run(self) -> Result<(), Failure> {
        let store = SceneStore::new(self.data.folder());
        let scenes = store.list().map_err(Failure::work)?;
        if self.json.json {
            return super::print_json(&scenes);
        }
        if scenes.is_empty() {
            return super::print_line(&format!("no scenes in {}", store.scenes_dir().display()));
        }
        for scene in &scenes {
            super::print_line(&format!("{} ({})", scene.id, scene.title))?;
            super::print_line(aligned(&report::rows(scene)).trim_end())?;
        }
        Ok(())
    }
}
