//! Storage of recorded sessions: a thread that appends the journal's lines to a file, makes recordings of it at the end, and has
//! a model tuned on them. The engine waits for no disk.

mod summary;
#[cfg_attr(not(feature = "train"), path = "untrained.rs")]
mod tuning;

use std::fs::OpenOptions;
use std::io::Write as _;
use std::path::{Path, PathBuf};
use std::sync::mpsc::{self, Receiver, RecvTimeoutError, Sender};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

use execution::progress;
use serde::Serialize;
use shared::units::Millis;
use web::engine::{Lines, Stored};
use web::record::remark::NOTES;
use web::record::session::HoldReason;
use web::said::{Said, os};

use super::RecordOptions;
use super::stream::Input;
use crate::record::journal::{ENDING, FlushOutcome, Journal};
use crate::record::{RecordError, convert};

/// Longest wait for lines between two checks of the file: too short to notice.
const WAIT: Duration = Duration::from_millis(20);

/// Trouble with a session's files, and advice.
#[derive(Serialize, thiserror::Error, Debug)]
#[serde(tag = "name", rename_all = "kebab-case")]
enum Trouble {
    #[error("the recording cannot begin: {why}")]
    CannotBegin { why: Said },
    #[error("{folder}: {why}")]
    Folder {
        folder: PathBuf,
        #[serde(serialize_with = "os")]
        why: std::io::Error,
    },
    #[error("the note is not kept: {path}: {why}")]
    NoteLost {
        path: PathBuf,
        #[serde(serialize_with = "os")]
        why: std::io::Error,
    },
    #[error(
        "{gone} was deleted, moved or replaced: all of the session was written anew to {path}. If it was moved, what was written before is in the moved file, too"
    )]
    Anew { gone: PathBuf, path: PathBuf },
    #[error("{why}; what was recorded is kept while this program runs, and writing is tried again")]
    Retrying { why: Said },
    #[error(
        "{why}. The next start of `myointent record` for this person makes recordings of the journal"
    )]
    Cut { why: Said },
    #[error(
        "{why}. What was recorded is in {path}. The next start of `myointent record` for this person makes recordings of the journal"
    )]
    Left { why: Said, path: PathBuf },
}

impl Trouble {
    fn said(&self) -> Said {
        Said::of("storage", self)
    }
}

/// Work of the storage.
#[derive(Debug)]
pub(super) enum Work {
    /// Keep lines of a journal.
    Lines(Lines),
    /// Keep the line of a remark.
    Remark(Lines),
    /// Tune the model on all of the person's recordings.
    Tune,
}

/// Thread of the storage.
#[derive(Debug)]
pub(super) struct Storage {
    work: Sender<Work>,
    thread: JoinHandle<anyhow::Result<()>>,
}

impl Storage {
    /// Starts the thread. `port` is that of the board that a tuned model is for, and `option` selects the source again.
    pub(super) fn start(
        options: RecordOptions,
        model: Vec<u8>,
        port: Option<PathBuf>,
        option: String,
        inputs: Sender<Input>,
    ) -> std::io::Result<Self> {
        let (work, received) = mpsc::channel();
        let keeper = Keeper {
            folder: options.folder.join(&options.person),
            options,
            model,
            port,
            option,
            inputs,
            began: Instant::now(),
            journal: None,
            fails: false,
            unconverted: Vec::new(),
            tuning: None,
        };
        let thread = std::thread::Builder::new()
            .name("storage".to_owned())
            .spawn(move || keeper.run(&received))?;
        Ok(Self { work, thread })
    }

    pub(super) fn send(&self, work: Work) {
        // A thread that has ended by a panic is told by `stop`.
        let _ = self.work.send(work);
    }

    /// Ends the thread after the work before.
    ///
    /// # Errors
    /// When a session is not kept; the message names the journals.
    pub(super) fn stop(self) -> anyhow::Result<()> {
        drop(self.work);
        // The panic was printed already.
        self.thread.join().unwrap_or_else(|_| {
            Err(anyhow::anyhow!(
                "the storage ended; what was recorded is in the journal"
            ))
        })
    }
}

/// State of the storage.
struct Keeper {
    options: RecordOptions,
    /// Folder of the person.
    folder: PathBuf,
    #[cfg_attr(not(feature = "train"), expect(dead_code, reason = "of the tune step"))]
    model: Vec<u8>,
    port: Option<PathBuf>,
    #[cfg_attr(not(feature = "train"), expect(dead_code, reason = "of the tune step"))]
    option: String,
    inputs: Sender<Input>,
    began: Instant,
    /// Journal in progress, if it could be begun.
    journal: Option<Journal>,
    /// Whether the journal cannot be written at the moment.
    fails: bool,
    unconverted: Vec<Unconverted>,
    /// Thread of the tuning begun last.
    tuning: Option<JoinHandle<()>>,
}

/// Session without recordings.
struct Unconverted {
    /// Journal to try again; none if its writing failed.
    journal: Option<PathBuf>,
    /// Message that viewers got.
    message: String,
}

