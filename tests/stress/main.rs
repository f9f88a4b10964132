//! `make stress`: hunts for NaN, infinity, negative radiance, jumps and lost digits, where they would hide: at the ends
//! of every range, at nodes, at seams and poles, in sums of large and small.
//!
//! Every check prints its worst figure, the limit, and the figure that a planted fault gives, which must exceed the
//! limit. `stress [--only TOPIC]… [--out FILE.json]`; the exit status is 1 where a check failed.

mod bounds;
mod checks;
mod demo;
mod detectors;
mod digits;
mod geotiff;
mod kernel;
mod nodes;
mod passes;
mod places;
mod plain;
mod random;
mod rig;
mod sizes;
mod symmetry;
mod walks;

use checks::{Outcome, Report};
use rig::{Bench, Rig, shipped_tables};
use std::{path::PathBuf, process::ExitCode};

/// A topic by its name.
type Topic = (&'static str, fn(&Bench, &mut Report) -> Outcome);

const TOPICS: &[Topic] = &[
    ("kernel", kernel::run),
    ("passes", passes::run),
    ("digits", digits::run),
    ("bounds", bounds::run),
    ("symmetry", symmetry::run),
    ("places", places::run),
    ("sizes", sizes::run),
    ("random", random::run),
    ("demo", demo::run),
    ("nodes", nodes::run),
    ("walks", walks::run),
];

/// What the command line asks for.
struct Wanted {
    topics: Vec<Topic>,
    out: Option<PathBuf>,
}

fn wanted(arguments: impl Iterator<Item = String>) -> Result<Wanted, String> {
    let mut wanted = Wanted { topics: Vec::new(), out: None };
    let mut arguments = arguments.skip(1);
    while let Some(flag) = arguments.next() {
        let value = arguments.next().ok_or(format!("{flag} needs a value"))?;
        match flag.as_str() {
            "--out" => wanted.out = Some(value.into()),
            "--only" => {
                let topic = TOPICS.iter().find(|(name, _)| *name == value);
                let names: Vec<_> = TOPICS.iter().map(|(name, _)| *name).collect();
                wanted
                    .topics
                    .push(*topic.ok_or(format!("no topic {value}; there are {}", names.join(", ")))?);
            }
            _ => return Err(format!("{flag} is unknown; stress [--only TOPIC]… [--out FILE.json]")),
        }
    }
    if wanted.topics.is_empty() {
        wanted.topics = TOPICS.to_vec();
    }
    Ok(wanted)
}

fn main() -> ExitCode {
    let set_up = || -> Result<(Wanted, Bench), Box<dyn std::error::Error>> {
        let wanted = wanted(std::env::args())?;
        Ok((wanted, Bench { shipped: Rig::of(shipped_tables()?)? }))
    };
    let (wanted, bench) = match set_up() {
        Ok(ready) => ready,
        Err(error) => {
            eprintln!("error: {error}");
            return ExitCode::from(2);
        }
    };
    let mut report = Report::new();
    Report::print_head();
    for (name, run) in &wanted.topics {
        report.run(name, |report| run(&bench, report));
    }
    report.print_summary();
    if let Some(path) = &wanted.out
        && let Err(error) = report.write(path)
    {
        eprintln!("error: {}: {error}", path.display());
        return ExitCode::from(2);
    }
    ExitCode::from(u8::from(report.failed() > 0))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn words(text: &str) -> impl Iterator<Item = String> {
        format!("stress {text}").split_whitespace().map(str::to_owned).collect::<Vec<_>>().into_iter()
    }

    /// Topics are taken by name, and unknown ones are refused.
    #[test]
    fn unknown_topics_are_refused() {
        assert_eq!(wanted(words("")).unwrap().topics.len(), TOPICS.len());
        let one = wanted(words("--only symmetry --out x.json")).unwrap();
        assert_eq!((one.topics[0].0, one.topics.len(), one.out.is_some()), ("symmetry", 1, true));
        assert!(wanted(words("--only poles-of-mars")).is_err());
        assert!(wanted(words("--out")).is_err() && wanted(words("--verbose yes")).is_err());
    }
}
