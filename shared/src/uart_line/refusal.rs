//! Refusals of commands, and their texts.

use serde::Serialize;

use crate::installation::Refused;

/// Why a command is not carried out. `Display` is for people.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug, Serialize, thiserror::Error)]
#[serde(tag = "name", content = "expected", rename_all = "kebab-case")]
#[expect(missing_docs, reason = "the messages say it")]
pub enum Refusal {
    #[error("more than 112 bytes without a line end: begin anew with `$`")]
    TooLong,
    #[error("not framed as `$...*HH` in ASCII: begin anew with `$`")]
    Frame,
    #[error("checksum {0:02X} expected: send the line again")]
    Checksum(u8),
    #[error("no such command: is the program of another version?")]
    Unknown,
    #[error("arguments that the command does not have: is the program of another version?")]
    Arguments,
    #[error("the board runs no model: flash one")]
    NoModel,
    #[error("no armband streams: put it on and wait")]
    NoStream,
    #[error("the armband's address was given when the program was built: build it without")]
    BuiltIn,
    #[error("not done within a second: ask again")]
    Busy,
    #[error("a UART has no room for it: ask over the board's USB")]
    NoRoom,
    #[error("the file is longer than the board's flash region, or too short to be a model")]
    Length,
    #[error("the block was damaged on the way: send it again")]
    Block,
    #[error("no installation is in progress: begin it")]
    NotBegun,
    #[error("the file is no model that this program can run: the line says why")]
    Model,
    #[error("flash was not written: send it again")]
    Flash,
}

impl From<Refused> for Refusal {
    fn from(refused: Refused) -> Self {
        match refused {
            Refused::Length => Self::Length,
            Refused::NotBegun => Self::NotBegun,
            Refused::NoSuchBlock => Self::Arguments,
            Refused::Busy => Self::Busy,
            Refused::Flash => Self::Flash,
            Refused::Model => Self::Model,
        }
    }
}
