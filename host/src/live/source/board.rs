//! A board on a serial port or pseudo-terminal. The port is opened again after it was lost or used for an installation.

mod advice;

use std::io::ErrorKind;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use serial2::SerialPort;
use shared::uart_line::command::Command;
use shared::units::Millis;
use web::Losses;
use web::board::{Board, Change, NOTHING_YET, silent as board_is_silent};
use web::event::Event;
use web::outcome::InstallationState;
use web::request::SourceRequest;
use web::scored_pipeline::ScoredPipeline;

use self::advice::Advice;
use super::Context;
use crate::board::{self, ModelFile, port};
use execution::progress::with_causes;

/// Longest time that one read waits for bytes: the longest delay that a page sees.
const WAIT: Duration = Duration::from_millis(10);
/// Pause between two attempts to open the port.
const AGAIN: Duration = Duration::from_millis(100);
/// Time after which a board that does not take a command is not there.
const WRITE: Duration = Duration::from_secs(1);

/// Board on a serial port.
#[derive(Debug)]
pub(crate) struct BoardSource {
    pub(crate) path: PathBuf,
    /// Bytes of a model file, for the scores; none shows no scores.
    pub(crate) model: Option<Vec<u8>>,
}

impl BoardSource {
    /// Reads the board until it is stopped. After an installation, the scores are those of the new model.
    ///
    /// # Errors
    /// When the model is refused.
    pub(crate) fn run(mut self, context: &Context) -> anyhow::Result<()> {
        let mut losses = Losses::default();
        while let Some(model) = self.show(context, &mut losses)? {
            self.publish(context, false, "a model is being installed", Vec::new());
            if install(&self.path, &model, context) {
                self.model = Some(model);
            }
        }
        Ok(())
    }

    /// Shows the board until it is stopped, or returns a model to install.
    fn show(&self, context: &Context, losses: &mut Losses) -> anyhow::Result<Option<Vec<u8>>> {
        let mut scored = self
            .model
            .as_deref()
            .map(ScoredPipeline::open)
            .transpose()?;
        if let Some(scored) = &scored {
            context.hub.publish(&Event::of_model(scored.model()));
        }
        let mut missing = (String::new(), Vec::new());
        while !context.stop.requested() {
            let ended = match port::open(&self.path, WAIT, WRITE) {
                Ok(port) => {
                    missing.0.clear();
                    if let model @ Some(_) = early_installation(context) {
                        return Ok(model);
                    }
                    self.publish(context, false, NOTHING_YET, Vec::new());
                    let session = BoardConnection {
                        context,
                        port,
                        board: Board::new(now(context), *losses, context.imu, scored.as_mut()),
                    };
                    let (ended, counted) = session.run(self);
                    *losses = counted;
                    ended
                }
                Err(error) => ConnectionEnd::Lost(error),
            };
            if context.stop.requested() {
                break;
            }
            context.hub.forget_stream();
            let error = match ended {
                ConnectionEnd::Installs(model) => return Ok(Some(model)),
                ConnectionEnd::Lost(error) => error,
            };
            let Advice { why, steps } = Advice::of(&error, &self.path, &existing());
            let told = (format!("{why}; looking for it again"), steps);
            // What has not changed is told once.
            if told != missing {
                self.publish(context, false, &told.0, told.1.clone());
                missing = told;
            }
            wait(context, AGAIN);
        }
        Ok(None)
    }

    fn publish(&self, context: &Context, connected: bool, detail: &str, steps: Vec<String>) {
        context.hub.publish(&Event::Source {
            kind: "port",
            name: self.path.display().to_string(),
            connected,
            detail: detail.to_owned(),
            steps,
        });
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

/// Reason why a connection ended.
enum ConnectionEnd {
    /// The port is lost, or the program was stopped.
    Lost(std::io::Error),
    /// Model to install; the port is free for it.
    Installs(Vec<u8>),
}

impl From<std::io::Error> for ConnectionEnd {
    fn from(error: std::io::Error) -> Self {
        Self::Lost(error)
    }
}

/// State of one connection.
struct BoardConnection<'c> {
    context: &'c Context,
    port: SerialPort,
    board: Board<'c>,
}

impl BoardConnection<'_> {
    /// Runs until the port is lost or needed, or the program is stopped. Also returns the losses on the line.
    fn run(mut self, source: &BoardSource) -> (ConnectionEnd, Losses) {
        let hub = &self.context.hub;
        let mut buffer = [0; 4096];
        let ended = loop {
            if self.context.stop.requested() {
                self.leave();
                break ConnectionEnd::Lost(ErrorKind::Interrupted.into());
            }
            if let Err(ended) = self.commands() {
                break ended;
            }
            match self.port.read(&mut buffer) {
                Ok(0) => break ConnectionEnd::Lost(ErrorKind::UnexpectedEof.into()),
                Ok(length) => {
                    let emit = &mut |event| hub.publish(&event);
                    self.board
                        .bytes(now(self.context), hub.now(), &buffer[..length], emit);
                }
                Err(error) if port::is_timeout(&error) => {}
                Err(error) => break ConnectionEnd::Lost(error),
            }
            if let Some(Change { state, is_silent }) = self.board.change(now(self.context)) {
                let port = source.path.display().to_string();
                let steps = if is_silent {
                    board_is_silent(&port)
                } else {
                    Vec::new()
                };
                source.publish(self.context, state.is_empty(), state, steps);
            }
        };
        self.board.ended(now(self.context));
        (ended, self.board.losses())
    }

    fn commands(&mut self) -> Result<(), ConnectionEnd> {
        while let Some(command) = self.board.command(now(self.context)) {
            self.send(command)?;
        }
        while let Ok(request) = self.context.requests.try_recv() {
            if let Some(command) = request.command() {
                self.send(command)?;
            }
            if let SourceRequest::Install(model) = request {
                self.leave();
                return Err(ConnectionEnd::Installs(model));
            }
        }
        Ok(())
    }

    /// Turns the raw stream and the movement off again. Errors are ignored: a lost line has no stream either.
    fn leave(&self) {
        let _ = self.send(Command::Raw(false));
        if self.context.imu {
            let _ = self.send(Command::Imu(false));
        }
    }

    fn send(&self, command: Command) -> std::io::Result<()> {
        self.port.write_all(command.to_string().as_bytes())
    }
}

/// Takes the model to install that was asked for before there was a connection. Drops all other requests.
fn early_installation(context: &Context) -> Option<Vec<u8>> {
    let installs = |request: &SourceRequest| matches!(request, SourceRequest::Install(_));
    match context.requests.try_iter().filter(installs).last() {
        Some(SourceRequest::Install(model)) => Some(model),
        _ => None,
    }
}

/// Installs a model and tells viewers its progress and result. Returns whether it is in use now.
fn install(path: &Path, model: &[u8], context: &Context) -> bool {
    let publish = |state| context.hub.publish(&Event::Installing(state));
    let running = InstallationState::running("outputs are safe until the board has all of it");
    publish(running.clone());
    let send = || -> anyhow::Result<u32> {
        let file = ModelFile::new(model)?;
        let stopped = || context.stop.requested();
        let of = file.blocks();
        let mut published = None;
        board::install(path, file, stopped, |blocks| {
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
    is_installed
}

fn now(context: &Context) -> Millis {
    context.hub.millis()
}

/// Waits, at most until the program is stopped.
fn wait(context: &Context, duration: Duration) {
    let end = Instant::now() + duration;
    while !context.stop.requested() && Instant::now() < end {
        std::thread::sleep(WAIT);
    }
}

#[cfg(all(test, unix))]
mod tests;
