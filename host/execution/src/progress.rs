//! Progress on standard error: bars and log lines; parallel work with a bar.

use std::error::Error;
use std::io::{self, Write as _};
use std::iter;
use std::time::Duration;

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use rayon::prelude::*;

use crate::interrupt::Interrupt;
use crate::printable::{printable, printable_lines};
use crate::run_folder::{RunError, RunFolder};

/// A progress bar of `length` steps, hidden when standard error is not a terminal.
pub fn bar(length: usize, what: &str) -> ProgressBar {
    let template = "{prefix:24} [{bar:32}] {pos}/{len} {elapsed}<{eta} {msg}";
    let bar = styled(Some(length as u64), template, what);
    bar.enable_steady_tick(Duration::from_millis(250));
    bar
}

/// A progress bar of bytes, of a number that may be unknown; hidden when standard error is not a terminal.
pub fn bytes(length: Option<u64>, what: &str) -> ProgressBar {
    let template = match length {
        Some(_) => "{prefix:24} [{bar:32}] {bytes}/{total_bytes} {bytes_per_sec} {eta}",
        None => "{prefix:24} {bytes} {bytes_per_sec} {elapsed}",
    };
    styled(length, template, what)
}

/// A progress bar of a template.
///
/// # Panics
/// Never: the templates are constants.
fn styled(length: Option<u64>, template: &str, what: &str) -> ProgressBar {
    let bar = ProgressBar::with_draw_target(length, ProgressDrawTarget::stderr_with_hz(4));
    let style = ProgressStyle::with_template(template).expect("a template of known fields");
    bar.set_style(style.progress_chars("=> "));
    bar.set_prefix(printable(what));
    bar
}

/// Message of an error and of its causes, each once: some messages quote their cause, because a page shows them alone.
pub fn with_causes(error: &(dyn Error + 'static)) -> String {
    let causes = iter::successors(error.source(), |&cause| cause.source());
    causes.fold(error.to_string(), |said, cause| {
        let cause = cause.to_string();
        if said.contains(&cause) {
            said
        } else {
            format!("{said}: {cause}")
        }
    })
}

/// Writes a message to the log, printable: it may quote files. An error of writing is ignored.
pub fn log(message: &str) {
    let _ = writeln!(io::stderr(), "{}", printable_lines(message));
}

/// Results of `work` for every item, in the items' order, computed on all cores; `name` is shown beside the progress
/// bar.
pub fn map<T: Sync, R: Send>(
    name: &str,
    items: &[T],
    run: &RunFolder,
    interrupt: &Interrupt,
    work: impl Fn(&T) -> R + Sync,
) -> Result<Vec<R>, RunError> {
    let progress = bar(items.len(), name);
    let results = items
        .par_iter()
        .map(|item| {
            if interrupt.requested() {
                return Err(run.interrupted());
            }
            let result = work(item);
            progress.inc(1);
            Ok(result)
        })
        .collect();
    progress.finish_and_clear();
    results
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_cause_is_said_once() {
        #[derive(Debug, thiserror::Error)]
        enum Outer {
            #[error("outside: {0}")]
            Quotes(#[source] Inner),
            #[error("{0} inside; try again")]
            Within(#[source] Inner),
            #[error("outside")]
            Leaves(#[source] Inner),
        }
        #[derive(Debug, thiserror::Error)]
        #[error("block 7")]
        struct Inner(#[source] io::Error);
        let inner = || Inner(io::Error::other("no room"));
        for (error, said) in [
            (Outer::Quotes(inner()), "outside: block 7: no room"),
            (Outer::Within(inner()), "block 7 inside; try again: no room"),
            (Outer::Leaves(inner()), "outside: block 7: no room"),
        ] {
            assert_eq!(with_causes(&error), said);
        }
    }
}
