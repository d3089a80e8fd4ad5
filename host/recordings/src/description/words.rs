//! Words of labels: a file's own, and what they mean here.

use std::collections::{BTreeMap, HashMap};

use serde::Deserialize;

use crate::labels::motion::Motion;
use crate::readers::error::excerpt::excerpt;
use crate::readers::label_file::from_text;

/// A word or number of a label, or the name or number of a column.
#[derive(Clone, PartialEq, Debug, Deserialize)]
#[serde(untagged)]
pub(super) enum Word {
    /// A whole number.
    Whole(i64),
    /// A number.
    Number(f64),
    /// Text.
    Text(String),
}

/// A word as it is compared: without spaces around it; numbers in one spelling, so that `2.0` is `2`.
pub(crate) fn plain(word: &str) -> String {
    let word = word.trim();
    let number = word.parse::<f64>().ok();
    match number.filter(|number| number.is_finite()) {
        // -0 is 0.
        Some(number) => (number + 0.0).to_string(),
        None => word.to_owned(),
    }
}

impl Word {
    fn plain(&self) -> String {
        match self {
            Self::Whole(number) => number.to_string(),
            Self::Number(number) => plain(&number.to_string()),
            Self::Text(text) => plain(text),
        }
    }
}

/// Word that stands for all words that are in no list.
pub(super) const ALL_OTHERS: &str = "*";

/// Meaning of each word: `labels = { relax = ["rest", 0], open = [1], other = [2, 3], unknown = ["*"] }`.
#[derive(Clone, PartialEq, Debug, Default, Deserialize)]
#[serde(try_from = "BTreeMap<String, Vec<Word>>")]
pub(crate) struct Labels(BTreeMap<String, Motion>);

impl TryFrom<BTreeMap<String, Vec<Word>>> for Labels {
    /// Reason why a list has no meaning.
    type Error = String;

    fn try_from(lists: BTreeMap<String, Vec<Word>>) -> Result<Self, String> {
        let mut labels = BTreeMap::new();
        for (class, words) in lists {
            let motion = Motion::from_name(&class).filter(|motion| motion.name() == class);
            let motion = motion.ok_or_else(|| {
                format!(
                    "expected lists of words under relax, open, close, wave-in, wave-out, pinch, other, a kind of other \
                     movement such as point, or unknown, found \"{class}\""
                )
            })?;
            for word in words {
                if let Word::Number(number) = word
                    && !number.is_finite()
                {
                    return Err(format!(
                        "expected words and finite numbers, found {number}: write it as a word, in quotes"
                    ));
                }
                let word = word.plain();
                if labels.insert(word.clone(), motion).is_some() {
                    return Err(format!("expected each word once, found \"{word}\" twice"));
                }
            }
        }
        Ok(Self(labels))
    }
}

impl Labels {
    /// Whether no word has a meaning.
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// Whether a word is in a list.
    pub fn has(&self, word: &str) -> bool {
        self.0.contains_key(&plain(word))
    }

    /// Meaning of a word; without lists, that of a label's name or number.
    ///
    /// # Errors
    /// A word in no list, or one that is no label.
    pub fn meaning(&self, word: &str) -> Result<Motion, String> {
        if self.is_empty() {
            return from_text(word);
        }
        self.motion(word).ok_or_else(|| {
            format!(
                "expected a label that is listed in `labels` of the description, found \"{}\": add it to one of the \
                 lists, such as unknown",
                excerpt(word)
            )
        })
    }

    /// Meaning of a word; `None` if no list has it and no list is for all others.
    pub fn motion(&self, word: &str) -> Option<Motion> {
        let own = self.0.get(&plain(word));
        own.or_else(|| self.0.get(ALL_OTHERS)).copied()
    }
}

/// Words of a recording's samples, each distinct one kept once.
#[derive(Clone, PartialEq, Debug, Default)]
pub(super) struct Words {
    /// Words in the order in which they come, each with the row of its first sample.
    distinct: Vec<(String, usize)>,
    /// Number of each distinct word.
    numbers: HashMap<String, usize>,
    /// Number of the word of each sample.
    pub at: Vec<usize>,
}

impl Words {
    /// One word for all samples.
    pub fn of_file(word: &str, samples: usize) -> Self {
        let mut words = Self::default();
        words.push(word);
        words.at = vec![0; samples];
        words
    }

    /// Adds the word of the next sample.
    pub fn push(&mut self, word: &str) {
        let row = self.at.len();
        // Labels change seldom: the last one first.
        let last = self.at.last().copied();
        let same = last.filter(|&last| self.distinct[last].0 == word);
        let number = same.unwrap_or_else(|| {
            let word = plain(word);
            *self.numbers.entry(word).or_insert_with_key(|word| {
                self.distinct.push((word.clone(), row));
                self.distinct.len() - 1
            })
        });
        self.at.push(number);
    }

    /// Distinct words, each with the row of its first sample.
    pub fn distinct(&self) -> &[(String, usize)] {
        &self.distinct
    }
}

impl<T: AsRef<str>> FromIterator<T> for Words {
    /// Collects the word of each sample.
    fn from_iter<I: IntoIterator<Item = T>>(texts: I) -> Self {
        let mut words = Self::default();
        texts.into_iter().for_each(|text| words.push(text.as_ref()));
        words
    }
}

#[cfg(test)]
mod tests {
    use shared::intent::Intent;

    use super::*;
    use crate::recording::movement::MovementKind;

    fn labels(text: &str) -> Result<Labels, String> {
        #[derive(Deserialize)]
        struct File {
            labels: Labels,
        }
        let file = toml::from_str::<File>(&format!("labels = {text}"));
        file.map(|file| file.labels)
            .map_err(|error| error.to_string())
    }

    #[test]
    fn words_and_numbers_have_one_meaning() {
        let labels = labels(
            "{ relax = [0, \"rest\"], open = [1.0], point = [\"p\"], other = [-2], unknown = [\"?\"] }",
        );
        let labels = labels.unwrap();
        for (word, motion) in [
            ("0", Some(Motion::RELAX)),
            (" 0.0", Some(Motion::RELAX)),
            ("-0", Some(Motion::RELAX)),
            ("rest", Some(Motion::RELAX)),
            ("Rest", None),
            ("01", Some(Motion::Intent(Intent::Open))),
            ("p", Some(Motion::Other(MovementKind::Point))),
            ("-2", Some(Motion::Other(MovementKind::Other))),
            ("?", Some(Motion::Unknown)),
            ("", None),
            ("nan", None),
        ] {
            assert_eq!(labels.motion(word), motion, "{word}");
        }
        let star = self::labels("{ open = [\"o\"], other = [\"*\"] }").unwrap();
        assert_eq!(star.motion("x"), Some(Motion::Other(MovementKind::Other)));
        assert_eq!((star.has("o"), star.has("x")), (true, false));
    }

    #[test]
    fn each_word_is_kept_once() {
        let words: Words = ["0", "0", "1", " 1.0", "0", "rest"].into_iter().collect();
        assert_eq!(words.at, [0, 0, 1, 1, 0, 2]);
        let expected = [("0", 0), ("1", 2), ("rest", 5)].map(|(word, row)| (word.to_owned(), row));
        assert_eq!(words.distinct(), expected);
    }

    #[test]
    fn a_million_different_words_are_kept() {
        const MANY: usize = 1_000_000;
        let words: Words = (0..MANY).map(|row| row.to_string()).collect();
        assert_eq!(words.distinct().len(), MANY);
    }
}
