//! First description of a folder, by looking: `myointent data describe`.
//!
//! Files are sorted by their layout; the layout that most of them have is described. Its columns, scale and rate come
//! from their values, the fields of the paths from the paths. What cannot be seen (what a word means, the arm, how the
//! armband sits) stands in the text as a comment.

mod columns;
mod layout;
mod names;
mod text;
mod words;

use std::collections::{BTreeMap, BTreeSet};
use std::fs::File;
use std::io::{ErrorKind, Write as _};
use std::path::{Path, PathBuf};

use rayon::prelude::*;

use super::pattern::{Field, Pattern};
use super::{Described, Description, FILE_NAME};
use crate::readers::error::LoadError;
use crate::readers::path::with_small_ending;
use columns::Roles;
use layout::{Beginning, Layout, Look};
use text::Text;
use words::Words;

/// Maximum number of files whose columns are looked at.
const EXAMINED: usize = 24;

/// Error of a first description.
#[derive(Debug, thiserror::Error)]
pub enum SurveyError {
    /// The folder or a file cannot be read.
    #[error(transparent)]
    Load(#[from] LoadError),
    /// The path is no folder.
    #[error("expected a folder, found {}: a description is of the recordings in a folder", _0.display())]
    NoFolder(PathBuf),
    /// No file with eight columns of numbers.
    #[error(
        "no recordings in {}: expected csv, txt, tsv or npy files with eight columns of numbers that change from row to \
         row, found {found}",
        path.display()
    )]
    NoSamples {
        /// The folder.
        path: PathBuf,
        /// Description of the files that there are.
        found: String,
    },
    /// A description is there already.
    #[error("{} exists: correct it, or remove it and describe again", _0.display())]
    Exists(PathBuf),
    /// The file cannot be written.
    #[error("cannot write {}; --out FILE writes it elsewhere", path.display())]
    Write {
        /// The file.
        path: PathBuf,
        /// The system's reason.
        source: std::io::Error,
    },
}

/// Writes a first description of a folder: into it, or into the file `out`. Returns the file and its text.
///
/// # Errors
/// [`SurveyError`]; an existing file is never replaced.
pub fn describe(folder: &Path, out: Option<&Path>) -> Result<(PathBuf, String), SurveyError> {
    let io = |source| LoadError::io(folder, source);
    let folder = folder.canonicalize().map_err(io)?;
    if !folder.is_dir() {
        return Err(SurveyError::NoFolder(folder));
    }
    let path = out.map_or_else(|| folder.join(FILE_NAME), Path::to_owned);
    if path.exists() {
        return Err(SurveyError::Exists(path));
    }
    let text = survey(&folder, out.is_some())?;
    let failed = |source: std::io::Error| match source.kind() {
        ErrorKind::AlreadyExists => SurveyError::Exists(path.clone()),
        _ => SurveyError::Write {
            path: path.clone(),
            source,
        },
    };
    let mut file = File::create_new(&path).map_err(failed)?;
    file.write_all(text.as_bytes()).map_err(failed)?;
    Ok((path, text))
}

/// Files of a folder by what is in them.
#[derive(Default)]
struct Files {
    samples: BTreeMap<Layout, Vec<PathBuf>>,
    labels: BTreeSet<PathBuf>,
    refused: Vec<LoadError>,
    others: usize,
}

fn files(folder: &Path) -> Result<Files, LoadError> {
    let (_, paths) = crate::library::files(folder)?;
    // What cannot be read is told by `inspect`.
    let looks: Vec<(PathBuf, Look)> = paths
        .into_par_iter()
        .flatten()
        .map(|path| {
            let look = layout::look(&path).unwrap_or(Look::Nothing);
            (path, look)
        })
        .collect();
    let mut files = Files::default();
    for (path, look) in looks {
        match look {
            Look::Samples(layout) => files.samples.entry(layout).or_default().push(path),
            Look::Labels => {
                files.labels.insert(path);
            }
            Look::Refused(error) => files.refused.push(error),
            Look::Nothing => files.others += 1,
        }
    }
    Ok(files)
}

