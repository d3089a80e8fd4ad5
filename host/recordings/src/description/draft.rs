//! Draft of a description: `myointent data describe`.
//!
//! It describes the kind of files that a folder has most of, by what they say themselves: separator, header, columns,
//! unit, words of labels. What only a person knows stands in it as a comment.

mod columns;
mod pattern;

use std::collections::{BTreeMap, BTreeSet};
use std::fmt::{self, Write as _};
use std::fs::File;
use std::io::{ErrorKind, Write as _};
use std::path::{Path, PathBuf};

use rayon::prelude::*;
use shared::units::{CHANNELS, SAMPLE_RATE_HZ};

use super::pattern::{Field, Pattern};
use super::words::ALL_OTHERS;
use super::{Described, Description, FILE_NAME};
use crate::labels::motion::Motion;
use crate::readers::error::LoadError;
use crate::readers::error::excerpt::excerpt;
use crate::readers::label_file;
use crate::readers::path::with_small_ending;
use columns::{ColumnKind, Columns};
use execution::printable::printable;

/// Maximum number of words that are listed.
const LISTED: usize = 30;

/// Error of a draft.
#[derive(Debug, thiserror::Error)]
#[expect(missing_docs, reason = "the messages say it")]
pub enum DraftError {
    #[error(transparent)]
    Load(#[from] LoadError),
    #[error("expected a folder, found {}: a description is of the recordings in a folder", _0.display())]
    NoFolder(PathBuf),
    #[error(
        "no recordings in {}: expected csv, txt, tsv or npy files with eight columns of numbers, found {found}",
        path.display()
    )]
    NoSamples { path: PathBuf, found: String },
    #[error("names of folders have braces, as in {}: rename them", _0.display())]
    Braces(PathBuf),
    #[error("{} exists: correct it, or remove it and describe again", _0.display())]
    Exists(PathBuf),
    #[error("cannot write {}; --out FILE writes it elsewhere", path.display())]
    Write {
        path: PathBuf,
        source: std::io::Error,
    },
}

/// Writes a draft of a folder's description: into the folder, or into the file `out`. Returns the file and its text.
///
/// # Errors
/// [`DraftError`]; an existing file is never replaced.
pub fn describe(folder: &Path, out: Option<&Path>) -> Result<(PathBuf, String), DraftError> {
    let io = |source| LoadError::io(folder, source);
    let folder = dunce::canonicalize(folder).map_err(io)?;
    if !folder.is_dir() {
        return Err(DraftError::NoFolder(folder));
    }
    let path = out.map_or_else(|| folder.join(FILE_NAME), Path::to_owned);
    if path.exists() {
        return Err(DraftError::Exists(path));
    }
    let mut draft = Draft::of(&folder)?;
    if out.is_some() {
        draft.folder = Some(folder);
    }
    let text = draft.to_string();
    let failed = |source: std::io::Error| match source.kind() {
        ErrorKind::AlreadyExists => DraftError::Exists(path.clone()),
        _ => DraftError::Write {
            path: path.clone(),
            source,
        },
    };
    let mut file = File::create_new(&path).map_err(failed)?;
    file.write_all(text.as_bytes()).map_err(failed)?;
    Ok((path, text))
}

/// Draft of a description.
struct Draft {
    /// The folder, if the description is not in it.
    folder: Option<PathBuf>,
    kind: ColumnKind,
    columns: Columns,
    pattern: Pattern,
    /// Paths below the folder of the files of the kind.
    files: Vec<PathBuf>,
    /// Number of files of other kinds, and the first of each.
    others: Vec<(usize, PathBuf)>,
    words: BTreeSet<String>,
    /// Number of recordings that are read without a description.
    known: usize,
    /// Number of files that cannot be read so, and the first reason.
    unread: (usize, String),
}

