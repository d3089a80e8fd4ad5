//! Names of journals: when a file gets one, and whether it has it still.

use std::fs::{self, File, OpenOptions, TryLockError};
use std::io::{self, ErrorKind};
use std::path::{Path, PathBuf};

use super::error::JournalError;

/// Ending of a journal's name.
pub const ENDING: &str = "journal";
/// Ending of the name that a file has until it is locked and has its first line: nobody takes it for a journal.
const UNNAMED: &str = "journal.new";

/// A new file that has not yet the name of a journal, and its name.
pub(super) fn unnamed(path: &Path) -> io::Result<(PathBuf, File)> {
    let unnamed = path.with_extension(UNNAMED);
    let mut options = OpenOptions::new();
    let file = options.read(true).append(true).create_new(true);
    Ok((unnamed.clone(), file.open(&unnamed)?))
}

/// Gives a file the name of a journal. Who has made the unnamed one is alone: no other session can make it.
pub(super) fn name(unnamed: &Path, path: &Path) -> io::Result<()> {
    if path.symlink_metadata().is_ok() {
        return Err(ErrorKind::AlreadyExists.into());
    }
    fs::rename(unnamed, path)
}

/// A name that no file has: `anna_….journal`, `anna_…-2.journal`.
pub(super) fn free(wanted: &Path) -> PathBuf {
    let stem = wanted.file_stem().unwrap_or_default().to_string_lossy();
    let mut path = wanted.to_owned();
    let mut number = 1_u32;
    while path.symlink_metadata().is_ok() {
        number += 1;
        path = wanted.with_file_name(format!("{stem}-{number}.{ENDING}"));
    }
    path
}

/// Whether a path leads to an open file.
#[cfg(unix)]
pub(super) fn is_named(file: &File, path: &Path) -> bool {
    use std::os::unix::fs::MetadataExt as _;
    let place = |found: fs::Metadata| (found.dev(), found.ino());
    match (file.metadata(), fs::metadata(path)) {
        (Ok(own), Ok(found)) => place(own) == place(found),
        _ => false,
    }
}

/// Whether a path leads to a file. Elsewhere than on Unix an open file is hardly ever replaced.
#[cfg(not(unix))]
pub(super) fn is_named(_: &File, path: &Path) -> bool {
    path.exists()
}

/// Locks a journal, so that no other start takes it.
pub(super) fn lock(path: &Path, file: &File) -> Result<(), JournalError> {
    match file.try_lock() {
        Ok(()) => Ok(()),
        Err(TryLockError::WouldBlock) => Err(JournalError::Busy {
            path: path.to_owned(),
        }),
        // Not every file system has locks: without one two sessions are told apart by the time in their names.
        Err(TryLockError::Error(_)) => Ok(()),
    }
}
