//! Text from files for a terminal: without characters that a terminal obeys.

/// A text with control and formatting characters escaped (`\u{1b}`), everything else as it is.
pub fn printable(text: &str) -> String {
    let escaped = |c: char| match c {
        '"' | '\'' | '\\' => vec![c],
        c => c.escape_debug().collect(),
    };
    text.chars().flat_map(escaped).collect()
}

/// The lines of a text, each [`printable`].
pub fn printable_lines(text: &str) -> String {
    let lines: Vec<String> = text.lines().map(printable).collect();
    lines.join("\n")
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
        let lines = printable_lines("\u{1b}[2J\r\n\u{9b}\n");
        assert_eq!(lines, "\\u{1b}[2J\n\\u{9b}");
    }
}
