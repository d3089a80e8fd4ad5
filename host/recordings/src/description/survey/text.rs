//! Text of a first description, with comments on what was seen and what a person must say.

use std::collections::{BTreeMap, BTreeSet};
use std::fmt::{self, Write as _};
use std::path::{Path, PathBuf};

use shared::units::SAMPLE_RATE_HZ;

use super::columns::{Roles, is_armbands};
use super::layout::Layout;
use super::words::Words;
use crate::description::pattern::{Field, Pattern};
use crate::description::words::ALL_OTHERS;
use crate::readers::error::LoadError;
use crate::readers::error::excerpt::excerpt;
use execution::printable::printable;

/// Maximum number of names in a comment.
const SHOWN: usize = 6;
/// Maximum number of words in a comment.
const WORDS: usize = 40;
/// Maximum number of words under unknown.
const LISTED: usize = 30;

/// Observations of a folder.
pub(super) struct Text<'s> {
    /// The folder, if the description is elsewhere.
    pub folder: Option<&'s Path>,
    pub layout: &'s Layout,
    pub roles: &'s Roles,
    pub pattern: &'s Pattern,
    pub label_files: Option<&'s Pattern>,
    /// The files of the layout.
    pub files: &'s [PathBuf],
    /// Files of other layouts, and the first of each.
    pub others: Vec<(usize, PathBuf)>,
    /// Files whose rows no description makes samples.
    pub refused: &'s [LoadError],
    pub people: BTreeSet<String>,
    pub words: Words,
    /// Recordings that are read without a description.
    pub known: usize,
}

/// A text as TOML has it.
fn quoted(text: &str) -> String {
    toml::Value::String(text.to_owned()).to_string()
}

/// A word as a description has it: numbers without quotes.
fn word(text: &str) -> String {
    text.parse::<i64>()
        .map_or_else(|_| quoted(text), |number| number.to_string())
}

