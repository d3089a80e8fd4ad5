//! Shared parts of the tests, and the search for their reference numbers and recordings.
//!
//! Reference numbers are in the repository, `tests/golden/data`; `$MYOINTENT_GOLDEN` names another
//! folder of the same layout. Recordings are not: they are looked for in `$MYOINTENT_DATA`, or else
//! in `../shared/data` beside the workspace. A test that finds none prints where to get them and
//! returns: `let Some(data) = data() else { return };`. With `MYOINTENT_REQUIRE=all` it fails.

pub mod bench;
pub mod chip;
pub mod oracle;
pub mod output;
pub mod simulation;

use std::io::Write;
use std::path::{Path, PathBuf};

use shared::intent::Vocabulary;
use shared::model::dimensions::Dimensions;
use shared::model::file::random::{SMALL, random_model};

/// Value of a part of a test, or the test's end where the part is missing, which is booked as skipped. A function that is no
/// test ends with the second value.
#[macro_export]
macro_rules! found {
    ($part:expr) => {
        $crate::found!($part, ())
    };
    ($part:expr, $missing:expr) => {
        match $part {
            Some(part) => part,
            None => return Ok($missing),
        }
    };
}

/// Returns the folder of reference numbers.
pub fn golden() -> PathBuf {
    folder("MYOINTENT_GOLDEN", "golden/data")
}

/// Returns the folder of recordings; without one, books the test as skipped.
pub fn data() -> Option<PathBuf> {
    recorded("")
}

/// Returns a file or folder below the folder of recordings; without it, books the test as skipped.
pub fn recorded(path: impl AsRef<Path>) -> Option<PathBuf> {
    let found = folder("MYOINTENT_DATA", "../../shared/data").join(path);
    if found.exists() {
        return Some(found);
    }
    let missing = found.display();
    skip(&format!(
        "no {missing}: MYOINTENT_DATA names a folder of recordings (docs/recordings.md)"
    ));
    None
}

/// Books the test of this thread as skipped: prints `SKIPPED name: reason`, past the capture of test output, so that it can be
/// counted.
///
/// # Panics
/// Panics if `MYOINTENT_REQUIRE` is `all`, so that no test passes because something is missing; and if it has another value.
pub fn skip(reason: &str) {
    let thread = std::thread::current();
    let (name, reason) = (thread.name().unwrap_or("a test"), reason.replace('\n', " "));
    let required = std::env::var("MYOINTENT_REQUIRE").unwrap_or_default();
    match required.as_str() {
        "" => {}
        "all" => panic!("{name} needs what is missing, and MYOINTENT_REQUIRE=all: {reason}"),
        other => panic!("MYOINTENT_REQUIRE={other}: expected all, or unset it"),
    }
    // The skip is one write and a line of its own: tests run side by side, and lines that begin so are counted.
    let line = format!("\nSKIPPED {name}: {reason}\n");
    // The worst failure is a lost line, which nothing could report.
    let _ = std::io::stderr().write_all(line.as_bytes());
}

/// Returns the folder that a variable names, or a default beside this file.
fn folder(variable: &str, default: &str) -> PathBuf {
    std::env::var_os(variable).map_or_else(
        || Path::new(env!("CARGO_MANIFEST_DIR")).join(default),
        PathBuf::from,
    )
}

/// Returns the path of a model of the repository.
pub fn shipped(name: &str) -> PathBuf {
    let models = Path::new(env!("CARGO_MANIFEST_DIR")).join("../models");
    models.join(name).with_extension("intent")
}

/// Reads a model of the repository.
///
/// # Panics
/// Panics if there is none of this name.
pub fn model_file(name: &str) -> Vec<u8> {
    std::fs::read(shipped(name)).expect("a model of the repository")
}

/// Writes a small model of random weights that has seen these people.
///
/// # Panics
/// Panics if the file cannot be written.
pub fn small_model(path: &Path, seen: &[&str], vocabulary: Vocabulary) {
    let dimensions = Dimensions {
        width: 32,
        span: 20,
        vocabulary,
        ..SMALL
    };
    let mut parts = random_model(dimensions, 5);
    parts.provenance.subjects_seen = seen.iter().map(|&name| name.to_owned()).collect();
    let bytes = parts.to_bytes().expect("a valid model");
    std::fs::write(path, bytes).expect("a folder of the test");
}
