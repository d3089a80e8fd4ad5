//! Line to a board on a serial port: bytes both ways, looked for again when it is lost; and installations of a model.

mod advice;

use std::io::{Error, ErrorKind};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{self, Receiver, Sender};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

use serial2::SerialPort;
use web::board::leave;
use web::event::Event;
use web::outcome::InstallationState;

use self::advice::Advice;
use super::stream::Input;
use crate::board::{self, ModelFile, port};
use execution::progress::with_causes;

/// Longest time that one read waits for bytes: the longest delay that a page sees.
const WAIT: Duration = Duration::from_millis(10);
/// Pause between two attempts to open the port.
const AGAIN: Duration = Duration::from_millis(100);
/// Time after which a board that does not take a command is not there.
const WRITE: Duration = Duration::from_secs(1);

/// Something for the board.
#[derive(Debug)]
pub(super) enum ToBoard {
    /// Line of text.
    Line(String),
    /// Model to install.
    Install(Vec<u8>),
}

/// Thread of the line.
#[derive(Debug)]
pub(super) struct Line {
    sender: Sender<ToBoard>,
    stop: Arc<AtomicBool>,
    thread: JoinHandle<()>,
}

impl Line {
    /// Starts the thread; with `imu` it turns the movement off at its end, as it does the raw stream.
    pub(super) fn start(path: PathBuf, imu: bool, inputs: Sender<Input>) -> std::io::Result<Self> {
        let (sender, received) = mpsc::channel();
        let stop = Arc::<AtomicBool>::default();
        let state = State {
            path,
            leave: leave(imu),
            stop: stop.clone(),
            received,
            inputs,
        };
        let thread = std::thread::Builder::new()
            .name("line".to_owned())
            .spawn(move || state.run())?;
        Ok(Self {
            sender,
            stop,
            thread,
        })
    }

    pub(super) fn send(&self, message: ToBoard) {
        // A thread that has ended by a panic has printed that.
        let _ = self.sender.send(message);
    }

    /// Leaves the board as it was found, and ends the thread.
    pub(super) fn stop(self) {
        self.stop.store(true, Ordering::Relaxed);
        let _ = self.thread.join();
    }
}

/// State of the line.
struct State {
    path: PathBuf,
    /// Commands to send before the port is closed.
    leave: String,
    stop: Arc<AtomicBool>,
    received: Receiver<ToBoard>,
    inputs: Sender<Input>,
}

/// Reason why a connection ended.
enum End {
    /// The port is lost, or the program was stopped.
    Lost(Error),
    /// Model to install; the port is free for it.
    Installs(Vec<u8>),
}

impl From<Error> for End {
    fn from(error: Error) -> Self {
        Self::Lost(error)
    }
}

impl State {
    fn run(self) {
        let mut missing = (String::new(), Vec::new());
        while !self.is_stopped() {
            let ended = match port::open(&self.path, WAIT, WRITE) {
                Ok(port) => {
                    missing.0.clear();
                    match self.early() {
                        Some(model) => End::Installs(model),
                        None => self.connection(&port),
                    }
                }
                Err(error) => End::Lost(error),
            };
            match ended {
                _ if self.is_stopped() => return,
                End::Installs(model) => {
                    let why = "a model is being installed".to_owned();
                    self.tell(Input::Lost(why, Vec::new()));
                    self.install(model);
                }
                End::Lost(error) => {
                    let Advice { why, steps } = Advice::of(&error, &self.path, &existing());
                    let told = (format!("{why}; looking for it again"), steps);
                    // What has not changed is told once.
                    if told != missing {
                        self.tell(Input::Lost(told.0.clone(), told.1.clone()));
                        missing = told;
                    }
                    let end = Instant::now() + AGAIN;
                    while !self.is_stopped() && Instant::now() < end {
                        std::thread::sleep(WAIT);
                    }
                }
            }
        }
    }

    fn is_stopped(&self) -> bool {
        self.stop.load(Ordering::Relaxed)
    }

    fn tell(&self, input: Input) {
        // An engine that has ended needs nothing.
        let _ = self.inputs.send(input);
    }

    /// Takes the model to install that was asked for before there was a connection. Drops all lines.
    fn early(&self) -> Option<Vec<u8>> {
        let models = self
            .received
            .try_iter()
            .filter_map(|message| match message {
                ToBoard::Install(model) => Some(model),
                ToBoard::Line(_) => None,
            });
        models.last()
    }

    /// Carries bytes until the port is lost or needed, or the program is stopped.
    fn connection(&self, port: &SerialPort) -> End {
        self.tell(Input::Opened);
        let ended = self.carry(port);
        ended
            .err()
            .unwrap_or(End::Lost(ErrorKind::Interrupted.into()))
    }

    fn carry(&self, port: &SerialPort) -> Result<(), End> {
        let mut buffer = [0; 4096];
        // A lost line has no stream either.
        let leave = || drop(port.write_all(self.leave.as_bytes()));
        while !self.is_stopped() {
            while let Ok(message) = self.received.try_recv() {
                match message {
                    ToBoard::Line(line) => port.write_all(line.as_bytes())?,
                    ToBoard::Install(model) => {
                        leave();
                        return Err(End::Installs(model));
                    }
                }
            }
            match port.read(&mut buffer) {
                Ok(0) => return Err(Error::from(ErrorKind::UnexpectedEof).into()),
                Ok(length) => self.tell(Input::Heard(buffer[..length].to_vec())),
                Err(error) if port::is_timeout(&error) => {}
                Err(error) => return Err(error.into()),
            }
        }
        leave();
        Ok(())
    }

    /// Installs a model and tells viewers its progress and result.
    fn install(&self, model: Vec<u8>) {
        let publish = |state| self.tell(Input::Event(Event::Installing(state)));
        let running = InstallationState::running("outputs are safe until the board has all of it");
        publish(running.clone());
        let send = || -> anyhow::Result<u32> {
            let file = ModelFile::new(&model)?;
            let stopped = || self.is_stopped();
            let of = file.blocks();
            let mut published = None;
            board::install(&self.path, file, stopped, |blocks| {
                // Viewers need the progress in percent only.
                let percent = 100 * blocks / of.max(1);
                if published.replace(percent) != Some(percent) {
                    let running = running.clone();
                    publish(InstallationState {
                        blocks,
                        of,
                        ..running
                    });
                }
            })?;
            Ok(file.checksum())
        };
        let sent = send();
        let is_installed = sent.is_ok();
        publish(match sent {
            Ok(checksum) => InstallationState {
                state: "done",
                text: format!("model {checksum:08x} is on the board and in use"),
                ..running
            },
            Err(error) => InstallationState {
                state: "failed",
                text: format!(
                    "{}. Install again: it goes on where this one ended",
                    with_causes(&*error)
                ),
                ..running
            },
        });
        if is_installed {
            self.tell(Input::Model(model));
        }
    }
}

/// Serial ports of this computer.
fn existing() -> Vec<PathBuf> {
    SerialPort::available_ports().unwrap_or_default()
}

/// Reason why a port cannot be opened and what helps, as lines of text.
pub(crate) fn no_port(error: &std::io::Error, path: &Path) -> String {
    let Advice { why, steps } = Advice::of(error, path, &existing());
    format!("{why}\n{}", steps.join("\n"))
}

#[cfg(all(test, unix))]
mod tests;
