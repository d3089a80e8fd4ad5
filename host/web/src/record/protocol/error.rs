//! Errors of protocols.

use recordings::labels::motion::Motion;

use super::BUILT_IN;

/// Error of a protocol.
#[derive(Clone, PartialEq, Debug, thiserror::Error)]
pub enum ProtocolError {
    /// The name is neither a built-in protocol nor a file.
    #[error(
        "no protocol {0}: built in are {names}; or give a TOML file, such as one that `myointent protocols quick > mine.toml` writes",
        names = BUILT_IN.map(|(name, _)| name).join(", ")
    )]
    UnknownProtocol(String),
    /// The file of a protocol cannot be read: its name, and the error.
    #[error("{0} cannot be read: {1}")]
    UnreadableProtocol(String, String),
    /// A protocol is impossible: its name, and the reason.
    #[error("{0}: {1}")]
    Impossible(String, Fault),
}

/// Reason why a protocol is impossible.
#[derive(Clone, PartialEq, Debug, thiserror::Error)]
pub enum Fault {
    /// The text is not TOML, or has unknown keys: message of the parser, with line and column.
    #[error("{0}")]
    Toml(String),
    /// It is neither guided nor free, or both: `both` or `neither`.
    #[error("expected either `sequence` (guided) or `gestures` (free), found {0}")]
    Course(&'static str),
    /// No motion has this name.
    #[error("{0:?} is no gesture: expected {names}", names = Motion::named().map(Motion::name).collect::<Vec<_>>().join(", "))]
    Motion(String),
    /// A number is out of bounds: its name, least and greatest value, value in the file.
    #[error("{0}: expected {1} to {2}, found {3}")]
    Number(String, f64, f64, f64),
    /// A class of the sequence has no duration.
    #[error("[seconds] has no {0}, which the sequence asks for")]
    NoSeconds(&'static str),
    /// The sequence does not begin and end with rest, with which gestures are compared.
    #[error("the sequence must begin and end with relax")]
    Ends,
    /// A class follows itself: the two cues could not be told apart.
    #[error("{0} follows itself: ask for it once, for longer")]
    Twice(&'static str),
    /// The gestures of a free protocol lack rest or a second class, or repeat one.
    #[error("expected relax and at least one gesture, each once in `gestures`")]
    Gestures,
    /// The key belongs to a guided protocol.
    #[error("`{0}` means nothing in a free protocol")]
    Meaningless(&'static str),
}
