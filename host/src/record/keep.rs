//! From a journal to files: at the end of a session, or at the next start if that did not come.

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

/// Ending of a journal that the disk has damaged.
const DAMAGED: &str = "journal.damaged";

/// Most samples of a recording: an hour, which is a third of what readers take from one file.
const LONGEST: usize = 3600 * SAMPLE_RATE_HZ as usize;

/// What was kept of a session.
#[derive(Clone, PartialEq, Debug)]
pub struct Kept {
    /// Whose.
    pub person: String,
    /// The recordings, in order.
    pub files: Vec<PathBuf>,
    /// Whether they are good enough.
    pub quality: Quality,
    /// Trials that are not used.
    pub bad: usize,
    /// Bytes of the journal behind its last whole line.
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
        /// Why.
        error: RunError,
    },
    /// There is a file of that name.
    #[error("{} exists already and is left as it is: move it, then start `myointent record` for this person again", path.display())]
    Exists {
        /// The file.
        path: PathBuf,
    },
    /// The recording is written, and no command will read it.
    #[error("the recording is written and cannot be used; the journal is kept: {reason}")]
    Refused {
        /// The file, and what the examiner found in it.
        reason: String,
    },
    /// What was written is not what is read.
    #[error("{} is not read as it was written; the journal is kept", path.display())]
    Unlike {
        /// The file.
        path: PathBuf,
    },
    /// What was written cannot be read.
    #[error(transparent)]
    Load(#[from] LoadError),
    /// The journal cannot be put away.
    #[error("{}: {source}", path.display())]
    Io {
        /// The file.
        path: PathBuf,
        /// Why.
        #[source]
        source: io::Error,
    },
}

/// Makes a journal into recordings beside it, reads these back, and removes it.
///
/// # Errors
/// The journal stays where it is, and the next start tries again.
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
        // The journal itself may have made it: a program that was killed half-way.
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

/// `anna_20261122T110323Z_quick_1.csv`
fn file(journal: &Path, number: usize) -> PathBuf {
    let stem = journal.file_stem().unwrap_or_default().to_string_lossy();
    journal.with_file_name(format!("{stem}_{number}.csv"))
}

/// Journals in a person's folder that no session writes, made into recordings: of sessions that were killed, or whose disk
/// was full. With each, what came of it.
///
/// # Errors
/// When the folder cannot be read. One that is not there has none.
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
        // Another session's, or killed before its first line was whole.
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
