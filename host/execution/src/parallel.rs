//! Parallel work on a list of items, with progress and interrupt.

use rayon::prelude::*;

use crate::interrupt::Interrupt;
use crate::progress;
use crate::run_folder::{RunError, RunFolder};

/// Results of `work` for every item, in the items' order, computed on all cores; `name` is shown beside the progress
/// bar.
///
/// # Errors
/// When the user interrupts.
pub fn map<T: Sync, R: Send>(
    name: &str,
    items: &[T],
    run: &RunFolder,
    interrupt: &Interrupt,
    work: impl Fn(&T) -> R + Sync,
) -> Result<Vec<R>, RunError> {
    let bar = progress::bar(items.len(), name);
    let results = items
        .par_iter()
        .map(|item| {
            if interrupt.requested() {
                return Err(run.interrupted());
            }
            let result = work(item);
            bar.inc(1);
            Ok(result)
        })
        .collect();
    bar.finish_and_clear();
    results
}
