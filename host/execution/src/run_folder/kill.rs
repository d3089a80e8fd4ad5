//! A kill at a chosen point between two changes of the disk, for tests.
//!
//! A killed process leaves its files and nothing else; so does one whose stack is unwound without any
//! cleaning up of files.

use std::cell::Cell;
use std::panic::{AssertUnwindSafe, catch_unwind, resume_unwind};

thread_local! {
    /// Points to pass before the kill; none without one.
    static LEFT: Cell<Option<usize>> = const { Cell::new(None) };
}

struct Killed;

/// Runs `work` up to its point number `points`, from 0 on; none if it was killed there, its result if it has
/// fewer points. Only points in the calling thread count.
pub fn after<T>(points: usize, work: impl FnOnce() -> T) -> Option<T> {
    LEFT.set(Some(points));
    let result = catch_unwind(AssertUnwindSafe(work));
    LEFT.set(None);
    match result {
        Ok(result) => Some(result),
        Err(cause) if cause.is::<Killed>() => None,
        Err(cause) => resume_unwind(cause),
    }
}

/// A point at which the process may be killed.
pub(crate) fn point() {
    match LEFT.get() {
        // Without the panic hook, which would print it.
        Some(0) => resume_unwind(Box::new(Killed)),
        Some(left) => LEFT.set(Some(left - 1)),
        None => {}
    }
}
