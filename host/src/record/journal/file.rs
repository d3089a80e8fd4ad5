//! The journal's file: new, locked while it is written, and on the disk once a second.
//!
//! A file is found by its name, so a journal that has lost its name is lost when the program ends. With each flush the name is
//! looked up: where it leads to nothing or to another file, the journal is written anew from the open file.

use std::fs::{self, File};
use std::io::{self, ErrorKind, Read as _, Seek as _};
use std::path::{Path, PathBuf};

use shared::units::{Millis, Sample, SampleIndex};

use super::entry::FORMAT;
use super::error::{JournalError, LARGEST, WriteError, folder};
use super::name::{free, is_named, lock, name, unnamed};
use super::{Contents, Entry, Header, Writer, read};

/// How often it is brought to the disk: so much is lost if the power fails.
const SYNC_MS: u32 = 1_000;
/// Bytes of a journal at which its session has to end: what waits for the disk has room after it.
const FULL: u64 = LARGEST - (32 << 20);
/// Bytes of a second of samples, at least.
const SECOND: usize = 3_500;

/// What a flush has found.
#[derive(Clone, PartialEq, Eq, Debug)]
pub enum Flushed {
    /// The file is where it was.
    InPlace,
    /// The file was gone from a name: it was written anew, under this name or another one.
    Anew {
        /// The name that it had.
        gone: PathBuf,
    },
}

/// A journal that is written.
#[derive(Debug)]
pub struct Journal {
    path: PathBuf,
    writer: Writer<File>,
    synced: Option<Millis>,
    /// When it could not be written anew.
    refused: Option<Millis>,
}

impl Journal {
    /// A new file, with its first line.
    ///
    /// It is locked before it has its name: another start, which takes journals that nobody has locked, cannot take it.
    ///
    /// # Errors
    /// When there is one of that name, or it cannot be written.
    pub fn create(path: &Path, mut header: Header) -> Result<Self, JournalError> {
        let failed = |source| JournalError::Io {
            path: path.to_owned(),
            source,
        };
        let (unnamed, file) = unnamed(path).map_err(failed)?;
        lock(path, &file)?;
        let mut writer = Writer::new(file);
        header.format = FORMAT;
        writer.entry(&Entry::Begin(header));
        let named = writer.flush().and_then(|()| name(&unnamed, path));
        named.map_err(|error| {
            let _ = fs::remove_file(&unnamed);
            failed(error)
        })?;
        Ok(Self {
            path: path.to_owned(),
            writer,
            synced: None,
            refused: None,
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

    /// Whether the session has to end: a longer journal is not read.
    #[must_use]
    pub fn is_full(&self) -> bool {
        let length = self.writer.get_ref().metadata();
        length.is_ok_and(|file| file.len() > FULL)
    }

    /// Writes what waits, and once a second brings it to the disk; writes all of it anew if the file has lost its name.
    ///
    /// # Errors
    /// When the disk takes no more. What it has not taken is kept for the next time.
    pub fn flush(&mut self, now: Millis) -> Result<Flushed, WriteError> {
        let mut flushed = Flushed::InPlace;
        if !is_named(self.writer.get_ref(), &self.path) {
            let gone = self.path.clone();
            // A long journal is not copied in vain many times a second.
            let waits = |last: Millis| now.elapsed_since(last) < SYNC_MS;
            let anew = if self.refused.is_some_and(waits) {
                Err(ErrorKind::ResourceBusy.into())
            } else {
                self.refused = Some(now);
                self.write_anew(folder(&gone))
            };
            if let Err(source) = anew {
                return Err(WriteError::Gone { path: gone, source });
            }
            flushed = Flushed::Anew { gone };
        }
        self.refused = None;
        let is_due = |last: Millis| now.elapsed_since(last) >= SYNC_MS;
        let mut written = self.writer.flush();
        if written.is_ok() && self.synced.is_none_or(is_due) {
            written = self.writer.get_ref().sync_data();
            self.synced = Some(now);
        }
        let path = self.path.clone();
        written.map_err(|source| WriteError::Disk { path, source })?;
        Ok(flushed)
    }

    /// Writes all of it to the disk and lets go of it. Returns its name, which is another one if the file had lost it.
    ///
    /// # Errors
    /// When the disk takes no more: what it has taken can be read.
    pub fn close(mut self) -> Result<PathBuf, WriteError> {
        self.writer.close();
        let path = self.path.clone();
        let mut elsewhere = false;
        if !is_named(self.writer.get_ref(), &path)
            && let Err(source) = self.write_anew(folder(&path))
        {
            // Whatever has become of the folder, the samples are not lost with the program.
            if self.write_anew(&std::env::temp_dir()).is_err() {
                return Err(WriteError::Gone { path, source });
            }
            elsewhere = true;
        }
        let written = self.writer.flush();
        written
            .and_then(|()| self.writer.get_ref().sync_all())
            .map_err(|source| WriteError::Cut {
                path: self.path.clone(),
                seconds: self.writer.pending().div_ceil(SECOND),
                source,
            })?;
        // Closing the file lets go of it, too.
        let _ = self.writer.get_ref().unlock();
        let found = self.path;
        if elsewhere {
            return Err(WriteError::Elsewhere { path, found });
        }
        Ok(found)
    }

    /// Copies what was written into a file of the same name in a folder, or of the next name if another file has it.
    fn write_anew(&mut self, folder: &Path) -> io::Result<()> {
        fs::create_dir_all(folder)?;
        let wanted = folder.join(self.path.file_name().unwrap_or_default());
        let path = free(&wanted);
        let (unnamed, mut file) = unnamed(&path)?;
        // Nobody else can have it yet.
        let _ = file.try_lock();
        let mut old = self.writer.get_ref();
        let copied = old.rewind().and_then(|()| io::copy(&mut old, &mut file));
        let named = copied
            .and_then(|_| file.sync_all())
            .and_then(|()| name(&unnamed, &path));
        if let Err(error) = named {
            let _ = fs::remove_file(&unnamed);
            return Err(error);
        }
        self.writer.go_on_in(file);
        self.path = path;
        Ok(())
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
    let found = file.metadata().map_err(failed)?.len();
    if found > LARGEST {
        let path = path.to_owned();
        return Err(JournalError::Large { path, found });
    }
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
