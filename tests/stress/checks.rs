//! What a check found, and the table of them all.

use serde::Serialize;
use std::{error::Error, io::Write, path::Path, time::Instant};

/// What a topic answers: whether its checks could be made, not whether they passed.
pub(crate) type Outcome = Result<(), Box<dyn Error>>;

/// One named check.
#[derive(Clone, Debug, Serialize)]
pub(crate) struct Check {
    /// The file it is in.
    topic: &'static str,
    /// What was looked at.
    name: String,
    /// How many cases.
    cases: u64,
    /// The worst figure among them.
    worst: f64,
    /// The largest that passes.
    limit: f64,
    /// The same figure with a fault planted: it must exceed the limit, or the check could not fail.
    control: f64,
    /// What the figure is.
    figure: &'static str,
    /// Where the worst was, or what else is to know.
    note: String,
    /// Whether it passed.
    passed: bool,
}

impl Check {
    /// A check of `cases` cases whose worst `figure` may reach `limit`, and exceeds it with the fault of `control`.
    pub(crate) fn new(name: impl Into<String>, figure: &'static str, cases: usize) -> Self {
        Self {
            topic: "",
            name: name.into(),
            cases: cases as u64,
            worst: f64::NAN,
            limit: f64::NAN,
            control: f64::NAN,
            figure,
            note: String::new(),
            passed: false,
        }
    }

    /// What was found, what may be, and what a planted fault gives.
    pub(crate) fn found(self, worst: f64, limit: f64, control: f64) -> Self {
        // Comparisons with a NaN are false: what was not measured does not pass.
        let passed = worst <= limit && control > limit && self.cases > 0;
        Self { worst, limit, control, passed, ..self }
    }

    /// Adds words.
    pub(crate) fn note(self, note: impl Into<String>) -> Self {
        Self { note: note.into(), ..self }
    }

    fn line(&self) -> String {
        let verdict = match (self.passed, self.control > self.limit) {
            (true, _) => "ok",
            (false, true) => "FAILED",
            (false, false) => "CANNOT FAIL",
        };
        let note = if self.note.is_empty() { String::new() } else { format!("  ({})", self.note) };
        format!(
            "{:<10} {:<74} {:>9} {:>9.2e} {:>9.2e} {:>9.2e}  {verdict}  {}{note}",
            self.topic, self.name, self.cases, self.worst, self.limit, self.control, self.figure
        )
    }
}

/// All checks of a run.
#[derive(Debug, Serialize)]
pub(crate) struct Report {
    checks: Vec<Check>,
    seconds: Vec<(&'static str, f64)>,
    #[serde(skip)]
    topic: &'static str,
}

impl Report {
    /// Nothing yet.
    pub(crate) fn new() -> Self {
        Self { checks: Vec::new(), seconds: Vec::new(), topic: "" }
    }

    /// Prints the head of the table.
    pub(crate) fn print_head() {
        println!(
            "{:<10} {:<74} {:>9} {:>9} {:>9} {:>9}  verdict  figure",
            "topic", "check", "cases", "worst", "limit", "planted"
        );
    }

    /// Runs a topic under its name; a topic that cannot be run fails as a check.
    pub(crate) fn run(&mut self, topic: &'static str, run: impl FnOnce(&mut Self) -> Outcome) {
        self.topic = topic;
        let start = Instant::now();
        if let Err(error) = run(self) {
            self.add(Check::new("can be run", "failures", 1).found(1.0, 0.0, 1.0).note(error.to_string()));
        }
        self.seconds.push((topic, start.elapsed().as_secs_f64()));
    }

    /// Takes a check in and prints its line.
    pub(crate) fn add(&mut self, check: Check) {
        let check = Check { topic: self.topic, ..check };
        println!("{}", check.line());
        // The line is there to be watched; where stdout is gone the exit status still tells.
        let _ = std::io::stdout().flush();
        self.checks.push(check);
    }

    /// How many checks failed.
    pub(crate) fn failed(&self) -> usize {
        self.checks.iter().filter(|check| !check.passed).count()
    }

    /// Prints what took how long, and what failed once more.
    pub(crate) fn print_summary(&self) {
        println!();
        for (topic, seconds) in &self.seconds {
            println!("{topic:<10} {seconds:>8.1} s");
        }
        let all: f64 = self.seconds.iter().map(|(_, seconds)| seconds).sum();
        let cases: u64 = self.checks.iter().map(|check| check.cases).sum();
        println!("{} checks of {cases} cases in {all:.0} s; {} failed", self.checks.len(), self.failed());
        for check in self.checks.iter().filter(|check| !check.passed) {
            println!("{}", check.line());
        }
    }

    /// Writes everything as JSON. A figure that is no finite number becomes null.
    pub(crate) fn write(&self, path: &Path) -> Outcome {
        std::fs::write(path, serde_json::to_string_pretty(self)? + "\n")?;
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn check(worst: f64, limit: f64, control: f64) -> Check {
        Check::new("one", "error", 1).found(worst, limit, control)
    }

    /// A check passes within its limit where the planted fault exceeds it.
    #[test]
    fn a_check_needs_its_fault_above_the_limit() {
        assert!(check(1.0, 2.0, 3.0).passed && check(0.0, 0.0, 1.0).passed);
        assert!(!check(2.1, 2.0, 3.0).passed);
        assert!(!check(1.0, 2.0, 1.5).passed, "a check that cannot fail");
        assert!(!check(f64::NAN, 2.0, 3.0).passed && !check(1.0, 2.0, f64::NAN).passed);
        assert!(!Check::new("none", "error", 0).found(0.0, 1.0, 2.0).passed, "no cases are no proof");
    }

    #[test]
    fn a_topic_that_cannot_be_run_fails() {
        let mut report = Report::new();
        report.run("broken", |_| Err("no such device".into()));
        report.run("sound", |report| {
            report.add(check(0.0, 1.0, 2.0));
            Ok(())
        });
        assert_eq!((report.failed(), report.checks.len()), (1, 2));
        assert!(report.checks[0].note.contains("no such device"));
        assert_eq!(report.checks[1].topic, "sound");
    }
}
