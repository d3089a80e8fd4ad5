//! A board on a serial port, or a pseudo-terminal that stands for one. It is looked for until it is there, and again after
//! it was lost.

use std::cell::RefCell;
use std::io::ErrorKind;
use std::path::PathBuf;
use std::time::{Duration, Instant};

use anyhow::Context as _;
use serial2::SerialPort;
use shared::model::Encode;
use shared::model::encoder::HostEncoder;
use shared::model::file::Model;
use shared::uart_line::command::{AlignCommand, Command};
use shared::units::Millis;

use super::dialogue::{Dialogue, Heard, Losses};
use super::scored::Scored;
use super::{Context, Request};
use crate::board::BAUD;
use crate::live::event::Event;

/// How long a read waits for bytes: the longest delay that a page sees.
const WAIT: Duration = Duration::from_millis(10);
/// Between two attempts to open the port.
const AGAIN: Duration = Duration::from_millis(500);
/// A board that does not take a command for so long is not there.
const WRITE: Duration = Duration::from_secs(1);

const NOTHING_YET: &str = "open; nothing heard yet";

/// A board.
#[derive(Debug)]
pub(crate) struct Board {
    pub(crate) path: PathBuf,
    /// For the scores.
    pub(crate) model: Option<Vec<u8>>,
}

impl Board {
    /// Reads the board until it is stopped.
    ///
    /// # Errors
    /// When the model is refused.
    pub(crate) fn run(&self, context: &Context) -> anyhow::Result<()> {
        let Some(bytes) = &self.model else {
            self.read::<HostEncoder<'_>>(context, None);
            return Ok(());
        };
        let model = Model::parse(bytes).context("the model is refused")?;
        let encoder = HostEncoder::new(&model)?;
        let outputs = RefCell::default();
        let mut state = encoder.fresh();
        let scored = Scored::new(&model, encoder, &mut state, &outputs)?;
        context.hub.publish(&Event::of_model(&model));
        self.read(context, Some(scored));
        Ok(())
    }

    fn read<E: Encode>(&self, context: &Context, mut scored: Option<Scored<'_, E>>) {
        let mut losses = Losses::default();
        while !context.stop.requested() {
            let lost = match self.open() {
                Ok(port) => {
                    self.tell(context, false, NOTHING_YET);
                    let session = Session {
                        context,
                        port,
                        dialogue: Dialogue::new(now(context), losses),
                        told: NOTHING_YET,
                        scored: scored.as_mut(),
                    };
                    let (lost, counted) = session.run(self);
                    losses = counted;
                    lost
                }
                Err(error) => error,
            };
            if context.stop.requested() {
                break;
            }
            context.hub.forget_stream();
            let lost = match lost.kind() {
                ErrorKind::UnexpectedEof => "the port was closed".to_owned(),
                _ => lost.to_string(),
            };
            let detail = format!("{lost}; looking for it again");
            self.tell(context, false, &detail);
            wait(context, AGAIN);
        }
    }

    fn open(&self) -> std::io::Result<SerialPort> {
        let mut port = SerialPort::open(&self.path, BAUD)?;
        port.set_read_timeout(WAIT)?;
        port.set_write_timeout(WRITE)?;
        // What came before is old.
        port.discard_input_buffer()?;
        Ok(port)
    }

    fn tell(&self, context: &Context, connected: bool, detail: &str) {
        context.hub.publish(&Event::Source {
            kind: "port",
            name: self.path.display().to_string(),
            connected,
            detail: detail.to_owned(),
        });
    }
}

/// One connection.
struct Session<'c, 'r, E: Encode> {
    context: &'c Context,
    port: SerialPort,
    dialogue: Dialogue,
    /// What viewers know about it; empty: it is heard.
    told: &'static str,
    scored: Option<&'c mut Scored<'r, E>>,
}

impl<E: Encode> Session<'_, '_, E> {
    /// Until the port is lost, with the reason, or the program stopped; also what was lost on the line.
    fn run(mut self, board: &Board) -> (std::io::Error, Losses) {
        let mut buffer = [0; 4096];
        let error = loop {
            if self.context.stop.requested() {
                // As it was found.
                let _ = self.send(Command::Raw(false));
                break ErrorKind::Interrupted.into();
            }
            if let Err(error) = self.commands() {
                break error;
            }
            match self.port.read(&mut buffer) {
                Ok(0) => break ErrorKind::UnexpectedEof.into(),
                Ok(length) => self.bytes(&buffer[..length]),
                Err(error) if is_patient(&error) => {}
                Err(error) => break error,
            }
            self.watch(board);
        };
        if let Some(scored) = &mut self.scored {
            scored.disconnected(now(self.context));
        }
        (error, self.dialogue.losses())
    }

    fn commands(&mut self) -> std::io::Result<()> {
        while let Some(command) = self.dialogue.command(now(self.context)) {
            self.send(command)?;
        }
        while let Ok(request) = self.context.requests.try_recv() {
            self.send(Command::Align(match request {
                Request::Align => AlignCommand::Begin,
                Request::CancelAlignment => AlignCommand::Cancel,
            }))?;
        }
        Ok(())
    }

    fn send(&self, command: Command) -> std::io::Result<()> {
        self.port.write_all(command.to_string().as_bytes())
    }

    fn bytes(&mut self, bytes: &[u8]) {
        let hub = &self.context.hub;
        let now = now(self.context);
        let scored = &mut self.scored;
        self.dialogue.bytes(now, hub.now(), bytes, |heard| {
            let Some(scored) = scored else {
                if let Heard::Event(event) = heard {
                    hub.publish(&event);
                }
                return;
            };
            match heard {
                Heard::Event(event) => hub.publish(&event),
                Heard::Restart => drop(scored.disconnected(now)),
                Heard::Alignment(alignment) => scored.set_alignment(alignment),
                Heard::Samples(report, missing) => {
                    match missing {
                        Some(0) => {}
                        Some(missing) => drop(scored.gap(now, missing)),
                        None => drop(scored.disconnected(now)),
                    }
                    let mut index = report.first;
                    for sample in report.samples {
                        if let Some(scores) = scored.sample(now, index, sample).scores {
                            hub.publish(&scores);
                        }
                        index = index.plus(1);
                    }
                }
            }
        });
    }

    /// Tells viewers when a board is heard, and when it no longer is.
    fn watch(&mut self, board: &Board) {
        let heard = self.dialogue.has_heard();
        let state = match (heard, self.dialogue.is_silent(now(self.context))) {
            (true, false) => "",
            (true, true) => "no line for 5 s: is the board still powered?",
            (false, false) => NOTHING_YET,
            (false, true) => {
                "no line of a board for 5 s: is this its port, and does no other program read it?"
            }
        };
        if state != self.told {
            self.told = state;
            board.tell(self.context, state.is_empty(), state);
        }
    }
}

/// Whether a read may be tried again: nothing came in time.
fn is_patient(error: &std::io::Error) -> bool {
    matches!(
        error.kind(),
        ErrorKind::TimedOut | ErrorKind::WouldBlock | ErrorKind::Interrupted
    )
}

fn now(context: &Context) -> Millis {
    context.hub.millis()
}

/// Waits, but not longer than the program runs.
fn wait(context: &Context, duration: Duration) {
    let end = Instant::now() + duration;
    while !context.stop.requested() && Instant::now() < end {
        std::thread::sleep(WAIT);
    }
}
