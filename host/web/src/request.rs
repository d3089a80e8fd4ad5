//! Messages of a page to its source, each a JSON object.

use serde::{Deserialize, Serialize};
use shared::stream::alignment::{Alignment, Arm};
use shared::uart_line::calibration::CalibrateCommand;
use shared::uart_line::command::{AlignCommand, BindCommand, Command};

use crate::record::session::Action;

/// Reason to refuse a message.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Serialize, thiserror::Error)]
#[serde(tag = "name", rename_all = "kebab-case")]
#[expect(missing_docs, reason = "the messages say it")]
pub enum NotDone {
    #[error("there is no such request: load the page again, it may be of another version")]
    Unknown,
    #[error("another page leads, and this one watches")]
    Watches,
    #[error("no session is recorded here: `myointent record` has a page for it")]
    NoSession,
    #[error("there is no board here: `myointent record --port PATH` has one")]
    NoBoard,
    #[error("only a simulated armband is turned here")]
    NoTurn,
}

/// Message of a viewer.
#[derive(Deserialize)]
#[serde(tag = "do", rename_all = "snake_case", deny_unknown_fields)]
pub enum ViewerMessage {
    /// Ask for the source's time; the answer repeats `sent`.
    Ping {
        /// Time of the page in ms.
        sent: f64,
    },
    /// Mark a sample.
    Mark {
        /// Number of the sample.
        sample: u32,
        /// Text of the mark.
        text: String,
    },
    /// Begin or end box and blocks.
    Blocks {
        /// Whether it begins.
        begin: bool,
    },
    /// Keep a note on the session.
    Note {
        /// Text of the note.
        text: String,
    },
    /// Control the recording session.
    Session {
        /// Command.
        #[serde(rename = "wish")]
        command: SessionCommand,
    },
    /// Name the gesture done from now on, in a free session.
    Gesture {
        /// Name of the motion.
        class: String,
    },
    /// Prepare a session, which the browser keeps; without a program only, as the next ones.
    Record {
        /// Name of the person.
        person: String,
        /// Name of a built-in protocol.
        protocol: String,
        /// Time now, in ms since 1970.
        time: f64,
    },
    /// Make recordings of a journal that the browser has kept, whose bytes were given as a file.
    Recover {
        /// Name of the journal.
        name: String,
    },
    /// Install the model, whose bytes were given as a file, on the board.
    Install,
    /// Give the newest recordings as files.
    Keep,
    /// Request to the source.
    #[serde(untagged)]
    Source(SourceRequest),
}

/// Command of a viewer to the session.
#[derive(Clone, Copy, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum SessionCommand {
    /// Begin another session.
    Again,
    /// Tune a model on the recordings.
    Tune,
    /// Install the tuned model on the board.
    Install,
    /// Act on the session in progress.
    #[serde(untagged)]
    Action(Action),
}

/// Request to a source.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Deserialize)]
#[serde(tag = "do", rename_all = "snake_case", deny_unknown_fields)]
pub enum SourceRequest {
    /// Begin an alignment.
    Align,
    /// Cancel the alignment in progress.
    Cancel,
    /// Put an alignment in force that is known.
    Place {
        /// Turn in electrodes, 0 to 7.
        turn: u8,
        /// Whether the armband is on the other arm.
        mirrored: bool,
    },
    /// Begin or end a calibration, or take it back.
    Calibrate {
        /// Wish about the calibration.
        wish: CalibrationWish,
    },
    /// Begin a pairing; boards only.
    Bind,
    /// Turn the armband, or turn it back; simulated persons only.
    Turn,
}

/// Request to a calibration.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum CalibrationWish {
    /// Begin one.
    Begin,
    /// End the one in progress.
    Cancel,
    /// Use the model's own last layer.
    Forget,
    /// Give the file of the calibrated model; without a board only, which keeps the calibration itself.
    Save,
}

impl CalibrationWish {
    /// Command for it; none to save.
    pub const fn command(self) -> Option<CalibrateCommand> {
        Some(match self {
            Self::Begin => CalibrateCommand::Begin { others: false },
            Self::Cancel => CalibrateCommand::Cancel,
            Self::Forget => CalibrateCommand::Forget,
            Self::Save => return None,
        })
    }
}

impl SourceRequest {
    /// Command that asks a board for it; none for a model.
    pub const fn command(self) -> Option<Command> {
        Some(match self {
            Self::Align => Command::Align(AlignCommand::Begin(Arm::Unknown)),
            Self::Cancel => Command::Align(AlignCommand::Cancel),
            Self::Place { turn, mirrored } => {
                Command::Align(AlignCommand::Set(Alignment::new(turn, mirrored)))
            }
            Self::Calibrate { wish } => match wish.command() {
                Some(command) => Command::Calibrate(command),
                None => return None,
            },
            Self::Bind => Command::Bind(BindCommand::Begin),
            Self::Turn => return None,
        })
    }
}
