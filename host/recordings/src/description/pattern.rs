//! Pattern of paths: `{person}/{session}_{gesture}_{trial}.csv`.
//!
//! A field in braces stands for text within one folder's or file's name, as short as the rest of the pattern allows.
//! Where a path can be divided in several ways, the caller's words decide: `wave_in_3` is gesture `wave_in` and trial 3
//! if the labels have `wave_in`.

use std::collections::HashSet;
use std::fmt;
use std::path::{Path, PathBuf};

use serde::Deserialize;

use crate::readers::path::is_number;

/// Field of a pattern.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub(crate) enum Field {
    /// The person.
    Person,
    /// A session of the person; part of the recording's name only.
    Session,
    /// The label of the whole file.
    Gesture,
    /// A number; part of the recording's name only.
    Trial,
    /// Text without meaning.
    Any,
}

impl Field {
    const ALL: [Self; 5] = [
        Self::Person,
        Self::Session,
        Self::Gesture,
        Self::Trial,
        Self::Any,
    ];

    /// Name in a pattern.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Person => "person",
            Self::Session => "session",
            Self::Gesture => "gesture",
            Self::Trial => "trial",
            Self::Any => "any",
        }
    }
}

/// Part of a pattern within one name.
#[derive(Clone, PartialEq, Eq, Debug)]
pub(super) enum Part {
    Text(String),
    Field(Field),
}

/// Pattern of the paths below a folder.
#[derive(Clone, PartialEq, Eq, Debug, Deserialize)]
#[serde(try_from = "String")]
pub(crate) struct Pattern {
    /// Names of folders, and of the file last.
    names: Vec<Vec<Part>>,
}

/// Reason why a text is no pattern.
#[derive(Clone, PartialEq, Eq, Debug, thiserror::Error)]
pub(crate) enum PatternError {
    /// A path that leaves the folder, or has an empty name.
    #[error(
        "expected the path of the files below the folder, such as {{person}}/{{gesture}}_{{trial}}.csv, found \"{0}\""
    )]
    Path(String),
    /// A brace without its partner.
    #[error("expected a closing brace after each opening one, found \"{0}\"")]
    Brace(String),
    /// A field that does not exist.
    #[error("expected {{person}}, {{session}}, {{gesture}}, {{trial}} or {{any}}, found {{{0}}}")]
    Field(String),
    /// A field that stands twice.
    #[error("expected {{{0}}} once, found it twice: write {{any}} for one of them")]
    Twice(&'static str),
    /// Two fields without text between them.
    #[error("expected text between two fields, found none in \"{0}\"")]
    Adjacent(String),
}

impl TryFrom<String> for Pattern {
    type Error = PatternError;

    fn try_from(text: String) -> Result<Self, PatternError> {
        let names: Vec<Vec<Part>> = text.split('/').map(parts).collect::<Result<_, _>>()?;
        let leaves = |name: &Vec<Part>| match &name[..] {
            [] => true,
            [Part::Text(text)] => text == "." || text == "..",
            _ => false,
        };
        if names.iter().any(leaves) || text.contains('\\') {
            return Err(PatternError::Path(text));
        }
        let pattern = Self { names };
        let mut seen = HashSet::new();
        let twice = |field: &Field| *field != Field::Any && !seen.insert(*field);
        let twice = pattern.fields().find(twice);
        twice.map_or(Ok(pattern), |field| Err(PatternError::Twice(field.name())))
    }
}

/// Parts of one name.
fn parts(name: &str) -> Result<Vec<Part>, PatternError> {
    let brace = || PatternError::Brace(name.to_owned());
    let (mut parts, mut rest) = (Vec::new(), name);
    while !rest.is_empty() {
        let text = &rest[..rest.find('{').unwrap_or(rest.len())];
        if text.contains('}') {
            return Err(brace());
        }
        if !text.is_empty() {
            parts.push(Part::Text(text.to_owned()));
        }
        rest = &rest[text.len()..];
        let Some(open) = rest.strip_prefix('{') else {
            continue;
        };
        let (field, after) = open.split_once('}').ok_or_else(brace)?;
        let unknown = || PatternError::Field(field.to_owned());
        let mut known = Field::ALL.into_iter();
        let field = known.find(|own| own.name() == field).ok_or_else(unknown)?;
        if matches!(parts.last(), Some(Part::Field(_))) {
            return Err(PatternError::Adjacent(name.to_owned()));
        }
        parts.push(Part::Field(field));
        rest = after;
    }
    Ok(parts)
}

