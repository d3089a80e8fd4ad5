//! Commands for a shell or a scheduler.

use clap::ValueEnum as _;
use myointent::cli::steps::DataArguments;
use training::backend::BackendArguments;

/// Formats words as a command line, each quoted where a shell needs it.
pub(super) fn line(words: &[String]) -> String {
    words
        .iter()
        .map(|word| quoted(word))
        .collect::<Vec<_>>()
        .join(" ")
}

/// Name of the program, as it was called.
pub(super) fn program() -> String {
    std::env::args()
        .next()
        .unwrap_or_else(|| "myointent-research".to_owned())
}

/// Options that every job gets again: `--backend` and `--strict`, if they were given.
pub(super) fn shared_options(data: &DataArguments, backend: BackendArguments) -> Vec<String> {
    let mut words = Vec::new();
    let value = backend
        .backend
        .and_then(|backend| backend.to_possible_value());
    if let Some(value) = value {
        words.extend(["--backend".to_owned(), value.get_name().to_owned()]);
    }
    if data.strict {
        words.push("--strict".to_owned());
    }
    words
}

/// Quotes a word where a shell needs it.
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
        let words = ["runs/fold-1", "my data", "it's", ""].map(str::to_owned);
        assert_eq!(line(&words), r"runs/fold-1 'my data' 'it'\''s' ''");
    }
}
