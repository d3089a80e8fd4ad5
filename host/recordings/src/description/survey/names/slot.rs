//! Part of all paths: a folder, or a part of the file's name.

use std::collections::BTreeSet;

use crate::description::pattern::{Field, Part};
use crate::labels::motion::Motion;

/// Words in front of a number or a name that say what it is.
#[rustfmt::skip]
const HINTS: [(Field, &[&str]); 4] = [
    (Field::Person, &["s", "p", "sub", "subj", "subject", "user", "person", "participant", "patient", "id"]),
    (Field::Gesture, &["c", "class", "classe", "g", "gesture", "m", "motion", "movement", "label", "pose"]),
    (Field::Trial, &["r", "rep", "repetition", "t", "trial", "take", "run", "n", "nr", "no"]),
    (Field::Session, &["session", "sess", "day", "round", "block", "set"]),
];

/// Characters between the parts of a name.
pub(super) const MARKS: [char; 5] = ['_', '-', ' ', '.', '+'];

/// Part of all paths: a folder, or a part of the file's name.
pub(super) struct Slot<'p> {
    /// The part of each path.
    pub texts: Vec<&'p str>,
    pub field: Option<Field>,
    pub is_folder: bool,
    /// Words before it that may say what it is.
    hint: String,
}

impl<'p> Slot<'p> {
    pub const fn folder(texts: Vec<&'p str>, field: Option<Field>) -> Self {
        Self {
            texts,
            field,
            is_folder: true,
            hint: String::new(),
        }
    }

    pub fn part(texts: Vec<&'p str>, before: Option<&Self>) -> Self {
        let mut slot = Self {
            texts,
            field: None,
            is_folder: false,
            hint: String::new(),
        };
        // `subject08`, or `R` in front of 0.
        let own = slot.prefix().filter(|prefix| !prefix.is_empty());
        let before = before
            .filter(|before| before.is_text())
            .map(|before| before.texts[0]);
        let hint = own.or(before).unwrap_or_default();
        slot.hint = hint.trim_matches(MARKS).to_lowercase();
        slot
    }

    pub fn distinct(&self) -> BTreeSet<&'p str> {
        self.texts.iter().copied().collect()
    }

    pub fn is_text(&self) -> bool {
        self.distinct().len() == 1
    }

    pub fn is_mark(&self) -> bool {
        self.texts
            .iter()
            .all(|text| text.chars().all(|c| MARKS.contains(&c)))
    }

    /// Letters in front of the digits of each text, if they are the same.
    pub fn prefix(&self) -> Option<&'p str> {
        fn letters(text: &str) -> &str {
            text.trim_end_matches(|c: char| c.is_ascii_digit())
        }
        let first = letters(self.texts.first()?);
        let is_alike = |text: &&str| letters(text) == first && text.len() > first.len();
        self.texts.iter().all(is_alike).then_some(first)
    }

    /// Share of the texts that are known gestures.
    pub fn gestures(&self) -> f64 {
        let known = self
            .texts
            .iter()
            .filter(|text| Motion::of_gesture(text).is_some());
        known.count() as f64 / self.texts.len() as f64
    }

    pub fn hinted(&self) -> Option<Field> {
        let hint = |(field, words): &(Field, &[&str])| {
            words.contains(&self.hint.as_str()).then_some(*field)
        };
        HINTS.iter().find_map(hint)
    }

    /// Parts of the pattern.
    pub fn parts(&self) -> Vec<Part> {
        let text = |text: &str| Part::Text(text.to_owned());
        match self.field {
            None => vec![text(self.texts[0])],
            // A trial is a number.
            Some(Field::Trial) => {
                let prefix = self.prefix().unwrap_or_default();
                let prefix = (!prefix.is_empty()).then(|| text(prefix));
                prefix
                    .into_iter()
                    .chain([Part::Field(Field::Trial)])
                    .collect()
            }
            Some(field) => vec![Part::Field(field)],
        }
    }
}
