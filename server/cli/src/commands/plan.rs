//! `skyglow plan`: what to dim for the sky of a place, kept beside the scenes and written to a file.

use super::influence::{Output, output};
use crate::{
    failure::Failure,
    flags::ProgramFlags,
    print,
    query::{self, QueryFlags},
};
use clap::Args;
use skyglow_app::{
    SkySource,
    facts::SourceFacts,
    parameters::PlanParameters,
    plan_file::encode_plan,
    planning::{make_plan, prepare_plan},
    request::{self, PlanStoreRequest},
};
use skyglow_scene::{Posting, SceneId};
use std::path::PathBuf;

/// Make a reduction plan: what to dim, with the sky before and after
///
/// The request is a JSON file as POST /api/v1/scenes/ID/plans takes it. The plan is kept beside the scenes; its id, which is
/// printed, is taken by every query as --scenario.
#[derive(Debug, Args)]
#[command(after_help = "Example:\n  \
    echo '{\"method\": \"target\", \"sites\": [{\"lat\": 46.53, \"lon\": 8.61, \"reduce_by\": 0.3}]}' > request.json\n  \
    skyglow plan --scene demo --request request.json -o plan.tif")]
pub(crate) struct Plan {
    /// The scene's id
    #[arg(long, env = "SKYGLOW_SCENE", value_name = "ID", value_parser = SceneId::parse)]
    scene: SceneId,
    /// JSON file that says for whose sake what may be dimmed
    #[arg(long, env = "SKYGLOW_REQUEST", value_name = "FILE")]
    request: PathBuf,
    /// File to write; its ending says the format: .tif for all pixels, .json, .geojson or .csv for those with the most effect
    #[arg(short, long, env = "SKYGLOW_OUTPUT", value_name = "FILE", value_parser = output)]
    output: Output,
    #[command(flatten)]
    query: QueryFlags<PlanParameters>,
    #[command(flatten)]
    program: ProgramFlags,
}

impl Plan {
    /// Runs the command.
    pub(crate) fn run(self) -> Result<(), Failure> {
        let body = std::fs::read(&self.request).map_err(|error| Failure::file(&self.request, error))?;
        self.request(&body, &self.program.facts())?;
        let source = self.program.source()?;
        let source: &dyn SkySource = source.as_ref();
        let request = self.request(&body, source.facts())?;
        let failure = |error| query::failure(&error);
        let view = prepare_plan(source, &request).map_err(failure)?;
        let (plan, _) =
            make_plan(source, &request, &view, &Posting::default(), &|_| true).map_err(failure)?;
        let bytes = encode_plan(&plan, request.limit, self.output.format).map_err(Failure::work)?;
        let path = &self.output.path;
        std::fs::write(path, bytes).map_err(|error| Failure::file(path, error))?;
        print::print_line(plan.id.as_str())
    }

    fn request(&self, body: &[u8], facts: &SourceFacts) -> Result<PlanStoreRequest, Failure> {
        request::plan(Some(self.query.query()), body, self.scene.clone(), facts)
            .map_err(|error| query::failure(&error))
    }
}
