//! Why a text is no protocol.

use shared::intent::Intent;

use super::BUILT_IN;

/// Why a text is no protocol.
#[derive(Clone, PartialEq, Debug, thiserror::Error)]
pub enum ProtocolError {
    /// Neither a built-in one nor a file.
    #[error(
        "no protocol {name}: built in are {}; or give a TOML file, such as one that `myointent protocols quick > mine.toml` writes",
        built_in()
    )]
    Unknown {
        /// As it was asked for.
        name: String,
    },
    /// The file cannot be read.
    #[error("{name} cannot be read: {error}")]
    Unreadable {
        /// The file.
        name: String,
        /// Why.
        error: String,
    },
    /// No TOML, or with keys that no protocol has.
    #[error("{name}: {error}")]
    Toml {
        /// The file.
        name: String,
        /// With line and column.
        error: String,
    },
    /// What it says cannot be done.
    #[error("{name}: {fault}")]
    Wrong {
        /// The file.
        name: String,
        /// What.
        fault: ProtocolFault,
    },
}

/// What cannot be done.
#[derive(Clone, PartialEq, Debug, thiserror::Error)]
pub enum ProtocolFault {
    /// Neither guided nor free, or both.
    #[error("expected either `sequence` (guided) or `gestures` (free), found {found}")]
    Kind {
        /// Both or none of them.
        found: &'static str,
    },
    /// No class has this name.
    #[error("{found:?} is no class: expected {}", Intent::ALL.map(Intent::name).join(", "))]
    Class {
        /// The name.
        found: String,
    },
    /// A number out of bounds.
    #[error("{what}: expected {least} to {most}, found {found}")]
    Number {
        /// Of what.
        what: String,
        /// Least value.
        least: f64,
        /// Greatest value.
        most: f64,
        /// What was given.
        found: f64,
    },
    /// A class of the sequence has no duration.
    #[error("[seconds] has no {missing}, which the sequence asks for")]
    NoSeconds {
        /// The class.
        missing: &'static str,
    },
    /// Rest is where the levels of a gesture are compared with.
    #[error("the sequence must begin and end with relax")]
    Ends,
    /// Two cues in a row that nobody could tell apart.
    #[error("{class} follows itself: ask for it once, for longer")]
    Twice {
        /// The class.
        class: &'static str,
    },
    /// Nothing to record.
    #[error("expected relax and at least one gesture, each once in `gestures`")]
    Gestures,
    /// A key of a guided protocol in a free one, or the other way round.
    #[error("`{key}` means nothing in a free protocol")]
    Meaningless {
        /// The key.
        key: &'static str,
    },
}

fn built_in() -> String {
    BUILT_IN.map(|(name, _)| name).join(", ")
}
