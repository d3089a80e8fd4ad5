//! Sentences of the program for people: in English, and by a name with values, from which a page makes its own language.

use std::fmt::{self, Display};
use std::io;

use serde::{Serialize, Serializer};
use serde_json::{Map, Value};

/// Sentence for people.
#[derive(Clone, PartialEq, Eq, Debug, Default, Serialize)]
pub struct Said {
    /// English.
    pub text: String,
    /// Name of the sentence: `finding.seldom`; empty for one that has English alone.
    #[serde(skip_serializing_if = "String::is_empty")]
    pub name: String,
    /// Values that it is filled with.
    #[serde(flatten)]
    values: Map<String, Value>,
}

impl Said {
    /// Sentence of an enum's variant, which is serialized with its `name`. A variant that is not has English alone.
    pub fn of(kind: &str, said: &(impl Display + Serialize)) -> Self {
        let named = serde_json::to_value(said);
        let mut values = match named {
            Ok(Value::Object(values)) => values,
            _ => Map::new(),
        };
        let name = match values.remove("name") {
            Some(Value::String(name)) => format!("{kind}.{name}"),
            _ => String::new(),
        };
        let text = said.to_string();
        Self { text, name, values }
    }

    /// Sentence that has no values.
    pub fn named(name: String, text: impl Display) -> Self {
        let text = text.to_string();
        let values = Map::new();
        Self { text, name, values }
    }

    /// Sentence of an error of the operating system, named for its kind: `os.NotFound`.
    pub fn of_os(error: &io::Error) -> Self {
        Self::named(format!("os.{:?}", error.kind()), error)
    }

    /// Sentence that has English alone.
    pub fn plain(text: impl Display) -> Self {
        Self::named(String::new(), text)
    }
}

impl Display for Said {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.text.fmt(formatter)
    }
}

/// Serializes an error of the operating system as a sentence.
///
/// # Errors
/// When the output cannot be written.
pub fn os<S: Serializer>(error: &io::Error, output: S) -> Result<S::Ok, S::Error> {
    Said::of_os(error).serialize(output)
}

/// English of an error and of its causes.
pub fn chain(error: &dyn std::error::Error) -> String {
    let causes = std::iter::successors(Some(error), |error| error.source());
    let causes: Vec<_> = causes.map(ToString::to_string).collect();
    causes.join(": ")
}

/// Serializes an error as its English and that of its causes.
///
/// # Errors
/// When the output cannot be written.
pub fn as_chain<S: Serializer>(
    error: &impl std::error::Error,
    output: S,
) -> Result<S::Ok, S::Error> {
    output.serialize_str(&chain(error))
}

/// Serializes a value as its English.
///
/// # Errors
/// When the output cannot be written.
pub fn as_text<S: Serializer>(value: &impl Display, output: S) -> Result<S::Ok, S::Error> {
    output.collect_str(value)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[derive(Serialize, thiserror::Error, Debug)]
    #[serde(tag = "name", rename_all = "kebab-case")]
    enum Trouble {
        #[error("{path}: {why}")]
        NotWritten { path: &'static str, why: Said },
        #[error("it is {0}")]
        #[serde(skip)]
        Other(u8),
    }

    #[test]
    fn a_variant_is_said_with_its_name_and_values_and_one_without_in_english_alone() {
        let why = Said::named("os.NotFound".to_owned(), "not there");
        let trouble = Said::of("storage", &Trouble::NotWritten { path: "a", why });
        assert_eq!(
            serde_json::to_value(trouble).unwrap(),
            serde_json::json!({
                "text": "a: not there", "name": "storage.not-written", "path": "a",
                "why": { "text": "not there", "name": "os.NotFound" },
            })
        );
        let other = Said::of("storage", &Trouble::Other(1));
        assert_eq!(other, Said::plain("it is 1"));
    }
}
