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

    #[test]
    fn a_long_text_is_cut_between_characters() {
        let text = "\u{63e1}".repeat(100);
        let expected = format!("{}... (300 bytes)", "\u{63e1}".repeat(60));
        assert_eq!(excerpt(&text), expected);
        assert_eq!(excerpt("12x"), "12x");
    }
}
