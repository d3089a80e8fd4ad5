//! What a viewer says: the messages of its websocket, each a JSON object.

use serde::Deserialize;

use crate::live::recorder::Wish;
use crate::record::session::Action;

/// What a viewer says.
#[derive(Deserialize)]
#[serde(tag = "do", rename_all = "snake_case", deny_unknown_fields)]
pub(super) enum Said {
    /// What is the time there? Answered with `sent` as it is.
    Ping { sent: f64 },
    /// Remember this sample.
    Mark { sample: u32, text: String },
    /// Begin an alignment.
    Align,
    /// End it.
    Cancel,
    /// Begin a pairing of the board.
    Bind,
    /// Of the recording session.
    Session { wish: SessionWish },
    /// Free: this is done from now on.
    Gesture { class: String },
}

impl Said {
    /// Its name in the table of rights.
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

/// What a viewer wants of a session.
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