impl Draft {
    fn of(folder: &Path) -> Result<Self, DraftError> {
        let (_, files) = crate::library::files(folder)?;
        let count = files.len();
        let kinds: Vec<(ColumnKind, PathBuf)> = files
            .into_par_iter()
            .flatten()
            .filter_map(|path| Some((ColumnKind::of(&path)?, path)))
            .collect();
        let mut by_kind: BTreeMap<ColumnKind, Vec<PathBuf>> = BTreeMap::new();
        for (kind, path) in kinds {
            by_kind.entry(kind).or_default().push(path);
        }
        // A folder that the readers know may need no description; and they say why a file is refused.
        let library = crate::load(folder, &crate::LoadOptions::default());
        let reason = match &library {
            Ok(library) => library.skipped.first().map(LoadError::line),
            Err(error) => Some(error.line()),
        };
        let none = || DraftError::NoSamples {
            path: folder.to_owned(),
            found: reason.clone().unwrap_or_else(|| format!("{count} files")),
        };
        let most = by_kind
            .iter()
            .max_by_key(|(kind, paths)| (paths.len(), std::cmp::Reverse(*kind)));
        let kind = most.map(|(kind, _)| kind.clone()).ok_or_else(none)?;
        let paths = by_kind.remove(&kind).unwrap_or_default();
        let columns = Columns::of(&paths[0])?.ok_or_else(none)?;
        let below = |path: &PathBuf| with_small_ending(path.strip_prefix(folder).unwrap_or(path));
        let files: Vec<PathBuf> = paths.iter().map(below).collect();
        let has_label = columns.label.is_some();
        let pattern = pattern::of(&files, has_label);
        let mut draft = Self {
            folder: None,
            kind,
            columns,
            pattern: pattern.ok_or_else(|| DraftError::Braces(files[0].clone()))?,
            files,
            others: by_kind
                .values()
                .filter_map(|paths| Some((paths.len(), below(paths.first()?))))
                .collect(),
            words: BTreeSet::new(),
            known: library.map_or(0, |library| library.recordings.len()),
            unread: (0, String::new()),
        };
        draft.read(folder, &paths)?;
        Ok(draft)
    }

    /// Reads all files as the draft describes them: words, and what cannot be read.
    fn read(&mut self, folder: &Path, paths: &[PathBuf]) -> Result<(), LoadError> {
        let file = folder.join(FILE_NAME);
        let described = Described {
            description: Description::parse(&file, &self.fields())?,
            folder: folder.to_owned(),
            file,
            above: String::new(),
        };
        let read = |path: &PathBuf| {
            let fields = described.fields_of(path)?;
            let rows = described.rows(path, &fields);
            Some(rows.map(|rows| {
                let words = rows.labels.words.unwrap_or_default();
                let words = words.distinct().iter().map(|(word, _)| word.clone());
                words.collect::<Vec<String>>()
            }))
        };
        let found: Vec<_> = paths.par_iter().filter_map(read).collect();
        for read in found {
            match read {
                Ok(words) => self.words.extend(words),
                Err(error) => {
                    if self.unread.0 == 0 {
                        self.unread.1 = error.line();
                    }
                    self.unread.0 += 1;
                }
            }
        }
        Ok(())
    }

    /// Lines of the fields that the files show.
    fn fields(&self) -> String {
        let mut text = format!("files = {}\n", quoted(&self.pattern.to_string()));
        let names: BTreeSet<&String> = self.columns.names.iter().collect();
        let is_clear = names.len() == self.columns.names.len();
        let column = |at: usize| match self.columns.names.get(at) {
            Some(name) if is_clear => quoted(name.trim()),
            _ => (at + 1).to_string(),
        };
        if let Some(channels) = self.columns.channels {
            if let Some(separator) = self.kind.separator {
                let header = !self.columns.names.is_empty();
                let _ = writeln!(text, "separator = {}\nheader = {header}", quoted(separator));
            }
            let channels = channels.map(column).join(", ");
            let _ = writeln!(text, "channels = [{channels}]");
        }
        for (field, at) in [("time", self.columns.time), ("label", self.columns.label)] {
            if let Some(at) = at {
                let _ = writeln!(text, "{field} = {}", column(at));
            }
        }
        let _ = writeln!(text, "rate = {SAMPLE_RATE_HZ}");
        if let Ok(scale) = self.columns.scale
            && scale != 1.0
        {
            let _ = writeln!(text, "scale = {scale}");
        }
        if self.columns.label.is_some() || self.pattern.has(Field::Gesture) {
            let _ = writeln!(text, "labels = {}", self.labels());
        }
        text
    }

