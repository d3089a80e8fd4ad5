//! Journal of a session in progress: an append-only file with a line for each event, each with a checksum. A cut file is
//! valid up to its last whole line. It becomes recordings at the end of the session or at the next start.

mod entry;
mod file;
mod name;
mod writer;

pub(super) use self::entry::FORMAT;
pub(crate) use self::entry::{Entry, Header};
pub(super) use self::file::LARGEST;
pub(crate) use self::file::{FlushOutcome, Journal, open};
pub(crate) use self::name::ENDING;
pub(crate) use self::writer::Writer;

/// Contents of a journal up to the first damage.
#[derive(Clone, PartialEq, Debug, Default)]
pub(crate) struct Contents {
    /// Entries in order.
    pub(crate) entries: Vec<Entry>,
    /// Number of bytes after the last whole line.
    pub(crate) left_off: usize,
    /// Whether these bytes are more than one unfinished line: the disk has damaged them.
    pub(crate) damaged: bool,
}

/// Reads a journal up to the first line that is not whole.
pub(crate) fn read(bytes: &[u8]) -> Contents {
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
