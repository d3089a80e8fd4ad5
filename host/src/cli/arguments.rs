//! Arguments that several subcommands share.

use std::path::Path;

use shared::stream::alignment::Arm;
use shared::uart_line::flag;

use execution::progress;
pub use recordings::printable;
use recordings::{Library, LoadError, LoadOptions, load};

/// Parses the arm for an alignment: 0 or 1 for mirrored.
pub(in crate::cli) fn mirrored(text: &str) -> Result<Arm, String> {
    let mirrored = flag(text).ok_or("0 or 1")?;
    Ok(Arm::Known { mirrored })
}

/// Loads all recordings below a path, of every data set.
///
/// # Errors
/// When nothing can be read, or a file is damaged and `strict`.
pub(crate) fn every_recording(path: &Path, strict: bool) -> anyhow::Result<Library> {
    let options = LoadOptions {
        strict,
        data_sets: Vec::new(),
    };
    let library = load(path, &options).map_err(refused)?;
    log_found(&library, path)?;
    Ok(library)
}

/// Logs how many recordings were found, what was left out, and what is doubtful.
///
/// # Errors
/// When no recording is left.
pub(in crate::cli) fn log_found(library: &Library, path: &Path) -> anyhow::Result<()> {
    library.not_empty(path)?;
    log_doubts(library);
    progress::log(&format!(
        "{} recordings in {}",
        library.recordings.len(),
        path.display()
    ));
    for sentence in &library.people {
        progress::log(&printable(sentence));
    }
    Ok(())
}

/// Logs what was left out and the doubts about the recordings.
pub(in crate::cli) fn log_doubts(library: &Library) {
    library
        .doubts()
        .iter()
        .for_each(|doubt| progress::log(doubt));
}

/// Message for a failed load, with the option that leaves damaged files out.
pub(crate) fn refused(error: LoadError) -> anyhow::Error {
    match error {
        LoadError::Damaged { .. } => anyhow::Error::new(error)
            .context("--strict refuses this file; without it, damaged files are left out"),
        other => other.into(),
    }
}

/// Warns that test people, who are reserved for releases, are evaluated.
pub fn warn_of_test_people(people: usize) {
    if people > 0 {
        progress::log(&format!(
            "warning: {people} test people are evaluated, who are for releases: choose nothing by their scores"
        ));
    }
}
