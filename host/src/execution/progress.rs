//! Progress for people: a bar on everything that takes more than a second, on standard error.

use std::time::Duration;

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};

/// A bar over `length` steps; hidden when standard error is no terminal.
#[must_use]
pub fn bar(length: usize, what: &str) -> ProgressBar {
    let bar =
        ProgressBar::with_draw_target(Some(length as u64), ProgressDrawTarget::stderr_with_hz(4));
    bar.set_style(
        ProgressStyle::with_template("{prefix:24} [{bar:32}] {pos}/{len} {elapsed}<{eta} {msg}")
            .expect("a template of known fields")
            .progress_chars("=> "),
    );
    bar.set_prefix(what.to_owned());
    bar.enable_steady_tick(Duration::from_millis(250));
    bar
}

/// One line for people, above any bar.
pub fn log(line: &str) {
    eprintln!("{line}");
}