/// Text of each field of a path, in the pattern's order.
#[derive(Clone, PartialEq, Eq, Debug)]
pub(crate) struct Fields(Vec<(Field, String)>);

impl Fields {
    /// Text of a field; none if the pattern does not have it.
    pub fn get(&self, field: Field) -> Option<&str> {
        let mut own = self.0.iter();
        own.find(|(known, _)| *known == field)
            .map(|(_, text)| text.as_str())
    }
}

impl Pattern {
    /// Pattern of these names.
    pub(super) const fn of(names: Vec<Vec<Part>>) -> Self {
        Self { names }
    }

    fn fields(&self) -> impl Iterator<Item = Field> {
        self.names.iter().flatten().filter_map(|part| match part {
            Part::Text(_) => None,
            Part::Field(field) => Some(*field),
        })
    }

    /// Whether the pattern has a field.
    pub fn has(&self, field: Field) -> bool {
        self.fields().any(|own| own == field)
    }

    /// A field that another pattern does not have, or has less often.
    pub fn beyond(&self, other: &Self) -> Option<Field> {
        let count = |pattern: &Self, field| pattern.fields().filter(|own| *own == field).count();
        self.fields()
            .find(|&field| count(self, field) > count(other, field))
    }

    /// Fields of a path below the folder; none if it does not match. A gesture is divided from the text around it so
    /// that it is a known one, if that is possible.
    pub fn fields_of(&self, path: &Path, is_known: impl Fn(&str) -> bool) -> Option<Fields> {
        let known = |field, text: &str| field != Field::Gesture || is_known(text);
        self.matched(path, &known)
            .or_else(|| self.matched(path, &|_, _| true))
    }

    fn matched(&self, path: &Path, accepts: &dyn Fn(Field, &str) -> bool) -> Option<Fields> {
        let mut fields = Vec::new();
        let mut found = path.iter();
        for parts in &self.names {
            let mut name = Name {
                text: found.next()?.to_str()?,
                accepts,
                failed: HashSet::new(),
            };
            fields.extend(name.fields(parts, 0)?.into_iter().rev());
        }
        found.next().is_none().then_some(Fields(fields))
    }

    /// Path of the fields of another pattern's path.
    pub fn path_of(&self, fields: &Fields) -> PathBuf {
        let mut any = fields.0.iter().filter(|(field, _)| *field == Field::Any);
        let mut text = |part: &Part| match part {
            Part::Text(text) => text.clone(),
            Part::Field(Field::Any) => any.next().map(|(_, text)| text.clone()).unwrap_or_default(),
            Part::Field(field) => fields.get(*field).unwrap_or_default().to_owned(),
        };
        let names = self.names.iter();
        names
            .map(|parts| parts.iter().map(&mut text).collect::<String>())
            .collect()
    }
}

impl fmt::Display for Pattern {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (at, parts) in self.names.iter().enumerate() {
            f.write_str(if at > 0 { "/" } else { "" })?;
            for part in parts {
                match part {
                    Part::Text(text) => f.write_str(text)?,
                    Part::Field(field) => write!(f, "{{{}}}", field.name())?,
                }
            }
        }
        Ok(())
    }
}

/// A folder's or file's name that is compared with parts of a pattern.
struct Name<'n> {
    text: &'n str,
    accepts: &'n dyn Fn(Field, &str) -> bool,
    /// Numbers of parts and positions that do not match: they bound the search by the square of the length.
    failed: HashSet<(usize, usize)>,
}

