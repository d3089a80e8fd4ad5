//! Draft of a description: `myointent data describe`.
//!
//! It describes the kind of files that a folder has most of, by what they say themselves: separator, header, columns,
//! unit, words of labels. What only a person knows stands in it as a comment.

mod columns;

use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write as _;
use std::fs::File;
use std::io::{ErrorKind, Write as _};
use std::path::{Path, PathBuf};

use rayon::prelude::*;
use shared::units::SAMPLE_RATE_HZ;

use super::pattern::Pattern;
use super::words::ALL_OTHERS;
use super::{Described, Description, FILE_NAME};
use crate::labels::motion::Motion;
use crate::readers::error::LoadError;
use crate::readers::error::excerpt::excerpt;
use crate::readers::label_file;
use crate::readers::path::with_small_ending;
use crate::recording::by;
use columns::Columns;
use execution::printable::printable;

/// Maximum number of words that are listed.
const LISTED: usize = 30;
/// Marks that divide a name.
const MARKS: [char; 4] = ['_', '-', ' ', '.'];

/// Writes a draft of a folder's description: into the folder, or into the file `out`. Returns the file and its text.
///
/// # Errors
/// When the folder has no recordings that can be described, or the file exists: it is never replaced.
pub fn describe(folder: &Path, out: Option<&Path>) -> Result<(PathBuf, String), LoadError> {
    let io = |source| LoadError::io(folder, source);
    let folder = dunce::canonicalize(folder).map_err(io)?;
    if !folder.is_dir() {
        let problem = "expected a folder with recordings, which is what a description is of";
        return Err(LoadError::description(&folder, None, problem));
    }
    let path = out.map_or_else(|| folder.join(FILE_NAME), Path::to_owned);
    let exists = || {
        let problem = "there is one already: correct it, or remove it and describe again";
        LoadError::description(&path, None, problem)
    };
    if path.exists() {
        return Err(exists());
    }
    let text = draft(&folder, out.is_some())?;
    let failed = |source: std::io::Error| match source.kind() {
        ErrorKind::AlreadyExists => exists(),
        _ => {
            let problem = format!("it cannot be written: {source}; --out FILE writes it elsewhere");
            LoadError::description(&path, None, problem)
        }
    };
    let mut file = File::create_new(&path).map_err(failed)?;
    file.write_all(text.as_bytes()).map_err(failed)?;
    Ok((path, text))
}

