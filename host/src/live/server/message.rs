//! Messages of a viewer over its websocket, each a JSON object.

use serde::Deserialize;

use crate::live::recorder::RecorderRequest;
use crate::record::session::Action;

/// Message of a viewer.
#[derive(Deserialize)]
#[serde(tag = "do", rename_all = "snake_case", deny_unknown_fields)]
pub(super) enum ViewerMessage {
    /// Ask for the server's time; the answer repeats `sent`.
    Ping { sent: f64 },
    /// Mark a sample.
    Mark { sample: u32, text: String },
    /// Begin an alignment.
    Align,
    /// Cancel the alignment.
    Cancel,
    /// Put a known alignment in force.
    Place { turn: u8, mirrored: bool },
    /// Begin a pairing on the board.
    Bind,
    /// Control the recording session.
    Session {
        #[serde(rename = "wish")]
        command: SessionCommand,
    },
    /// Name the gesture done from now on, in a free session.
    Gesture { class: String },
}

impl ViewerMessage {
    /// Name of the request in the table of rights.
    pub(super) const fn name(&self) -> &'static str {
        match self {
            Self::Ping { .. } => "ping",
            Self::Mark { .. } => "mark",
            Self::Align => "align",
            Self::Cancel => "cancel",
            Self::Place { .. } => "place",
            Self::Bind => "bind",
            Self::Session {
                command: SessionCommand::Install,
            } => "install",
            Self::Session { .. } => "session",
            Self::Gesture { .. } => "gesture",
        }
    }
}

/// Command of a viewer to the session.
#[derive(Clone, Copy, Deserialize)]
#[serde(rename_all = "snake_case")]
pub(super) enum SessionCommand {
    Begin,
    Repeat,
    Hold,
    Finish,
    Again,
    Tune,
    Install,
}

impl SessionCommand {
    pub(super) const fn request(self) -> RecorderRequest {
        match self {
            Self::Begin => RecorderRequest::Action(Action::Begin),
            Self::Repeat => RecorderRequest::Action(Action::Repeat),
            Self::Hold => RecorderRequest::Action(Action::Hold),
            Self::Finish => RecorderRequest::Action(Action::Finish),
            Self::Again => RecorderRequest::NewSession,
            Self::Tune => RecorderRequest::Tune,
            Self::Install => RecorderRequest::Install,
        }
    }
}
