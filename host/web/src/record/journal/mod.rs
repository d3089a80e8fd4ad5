//! Journal of a session in progress: an append-only file with a line for each event, each with a checksum and a number. All
//! whole lines of a cut or damaged file are read. It becomes recordings at the end of the session or at the next start.

mod entry;
mod writer;

pub use self::entry::FORMAT;
pub use self::entry::{Entry, Header};
pub use self::writer::TOGETHER;
pub use self::writer::Writer;

/// Greatest length of a journal in bytes: 20 hours.
pub const LARGEST: usize = 256 << 20;
/// Length in bytes at which a session has to end, so that data that are still to be written fit.
pub const FULL: usize = LARGEST - (32 << 20);

/// Contents of a journal.
#[derive(Clone, PartialEq, Debug, Default)]
pub struct Contents {
    /// Entries in order, with [`Entry::Damage`] in place of lines that are lost.
    pub entries: Vec<Entry>,
    /// Number of bytes of an unfinished line at the end.
    pub left_off: usize,
    /// Number of the next line.
    due: u32,
    /// Damaged lines since the last whole one.
    damaged: u32,
}

/// Reads all whole lines of a journal, whatever is between them. Lines that are there twice count once.
pub fn read(bytes: &[u8]) -> Contents {
    let bytes = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes);
    let mut contents = Contents::default();
    let end = bytes.iter().rposition(|&byte| byte == b'\n');
    let (lines, last) = bytes.split_at(end.map_or(0, |at| at + 1));
    for line in lines.split(|&byte| byte == b'\n') {
        contents.line(line);
    }
    let mut whole = Entry::whole(last).into_iter();
    if Entry::is_begun(last) && !last.contains(&0) && whole.all(|(own, _)| own.end == last.len()) {
        contents.left_off = last.len();
    } else {
        contents.line(last);
    }
    contents.lose(contents.damaged);
    contents
}

impl Contents {
    /// Whether lines are lost.
    pub fn is_damaged(&self) -> bool {
        let mut entries = self.entries.iter();
        entries.any(|entry| matches!(entry, Entry::Damage { .. }))
    }

    fn line(&mut self, line: &[u8]) {
        let mut end = 0;
        for (place, (number, entry)) in Entry::whole(line) {
            self.between(&line[end..place.start]);
            self.entry(number, entry);
            end = place.end;
        }
        self.between(&line[end..]);
    }

    /// Takes bytes of no whole entry. A single one, or spaces, are the end of a line.
    fn between(&mut self, bytes: &[u8]) {
        if bytes.len() > 1 && !bytes.iter().all(u8::is_ascii_whitespace) {
            self.damaged += 1;
        }
    }

    fn entry(&mut self, number: u32, entry: Entry) {
        if number < self.due {
            return;
        }
        self.lose(number - self.due);
        self.damaged = 0;
        self.due = number.saturating_add(1);
        self.entries.push(entry);
    }

    fn lose(&mut self, lines: u32) {
        if lines > 0 {
            self.entries.push(Entry::Damage { lines });
        }
    }
}