/// Text of a first description.
fn survey(folder: &Path, is_elsewhere: bool) -> Result<String, SurveyError> {
    let Files {
        mut samples,
        labels,
        refused,
        others,
    } = files(folder)?;
    let none = |found: String| SurveyError::NoSamples {
        path: folder.to_owned(),
        found,
    };
    let most = samples
        .iter()
        .max_by_key(|(layout, paths)| (paths.len(), std::cmp::Reverse(*layout)));
    let Some(layout) = most.map(|(layout, _)| layout.clone()) else {
        return Err(none(match refused.first() {
            Some(first) => format!(
                "{} files that cannot be read so; the first: {first}",
                refused.len()
            ),
            None => format!("{} files with one column and {others} others", labels.len()),
        }));
    };
    let paths = samples.remove(&layout).unwrap_or_default();
    let every = paths.len().div_ceil(EXAMINED);
    let beginnings: Vec<Beginning> = paths
        .iter()
        .step_by(every.max(1))
        .filter_map(|path| layout::beginning(path).transpose())
        .collect::<Result<_, _>>()?;
    let Some(roles) = Roles::of(&beginnings) else {
        let first = paths[0].display();
        let found = format!(
            "fewer such columns in {} files such as {first}",
            paths.len()
        );
        return Err(none(found));
    };
    let below = |path: &PathBuf| with_small_ending(path.strip_prefix(folder).unwrap_or(path));
    let relative: Vec<PathBuf> = paths.iter().map(below).collect();
    let labels: BTreeSet<PathBuf> = labels.iter().map(below).collect();
    // A column of labels goes before a file of them.
    let partner = partner(&relative, &labels).filter(|_| roles.label.is_none());
    let has_labels = roles.label.is_some() || partner.is_some();
    let unnamed = || none("names of files that have nothing in common, or braces".to_owned());
    let pattern = names::pattern(&relative, has_labels).ok_or_else(unnamed)?;
    let label_files = partner.and_then(|(from, to)| replaced(&pattern, &from, &to));
    let mut text = Text {
        folder: is_elsewhere.then_some(folder),
        layout: &layout,
        roles: &roles,
        pattern: &pattern,
        label_files: label_files.as_ref(),
        files: &relative,
        others: samples
            .values()
            .filter_map(|paths| Some((paths.len(), below(paths.first()?))))
            .collect(),
        refused: &refused,
        people: BTreeSet::new(),
        words: Words::default(),
        known: crate::load(folder, &crate::LoadOptions::default())
            .map_or(0, |library| library.recordings.len()),
    };
    let draft = described(folder, &text.draft())?;
    text.words = Words::of(&draft, &paths);
    let person = |path| draft.fields_of(path)?.get(Field::Person).map(str::to_owned);
    text.people = paths.iter().filter_map(|path| person(path)).collect();
    Ok(text.to_string())
}

/// A draft as a description of its folder.
fn described(folder: &Path, text: &str) -> Result<Described, LoadError> {
    let file = folder.join(FILE_NAME);
    Ok(Described {
        description: Description::parse(&file, text)?,
        folder: folder.to_owned(),
        file,
        above: String::new(),
    })
}

/// Change from names of samples to those of labels, `emg` and `ann`, if every recording has such a file.
fn partner(samples: &[PathBuf], labels: &BTreeSet<PathBuf>) -> Option<(String, String)> {
    let first = samples.first()?;
    let name = first.file_name()?.to_str()?;
    let same_folder = labels
        .iter()
        .filter(|label| label.parent() == first.parent());
    let pairs = same_folder.filter_map(|label| {
        let label = label.file_name()?.to_str()?;
        let start = name
            .bytes()
            .zip(label.bytes())
            .take_while(|(a, b)| a == b)
            .count();
        let rest = name.len().min(label.len()) - start;
        let (ends, label_ends) = (name.bytes().rev(), label.bytes().rev());
        let end = ends
            .zip(label_ends)
            .take(rest)
            .take_while(|(a, b)| a == b)
            .count();
        let from = name.get(start..name.len() - end)?;
        Some((
            from.to_owned(),
            label.get(start..label.len() - end)?.to_owned(),
        ))
    });
    let is_complete = |(from, to): &(String, String)| {
        let partner = |path: &PathBuf| {
            let name = path.file_name()?.to_str()?;
            let at = name.rfind(from.as_str())?;
            let name = format!("{}{to}{}", &name[..at], &name[at + from.len()..]);
            Some(path.with_file_name(name))
        };
        let has = |path: &PathBuf| partner(path).is_some_and(|partner| labels.contains(&partner));
        !from.is_empty() && samples.iter().all(has)
    };
    pairs.into_iter().find(is_complete)
}

/// The pattern with the last text that holds `from` changed.
fn replaced(pattern: &Pattern, from: &str, to: &str) -> Option<Pattern> {
    let text = pattern.to_string();
    let at = text.rfind(from)?;
    Pattern::try_from(format!("{}{to}{}", &text[..at], &text[at + from.len()..])).ok()
}

#[cfg(test)]
mod tests;
