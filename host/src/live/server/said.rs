//! Requests of a viewer: the messages of its websocket, each a JSON object.

use serde::Deserialize;

use crate::live::recorder::Wish;
use crate::record::session::Action;

/// Request of a viewer.
#[derive(Deserialize)]
#[serde(tag = "do", rename_all = "snake_case", deny_unknown_fields)]
pub(super) enum Said {
    /// Ask for the server's time; the answer repeats `sent`.
    Ping { sent: f64 },
    /// Mark a sample.
    Mark { sample: u32, text: String },
    /// Begin an alignment.
    Align,
    /// Cancel the alignment.
    Cancel,
    /// Begin a pairing on the board.
    Bind,
    /// Control the recording session.
    Session { wish: SessionWish },
    /// Name the gesture done from now on, in a free session.
    Gesture { class: String },
}

impl Said {
    /// Name of the request in the table of rights.
    pub(super) const fn name(&self) -> &'static str {
        match self {
            Self::Ping { .. } => "ping",
            Self::Mark { .. } => "mark",
            Self::Align => "align",
            Self::Cancel => "cancel",
            Self::Bind => "bind",
            Self::Session {
                wish: SessionWish::Install,
            } => "install",
            Self::Session { .. } => "session",
            Self::Gesture { .. } => "gesture",
        }
    }
}

/// Request of a viewer to a session.
#[derive(Clone, Copy, Deserialize)]
#[serde(rename_all = "snake_case")]
pub(super) enum SessionWish {
    Begin,
    Repeat,
    Hold,
    Finish,
    Again,
    Tune,
    Install,
}

impl SessionWish {
    pub(super) const fn wish(self) -> Wish {
        match self {
            Self::Begin => Wish::Action(Action::Begin),
            Self::Repeat => Wish::Action(Action::Repeat),
            Self::Hold => Wish::Action(Action::Hold),
            Self::Finish => Wish::Action(Action::Finish),
            Self::Again => Wish::Again,
            Self::Tune => Wish::Tune,
            Self::Install => Wish::Install,
        }
    }
}
