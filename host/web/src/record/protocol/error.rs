//! Errors of protocols.

use recordings::labels::motion::Motion;

use super::BUILT_IN;

/// Error of a protocol.
#[derive(Clone, PartialEq, Debug, thiserror::Error)]
pub enum ProtocolError {
    /// The name is neither a built-in protocol nor a file.
    #[error(
        "no protocol {name}: built in are {}; or give a TOML file, such as one that `myointent protocols quick > mine.toml` writes",
        BUILT_IN.map(|(name, _)| name).join(", ")
    )]
    UnknownProtocol {
        /// Name as given.
        name: String,
    },
    /// The file of a protocol cannot be read.
    #[error("{name} cannot be read: {error}")]
    UnreadableProtocol {
        /// The file.
        name: String,
        /// Error of the read.
        error: String,
    },
    /// The text of a protocol is not TOML, or has unknown keys.
    #[error("{name}: {error}")]
    Toml {
        /// The file.
        name: String,
        /// Message of the parser, with line and column.
        error: String,
    },
    /// The protocol is neither guided nor free, or both.
    #[error("{name}: expected either `sequence` (guided) or `gestures` (free), found {found}")]
    Course {
        /// The file.
        name: String,
        /// `both` or `neither`.
        found: &'static str,
    },
    /// No motion has the name that a protocol gives.
    #[error("{name}: {found:?} is no gesture: expected {}", Motion::named().map(Motion::name).collect::<Vec<_>>().join(", "))]
    Motion {
        /// The file.
        name: String,
        /// Name in the protocol.
        found: String,
    },
    /// A number of a protocol is out of bounds.
    #[error("{name}: {what}: expected {least} to {most}, found {found}")]
    Number {
        /// The file.
        name: String,
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
    #[error("{name}: [seconds] has no {missing}, which the sequence asks for")]
    NoSeconds {
        /// The file.
        name: String,
        /// The class.
        missing: &'static str,
    },
    /// The sequence does not begin and end with rest, with which gestures are compared.
    #[error("{name}: the sequence must begin and end with relax")]
    Ends {
        /// The file.
        name: String,
    },
    /// A class follows itself: the two cues could not be told apart.
    #[error("{name}: {class} follows itself: ask for it once, for longer")]
    Twice {
        /// The file.
        name: String,
        /// The class.
        class: &'static str,
    },
    /// The gestures of a free protocol lack rest or a second class, or repeat one.
    #[error("{name}: expected relax and at least one gesture, each once in `gestures`")]
    Gestures {
        /// The file.
        name: String,
    },
    /// The key belongs to a guided protocol.
    #[error("{name}: `{key}` means nothing in a free protocol")]
    Meaningless {
        /// The file.
        name: String,
        /// The key.
        key: &'static str,
    },
}