    /// Lists of words by class, unknown last. In a column gt, numbers are ReactEMG's.
    fn labels(&self) -> String {
        let label = self.columns.label;
        let is_gt = label.and_then(|at| self.columns.names.get(at)) == Some(&"gt".to_owned());
        let motion = |word: &str| match is_gt {
            true => label_file::from_text(word).ok(),
            false => Motion::of_gesture(word).or_else(|| Motion::from_name(word)),
        };
        let mut classes: BTreeMap<(bool, &str), Vec<String>> = BTreeMap::new();
        for word in &self.words {
            let name = motion(word).unwrap_or(Motion::Unknown).name();
            let number = word.parse::<i64>().map(|number| number.to_string());
            let word = number.unwrap_or_else(|_| quoted(word));
            classes
                .entry((name == "unknown", name))
                .or_default()
                .push(word);
        }
        let list = |((_, class), words): (&(bool, &str), &Vec<String>)| {
            let all = [quoted(ALL_OTHERS)];
            let is_long = *class == "unknown" && words.len() > LISTED;
            let words = if is_long { &all[..] } else { words };
            format!("{class} = [{}]", words.join(", "))
        };
        if classes.is_empty() {
            return format!("{{ unknown = [{}] }}", quoted(ALL_OTHERS));
        }
        let lists: Vec<String> = classes.iter().map(list).collect();
        format!("{{ {} }}", lists.join(", "))
    }
}

/// A text as TOML has it.
fn quoted(text: &str) -> String {
    toml::Value::String(text.to_owned()).to_string()
}

impl fmt::Display for Draft {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        // As the pattern has them, on every system.
        let such_as = |path: &Path| {
            let names: Vec<_> = path.iter().map(|name| name.to_string_lossy()).collect();
            excerpt(&names.join("/"))
        };
        writeln!(
            f,
            "# Draft, by `myointent data describe`. Correct each line, then look at what comes of it: myointent data inspect.\n\
             # `myointent data describe --help` explains all fields.\n"
        )?;
        if let Some(folder) = &self.folder {
            writeln!(f, "folder = {}\n", quoted(&folder.to_string_lossy()))?;
        }
        if 2 * self.known > self.files.len() {
            let known = self.known;
            writeln!(
                f,
                "# {known} recordings are read without this file. Remove it if `data inspect` then shows what it should.\n"
            )?;
        }
        writeln!(
            f,
            "# {} files such as {}. Name the parts of their paths: {{person}}, {{session}}, {{gesture}}, {{trial}} (a number),\n\
             # {{any}}. Without {{person}} the folder is the person.",
            self.files.len(),
            such_as(&self.files[0])
        )?;
        let is_other = |path: &&PathBuf| self.pattern.fields_of(path, |_| true).is_none();
        let unmatched: Vec<&PathBuf> = self.files.iter().filter(is_other).collect();
        if let Some(first) = unmatched.first() {
            let count = unmatched.len();
            writeln!(
                f,
                "# Named otherwise, and not read: {count}, such as {}",
                such_as(first)
            )?;
        }
        for (count, first) in &self.others {
            let first = such_as(first);
            writeln!(
                f,
                "# With other columns, and not read: {count}, such as {first}"
            )?;
        }
        if let Some(more) = self.columns.more {
            writeln!(
                f,
                "# {more} columns are numbers: channels are the first eight of them. Check."
            )?;
        }
        f.write_str(&self.fields())?;
        if let Err(finding) = &self.columns.scale {
            let advice = finding.advice();
            writeln!(
                f,
                "# scale = 128    # counts for a value of 1. Refused as they are: {finding}: {advice}"
            )?;
        }
        writeln!(
            f,
            "\n# Labels: words in a column, one a sample in files of their own, or {{gesture}} in `files`. Classes: relax, open, close,\n\
             # wave-in (flexion), wave-out (extension), pinch, other (movement that is none of these) or a kind of it (point, ...).\n\
             # What stays unknown is unlabelled. \"*\": all other words.\n\
             # label = {}\n# label_files = \"...\"\n# labels = {{ relax = [0], open = [1], close = [2], other = [3, 4], unknown = [\"*\"] }}\n\
             # timing = \"cues\"    # the muscle follows late; \"muscle\": labels lie on its activity; \"from-activity\": one gesture a file\n\
             # arm = \"left\"\n# rotation = 1    # channel c of the common frame is channel c + 1 here",
            CHANNELS + 1
        )?;
        if let (unread @ 1.., reason) = &self.unread {
            writeln!(
                f,
                "\n# Cannot be read so: {unread} files; the first: {}",
                printable(reason)
            )?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests;
