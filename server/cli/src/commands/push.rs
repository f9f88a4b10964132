//! `skyglow push`: a scene for all servers over a store.

use crate::{failure::Failure, flags::DataFlags, print, settings::open_store};
use clap::Args;
use skyglow_scene::{SceneId, SceneStore, SharedScenes};

/// Put a scene into the store that servers share
///
/// Every server over the store copies it within seconds, in place of the one of that id. What a server is given by PUT goes there by
/// itself, and DELETE removes it for all. Credentials are those of the environment (`AWS_…`, `GOOGLE_…`, `AZURE_…`).
#[derive(Debug, Args)]
#[command(after_help = "Example:\n  skyglow push world --store s3://skyglow/production")]
pub(crate) struct Push {
    /// The scene's id
    #[arg(env = "SKYGLOW_SCENE", value_name = "SCENE", value_parser = SceneId::parse)]
    scene: SceneId,
    /// The store: s3://BUCKET/PREFIX, gs://BUCKET/PREFIX, az://CONTAINER/PREFIX, or file:///FOLDER
    #[arg(long, env = "SKYGLOW_STORE", value_name = "ADDRESS")]
    store: String,
    #[command(flatten)]
    data: DataFlags,
}

impl Push {
    /// Runs the command.
    pub(crate) fn run(self) -> Result<(), Failure> {
        let shared = SharedScenes::new(open_store(&self.store)?);
        shared.put(&SceneStore::new(self.data.folder()), &self.scene, false).map_err(Failure::work)?;
        print::print_line(&format!("{} is at {}", self.scene, self.store))
    }
}
