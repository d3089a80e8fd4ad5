//! File of a journal: new, locked while it is written, and synchronized to the disk once a second.
//!
//! A journal whose file has no name is lost when the program ends. So each flush looks up the name: if it leads to nothing
//! or to another file, the journal is written anew from the open file.

use std::fs::{self, File};
use std::io::{self, ErrorKind, Read as _, Seek as _, Write};
use std::path::{Path, PathBuf};

use shared::units::Millis;
use web::record::journal::{Contents, Entry, Header, read};

use super::name::{create_unnamed, free_name, is_named, lock, set_name};
use crate::record::error::{RecordError, folder};

/// Greatest length of a journal in bytes.
pub(in crate::record) const LARGEST: u64 = web::record::journal::LARGEST as u64;
/// Pause between two synchronizations to the disk: a power failure loses so much.
const SYNC_MS: u32 = 1_000;
/// Least number of bytes of a second of samples.
pub(in crate::record) const SECOND: usize = 3_500;

/// Result of a flush.
#[derive(Clone, PartialEq, Eq, Debug)]
pub(crate) enum FlushOutcome {
    /// The file is where it was.
    InPlace,
    /// The file had lost its name and was written anew, under this name or another one.
    Rewritten {
        /// Former name of the file.
        gone: PathBuf,
    },
}

/// Journal that is being written.
#[derive(Debug)]
pub(crate) struct Journal {
    path: PathBuf,
    file: File,
    /// Bytes that the file has not taken yet; begins within a line if it took a part of it.
    pending: Vec<u8>,
    synced: Option<Millis>,
    /// Time of the last attempt to write the file anew; none after a success.
    refused: Option<Millis>,
}

impl Journal {
    /// Creates a file with its first lines.
    ///
    /// It is locked before it gets its name, so that another start, which takes unlocked journals, cannot take it.
    ///
    /// # Errors
    /// When a file of that name exists or the file cannot be written.
    pub(crate) fn create(path: &Path, lines: &str) -> Result<Self, RecordError> {
        let failed = RecordError::io(path);
        let (unnamed, file) = create_unnamed(path).map_err(failed)?;
        lock(path, &file)?;
        let mut journal = Self {
            path: path.to_owned(),
            file,
            pending: lines.as_bytes().to_vec(),
            synced: None,
            refused: None,
        };
        let named = journal.write().and_then(|()| set_name(&unnamed, path));
        named.map_err(|error| {
            let _ = fs::remove_file(&unnamed);
            failed(error)
        })?;
        Ok(journal)
    }

    /// Path of the file.
    pub(crate) fn path(&self) -> &Path {
        &self.path
    }

    /// Takes whole lines; [`flush`](Self::flush) writes them.
    pub(crate) fn append(&mut self, lines: &str) {
        self.pending.extend_from_slice(lines.as_bytes());
    }

    fn write(&mut self) -> io::Result<()> {
        write_pending(&mut self.file, &mut self.pending)
    }

    /// Writes pending lines, and once a second synchronizes them to the disk. Writes the file anew if it has lost its name.
    ///
    /// # Errors
    /// When the disk takes no more. Data not yet taken is kept for the next call.
    pub(crate) fn flush(&mut self, now: Millis) -> Result<FlushOutcome, RecordError> {
        let mut flushed = FlushOutcome::InPlace;
        if !is_named(&self.file, &self.path) {
            let gone = self.path.clone();
            // A long journal is not copied in vain many times a second.
            let waits = |last: Millis| now.elapsed_since(last) < SYNC_MS;
            let anew = if self.refused.is_some_and(waits) {
                Err(ErrorKind::ResourceBusy.into())
            } else {
                self.refused = Some(now);
                self.rewrite(folder(&gone))
            };
            if let Err(source) = anew {
                return Err(RecordError::Gone { path: gone, source });
            }
            flushed = FlushOutcome::Rewritten { gone };
        }
        self.refused = None;
        let is_due = |last: Millis| now.elapsed_since(last) >= SYNC_MS;
        let mut written = self.write();
        if written.is_ok() && self.synced.is_none_or(is_due) {
            written = self.file.sync_data();
            self.synced = Some(now);
        }
        written.map_err(RecordError::io(&self.path))?;
        Ok(flushed)
    }

