//! `skyglow scenes`: what is stored.

use crate::{
    failure::Failure,
    flags::{DataFlags, JsonFlags},
    print, report,
    table::aligned,
};
use clap::Args;
use skyglow_scene::{SceneList, SceneStore};

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
    /// Runs the command. A damaged scene is an error, after all others are listed.
    pub(crate) fn run(self) -> Result<(), Failure> {
        let store = SceneStore::new(self.data.folder());
        let SceneList { scenes, mut damaged } = store.list().map_err(Failure::work)?;
        let outcome = if damaged.is_empty() { Ok(()) } else { Err(Failure::work(damaged.swap_remove(0))) };
        if self.json.json {
            print::print_json(&scenes)?;
            return outcome;
        }
        if scenes.is_empty() && outcome.is_ok() {
            return print::print_line(&format!("no scenes in {}", store.scenes_dir().display()));
        }
        for scene in &scenes {
            print::print_line(&format!("{} ({})", scene.id, scene.title))?;
            print::print_line(aligned(&report::rows(scene)).trim_end())?;
        }
        outcome
    }
}
