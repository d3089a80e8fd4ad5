//! A board: its line, and beside it the scores of a model on this computer.

use serde::Serialize;
use shared::uart_line::command::Command;
use shared::units::Millis;

use crate::calibration::Calibration;
use crate::dialogue::{BoardEvent, Dialogue, Losses};
use crate::event::Event;
use crate::installer::{Installer, ModelFile};
use crate::outcome::InstallationState;
use crate::said::Said;
use crate::scored_pipeline::ScoredPipeline;

/// State of a board that is not heard.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Serialize, thiserror::Error)]
#[serde(tag = "name", rename_all = "kebab-case")]
#[expect(missing_docs, reason = "the messages say it")]
pub enum Unheard {
    #[error("open; nothing heard yet")]
    NothingYet,
    #[error("no line for 5 s: is the board still powered?")]
    NoLine,
    #[error("no line of a board for 5 s: is this its port, and does no other program read it?")]
    NoBoard,
}

impl Unheard {
    /// The state in words.
    pub fn said(self) -> Said {
        Said::of("unheard", &self)
    }

    /// Steps that may help on a port; none while nothing is wrong.
    pub fn steps(self, port: &str) -> Vec<Said> {
        if self == Self::NothingYet {
            return Vec::new();
        }
        [
            Step::Power,
            Step::Port { port },
            Step::Close,
            Step::Firmware,
        ]
        .map(|step| Said::of("silent", &step))
        .into()
    }
}

/// Step that may help where a board is not heard.
#[derive(Serialize, thiserror::Error, Debug)]
#[serde(tag = "name", rename_all = "kebab-case")]
enum Step<'p> {
    #[error("Is the board powered? Its LED blinks while it looks for an armband.")]
    Power,
    #[error("Is {port} the board's port? Another device may have taken the name.")]
    Port { port: &'p str },
    #[error("Close every other program that reads this port: it takes part of the lines.")]
    Close,
    #[error("Has the board the firmware of this project? The guide `flash` says how it gets it.")]
    Firmware,
}

/// Connection to a board.
pub struct Board {
    dialogue: Dialogue,
    imu: bool,
    scored: Option<ScoredPipeline>,
    /// Whether scores are shown always, and now.
    has_scores: (bool, bool),
    calibration: Calibration,
    /// State that viewers know; none while the board is heard.
    published: Option<Unheard>,
}

/// Change of the state of a board.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct Change {
    /// State; none while the board is heard.
    pub state: Option<Unheard>,
}

impl Board {
    /// State before the first connection. Scores are shown always, or once the board runs the model; with `imu` the board is asked
    /// for the armband's movement too.
    pub fn new(now: Millis, imu: bool, scored: Option<ScoredPipeline>, always: bool) -> Self {
        Self {
            dialogue: Dialogue::new(now, Losses::default(), imu),
            imu,
            scored,
            has_scores: (always, always),
            calibration: Calibration::default(),
            published: Some(Unheard::NothingYet),
        }
    }

    /// Begins a connection; continues the losses of earlier ones, and an installation.
    pub fn connected(&mut self, now: Millis) {
        self.dialogue.connected(now, self.imu);
        self.calibration = Calibration::default();
        self.published = Some(Unheard::NothingYet);
    }

    /// Shows the scores of another model. Returns the event that describes it.
    pub fn set_model(&mut self, scored: ScoredPipeline) -> Event {
        self.has_scores.1 = true;
        Event::of_model(self.scored.insert(scored).model())
    }

    /// Installs a model. Emits why it cannot.
    pub fn install(&mut self, now: Millis, file: &[u8], emit: &mut dyn FnMut(Event)) {
        match ModelFile::new(file) {
            Ok(file) => self.dialogue.install(Installer::new(file, now)),
            Err(error) => emit(Event::Installing(InstallationState::failed(&error))),
        }
    }

    /// Lets time pass without a connection.
    pub fn wait(&mut self, now: Millis) {
        self.dialogue.wait(now);
    }

    /// Emits what is new of an installation. Returns the file once the board runs it.
    pub fn installation(&mut self, emit: &mut dyn FnMut(Event)) -> Option<&[u8]> {
        let (state, file) = self.dialogue.installation()?;
        emit(Event::Installing(state));
        file
    }

    /// Returns the next command that is due; to be called until no command is.
    pub fn command(&mut self, now: Millis) -> Option<Command> {
        self.dialogue.command(now)
    }

    /// Takes received bytes and emits what they say; `at` is the time in the events.
    pub fn bytes(&mut self, now: Millis, at: f64, bytes: &[u8], emit: &mut dyn FnMut(Event)) {
        let Self {
            dialogue,
            scored,
            has_scores,
            calibration,
            ..
        } = self;
        dialogue.bytes(now, at, bytes, |event| {
            match event {
                BoardEvent::Publish(event) => {
                    if let (Event::Board { model, .. }, Some(scored)) = (&event, &scored) {
                        let own = scored.model();
                        let is_same = *model == Some(format!("{:08x}", own.checksum));
                        if is_same {
                            calibration.know(own.header.dimensions.vocabulary.classes());
                        }
                        let before = has_scores.1;
                        has_scores.1 = has_scores.0 || is_same;
                        if has_scores.1 && !before {
                            emit(Event::of_model(own));
                        }
                    }
                    return emit(event);
                }
                BoardEvent::Calibration(report, in_use) => {
                    if let Some(event) = calibration.event(at, report, in_use) {
                        emit(event);
                    }
                    return;
                }
                _ => {}
            }
            let Some(scored) = scored else {
                return;
            };
            match event {
                BoardEvent::Publish(_) | BoardEvent::Calibration(..) => {}
                BoardEvent::Restart => drop(scored.disconnected(now)),
                BoardEvent::Alignment(alignment) => scored.set_alignment(alignment),
                BoardEvent::Samples(report, missing) => {
                    match missing {
                        Some(0) => {}
                        Some(missing) => drop(scored.gap(now, missing)),
                        None => drop(scored.disconnected(now)),
                    }
                    let mut index = report.first;
                    for sample in report.samples {
                        let output = scored.sample(now, at, index, sample);
                        if let Some(scores) = output.scores.filter(|_| has_scores.1) {
                            emit(scores);
                        }
                        index = index.plus(1);
                    }
                }
            }
        });
    }

    /// Returns the state of the board if it has changed.
    pub fn change(&mut self, now: Millis) -> Option<Change> {
        let is_silent = self.dialogue.is_silent(now);
        let state = match (self.dialogue.has_received(), is_silent) {
            (true, false) => None,
            (true, true) => Some(Unheard::NoLine),
            (false, false) => Some(Unheard::NothingYet),
            (false, true) => Some(Unheard::NoBoard),
        };
        if state == self.published {
            return None;
        }
        self.published = state;
        Some(Change { state })
    }

    /// Handles the end of the connection.
    pub fn ended(&mut self, now: Millis) {
        if let Some(scored) = &mut self.scored {
            scored.disconnected(now);
        }
    }
}

/// Commands that turn off what the program has turned on, to be sent before the port is closed.
pub fn leave(imu: bool) -> String {
    let imu = imu.then_some(Command::Imu(false));
    let commands = [Command::Raw(false)].into_iter().chain(imu);
    commands.map(|command| command.to_string()).collect()
}
