//! Conversion of a journal to recordings, at the end of a session or at the next start.

use std::fs;
use std::io;
use std::path::{Path, PathBuf};

use shared::units::{SAMPLE_RATE_HZ, Sample};

use super::assembly::assemble;
use super::journal::{ENDING, JournalError, open};
use super::layout::csv;
use super::quality::{Quality, judge};
use execution::run_folder::{RunError, write_whole};
use recordings::{LoadError, LoadOptions, load};

/// File extension of a journal that the disk has damaged.
const DAMAGED: &str = "journal.damaged";

/// Greatest number of samples of a recording: an hour, a third of what readers take from one file.
const LONGEST: usize = 3600 * SAMPLE_RATE_HZ as usize;

/// Recordings made of a session.
#[derive(Clone, PartialEq, Debug)]
pub struct Kept {
    /// Name of the person.
    pub person: String,
    /// Paths of the recordings, in order.
    pub files: Vec<PathBuf>,
    /// Quality of the recordings.
    pub quality: Quality,
    /// Number of trials that are not used.
    pub bad: usize,
    /// Number of bytes of the journal after its last whole line.
    pub left_off: usize,
}

/// Why a journal is not made into recordings. It stays where it is.
#[derive(Debug, thiserror::Error)]
pub enum KeepError {
    /// The journal is refused.
    #[error(transparent)]
    Journal(#[from] JournalError),
    /// A recording cannot be written.
    #[error("{}: the recordings cannot be written ({error}). Nothing is lost: free the disk, then start `myointent record` for this person again", journal.display())]
    Write {
        /// The journal.
        journal: PathBuf,
        /// Error of the write.
        error: RunError,
    },
    /// Another file of that name exists.
    #[error("{} exists already and is left as it is: move it, then start `myointent record` for this person again", path.display())]
    Exists {
        /// The file.
        path: PathBuf,
    },
    /// The recording was written, but no command would read it.
    #[error("the recording is written and cannot be used; the journal is kept: {reason}")]
    Refused {
        /// Finding, with the file.
        reason: String,
    },
    /// The recording reads back differently.
    #[error("{} is not read as it was written; the journal is kept", path.display())]
    Unlike {
        /// The file.
        path: PathBuf,
    },
    /// The recording cannot be read back.
    #[error(transparent)]
    Load(#[from] LoadError),
    /// The journal cannot be removed or renamed.
    #[error("{}: {source}", path.display())]
    Io {
        /// The file.
        path: PathBuf,
        /// Error of the operating system.
        #[source]
        source: io::Error,
    },
}

/// Makes recordings beside a journal, reads them back, and removes the journal.
///
/// # Errors
/// See [`KeepError`]. The journal stays where it is, and the next start tries again.
pub fn keep(journal: &Path) -> Result<Kept, KeepError> {
    let (lock, header, contents) = open(journal)?;
    let take = assemble(&contents.entries);
    let mut files = Vec::new();
    let cued = take
        .parts
        .iter()
        .filter(|part| part.cues.iter().any(Option::is_some));
    let pieces = cued.flat_map(|part| {
        let files = part.files(LONGEST).into_iter();
        files.map(move |samples| (part, samples))
    });
    for (place, (part, piece)) in pieces.enumerate() {
        let path = file(journal, place + 1);
        let text = csv(&take, part, piece.clone(), header.synthetic);
        // A program that was killed half-way may have written the file before.
        let is_own = fs::read(&path).is_ok_and(|found| found == text.as_bytes());
        if path.exists() && !is_own {
            return Err(KeepError::Exists { path });
        }
        write_whole(&path, text.as_bytes()).map_err(|error| KeepError::Write {
            journal: journal.to_owned(),
            error,
        })?;
        let read = load(&path, &LoadOptions::default())?;
        if let (true, Some(refused)) = (read.recordings.is_empty(), read.skipped.first()) {
            let reason = refused.line();
            return Err(KeepError::Refused { reason });
        }
        let place = |at: usize| part.placements[at].apply(part.samples[at]);
        let samples: Vec<Sample> = piece.clone().map(place).collect();
        let same = read.recordings.first().is_some_and(|recording| {
            recording.samples == samples && recording.labels == part.labels[piece]
        });
        if !same {
            return Err(KeepError::Unlike { path });
        }
        files.push(path);
    }
    let kept = Kept {
        person: header.person,
        quality: judge(&take, contents.damaged),
        files,
        bad: take.bad.len(),
        left_off: contents.left_off,
    };
    let put_away = if contents.damaged {
        fs::rename(journal, journal.with_extension(DAMAGED))
    } else {
        fs::remove_file(journal)
    };
    drop(lock);
    put_away.map_err(|source| KeepError::Io {
        path: journal.to_owned(),
        source,
    })?;
    Ok(kept)
}

/// Path of a recording: `anna_20261122T110323Z_quick_1.csv`.
fn file(journal: &Path, number: usize) -> PathBuf {
    let stem = journal.file_stem().unwrap_or_default().to_string_lossy();
    journal.with_file_name(format!("{stem}_{number}.csv"))
}

/// Makes recordings of all journals in a person's folder that no session writes: their sessions were killed, or the disk was
/// full. Returns the result for each.
///
/// # Errors
/// When the folder cannot be read. A missing folder has no journals.
pub fn recover(folder: &Path) -> io::Result<Vec<(PathBuf, Result<Kept, KeepError>)>> {
    let entries = match fs::read_dir(folder) {
        Ok(entries) => entries,
        Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(Vec::new()),
        Err(error) => return Err(error),
    };
    let mut journals = Vec::new();
    for entry in entries {
        let path = entry?.path();
        if path.extension().is_some_and(|ending| ending == ENDING) {
            journals.push(path);
        }
    }
    journals.sort();
    let kept = journals.into_iter().filter_map(|path| match keep(&path) {
        // Another session writes it, or was killed before its first line was complete.
        Err(KeepError::Journal(JournalError::Busy { .. })) => None,
        Err(KeepError::Journal(JournalError::Empty { .. })) => {
            let removed = fs::remove_file(&path).map_err(|source| KeepError::Io {
                path: path.clone(),
                source,
            });
            removed.err().map(|error| (path, Err(error)))
        }
        result => Some((path, result)),
    });
    Ok(kept.collect())
}

#[cfg(test)]
mod tests;