/// Text of the draft of a folder's description, which names the folder if it is `elsewhere`.
fn draft(folder: &Path, elsewhere: bool) -> Result<String, LoadError> {
    let (_, files) = crate::library::files(folder)?;
    let count = files.len();
    let found: Vec<(Columns, PathBuf)> = files
        .into_par_iter()
        .flatten()
        .filter_map(|path| Some((Columns::of(&path)?, path)))
        .collect();
    let by_kind = by(0..found.len(), |&at| {
        let columns = &found[at].0;
        (&columns.ending, &columns.channels, &columns.label)
    });
    // A folder that the readers know may need no description; and they say why a file is refused.
    let (known, reason) = match crate::load(folder, &crate::LoadOptions::default()) {
        Ok(library) => (
            library.recordings.len(),
            library.skipped.first().map(LoadError::line),
        ),
        Err(error) => (0, Some(error.line())),
    };
    let none = || {
        let found = reason.unwrap_or_else(|| format!("{count} files"));
        let problem = format!(
            "no recordings in it: expected csv, txt, tsv or npy files with eight columns of numbers, found {found}"
        );
        LoadError::description(folder, None, problem)
    };
    let by_number = by_kind.into_values();
    let most = by_number.max_by_key(|own| (own.len(), std::cmp::Reverse(own[0])));
    let most = most.ok_or_else(none)?;
    let below = |at: &usize| {
        let path = &found[*at].1;
        with_small_ending(path.strip_prefix(folder).unwrap_or(path))
    };
    let files: Vec<PathBuf> = most.iter().map(below).collect();
    let braces = "names of folders have braces: rename them";
    let braces = || LoadError::description(&files[0], None, braces);
    let pattern = pattern(&files).ok_or_else(braces)?;
    let columns = &found[most[0]].0;
    let described = Described::new(
        folder,
        Description::parse(
            &folder.join(FILE_NAME),
            &fields(&pattern, columns, &BTreeSet::new()),
        )?,
    );
    let (words, unread) = read(&described, most.iter().map(|&at| &*found[at].1).collect());
    let first = such_as(&files[0]);
    let mut text = "# Draft, by `myointent data describe`. Correct each line, then look at what comes of it: myointent data inspect.\n\
        # `myointent data describe --help` explains all fields.\n\n"
        .to_owned();
    if elsewhere {
        text += &format!("folder = {}\n\n", quoted(&folder.to_string_lossy()));
    }
    if 2 * known > files.len() {
        text += &format!(
            "# {known} recordings are read without this file. Remove it if `data inspect` then shows what it should.\n\n"
        );
    }
    text += &format!(
        "# {} files such as {first}. Name the parts of their paths: {{person}}, {{session}}, {{gesture}}, {{trial}} (a number),\n\
         # {{any}}. Without {{person}} the folder is the person.\n",
        files.len()
    );
    let is_other = |path: &&PathBuf| pattern.fields_of(path, |_| true).is_none();
    let otherwise: Vec<PathBuf> = files.iter().filter(is_other).cloned().collect();
    let others = (0..found.len()).filter(|at| most.binary_search(at).is_err());
    let others: Vec<PathBuf> = others.map(|at| below(&at)).collect();
    for (how, paths) in [
        ("Named otherwise", otherwise),
        ("With other columns", others),
    ] {
        if let Some(first) = paths.first() {
            let (count, first) = (paths.len(), such_as(first));
            text += &format!("# {how}, and not read: {count}, such as {first}\n");
        }
    }
    text += &fields(&pattern, columns, &words);
    if let Err(finding) = &columns.scale {
        let advice = &finding.advice;
        text += &format!(
            "# scale = 128    # counts for a value of 1. Refused as they are: {finding}: {advice}\n"
        );
    }
    text += "\n# Labels: words in a column, one a sample in files of their own, or {gesture} in `files`. Classes: relax, open, close,\n\
         # wave-in (flexion), wave-out (extension), pinch, other (movement that is none of these) or a kind of it (point, ...).\n\
         # What stays unknown is unlabelled. \"*\": all other words.\n";
    if !columns.channels.contains("time = ") {
        text += "# time = 1    # a column of times or numbers of samples\n";
    }
    text += "# label = 9\n# label_files = \"...\"\n# labels = { relax = [0], open = [1], close = [2], other = [3, 4], unknown = [\"*\"] }\n\
         # timing = \"cues\"    # the muscle follows late; \"muscle\": labels lie on its activity; \"from-activity\": one gesture a file\n\
         # arm = \"left\"\n# rotation = 1    # channel c of the common frame is channel c + 1 here\n";
    if let (unread @ 1.., reason) = unread {
        text += &format!(
            "\n# Cannot be read so: {unread} files; the first: {}\n",
            printable(&reason)
        );
    }
    Ok(text)
}

/// Words of the labels in files; and the number of those that cannot be read as described, with the first reason.
fn read(described: &Described, paths: Vec<&Path>) -> (BTreeSet<String>, (usize, String)) {
    let words = |path: &Path| {
        let fields = described.fields_of(path)?;
        let rows = described.rows(path, &fields);
        Some(rows.map(|rows| {
            let words = rows.labels.words.unwrap_or_default();
            let distinct = words.distinct().iter();
            distinct.map(|(word, _)| word.clone()).collect::<Vec<_>>()
        }))
    };
    let found: Vec<_> = paths.into_par_iter().filter_map(words).collect();
    let (mut all, mut unread) = (BTreeSet::new(), (0, String::new()));
    for found in found {
        match found {
            Ok(words) => all.extend(words),
            Err(error) if unread.0 == 0 => unread = (1, error.line()),
            Err(_) => unread.0 += 1,
        }
    }
    (all, unread)
}

/// Lines of the fields that the files show.
fn fields(pattern: &Pattern, columns: &Columns, words: &BTreeSet<String>) -> String {
    let mut text = format!("files = {}\n", quoted(&pattern.to_string()));
    text += &columns.channels;
    if let Some((label, _)) = &columns.label {
        let _ = writeln!(text, "label = {label}");
    }
    let _ = writeln!(text, "rate = {SAMPLE_RATE_HZ}");
    if let Ok(scale) = columns.scale
        && scale != 1.0
    {
        let _ = writeln!(text, "scale = {scale}");
    }
    if let Some((_, is_gt)) = columns.label {
        let _ = writeln!(text, "labels = {}", labels(words, is_gt));
    }
    text
}