impl Keeper {
    fn run(mut self, work: &Receiver<Work>) -> anyhow::Result<()> {
        loop {
            match work.recv_timeout(WAIT) {
                Ok(first) => {
                    for work in std::iter::once(first).chain(work.try_iter().take(64)) {
                        match work {
                            Work::Lines(lines) => self.lines(&lines),
                            Work::Remark(line) => self.remark(&line),
                            Work::Tune => self.tune(),
                        }
                    }
                }
                Err(RecvTimeoutError::Timeout) => {}
                Err(RecvTimeoutError::Disconnected) => return self.retry_conversions(),
            }
            self.flush();
        }
    }

    fn tell(&self, stored: Stored) {
        // An engine that has ended needs nothing.
        let _ = self.inputs.send(Input::Stored(stored));
    }

    /// Logs a warning.
    fn warn(said: Said) -> Said {
        progress::log(&format!("warning: {said}"));
        said
    }

    fn lines(&mut self, lines: &Lines) {
        if lines.begins {
            let path = self.folder.join(format!("{}.{ENDING}", lines.name));
            let created = std::fs::create_dir_all(&self.folder).map_err(|why| {
                let folder = self.folder.clone();
                Trouble::Folder { folder, why }.said()
            });
            let created = created.and_then(|()| {
                Journal::create(&path, &lines.journal).map_err(|error| error.said())
            });
            self.fails = false;
            match created {
                Ok(journal) => self.journal = Some(journal),
                Err(why) => self.tell(Stored::Refused(Trouble::CannotBegin { why }.said())),
            }
        } else if let Some(journal) = &mut self.journal {
            journal.append(&lines.journal);
        }
        if lines.is_over {
            self.end();
        }
    }

    /// Appends a remark to the notes beside the session's recordings, at once.
    fn remark(&self, line: &Lines) {
        let path = self.folder.join(format!("{}.{NOTES}", line.name));
        let write = || {
            std::fs::create_dir_all(&self.folder)?;
            let file = OpenOptions::new().create(true).append(true).open(&path);
            let mut file = file?;
            file.write_all(line.journal.as_bytes())?;
            file.sync_data()
        };
        if let Err(why) = write() {
            let lost = Trouble::NoteLost { path, why };
            self.tell(Stored::Unkept(Self::warn(lost.said())));
        }
    }

    fn flush(&mut self) {
        #[expect(clippy::cast_possible_truncation, reason = "a clock that may wrap")]
        let now = Millis(self.began.elapsed().as_millis() as u32);
        let Some(journal) = &mut self.journal else {
            return;
        };
        match journal.flush(now) {
            Ok(outcome) => {
                let failed = std::mem::take(&mut self.fails);
                if let FlushOutcome::Rewritten { gone } = outcome {
                    let path = journal.path().to_owned();
                    let anew = Trouble::Anew { gone, path };
                    self.tell(Stored::Anew(Self::warn(anew.said())));
                } else if failed {
                    self.tell(Stored::Written);
                }
            }
            Err(error) => {
                let reason = match error {
                    RecordError::Gone { .. } => HoldReason::Gone,
                    _ => HoldReason::Disk,
                };
                let mut trouble = Trouble::Retrying { why: error.said() }.said();
                if !std::mem::replace(&mut self.fails, true) {
                    trouble = Self::warn(trouble);
                }
                self.tell(Stored::Failed(reason, trouble));
            }
        }
    }

    /// Ends the journal.
    fn end(&mut self) {
        let Some(journal) = self.journal.take() else {
            return;
        };
        match journal.close() {
            Ok(path) => self.convert(path),
            Err(error) => {
                let why = error.said();
                let trouble = match error {
                    RecordError::Elsewhere { .. } => why,
                    _ => Trouble::Cut { why }.said(),
                };
                self.left(None, trouble);
            }
        }
    }

    /// Makes recordings of a complete journal.
    fn convert(&mut self, path: PathBuf) {
        match convert(&path) {
            Ok(conversion) => {
                if let Some(damage) = conversion.damage() {
                    self.unconverted.push(Unconverted {
                        journal: None,
                        message: format!("{}: {damage}", path.display()),
                    });
                }
                self.tell(Stored::Kept(self.summary(&conversion)));
            }
            Err(error) => {
                let why = error.said();
                let left = Trouble::Left {
                    why,
                    path: path.clone(),
                };
                self.left(Some(path), left.said());
            }
        }
    }

    fn left(&mut self, journal: Option<PathBuf>, trouble: Said) {
        let message = trouble.text.clone();
        self.tell(Stored::Left(Self::warn(trouble)));
        self.unconverted.push(Unconverted { journal, message });
    }

    /// Tries again to make recordings of journals for which it failed: the disk may have room now.
    ///
    /// # Errors
    /// When a session is not kept; the message names the journals.
    fn retry_conversions(self) -> anyhow::Result<()> {
        let is_left = |own: &Unconverted| {
            let again = own.journal.as_deref().map(convert);
            !matches!(again, Some(Ok(_)))
        };
        let left = self.unconverted.into_iter().filter(is_left);
        let left: Vec<_> = left.map(|own| own.message).collect();
        anyhow::ensure!(left.is_empty(), "{}", left.join("\n"));
        Ok(())
    }
}

/// Finds a free name for a model file.
fn free_path(folder: &Path, person: &str) -> PathBuf {
    let mut number = 1_u32;
    let mut path = folder.join(format!("{person}.intent"));
    while path.exists() {
        number += 1;
        path = folder.join(format!("{person}-{number}.intent"));
    }
    path
}
