//! The `skyglow` command: parses the command line, wires the crates, prints. It holds no logic of its own.
//!
//! Results go to standard output, logs and progress to standard error. Exit status: 0 done, 1 the work failed
//! (one line says why), 2 wrong usage.

mod commands;
mod device;
mod failure;
mod flags;
mod folders;
mod logging;
mod measurements;
mod partial_settings;
mod print;
mod program;
mod progress;
mod query;
mod render;
mod report;
mod settings;
mod table;
mod values;

use clap::{CommandFactory, Parser};
use skyglow_tables::{
    celestial::manifest::{CELESTIAL_FORMAT_VERSION, CELESTIAL_MODEL_VERSION},
    manifest::{FORMAT_VERSION, MODEL_VERSION},
};
use std::{collections::BTreeSet, process::ExitCode, sync::LazyLock};

/// The program, and which packs and celestial tables it reads: those of the same format and of the same model of the air.
static LONG_VERSION: LazyLock<String> = LazyLock::new(|| {
    format!(
        "{}\npacks: format {FORMAT_VERSION}, model {MODEL_VERSION}\ncelestial tables: format \
         {CELESTIAL_FORMAT_VERSION}, model {CELESTIAL_MODEL_VERSION}",
        env!("CARGO_PKG_VERSION")
    )
});

/// The light pollution of the night sky from satellite pictures: what a place's sky looks like, and why.
///
/// Every flag has an environment variable: SKYGLOW_ and its name in capitals (--no-demo is SKYGLOW_NO_DEMO).
/// `serve` and `config` also read a TOML file of the same names; the environment wins over the file, and a
/// flag over both.
#[derive(Debug, Parser)]
#[command(
    name = "skyglow",
    version,
    long_version = LONG_VERSION.as_str(),
    after_help = "Example:\n  skyglow serve\n  then open http://127.0.0.1:8080"
)]
struct CommandLine {
    #[command(subcommand)]
    command: commands::Command,
}

/// Mesa's layer that sorts GPUs for a desktop complains on standard error where there is none, of a variable that servers do not
/// have. Without a desktop there is nothing for it to sort.
fn quiet_mesa() {
    if std::env::var_os("XDG_RUNTIME_DIR").is_none() && std::env::var_os("NODEVICE_SELECT").is_none() {
        #[expect(unsafe_code, reason = "the loader of Vulkan reads its variables from the environment alone")]
        // SAFETY: `main` calls this first, so no other thread runs that could read the environment.
        unsafe {
            std::env::set_var("NODEVICE_SELECT", "1");
        }
    }
}

/// What begins the names of this program's variables.
const OUR_VARIABLES: &str = "SKYGLOW_";
/// And of those of its tests.
const TEST_VARIABLES: &str = "SKYGLOW_TEST_";

/// Variables of the environment that look like this program's and are those of no flag: misspelt, most likely.
fn unknown_variables(names: impl Iterator<Item = String>) -> Vec<String> {
    fn collect(command: &clap::Command, known: &mut BTreeSet<String>) {
        let names = command.get_arguments().filter_map(clap::Arg::get_env);
        known.extend(names.map(|name| name.to_string_lossy().into_owned()));
        command.get_subcommands().for_each(|command| collect(command, known));
    }
    let mut known = BTreeSet::new();
    collect(&CommandLine::command(), &mut known);
    let is_ours = |name: &String| name.starts_with(OUR_VARIABLES) && !name.starts_with(TEST_VARIABLES);
    names.filter(is_ours).filter(|name| !known.contains(name)).collect()
}

fn main() -> ExitCode {
    quiet_mesa();
    if std::env::args_os().nth(1).is_some_and(|argument| argument == program::READ_UPLOAD) {
        return program::read_upload();
    }
    let command_line = CommandLine::parse();
    for name in unknown_variables(std::env::vars_os().filter_map(|(name, _)| name.into_string().ok())) {
        eprintln!("skyglow: the environment variable {name} is that of no flag and does nothing");
    }
    // The server reads first where its traces go.
    if !matches!(command_line.command, commands::Command::Serve(_)) {
        logging::start(command_line.command.default_log_level());
    }
    match command_line.command.run() {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => {
            eprintln!("skyglow: {failure}");
            failure.exit_code()
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_command_line_is_consistent() {
        CommandLine::command().debug_assert();
    }

    #[test]
    fn misspelt_variables_are_found() {
        let names =
            ["SKYGLOW_NO_DEMO", "SKYGLOW_NO_DEMOO", "SKYGLOW_TEST_DATA", "HOME", "SKYGLOW_CLOUD_COVER"];
        assert_eq!(unknown_variables(names.map(str::to_owned).into_iter()), ["SKYGLOW_NO_DEMOO"]);
    }

    #[test]
    fn every_command_shows_an_example() {
        fn check(command: &clap::Command) {
            let help = command.get_after_help().map(ToString::to_string).unwrap_or_default();
            assert!(help.contains("Example"), "{} --help has no example", command.get_name());
            command.get_subcommands().for_each(check);
        }
        check(&CommandLine::command());
    }

    #[test]
    fn every_flag_has_its_environment_variable() {
        fn check(command: &clap::Command) {
            for flag in command.get_arguments().filter(|flag| !flag.is_positional()) {
                let Some(long) = flag.get_long().filter(|long| !["help", "version"].contains(long)) else {
                    continue;
                };
                let wanted = format!("SKYGLOW_{}", long.to_uppercase().replace('-', "_"));
                let env = flag.get_env().map(|name| name.to_string_lossy().into_owned());
                assert_eq!(env.as_deref(), Some(wanted.as_str()), "{} --{long}", command.get_name());
            }
            command.get_subcommands().for_each(check);
        }
        check(&CommandLine::command());
    }

    #[test]
    fn the_commands_are_those_agreed_on() {
        let command_line = CommandLine::command();
        let names: Vec<&str> = command_line.get_subcommands().map(clap::Command::get_name).collect();
        assert_eq!(
            names,
            [
                "serve",
                "ingest",
                "prepare",
                "push",
                "scenes",
                "precompute",
                "packs",
                "panorama",
                "sky",
                "skies",
                "compare",
                "night",
                "nights",
                "influence",
                "shares",
                "darker",
                "horizon",
                "landscape",
                "plan",
                "scenario",
                "kept",
                "atlas",
                "reference",
                "bench",
                "config"
            ]
        );
    }
}
