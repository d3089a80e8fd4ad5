//! Commands to a board on a serial port: one at a time, each with its answer.

mod install;

pub use self::install::{ModelFile, Unfit, install};

use std::io::ErrorKind;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use serial2::SerialPort;
use shared::uart_line::answer::{Answer, Refusal};
use shared::uart_line::command::Command;
use shared::uart_line::line::{Line, LineReader};

/// Of the board's UART.
pub(crate) const BAUD: u32 = 115_200;
/// How long one read waits for bytes.
const WAIT: Duration = Duration::from_millis(20);
/// A board answers within a second, behind the lines that wait for the UART already.
const ANSWER: Duration = Duration::from_secs(2);
/// How often a command is sent before the board counts as silent.
const ATTEMPTS: u32 = 3;

/// Why a board did not do what it was asked for.
#[derive(Debug, thiserror::Error)]
pub enum BoardError {
    /// The port cannot be opened.
    #[error("{path} cannot be opened: is it the board's port, and may this user open it?")]
    Open {
        /// The port.
        path: PathBuf,
        /// Why.
        #[source]
        source: std::io::Error,
    },
    /// The port was lost.
    #[error("{path} was lost: is the board still connected?")]
    Lost {
        /// The port.
        path: PathBuf,
        /// How.
        #[source]
        source: std::io::Error,
    },
    /// No answer came.
    #[error(
        "no answer on {path}: is it the board's port, is the board powered, and does no other program read it?"
    )]
    Silent {
        /// The port.
        path: PathBuf,
    },
    /// The board refuses.
    #[error("the board refuses: {0}")]
    Refused(#[from] Refusal),
    /// The board cannot run a model.
    #[error("the board cannot run this model, and is safe; it says: {reason}")]
    Model {
        /// Its own words.
        reason: String,
    },
    /// The installation was stopped from here.
    #[error("stopped before the board had all of it")]
    Stopped,
}

/// A board.
#[derive(Debug)]
pub struct Board {
    path: PathBuf,
    port: SerialPort,
    reader: LineReader,
    /// Why it has refused a model, in its own words.
    reason: Option<String>,
}

impl Board {
    /// Opens a serial port, or a pseudo-terminal that stands for one.
    ///
    /// # Errors
    /// [`BoardError::Open`].
    pub fn open(path: &Path) -> Result<Self, BoardError> {
        let open = || {
            let mut port = SerialPort::open(path, BAUD)?;
            port.set_read_timeout(WAIT)?;
            port.set_write_timeout(ANSWER)?;
            // What came before is old.
            port.discard_input_buffer()?;
            Ok(port)
        };
        let port = open().map_err(|source| BoardError::Open {
            path: path.to_owned(),
            source,
        })?;
        Ok(Self {
            path: path.to_owned(),
            port,
            reader: LineReader::new(),
            reason: None,
        })
    }

    /// Sends a command, and gives what `read` makes of its answer. A line that was damaged on the way is sent again.
    ///
    /// # Errors
    /// The port is lost, no answer comes, or the board refuses.
    pub fn ask<T>(
        &mut self,
        command: Command,
        mut read: impl FnMut(&Answer<'_>) -> Option<T>,
    ) -> Result<T, BoardError> {
        let is_block = matches!(command, Command::Block(..));
        let mut refused = None;
        for _ in 0..ATTEMPTS {
            self.port
                .write_all(command.to_string().as_bytes())
                .map_err(|source| self.lost(source))?;
            let answer = self.wait(ANSWER, |line| match line {
                // Of blocks alone: one that was sent twice, to a board that had restarted.
                Line::Answer(Answer::Refused(Refusal::NotBegun)) if !is_block => None,
                Line::Answer(Answer::Refused(refusal)) => Some(Err(*refusal)),
                Line::Answer(answer) => read(answer).map(Ok),
                _ => None,
            })?;
            match answer {
                Some(Ok(answer)) => return Ok(answer),
                // The board says so of a line that was damaged on the way.
                Some(Err(
                    refusal @ (Refusal::Checksum(_)
                    | Refusal::Frame
                    | Refusal::TooLong
                    | Refusal::Block
                    | Refusal::Flash
                    | Refusal::Busy),
                )) => refused = Some(refusal),
                None => {}
                Some(Err(refusal)) => return Err(refusal.into()),
            }
        }
        Err(match refused {
            Some(refusal) => refusal.into(),
            None => BoardError::Silent {
                path: self.path.clone(),
            },
        })
    }

    /// Reads lines until `read` makes something of one; none after this time.
    ///
    /// # Errors
    /// The port is lost.
    pub fn wait<T>(
        &mut self,
        within: Duration,
        mut read: impl FnMut(&Line<'_>) -> Option<T>,
    ) -> Result<Option<T>, BoardError> {
        let end = Instant::now() + within;
        while Instant::now() < end {
            // Byte by byte would be slow, and bytes behind the line belong to the next.
            let mut byte = [0];
            match self.port.read(&mut byte) {
                Ok(0) => return Err(self.lost(ErrorKind::UnexpectedEof.into())),
                Ok(_) => {
                    // A damaged line is no line: what it may have said is asked for again.
                    if let Some(Ok(line)) = self.reader.push(byte[0]) {
                        if let Line::Comment(text) = line
                            && text.starts_with(" model refused: ")
                        {
                            self.reason = Some(text.trim().to_owned());
                        }
                        if let Some(found) = read(&line) {
                            return Ok(Some(found));
                        }
                    }
                }
                Err(error)
                    if matches!(
                        error.kind(),
                        ErrorKind::TimedOut | ErrorKind::WouldBlock | ErrorKind::Interrupted
                    ) => {}
                Err(error) => return Err(self.lost(error)),
            }
        }
        Ok(None)
    }

    fn lost(&self, source: std::io::Error) -> BoardError {
        BoardError::Lost {
            path: self.path.clone(),
            source,
        }
    }
}