impl Name<'_> {
    /// Fields of the parts from a position on, in reverse; none if they do not match.
    fn fields(&mut self, parts: &[Part], at: usize) -> Option<Vec<(Field, String)>> {
        let rest = &self.text[at..];
        let Some((part, after)) = parts.split_first() else {
            return rest.is_empty().then(Vec::new);
        };
        if self.failed.contains(&(parts.len(), at)) {
            return None;
        }
        let found = match part {
            Part::Text(text) if rest.starts_with(text) => self.fields(after, at + text.len()),
            Part::Text(_) => None,
            Part::Field(field) => self.field(*field, after, at),
        };
        if found.is_none() {
            self.failed.insert((parts.len(), at));
        }
        found
    }

    fn field(&mut self, field: Field, after: &[Part], at: usize) -> Option<Vec<(Field, String)>> {
        let text = self.text;
        let ends = text[at..].char_indices().skip(1).map(|(end, _)| at + end);
        for end in ends.chain([text.len()]) {
            let own = &text[at..end];
            let fits = !own.is_empty() && (field != Field::Trial || is_number(own));
            if !fits || !(self.accepts)(field, own) {
                continue;
            }
            if let Some(mut fields) = self.fields(after, end) {
                fields.push((field, own.to_owned()));
                return Some(fields);
            }
        }
        None
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn pattern(text: &str) -> Pattern {
        text.to_owned().try_into().unwrap()
    }

    fn fields(text: &str, path: &str, known: &[&str]) -> Option<Vec<String>> {
        let found = pattern(text).fields_of(Path::new(path), |word| known.contains(&word));
        found.map(|found| found.0.into_iter().map(|(_, text)| text).collect())
    }

    #[test]
    fn paths_are_divided_as_the_pattern_says() {
        for (text, path, expected) in [
            (
                "{person}/{gesture}_{trial}.csv",
                "anna/open_3.csv",
                &["anna", "open", "3"][..],
            ),
            (
                "d/{person}/M{gesture}T{trial}.csv",
                "d/sub12/M5T2.csv",
                &["sub12", "5", "2"],
            ),
            (
                "{session}_R{trial}_{gesture}.npy",
                "test_trial_0_R1_close.npy",
                &["test_trial_0", "1", "close"],
            ),
            (
                "{person}/{trial}_{gesture}.npy",
                "EMG_S3/5_thumb_up.npy",
                &["EMG_S3", "5", "thumb_up"],
            ),
            (
                "{any}/{any}-{gesture}.csv",
                "a/b-c-d.csv",
                &["a", "b", "c-d"],
            ),
            ("{person}.csv", "\u{63e1}.csv", &["\u{63e1}"]),
            ("raw.csv", "raw.csv", &[]),
        ] {
            let expected: Vec<String> = expected.iter().map(|&text| text.to_owned()).collect();
            assert_eq!(fields(text, path, &[]), Some(expected), "{text} {path}");
        }
        for (text, path) in [
            ("{person}/{gesture}_{trial}.csv", "anna/open_x.csv"),
            ("{person}/{gesture}.csv", "anna/monday/open.csv"),
            ("{person}/{gesture}.csv", "open.csv"),
            ("{person}/{gesture}.csv", "anna/open.npy"),
            ("{person}_x.csv", "_x.csv"),
            ("{any}.csv", "anna/1.csv"),
        ] {
            assert_eq!(fields(text, path, &[]), None, "{text} {path}");
        }
    }

    #[test]
    fn known_words_decide_where_a_gesture_ends() {
        let divided = |known: &[&str]| {
            fields("{gesture}_{any}.csv", "wave_in_left_3.csv", known).map(|found| found[0].clone())
        };
        assert_eq!(divided(&["wave_in"]).as_deref(), Some("wave_in"));
        assert_eq!(divided(&["wave_in_left"]).as_deref(), Some("wave_in_left"));
        assert_eq!(
            divided(&[]).as_deref(),
            Some("wave"),
            "as short as possible"
        );
    }

    #[test]
    fn fields_name_the_file_of_the_labels() {
        let samples = pattern("{any}/{person}_{any}_emg.npy");
        let labels = pattern("{any}/labels/{person}_{any}_ann.npy");
        assert_eq!(labels.beyond(&samples), None);
        let fields = samples
            .fields_of(Path::new("d/anna_2_emg.npy"), |_| true)
            .unwrap();
        assert_eq!(
            labels.path_of(&fields),
            Path::new("d/labels/anna_2_ann.npy")
        );
        let beyond = pattern("{session}.npy").beyond(&samples);
        assert_eq!(beyond, Some(Field::Session));
        assert_eq!(
            pattern("{any}{any}".replace("}{", "}-{").as_str()).beyond(&pattern("{any}")),
            Some(Field::Any)
        );
    }

    #[test]
    fn what_is_no_pattern_says_why() {
        for (text, words) in [
            ("", "below the folder"),
            ("/data/{person}.csv", "below the folder"),
            ("../{person}.csv", "below the folder"),
            ("{person}\\{trial}.csv", "below the folder"),
            ("{person/{trial}.csv", "closing brace"),
            ("person}.csv", "closing brace"),
            (
                "{peron}.csv",
                "{person}, {session}, {gesture}, {trial} or {any}, found {peron}",
            ),
            ("{person}/{person}_{trial}.csv", "{person} once"),
            ("{person}{trial}.csv", "between two fields"),
        ] {
            let error = Pattern::try_from(text.to_owned()).unwrap_err().to_string();
            assert!(error.contains(words), "{text}: {error}");
        }
    }

    /// Whether a path matches, by a search without memory that tries every division.
    fn naive(parts: &[Part], text: &str) -> bool {
        match parts.split_first() {
            None => text.is_empty(),
            Some((Part::Text(own), after)) => text
                .strip_prefix(own.as_str())
                .is_some_and(|rest| naive(after, rest)),
            Some((Part::Field(field), after)) => (1..=text.len())
                .filter(|&end| text.is_char_boundary(end))
                .any(|end| {
                    (*field != Field::Trial || is_number(&text[..end]))
                        && naive(after, &text[end..])
                }),
        }
    }

    proptest! {
        /// A path that a pattern writes is one that it matches, and gives the path again.
        #[test]
        fn a_written_path_matches(person in "[a-z_]{1,6}", gesture in "[a-z_]{1,6}", trial in "[0-9]{1,3}") {
            let pattern = pattern("{person}/x_{gesture}_{trial}.csv");
            let fields = Fields(vec![
                (Field::Person, person),
                (Field::Gesture, gesture.clone()),
                (Field::Trial, trial),
            ]);
            let path = pattern.path_of(&fields);
            let found = pattern.fields_of(&path, |word| word == gesture).unwrap();
            prop_assert_eq!(pattern.path_of(&found), path);
            prop_assert_eq!(found, fields);
        }

        /// The search agrees with one that tries everything.
        #[test]
        fn the_search_equals_a_naive_one(
            parts in prop::collection::vec(prop::sample::select(vec!["a", "ab", "_", "{any}", "{trial}"]), 1..7),
            text in "[ab_1]{0,12}",
        ) {
            let spelled = parts.join("");
            let fields = spelled.matches("{trial}").count();
            prop_assume!(fields < 2 && !spelled.contains("}{"));
            let pattern = pattern(&spelled);
            let found = pattern.fields_of(Path::new(&text), |_| true);
            prop_assert_eq!(found.is_some(), !text.is_empty() && naive(&pattern.names[0], &text));
        }

        /// No text makes the parser fail otherwise than by an error, and a pattern is written as it was read.
        #[test]
        fn any_text_is_a_pattern_or_an_error(text in "[a-z{}/._]{0,20}|\\PC{0,12}", path in "\\PC{0,12}") {
            if let Ok(pattern) = Pattern::try_from(text.clone()) {
                prop_assert_eq!(pattern.to_string(), text);
                pattern.fields_of(Path::new(&path), |_| false);
            }
        }
    }

    #[test]
    fn a_long_name_that_almost_matches_takes_no_time() {
        let name = "x".repeat(250);
        assert_eq!(
            fields("{any}x{any}x{any}x{any}x{any}x{any}x{any}y", &name, &[]),
            None
        );
    }
}
