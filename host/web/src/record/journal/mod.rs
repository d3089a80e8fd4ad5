//! Journal of a session in progress: an append-only file with a line for each event, each with a checksum and a number. All
//! whole lines of a cut or damaged file are read. It becomes recordings at the end of the session or at the next start.

mod entry;
mod writer;

pub use self::entry::{Entry, FORMAT, Header, OLDEST_FORMAT};
pub use self::writer::{TOGETHER, Writer};

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
}

/// Reads all whole lines of a journal; their numbers tell which are lost. Lines that are there twice count once. An editor may have
/// put a byte order mark before the first line, and CR LF behind each.
pub fn read(bytes: &[u8]) -> Contents {
    let mut contents = Contents::default();
    // Number of the next line, and damaged lines since the last whole one.
    let (mut due, mut damaged) = (0_u32, 0);
    let bytes = bytes.strip_prefix("\u{feff}".as_bytes()).unwrap_or(bytes);
    let lines = bytes.split(|&byte| byte == b'\n');
    let mut lines: Vec<_> = lines
        .map(|line| line.strip_suffix(b"\r").unwrap_or(line))
        .collect();
    if let Some(last) = lines.pop_if(|last| Entry::is_begun(last)) {
        contents.left_off = last.len();
    }
    for line in lines.into_iter().filter(|line| !line.is_empty()) {
        match Entry::parse(line) {
            Some((number, entry)) if number >= due => {
                contents.lose(number - due);
                contents.entries.push(entry);
                (due, damaged) = (number.saturating_add(1), 0);
            }
            Some(_) => {}
            None => damaged += Entry::count(line),
        }
    }
    contents.lose(damaged);
    contents
}

impl Contents {
    /// Whether lines are lost.
    pub fn is_damaged(&self) -> bool {
        let mut entries = self.entries.iter();
        entries.any(|entry| matches!(entry, Entry::Damage { .. }))
    }

    fn lose(&mut self, lines: u32) {
        if lines > 0 {
            self.entries.push(Entry::Damage { lines });
        }
    }
}