impl Text<'_> {
    /// The description without meanings of labels, to read the files with.
    pub fn draft(&self) -> String {
        let has_words = self.has_words();
        let labels = if has_words {
            "labels = { unknown = [\"*\"] }\n"
        } else {
            ""
        };
        format!(
            "{}rate = {SAMPLE_RATE_HZ}\n{}{labels}",
            self.columns(),
            self.scale()
        )
    }

    fn has_words(&self) -> bool {
        self.roles.label.is_some() || self.label_files.is_some() || self.pattern.has(Field::Gesture)
    }

    /// A column by its name, or its number.
    fn column(&self, at: usize) -> String {
        let name = self.roles.names.get(at).map(|name| quoted(name.trim()));
        name.unwrap_or_else(|| (at + 1).to_string())
    }

    /// Paths and columns.
    fn columns(&self) -> String {
        let mut text = format!("files = {}\n", quoted(&self.pattern.to_string()));
        if let Some(pattern) = self.label_files {
            let _ = writeln!(text, "label_files = {}", quoted(&pattern.to_string()));
        }
        let is_plain_array = self.layout.separator.is_none() && self.layout.width == 8;
        if let Some(channels) = self.roles.channels.filter(|_| !is_plain_array) {
            if let Some(separator) = self.layout.separator {
                let header = !self.roles.names.is_empty();
                let _ = writeln!(text, "separator = {}\nheader = {header}", quoted(separator));
            }
            let channels = channels.map(|at| self.column(at)).join(", ");
            let _ = writeln!(text, "channels = [{channels}]");
        }
        if self.roles.channels.is_some() {
            for (key, column) in [("time", self.roles.time), ("label", self.roles.label)] {
                if let Some(at) = column {
                    let _ = writeln!(text, "{key} = {}", self.column(at));
                }
            }
        }
        text
    }

    fn scale(&self) -> String {
        match self.roles.scale {
            Ok(scale) if scale != 1.0 => format!("scale = {scale}\n"),
            _ => String::new(),
        }
    }

    /// Comments on the paths.
    fn paths(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let first = self.files.first().map(|path| path.display().to_string());
        writeln!(
            f,
            "# Paths: {} files such as {}",
            self.files.len(),
            excerpt(&first.unwrap_or_default())
        )?;
        if self.pattern.has(Field::Person) {
            let people: Vec<&str> = self.people.iter().map(String::as_str).take(SHOWN).collect();
            let more = if self.people.len() > SHOWN {
                ", ..."
            } else {
                ""
            };
            writeln!(
                f,
                "# People: {}: {}{more}",
                self.people.len(),
                printable(&people.join(", "))
            )?;
        } else {
            writeln!(
                f,
                "# People: by folder. Write {{person}} where a path names the person."
            )?;
        }
        let unmatched = self
            .files
            .iter()
            .filter(|path| self.pattern.fields_of(path, |_| true).is_none());
        let unmatched: Vec<&PathBuf> = unmatched.collect();
        if let Some(first) = unmatched.first() {
            writeln!(
                f,
                "# Named otherwise, and not read: {} files such as {}",
                unmatched.len(),
                excerpt(&first.display().to_string())
            )?;
        }
        for (count, first) in &self.others {
            let first = excerpt(&first.display().to_string());
            writeln!(
                f,
                "# With other columns, and not described here: {count} files such as {first}"
            )?;
        }
        if let Some(first) = self.refused.first() {
            let (count, first) = (self.refused.len(), first.line());
            writeln!(f, "# Left out: {count} files; the first: {first}")?;
        }
        Ok(())
    }

    /// Rate, with how it was seen.
    fn rate(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match (self.roles.rate, self.roles.time) {
            (Some(rate), _) if is_armbands(rate) => writeln!(
                f,
                "rate = {SAMPLE_RATE_HZ}    # {rate:.1} by the column of times"
            ),
            (Some(rate), _) => writeln!(
                f,
                "rate = {rate:.0}    # by the column of times: it is refused, as samples are missing"
            ),
            (None, Some(_)) => writeln!(
                f,
                "rate = {SAMPLE_RATE_HZ}    # not seen: the column of times does not show it. Check."
            ),
            (None, None) => writeln!(
                f,
                "rate = {SAMPLE_RATE_HZ}    # not seen: there is no column of times. Check."
            ),
        }
    }

    fn unit(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (least, most) = self.roles.range;
        match &self.roles.scale {
            Ok(1.0) => writeln!(f, "# Values from {least} to {most}: the armband's counts.")?,
            Ok(scale) => writeln!(
                f,
                "scale = {scale}    # values from {least} to {most}: counts divided by this"
            )?,
            Err(finding) => writeln!(
                f,
                "scale = 1    # values from {least} to {most} are no counts of a known unit. Say how many counts 1 is.\n\
                 # As they are, files are refused: {finding}: {}",
                finding.advice()
            )?,
        }
        let is_rectified = least >= 0.0 && self.roles.scale.is_ok();
        let seen = match (is_rectified, least >= 0.0) {
            (true, _) => "no value is below zero: it is refused",
            (false, true) => "not seen: the values are no counts",
            (false, false) => "values have both signs",
        };
        writeln!(f, "rectified = {is_rectified}    # {seen}")
    }

    /// Meaning of the words.
    fn labels(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if !self.has_words() {
            return writeln!(
                f,
                "# Labels: none seen. Write {{gesture}} in `files`, or name a column, label = \"NAME\", and say what its words mean:\n\
                 # labels = {{ relax = [0], open = [1], close = [2], other = [3, 4], unknown = [9] }}"
            );
        }
        writeln!(
            f,
            "# Labels: word, files, seconds, mean magnitude in counts."
        )?;
        let more = self.words.words.len().saturating_sub(WORDS);
        for word in self.words.sorted().into_iter().take(WORDS) {
            let own = &self.words.words[word];
            let word = printable(word);
            writeln!(
                f,
                "#   {word:16} {:5} {:7.0} s {:6.1}",
                own.files,
                own.seconds(),
                own.level()
            )?;
        }
        if more > 0 {
            writeln!(f, "#   and {more} more words")?;
        }
        let column = self.roles.label.and_then(|at| self.roles.names.get(at));
        let classes = self.words.by_class(column.map(String::as_str));
        if classes.contains_key("unknown") {
            writeln!(
                f,
                "# Sort the words under unknown: relax, open, close, wave-in (flexion), wave-out (extension), pinch, other\n\
                 # (movement that is none of these), or a kind of it (point, pronation, ...). What stays is unlabelled. \"*\": all other words."
            )?;
        }
        writeln!(f, "labels = {}", lists(&classes))
    }

    /// Time that the labels stand at.
    fn timing(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Words {
            gestures,
            between_rests,
            ..
        } = self.words;
        if gestures == 0 {
            return writeln!(
                f,
                "timing = \"cues\"    # not seen: cues, which the muscle follows late, or \"muscle\" if labels lie on its activity"
            );
        }
        if 4 * between_rests > 3 * gestures {
            return writeln!(
                f,
                "timing = \"from-activity\"    # in {between_rests} of {gestures} files the muscle rises from rest: labels are found there"
            );
        }
        writeln!(
            f,
            "timing = \"cues\"    # in {between_rests} of {gestures} files the muscle rises from rest: files are taken for one hold each"
        )
    }
}

