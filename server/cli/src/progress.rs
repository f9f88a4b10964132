//! Progress bars with the time left, on standard error; none where that is not a terminal.

use indicatif::{ProgressBar, ProgressStyle};

/// A bar of `length` steps headed by `what`.
pub(crate) fn bar(what: &str, length: u64) -> ProgressBar {
    let style = ProgressStyle::with_template(
        "{prefix} [{bar:30}] {percent:>3} % {msg} {elapsed} gone, {eta} left",
    )
    .unwrap_or_else(|_| ProgressStyle::default_bar());
    ProgressBar::new(length).with_style(style.progress_chars("=> ")).with_prefix(what.to_owned())
}
