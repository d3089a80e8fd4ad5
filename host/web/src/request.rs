//! Messages of a page to its source, each a JSON object.

use serde::Deserialize;
use shared::stream::alignment::{Alignment, Arm};
use shared::uart_line::calibration::CalibrateCommand;
use shared::uart_line::command::{AlignCommand, BindCommand, Command};
use shared::units::CHANNELS;

use crate::record::session::Action;

/// Reason to refuse a message that is none of these.
pub const UNKNOWN: &str =
    "there is no such request: load the page again, it may be of another version";

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
    /// Begin an alignment.
    Align,
    /// Cancel the alignment.
    Cancel,
    /// Put a known alignment in force.
    Place {
        /// Turn in electrodes, 0 to 7.
        turn: u8,
        /// Whether the armband is on the other arm.
        mirrored: bool,
    },
    /// Begin or end a calibration, or take it back.
    Calibrate {
        /// Command.
        #[serde(rename = "wish")]
        command: CalibrationWish,
    },
    /// Turn a simulated armband, or turn it back.
    Turn,
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
    /// Begin a pairing on the board.
    Bind,
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
}

impl ViewerMessage {
    /// Name of the request, for its refusal.
    pub const fn name(&self) -> &'static str {
        match self {
            Self::Ping { .. } => "ping",
            Self::Mark { .. } => "mark",
            Self::Align => "align",
            Self::Cancel => "cancel",
            Self::Place { .. } => "place",
            Self::Calibrate { .. } => "calibrate",
            Self::Turn => "turn",
            Self::Blocks { .. } => "blocks",
            Self::Note { .. } => "note",
            Self::Bind => "bind",
            Self::Install
            | Self::Session {
                command: SessionCommand::Install,
            } => "install",
            Self::Session { .. } => "session",
            Self::Gesture { .. } => "gesture",
            Self::Record { .. } => "record",
            Self::Recover { .. } => "recover",
            Self::Keep => "keep",
        }
    }

    /// Request to the source that the message makes; none if it makes none.
    pub fn for_source(&self) -> Option<SourceRequest> {
        Some(match *self {
            Self::Align => SourceRequest::Align,
            Self::Cancel => SourceRequest::CancelAlignment,
            Self::Place { turn, mirrored } if usize::from(turn) < CHANNELS => {
                SourceRequest::SetAlignment(Alignment::new(turn, mirrored))
            }
            Self::Calibrate { command } => command.for_source(),
            Self::Bind => SourceRequest::Bind,
            Self::Turn => SourceRequest::Turn,
            _ => return None,
        })
    }
}

/// Command of a viewer to a calibration.
#[derive(Clone, Copy, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum CalibrationWish {
    /// Begin one.
    Begin,
    /// End the one in progress.
    Cancel,
    /// Use the model's own last layer.
    Forget,
    /// Save the calibrated model as a file.
    Save,
}

impl CalibrationWish {
    const fn for_source(self) -> SourceRequest {
        SourceRequest::Calibrate(match self {
            Self::Begin => CalibrateCommand::Begin { others: false },
            Self::Cancel => CalibrateCommand::Cancel,
            Self::Forget => CalibrateCommand::Forget,
            Self::Save => return SourceRequest::SaveModel,
        })
    }
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
#[derive(Clone, PartialEq, Eq, Debug)]
pub enum SourceRequest {
    /// Begin an alignment.
    Align,
    /// Cancel the alignment in progress.
    CancelAlignment,
    /// Put an alignment in force that is known.
    SetAlignment(Alignment),
    /// Begin, end or forget a calibration.
    Calibrate(CalibrateCommand),
    /// Give the file of the calibrated model; without a board only, which keeps the calibration itself.
    SaveModel,
    /// Begin a pairing; boards only.
    Bind,
    /// Turn the armband, or turn it back; simulated persons only.
    Turn,
}

impl SourceRequest {
    /// Command that asks a board for it; none for a model.
    pub const fn command(&self) -> Option<Command> {
        Some(match self {
            Self::Align => Command::Align(AlignCommand::Begin(Arm::Unknown)),
            Self::CancelAlignment => Command::Align(AlignCommand::Cancel),
            Self::SetAlignment(known) => Command::Align(AlignCommand::Set(*known)),
            Self::Calibrate(command) => Command::Calibrate(*command),
            Self::Bind => Command::Bind(BindCommand::Begin),
            Self::SaveModel | Self::Turn => return None,
        })
    }
}
