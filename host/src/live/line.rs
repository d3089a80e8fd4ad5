//! Line to a board on a serial port: bytes both ways, looked for again when it is lost.

mod advice;

use std::io::ErrorKind;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{self, Receiver, Sender};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

use serial2::SerialPort;
use web::board::leave;

use self::advice::Advice;
use super::stream::Input;
use crate::board::port;

/// Longest time that one read waits for bytes: the longest delay that a page sees.
const WAIT: Duration = Duration::from_millis(10);
/// Pause between two attempts to open the port.
const AGAIN: Duration = Duration::from_millis(100);
/// Time after which a board that does not take a command is not there.
const WRITE: Duration = Duration::from_secs(1);

/// Thread of the line.
#[derive(Debug)]
pub(super) struct Line {
    sender: Sender<String>,
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

    /// Sends a line of text.
    pub(super) fn send(&self, line: String) {
        // A thread that has ended by a panic has printed that.
        let _ = self.sender.send(line);
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
    received: Receiver<String>,
    inputs: Sender<Input>,
}

impl State {
    fn run(self) {
        let mut missing = None;
        while !self.is_stopped() {
            let ended = port::open(&self.path, WAIT, WRITE).and_then(|port| {
                missing = None;
                // What was asked for before there was a connection is not done.
                self.received.try_iter().for_each(drop);
                self.tell(Input::Port(Ok(())));
                self.carry(&port)
            });
            let Err(error) = ended else {
                return;
            };
            let advice = Advice::of(&error, &self.path, &existing());
            // What has not changed is told once.
            if missing.as_ref() != Some(&advice) {
                self.tell(Input::Port(Err((advice.again(), advice.steps.clone()))));
                missing = Some(advice);
            }
            let end = Instant::now() + AGAIN;
            while !self.is_stopped() && Instant::now() < end {
                std::thread::sleep(WAIT);
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

    /// Carries bytes until the program is stopped.
    ///
    /// # Errors
    /// When the port is lost.
    fn carry(&self, port: &SerialPort) -> std::io::Result<()> {
        let mut buffer = [0; 4096];
        while !self.is_stopped() {
            while let Ok(line) = self.received.try_recv() {
                port.write_all(line.as_bytes())?;
            }
            match port.read(&mut buffer) {
                Ok(0) => return Err(ErrorKind::UnexpectedEof.into()),
                Ok(length) => self.tell(Input::Heard(buffer[..length].to_vec())),
                Err(error) if port::is_timeout(&error) => {}
                Err(error) => return Err(error),
            }
        }
        // A lost line has no stream either.
        let _ = port.write_all(self.leave.as_bytes());
        Ok(())
    }
}

/// Serial ports of this computer.
fn existing() -> Vec<PathBuf> {
    SerialPort::available_ports().unwrap_or_default()
}

/// Reason why a port cannot be opened and what helps, as lines of text.
pub(crate) fn no_port(error: &std::io::Error, path: &Path) -> String {
    let Advice { why, steps } = Advice::of(error, path, &existing());
    let lines = std::iter::once(why).chain(steps);
    let lines: Vec<_> = lines.map(|line| line.text).collect();
    lines.join("\n")
}

#[cfg(all(test, unix))]
mod tests;
