//! `skyglow config`: the configuration file.

use crate::{
    failure::Failure,
    flags::{JsonFlags, ServerFlags},
    settings::Layer,
};
use clap::{Args, Subcommand};
use std::path::PathBuf;

/// Check, print or describe the configuration
#[derive(Debug, Args)]
#[command(after_help = "Example:\n  skyglow config print --config skyglow.toml")]
pub(crate) struct Config {
    #[command(subcommand)]
    action: Action,
}

#[derive(Debug, Subcommand)]
enum Action {
    /// Say whether a file can be used
    #[command(after_help = "Example:\n  skyglow config check --config skyglow.toml")]
    Check {
        /// The file
        #[arg(long, env = "SKYGLOW_CONFIG", value_name = "FILE")]
        config: PathBuf,
    },
    /// Print the configuration in force: file, environment and flags together
    #[command(after_help = "Example:\n  SKYGLOW_DEVICE=cpu skyglow config print --config skyglow.toml")]
    Print {
        #[command(flatten)]
        server: ServerFlags,
        /// TOML file to start from
        #[arg(long, env = "SKYGLOW_CONFIG", value_name = "FILE")]
        config: Option<PathBuf>,
        #[command(flatten)]
        json: JsonFlags,
    },
    /// Print the JSON Schema of the file
    #[command(after_help = "Example:\n  skyglow config schema > skyglow.schema.json")]
    Schema,
}

impl Config {
    /// Runs the command.
    pub(crate) fn run(self) -> Result<(), Failure> {
        match self.action {
            Action::Check { config } => {
                Layer::from_file(&config)?;
                println!("{} is correct", config.display());
            }
            Action::Print { server, config, json } => {
                let file = config.as_deref().map(Layer::from_file).transpose()?.unwrap_or_default();
                let settings = server.layer().over(file).settings();
                if json.json {
                    super::print_json(&settings)?;
                } else {
                    print!("{}", toml::to_string(&settings).map_err(Failure::work)?);
                }
            }
            Action::Schema => super::print_json(&schemars::schema_for!(Layer))?,
        }
        Ok(())
    }
}
