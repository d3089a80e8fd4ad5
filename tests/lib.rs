//! Where the tests find their reference numbers and recordings.
//!
//! Both lie outside the repository: in `$MYOINTENT_GOLDEN` and `$MYOINTENT_DATA`, or else in
//! `../shared/golden` and `../shared/data` beside the workspace. A test that finds none says so
//! and passes over: `let Some(golden) = golden("name") else { return };`.

pub mod emulator;

use std::io::Write;
use std::path::{Path, PathBuf};

/// The folder of reference numbers; without one, books the test `name` as skipped.
#[must_use]
pub fn golden(name: &str) -> Option<PathBuf> {
    folder(name, "MYOINTENT_GOLDEN", "golden")
}

/// The folder of recordings; without one, books the test `name` as skipped.
#[must_use]
pub fn data(name: &str) -> Option<PathBuf> {
    folder(name, "MYOINTENT_DATA", "data")
}

/// Prints `SKIPPED name: reason`, past the capture of test output, so that it can be counted.
pub fn skip(name: &str, reason: &str) {
    // A lost line is all that can go wrong, and there is nobody to tell.
    let _ = writeln!(std::io::stderr(), "SKIPPED {name}: {reason}");
}

fn folder(name: &str, variable: &str, default: &str) -> Option<PathBuf> {
    let folder = std::env::var_os(variable).map_or_else(
        || {
            Path::new(env!("CARGO_MANIFEST_DIR"))
                .join("../../shared")
                .join(default)
        },
        PathBuf::from,
    );
    if folder.is_dir() {
        return Some(folder);
    }
    let folder = folder.display();
    skip(name, &format!("no folder {folder}: set {variable}"));
    None
}
