//! Commands for a shell or a scheduler.

/// A command line of these words, each quoted where a shell needs it.
pub(super) fn line(words: &[String]) -> String {
    words
        .iter()
        .map(|word| quoted(word))
        .collect::<Vec<_>>()
        .join(" ")
}

/// The program's own name, as it was called.
pub(super) fn program() -> String {
    std::env::args()
        .next()
        .unwrap_or_else(|| "myointent-research".to_owned())
}

/// A word, quoted for a shell where needed.
fn quoted(word: &str) -> String {
    let plain = |c: char| c.is_ascii_alphanumeric() || "-_./,=".contains(c);
    if !word.is_empty() && word.chars().all(plain) {
        word.to_owned()
    } else {
        format!("'{}'", word.replace('\'', r"'\''"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_are_quoted_where_a_shell_needs_it() {
        let words = ["runs/study-1", "my data", "it's", ""].map(str::to_owned);
        assert_eq!(line(&words), r"runs/study-1 'my data' 'it'\''s' ''");
    }
}
