//! Commands to a board on a serial port: one at a time, each with its answer.

pub mod drive;
pub mod flash;
mod install;
pub(crate) mod port;
mod usb;

pub use self::install::install;
pub use web::installer::{InstallError, ModelFile};

use std::io::ErrorKind;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use serial2::SerialPort;
use shared::uart_line::alignment::{AlignmentReport, AlignmentState};
use shared::uart_line::answer::{Answer, Charge, Refusal};
use shared::uart_line::command::{Command, NOBODY_HEARD};
use shared::uart_line::line::{Line, LineReader};
use web::installer::asks_again;

/// Longest time that one read waits for bytes.
const WAIT: Duration = Duration::from_millis(20);
/// Longest time to wait for an answer. A board answers within a second, after the lines already queued for the UART.
const ANSWER: Duration = Duration::from_secs(2);
/// Number of times a command is sent before the board counts as silent.
const ATTEMPTS: u32 = 3;

/// Error of a command to a board, or of an installation.
#[derive(Debug, thiserror::Error)]
#[expect(missing_docs, reason = "the messages say it")]
pub enum BoardError {
    #[error("{path} cannot be opened: is it the board's port, and may this user open it?")]
    Open {
        path: PathBuf,
        #[source]
        source: std::io::Error,
    },
    #[error("{path} was lost: is the board still connected?")]
    Lost {
        path: PathBuf,
        #[source]
        source: std::io::Error,
    },
    #[error(
        "no answer on {path}: is it the board's port, is the board powered, and does no other program read it?"
    )]
    Silent { path: PathBuf },
    #[error(
        "{path}: expected the answer to {command}, found {answer}: close every other program that uses the port, and ask again"
    )]
    Unmatched {
        path: PathBuf,
        command: String,
        answer: String,
    },
    #[error("the board refuses: {0}")]
    Refused(#[from] Refusal),
    #[error("stopped before the board had the whole model")]
    Stopped,
    #[error(transparent)]
    Install(#[from] InstallError),
}

/// Connection to a board on a serial port.
#[derive(Debug)]
pub struct Board {
    path: PathBuf,
    port: SerialPort,
    reader: LineReader,
    /// Report of an alignment that ended as soon as it began; cleared by the next command.
    unavailable: Option<AlignmentReport>,
    /// Whether a pairing has ended because no armband was heard.
    pub(crate) has_heard_nobody: bool,
}

impl Board {
    /// Opens a serial port, or a pseudo-terminal that stands for one.
    pub fn open(path: &Path) -> Result<Self, BoardError> {
        let port = port::open(path, WAIT, ANSWER).map_err(|source| BoardError::Open {
            path: path.to_owned(),
            source,
        })?;
        Ok(Self {
            path: path.to_owned(),
            port,
            reader: LineReader::default(),
            unavailable: None,
            has_heard_nobody: false,
        })
    }

    /// Sends a command and returns what `read` makes of its answer. A line damaged on the way is sent again. Answers to
    /// other commands, late or caused by another program, are skipped ([`Answer::answers`]).
    pub fn ask<T>(
        &mut self,
        command: Command,
        mut read: impl FnMut(&Answer<'_>) -> Option<T>,
    ) -> Result<T, BoardError> {
        let (mut refused, mut other) = (None, None);
        self.unavailable = None;
        for _ in 0..ATTEMPTS {
            self.send(command)?;
            let answer = self.wait(ANSWER, |line| match line {
                Line::Answer(answer) if !answer.answers(command) => {
                    other = Some(answer.to_string());
                    None
                }
                Line::Answer(Answer::Refused(refusal)) => Some(Err(*refusal)),
                Line::Answer(answer) => read(answer).map(Ok),
                _ => None,
            })?;
            match answer {
                Some(Ok(answer)) => return Ok(answer),
                Some(Err(refusal)) if asks_again(refusal) => refused = Some(refusal),
                None => {}
                Some(Err(refusal)) => return Err(refusal.into()),
            }
        }
        let path = self.path.clone();
        Err(match (refused, other) {
            (Some(refusal), _) => refusal.into(),
            (None, Some(answer)) => BoardError::Unmatched {
                path,
                command: command.to_string().trim_end().to_owned(),
                answer: answer.trim_end().to_owned(),
            },
            (None, None) => BoardError::Silent { path },
        })
    }

    fn send(&self, command: Command) -> Result<(), BoardError> {
        let line = command.to_string();
        self.port
            .write_all(line.as_bytes())
            .map_err(|source| self.lost(source))
    }

    /// Asks how the board's own battery is charged; none if it does not measure that, or is older than the question.
    pub fn battery(&mut self) -> Result<Option<Charge>, BoardError> {
        let charge = self.ask(Command::Battery, |answer| match answer {
            Answer::Battery(charge) => Some(*charge),
            _ => None,
        });
        match charge {
            Err(BoardError::Refused(_)) => Ok(None),
            charge => charge,
        }
    }

    /// Reads lines until `read` returns something; none on timeout.
    pub fn wait<T>(
        &mut self,
        within: Duration,
        mut read: impl FnMut(&Line<'_>) -> Option<T>,
    ) -> Result<Option<T>, BoardError> {
        let end = Instant::now() + within;
        while Instant::now() < end {
            // Reading byte by byte would be slow, and bytes after the line belong to the next one.
            let mut byte = [0];
            match self.port.read(&mut byte) {
                Ok(0) => return Err(self.lost(ErrorKind::UnexpectedEof.into())),
                Ok(_) => {
                    // A damaged line is dropped: its command is sent again.
                    if let Some(Ok(line)) = self.reader.push(byte[0]) {
                        match line {
                            Line::Comment(_) if line.to_string() == NOBODY_HEARD => {
                                self.has_heard_nobody = true;
                            }
                            Line::Alignment(report)
                                if report.state == AlignmentState::Unavailable =>
                            {
                                self.unavailable = Some(report);
                            }
                            _ => {}
                        }
                        if let Some(found) = read(&line) {
                            return Ok(Some(found));
                        }
                    }
                }
                Err(error) if port::is_timeout(&error) => {}
                Err(error) => return Err(self.lost(error)),
            }
        }
        Ok(None)
    }

    /// Waits for the result of the alignment that the last command began; none on timeout.
    pub(crate) fn aligned(
        &mut self,
        within: Duration,
    ) -> Result<Option<AlignmentReport>, BoardError> {
        // The report comes before the answer to the command.
        if let Some(report) = self.unavailable.take() {
            return Ok(Some(report));
        }
        self.wait(within, |line| match line {
            Line::Alignment(report) if report.state != AlignmentState::Waiting => Some(*report),
            _ => None,
        })
    }

    fn lost(&self, source: std::io::Error) -> BoardError {
        BoardError::Lost {
            path: self.path.clone(),
            source,
        }
    }
}
