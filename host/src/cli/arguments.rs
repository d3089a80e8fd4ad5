//! Arguments that several subcommands share.

use std::collections::BTreeMap;
use std::path::Path;

use anyhow::bail;
use shared::stream::alignment::Arm;
use shared::uart_line::flag;

use execution::progress;
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
    recordings_of(&[path], strict)
}

/// Loads all recordings at or below some paths, of every data set.
///
/// # Errors
/// When nothing can be read at one of them, two recordings have one name, or a file is damaged and `strict`.
pub(in crate::cli) fn recordings_of(
    paths: &[impl AsRef<Path>],
    strict: bool,
) -> anyhow::Result<Library> {
    let options = LoadOptions {
        strict,
        data_sets: Vec::new(),
    };
    let mut libraries = Vec::with_capacity(paths.len());
    for path in paths {
        let path = path.as_ref();
        let found = load(path, &options).map_err(refused)?;
        found.not_empty(path)?;
        libraries.push(found);
    }
    let library = Library::joined(libraries);
    let mut named = BTreeMap::new();
    for own in &library.recordings {
        if let Some(other) = named.insert(own.full_name(), &own.path)
            && paths.len() > 1
        {
            bail!(
                "{} and {} are both named {}: give the folder that holds both, or rename one",
                other.display(),
                own.path.display(),
                own.full_name()
            );
        }
    }
    let paths: Vec<_> = paths
        .iter()
        .map(|path| path.as_ref().display().to_string())
        .collect();
    log_found(&library, &paths.join(", "));
    Ok(library)
}

/// Logs how many recordings were found, what was left out, and what is doubtful.
pub(in crate::cli) fn log_found(library: &Library, whence: &str) {
    log_doubts(library);
    let count = library.recordings.len();
    progress::log(&format!("{count} recordings in {whence}"));
    for sentence in &library.people {
        progress::log(sentence);
    }
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
