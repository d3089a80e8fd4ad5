//! Foreign text in messages: bounded, and without control characters for a terminal.

/// Characters of a text that a message quotes.
const QUOTED: usize = 60;

/// A text with control and formatting characters escaped (`\u{1b}`), everything else as it is.
pub fn printable(text: &str) -> String {
    let escaped = |c: char| match c {
        '"' | '\'' | '\\' => vec![c],
        c => c.escape_debug().collect(),
    };
    text.chars().flat_map(escaped).collect()
}

/// The first characters of a text, printable; with its length if there are more.
pub(crate) fn excerpt(text: &str) -> String {
    match text.char_indices().nth(QUOTED) {
        None => printable(text),
        Some((end, _)) => format!("{}... ({} bytes)", printable(&text[..end]), text.len()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_a_terminal_obeys_is_escaped_and_nothing_else() {
        assert_eq!(
            printable("r\u{e9}sum\u{e9} \"1\" 握拳 \\"),
            "r\u{e9}sum\u{e9} \"1\" 握拳 \\"
        );
        let escaped = r"\u{1b}[2J\u{9b}\r\n\u{202e}";
        assert_eq!(printable("\u{1b}[2J\u{9b}\r\n\u{202e}"), escaped);
    }

    #[test]
    fn a_long_text_is_cut_between_characters() {
        let text = "\u{63e1}".repeat(100);
        let expected = format!("{}... (300 bytes)", "\u{63e1}".repeat(60));
        assert_eq!(excerpt(&text), expected);
        assert_eq!(excerpt("12x"), "12x");
    }
}
