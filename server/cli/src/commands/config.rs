//! `skyglow config`: the configuration file.

use crate::{failure::Failure, flags::JsonFlags, settings::Layer};
use clap::{Args, Subcommand};
use std::path::PathBuf;

/// Check, print or describe the configuration of the server
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
        flags: Box<Layer>,
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
                Layer::default().over_file(Some(&config))?;
                super::print_line(&format!("{} is correct", config.display()))
            }
            Action::Print { flags, config, json } => {
                let settings = flags.over_file(config.as_deref())?;
                if json.json {
                    super::print_json(&settings)
                } else {
                    super::print_line(toml::to_string(&settings).map_err(Failure::work)?.trim_end())
                }
            }
            Action::Schema => super::print_json(&schemars::schema_for!(Layer)),
        }
    }
}
