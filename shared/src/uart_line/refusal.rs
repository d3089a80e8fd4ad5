//! Refusals of commands, and their texts.

/// Why a command is not carried out. `Display` is for people.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug, thiserror::Error)]
pub enum Refusal {
    /// The line does not end.
    #[error("more than 112 bytes without a line end: begin anew with `$`")]
    TooLong,
    /// The line is not framed.
    #[error("not framed as `$...*HH` in ASCII: begin anew with `$`")]
    Frame,
    /// The checksum is wrong.
    #[error("checksum {0:02X} expected: send the line again")]
    Checksum(u8),
    /// No such command.
    #[error("no such command: is the program of another version?")]
    Unknown,
    /// The command has no such arguments.
    #[error("arguments that the command does not have: is the program of another version?")]
    Arguments,
    /// There is no model.
    #[error("the board runs no model: flash one")]
    NoModel,
    /// There is no stream.
    #[error("no armband streams: put it on and wait")]
    NoStream,
    /// The armband cannot be changed.
    #[error("the armband's address was given when the program was built: build it without")]
    BuiltIn,
    /// It was not done in time.
    #[error("not done within a second: ask again")]
    Busy,
    /// The line is too slow for it.
    #[error("a UART has no room for it: ask over the board's USB")]
    NoRoom,
    /// The file does not fit.
    #[error("the file is longer than the board's flash region, or too short to be a model")]
    Length,
    /// The block's own checksum is wrong.
    #[error("the block was damaged on the way: send it again")]
    Block,
    /// No file was begun.
    #[error("no installation is in progress: begin it")]
    NotBegun,
    /// Not a model for this program.
    #[error("the file is no model that this program can run: the line says why")]
    Model,
    /// Flash was not written.
    #[error("the flash memory did not take it: send it again")]
    Flash,
}