/// Lists of words by class, unknown last. In a column gt, numbers are ReactEMG's.
fn labels(words: &BTreeSet<String>, is_gt: bool) -> String {
    let motion = |word: &str| match is_gt {
        true => label_file::from_text(word).ok(),
        false => Motion::of_gesture(word).or_else(|| Motion::from_name(word)),
    };
    let mut classes: BTreeMap<(bool, &str), Vec<String>> = BTreeMap::new();
    for word in words {
        let name = motion(word).unwrap_or(Motion::Unknown).name();
        let number = word.parse::<i64>().map(|number| number.to_string());
        let word = number.unwrap_or_else(|_| quoted(word));
        classes
            .entry((name == "unknown", name))
            .or_default()
            .push(word);
    }
    let all_others = || vec![quoted(ALL_OTHERS)];
    if classes.is_empty() {
        classes.insert((true, "unknown"), all_others());
    }
    let list = |((is_unknown, class), words): ((bool, &str), Vec<String>)| {
        let is_long = is_unknown && words.len() > LISTED;
        let words = if is_long { all_others() } else { words };
        format!("{class} = [{}]", words.join(", "))
    };
    let lists: Vec<String> = classes.into_iter().map(list).collect();
    format!("{{ {} }}", lists.join(", "))
}

/// Pattern of paths as long as most are: what is the same in all is text; of the folders that differ the outermost is the
/// person. `None` if names have braces.
fn pattern(paths: &[PathBuf]) -> Option<Pattern> {
    let names = |path: &PathBuf| -> Option<Vec<String>> {
        let names = path.iter().map(|name| name.to_str().map(str::to_owned));
        names.collect()
    };
    let paths: Vec<Vec<String>> = paths.iter().filter_map(names).collect();
    let mut depths: BTreeMap<usize, usize> = BTreeMap::new();
    for path in &paths {
        *depths.entry(path.len()).or_default() += 1;
    }
    let (depth, _) = depths.into_iter().max_by_key(|(_, count)| *count)?;
    let alike = paths.iter().filter(|path| path.len() == depth);
    let mut free = ["{session}", "{person}"].to_vec();
    let mut text = String::new();
    for at in 0..depth - 1 {
        let mut folders = alike.clone().map(|path| &path[at]);
        let first = folders.next()?;
        text += match folders.all(|own| own == first) {
            true => first,
            false => free.pop().unwrap_or("{any}"),
        };
        text.push('/');
    }
    let files: Vec<&str> = alike.map(|path| path[depth - 1].as_str()).collect();
    Pattern::try_from(text + &file_pattern(&files)).ok()
}

/// Pattern of names of files: what all begin and end with, up to a mark.
fn file_pattern(files: &[&str]) -> String {
    let first = files[0];
    if files.iter().all(|own| *own == first) {
        return first.to_owned();
    }
    let places = || {
        first
            .char_indices()
            .filter(|(_, mark)| MARKS.contains(mark))
    };
    let begins = |at: &usize| files.iter().all(|own| own.starts_with(&first[..*at]));
    let ends = |at: &usize| files.iter().all(|own| own.ends_with(&first[*at..]));
    let begin = places().map(|(at, _)| at + 1).rfind(begins);
    let end = places().map(|(at, _)| at).find(ends);
    let (begin, end) = (begin.unwrap_or(0), end.unwrap_or(first.len()));
    let is_between = |own: &&str| own.len() > begin + (first.len() - end);
    if files.iter().all(is_between) {
        format!("{}{{any}}{}", &first[..begin], &first[end..])
    } else {
        format!("{{any}}{}", &first[first.rfind('.').unwrap_or(end)..])
    }
}

/// A path as a pattern has it, on every system.
fn such_as(path: &Path) -> String {
    let names: Vec<_> = path.iter().map(|name| name.to_string_lossy()).collect();
    excerpt(&names.join("/"))
}

/// A text as TOML has it.
fn quoted(text: &str) -> String {
    toml::Value::String(text.to_owned()).to_string()
}

#[cfg(test)]
mod tests;
