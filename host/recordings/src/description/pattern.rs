//! Pattern of paths: `{person}/{session}_{gesture}_{trial}.csv`.
//!
//! A field in braces stands for text within one folder's or file's name, as short as the rest of the pattern allows.
//! Where a path can be divided in several ways, the caller's words decide: `wave_in_3` is gesture `wave_in` and trial 3
//! if the labels have `wave_in`.

use std::borrow::Cow;
use std::collections::HashSet;
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

/// Part of a pattern within one name.
#[derive(Clone, PartialEq, Eq, Debug)]
enum PatternPart {
    Text(String),
    Field(Field),
}

/// Pattern of the paths below a folder.
#[derive(Clone, PartialEq, Eq, Debug, Deserialize)]
#[serde(try_from = "String")]
pub(crate) struct Pattern {
    /// Names of folders, and of the file last.
    names: Vec<Vec<PatternPart>>,
}

impl TryFrom<String> for Pattern {
    /// Reason why the text is no pattern.
    type Error = String;

    fn try_from(text: String) -> Result<Self, String> {
        let names: Vec<Vec<PatternPart>> = text.split('/').map(parts).collect::<Result<_, _>>()?;
        let leaves = |name: &Vec<PatternPart>| match &name[..] {
            [] => true,
            [PatternPart::Text(text)] => text == "." || text == "..",
            _ => false,
        };
        if names.iter().any(leaves) || text.contains('\\') {
            return Err(format!(
                "expected the path of the files below the folder, such as {{person}}/{{gesture}}_{{trial}}.csv, found \"{text}\""
            ));
        }
        let pattern = Self { names };
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

/// Names with the ending of the last one in small letters, as paths are compared.
fn with_small_endings(names: &[Vec<PatternPart>]) -> Cow<'_, [Vec<PatternPart>]> {
    let mut names = Cow::Borrowed(names);
    if let Some(PatternPart::Text(last)) = names.last().and_then(|name| name.last())
        && let Some(ending) = last.rfind('.')
        && last[ending..].contains(|c: char| c.is_ascii_uppercase())
        && let Some(PatternPart::Text(last)) =
            names.to_mut().last_mut().and_then(|name| name.last_mut())
    {
        last[ending..].make_ascii_lowercase();
    }
    names
}

fn parts(name: &str) -> Result<Vec<PatternPart>, String> {
    let brace = || format!("expected a closing brace after each opening one, found \"{name}\"");
    let (mut parts, mut rest) = (Vec::new(), name);
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
        let (field, after) = open.split_once('}').ok_or_else(brace)?;
        let field = Field::from_name(field).ok_or_else(|| {
            format!(
                "expected {{person}}, {{session}}, {{gesture}}, {{trial}} or {{any}}, found {{{field}}}"
            )
        })?;
        if matches!(parts.last(), Some(PatternPart::Field(_))) {
            return Err(format!(
                "expected text between two fields, found none in \"{name}\""
            ));
        }
        parts.push(PatternPart::Field(field));
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
    fn fields(&self) -> impl Iterator<Item = Field> {
        self.names.iter().flatten().filter_map(|part| match part {
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
        path.ancestors().nth(self.names.len()).unwrap_or(path)
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
        let (path, names) = (with_small_ending(path), with_small_endings(&self.names));
        let mut fields = Vec::new();
        let mut found = path.iter();
        for parts in &*names {
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
        let mut text = |part: &PatternPart| match part {
            PatternPart::Text(text) => text.clone(),
            PatternPart::Field(Field::Any) => {
                any.next().map(|(_, text)| text.clone()).unwrap_or_default()
            }
            PatternPart::Field(field) => fields.get(*field).unwrap_or_default().to_owned(),
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
                    PatternPart::Text(text) => f.write_str(text)?,
                    PatternPart::Field(field) => write!(f, "{{{}}}", field.name())?,
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
mod tests;
