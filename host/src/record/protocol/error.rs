//! Errors of a protocol.

use shared::intent::Intent;

use super::BUILT_IN;

/// Why a protocol is refused.
#[derive(Clone, PartialEq, Debug, thiserror::Error)]
pub enum ProtocolError {
    /// The name is neither a built-in protocol nor a file.
    #[error(
        "no protocol {name}: built in are {}; or give a TOML file, such as one that `myointent protocols quick > mine.toml` writes",
        built_in()
    )]
    Unknown {
        /// Name as given.
        name: String,
    },
    /// The file cannot be read.
    #[error("{name} cannot be read: {error}")]
    Unreadable {
        /// The file.
        name: String,
        /// Error of the read.
        error: String,
    },
    /// The text is no TOML, or has unknown keys.
    #[error("{name}: {error}")]
    Toml {
        /// The file.
        name: String,
        /// Message of the parser, with line and column.
        error: String,
    },
    /// The protocol is impossible.
    #[error("{name}: {fault}")]
    Wrong {
        /// The file.
        name: String,
        /// Reason.
        fault: ProtocolFault,
    },
}

/// Why a protocol is impossible.
#[derive(Clone, PartialEq, Debug, thiserror::Error)]
pub enum ProtocolFault {
    /// The protocol is neither guided nor free, or both.
    #[error("expected either `sequence` (guided) or `gestures` (free), found {found}")]
    Kind {
        /// `both` or `neither`.
        found: &'static str,
    },
    /// No class has this name.
    #[error("{found:?} is no class: expected {}", Intent::ALL.map(Intent::name).join(", "))]
    Class {
        /// The name.
        found: String,
    },
    /// A number is out of bounds.
    #[error("{what}: expected {least} to {most}, found {found}")]
    Number {
        /// Name of the number.
        what: String,
        /// Least value.
        least: f64,
        /// Greatest value.
        most: f64,
        /// Value in the file.
        found: f64,
    },
    /// A class of the sequence has no duration.
    #[error("[seconds] has no {missing}, which the sequence asks for")]
    NoSeconds {
        /// The class.
        missing: &'static str,
    },
    /// The sequence does not begin and end with rest, with which gestures are compared.
    #[error("the sequence must begin and end with relax")]
    Ends,
    /// A class follows itself: nobody could tell the two cues apart.
    #[error("{class} follows itself: ask for it once, for longer")]
    Twice {
        /// The class.
        class: &'static str,
    },
    /// The gestures lack rest or a second class, or repeat one.
    #[error("expected relax and at least one gesture, each once in `gestures`")]
    Gestures,
    /// The key belongs to a guided protocol.
    #[error("`{key}` means nothing in a free protocol")]
    Meaningless {
        /// The key.
        key: &'static str,
    },
}

fn built_in() -> String {
    BUILT_IN.map(|(name, _)| name).join(", ")
}
