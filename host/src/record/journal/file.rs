//! The journal's file: new, locked while it is written, and on the disk once a second.

use std::fs::{File, OpenOptions, TryLockError};
use std::io::{self, Read as _};
use std::path::{Path, PathBuf};

use shared::units::{Millis, Sample, SampleIndex};

use super::entry::FORMAT;
use super::{Contents, Entry, Header, Writer, read};

/// Ending of a journal's name.
pub const ENDING: &str = "journal";
/// How often it is brought to the disk: so much is lost if the power fails.
const SYNC_MS: u32 = 1_000;
/// Most bytes of a journal: 10 hours and more.
const LARGEST: u64 = 256 << 20;

/// Why a journal is not begun or not read.
#[derive(Debug, thiserror::Error)]
pub enum JournalError {
    /// It cannot be made, written or read.
    #[error("{}: {source}", path.display())]
    Io {
        /// The file.
        path: PathBuf,
        /// Why.
        #[source]
        source: io::Error,
    },
    /// A session writes it.
    #[error("{} is being written by another session: end that first", path.display())]
    Busy {
        /// The file.
        path: PathBuf,
    },
    /// Its first line was being written: no sample was recorded.
    #[error("{} has no whole first line: no sample was recorded in it", path.display())]
    Empty {
        /// The file.
        path: PathBuf,
    },
    /// It does not begin as a journal does.
    #[error("{}: the first line is damaged, so nobody can say whose it is; it is left as it is", path.display())]
    Headless {
        /// The file.
        path: PathBuf,
    },
    /// Of a later program.
    #[error("{}: format {found}, this program reads {FORMAT}: use the program that wrote it, version {version}", path.display())]
    Format {
        /// The file.
        path: PathBuf,
        /// What it says.
        found: u32,
        /// Of the program.
        version: String,
    },
}

/// A journal that is written.
#[derive(Debug)]
pub struct Journal {
    path: PathBuf,
    writer: Writer<File>,
    synced: Option<Millis>,
}

impl Journal {
    /// A new file, with its first line.
    ///
    /// # Errors
    /// When there is one of that name, or it cannot be written.
    pub fn create(path: &Path, mut header: Header) -> Result<Self, JournalError> {
        let failed = |source| JournalError::Io {
            path: path.to_owned(),
            source,
        };
        let file = OpenOptions::new().append(true).create_new(true).open(path);
        let file = file.map_err(failed)?;
        lock(path, &file)?;
        let mut writer = Writer::new(file);
        header.format = FORMAT;
        writer.entry(&Entry::Begin(header));
        writer.flush().map_err(failed)?;
        Ok(Self {
            path: path.to_owned(),
            writer,
            synced: None,
        })
    }

    /// The file.
    #[must_use]
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Takes samples; written with the next [`flush`](Self::flush), a tenth of a second at a time.
    pub fn samples(&mut self, first: SampleIndex, samples: &[Sample]) {
        self.writer.samples(first, samples);
    }

    /// Takes anything else.
    pub fn entry(&mut self, entry: &Entry) {
        self.writer.entry(entry);
    }

    /// Writes what waits, and once a second brings it to the disk.
    ///
    /// # Errors
    /// When the disk takes no more. What it has not taken is kept for the next time.
    pub fn flush(&mut self, now: Millis) -> io::Result<()> {
        self.writer.flush()?;
        if self
            .synced
            .is_none_or(|last| now.elapsed_since(last) >= SYNC_MS)
        {
            self.writer.get_ref().sync_data()?;
            self.synced = Some(now);
        }
        Ok(())
    }

    /// Writes all of it to the disk and lets go of it.
    ///
    /// # Errors
    /// When the disk takes no more: what it has taken can be read.
    pub fn close(mut self) -> io::Result<()> {
        self.writer.close();
        self.writer.flush()?;
        self.writer.get_ref().sync_all()?;
        self.writer.get_ref().unlock()
    }
}

/// Opens a journal that no session writes any more, and keeps others from it.
///
/// # Errors
/// When it cannot be read, is being written, or is none of this program.
pub fn open(path: &Path) -> Result<(File, Header, Contents), JournalError> {
    let failed = |source| JournalError::Io {
        path: path.to_owned(),
        source,
    };
    let file = File::open(path).map_err(failed)?;
    lock(path, &file)?;
    let mut bytes = Vec::new();
    // Through the handle that has the lock.
    (&file)
        .take(LARGEST)
        .read_to_end(&mut bytes)
        .map_err(failed)?;
    let mut contents = read(&bytes);
    if contents.entries.is_empty() {
        let path = path.to_owned();
        return Err(if contents.damaged {
            JournalError::Headless { path }
        } else {
            JournalError::Empty { path }
        });
    }
    match contents.entries.remove(0) {
        Entry::Begin(header) if header.format == FORMAT => Ok((file, header, contents)),
        Entry::Begin(header) => Err(JournalError::Format {
            path: path.to_owned(),
            found: header.format,
            version: header.version,
        }),
        _ => Err(JournalError::Headless {
            path: path.to_owned(),
        }),
    }
}

fn lock(path: &Path, file: &File) -> Result<(), JournalError> {
    match file.try_lock() {
        Ok(()) => Ok(()),
        Err(TryLockError::WouldBlock) => Err(JournalError::Busy {
            path: path.to_owned(),
        }),
        // Not every file system has locks: without one two sessions are told apart by the time in their names.
        Err(TryLockError::Error(_)) => Ok(()),
    }
}
