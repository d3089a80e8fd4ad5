//! Names of journals: giving a file its name, and checking that it still has it.

use std::fs::{self, File, OpenOptions, TryLockError};
use std::io::{self, ErrorKind};
use std::path::{Path, PathBuf};

use crate::record::RecordError;

/// File extension of a journal.
pub(crate) const ENDING: &str = "journal";
/// File extension until a journal is locked and has its first line: no start takes such a file.
const UNNAMED: &str = "journal.new";

/// Creates a file that has no journal's name yet; returns its name, too.
pub(super) fn create_unnamed(path: &Path) -> io::Result<(PathBuf, File)> {
    let unnamed = path.with_extension(UNNAMED);
    let mut options = OpenOptions::new();
    let file = options.read(true).append(true).create_new(true);
    Ok((unnamed.clone(), file.open(&unnamed)?))
}

/// Gives a file the name of a journal. Only the session that created the unnamed file gets here.
pub(super) fn set_name(unnamed: &Path, path: &Path) -> io::Result<()> {
    if path.symlink_metadata().is_ok() {
        return Err(ErrorKind::AlreadyExists.into());
    }
    fs::rename(unnamed, path)
}

/// Finds a free name: `anna_….journal`, `anna_…-2.journal`.
pub(super) fn free_name(wanted: &Path) -> PathBuf {
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

/// Whether a path leads to a file. On systems other than Unix, an open file is rarely replaced.
#[cfg(not(unix))]
pub(super) fn is_named(_: &File, path: &Path) -> bool {
    path.exists()
}

/// Locks a journal, so that no other start takes it.
pub(super) fn lock(path: &Path, file: &File) -> Result<(), RecordError> {
    match file.try_lock() {
        Ok(()) => Ok(()),
        Err(TryLockError::WouldBlock) => Err(RecordError::Busy {
            path: path.to_owned(),
        }),
        // Not every file system has locks. Without them, the time in the names keeps two sessions apart.
        Err(TryLockError::Error(_)) => Ok(()),
    }
}
