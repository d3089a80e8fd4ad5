//! What is written while a session goes on: a file that only ever grows, a line for each thing that happened, each with a
//! checksum. Wherever it ends, all lines before are whole; it is made into recordings at the end, or by the next start.

mod entry;
mod error;
mod file;
mod name;
mod writer;

pub use self::entry::{Entry, Header};
pub use self::error::{JournalError, WriteError};
pub use self::file::{Flushed, Journal, open};
pub use self::name::ENDING;
pub use self::writer::Writer;

/// What a journal says, as far as it is whole.
#[derive(Clone, PartialEq, Debug, Default)]
pub struct Contents {
    /// In order.
    pub entries: Vec<Entry>,
    /// Bytes behind the last whole line.
    pub left_off: usize,
    /// Whether these are more than one line that was being written: the disk has damaged them.
    pub damaged: bool,
}

/// Reads a journal up to the first line that is not whole.
#[must_use]
pub fn read(bytes: &[u8]) -> Contents {
    let mut contents = Contents::default();
    let mut rest = bytes;
    while let Some(end) = rest.iter().position(|&byte| byte == b'\n') {
        let Some(entry) = Entry::parse(&rest[..end]) else {
            contents.damaged = true;
            break;
        };
        contents.entries.push(entry);
        rest = &rest[end + 1..];
    }
    contents.left_off = rest.len();
    contents
}

#[cfg(test)]
mod tests;
