//! Pattern of paths: `{person}/{session}_{gesture}_{trial}.csv`.
//!
//! A field in braces stands for text within one folder's or file's name, as short as the rest of the pattern allows.
//! Where a path can be divided in several ways, the caller's words decide: `wave_in_3` is gesture `wave_in` and trial 3
//! if the labels have `wave_in`.

use std::collections::HashSet;
use std::ffi::OsStr;
use std::fmt;
use std::path::{Path, PathBuf};

use serde::Deserialize;

use crate::readers::path::{is_number, with_small_ending};

shared::names! {
    /// Field of a pattern.
    pub(crate) enum Field {
        /// The person.
        Person = "person",
        /// A session of the person; part of the recording's name only.
        Session = "session",
        /// The label of the whole file.
        Gesture = "gesture",
        /// A number; part of the recording's name only.
        Trial = "trial",
        /// Text without meaning.
        Any = "any",
    }
}

/// Part of a pattern.
#[derive(Clone, PartialEq, Eq, Debug)]
enum PatternPart {
    Text(String),
    Field(Field),
}

/// Pattern of the paths below a folder.
#[derive(Clone, PartialEq, Eq, Debug, Deserialize)]
#[serde(try_from = "String")]
pub(crate) struct Pattern {
    /// The pattern as it was written.
    text: String,
    /// Parts, with the ending in small letters, as paths are compared.
    parts: Vec<PatternPart>,
}

impl TryFrom<String> for Pattern {
    /// Reason why the text is no pattern.
    type Error = String;

    fn try_from(text: String) -> Result<Self, String> {
        let leaves = |name: &str| matches!(name, "" | "." | "..");
        if text.split('/').any(leaves) || text.contains('\\') {
            return Err(format!(
                "expected the path of the files below the folder, such as {{person}}/{{gesture}}_{{trial}}.csv, found \"{text}\""
            ));
        }
        let parts = parts(&text)?;
        let pattern = Self { text, parts };
        let mut seen = HashSet::new();
        let twice = |field: &Field| *field != Field::Any && !seen.insert(*field);
        let twice = pattern.fields().find(twice);
        twice.map_or(Ok(pattern), |field| {
            let name = field.name();
            Err(format!(
                "expected {{{name}}} once, found it twice: write {{any}} for one of them"
            ))
        })
    }
}

fn parts(pattern: &str) -> Result<Vec<PatternPart>, String> {
    let brace = || format!("expected a closing brace after each opening one, found \"{pattern}\"");
    let (mut parts, mut rest) = (Vec::new(), pattern);
    while !rest.is_empty() {
        let text = &rest[..rest.find('{').unwrap_or(rest.len())];
        if text.contains('}') {
            return Err(brace());
        }
        if !text.is_empty() {
            parts.push(PatternPart::Text(text.to_owned()));
        }
        rest = &rest[text.len()..];
        let Some(open) = rest.strip_prefix('{') else {
            continue;
        };
        let closed = open.split_once('}');
        let (field, after) = closed
            .filter(|(field, _)| !field.contains('/'))
            .ok_or_else(brace)?;
        let field = Field::from_name(field).ok_or_else(|| {
            format!(
                "expected {{person}}, {{session}}, {{gesture}}, {{trial}} or {{any}}, found {{{field}}}"
            )
        })?;
        if matches!(parts.last(), Some(PatternPart::Field(_))) {
            return Err(format!(
                "expected text between two fields, found none in \"{pattern}\""
            ));
        }
        parts.push(PatternPart::Field(field));
        rest = after;
    }
    if let Some(PatternPart::Text(last)) = parts.last_mut()
        && let Some(ending) = last.rfind('.').filter(|&at| !last[at..].contains('/'))
    {
        last[ending..].make_ascii_lowercase();
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
    fn fields(&self) -> impl Iterator<Item = Field> {
        self.parts.iter().filter_map(|part| match part {
            PatternPart::Text(_) => None,
            PatternPart::Field(field) => Some(*field),
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

    /// Folder that the pattern's paths lie below, of a path that it matches the end of.
    pub fn folder_of<'p>(&self, path: &'p Path) -> &'p Path {
        let names = self.text.split('/').count();
        path.ancestors().nth(names).unwrap_or(path)
    }

    /// Fields of the end of a path, each accepted.
    pub fn fields_of_end(
        &self,
        path: &Path,
        accepts: &dyn Fn(Field, &str) -> bool,
    ) -> Option<Fields> {
        let below = path.strip_prefix(self.folder_of(path)).ok()?;
        self.matched(below, accepts)
    }

    fn matched(&self, path: &Path, accepts: &dyn Fn(Field, &str) -> bool) -> Option<Fields> {
        let path = with_small_ending(path);
        let names: Option<Vec<&str>> = path.iter().map(OsStr::to_str).collect();
        let mut search = Search {
            text: &names?.join("/"),
            accepts,
            failed: HashSet::new(),
        };
        let mut fields = search.fields(&self.parts, 0)?;
        fields.reverse();
        Some(Fields(fields))
    }

    /// Path of the fields of another pattern's path.
    pub fn path_of(&self, fields: &Fields) -> PathBuf {
        let mut any = fields.0.iter().filter(|(field, _)| *field == Field::Any);
        let text = |part: &PatternPart| match part {
            PatternPart::Text(text) => text.clone(),
            PatternPart::Field(Field::Any) => {
                any.next().map(|(_, text)| text.clone()).unwrap_or_default()
            }
            PatternPart::Field(field) => fields.get(*field).unwrap_or_default().to_owned(),
        };
        let path: String = self.parts.iter().map(text).collect();
        path.split('/').collect()
    }
}

impl fmt::Display for Pattern {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.text)
    }
}

/// Comparison of a path with the parts of a pattern.
struct Search<'n> {
    /// Names of the path, with `/` between them.
    text: &'n str,
    accepts: &'n dyn Fn(Field, &str) -> bool,
    /// Numbers of parts and positions that do not match: they bound the search by the square of the length.
    failed: HashSet<(usize, usize)>,
}

impl Search<'_> {
    /// Fields of the parts from a position on, in reverse; none if they do not match.
    fn fields(&mut self, parts: &[PatternPart], at: usize) -> Option<Vec<(Field, String)>> {
        let rest = &self.text[at..];
        let Some((part, after)) = parts.split_first() else {
            return rest.is_empty().then(Vec::new);
        };
        if self.failed.contains(&(parts.len(), at)) {
            return None;
        }
        let found = match part {
            PatternPart::Text(text) if rest.starts_with(text) => {
                self.fields(after, at + text.len())
            }
            PatternPart::Text(_) => None,
            PatternPart::Field(field) => self.field(*field, after, at),
        };
        if found.is_none() {
            self.failed.insert((parts.len(), at));
        }
        found
    }

    fn field(
        &mut self,
        field: Field,
        after: &[PatternPart],
        at: usize,
    ) -> Option<Vec<(Field, String)>> {
        let name = self.text[at..].split('/').next().unwrap_or_default();
        let ends = name.char_indices().skip(1).map(|(end, _)| end);
        for end in ends.chain([name.len()]) {
            let own = &name[..end];
            let fits = !own.is_empty() && (field != Field::Trial || is_number(own));
            if !fits || !(self.accepts)(field, own) {
                continue;
            }
            if let Some(mut fields) = self.fields(after, at + end) {
                fields.push((field, own.to_owned()));
                return Some(fields);
            }
        }
        None
    }
}

#[cfg(test)]
mod tests;
