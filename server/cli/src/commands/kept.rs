//! `skyglow kept`: which scenarios and plans there are.

use crate::{
    failure::Failure,
    flags::{DataFlags, JsonFlags},
    print,
    table::aligned,
};
use clap::Args;
use serde::Serialize;
use skyglow_app::{
    answers::{PlanEntry, ScenarioEntry},
    request::ListRequest,
    stored::{stored_plans, stored_scenarios},
};
use skyglow_scene::{ChangeLimits, ChangeStore, SceneId, SceneStore, Viewer};

/// List the scenarios and plans that are kept of a scene, the newest first
///
/// Each id is taken by every query as --scenario.
#[derive(Debug, Args)]
#[command(after_help = "Example:\n  skyglow kept --scene demo")]
pub(crate) struct Kept {
    /// The scene's id
    #[arg(long, env = "SKYGLOW_SCENE", value_name = "ID", value_parser = SceneId::parse)]
    scene: SceneId,
    #[command(flatten)]
    data: DataFlags,
    #[command(flatten)]
    json: JsonFlags,
}

/// What is printed as JSON.
#[derive(Serialize)]
struct Lists {
    scenarios: Vec<ScenarioEntry>,
    plans: Vec<PlanEntry>,
}

impl Kept {
    /// Runs the command.
    pub(crate) fn run(self) -> Result<(), Failure> {
        let folder = self.data.folder();
        // A scene that is not there is an error, not an empty list.
        SceneStore::new(&folder).open(&self.scene).map_err(Failure::work)?;
        let changes = ChangeStore::new(&folder, ChangeLimits::none());
        let (viewer, all) = (Viewer::Operator, ListRequest { limit: usize::MAX, after: None });
        let scenarios =
            stored_scenarios(&changes, &self.scene, &viewer, &all).map_err(Failure::work)?.entries;
        let plans = stored_plans(&changes, &self.scene, &viewer, &all).map_err(Failure::work)?.entries;
        if self.json.json {
            return print::print_json(&Lists { scenarios, plans });
        }
        let painted = scenarios.iter().map(|entry| {
            let title = entry.title.as_deref().unwrap_or("no title");
            vec![
                entry.id.clone(),
                entry.created.clone(),
                format!("{title}, {}", counted(entry.edit_count, "edit")),
            ]
        });
        let planned = plans.iter().map(|entry| {
            let share = 100.0 * entry.flux_removed_share;
            let sites = counted(entry.site_count, "site");
            let what = format!("{}, {sites}, {share:.2} % of the flux goes", entry.method);
            vec![entry.id.clone(), entry.created.clone(), what]
        });
        let rows: Vec<Vec<String>> = painted.chain(planned).collect();
        if rows.is_empty() {
            return print::print_line(&format!("nothing is kept of {}", self.scene));
        }
        print::print_line(aligned(&rows).trim_end())
    }
}

/// `1 site`, `2 sites`.
fn counted(count: usize, word: &str) -> String {
    format!("{count} {word}{}", if count == 1 { "" } else { "s" })
}

#[cfg(test)]
mod tests {
    use super::counted;

    #[test]
    fn one_is_no_plural() {
        assert_eq!([0, 1, 2].map(|count| counted(count, "site")), ["0 sites", "1 site", "2 sites"]);
    }
}
