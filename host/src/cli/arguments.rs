//! Arguments that several subcommands share.

use std::path::Path;

use shared::stream::alignment::Arm;
use shared::uart_line::flag;

use execution::progress;
use recordings::finding::grouped;
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
    some_recording(library, path)?;
    if let Some(first) = library.skipped.first() {
        progress::log(&format!(
            "files left out: {} (`myointent data inspect` lists them); the first: {}",
            library.skipped.len(),
            first.line()
        ));
    }
    log_findings(library);
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

/// Logs the doubts about the recordings, equal findings in one line.
pub(in crate::cli) fn log_findings(library: &Library) {
    for group in grouped(library.findings()) {
        progress::log(&printable(&group.to_string()));
    }
}

/// Refuses a library without a recording.
pub(in crate::cli) fn some_recording(library: &Library, path: &Path) -> anyhow::Result<()> {
    if let (true, Some(first)) = (library.recordings.is_empty(), library.skipped.first()) {
        anyhow::bail!(
            "no recording is left in {}: {} files are left out; the first: {}",
            path.display(),
            library.skipped.len(),
            first.line()
        );
    }
    Ok(())
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
