//! Foreign text in messages: bounded and printable.

use execution::printable::printable;

/// Characters of a text that a message quotes.
const QUOTED: usize = 60;

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
    use crate::readers::error::array;
    use crate::readers::label_file::from_text;
    use crate::readers::mat;
    use crate::readers::table::number;

    #[test]
    fn a_long_text_is_cut_between_characters() {
        let text = "\u{63e1}".repeat(100);
        let expected = format!("{}... (300 bytes)", "\u{63e1}".repeat(60));
        assert_eq!(excerpt(&text), expected);
        assert_eq!(excerpt("12x"), "12x");
    }

    #[test]
    fn a_message_quotes_a_printable_excerpt_of_a_long_text() {
        let found = "\u{1b}[2J\u{9b}31m\u{202e}\rxxxx".to_owned() + &"x".repeat(10_000_000);
        for message in [
            number(1, &found).unwrap_err(),
            from_text(&found).unwrap_err(),
            array("(n, 8)", &found),
            mat::fault(&found),
        ] {
            assert!(message.len() < 400, "{} bytes", message.len());
            assert!(message.contains("xxxx"), "{message}");
            let raw = |c: char| c.is_control() || c == '\u{202e}';
            assert!(!message.contains(raw), "{message:?}");
        }
    }
}
