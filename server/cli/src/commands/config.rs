//! `skyglow config`: the configuration file.

use crate::{failure::Failure, flags::JsonFlags, partial_settings::PartialSettings, print};
use clap::{Args, Subcommand};
use skyglow_http::{Access, ApiKey, access::hash_of};
use std::{
    fs::File,
    io::Read,
    path::{Path, PathBuf},
};

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
        flags: Box<PartialSettings>,
        /// TOML file to start from
        #[arg(long, env = "SKYGLOW_CONFIG", value_name = "FILE")]
        config: Option<PathBuf>,
        #[command(flatten)]
        json: JsonFlags,
    },
    /// Make a key for a known client: prints the key, and what goes into --api-keys-file
    #[command(after_help = "Example:\n  skyglow config key --name city-of-x >> notes.txt")]
    Key {
        /// The client's name in the log
        #[arg(long, env = "SKYGLOW_NAME")]
        name: String,
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
                // The files of secrets that it names are looked at too.
                PartialSettings::default().over_file(Some(&config))?.access()?;
                print::print_line(&format!("{} is correct", config.display()))
            }
            Action::Print { flags, config, json } => {
                let settings = flags.over_file(config.as_deref())?;
                if json.json {
                    print::print_json(&settings)
                } else {
                    print::print_line(toml::to_string(&settings).map_err(Failure::work)?.trim_end())
                }
            }
            Action::Key { name } => {
                let key = random_key()?;
                let entry = ApiKey {
                    name,
                    blake3: hash_of(&key),
                    // More than anybody has without a key.
                    requests_per_second: 200.0,
                    request_burst: 2000,
                    requests_per_day: Some(1_000_000),
                };
                Access::new(None, vec![entry.clone()]).map_err(|error| Failure::Usage(error.to_string()))?;
                let entry = toml::to_string(&entry).map_err(Failure::work)?;
                print::print_line(&format!(
                    "# For the client, and nowhere else: {key}\n[[key]]\n{}",
                    entry.trim_end()
                ))
            }
            Action::Schema => print::print_json(&schemars::schema_for!(PartialSettings)),
        }
    }
}

/// 24 random bytes of the system, hexadecimal.
fn random_key() -> Result<String, Failure> {
    let source = Path::new("/dev/urandom");
    let mut bytes = [0u8; 24];
    File::open(source)
        .and_then(|mut file| file.read_exact(&mut bytes))
        .map_err(|error| Failure::file(source, error))?;
    Ok(bytes.iter().map(|byte| format!("{byte:02x}")).collect())
}
