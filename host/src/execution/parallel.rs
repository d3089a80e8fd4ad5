//! The same work on many things, as many at once as there are cores.

use rayon::prelude::*;

use crate::execution::interrupt::Interrupt;
use crate::execution::progress;
use crate::execution::run_folder::{RunError, RunFolder};

/// What the work makes of every item, in their order, under a bar of that name.
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
    let all = items
        .par_iter()
        .map(|item| {
            if interrupt.requested() {
                return Err(run.interrupted());
            }
            let made = work(item);
            bar.inc(1);
            Ok(made)
        })
        .collect();
    bar.finish_and_clear();
    all
}
