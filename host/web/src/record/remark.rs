//! Remarks on a session: a note of who leads it, or the score of a task. Each is a line of JSON in the file of notes beside the
//! session's recordings.

use serde::{Deserialize, Serialize};

use crate::blocks;

/// File extension of notes.
pub const NOTES: &str = "notes";

/// Greatest number of characters of a note.
const MOST: usize = 200;

/// Remark on a session.
#[derive(Clone, PartialEq, Eq, Debug, Serialize, Deserialize)]
#[serde(tag = "is", rename_all = "kebab-case")]
pub enum Remark {
    /// Note.
    Note {
        /// Time, UTC.
        at: String,
        /// Text of the note.
        text: String,
    },
    /// Score in box and blocks.
    Blocks {
        /// Time, UTC.
        at: String,
        /// Number of blocks.
        score: u32,
        /// Unit of the score.
        unit: String,
        /// How it is counted.
        counted: String,
    },
}

impl Remark {
    /// Note of a text, cut to 200 characters, each control character a space; none of an empty text.
    pub fn note(at: String, text: &str) -> Option<Self> {
        let text = text.replace(char::is_control, " ");
        let text: String = text.trim().chars().take(MOST).collect();
        (!text.is_empty()).then_some(Self::Note { at, text })
    }

    /// Score in box and blocks.
    pub fn blocks(at: String, score: u32) -> Self {
        Self::Blocks {
            at,
            score,
            unit: format!("blocks in {} s", blocks::SECONDS),
            counted:
                "a fist and then an open hand, each recognised for 0.2 s; from the first fist on"
                    .to_owned(),
        }
    }

    /// Line of the remark, with its end.
    pub fn line(&self) -> String {
        // Strings and numbers always become JSON.
        serde_json::to_string(self).unwrap_or_default() + "\n"
    }

    /// Remarks of a file of notes. Other lines are left out.
    pub fn read(text: &str) -> Vec<Self> {
        let lines = text.lines();
        lines
            .filter_map(|line| serde_json::from_str(line).ok())
            .collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_remark_is_read_as_it_was_written_and_a_note_is_one_line() {
        let note = Remark::note("now".to_owned(), " left\u{2028}arm,\n\"loose\" ").unwrap();
        let score = Remark::blocks("now".to_owned(), 14);
        let text = note.line() + "{\"is\":\"no\n" + &score.line();
        assert_eq!(Remark::read(&text), [note, score]);
        assert_eq!(Remark::note(String::new(), "\u{1} \u{1}"), None);
        let Some(Remark::Note { text, .. }) = Remark::note(String::new(), &"ä".repeat(300)) else {
            panic!("no note");
        };
        assert_eq!(text, "ä".repeat(200));
    }
}