/// Lists of words in TOML.
fn lists(classes: &BTreeMap<&str, Vec<&str>>) -> String {
    let order = ["relax", "open", "close", "wave-in", "wave-out", "pinch"];
    let rank = |class: &str| match order.iter().position(|own| *own == class) {
        Some(at) => at,
        None => order.len() + usize::from(class == "unknown"),
    };
    let mut lists: Vec<(&&str, &Vec<&str>)> = classes.iter().collect();
    lists.sort_by_key(|(class, _)| rank(class));
    if lists.is_empty() {
        return format!("{{ unknown = [{}] }}", quoted(ALL_OTHERS));
    }
    let list = |(class, words): (&&str, &Vec<&str>)| {
        if *class == "unknown" && words.len() > LISTED {
            return format!("unknown = [{}]", quoted(ALL_OTHERS));
        }
        let words: Vec<String> = words.iter().map(|text| word(text)).collect();
        format!("{class} = [{}]", words.join(", "))
    };
    let lists: Vec<String> = lists.into_iter().map(list).collect();
    format!("{{ {} }}", lists.join(", "))
}

impl fmt::Display for Text<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(
            f,
            "# Recordings of this folder, as `myointent data describe` sees them. Check each line and correct it, then look at\n\
             # what comes of it: myointent data inspect. `myointent data describe --help` has all fields.\n"
        )?;
        if let Some(folder) = self.folder {
            writeln!(f, "folder = {}", quoted(&folder.to_string_lossy()))?;
        }
        if 2 * self.known > self.files.len() {
            let known = self.known;
            writeln!(
                f,
                "# {known} recordings are read without this file. Remove it if `data inspect` then shows what it should.\n"
            )?;
        }
        self.paths(f)?;
        f.write_str(&self.columns())?;
        if self.roles.channels.is_none() {
            writeln!(
                f,
                "# Columns: by their names, which differ from file to file."
            )?;
        }
        if !self.roles.one_hot.is_empty() {
            let columns: Vec<String> = self
                .roles
                .one_hot
                .iter()
                .map(|&at| self.column(at))
                .collect();
            writeln!(
                f,
                "# Columns {} have a label each, as a description cannot say. Where eight columns are called emg_0 to emg_7 and\n\
                 # these after classes (relax, open, close), they are read without this file; else write one column of labels.",
                columns.join(", ")
            )?;
        }
        if let Some(more) = self.roles.more {
            writeln!(
                f,
                "# {more} columns look like channels; the first eight are taken. Check."
            )?;
        }
        writeln!(f)?;
        self.rate(f)?;
        self.unit(f)?;
        writeln!(
            f,
            "# Cannot be seen: the arm, and by how many places the armband is turned.\n\
             # arm = \"left\"\n# rotation = 1    # channel c of the common frame is channel c + 1 here\n"
        )?;
        self.labels(f)?;
        if self.has_words() {
            self.timing(f)?;
        }
        if let (unread, Some(reason)) = (self.words.unread, &self.words.first_reason) {
            writeln!(
                f,
                "\n# Cannot be read so: {unread} files; the first: {}",
                printable(reason)
            )?;
        }
        Ok(())
    }
}
