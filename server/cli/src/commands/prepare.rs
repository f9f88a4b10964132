//! `skyglow prepare`: what a scene would find out when places first need it.

use crate::{
    failure::Failure,
    flags::{Bounds, DataFlags, JsonFlags, bounds},
    print,
    progress::Stages,
};
use clap::Args;
use skyglow_scene::{SceneId, SceneStore};

/// Find what terrain hides of each light, for a scene that has it found when places first need it
///
/// It is kept beside the scene, so that the first click anywhere within the bounds is as fast as the next. Interrupted, it goes on
/// where it was.
#[derive(Debug, Args)]
#[command(after_help = "Example:\n  skyglow prepare world --bounds 5,44,12,48")]
pub(crate) struct Prepare {
    /// The scene's id
    #[arg(env = "SKYGLOW_SCENE", value_name = "SCENE", value_parser = SceneId::parse)]
    scene: SceneId,
    /// West, south, east and north of the places to prepare for, degrees; lights within 300 km of them count [default: all of the scene]
    #[arg(long, env = "SKYGLOW_BOUNDS", value_name = "W,S,E,N", value_parser = bounds, allow_hyphen_values = true)]
    bounds: Option<Bounds>,
    #[command(flatten)]
    data: DataFlags,
    #[command(flatten)]
    json: JsonFlags,
}

impl Prepare {
    /// Runs the command.
    pub(crate) fn run(self) -> Result<(), Failure> {
        let scene = SceneStore::new(self.data.folder()).open(&self.scene).map_err(Failure::work)?;
        let stages = Stages::new();
        let mut has_begun = false;
        let prepared = scene.prepare_skylines(self.bounds, &mut |done, total| {
            if !has_begun {
                has_begun = true;
                stages.begin("skylines of lights", total);
            }
            stages.set(done);
        });
        drop(stages);
        let prepared = prepared.map_err(Failure::work)?;
        if self.json.json {
            return print::print_json(&prepared);
        }
        let text = match prepared.tiles {
            0 => "nothing to prepare: what the scene needs there is in its files".to_owned(),
            tiles => format!(
                "{tiles} tiles with {} lights are ready, {} of them made now",
                prepared.lights, prepared.made
            ),
        };
        print::print_line(&text)
    }
}