    /// Writes everything to the disk and unlocks the file. Returns its name, which is new if the file had lost its own.
    ///
    /// # Errors
    /// When the disk takes no more: what was written before can be read.
    pub(crate) fn close(mut self) -> Result<PathBuf, RecordError> {
        let path = self.path.clone();
        let mut elsewhere = false;
        if !is_named(&self.file, &path)
            && let Err(source) = self.rewrite(folder(&path))
        {
            // The samples are saved elsewhere: they would be lost when the program ends.
            if self.rewrite(&std::env::temp_dir()).is_err() {
                return Err(RecordError::Gone { path, source });
            }
            elsewhere = true;
        }
        let written = self.write();
        written
            .and_then(|()| self.file.sync_all())
            .map_err(|source| RecordError::Cut {
                path: self.path.clone(),
                seconds: self.pending.len().div_ceil(SECOND),
                source,
            })?;
        // Closing the file unlocks it, too.
        let _ = self.file.unlock();
        let found = self.path;
        if elsewhere {
            return Err(RecordError::Elsewhere { path, found });
        }
        Ok(found)
    }

    /// Copies the journal into a file of the same name in a folder, or of the next free name.
    fn rewrite(&mut self, folder: &Path) -> io::Result<()> {
        fs::create_dir_all(folder)?;
        let wanted = folder.join(self.path.file_name().unwrap_or_default());
        let path = free_name(&wanted);
        let (unnamed, mut file) = create_unnamed(&path)?;
        // No other process knows this file yet.
        let _ = file.try_lock();
        let mut old = &self.file;
        let copied = old.rewind().and_then(|()| io::copy(&mut old, &mut file));
        let named = copied
            .and_then(|_| file.sync_all())
            .and_then(|()| set_name(&unnamed, &path));
        if let Err(error) = named {
            let _ = fs::remove_file(&unnamed);
            return Err(error);
        }
        self.file = file;
        self.path = path;
        Ok(())
    }
}

/// Writes pending bytes.
///
/// # Errors
/// When the output takes no more. Bytes not yet taken are kept for the next call.
pub(super) fn write_pending(out: &mut impl Write, pending: &mut Vec<u8>) -> io::Result<()> {
    while !pending.is_empty() {
        match out.write(pending) {
            Ok(0) => return Err(ErrorKind::WriteZero.into()),
            Ok(taken) => drop(pending.drain(..taken)),
            Err(error) if error.kind() == ErrorKind::Interrupted => {}
            Err(error) => return Err(error),
        }
    }
    out.flush()
}

/// Opens and locks a journal that no session is writing.
///
/// # Errors
/// When it cannot be read, is being written, or is not a journal of this format.
pub(crate) fn open(path: &Path) -> Result<(File, Header, Contents), RecordError> {
    let failed = RecordError::io(path);
    let file = File::open(path).map_err(failed)?;
    lock(path, &file)?;
    let found = file.metadata().map_err(failed)?.len();
    if found > LARGEST {
        let path = path.to_owned();
        return Err(RecordError::Large { path, found });
    }
    let mut bytes = Vec::new();
    // Read through the locked handle.
    (&file)
        .take(LARGEST)
        .read_to_end(&mut bytes)
        .map_err(failed)?;
    let contents = read(&bytes);
    let mut entries = contents.entries.iter();
    let header = entries.find_map(|entry| match entry {
        Entry::Begin(header) => Some(header.clone()),
        _ => None,
    });
    let path = path.to_owned();
    match header {
        Some(header) if header.is_read() => Ok((file, header, contents)),
        Some(header) => Err(RecordError::Format {
            path,
            found: header.format,
            version: header.version,
        }),
        None if contents.entries.is_empty() => Err(RecordError::Empty { path }),
        None => Err(RecordError::Headless { path }),
    }
}
